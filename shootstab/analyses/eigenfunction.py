"""The eigenfunction of a mode to the accuracy asked for: in double precision, or beyond it with many digits."""

from __future__ import annotations

from typing import TYPE_CHECKING, overload

from shootstab.analyses.eigenfunction_double import Eigenfunction, eigenfunction_double
from shootstab.core.allowed import RTOL
from shootstab.core.progress import Progress
from shootstab.core.records import Mode
from shootstab.problems.protocol import Problem

if TYPE_CHECKING:
    from shootstab.analyses.eigenfunction_digits import EigenfunctionInDigits


@overload
def eigenfunction(problem: Problem, mode: Mode | complex, rtol: float = ..., progress: Progress | None = ...) -> Eigenfunction: ...


@overload
def eigenfunction(
    problem: Problem, mode: Mode | complex, rtol: float = ..., progress: Progress | None = ..., *, digits: int
) -> EigenfunctionInDigits: ...


def eigenfunction(
    problem: Problem, mode: Mode | complex, rtol: float = RTOL, progress: Progress | None = None, digits: int | None = None
) -> Eigenfunction | EigenfunctionInDigits:
    """The eigenfunction of a simple mode, or of the one next to a guess: see eigenfunction_double.py.

    With digits=N its values at any z are mpmath numbers, with an error of at most 10^−N of the largest ones: see eigenfunction_digits.py.
    progress(done, total) is told how far it is. Raises InputError for a mode that did not converge, or that stands for several;
    ConvergenceError where the real line passes too near to a singular point, or the digits are not reached.
    """
    if digits is None:
        return eigenfunction_double(problem, mode, rtol, progress)
    from shootstab.analyses.eigenfunction_digits import eigenfunction_digits  # mpmath and flint are imported where they are needed

    return eigenfunction_digits(problem, mode, digits, progress)
