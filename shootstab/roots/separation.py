"""How far from a zero D is linear: about the distance to the other zeros, and a scale for a zero at σ = 0, which has none of its own.

With D = Π (σ − z_j) e^{g(σ)} and z one of the zeros, D″/(2D′) at z is Σ 1/(z − z_j) over the others, plus g′. A zero at 0 cannot be known
to digits of itself; it can to digits of |2D′/D″|.
"""

from __future__ import annotations

import cmath
from collections.abc import Sequence
from dataclasses import dataclass

from shootstab.core.discriminant import Discriminant, Value
from shootstab.core.errors import ConvergenceError
from shootstab.roots.iterations import slope_change

FIRST_DISTANCE = 1e-3  # chosen: the first distance, in |σ|, at which D′ is looked at again
SMALLEST_DISTANCE = 1e-24  # chosen: that distance where σ is 0, below any σ of interest and far above where a double underflows
NEAR_BY = (1e-4, 2e-2)  # chosen: distances, in |σ|, of a σ that a search passed at which D′ is looked at
STRAIGHT = 0.05  # chosen: the most that D′ may have changed there for the next term of its series to be some percent
NEXT_DISTANCE = 1e3  # derived: the next distance over one, so that a change of SEEN becomes one of a tenth, still nearly linear
SEEN = 1e-4  # chosen: a relative change of D′ so far above its noise, which is 1e-12 or so, that it shows two digits
MOST_DISTANCES = 12  # derived: distances: from the smallest to 1e9
TENFOLD = 10.0  # chosen: the next distance over one where the zeros near a point are counted
MISSES = 8  # chosen: distances in all at which it is none, before nothing more is to be seen
BEYOND = 1e3  # chosen: times the distance to the nearest zero, how far others are looked for that would make it a near one
MOST_TOGETHER = 64  # chosen: |h D′/D| above which D is steep and no number of zeros near a point: as many as a problem may have states
LARGEST_LOOK = 1e50  # chosen: the largest |σ| that is looked at: its powers up to the sixth, with which conditions may go, are doubles
FALLS = 2  # chosen: distances in turn at which |h D′/D| falls though no zero is near: one may be an accident, and beyond them D is constant
WHOLE_NUMBER = 0.1  # chosen: how near (σ − c) D′/D must come to a whole number to be one


def separation(discriminant: Discriminant, at_zero: Value, passed: Sequence[complex] = ()) -> float:
    """|2D′/D″| at a simple zero, with D and D′ next to it, to some 10 %; smaller than that of 1e−3 |σ| it is known only to be so small.

    It is seen at the last of the σ that a search passed which is near enough and not too near, where D may be known still.
    """
    zero = at_zero.sigma
    near = [sigma for sigma in passed if NEAR_BY[0] * abs(zero) <= abs(sigma - zero) <= NEAR_BY[1] * abs(zero)]
    if near:
        change = slope_change(at_zero, discriminant.with_derivative(near[-1]))
        if SEEN <= change <= STRAIGHT:
            return 2.0 * abs(near[-1] - zero) / change
    distance = max(FIRST_DISTANCE * abs(zero), SMALLEST_DISTANCE)
    for _ in range(MOST_DISTANCES):
        change = slope_change(at_zero, discriminant.with_derivative(zero + distance))
        if change >= SEEN:
            break
        distance *= NEXT_DISTANCE
    return 2.0 * distance / change if change > 0.0 else float("inf")


@dataclass(frozen=True)
class Surroundings:
    """The number of zeros at a point, as seen from afar, and the distance over which D is like that power of the distance.

    nearest is about the distance to the nearest of them that D shows from the point itself; 0 where it shows none.
    """

    multiplicity: int
    scale: float
    nearest: float = 0.0

    @property
    def apart(self) -> Surroundings:
        """The surroundings where D at the point is known: its zeros lie where D shows them, and none at the point."""
        return Surroundings(0, self.nearest, self.nearest) if self.nearest > 0.0 else self


def surroundings(discriminant: Discriminant, centre: complex) -> Surroundings:
    """What h D′/D says at c + h while h grows: m + h/scale, m the number of zeros much nearer than h to c.

    That is a whole number above 0 at two distances in turn where m zeros lie near c and no others by a factor of 1000; the larger of them
    tells the scale, as there neither rounding nor the places of the m zeros matter. Otherwise m is 0 and the scale |D/D′|, about the
    distance to the nearest zero. It suggests, and proves nothing. Farther zeros make h D′/D grow with h: where it falls there are none.
    Where m stands out to LARGEST_LOOK, as for D = σ² + 1, there are no others to be nearer than, and m is 0.
    """
    distance, before = max(TENFOLD * abs(centre), SMALLEST_DISTANCE), -1
    empty, found, misses, falls, last = 0.0, Surroundings(0, 0.0), 0, 0, 0.0
    while misses < MISSES and falls < FALLS and abs(centre) + distance < LARGEST_LOOK:
        try:
            turns = distance * discriminant.with_derivative(centre + distance).logarithmic_derivative
        except ConvergenceError:
            break  # D cannot be computed so far off
        if abs(turns) > MOST_TOGETHER:
            break
        whole = max(0, round(turns.real)) if cmath.isfinite(turns) else -1
        off = abs(turns - whole)
        if whole < 0 or off > WHOLE_NUMBER:
            if found.multiplicity > 0 or (empty > 0.0 and distance > BEYOND * empty):
                break
            whole, misses = -1, misses + 1
        elif whole == 0:
            empty = distance / max(off, SEEN)
            falls = falls + 1 if off < last or off == 0.0 else 0
            last = off
        elif whole == before:
            found = Surroundings(whole, distance / max(off, SEEN), empty)
        before, distance = whole, TENFOLD * distance
    seen = found.multiplicity > 0 and abs(centre) + distance < LARGEST_LOOK
    return found if seen else Surroundings(0, empty, empty)


def neutral(around: Surroundings, accuracy: float) -> float:
    """The distance accuracy^(1/m)·scale by which a relative error of D of this accuracy moves m zeros next to 0, one if there is none."""
    return float(accuracy ** (1 / max(1, around.multiplicity)) * around.scale)
