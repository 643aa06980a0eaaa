"""One mode to any number of digits: double precision finds and proves it, Taylor series give the digits.

σ is computed by secants at rising precisions, each about twice as high as the one before. At the first one thing after the other is
done better (order and step, far field, working precision and base flow), and what σ moves by on the way is its error. At the last
everything is better at once: how far σ moves then is the error, of which each thing has the share that it has at the first.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from time import perf_counter
from typing import Any

import mpmath

from shootstab.analyses.refine_double import UNKNOWN, refine_double
from shootstab.core.allowed import GUESS_RADIUS, MOST_DIGITS
from shootstab.core.errors import ConvergenceError, InputError
from shootstab.core.given import require_whole
from shootstab.core.progress import StageClock, TimedProgress
from shootstab.core.records import CONVERGED, Budget, Mode
from shootstab.multiprecision.arithmetic import Arithmetic
from shootstab.multiprecision.backends import choose
from shootstab.multiprecision.closed_form_integration import ClosedFormDigits
from shootstab.multiprecision.integration import BaseFlowNumbers, MultiprecisionProblem
from shootstab.multiprecision.secant import Secant, Values
from shootstab.multiprecision.settings import Settings
from shootstab.multiprecision.taylor_shooting import TaylorShooting
from shootstab.problems.capabilities import CLOSED_FORM, MULTIPRECISION, UNSCALED
from shootstab.problems.protocol import Problem

METHOD = "taylor"
START = 1e-11  # chosen: relative accuracy of the double-precision mode
DOUBLE = 12.5  # chosen: digits that it is taken to have
LOWEST = 20.0  # chosen: digits of the first precision
RISE = 2.3  # chosen: ratio of digits from one precision to the next; two secants double them and add those of the slope
BY_THREE = 2.7  # chosen: times the digits known are reached by three secants
SPARE_TO_DIGITS = 2  # chosen: digits computed beyond those asked for
STAGE = 1.7  # chosen: time of a precision over that of an integration; the progress shown rests on it, and nothing else
VARIANTS = 3  # derived: integrations that make the budget at the first precision, for the share of work done that is shown
CHANGE_SAFETY = 2.0  # chosen: factor on the changes that make the bound
MODE_WANDER = 100.0  # chosen: double-precision error bounds that the mode may move by
DIGIT_ATTEMPTS = 2  # chosen: a second one begins from the mode that the first found, with more digits
SHORT = 15  # derived: decimals of so many digits are what a double stands for
ROUGHEST_SEED = 1e-6  # chosen: the relative error bound of a mode in double precision from which the iteration may begin
SEED_ROUNDING = 1e-10  # chosen: the relative distance that the mode may move by whatever the bound in double precision is
COST_DIGITS, COST_POWER = 20, 2.3  # chosen: fitted to times of integrations; the progress shown rests on them, and nothing else
LEAST_DOUBLE = 1e-290  # chosen: bounds from here to its inverse are doubles, far from where these end


def refine_digits(problem: Problem, guess: Any, digits: int, progress: TimedProgress | None = None, arithmetic: str | None = None) -> Mode:
    """The mode next to guess with |true − sigma| ≤ error and error ≤ 10^−digits |sigma| if its status is 'converged'.

    At a mode that double precision does not tell from 0 the scale of D there, mode.scale, stands for |sigma|.

    sigma is an mpc. The problem is a chute or has a closed form (problems.closed.ClosedForm); its parameters mean the
    shortest decimals that their floats stand for. arithmetic is 'flint' or 'mpmath', by default flint where it is installed.
    progress(done, total, seconds left) is told how far it is. Where no mode is near, or the base flow does not determine it, the
    status says so.
    """
    unscaled = UNSCALED.of(problem)
    if unscaled is not None:
        inner, unit = unscaled
        return _in_other_units(inner, unit, guess, digits, progress, arithmetic)
    began = perf_counter()
    require_whole("digits", digits, 1, MOST_DIGITS)
    guess, numbers, problem_in_digits = complex(guess), choose(arithmetic), in_digits(problem)
    seed = refine_double(problem, guess, rtol=START)
    if not seed.converged and not seed.error <= ROUGHEST_SEED * abs(seed.sigma):
        return _failed(
            seed, f"not converged: double precision finds no mode to start from ({seed.status.removeprefix('not converged: ')})", began
        )
    if abs(seed.sigma - guess) > GUESS_RADIUS * max(abs(seed.sigma), abs(guess), _scale_at_zero(seed)):
        return _failed(
            seed,
            f"not converged: no mode is near the guess {guess:.6g}; the iteration goes to {seed.sigma:.12g}: start there if that is meant",
            began,
        )
    search = DigitSearch(problem_in_digits, numbers, seed, StageClock(progress))
    wanted = digits
    try:
        for _ in range(DIGIT_ATTEMPTS):
            mode = search.mode(wanted, 10 ** -mpmath.mpf(digits))
            if mode.converged or not mode.digits > 0.0:
                break
            wanted += math.ceil(digits - mode.digits) + 1
    except ConvergenceError as error:
        return _failed(seed, f"not converged: {error}", began)
    return replace(mode, seconds=perf_counter() - began, continuum_distance=seed.continuum_distance)


def _scale_at_zero(seed: Mode) -> float:
    """The scale of D at a mode that double precision does not tell from 0, to which its digits are counted; 0 for any other."""
    return seed.scale if abs(seed.sigma) <= max(seed.error, seed.atol) and math.isfinite(seed.scale) else 0.0


def _in_other_units(
    problem: Problem, unit: complex, guess: Any, digits: int, progress: TimedProgress | None, arithmetic: str | None
) -> Mode:
    """The mode v = σ/unit of a problem in σ. Raises InputError for a unit that is no short decimal, as 1/3 is none."""
    if any(len(repr(part).split("e")[0].strip("-0.").replace(".", "")) > SHORT for part in (unit.real, unit.imag)):
        raise InputError(f"many digits in units of {unit:.17g}: allowed are units that are decimals of at most {SHORT} digits")
    mode = refine_digits(problem, unit * complex(guess), digits, progress, arithmetic)
    with mpmath.workdps(digits + SHORT):
        divisor = mpmath.mpc(*(mpmath.mpf(repr(part)) for part in (unit.real, unit.imag)))
        size = abs(divisor)
        parts = Budget(**{name: _plain(part / size) for name, part in mode.budget.as_dict().items()})
        return replace(mode, sigma=mode.sigma / divisor, error=_plain(mode.error / size), budget=parts)


def in_digits(problem: Problem) -> MultiprecisionProblem:
    """The problem as many digits take it: its own formulation, or its closed form on power series. Raises InputError if it has neither."""
    own = MULTIPRECISION.of(problem)
    made: MultiprecisionProblem = own() if own is not None else ClosedFormDigits(CLOSED_FORM.required(problem))
    return made


class DigitSearch:
    """The mode in one arithmetic, from its double-precision value on; what is known of it grows."""

    def __init__(self, problem_in_digits: MultiprecisionProblem, arithmetic: Arithmetic, seed: Mode, clock: StageClock) -> None:
        self._problem_in_digits, self._arithmetic, self._seed, self._clock = problem_in_digits, arithmetic, seed, clock
        sigma = mpmath.mpmathify(seed.sigma)
        self._real = problem_in_digits.real and abs(sigma.imag) <= seed.error
        self._zero = _scale_at_zero(seed)
        self._secant = Secant(sigma.real if self._real else mpmath.mpc(sigma), self._zero)
        self._known = DOUBLE
        self.evaluations = seed.evaluations

    def mode(self, digits: int, rtol: Any) -> Mode:
        """The mode to about so many digits, with its error bound."""
        precisions = _precisions(max(digits + SPARE_TO_DIGITS, LOWEST), self._known)
        self._clock.plan(self._stages(precisions))
        for d in precisions:
            settings = Settings.of(d)
            with self._arithmetic.working(settings.digits), mpmath.workdps(settings.digits):
                base = self._problem_in_digits.base(self._arithmetic, settings, self._clock.step_done)
                shooting = self._shooting(settings, base)
                self._secant.settle(partial(self._values, shooting), d, least=1 + (d == precisions[-1]))
                self._require_near(self._secant.x)
            self._known = d
            self._clock.done()
            if d == precisions[0]:
                parts = self._budget(settings, base)
        return self._result(settings, parts if len(precisions) == 1 else self._rescaled(parts, settings), rtol)

    def _shooting(self, settings: Settings, base: BaseFlowNumbers) -> TaylorShooting:
        integration = self._problem_in_digits.integration(self._arithmetic, settings, base)
        return TaylorShooting(self._arithmetic, self._problem_in_digits.size, settings, integration, self._clock.step_done)

    def _values(self, shooting: TaylorShooting, sigma: Any) -> Values:
        self.evaluations += 1
        arithmetic = self._arithmetic
        return (arithmetic.to_mpmath(shooting(arithmetic.number(sigma) if self._real else arithmetic.complex(sigma))),)

    def _require_near(self, sigma: Any) -> None:
        seed = self._seed
        moved = abs(sigma - mpmath.mpmathify(seed.sigma))
        if not moved <= MODE_WANDER * seed.error + SEED_ROUNDING * max(abs(seed.sigma), self._zero):
            raise ConvergenceError(
                f"in high precision the iteration leaves the mode that double precision found, by {float(moved):.1e} with a bound of "
                f"{float(seed.error):.1e}"
            )

    def _budget(self, settings: Settings, base: BaseFlowNumbers) -> Budget:
        """What σ moves by while one thing after the other is done better, each measured by the change of D at the same σ over D′.

        Together these moves are the whole error, whichever of them have the same cause or cancel. The last one, to a higher working
        precision, is on the base flow that the better integrations ask for, if there is one: it is then the error of that flow.
        """
        arithmetic, secant = self._arithmetic, self._secant
        sigma, (before,) = secant.last
        moves, asked, finer = [], base, settings.finer()
        best = finer.farther().more_precise()
        for better in (finer, finer.farther(), best):
            with arithmetic.working(better.digits), mpmath.workdps(better.digits):
                shooting = self._shooting(better, asked if better is best else base)
                (value,) = self._values(shooting, sigma)
                moves.append(_plain(CHANGE_SAFETY * abs((value - before) / secant.slope)))
                before, asked = value, shooting.corrected_base()
                self._clock.done()
        integration, far, last = moves
        with mpmath.workdps(settings.digits):
            root, epsilon = CHANGE_SAFETY * secant.error, abs(secant.x) * mpmath.mpf(10) ** -settings.digits
            steady, rounding = (last, epsilon) if base else (0.0, last + epsilon)
        return Budget(integration, far, steady, _plain(root), _plain(rounding))

    def _rescaled(self, parts: Budget, settings: Settings) -> Budget:
        """The budget at the last precision: its whole from one integration in which everything is better, its shares those of parts.

        The base flow of that integration is found anew with the better settings.
        """
        arithmetic, secant, best = self._arithmetic, self._secant, settings.finer().farther().more_precise()
        sigma, (before,) = secant.last
        with arithmetic.working(best.digits), mpmath.workdps(best.digits):
            base = self._problem_in_digits.base(arithmetic, best, self._clock.step_done)
            (value,) = self._values(self._shooting(best, base), sigma)
            whole = CHANGE_SAFETY * abs((value - before) / secant.slope)
            self._clock.done()
        with mpmath.workdps(settings.digits):
            shares = [mpmath.mpf(part) for part in (parts.integration, parts.far_field, parts.steady_flow, parts.rounding)]
            total = mpmath.fsum(shares)
            epsilon = abs(secant.x) * mpmath.mpf(10) ** -settings.digits
            integration, far, steady, rounding = (whole * share / total for share in shares)
            return Budget(*map(_plain, (integration, far, steady, CHANGE_SAFETY * secant.error, rounding + epsilon)))

    @staticmethod
    def _stages(precisions: Sequence[float]) -> list[float]:
        """The cost of each stage: the precisions, behind the first one the integrations of its budget, and the better one of the last."""
        first, *later = [STAGE * _cost(d) for d in precisions]
        return [first, *[_cost(precisions[0])] * VARIANTS, *later, *([_cost(precisions[-1])] if later else [])]

    def _result(self, settings: Settings, parts: Budget, rtol: Any) -> Mode:
        with mpmath.workdps(settings.digits):
            error = _plain(mpmath.fsum(parts.as_dict().values()))
            sigma = mpmath.mpc(self._secant.x)
            allowed, atol = rtol * max(abs(sigma), self._zero), _plain(rtol * self._zero)
            status = CONVERGED if error <= allowed else f"not converged: the error bound {mpmath.nstr(error, 2)} is too large"
            return Mode(sigma, error, parts, status, METHOD, self.evaluations, 0.0, scale=self._seed.scale, atol=float(atol))


def _precisions(top: float, known: float) -> list[float]:
    """The precisions from top down, in steps of RISE, to where the digits known lead up in a few secants."""
    precisions = [float(top)]
    while precisions[0] > BY_THREE * known:
        precisions.insert(0, max(precisions[0] / RISE, LOWEST))
    return precisions


def as_far_off(base: BaseFlowNumbers, asked: Sequence[BaseFlowNumbers]) -> BaseFlowNumbers:
    """A base flow that is off by as much as the ones asked for differ: from base to the first one, and from that to each of the others.

    The largest of these differences, relative to each number, or for a zero to the largest, scaled to the sum of their sizes: what changes
    together stays together.
    """
    ours, *others = asked
    largest_number = max(map(abs, base), default=0) or 1
    shifts = [[x - y for x, y in zip(one, two, strict=True)] for one, two in ((ours, base), *((other, ours) for other in others))]
    sizes = [max((abs(x) / (abs(y) or largest_number) for x, y in zip(shift, base, strict=True)), default=0) for shift in shifts]
    largest, size = max(zip(shifts, sizes, strict=True), key=lambda pair: pair[1])
    return tuple(y + x * (mpmath.fsum(sizes) / size) for x, y in zip(largest, base, strict=True)) if size else base


def _cost(digits: float) -> float:
    """Relative time of one integration, about (digits + COST_DIGITS)^COST_POWER."""
    return float((digits + COST_DIGITS) ** COST_POWER)


def _plain(x: Any) -> Any:
    """A double where one can hold it."""
    return float(x) if x == 0 or LEAST_DOUBLE < x < 1 / LEAST_DOUBLE else mpmath.mpf(x)


def _failed(seed: Mode, status: str, began: float) -> Mode:
    """A reason in place of digits; sigma is where double precision was."""
    return replace(
        seed, sigma=mpmath.mpc(seed.sigma), error=math.inf, budget=UNKNOWN, status=status, method=METHOD, seconds=perf_counter() - began
    )
