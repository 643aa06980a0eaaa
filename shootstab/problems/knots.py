"""Points at which coefficients are not smooth, found from their values: jumps, kinks, and jumps of higher derivatives.

An integration of order 8 errs in a step across such a point with the order of the singularity, and no estimate of its error holds there.
So every knot becomes a node: a pair of them, one on either side, so that no stage of a step sees the coefficients of the other side.

An interval of the line is resolved where polynomials of a low degree fit all coefficients to rounding. What is not is cut in two, again and
again: of smooth coefficients the residual then falls with a high power of the length, of those with a jump of the p-th derivative as
length^p, and in one of the two parts only. Noise stays in both.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shootstab.core.errors import InputError
from shootstab.core.scaled import EPSILON
from shootstab.problems.protocol import ComplexArray

Reals = NDArray[np.float64]
CoefficientFunction = Callable[[Reals], ComplexArray]  # z (m,) to values (m, entries)

KNOT_POINTS, KNOT_DEGREE = 12, 7  # chosen: a fit on an interval; from it to its half the residual of smooth coefficients falls by 2^8
FIRST_INTERVALS = 65  # chosen: intervals to begin with, in all; narrower features than a twelfth of one may be overlooked
INTERVAL_CUT = 0.48773  # chosen: place of a cut in an interval's length; a knot at 1/2 or 1/3 is to lie inside one and not between two
RESIDUAL_RESOLVED = 1e-14  # chosen: residual of a coefficient in its own size, below which it is smooth to rounding
# chosen: a residual that falls by less from an interval to its quarter is that of a knot: it does by 4^p for a jump of the p-th derivative
KNOT_FALL = 2.0**10
POWER_FALL = 2.0**4.5  # chosen: likewise beside a knot, where nothing is left that jumps: there z^p of a power that is no integer
LAYER_FALL = 1.1  # chosen: one that falls by less does not: there is a layer, wider than the lengths that were tried
FALLS_ALIKE = 2.0  # chosen: factor by which they may differ if they are those of a power
NOISE_RESIDUAL = 1e-9  # chosen: residuals that stay in all parts are noise below it
NOISE_GENERATIONS = 4  # chosen: generations after which all 2^NOISE_GENERATIONS parts of an interval are not resolved, for that
LARGEST_ROUNDINGS = 4.0  # chosen: roundings of a coefficient's largest value, which its residuals are to exceed: 1 − tanh² rounds as 1 does
NOISE_INTERVAL = 1e-6  # chosen: the part of an interval in which coefficients vary by their noise alone
NOISE_FACTOR = 8.0  # chosen: factor by which noise may exceed what is seen there
KNOT_HAIR = 2.0  # chosen: roundings of z between a knot and the node on either side of it
ARGUMENT_ROUNDINGS = 8.0  # chosen: roundings of z that a coefficient feels where it is steep
NARROW_INTERVAL = 256  # chosen: such hairs in an interval that is too narrow to be cut into intervals
MOST_KNOTS = 512  # chosen: knots that are looked for; each costs a thousand values, and all of them a few seconds
KNOT_GENERATIONS = 8  # chosen: after so many cuts steep coefficients tell themselves from those with many knots
MOST_STRETCHES = 8192  # chosen: stretches of one generation; the coefficients have been computed 200,000 times by then
NEAR_ORIGIN = 1e-3  # chosen: the least |z| whose rounding counts, in lengths of the line
MOST_GENERATIONS = 80  # chosen: generations of intervals; 64 cuts make a hair next to z = 0 of the whole line
PAIR_SPACE = 1e-6  # chosen: the least distance of another node to a knot, in lengths of the line
FIT_LENGTHS = (32, 16, 8)  # chosen: lengths beside an interval with a knot over which fits are made; from shorter ones they reach in badly
FIT_ROUNDINGS = 16.0  # chosen: roundings by which two fits that reach into the interval may differ and be one
# chosen: lengths beside a knot, in that to which it is located, over which smoothness is asked for
BESIDE_KNOT = (32, 64, 128, 256, 512, 1024)
BISECTED = 0.1  # chosen: the part of a hair to which the place of a jump is bisected


@dataclass(frozen=True)
class _Intervals:
    """Intervals of one generation (m,): ends, the size of each entry (m, entries), residuals, those of their parents, and ancestors."""

    low: Reals
    high: Reals
    size: Reals
    residual: Reals
    before: Reals
    slow: NDArray[np.bool_]
    ancestor: NDArray[np.int64]

    def where(self, chosen: NDArray[np.bool_]) -> _Intervals:
        """The intervals that a mask (m,) names."""
        return replace(self, **{field.name: getattr(self, field.name)[chosen] for field in fields(self)})

    def each(self) -> Iterator[tuple[float, float, Reals]]:
        """Ends and sizes, interval by interval."""
        return zip(self.low.tolist(), self.high.tolist(), self.size, strict=True)


def find_knots(coefficients: CoefficientFunction, low: float, high: float, given: Reals) -> Reals:
    """The knots (k,) of coefficients inside an interval, those given (l,) among them, rising.

    Raises InputError with the place where they are more than MOST_KNOTS beside those given, or where coefficients go with a power that is
    no integer beside one.
    """
    span = high - low
    ends = np.concatenate(([low], given[(given > low) & (given < high)], [high]))
    found = [ends[1:-1]]
    active = _roots(coefficients, ends)
    for generation in range(MOST_GENERATIONS):
        narrow = active.high - active.low <= NARROW_INTERVAL * hair(np.maximum(np.abs(active.low), np.abs(active.high)), span)
        _require_smooth_beside(coefficients, active.where(narrow), ends)
        found += [_bisected(coefficients, span, *interval) for interval in active.where(narrow).each()]
        parents = active.where(~narrow)
        if not len(parents.low):
            break
        children = _halves(coefficients, parents)
        unresolved = (children.residual > RESIDUAL_RESOLVED).reshape(-1, 2)
        ended = parents.slow & ~unresolved.any(axis=1) & (KNOT_FALL * children.residual.reshape(-1, 2).max(axis=1) > parents.before)
        _require_smooth_beside(coefficients, parents.where(ended), ends)
        found += [_between_fits(coefficients, ends, *interval) for interval in parents.where(ended).each()]
        active = children.where(unresolved.ravel())
        if generation % NOISE_GENERATIONS == NOISE_GENERATIONS - 1:
            active = _without_noise(active)
        if np.count_nonzero(active.slow) > MOST_KNOTS and (generation >= KNOT_GENERATIONS or len(active.low) > MOST_STRETCHES):
            raise InputError(
                f"the coefficients are not smooth at more than {MOST_KNOTS} points, from z = {active.low[active.slow].min():.6g} on: "
                "allowed are jumps and kinks at fewer, or at points that are given as knots=, as those of st.profile(z, values) are"
            )
        if len(active.low) > MOST_STRETCHES:  # smooth, but many periods of them
            break
    return _apart(np.sort(np.concatenate(found)), low, high)


def hair(z: Any, span: float) -> Any:
    """A few roundings of z, on a line of this length."""
    return KNOT_HAIR * EPSILON * np.maximum(np.abs(z), NEAR_ORIGIN * span)


def pair(knot: float, span: float, offset: float = 0.0) -> tuple[float, float]:
    """Points on either side of a knot, on a line of this length: a step between them is too short to err.

    offset is a number that z is computed from, and rounds as.
    """
    off = float(hair(max(abs(knot), abs(offset)), span))
    return knot - off, knot + off


def with_pairs(nodes: Reals, pairs: Reals) -> Reals:
    """The nodes (N,), rising or falling, with those of all pairs (M, 2) that lie inside, and without others next to them."""
    low, high = sorted((float(nodes[0]), float(nodes[-1])))
    inside = pairs[(pairs.min(axis=1) > low) & (pairs.max(axis=1) < high)].ravel()
    near = np.abs(nodes[:, None] - inside[None]).min(axis=1, initial=np.inf) < PAIR_SPACE * (high - low)
    near[[0, -1]] = False
    out = np.unique(np.concatenate((nodes[~near], inside)))
    return np.asarray(out if nodes[-1] > nodes[0] else out[::-1])


def _roots(coefficients: CoefficientFunction, ends: Reals) -> _Intervals:
    """The intervals to begin with that are not resolved, FIRST_INTERVALS in all or two between each pair of ends if that is more."""
    lengths = np.diff(ends)
    counts = np.maximum(2, np.ceil(FIRST_INTERVALS * lengths / lengths.sum())).astype(int)
    cuts = [a + (b - a) * np.arange(n) / n for a, b, n in zip(ends[:-1], ends[1:], counts, strict=True)]
    # inner cuts off the middle by the same share
    low = np.concatenate([np.concatenate((c[:1], c[1:] + (INTERVAL_CUT - 0.5) * (c[1] - c[0]))) for c in cuts])
    high = np.append(low[1:], ends[-1])
    values = _values(coefficients, low, high)
    local = np.abs(values).max(axis=1)
    rounding = EPSILON / RESIDUAL_RESOLVED * local.max(axis=0)
    size = np.maximum(np.maximum(local, LARGEST_ROUNDINGS * rounding), EPSILON * local.max(initial=0.0))
    at = low + INTERVAL_CUT * (high - low)
    noise = np.abs(RESIDUAL_OPERATOR @ _values(coefficients, at, at + NOISE_INTERVAL * (high - low))).max(axis=1)
    around = np.maximum(noise, np.maximum(np.roll(noise, 1, axis=0), np.roll(noise, -1, axis=0)))
    size = np.maximum(size, NOISE_FACTOR / RESIDUAL_RESOLVED * around)
    residual = _residuals(coefficients, low, high, size)
    return _Intervals(low, high, size, residual, np.full(len(low), np.inf), np.zeros(len(low), dtype=bool), np.arange(len(low))).where(
        residual > RESIDUAL_RESOLVED
    )


def _halves(coefficients: CoefficientFunction, parents: _Intervals) -> _Intervals:
    """Both parts of every interval, in turn."""
    middle = parents.low + INTERVAL_CUT * (parents.high - parents.low)
    low, high = np.column_stack((parents.low, middle)).ravel(), np.column_stack((middle, parents.high)).ravel()
    size = np.repeat(parents.size, 2, axis=0)
    residual = _residuals(coefficients, low, high, size) if len(low) else np.zeros(0)
    before, slow = np.repeat(parents.residual, 2), residual * KNOT_FALL > np.repeat(parents.before, 2)
    return _Intervals(low, high, size, residual, before, slow, np.repeat(parents.ancestor, 2))


def _without_noise(active: _Intervals) -> _Intervals:
    """The intervals of which a part is smooth, or whose residual is no noise; from here on each is an ancestor of its own."""
    _, family, members = np.unique(active.ancestor, return_inverse=True, return_counts=True)
    largest = np.zeros(len(members))
    np.maximum.at(largest, family, active.residual)
    kept = active.where(~((members == 2**NOISE_GENERATIONS) & (largest < NOISE_RESIDUAL))[family])
    return replace(kept, ancestor=np.arange(len(kept.low)))


def _values(coefficients: CoefficientFunction, low: Reals, high: Reals) -> ComplexArray:
    """The coefficients at Chebyshev's points of intervals: (m, KNOT_POINTS, entries)."""
    z = 0.5 * (low + high)[:, None] + 0.5 * (high - low)[:, None] * PIECE_ABSCISSAE
    return coefficients(z.ravel()).reshape(len(low), KNOT_POINTS, -1)


