"""One mode in double precision, with an error bound made of named parts and the proof that it is one."""

from __future__ import annotations

import cmath
import math
import time
from dataclasses import is_dataclass, replace
from typing import Any

from shootstab.analyses.claim_size import has_a_size
from shootstab.analyses.error_budget import budget
from shootstab.analyses.multiple import cluster, multiple, told_apart
from shootstab.analyses.root_near import searches
from shootstab.core.allowed import DOUBLE_DIGITS, LARGEST_GUESS, LEAST_MODE_RTOL, RTOL
from shootstab.core.errors import ConvergenceError, Inaccurate, InputError, OnSpectrum
from shootstab.core.given import complex_of, require_real, require_rtol
from shootstab.core.records import CONVERGED, Budget, Mode
from shootstab.core.regions import Disc
from shootstab.core.scaled import EPSILON
from shootstab.discriminants.continuation import Branch, Continuation
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.method import Method
from shootstab.discriminants.recent import continuation_of
from shootstab.problems.protocol import Problem
from shootstab.roots.iterations import LEAST_D_ERROR, Root, newton
from shootstab.roots.search import Zero
from shootstab.roots.separation import SMALLEST_DISTANCE, neutral, separation, surroundings
from shootstab.roots.winding import count_around

TIGHTEST = 1e-13  # measured (validation/calibration.py): the local error below which rounding takes over
LOOSEST = 1e-5  # chosen: the largest local error with which halving the steps still tells the error
LOCAL_ERROR = 0.1  # chosen: the local error to begin with, in the accuracy of the mode; with the whole of it three modes in 2e-7 were lost
OF_LOCAL_ERRORS = 10.0  # chosen: a zero is off by so many local errors at most, in |σ|, where nothing has been measured yet
TIGHTENED = 1e-2  # chosen: the next local error, in the last one
CIRCLE_OF_PROOF = 1e-2  # chosen: the circle of the proof at least, in the accuracy asked for
DOUBLE_ATTEMPTS = 3  # chosen: local errors tried; from 1e-5 factors of 100 would need four; tolerance_for begins no mode that far off
PROOF = 32.0  # chosen: the circle of the proof, in error bounds; the noise of D must be small on it
WIDEST_PROOF = 1e-2  # chosen: the circle of the proof at most, in the larger of |σ| and the scale, so that it leaves other modes out
NO_ZERO = 1e-2  # chosen: Newton's step to a zero of D continued from one side, in that of D from the other, which has none there
LEFT = 1e-3  # chosen: what iterations may leave, in the accuracy asked for
NEUTRAL = 1e-12  # chosen: the accuracy of a mode at 0 in the scale of D there; four digits above the rounding of a double
UNKNOWN = Budget(math.inf, math.inf, math.inf, math.inf, math.inf)


def refine_double(problem: Problem, guess: Any, rtol: float = RTOL, method: Method | None = None, atol: float | None = None) -> Mode:
    """The mode next to guess in double precision, with |true − sigma| ≤ error ≤ max(rtol·|sigma|, atol) if its status is 'converged'.

    method defaults to orthonormalized shooting with a tolerance chosen from rtol; where the bound misses rtol, any method is tried again
    with a smaller one. atol defaults to min(rtol, 1e-12)·|2D′/D″|, in the scale over which D is linear at the mode: it is for modes next
    to 0, and counts only where the tolerance cannot be made smaller or |sigma| is below the error. Raises InputError for a guess that is
    not finite, an rtol outside 1e−14 to 1, and an atol that is not a finite number ≥ 0.
    """
    began = time.perf_counter()
    guess = near = finite(guess)
    require_rtol(rtol, LEAST_MODE_RTOL)
    require_atol(atol)
    tried: Method = method or Frame(rtol=tolerance_for(rtol))
    evaluations = 0
    for _ in range(DOUBLE_ATTEMPTS):
        mode, count, again = _attempt(problem, near, rtol, tried, atol)
        evaluations += count
        tighter = tightened(tried)
        relative = mode.error <= rtol * abs(mode.sigma)
        enough = mode.converged and (relative or atol is not None or abs(mode.sigma) <= mode.error)
        if enough or tighter is None or not again:
            break
        tried = tighter
        near = complex(mode.sigma)
    return replace(mode, evaluations=evaluations, seconds=time.perf_counter() - began, guess_distance=abs(mode.sigma - guess))


