"""Whether a flow is linearly stable, as far as a set of wavenumbers tells: one growing mode refutes, counts at all of them support.

Instability is cheap to show: a pseudospectral spectrum suggests a growing mode at some wave, and one zero of D in a small circle proves it.
Stability is not: the modes of every wave are counted, and none may grow. Along a family of flows the answer of one says where to begin
with the next.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shootstab.analyses.refine import refine
from shootstab.analyses.sweep.dominance import DominantModes, count_dominant, lowest_floor, next_to, suggested
from shootstab.core.allowed import GROWTH_FLOOR
from shootstab.core.errors import ConvergenceError
from shootstab.core.records import UNRESOLVED, Mode
from shootstab.models.chute.chute_problem import ChuteProblem
from shootstab.models.chute.steady_flow import Flow

STABLE, UNSTABLE = "stable", "unstable"
EXTENT = (1e-3, 1.0)  # chosen: wavenumbers times the height of the centre of mass
PER_AXIS = 10  # chosen: wavenumbers along an axis, over the three decades of EXTENT
OBLIQUE = 0.1  # chosen: k_x/k_y of the oblique waves: where the paper finds them, k_y is about ten times k_x
STABILITY_RTOL = 1e-6  # chosen: accuracy of the mode that proves an instability

Wave = tuple[float, float]


@dataclass(frozen=True)
class Stability:
    """verdict: 'unstable' where `mode` grows at `wave`; 'stable' where none grows at any wave; 'unresolved: …' says why.

    Growing means Re σ > floor, or 1e−7 of the frequencies k_x u0 of the continuous spectrum where that is more.

    counted is the number of waves at which the modes were counted, place the line of `wave` and its place on it.
    """

    verdict: str
    mode: Mode | None = None
    wave: Wave | None = None
    counted: int = 0
    place: tuple[int, int] | None = None


def waves(flow: Flow, per_axis: int = PER_AXIS) -> list[list[Wave]]:
    """Lines of rising (k_x, k_y) over three decades of k h0: along k_y, along k_x, and along an oblique direction."""
    ks = np.geomspace(*EXTENT, per_axis) / flow.centre_of_mass
    return [[(0.0, float(k)) for k in ks], [(float(k), 0.0) for k in ks], [(OBLIQUE * float(k), float(k)) for k in ks]]


def stability(
    flow: Flow, lines: Sequence[Sequence[Wave]] | None = None, floor: float = GROWTH_FLOOR, near: Stability | None = None
) -> Stability:
    """Look for a growing mode at every wave, and count the modes of all where none is found.

    lines hold waves in the order of neighbours, by default those of `waves`. The search begins where k h0 is about 0.1.

    near is what was said of a flow next to this one at the same places of its lines. It tells where to begin, and no more: with the mode
    that grew there, or where none did with the counts. What is said rests on a mode or on counts of this flow all the same.
    """
    lines = waves(flow) if lines is None else lines
    counted: Stability | None = None
    if near is not None and near.mode is not None and near.place is not None:
        line, at = near.place
        problem = ChuteProblem(flow, *lines[line][at])
        found = _grows(problem, [s for s in [next_to(problem, complex(near.mode.sigma))] if s is not None], floor)
        if found is not None:
            return Stability(UNSTABLE, found, lines[line][at], place=near.place)
    elif near is not None and near.verdict == STABLE:
        counted = _counted(flow, lines, floor)
        if counted.verdict in (STABLE, UNSTABLE):
            return counted
    places = [(i, j) for i, line in enumerate(lines) for j in range(len(line))]
    for i, j in sorted(places, key=lambda at: abs(np.log(10 * max(lines[at[0]][at[1]]) * flow.centre_of_mass))):
        problem = ChuteProblem(flow, *lines[i][j])
        found = _grows(problem, suggested(problem), floor)
        if found is not None:
            return Stability(UNSTABLE, found, lines[i][j], place=(i, j))
    return counted or _counted(flow, lines, floor)


def _counted(flow: Flow, lines: Sequence[Sequence[Wave]], floor: float) -> Stability:
    """What counts at all waves say, up to the first at which a mode grows, or at which none can be made down to the floor."""
    counted = 0
    for i, line in enumerate(lines):
        before: DominantModes | None = None
        for j, wave in enumerate(line):
            problem = ChuteProblem(flow, *wave)
            try:
                before = count_dominant(problem, [], floor, before)
            except ConvergenceError as error:
                return Stability(f"{UNRESOLVED}: at kx = {wave[0]:.4g}, ky = {wave[1]:.4g}: {error}", counted=counted)
            counted += 1
            if before.modes:
                found = _grows(problem, before.modes, floor)
                if found is None:
                    return Stability(f"{UNRESOLVED}: a mode is counted at kx = {wave[0]:.4g}, ky = {wave[1]:.4g}, and not refined")
                return Stability(UNSTABLE, found, wave, counted, (i, j))
            if before.floor > lowest_floor(before.continuation, floor):
                why = f"at kx = {wave[0]:.4g}, ky = {wave[1]:.4g} modes could be counted above {before.floor:.1e} only"
                return Stability(f"{UNRESOLVED}: {why}", counted=counted)
    return Stability(STABLE, counted=counted)


def _grows(problem: ChuteProblem, guesses: Sequence[complex], floor: float) -> Mode | None:
    """A mode next to one of the guesses that grows by more than its error, with its proof."""
    for guess in guesses:
        mode = refine(problem, guess, STABILITY_RTOL)
        if mode.converged and complex(mode.sigma).real - float(mode.error) > floor:
            return mode
    return None