def _residuals(coefficients: CoefficientFunction, low: Reals, high: Reals, size: Reals) -> Reals:
    """The largest residual over the entries of the fit by a polynomial, each in its size.

    What is no larger than a rounding of z makes it, where the entry is steep, counts as resolved.
    """
    values = _values(coefficients, low, high)
    rounding = ARGUMENT_ROUNDINGS * EPSILON * np.maximum(np.abs(low), np.abs(high)) / (high - low)
    unknown = rounding[:, None] * np.abs(values[:, -1] - values[:, 0])
    with np.errstate(invalid="ignore", divide="ignore"):
        off = np.abs(RESIDUAL_OPERATOR @ values).max(axis=1)
        relative = np.where(off > unknown, off, np.minimum(off, RESIDUAL_RESOLVED * size)) / size
    return np.asarray(np.where(size > 0.0, relative, 0.0).max(axis=1, initial=0.0))


def _bisected(coefficients: CoefficientFunction, span: float, low: float, high: float, size: Reals) -> Reals:
    """Where the coefficients jump (1,) between two points that are some hairs apart."""
    while (middle := 0.5 * (low + high)) not in (low, high) and high - low > BISECTED * hair(middle, span):
        at = coefficients(np.array([low, middle, high]))
        with np.errstate(invalid="ignore", divide="ignore"):
            left, right = (np.where(size > 0.0, np.abs(at[i + 1] - at[i]) / size, 0.0).max() for i in (0, 1))
        low, high = (low, middle) if left > right else (middle, high)
    return np.array([high])


