"""One mode to the accuracy asked for: in double precision, or beyond it with many digits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from shootstab.analyses.refine_double import finite, refine_double, tolerance_for
from shootstab.analyses.zeros import zeros_in
from shootstab.core.allowed import DOUBLE_DIGITS, GUESS_RADIUS, LEAST_MODE_RTOL, RTOL
from shootstab.core.errors import ConvergenceError, InputError
from shootstab.core.given import require_rtol, require_whole
from shootstab.core.records import Mode
from shootstab.core.regions import Disc
from shootstab.discriminants.continuation import Continuation
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.method import Method
from shootstab.discriminants.named import method_named
from shootstab.problems.protocol import Problem

LEFT_OUT = 0.98  # chosen: radius of the circle around the guess that must leave the mode out, in the way to it
OTHER_MODES_RTOL = 1e-5  # chosen: local error with which other modes are looked for; a count tells whether it is small enough
MODES_NAMED = 4  # chosen: modes nearer to the guess that are named


def refine(
    problem: Problem,
    guess: Any,
    rtol: float = RTOL,
    digits: int | None = None,
    method: Method | str | None = None,
    progress: Callable[[int, int, float], None] | None = None,
    atol: float | None = None,
) -> Mode:
    """The mode next to guess, with |true − sigma| ≤ error ≤ max(rtol·|sigma|, atol) if its status is 'converged'.

    digits=N stands for rtol = 10^−N; above 12 everything is computed with many digits (see refine_digits.py), sigma is an mpmath number,
    and progress(done, total, seconds left) is told how far it is. atol is an accuracy in the units of sigma, for a mode next to 0; by
    default 1e−12 of the scale over which D is linear (see refine_double.py). method, or its name, defaults to orthonormalized shooting
    with a tolerance chosen from rtol; where the bound misses rtol, any method is tried again with a smaller one. The iteration finds the
    mode, the argument principle proves that there is one: a failed search is a Mode whose status says why.
    """
    guess = finite(guess)
    if digits is None:
        require_rtol(rtol, LEAST_MODE_RTOL)
        return _placed(problem, guess, refine_double(problem, guess, rtol, method_named(method, tolerance_for(rtol)), atol))
    require_whole("digits", digits, 1)
    if digits <= DOUBLE_DIGITS:
        rtol = 10.0**-digits
        return _placed(problem, guess, refine_double(problem, guess, rtol, method_named(method, tolerance_for(rtol)), atol))
    if method is not None:
        raise InputError(f"method {getattr(method, 'name', method)!r}: allowed up to {DOUBLE_DIGITS} digits, more come from Taylor series")
    from shootstab.analyses.refine_digits import refine_digits  # mpmath and flint are imported where they are needed

    return refine_digits(problem, guess, digits, progress)


def _placed(problem: Problem, guess: complex, mode: Mode) -> Mode:
    """The mode; where it lies outside the neighbourhood of the guess, with a sentence on those that are nearer."""
    if not mode.converged or mode.guess_distance <= GUESS_RADIUS * max(abs(mode.sigma), abs(guess)):
        return mode
    radius = LEFT_OUT * mode.guess_distance
    try:
        zeros = zeros_in(Continuation(problem, Frame(rtol=OTHER_MODES_RTOL)), Disc(guess, radius), MODES_NAMED).modes
    except ConvergenceError as error:
        return replace(mode, nearer=f"whether modes within {radius:.2g} are nearer was not decided: {error}")
    listed = ", ".join(f"{zero.sigma:.6g}" for zero in sorted(zeros, key=lambda zero: abs(zero.sigma - guess)))
    return replace(mode, nearer=f"nearer modes are {listed}" if zeros else f"no mode within {radius:.2g} of the guess")
