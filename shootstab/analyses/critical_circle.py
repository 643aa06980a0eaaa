"""Functions of a mode, or of two, on a small circle of complex α, and their derivatives by it.

Analytic in α are a mode σ, and of two modes that may meet their mean m and Δ = ((σ₁ − σ₂)/2)², which is analytic where they meet too.
σ^(m)/m! = (1/N r^m) Σ_j σ(α + r ω^j) ω^{−jm} is exact to rounding over r^m: no difference that cancels.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shootstab.analyses.refine import refine
from shootstab.analyses.sweep.following import FollowedMode, land
from shootstab.analyses.zeros import zeros_in
from shootstab.core.errors import ConvergenceError
from shootstab.core.records import Mode
from shootstab.core.regions import Disc
from shootstab.discriminants.continuation import Continuation
from shootstab.discriminants.frame import Frame
from shootstab.problems.protocol import Problem

ALPHA_POINTS = 12  # chosen: points on a circle in α, whose Fourier coefficients are σ and its first two α-derivatives
ROUGH_POINTS = 8  # chosen: points of one on the way; what they leave out of σ′ is of the order 0.05^8
COARSE_POINTS = 5  # chosen: points of one that a long step is made with
ALPHA_RADIUS = 0.05  # chosen: radius of that circle; what the points leave out of σ′ is of the order 0.05^12
WAY_OUT = (0.25, 0.5)  # chosen: places on the way from the middle, in that radius, so that no mode is guessed
NOT_ANALYTIC = 1e-2  # chosen: part of σ's change over the radius by which its mean on the circle may miss σ in the middle
ERRORS_OF_MEAN = 1e2  # chosen: error bounds of a mode by which the mean on the circle may miss σ in the middle
ROUGH_RTOL = 1e-9  # chosen: relative accuracy of the modes on the way
COARSE_RTOL = 1e-6  # chosen: relative accuracy of the modes of long steps; a slope in R is then known to 1e-3
LANDED = 10.0  # chosen: the error of a mode that Newton's iteration came to, in the local errors of its mesh
PARTNERS = (1.5, 6.0)  # chosen: circles in which the mode that another one may meet is looked for, in the distance over which D is linear
PARTNER_RTOL = 1e-6  # chosen: the local error with which it is

ProblemsOverAlpha = Callable[[float, complex], Problem]
FollowedValues = tuple[complex, ...]


@dataclass(frozen=True)
class CircleSeries:
    """Taylor coefficients (3,) of what is followed at α; sigma is the mode there, or the mean of two; values are where the next circle
    begins; error is the largest of what is followed, and sigma_error that of the modes."""

    terms: NDArray[np.complex128]
    sigma: complex
    values: FollowedValues
    error: float
    sigma_error: float


def mode_on_circle(family: ProblemsOverAlpha, reynolds: float, alpha: float, begin: FollowedValues, rtol: float) -> CircleSeries:
    """One mode; begin holds a guess of it. Raises ConvergenceError where it is lost, or is no one analytic function around α."""

    def one(point: complex, guesses: FollowedValues) -> tuple[FollowedValues, float, float]:
        sigma, error, _ = _mode(family(reynolds, point), guesses[0], rtol, reynolds, point)
        return (sigma,), error, error

    return _on_circle(one, reynolds, alpha, begin, rtol)


def pair_on_circle(family: ProblemsOverAlpha, reynolds: float, alpha: float, begin: FollowedValues, rtol: float) -> CircleSeries:
    """Two modes that may meet; begin holds their m and Δ. Raises ConvergenceError where they are lost."""

    def two(point: complex, guesses: FollowedValues) -> tuple[FollowedValues, float, float]:
        problem = family(reynolds, point)
        mean, half = guesses[0], cmath.sqrt(guesses[1])
        first, error, several = _mode(problem, mean + half, rtol, reynolds, point)
        if several > 1:
            return (first, 0j), error * error, error
        second, other, _ = _mode(problem, 2 * mean - first, rtol, reynolds, point)
        error = max(error, other)
        if abs(first - second) <= 2 * error:  # the mean is not foreseen so well: D itself says how far the other one is
            near = refine(problem, first, rtol)
            found = [zero.sigma for zero in beside(problem, first, PARTNERS[0] * near.scale)] if math.isfinite(near.scale) else []
            if not found:
                raise ConvergenceError(f"the two modes near {mean:.6g} are not told apart at {reynolds:.6g}, {point:.6g}")
            second, other, _ = _mode(problem, found[0], rtol, reynolds, point)
        off = (first - second) / 2
        return ((first + second) / 2, off * off), abs(off) * 2 * error + error * error, error

    return _on_circle(two, reynolds, alpha, begin, rtol)


def beside(problem: Problem, sigma: complex, radius: float) -> list[Mode]:
    """The other modes within the radius, as zeros, the nearest first."""
    zeros = zeros_in(Continuation(problem, Frame(rtol=PARTNER_RTOL)), Disc(sigma, radius)).modes
    nearest = sorted(zeros, key=lambda zero: abs(zero.sigma - sigma))
    return list(nearest[1:])  # type: ignore[arg-type]


def _mode(problem: Problem, guess: complex, rtol: float, reynolds: float, alpha: complex) -> tuple[complex, float, int]:
    """The mode, its error and its multiplicity; on the way, with a rough rtol, it is where Newton's iteration lands from near by."""
    if rtol >= ROUGH_RTOL:
        found = land(Continuation(problem, Frame(rtol=rtol)).along(guess)[0], guess, -math.inf)
        if found is not None:
            return found, LANDED * rtol * abs(found), 1
    mode = refine(problem, guess, rtol)
    if not math.isfinite(mode.error):
        raise ConvergenceError(f"the mode is lost at reynolds = {reynolds:.6g}, alpha = {alpha:.6g}: {mode.status}")
    return complex(mode.sigma), float(mode.error), mode.multiplicity