def _between_fits(coefficients: CoefficientFunction, ends: Reals, low: float, high: float, size: Reals) -> Reals:
    """Where polynomials that fit the coefficients on either side of an interval take turns (1,); its middle where none do.

    A jump of the p-th derivative is seen in the residual of a fit when it is a part of what the coefficients are off if the wrong one of
    the two is taken: stages of a step take either.
    """
    length = high - low
    for lengths in FIT_LENGTHS:
        from_, to = np.array([low - lengths * length, high]), np.array([low, high + lengths * length])
        inside = from_[0] >= ends[0] and to[1] <= ends[-1]
        if inside and (_residuals(coefficients, from_, to, size[None]) <= RESIDUAL_RESOLVED).all():
            break
    else:
        return np.array([0.5 * (low + high)])
    left, right = FIT_OPERATOR @ _values(coefficients, from_, to)
    for _ in range(MOST_GENERATIONS):
        middle = 0.5 * (low + high)
        at = coefficients(np.array([middle]))[0]
        off = []
        for fit, a, b in zip((left, right), from_, to, strict=True):
            value = np.polynomial.chebyshev.chebval((2.0 * middle - a - b) / (b - a), fit)
            with np.errstate(invalid="ignore", divide="ignore"):
                off.append(float(np.where(size > 0.0, np.abs(at - value) / size, 0.0).max()))
        if max(off) <= FIT_ROUNDINGS * EPSILON or middle in (low, high):
            break
        low, high = (middle, high) if off[0] < off[1] else (low, middle)
    return np.array([0.5 * (low + high)])


