"""One mode to the accuracy asked for, with an error bound made of named parts."""

from __future__ import annotations

import cmath
import math
import time
from collections.abc import Callable
from dataclasses import is_dataclass, replace
from typing import Any

from shootstab.discriminants.atlas import Atlas
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.protocol import Examinable, Method
from shootstab.problems.protocol import Problem
from shootstab.questions.bounds import budget
from shootstab.questions.multiple import multiple
from shootstab.roots.iterations import Root, muller, newton
from shootstab.roots.winding import wind
from shootstab.vocabulary.errors import ConvergenceError, InputError
from shootstab.vocabulary.records import CONVERGED, Budget, Mode
from shootstab.vocabulary.regions import Disc

DOUBLE_DIGITS = 12  # more are computed with many digits
TIGHTEST = 1e-13  # the local error below which rounding takes over
LOOSEST = 1e-5
ATTEMPTS = 3
PROOF = 32.0  # the circle of the proof, in error bounds: the noise of D must be small on it
WIDEST_PROOF = 1e-2  # of |σ|
SIXTHS = 6  # a zero in its middle turns D by 60° from one sixth of a circle to the next, which is short enough
NEAR_ENOUGH = 1e-6  # relative step to the zero on the finer mesh, beyond which one step of Newton does not reach it
UNKNOWN = Budget(math.inf, math.inf, math.inf, math.inf, math.inf)


def refine(
    problem: Problem,
    guess: Any,
    rtol: float = 1e-10,
    digits: int | None = None,
    method: Method | None = None,
    progress: Callable[[int, int, float], None] | None = None,
) -> Mode:
    """The mode next to guess, with |true − sigma| ≤ error and error ≤ rtol·|sigma| if its status is 'converged'.

    digits=N stands for rtol = 10^−N; above 12 everything is computed with many digits (see precise.py), sigma is an mpmath number, and
    progress(done, total, seconds left) is told how far it is. method defaults to orthonormalized shooting with a tolerance chosen from
    rtol; where the bound misses rtol, any method is tried again with a smaller one. The iteration finds the mode, the argument principle
    proves that there is one: a failed search is a Mode whose status says why.
    """
    began = time.perf_counter()
    guess = complex(guess)
    if not cmath.isfinite(guess):
        raise InputError(f"guess = {guess}: allowed is a finite number")
    if digits is not None:
        if digits < 1:
            raise InputError(f"digits = {digits}: allowed is 1 or more")
        if digits > DOUBLE_DIGITS:
            if method is not None:
                raise InputError(f"method {method.name!r}: allowed up to {DOUBLE_DIGITS} digits, more come from Taylor series")
            from shootstab.questions.precise import refine_digits

            return refine_digits(problem, guess, digits, progress)
        rtol = 10.0**-digits
    if not 1e-14 <= rtol < 1.0:
        raise InputError(f"rtol = {rtol!r}: allowed is a number from 1e-14 to 1")
    tried: Method = method or Frame(rtol=tolerance_for(rtol))
    evaluations = 0
    for _ in range(ATTEMPTS):
        mode, count = _attempt(problem, guess, rtol, tried)
        evaluations += count
        tighter = tightened(tried)
        if mode.converged or tighter is None or not math.isfinite(mode.error):
            break
        tried = tighter
        guess = complex(mode.sigma)
    return Mode(**{**vars(mode), "evaluations": evaluations, "seconds": time.perf_counter() - began})


def _attempt(problem: Problem, guess: complex, rtol: float, method: Method) -> tuple[Mode, int]:
    """One search with one tolerance; the number of evaluations is returned beside the mode."""
    atlas = Atlas(problem, method)
    discriminant = atlas.at(guess).discriminant
    try:
        root = find_near(discriminant, guess, 1e-3 * rtol)
        mode, evaluations = examine(atlas, root, rtol)
    except ConvergenceError as error:
        return Mode(guess, math.inf, UNKNOWN, f"not converged: {error}", method.name, 0, 0.0), discriminant.evaluations
    return mode, evaluations + discriminant.evaluations


def tolerance_for(rtol: float) -> float:
    """The local error to begin with where a mode is wanted to rtol."""
    return min(max(0.1 * rtol, TIGHTEST), LOOSEST)


def tightened(method: Method) -> Method | None:
    """The method with a local error smaller by 100, or None where it has none or rounding takes over."""
    rtol = getattr(method, "rtol", None)
    if rtol is None or rtol <= TIGHTEST or not is_dataclass(method) or isinstance(method, type):
        return None
    return replace(method, rtol=max(1e-2 * rtol, TIGHTEST))


def find_near(discriminant: Examinable, guess: complex, tolerance: float) -> Root:
    """Newton from the guess; Muller if that fails.

    Raises ConvergenceError if both do.
    """
    for iteration in (newton, muller):
        root = iteration(discriminant, guess, tolerance)
        if root.converged:
            return root
    raise ConvergenceError(f"neither Newton nor Muller arrives anywhere from {guess:.6g}; the last step was {root.step:.1e}")


def examine(atlas: Atlas, root: Root, rtol: float) -> tuple[Mode, int]:
    """What a root is worth: the zero on a finer mesh along the path that suits it, its error bound, and the proof that it is one.

    Returned beside the mode is how often D was evaluated for it.
    """
    chart = atlas.at(root.sigma)
    coarse = chart.discriminant
    before = coarse.evaluations
    arrived = newton(coarse, root.sigma, 1e-3 * rtol)
    if not arrived.converged:
        raise ConvergenceError(f"the iteration does not settle at {root.sigma:.6g} along the path {chart.path}")
    fine = coarse.refined()
    coarse_value, fine_value = coarse.with_slope(arrived.sigma), fine.with_slope(arrived.sigma)
    if abs(fine_value.newton_step) > NEAR_ENOUGH * abs(arrived.sigma):
        better = newton(fine, arrived.sigma, 1e-3 * rtol)
        coarse_value, fine_value = coarse.with_slope(better.sigma), fine.with_slope(better.sigma)
    sigma = fine_value.sigma + fine_value.newton_step
    size = abs(sigma)
    parts = budget(atlas.problem, coarse, coarse_value, fine, fine_value)
    # next to a multiple zero the bound means nothing, but there is a circle that tells
    radius = min(max(PROOF * parts.total, 1e-2 * rtol * size), WIDEST_PROOF * size)
    count = wind(coarse, Disc(sigma, radius), SIXTHS).count
    if count > 1:
        mode = multiple(atlas, sigma, count, radius, rtol)
    else:
        distance = atlas.distance(sigma)
        status = _status(count, radius, sigma, parts.total, distance, rtol)
        mode = Mode(sigma, parts.total, parts, status, atlas.method.name, 0, 0.0, distance, chart.path)
    return replace(mode, system=coarse.system_at(sigma)), coarse.evaluations - before + fine.evaluations


def _status(count: int, radius: float, sigma: complex, error: float, distance: float, rtol: float) -> str:
    """What is to be said where so many zeros, one at most, were counted within the radius."""
    if not error < 0.5 * abs(sigma):
        return f"not converged: the error bound {error:.1e} is as large as the mode itself"
    if count == 0:
        return f"not converged: the iteration stopped at {sigma:.6g}, but no zero lies within {radius:.1e}"
    if distance <= error:
        return f"not converged: the continuous spectrum passes at {distance:.1e}, inside the error bound {error:.1e}"
    if error > rtol * abs(sigma):
        return f"not converged: the error bound {error:.1e} exceeds the {rtol * abs(sigma):.1e} asked for"
    return CONVERGED