def require_atol(atol: float | None) -> None:
    """Raise InputError for an atol that is no finite number ≥ 0."""
    if atol is not None:
        require_real("atol", atol, lambda a: a >= 0.0, "a finite number from 0 on, in the units of sigma, or None")


def finite(guess: Any) -> complex:
    """The guess as a complex number. Raises InputError where it is not finite, or too large."""
    number = complex_of("guess", guess)
    if math.hypot(number.real, number.imag) > LARGEST_GUESS:
        raise InputError(f"guess = {number:.6g}: allowed is a number up to {LARGEST_GUESS:.0e} in size")
    return number


def _attempt(problem: Problem, guess: complex, rtol: float, method: Method, atol: float | None) -> tuple[Mode, int, bool]:
    """One search with one tolerance, the number of evaluations, and whether a smaller tolerance may do better."""
    continuation = continuation_of(problem, method)
    told: list[ConvergenceError] = []
    evaluations = 0
    for search in searches(continuation, guess, LEFT * rtol):
        before = search.discriminant.evaluations
        try:
            mode, count = examine(continuation, search.root(), rtol, atol)
            if search.means(mode.sigma):
                return mode, evaluations + count + search.discriminant.evaluations - before, math.isfinite(mode.error)
        except ConvergenceError as error:
            told.append(type(error)(str(error)))  # another one: what was raised holds every mesh that it was raised from
        evaluations += search.discriminant.evaluations - before
    lost = Mode(guess, math.inf, UNKNOWN, f"not converged: {told[0]}", method.name, 0, 0.0)
    return lost, evaluations, isinstance(told[0], Inaccurate)


def tolerance_for(rtol: float) -> float:
    """The local error to begin with where a mode is wanted to rtol."""
    return min(max(LOCAL_ERROR * rtol, TIGHTEST), LOOSEST)


def tightened(method: Method) -> Method | None:
    """The method with a local error smaller by TIGHTENED, or None where it has none or rounding takes over."""
    rtol = getattr(method, "rtol", None)
    if rtol is None or rtol <= TIGHTEST or not is_dataclass(method) or isinstance(method, type):
        return None
    return replace(method, rtol=max(TIGHTENED * rtol, TIGHTEST))


def examine(continuation: Continuation, root: Root, rtol: float, atol: float | None = None) -> tuple[Mode, int]:
    """What a root is worth: the zero on a finer mesh along the path that suits it, its error bound, and the proof that it is one.

    Returned beside the mode is how often D was evaluated for it. Several zeros that D tells apart give the nearest, others one multiple
    mode. Raises ConvergenceError where the iteration does not settle, Inaccurate where D is too inaccurate to count its zeros.
    """
    coarse = continuation.at(root.sigma).discriminant
    before = coarse.evaluations
    if root.multiplicity > 1:
        mode, evaluations = _among_several(continuation, root.sigma, max(root.step, LEFT * rtol * abs(root.sigma)), rtol, atol)
    else:
        mode, evaluations = _simple(continuation, root, rtol, atol)
    return replace(mode, system=coarse.system_at(complex(mode.sigma))), coarse.evaluations - before + evaluations


