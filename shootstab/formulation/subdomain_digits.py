"""Problems in equations to any number of digits whose solutions are carried through several subdomains, or from an end at infinity.

Each subdomain goes from its beginning to its target in its own z = z_begin + t (target − z_begin), 0 ≤ t ≤ 1, all of them as one system in
blocks, as in problems.subdomains. It begins with what its end allows: with the decaying space at infinity, with the regular solutions at a
singular end, with the solutions that conditions without the eigenvalue leave; or, between two interfaces and where the eigenvalue stands in
the conditions, with all solutions beside their starting values a = ψ(z_begin), as components before ψ. Where all arrive conditions hold.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from shootstab.core.progress import StepDone
from shootstab.formulation.base_digits import FlowDigits, FlowSeries
from shootstab.formulation.digit_beginnings import AugmentedBeginning, Begin, Beginning
from shootstab.formulation.expression import Expression
from shootstab.formulation.series_digits import on_numbers, on_series
from shootstab.formulation.shown_in_digits import Shown, rows_of, shown_at
from shootstab.formulation.state_pencil import Powers, StatePencil
from shootstab.multiprecision.arithmetic import Arithmetic, Matrix
from shootstab.multiprecision.integration import BaseFlowNumbers, Expansion, UnknownRows
from shootstab.multiprecision.settings import Settings
from shootstab.multiprecision.taylor import Taylor, real_series


@dataclass(frozen=True, eq=False)
class DigitSubdomain:
    """One subdomain: the system that holds in it, what it begins with, and where it arrives."""

    system: StatePencil
    begin: Begin
    target: Fraction
    shown: Shown

    @property
    def size(self) -> int:
        """The number of components, starting values among them."""
        return self.system.size * (1 + isinstance(self.begin, AugmentedBeginning))


@dataclass(frozen=True, eq=False)
class ArrivalConditions:
    """Conditions where all arrive: by powers of σ, entries by (row, component of all subdomains); the coordinate in them is at."""

    rows: Powers
    count: int
    at: Fraction


def _holds_functions(parts: Powers) -> bool:
    return any(atom.kind == "given" for part in parts for entry in part.values() for atom in entry.atoms())


@dataclass(frozen=True, eq=False)
class DigitPart:
    """See multiprecision.placed_solution.LinePart: the j-th of the subdomains, and of their beginnings."""

    arithmetic: Arithmetic
    subdomains: Sequence[DigitSubdomain]
    beginnings: Sequence[Beginning]
    j: int

    @property
    def begin(self) -> Any:
        return self.arithmetic.number(self.beginnings[self.j].place)

    @property
    def way(self) -> Any:
        return self.arithmetic.number(self.subdomains[self.j].target - self.beginnings[self.j].place)

    @property
    def farthest(self) -> float:
        return self.beginnings[self.j].farthest

    def farther(self, sigma: Any, c: Matrix, place: Any, distance: Any) -> Mapping[str, Any]:
        first, *widths = [0, *(len(beginning.frame(sigma)[0][0]) for beginning in self.beginnings)]
        first = sum(widths[: self.j])
        psi = self.beginnings[self.j].beyond(sigma, c[first : first + widths[self.j]], place, distance)
        return shown_at(self.arithmetic, self.subdomains[self.j].shown, place, sigma, psi)


class SubdomainDigits:
    """See multiprecision.integration.MultiprecisionProblem."""

    real = False

    def __init__(self, subdomains: Sequence[DigitSubdomain], arrivals: Sequence[ArrivalConditions], flow: FlowDigits | None = None) -> None:
        self._subdomains, self._arrivals, self._flow = subdomains, arrivals, flow
        self.size = sum(subdomain.size for subdomain in subdomains)

    def base(self, arithmetic: Arithmetic, settings: Settings, progress: StepDone) -> BaseFlowNumbers:
        return () if self._flow is None else self._flow.base(arithmetic, settings, progress)

    def integration(self, arithmetic: Arithmetic, settings: Settings, base: BaseFlowNumbers) -> SubdomainIntegration:
        flow = None if self._flow is None else self._flow.series(arithmetic, settings, base)
        return SubdomainIntegration(arithmetic, settings, self._subdomains, self._arrivals, flow)


class SubdomainIntegration:
    """See multiprecision.integration.Integration."""

    def __init__(
        self,
        arithmetic: Arithmetic,
        settings: Settings,
        subdomains: Sequence[DigitSubdomain],
        arrivals: Sequence[ArrivalConditions],
        flow: FlowSeries | None,
    ) -> None:
        self._arithmetic, self._settings, self._subdomains, self._arrivals = arithmetic, settings, subdomains, arrivals
        self._flow = flow
        self._over = [(s, flow if _holds_functions((*s.system.C, *s.system.D)) else None) for s in subdomains]  # known where it is held
        self._beginnings = [s.begin.beginning(arithmetic, settings, s.system, s.target, flow) for s, flow in self._over]
        self._along: list[Taylor] = []
        self._t = arithmetic.number(0)
        self._step = arithmetic.number(1) / settings.order  # a first trial; steps double from there

    def begin(self, sigma: Any) -> None:
        for beginning in self._beginnings:
            beginning.begin(sigma)

    def far_frame(self, sigma: Any) -> tuple[Matrix, Any]:
        found = [beginning.frame(sigma) for beginning in self._beginnings]
        width, before, whole = sum(len(frame[0]) for frame, _ in found), 0, []
        factor, nothing = self._arithmetic.number(1), self._arithmetic.number(0)
        for frame, own in found:
            after = width - before - len(frame[0])
            whole += [[*[nothing] * before, *row, *[nothing] * after] for row in frame]
            before += len(frame[0])
            factor = factor * own
        return whole, self._arithmetic.rounded(factor)

    def expand(self, longest: float) -> Expansion:
        arithmetic = self._arithmetic
        left = 1 - self._t
        limit = arithmetic.number(longest) if longest < 1.0 else left
        h = min((self._step, limit, left), key=arithmetic.log2)
        self._h = h
        powers = max(len(subdomain.system.C) for subdomain in self._subdomains)
        C: list[dict[tuple[int, int], Taylor]] = [{} for _ in range(powers)]
        D: list[dict[tuple[int, int], Taylor]] = [{} for _ in range(powers)]
        shift, self._along = 0, []
        for (subdomain, flow), beginning in zip(self._over, self._beginnings, strict=True):
            system = subdomain.system
            way = arithmetic.number(subdomain.target - beginning.place)
            here = arithmetic.number(beginning.place) + way * self._t
            z = real_series(arithmetic, [here, way * h] + [arithmetic.number(0)] * (self._settings.order - 2))
            self._along.append(z)
            at = on_series(arithmetic, z, fields=None if flow is None else flow.along(z))
            for still in range(subdomain.size - system.size):
                C[0][shift + still, shift + still] = 0 * z + 1
            shift += subdomain.size - system.size
            for out, parts, factor in ((C, system.C, 1), (D, system.D, way)):
                for whole, part in zip(out, parts, strict=False):
                    whole.update({(i + shift, j + shift): factor * e for (i, j), e in _evaluated(part, at, z).items()})
            shift += system.size
        return Expansion(h, C, D, arithmetic.log2(left - h) == float("-inf"))

    def advance(self, part: float) -> None:
        step = self._h * self._arithmetic.number(part)
        self._t = self._arithmetic.rounded(self._t + step)
        self._step = 2 * step

    def unknowns(self, sigma: Any) -> UnknownRows:
        """Those of subdomain j by their names behind `j `."""
        rows: dict[str, Mapping[int, Any]] = {}
        first = 0
        for j, ((subdomain, flow), z) in enumerate(zip(self._over, self._along, strict=True)):
            at = on_series(self._arithmetic, z, sigma, None if flow is None else flow.along(z))
            first += subdomain.size
            rows |= rows_of(subdomain.shown, at, first - subdomain.system.size, f"{j} ")
        return rows

    @property
    def parts(self) -> tuple[DigitPart, ...]:
        """The subdomains on the user's line."""
        return tuple(DigitPart(self._arithmetic, self._subdomains, self._beginnings, j) for j in range(len(self._subdomains)))

    farthest = 0.0

    def farther(self, sigma: Any, c: Matrix, place: Any, distance: Any) -> None:
        """Nothing is known for all at once: each subdomain knows its own solutions, see DigitPart."""

    @property
    def wall(self) -> Any:
        """Where all subdomains arrive, in t."""
        return self._arithmetic.number(1)

    def wall_rows(self) -> list[Matrix]:
        arithmetic, width = self._arithmetic, sum(subdomain.size for subdomain in self._subdomains)
        powers = max(len(arrival.rows) for arrival in self._arrivals)
        out: list[Matrix] = [[] for _ in range(powers)]
        for arrival in self._arrivals:
            place = arithmetic.number(arrival.at)
            flow = self._flow if _holds_functions(arrival.rows) else None
            at = on_numbers(arithmetic, place, None if flow is None else flow.at(place))
            for power, whole in enumerate(out):
                part = arrival.rows[power] if power < len(arrival.rows) else {}
                values = {entry: arithmetic.number(1) * at(part[entry]) for entry in part}
                whole += [[values.get((i, j), arithmetic.number(0)) for j in range(width)] for i in range(arrival.count)]
        return out

    def corrected_base(self) -> BaseFlowNumbers:
        return () if self._flow is None else self._flow.corrected()


def _evaluated(part: Mapping[tuple[int, int], Expression], at: Any, z: Taylor) -> dict[tuple[int, int], Taylor]:
    values = {place: at(entry) for place, entry in part.items()}
    return {place: value if isinstance(value, Taylor) else 0 * z + value for place, value in values.items()}
