"""The eigenfunction of a mode to any number of digits, from the same integration by Taylor series that gives the digits of the mode.

Double precision finds where the largest value is; there, at a z of a few decimals, that unknown is 1. Then everything is done otherwise
once, and what the values change by is their error, as for the mode itself (see refine_digits.py).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import Any

import mpmath

from shootstab.analyses.eigenfunction_double import Eigenfunction, eigenfunction_double
from shootstab.analyses.refine_digits import CHANGE_SAFETY, DIGIT_ATTEMPTS, SPARE_TO_DIGITS, as_far_off, in_digits, refine_digits
from shootstab.core.errors import ConvergenceError, InputError
from shootstab.core.given import require_whole
from shootstab.core.progress import TOTAL, Progress
from shootstab.core.records import Budget, Mode
from shootstab.kernels.step_control import FLOOR
from shootstab.multiprecision.arithmetic import Arithmetic, exact
from shootstab.multiprecision.backends import choose
from shootstab.multiprecision.integration import BaseFlowNumbers, MultiprecisionProblem
from shootstab.multiprecision.placed_solution import PlacedSolution
from shootstab.multiprecision.settings import Settings
from shootstab.multiprecision.taylor_shooting import TaylorShooting
from shootstab.multiprecision.taylor_solution import TaylorSolution, solved
from shootstab.problems.capabilities import UNSCALED
from shootstab.problems.protocol import Problem

SolutionInDigits = TaylorSolution | PlacedSolution
PEAK_DIGITS = 6  # chosen: digits of the z at which the largest value is made 1; it is flat there
COMPARED = 25  # chosen: heights at which values are compared with those of an integration done otherwise
SHAPE_DIGITS = 4  # chosen: digits of the mode beyond those of its eigenfunction, which is as much more sensitive
SOLUTIONS = 6  # derived: the eigenfunction and its five variants, for the share of work done that is shown
SHARE_OF_MODE = 0.6  # chosen: the mode's part of the work; only the progress shown rests on it


@dataclass(frozen=True, eq=False)
class EigenfunctionInDigits:
    """f(z) gives the unknowns by name as mpmath numbers, with the factor that makes one of them 1 at one place, peak = (unknown, z).

    |true − shown| ≤ error times the largest value of the unknown, for each unknown and z; budget names the parts of that. The decimals of
    z are meant: 0.1 is 1/10. rough is the eigenfunction in doubles.
    """

    mode: Mode
    peak: tuple[str, str]
    budget: Budget
    solution: SolutionInDigits
    rough: Eigenfunction
    digits: int
    working_digits: int

    def __repr__(self) -> str:
        return f"EigenfunctionInDigits({', '.join(self.names)} at {complex(self.mode.sigma)}, error {self.error:.1e})"

    @property
    def names(self) -> tuple[str, ...]:
        """The unknowns."""
        return self.solution.names

    @property
    def error(self) -> float:
        """The sum of the budget."""
        return self.budget.total

    @property
    def extent(self) -> tuple[float, float]:
        """The extent of the eigenfunction in doubles, as far as the solution in digits is known."""
        (low, high), (first, last) = self.rough.extent, self.solution.extent
        return max(low, first), min(high, last)

    @property
    def normalization(self) -> str:
        """What the free factor is, in words."""
        return f"{self.peak[0]} = 1 at {self.rough.variable} = {self.peak[1]}, near where the largest of all values is"

    def __call__(self, z: Any) -> dict[str, Any]:
        """The unknowns by name at one z, mpmath numbers. Raises InputError for a z outside the domain, or that is no real number."""
        with _precision(self.solution.arithmetic, self.working_digits):
            place = _number(self.solution.arithmetic, z)
            return {name: value / self._factor for name, value in _values(self.solution, place).items()}

    @cached_property
    def _factor(self) -> Any:
        unknown, z = self.peak
        return _values(self.solution, _number(self.solution.arithmetic, z))[unknown]


def eigenfunction_digits(
    problem: Problem, mode: Mode | complex, digits: int, progress: Progress | None = None, arithmetic: str | None = None
) -> EigenfunctionInDigits:
    """The eigenfunction of a simple mode, or of the one next to a guess, with an error of at most 10^−digits of the largest values.

    Raises InputError for a mode that stands for several, or a problem without a formulation for many digits, ConvergenceError where the
    digits are not reached. arithmetic is that of refine_digits.
    """
    require_whole("digits", digits, 1)
    rough = eigenfunction_double(problem, mode)
    inner, unit = UNSCALED.of(problem) or (problem, 1.0)
    guess, numbers = complex(rough.mode.sigma), choose(arithmetic)
    told = progress or (lambda done, total: None)
    wanted = digits + SHAPE_DIGITS
    for _ in range(DIGIT_ATTEMPTS):
        found = refine_digits(inner, unit * guess, wanted, lambda done, total, left: told(round(SHARE_OF_MODE * done), total), arithmetic)
        if not found.converged:
            raise ConvergenceError(f"no mode to {wanted} digits next to {guess:.12g}: {found.status.removeprefix('not converged: ')}")
        settings = Settings.of(wanted + SPARE_TO_DIGITS)
        variants = Variations(in_digits(inner), numbers, found, rough.peak, told)
        solution, peak, parts = variants.with_budget(settings)
        if parts.total <= 10.0**-digits:
            shown = found if unit == 1.0 else refine_digits(problem, guess, wanted, arithmetic=arithmetic)
            return EigenfunctionInDigits(shown, peak, parts, solution, rough, digits, settings.digits)
        wanted += math.ceil(math.log10(parts.total) + digits) + 1
    raise ConvergenceError(f"the eigenfunction is known to {parts.total:.1e} of its largest values, and 1e-{digits} was asked for")


class Variations:
    """The solution that belongs to a mode, and what it changes by when one thing is done otherwise."""

    def __init__(
        self, problem: MultiprecisionProblem, arithmetic: Arithmetic, mode: Mode, peak: tuple[str, float], progress: Progress
    ) -> None:
        self._problem, self._arithmetic, self._mode, self._peak, self._progress = problem, arithmetic, mode, peak, progress
        self._done = 0

    def with_budget(self, settings: Settings) -> tuple[SolutionInDigits, tuple[str, str], Budget]:
        """The solution, where which unknown is 1, and the error of its values in parts."""
        with _precision(self._arithmetic, settings.digits):
            base = self._problem.base(self._arithmetic, settings, lambda: None)
        own, asked = self._solved(settings, base)
        finer = settings.finer()
        better = finer, finer.farther(), finer.farther().more_precise()
        varied = [self._solved(other, base) for other in better]
        root, _ = self._solved(settings, base, self._mode.error)
        with _precision(self._arithmetic, settings.digits):
            other = as_far_off(base, [asked, *(corrected for _, corrected in varied)])
        flow = self._solved(settings, other)[0] if other != base else None
        solutions = [own, *(solution for solution, _ in varied), root, *([] if flow is None else [flow])]
        digits = [settings.digits, *(other.digits for other in better), settings.digits, settings.digits]
        peak = self._place(own)
        with _precision(self._arithmetic, settings.digits):
            heights = _common_heights(solutions, _number(self._arithmetic, peak[1]))
        tables = []
        for solution, precision in zip(solutions, digits, strict=False):
            with _precision(self._arithmetic, precision):
                tables.append(_table(solution, heights, peak))
        with _precision(self._arithmetic, settings.digits):
            steps = [*pairwise(tables[:4]), *((tables[0], table) for table in tables[4:])]  # one thing after the other is done better
            changes = [CHANGE_SAFETY * _change(one, other) for one, other in steps]
        integration, far, rounding, moved = changes[:4]
        return own, peak, Budget(integration, far, changes[4] if flow is not None else 0.0, moved, rounding + 10.0**-settings.digits)

    def _solved(self, settings: Settings, base: BaseFlowNumbers, moved: Any = 0) -> tuple[SolutionInDigits, BaseFlowNumbers]:
        """The solution at the mode, or moved by so much, and the base flow that the integration asks for."""
        arithmetic = self._arithmetic
        with _precision(arithmetic, settings.digits):
            sigma = mpmath.mpc(self._mode.sigma) + mpmath.mpf(moved)
            real = self._problem.real and sigma.imag == 0
            integration = self._problem.integration(arithmetic, settings, base)
            shooting = TaylorShooting(arithmetic, self._problem.size, settings, integration, lambda: None)
            along, c = solved(shooting, arithmetic.number(sigma.real) if real else arithmetic.complex(sigma))
            parts = getattr(integration, "parts", ())
            found: SolutionInDigits = PlacedSolution(along, parts, c) if parts else along
            self._done += 1
            self._progress(round(TOTAL * (SHARE_OF_MODE + (1.0 - SHARE_OF_MODE) * self._done / SOLUTIONS)), TOTAL)
            return found, shooting.corrected_base()

    def _place(self, own: SolutionInDigits) -> tuple[str, str]:
        """The unknown with the largest value, and its place as a decimal inside the domain."""
        unknown, z = self._peak
        low, high = own.extent
        text = f"{z:.{PEAK_DIGITS}g}"
        return unknown, text if low <= float(text) <= high else repr(min(max(z, low), high))


def _common_heights(solutions: Sequence[SolutionInDigits], peak: Any) -> list[Any]:
    """Places of the first solution that all of them reach, and the middles between them, at most so many, the peak, and some beyond."""
    low, high = max(s.ends[0] for s in solutions), min(s.ends[1] for s in solutions)
    arithmetic = solutions[0].arithmetic
    nodes = [z for z in solutions[0].nodes if low <= float(arithmetic.to_mpmath(z)) <= high]
    places = [z for a, b in pairwise(nodes) for z in (a, (a + b) / 2)]
    return [*solutions[0].outer, *places[:: max(1, math.ceil(len(places) / COMPARED))], peak]


def _table(solution: SolutionInDigits, heights: Sequence[Any], peak: tuple[str, str]) -> list[list[Any]]:
    """The unknowns, each at all heights, scaled."""
    factor = _values(solution, _number(solution.arithmetic, peak[1]))[peak[0]]
    rows = [_values(solution, z) for z in heights]
    return [[row[name] / factor for row in rows] for name in solution.names]


def _change(one: Sequence[Sequence[Any]], two: Sequence[Sequence[Any]]) -> float:
    """The largest change of an unknown over its largest value, which counts as FLOOR of the largest of all at least."""
    sizes = [max(map(abs, values)) for values in one]
    least = FLOOR * max(sizes)
    return max(
        float(max(abs(a - b) for a, b in zip(u, v, strict=True)) / max(size, least)) for u, v, size in zip(one, two, sizes, strict=True)
    )


def _values(solution: SolutionInDigits, z: Any) -> Mapping[str, Any]:
    """The unknowns at one place as mpmath numbers, unscaled."""
    return {name: mpmath.mpc(solution.arithmetic.to_mpmath(value)) for name, value in solution(z).items()}


def _number(arithmetic: Arithmetic, z: Any) -> Any:
    """A place as a number of the arithmetic; decimals are meant. Raises InputError for what is no finite real number."""
    try:
        if isinstance(z, mpmath.mpf):
            return arithmetic.number(z)
        return arithmetic.number(Fraction(z) if isinstance(z, int | str | Fraction) else exact(z))
    except (ValueError, TypeError, OverflowError):
        raise InputError(f"z = {z!r}: allowed is a finite real number") from None


@contextmanager
def _precision(arithmetic: Arithmetic, digits: int) -> Iterator[None]:
    """A context in which the arithmetic and mpmath carry this many digits."""
    with arithmetic.working(digits), mpmath.workdps(digits):
        yield