def _simple(continuation: Continuation, root: Root, rtol: float, atol: float | None, alone: bool = False) -> tuple[Mode, int]:
    """`examine` for a root that looks simple, and how often D was evaluated on the finer mesh; alone: it was told apart from others."""
    branch = continuation.at(root.sigma)
    coarse = branch.discriminant
    coarse_value, coarse_error = coarse.with_derivative(root.sigma), continuation.method.rtol
    if not abs(coarse_value.newton_step) <= LEFT * rtol * abs(root.sigma):
        arrived = newton(coarse, root.sigma, LEFT * rtol)
        scale = surroundings(coarse, arrived.sigma).scale
        scale = scale if math.isfinite(scale) else 0.0  # an iterate next to 0 may be far from a zero on its other side, in |σ|
        settled = arrived.converged or arrived.step <= LEFT * NEUTRAL * scale
        if not settled or abs(arrived.sigma - root.sigma) > max(abs(root.sigma), math.sqrt(NEUTRAL) * scale):
            if continuation.distance(root.sigma) <= max(root.step, max(rtol, OF_LOCAL_ERRORS * coarse_error) * abs(root.sigma)):
                raise OnSpectrum(f"a zero of D lies on the continuous spectrum to the error with which it was found, at {root.sigma:.12g}")
            other = continuation.across(root.sigma)
            if other is not None and abs(other.with_derivative(root.sigma).newton_step) < NO_ZERO * abs(coarse_value.newton_step):
                told = f"the zero at {root.sigma:.6g} is one of D continued from the other side of the continuous spectrum"
                raise ConvergenceError(f"{told}, and none of D itself, along the path {branch.path}: a resonance, not a mode")
            if not alone and surroundings(coarse, arrived.sigma).multiplicity > 1:
                return _among_several(continuation, arrived.sigma, arrived.step, rtol, atol)
            why = f"the iteration does not settle at {root.sigma:.6g} along the path {branch.path}"
            raise Inaccurate(why) if settled else ConvergenceError(why)  # a zero that another mesh has elsewhere: a finer one decides
        if arrived.multiplicity > 1 and not alone:
            return _among_several(continuation, arrived.sigma, max(arrived.step, LEFT * rtol * abs(arrived.sigma)), rtol, atol)
        coarse_value = coarse.with_derivative(arrived.sigma)
    scale = separation(coarse, coarse_value, root.passed)
    own = coarse.vanishing_at(coarse_value.sigma)
    own_value = own.with_derivative(coarse_value.sigma)
    own_scale = scale if own is coarse else separation(own, own_value, root.passed)
    fine = own.refined()
    fine_value = fine.with_derivative(own_value.sigma)
    if not cmath.isfinite(fine_value.D.mantissa):
        halved = f"{continuation.method.name} has no value of D on the mesh with every step halved"
        raise ConvergenceError(f"{halved}, at sigma = {own_value.sigma:.6g}: nothing tells how exactly the zero is known")
    length = abs(fine_value.newton_step)
    if length * length > LEFT * rtol * abs(own_value.sigma) * own_scale:  # one step leaves too much
        better = newton(fine, own_value.sigma, LEFT * rtol)
        if not better.converged:
            raise Inaccurate(f"the iteration does not settle at {own_value.sigma:.6g} on the mesh with every step halved")
        own_value, fine_value = own.with_derivative(better.sigma), fine.with_derivative(better.sigma)
    sigma = fine_value.sigma + fine_value.newton_step
    parts = budget(continuation.problem, own, own_value, fine, fine_value, own_scale)
    if math.isfinite(scale) and abs(sigma) <= EPSILON * scale:  # 0 to rounding, which digits of σ know nothing of
        parts = replace(parts, rounding=parts.rounding + abs(sigma))
    size = max(abs(sigma), scale if math.isfinite(scale) else 0.0) or SMALLEST_DISTANCE  # a zero at 0 of a D that looks linear has none
    neutral = min(rtol, NEUTRAL) * scale if math.isfinite(scale) else 0.0
    allowed = neutral if atol is None else atol
    # next to a multiple zero the bound means nothing, but there is a circle that tells
    least, widest = max(CIRCLE_OF_PROOF * rtol * abs(sigma), CIRCLE_OF_PROOF * neutral), WIDEST_PROOF * size
    radius = min(max(least, PROOF * parts.total), widest) or widest
    try:
        count = count_around(coarse, Disc(sigma, radius), own_value.sigma + own_value.newton_step)
    except ConvergenceError:
        if alone:
            raise
        count = 2  # a zero lies on the circle, where a simple one does not
    if count > 1:
        several, evaluations = _among_several(continuation, sigma, radius, rtol, atol, apart=not alone)
        return several, fine.evaluations + evaluations
    distance = continuation.distance(sigma)
    if parts.total < distance:  # otherwise the status says that the side is not known
        _require_a_mode(continuation, branch, sigma, parts.total, radius)
    status = _status(count, radius, sigma, parts.total, distance, max(rtol * abs(sigma), allowed))
    mode = Mode(sigma, parts.total, parts, status, continuation.method.name, 0, 0.0, distance, branch.path, scale=scale, atol=allowed)
    return mode, fine.evaluations


