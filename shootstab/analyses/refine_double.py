"""One mode in double precision, with an error bound made of named parts and the proof that it is one."""

from __future__ import annotations

import cmath
import math
import time
from dataclasses import is_dataclass, replace
from typing import Any

from shootstab.analyses.error_budget import budget
from shootstab.analyses.multiple import multiple
from shootstab.core.discriminant import Discriminant
from shootstab.core.errors import ConvergenceError, InputError
from shootstab.core.records import CONVERGED, Budget, Mode
from shootstab.core.regions import Disc
from shootstab.discriminants.continuation import Continuation
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.method import Method
from shootstab.problems.protocol import Problem
from shootstab.roots.iterations import Root, muller, newton
from shootstab.roots.winding import wind

TIGHTEST = 1e-13  # the local error below which rounding takes over
LOOSEST = 1e-5
ATTEMPTS = 3
PROOF = 32.0  # the circle of the proof, in error bounds: the noise of D must be small on it
WIDEST_PROOF = 1e-2  # of |σ|
SIXTHS = 6  # a zero in its middle turns D by 60° from one sixth of a circle to the next, which is short enough
NEAR_ENOUGH = 1e-6  # relative step to the zero on the finer mesh, beyond which one step of Newton does not reach it
UNKNOWN = Budget(math.inf, math.inf, math.inf, math.inf, math.inf)


def refine_double(problem: Problem, guess: Any, rtol: float = 1e-10, method: Method | None = None) -> Mode:
    """The mode next to guess in double precision, with |true − sigma| ≤ error and error ≤ rtol·|sigma| if its status is 'converged'.

    method defaults to orthonormalized shooting with a tolerance chosen from rtol; where the bound misses rtol, any method is tried again
    with a smaller one. Raises InputError for a guess that is not finite and an rtol outside 1e−14 to 1.
    """
    began = time.perf_counter()
    guess = finite(guess)
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


def finite(guess: Any) -> complex:
    """The guess as a complex number. Raises InputError where it is not finite."""
    number = complex(guess)
    if not cmath.isfinite(number):
        raise InputError(f"guess = {number}: allowed is a finite number")
    return number


def _attempt(problem: Problem, guess: complex, rtol: float, method: Method) -> tuple[Mode, int]:
    """One search with one tolerance; the number of evaluations is returned beside the mode."""
    continuation = Continuation(problem, method)
    discriminant, _ = continuation.along(guess)
    try:
        root = find_near(discriminant, guess, 1e-3 * rtol)
        mode, evaluations = examine(continuation, root, rtol)
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


def find_near(discriminant: Discriminant, guess: complex, tolerance: float) -> Root:
    """Newton from the guess; Muller if that fails.

    Raises ConvergenceError if both do.
    """
    for iteration in (newton, muller):
        root = iteration(discriminant, guess, tolerance)
        if root.converged:
            return root
    raise ConvergenceError(f"neither Newton nor Muller arrives anywhere from {guess:.6g}; the last step was {root.step:.1e}")


def examine(continuation: Continuation, root: Root, rtol: float) -> tuple[Mode, int]:
    """What a root is worth: the zero on a finer mesh along the path that suits it, its error bound, and the proof that it is one.

    Returned beside the mode is how often D was evaluated for it.
    """
    branch = continuation.at(root.sigma)
    coarse = branch.discriminant
    before = coarse.evaluations
    arrived = newton(coarse, root.sigma, 1e-3 * rtol)
    if not arrived.converged:
        raise ConvergenceError(f"the iteration does not settle at {root.sigma:.6g} along the path {branch.path}")
    fine = coarse.refined()
    coarse_value, fine_value = coarse.with_derivative(arrived.sigma), fine.with_derivative(arrived.sigma)
    if abs(fine_value.newton_step) > NEAR_ENOUGH * abs(arrived.sigma):
        better = newton(fine, arrived.sigma, 1e-3 * rtol)
        coarse_value, fine_value = coarse.with_derivative(better.sigma), fine.with_derivative(better.sigma)
    sigma = fine_value.sigma + fine_value.newton_step
    size = abs(sigma)
    parts = budget(continuation.problem, coarse, coarse_value, fine, fine_value)
    # next to a multiple zero the bound means nothing, but there is a circle that tells
    radius = min(max(PROOF * parts.total, 1e-2 * rtol * size), WIDEST_PROOF * size)
    count = wind(coarse, Disc(sigma, radius), SIXTHS).count
    if count > 1:
        mode = multiple(continuation, sigma, count, radius, rtol)
    else:
        distance = continuation.distance(sigma)
        status = _status(count, radius, sigma, parts.total, distance, rtol)
        mode = Mode(sigma, parts.total, parts, status, continuation.method.name, 0, 0.0, distance, branch.path)
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
