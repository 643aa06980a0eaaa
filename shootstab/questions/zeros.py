"""The modes in a disc or a rectangle, near the continuous spectrum too: zeros of D, each counted on its own side."""

from __future__ import annotations

from dataclasses import dataclass

from shootstab.discriminants.atlas import Atlas, Chart
from shootstab.roots.find import find
from shootstab.roots.iterations import newton
from shootstab.roots.winding import Winding, wind
from shootstab.vocabulary.errors import ConvergenceError
from shootstab.vocabulary.regions import Disc, Rectangle

AGREEMENT = 0.3  # of D on a mesh and D on the halved one, on the boundary of a disc: by Rouché's theorem 1 would do
PROBES = 4


class Inaccurate(ConvergenceError):  # noqa: N818 - it is a finding, not a fault
    """D on its mesh is not accurate enough for a count in so small a disc."""


@dataclass(frozen=True)
class Zeros:
    """modes and resonances (complex numbers, as often as their multiplicity) in a disc; path tells along which path D was computed."""

    modes: tuple[complex, ...]
    resonances: tuple[complex, ...]
    path: str


class Crowded(ConvergenceError):  # noqa: N818 - it is a finding, not a fault
    """More zeros lie in the disc than were to be told apart."""


def zeros_in(atlas: Atlas, disc: Disc, most: int | None = None) -> Zeros:
    """All zeros in a disc, by counting; where the continuous spectrum crosses it, on each side of it those of the continuation from there.

    Raises ConvergenceError (Undecidable among them) when that cannot be decided, and Crowded when one chart has more zeros than most.
    """
    modes: list[complex] = []
    resonances: list[complex] = []
    charts = atlas.charts(disc.centre, disc.radius)
    for chart in charts:
        winding = wind(chart.discriminant, disc)
        if most is not None and winding.count > most:
            raise Crowded(f"{winding.count} zeros lie within {disc.radius:.1e}")
        require_accurate(chart, winding)
        if winding.count == 0:
            continue
        root = newton(chart.discriminant, winding.centre + winding.moment, 1e-10) if winding.count == 1 else None
        if root is not None and root.converged and abs(root.sigma - disc.centre) < disc.radius + 2 * root.step:
            found = [root.sigma]
        else:
            corner = complex(disc.radius, disc.radius)
            found = [z for z in find(chart.discriminant, Rectangle(disc.centre - corner, disc.centre + corner)) if disc.contains(z)]
            if len(found) != winding.count:
                raise ConvergenceError(f"{winding.count} zeros were counted within {disc.radius:.1e}, but {len(found)} found")
        for zero in found:
            (modes if atlas.own_side(chart, zero) else resonances).append(zero)
    return Zeros(tuple(modes), tuple(resonances), " and ".join(c.path for c in charts))


def require_accurate(chart: Chart, winding: Winding) -> None:
    """Raise Inaccurate unless D on the halved mesh is the same, at some of the samples, to what the count needs.

    Both are analytic; where |D_fine/D − 1| < 1 all along the boundary, Rouché's theorem says that they have as many zeros inside.
    """
    fine = chart.discriminant.refined()
    for value in winding.samples[:: max(1, len(winding.samples) // PROBES)]:
        off = abs(fine(value.sigma).over(value.D) - 1)
        if not off < AGREEMENT:
            raise Inaccurate(f"D is not accurate enough to count in so small a circle: halving the steps changes it by {off:.1e} of itself")
