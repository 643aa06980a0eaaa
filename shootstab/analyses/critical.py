"""The critical point of a family of problems: where, over all wavenumbers, the first mode begins to grow.

The growth rate g = Re σ(R, α) and its slope ∂g/∂α vanish there. σ is analytic in α, so that its derivatives at a real α are sums over a
small circle of complex ones, σ^(m)/m! = (1/N r^m) Σ_j σ(α + r ω^j) ω^{−jm}, exact to rounding over r^m: no difference that cancels.
Newton's iteration on (g, ∂g/∂α) then has g_α, g_αα and, from a second circle, g_R and g_αR.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from shootstab.analyses.refine import refine
from shootstab.analyses.sweep.following import FollowedMode
from shootstab.core.errors import ConvergenceError, InputError
from shootstab.problems.protocol import Problem

ALPHA_POINTS = 12  # chosen: points on a circle in α, whose Fourier coefficients are σ and its first two α-derivatives
ALPHA_RADIUS = 0.05  # chosen: radius of that circle; what the points leave out of σ′ is of the order 0.05^12
WAY_OUT = (0.25, 0.5)  # chosen: places on the way from the middle, in that radius, so that no mode is guessed
NOT_ANALYTIC = 1e-2  # chosen: part of σ's change over the radius by which its mean on the circle may miss σ in the middle
SHIFT = 1e-3  # chosen: relative change of R for the second circle
CRITICAL_STEPS = 16  # chosen: steps of Newton in (α, R); from a guess of two digits it takes some 5
LONGEST_CRITICAL_MOVE = 0.5  # chosen: the part of R, and of α, by which a step changes it at most: both stay above 0
SHORT_ENOUGH_FOR_A_CHORD = 0.05  # chosen: steps below so much keep the slopes in R; longer ones have them computed anew
ROUGH_RTOL = 1e-9  # chosen: relative accuracy of the modes on the way
CRITICAL_RTOL = 1e-12  # chosen: accuracy of the modes
STILL_ROUGH = 1e3  # chosen: steps above so many accuracies are made with modes that are rough
LAST_MOVE = 1e2  # chosen: the last step, in accuracies
ERRORS_OF_MEAN = 1e2  # chosen: error bounds of a mode by which the mean on the circle may miss σ in the middle


@dataclass(frozen=True)
class Critical:
    """R_c, α_c and the mode there, with bounds on the errors of both."""

    reynolds: float
    alpha: float
    sigma: complex
    reynolds_error: float
    alpha_error: float


def critical(
    family: Callable[[float, complex], Problem], reynolds: float, alpha: float, guess: complex, rtol: float = CRITICAL_RTOL
) -> Critical:
    """The critical point next to (reynolds, alpha), following the mode next to guess.

    family(R, α) makes the problem; α comes complex, and R may be any parameter that growth rises with. Raises ConvergenceError where
    Newton's iteration does not settle or a mode is lost on the way, and where growth is least there.
    """
    if not (reynolds > 0.0 and alpha > 0.0):
        raise InputError(f"reynolds = {reynolds!r}, alpha = {alpha!r}: allowed are numbers above 0, near the critical point")
    sigma = complex(guess)
    step, change_R = math.inf, np.zeros(2)
    for turn in range(CRITICAL_STEPS):
        rough = max(rtol, ROUGH_RTOL) if step > STILL_ROUGH * rtol else rtol
        series, error = _circle(family, reynolds, alpha, sigma, rough)
        sigma, g = complex(series[0]), series.real
        if turn < 2 or step > SHORT_ENOUGH_FOR_A_CHORD:  # a chord does from then on
            ahead, _ = _circle(family, reynolds * (1 + SHIFT), alpha, sigma, rough)
            change_R = (ahead.real - g)[:2] / (reynolds * SHIFT)
        jacobian = np.array([[change_R[0], g[1]], [change_R[1], 2 * g[2]]])
        move = np.linalg.solve(jacobian, -g[:2])
        move = move * min(
            1.0, LONGEST_CRITICAL_MOVE / max(abs(float(move[0])) / reynolds, abs(float(move[1])) / alpha, LONGEST_CRITICAL_MOVE)
        )
        reynolds, alpha = reynolds + float(move[0]), alpha + float(move[1])
        step = abs(float(move[0])) / reynolds + abs(float(move[1])) / alpha
        if rough == rtol and step < LAST_MOVE * rtol:
            if g[2] >= 0.0:
                told = f"at {reynolds:.6g}, {alpha:.6g} the growth rate is 0, and least over the second"
                raise ConvergenceError(f"{told}, not largest: no mode begins to grow there")
            wrong = np.abs(np.linalg.inv(jacobian)) @ np.array([error, error / (ALPHA_RADIUS * alpha)]) + np.abs(move)
            return Critical(reynolds, alpha, sigma, float(wrong[0]), float(wrong[1]))
    raise ConvergenceError(f"no critical point found near {reynolds:.6g}, {alpha:.6g}: the last step was {step:.1e}")


def _circle(
    family: Callable[[float, complex], Problem], reynolds: float, alpha: float, guess: complex, rtol: float
) -> tuple[np.ndarray, float]:
    """σ^(m)/m! for m = 0, 1, 2 at a real α, and the largest error of the modes around it.

    The guess means a mode at α itself; from there on every one is foreseen by the polynomial through those before. Raises ConvergenceError
    where a mode is lost, or those around the circle are not values of one analytic function.
    """
    radius = ALPHA_RADIUS * alpha
    turns = np.exp(2j * np.pi * np.arange(ALPHA_POINTS) / ALPHA_POINTS)
    way = FollowedMode()  # a mode followed in the complex plane of α
    error = 0.0
    for place in [0.0, *WAY_OUT, *turns.tolist()]:
        point = alpha + radius * place
        mode = refine(family(reynolds, point), way.predicted(place) if way.places else guess, rtol)
        if not math.isfinite(mode.error):
            raise ConvergenceError(f"the mode is lost at reynolds = {reynolds:.6g}, alpha = {point:.6g}: {mode.status}")
        error = max(error, float(mode.error))
        way.add(place, complex(mode.sigma))
    coefficients = np.fft.fft(way.sigmas[-ALPHA_POINTS:]) / ALPHA_POINTS
    # σ^(m) r^m/m! of an analytic function: those of the middle order are small, and the 0th is σ(α) itself, which was computed too
    left, whole = abs(coefficients[0] - way.sigmas[0]), float(np.abs(coefficients[1:3]).max())
    if left > max(NOT_ANALYTIC * whole, ERRORS_OF_MEAN * error):
        raise ConvergenceError(
            f"the mode {way.sigmas[0]:.6g} is not followed around alpha = {alpha:.6g} at reynolds = {reynolds:.6g}: "
            f"another one, or a branch point, is as near as the circle of {ALPHA_RADIUS:.0%} of alpha; "
            "allowed is a guess nearer to the critical point"
        )
    m = np.arange(3)
    return coefficients[:3] / radius**m, error
