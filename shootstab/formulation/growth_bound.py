"""A rectangle that holds every eigenvalue right of a floor, by the numerical range of the equations: found in doubles, proved in balls.

The half-planes Re(e^{−iθ} σ) ≤ b of numerical_range.py for θ = 0 and for directions on both sides of it, cut off at the floor. b is the
smallest number with which the form is positive at samples of z, widened; then a Cholesky decomposition in balls shows that it is positive
on every piece of the domain.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import InputError
from shootstab.core.regions import Rectangle
from shootstab.formulation.conditions import Conditions
from shootstab.formulation.domain import Domain
from shootstab.formulation.expression import Expression
from shootstab.formulation.gaussian import ONE, Gaussian
from shootstab.formulation.numerical_range import EnergyForm, energy_form, sampled
from shootstab.formulation.sesquilinear_form import Form
from shootstab.formulation.statement import Statement
from shootstab.formulation.system import Jet
from shootstab.formulation.system import coefficients as powers_of
from shootstab.problems.ends import Infinity

LEMMA = "P3"
DIRECTIONS = ((4, 3, 5), (3, 4, 5), (5, 12, 13), (7, 24, 25), (0, 1, 1))  # chosen: cos θ, sin θ as rational numbers, over the last one
SAMPLES = 65  # chosen: points at which the form is looked at for b
LARGEST_BOUND = 1e12  # chosen: a larger b is no bound to any purpose
SMALLEST_BOUND, NEXT_BOUND = 1e-6, 10.0  # chosen: the b that is tried first, and the factor to the next
BOUND_KNOWN = 1.01  # chosen: the ratio of two b, one too small, at which the larger is known well enough
WIDENED = 1.01  # chosen: b against that of the samples
PROOF_TRIES, WIDER = 6, 1.3  # chosen: how often b is widened where the proof fails, and by how much
RATIOS = (0.25, 4.0)  # chosen: steps with which weights of groups of equations are tried
SWEEPS = 4  # chosen: rounds of these trials
HALVINGS = 14  # chosen: halvings of the interval at most, for one piece of the proof
BITS = 80  # chosen: precision of the balls, half as many bits again as doubles have
SLIMMEST = 0.1  # chosen: the height of the rectangle in its width at least: a count beside real eigenvalues in a sliver is laborious
RECTANGLE_MARGIN = 1e-9  # chosen: how much wider than the bound the rectangle is, relative, far above the rounding of its corners


def growing_region(statement: Statement) -> Callable[..., tuple[Rectangle, str]] | None:
    """growing_region(floor) ↦ a rectangle with every σ of Re σ ≥ floor, and the lemma. None where no form bounds them.

    Offered between ends with conditions, or at infinity where coefficients come to their limits exponentially, for equations linear in the
    eigenvalue whose functions are formulas, finite and real on the domain; and with python-flint, which the proof needs.
    """
    if statement.domain.given or statement.joints or statement.denominators or not all(map(_told, (statement.left, statement.right))):
        return None
    try:
        return _region(statement)
    except InputError:
        return None  # a coefficient comes to no limit, or nothing is proved without python-flint


def _told(end: Any) -> bool:
    """Whether an end says that solutions obey conditions, or that they decay by what the coefficients come to and nothing else."""
    if isinstance(end, Infinity):
        return end.decaying is None and end.start is None and end.limit is None and end.expansion is None
    return isinstance(end, Conditions)


def _region(statement: Statement) -> Callable[..., tuple[Rectangle, str]] | None:
    """See `growing_region`. Raises InputError where something that it needs is not there."""
    from shootstab.formulation.ball_forms import real_everywhere

    coefficients = [c for row in statement.system.rows for held in row.values() for c in powers_of(held).values()]
    if not real_everywhere(coefficients, statement.domain, BITS, HALVINGS):
        return None
    right = _bound(statement, ONE)
    if right is None:
        return None
    sides: list[list[tuple[float, float, float]]] = [[], []]  # cos θ, sin θ, b, below and above
    for c, s, whole in DIRECTIONS:
        for side in (0, 1):
            found = _bound(statement, Gaussian(Fraction(c, whole), Fraction(s if side else -s, whole)))
            if found is not None:
                sides[side].append((c / whole, s / whole, found))
    if not all(sides):
        return None

    def region(floor: float, /, **varied: float) -> tuple[Rectangle, str]:
        if varied:
            raise InputError("the bound on growing modes is for one value of each parameter: name a --region for an interval of them")
        heights = [min((b - c * floor) / s for c, s, b in side) for side in sides]
        margin = RECTANGLE_MARGIN * max(*map(abs, heights), abs(right - floor))
        margin += 0.5 * max(0.0, SLIMMEST * (right - floor) - (heights[0] + heights[1]))
        low, high = sorted((-heights[0], heights[1]))  # where they cross, as where right < floor, there is nothing, and any sliver holds it
        return Rectangle(complex(floor, low - margin), complex(max(right, floor) + margin, high + margin)), LEMMA

    return region


def _bound(statement: Statement, direction: Gaussian) -> float | None:
    """b ≥ 0 with Re(σ conj(direction)) ≤ b for every eigenvalue; None where none is found or proved."""
    form = energy_form(statement, direction)
    if form is None:
        return None
    jets, domain = form.jets, statement.domain
    fractions = 0.5 - 0.5 * np.cos(np.pi * np.arange(SAMPLES) / (SAMPLES - 1))
    S, L = (np.array([sampled(part, jets, domain, fractions) for part in parts]) for parts in (form.weight, form.rotated))
    if not (np.isfinite(S).all() and np.isfinite(L).all()):
        return None
    weights, b = _lightest(S, L)
    for _ in range(PROOF_TRIES):
        if not b < LARGEST_BOUND:
            return None
        b = WIDENED * b
        if _proved(form, weights, b, domain):
            return b
        b = WIDER * b
    return None


def _lightest(S: NDArray[np.complex128], L: NDArray[np.complex128]) -> tuple[list[float], float]:
    """Weights of the groups, and about the smallest b with which the samples are positive; S and L are (groups, m, k, k)."""
    weights = np.ones(len(S))
    best = _smallest(weights, S, L)
    for _ in range(SWEEPS if len(S) > 1 else 0):
        before = best
        for i in range(1, len(S)):
            for ratio in RATIOS:
                trial = weights.copy()
                trial[i] *= ratio
                b = _smallest(trial, S, L)
                if b < best:
                    weights, best = trial, b
        if best == before:
            break
    return [float(w) for w in weights], best


def _smallest(weights: NDArray[np.float64], S: NDArray[np.complex128], L: NDArray[np.complex128]) -> float:
    """inf where none is below LARGEST_BOUND; to one part in a hundred."""
    s, form = np.tensordot(weights, S, 1), np.tensordot(weights, L, 1)

    def positive(b: float) -> bool:
        P = b * s - form
        size = np.sqrt(np.abs(np.diagonal(P, axis1=1, axis2=2)).max(axis=0))
        size[size == 0.0] = 1.0
        return bool(np.linalg.eigvalsh(P / size[:, None] / size[None, :]).min() > 0.0)

    high = SMALLEST_BOUND
    while not positive(high):
        high *= NEXT_BOUND
        if high > LARGEST_BOUND:
            return math.inf
    low = 1 / NEXT_BOUND * high
    while high > BOUND_KNOWN * low:
        middle = math.sqrt(low * high)
        low, high = (low, middle) if positive(middle) else (middle, high)
    return high


def _proved(form: EnergyForm, weights: Sequence[float], b: float, domain: Domain) -> bool:
    """Whether S > 0 in its own jets and b S − Re(e^{−iθ} L) > 0 at every z of the domain."""
    from shootstab.formulation.ball_forms import positive_everywhere

    free = [Expression({(): Gaussian.of(w)}) for w in weights]
    pairs = [(w, S, L) for w, S, L in zip(free, form.weight, form.rotated, strict=True)]
    S = _sum([(w, part) for w, part, _ in pairs])
    P = _sum([(w * Expression({(): Gaussian.of(b)}), part) for w, part, _ in pairs] + [(-w, part) for w, _, part in pairs])
    return positive_everywhere(S, domain, BITS, HALVINGS) and positive_everywhere(P, domain, BITS, HALVINGS)


def _sum(parts: Sequence[tuple[Expression, Form]]) -> Form:
    total: dict[tuple[Jet, Jet], Any] = {}
    for factor, form in parts:
        for at, c in form.items():
            total[at] = total[at] + factor * c if at in total else factor * c
    return total
