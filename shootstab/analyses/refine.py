"""One mode to the accuracy asked for: in double precision, or beyond it with many digits."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from shootstab.analyses.refine_double import finite, refine_double
from shootstab.core.errors import InputError
from shootstab.core.records import Mode
from shootstab.discriminants.method import Method
from shootstab.problems.protocol import Problem

DOUBLE_DIGITS = 12  # derived: 16 of a double less what conditioning and error bound take; more are computed with many digits


def refine(
    problem: Problem,
    guess: Any,
    rtol: float = 1e-10,
    digits: int | None = None,
    method: Method | None = None,
    progress: Callable[[int, int, float], None] | None = None,
) -> Mode:
    """The mode next to guess, with |true − sigma| ≤ error and error ≤ rtol·|sigma| if its status is 'converged'.

    digits=N stands for rtol = 10^−N; above 12 everything is computed with many digits (see refine_digits.py), sigma is an mpmath number,
    and progress(done, total, seconds left) is told how far it is. method defaults to orthonormalized shooting with a tolerance chosen from
    rtol; where the bound misses rtol, any method is tried again with a smaller one. The iteration finds the mode, the argument principle
    proves that there is one: a failed search is a Mode whose status says why.
    """
    guess = finite(guess)
    if digits is None:
        return refine_double(problem, guess, rtol, method)
    if digits < 1:
        raise InputError(f"digits = {digits}: allowed is 1 or more")
    if digits <= DOUBLE_DIGITS:
        return refine_double(problem, guess, 10.0**-digits, method)
    if method is not None:
        raise InputError(f"method {method.name!r}: allowed up to {DOUBLE_DIGITS} digits, more come from Taylor series")
    from shootstab.analyses.refine_digits import refine_digits  # mpmath and flint are imported where they are needed

    return refine_digits(problem, guess, digits, progress)
