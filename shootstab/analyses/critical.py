"""The critical point of a family of problems: where, over all wavenumbers, the first mode begins to grow.

The growth rate g = Re σ(R, α) and its slope ∂g/∂α vanish there. σ is analytic in α, so that its derivatives at a real α are found on a
small circle of complex ones (critical_circle.py). Newton's iteration on (g, ∂g/∂α) then has g_α, g_αα and, from a second circle, g_R and
g_αR.

A mode that neither grows nor decays, as in a flow without friction, begins to grow where it meets another one: there Δ = ((σ₁ − σ₂)/2)²,
which is real and analytic, passes from below 0 to above, and the iteration is that on (Δ, ∂Δ/∂α). Two modes σ and −σ̄ beyond it have Δ > 0.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from shootstab.analyses.critical_circle import (
    ALPHA_RADIUS,
    COARSE_RTOL,
    ERRORS_OF_MEAN,
    PARTNERS,
    ROUGH_RTOL,
    CircleSeries,
    FollowedValues,
    ProblemsOverAlpha,
    beside,
    mode_on_circle,
    pair_on_circle,
)
from shootstab.analyses.refine import refine
from shootstab.core.errors import ConvergenceError, InputError

SHIFT = 1e-3  # chosen: relative change of R for the second circle
CRITICAL_STEPS = 16  # chosen: steps of Newton in (α, R); from a guess of two digits it takes some 5
LONGEST_CRITICAL_MOVE = 0.5  # chosen: the part of R, and of α, by which a step changes it at most: both stay above 0
MOST_LONGEST = 7  # chosen: steps in turn that are the longest before the search ends, some seconds of work
SHORT_ENOUGH_FOR_A_CHORD = 0.05  # chosen: steps below so much keep the slopes in R; longer ones have them computed anew
CRITICAL_RTOL = 1e-12  # chosen: accuracy of the modes
STILL_ROUGH = 1e3  # chosen: steps above so many accuracies are made with modes that are rough
LAST_MOVE = 1e2  # chosen: the last step, in accuracies

OnCircle = Callable[[ProblemsOverAlpha, float, float, FollowedValues, float], CircleSeries]


@dataclass(frozen=True)
class Critical:
    """R_c, α_c and the mode there, with bounds on the errors of both."""

    reynolds: float
    alpha: float
    sigma: complex
    reynolds_error: float
    alpha_error: float


class NeutralError(ConvergenceError):
    """The mode neither grows nor decays, whatever the parameters: sigma is the mode at the first of them."""

    def __init__(self, sigma: complex) -> None:
        super().__init__(f"the mode {sigma:.6g} neither grows nor decays near the first parameters, to its error")
        self.sigma = sigma


def critical(family: ProblemsOverAlpha, reynolds: float, alpha: float, guess: complex, rtol: float = CRITICAL_RTOL) -> Critical:
    """The critical point next to (reynolds, alpha), following the mode next to guess.

    family(R, α) makes the problem; α comes complex, and R may be any parameter that growth rises with. A mode that is neutral there is
    followed to where it meets the neutral one beside it, as is one that grows beside its mirror image; sigma is then their mean.

    Raises ConvergenceError where Newton's iteration does not settle or a mode is lost on the way, and where growth is least there.
    """
    if not (reynolds > 0.0 and alpha > 0.0):
        raise InputError(f"reynolds = {reynolds!r}, alpha = {alpha!r}: allowed are numbers above 0, near the critical point")
    mirrored = _mirrored(family, reynolds, alpha, complex(guess))
    if mirrored is not None:
        try:
            return _iterated(family, pair_on_circle, reynolds, alpha, mirrored, rtol)
        except ConvergenceError:
            pass  # they need not meet: one mode may be followed yet
    try:
        return _iterated(family, mode_on_circle, reynolds, alpha, (complex(guess),), rtol)
    except NeutralError as neutral:
        return _iterated(family, pair_on_circle, reynolds, alpha, _pair(family, reynolds, alpha, neutral.sigma), rtol)


def _iterated(
    family: ProblemsOverAlpha, on_circle: OnCircle, reynolds: float, alpha: float, values: FollowedValues, rtol: float
) -> Critical:
    """Newton's iteration on the real part of what is followed, and its slope over α."""
    step, change_R, longest, fine = math.inf, np.zeros(2), 0, False
    for turn in range(CRITICAL_STEPS):
        fine = fine or step <= STILL_ROUGH * rtol  # rough modes would lead elsewhere by more than that
        rough = rtol if fine else max(rtol, ROUGH_RTOL)
        if turn > 0 and step > SHORT_ENOUGH_FOR_A_CHORD:
            rough = max(rtol, COARSE_RTOL)
        here = on_circle(family, reynolds, alpha, values, rough)
        values, g = here.values, here.terms.real
        if turn < 2 or step > SHORT_ENOUGH_FOR_A_CHORD:  # a chord does from then on
            ahead = on_circle(family, reynolds * (1 + SHIFT), alpha, values, rough)
            if on_circle is mode_on_circle and _is_neutral(here, alpha) and _is_neutral(ahead, alpha):
                raise NeutralError(here.sigma)
            change_R = (ahead.terms.real - g)[:2] / (reynolds * SHIFT)
        jacobian = np.array([[change_R[0], g[1]], [change_R[1], 2 * g[2]]])
        try:
            move = np.linalg.solve(jacobian, -g[:2])
        except np.linalg.LinAlgError:
            raise ConvergenceError(f"at {reynolds:.6g}, {alpha:.6g} growth does not change with the parameters") from None
        whole = max(abs(float(move[0])) / reynolds, abs(float(move[1])) / alpha)
        move = move * min(1.0, LONGEST_CRITICAL_MOVE / max(whole, LONGEST_CRITICAL_MOVE))
        longest = longest + 1 if whole > LONGEST_CRITICAL_MOVE else 0
        if longest == MOST_LONGEST:
            raise ConvergenceError(
                f"no critical point found near {reynolds:.6g}, {alpha:.6g}: {longest} steps in turn would change a parameter by more than "
                f"half; the mode there is {here.sigma:.6g}; allowed are a guess and parameters nearer to a critical point"
            )
        reynolds, alpha = reynolds + float(move[0]), alpha + float(move[1])
        step = abs(float(move[0])) / reynolds + abs(float(move[1])) / alpha
        if rough == rtol and step < LAST_MOVE * rtol:
            if g[2] >= 0.0:
                told = f"at {reynolds:.6g}, {alpha:.6g} the growth rate is 0, and least over the second"
                raise ConvergenceError(f"{told}, not largest: no mode begins to grow there")
            wrong = np.abs(np.linalg.inv(jacobian)) @ np.array([here.error, here.error / (ALPHA_RADIUS * alpha)]) + np.abs(move)
            return Critical(reynolds, alpha, here.sigma, float(wrong[0]), float(wrong[1]))
    raise ConvergenceError(f"no critical point found near {reynolds:.6g}, {alpha:.6g}: the last step was {step:.1e}")