def _require_smooth_beside(coefficients: CoefficientFunction, at: _Intervals, ends: Reals) -> None:
    """Raise InputError where coefficients go with a power of the distance beside a knot: their residual does with that of the length."""
    length = at.high - at.low
    for side, edge in ((-1.0, at.low), (1.0, at.high)):
        farthest = edge + side * BESIDE_KNOT[-1] * length
        inside = (farthest > ends[0]) & (farthest < ends[-1]) & (at.low > ends[0]) & (at.high < ends[-1])
        if not inside.any():
            continue
        residuals = []
        for lengths in BESIDE_KNOT:
            other = edge + side * lengths * length
            low, high = np.minimum(edge, other)[inside], np.maximum(edge, other)[inside]
            residuals.append(_residuals(coefficients, low, high, at.size[inside]))
        falls = np.array(residuals[1:]) / np.maximum(residuals[:-1], RESIDUAL_RESOLVED)
        rough = (
            (residuals[0] > RESIDUAL_RESOLVED)
            & ((falls > LAYER_FALL) & (falls < POWER_FALL)).all(axis=0)
            & (falls.max(axis=0) < FALLS_ALIKE * falls.min(axis=0))
        )
        if rough.any():
            place = float(edge[inside][rough][0])
            raise InputError(
                f"the coefficients are not analytic on the {'left' if side < 0 else 'right'} of z = {place:.6g} up to it: "
                "allowed are jumps and kinks between functions that are, or an end there (st.Wall, or st.Axis of equations)"
            )


def _apart(knots: Reals, low: float, high: float) -> Reals:
    """The knots without those at the ends, and without those that are next to another."""
    kept: list[float] = []
    for knot in knots.tolist():
        off = 4 * float(hair(knot, high - low))
        if low + off < knot < high - off and (not kept or knot - kept[-1] > off):
            kept.append(knot)
    return np.array(kept)


def _residual_operator() -> Reals:
    basis = np.linalg.qr(np.polynomial.chebyshev.chebvander(PIECE_ABSCISSAE, KNOT_DEGREE))[0]
    return np.asarray(np.eye(KNOT_POINTS) - basis @ basis.T)


PIECE_ABSCISSAE: Reals = -np.cos(np.pi * np.arange(KNOT_POINTS) / (KNOT_POINTS - 1))  # ends included: a jump next to one is seen
FIT_OPERATOR: Reals = np.asarray(np.linalg.pinv(np.polynomial.chebyshev.chebvander(PIECE_ABSCISSAE, KNOT_DEGREE)), dtype=np.float64)
RESIDUAL_OPERATOR = _residual_operator()


def as_knots(knots: ArrayLike, low: float, high: float) -> tuple[float, ...]:
    """The knots (k,), points between the ends low and high, rising, each once. Raises InputError for what is none."""
    try:
        at = np.unique(np.asarray(knots, dtype=np.float64).ravel())
    except (ValueError, TypeError) as error:
        raise InputError(f"knots = {knots!r} are no numbers ({error}): allowed are points of the line") from None
    outside = at[~(np.isfinite(at) & (at > low) & (at < high))]
    if len(outside):
        raise InputError(f"a knot lies at z = {outside[0]:g}: allowed are points between the ends, {low:g} and {high:g}")
    return tuple(at.tolist())