def _require_a_mode(continuation: Continuation, branch: Branch, sigma: complex, error: float, radius: float) -> None:
    """Raise ConvergenceError where a zero of a branch is none of D itself: it lies beyond the continuous spectrum.

    A zero on the other side of a spectrum inside that is one of D too, within the radius, belongs to a subsystem that is not singular.
    """
    told = f"the zero at {sigma:.{DOUBLE_DIGITS}g} lies beyond the continuous spectrum"
    if continuation.barrier is not None and continuation.barrier.beyond(sigma):
        advice = "if modes of that part of the plane are wanted, reference = a sigma in it names them"
        raise ConvergenceError(f"{told} of an end at infinity: a resonance, not a mode; {advice}")
    if continuation.own_side(branch, sigma, error):
        return
    if not abs(continuation.at(sigma).discriminant.with_derivative(sigma).newton_step) <= radius:
        raise ConvergenceError(f"{told}, on D continued through it: a resonance, not a mode")


def _among_several(
    continuation: Continuation, sigma: complex, radius: float, rtol: float, atol: float | None, apart: bool = True
) -> tuple[Mode, int]:
    """The nearest of several zeros in a circle of about this radius where D tells them apart, and the multiple mode otherwise."""
    D = continuation.at(sigma).discriminant
    if radius == 0.0 or not has_a_size(D, sigma):  # an iteration comes to 0 exactly or ever nearer, and |σ| measures no circle
        radius = max(radius, neutral(surroundings(D, sigma), LEAST_D_ERROR)) or SMALLEST_DISTANCE
    found = cluster(continuation, sigma, radius, goal=max(rtol * abs(sigma), atol or 0.0) if not apart else 0.0)
    zeros = told_apart(continuation, found) if apart else []
    if zeros:
        nearest = min(zeros, key=lambda zero: abs(zero - sigma))
        return _simple(continuation, Root(nearest, 0.0, 0, True), rtol, atol, alone=True)
    if atol is None and abs(found.mean) <= found.error:
        atol = neutral(surroundings(continuation.at(found.mean).discriminant, found.mean), min(rtol, NEUTRAL))
    return multiple(continuation, found, rtol, atol or 0.0), 0


def several(continuation: Continuation, zero: Zero, rtol: float, atol: float | None = None) -> list[Mode]:
    """All modes that a multiple zero stands for: each by itself where D tells them apart, and otherwise one multiple mode.

    Raises ConvergenceError where they cannot be counted.
    """
    found = cluster(continuation, zero.sigma, zero.radius, zero.multiplicity)
    zeros = told_apart(continuation, found)
    if not zeros:
        return [multiple(continuation, found, rtol, atol or 0.0)]
    return [_simple(continuation, Root(one, 0.0, 0, True), rtol, atol, alone=True)[0] for one in zeros]


def _status(count: int, radius: float, sigma: complex, error: float, distance: float, allowed: float) -> str:
    """What is to be said where so many zeros, one at most, were counted within the radius."""
    if not error < 0.5 * abs(sigma) and not error <= allowed:
        return f"not converged: the error bound {error:.1e} is as large as the mode itself"
    if count == 0:
        return f"not converged: the iteration stopped at {sigma:.{DOUBLE_DIGITS}g}, but no zero lies within {radius:.1e}"
    if distance <= error:
        return f"not converged: the continuous spectrum passes at {distance:.1e}, inside the error bound {error:.1e}"
    if error > allowed:
        return f"not converged: the error bound {error:.1e} exceeds the {allowed:.1e} asked for"
    return CONVERGED