def _is_neutral(found: CircleSeries, alpha: float) -> bool:
    """Whether growth and its first two derivatives over α are 0 to the error with which they are known."""
    over = np.abs(found.terms.real) * (ALPHA_RADIUS * alpha) ** np.arange(3)
    return bool((over <= ERRORS_OF_MEAN * found.sigma_error).all())


def _mirrored(family: ProblemsOverAlpha, reynolds: float, alpha: float, guess: complex) -> FollowedValues | None:
    """The mean of a mode and its mirror image -conj σ, and their Δ, where both are modes and grow or decay; None otherwise."""
    problem = family(reynolds, complex(alpha))
    mode = refine(problem, guess, ROUGH_RTOL)
    sigma, noise = complex(mode.sigma), ERRORS_OF_MEAN * mode.error
    if not (mode.converged and abs(sigma.real) > noise):
        return None
    image = refine(problem, -sigma.conjugate(), ROUGH_RTOL)
    if not (image.converged and abs(image.sigma + sigma.conjugate()) <= noise):
        return None
    return 1j * sigma.imag, complex(sigma.real**2)


def _pair(family: ProblemsOverAlpha, reynolds: float, alpha: float, sigma: complex) -> FollowedValues:
    """The mean of a neutral mode and the neutral one nearest to it, and their Δ. Raises ConvergenceError where none is near."""
    problem = family(reynolds, complex(alpha))
    mode = refine(problem, sigma)
    others: list[complex] = []
    for factor in PARTNERS if math.isfinite(mode.scale) else ():
        near = [zero.sigma for zero in beside(problem, complex(mode.sigma), factor * mode.scale)]
        others = [other for other in near if abs(other.real) <= ERRORS_OF_MEAN * ROUGH_RTOL * abs(other)]
        if others:
            break
    if not others:
        raise ConvergenceError(
            f"the mode {sigma:.6g} neither grows nor decays near {reynolds:.6g}, {alpha:.6g}, to its error, and none that it may meet "
            f"is found within {PARTNERS[-1] * mode.scale:.2g}: growth may begin with another mode"
        )
    half = (complex(mode.sigma) - others[0]) / 2
    return (complex(mode.sigma) + others[0]) / 2, half * half