def _on_circle(
    evaluate: Callable[[complex, FollowedValues], tuple[FollowedValues, float, float]],
    reynolds: float,
    alpha: float,
    begin: FollowedValues,
    rtol: float,
) -> CircleSeries:
    """The guesses are for α itself; from there on every value is foreseen by the polynomial through those before."""
    radius, count = ALPHA_RADIUS * alpha, _points(rtol)
    turns = np.exp(2j * np.pi * np.arange(count) / count)
    ways = [FollowedMode() for _ in begin]  # followed in the complex plane of α
    error = sigma_error = 0.0
    for place in [0.0, *WAY_OUT, *turns.tolist()]:
        guesses = tuple(way.predicted(place) if way.places else guess for way, guess in zip(ways, begin, strict=True))
        values, own, of_sigma = evaluate(alpha + radius * place, guesses)
        error, sigma_error = max(error, own), max(sigma_error, of_sigma)
        for way, value in zip(ways, values, strict=True):
            way.add(place, value)
    found = [np.fft.fft(way.sigmas[-count:]) / count for way in ways]
    _require_analytic(found[-1], ways[-1], error, reynolds, alpha)
    return CircleSeries(found[-1][:3] / radius ** np.arange(3), complex(found[0][0]), _middle(found), error, sigma_error)


def _points(rtol: float) -> int:
    return COARSE_POINTS if rtol >= COARSE_RTOL else ROUGH_POINTS if rtol >= ROUGH_RTOL else ALPHA_POINTS


def _middle(found: Sequence[NDArray[np.complex128]]) -> FollowedValues:
    return tuple(complex(coefficients[0]) for coefficients in found)


def _require_analytic(coefficients: NDArray[np.complex128], way: FollowedMode, error: float, reynolds: float, alpha: float) -> None:
    """Raise ConvergenceError where values on the circle are none of one analytic function.

    σ^(m) r^m/m! of an analytic function are small for the middle orders, and the 0th is σ(α) itself, which was computed too.
    """
    left, whole = abs(coefficients[0] - way.sigmas[0]), float(np.abs(coefficients[1:3]).max())
    if left > max(NOT_ANALYTIC * whole, ERRORS_OF_MEAN * error):
        raise ConvergenceError(
            f"the mode {way.sigmas[0]:.6g} is not followed around alpha = {alpha:.6g} at reynolds = {reynolds:.6g}: "
            f"another one, or a branch point, is as near as the circle of {ALPHA_RADIUS:.0%} of alpha; "
            "allowed is a guess nearer to the critical point"
        )
