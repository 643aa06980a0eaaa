"""One mode to any number of digits: double precision finds and proves it, Taylor series give the digits.

σ climbs a ladder of precisions, by secants, each rung about twice as precise as the one below. At the top everything is done
otherwise once (working precision, order and step, far field, base flow), and what σ moves by is its error.
"""

from __future__ import annotations

import math
from dataclasses import replace
from time import perf_counter
from typing import Any

import mpmath

from shootstab.discriminants.precise.arithmetic import Arithmetic, choose
from shootstab.discriminants.precise.chute import PreciseChute
from shootstab.discriminants.precise.closed import ClosedForm, ClosedFormulation
from shootstab.discriminants.precise.protocol import Formulation
from shootstab.discriminants.precise.settings import Settings
from shootstab.discriminants.precise.shooting import PreciseShooting
from shootstab.problems.chute import ChuteProblem
from shootstab.problems.protocol import Problem
from shootstab.questions.clock import Clock, Progress
from shootstab.questions.refine import UNKNOWN, refine
from shootstab.vocabulary.errors import ConvergenceError, InputError
from shootstab.vocabulary.records import CONVERGED, Budget, Mode

METHOD = "taylor"
START = 1e-11  # relative accuracy of the double-precision mode
PROBE = 24  # binary digits of the relative change of σ that shows the first slope
LOWEST = 20  # digits of the first rung
RISE = 2.2  # of digits from rung to rung
SPARE = 1  # digits computed beyond those asked for
SECANTS = 8
SAFETY = 2.0  # on the changes that make the bound
WANDER = 100.0  # double-precision error bounds that the mode may move by
ATTEMPTS = 2


def refine_digits(problem: Problem, guess: Any, digits: int, progress: Progress | None = None, arithmetic: str | None = None) -> Mode:
    """The mode next to guess with |true − sigma| ≤ error and error ≤ 10^−digits |sigma| if its status is 'converged'.

    sigma is an mpc. The problem is a chute or has a closed form (discriminants.precise.closed.ClosedForm); its parameters mean the
    shortest decimals that their floats stand for. arithmetic is 'flint' or 'mpmath', by default flint where it is installed.
    progress(done, total, seconds left) is told how far it is. Where no mode is near, or the base flow does not determine it, the
    status says so.
    """
    began = perf_counter()
    if not 1 <= digits <= 10_000:
        raise InputError(f"digits = {digits}: allowed is 1 to 10000")
    ring, formulation = choose(arithmetic), formulation_of(problem)
    seed = refine(problem, guess, rtol=START)
    if not seed.converged and not seed.error <= 1e-6 * abs(seed.sigma):
        return _failed(
            seed, f"not converged: double precision finds no mode to start from ({seed.status.removeprefix('not converged: ')})", began
        )
    search = Search(formulation, ring, seed, Clock(progress))
    wanted = digits
    try:
        for _ in range(ATTEMPTS):
            mode = search.mode(wanted, 10 ** -mpmath.mpf(digits))
            if mode.converged or not mode.digits > 0.0:
                break
            wanted += math.ceil(digits - mode.digits) + 1
    except ConvergenceError as error:
        return _failed(seed, f"not converged: {error}", began)
    return replace(mode, seconds=perf_counter() - began, continuum_distance=seed.continuum_distance)


def formulation_of(problem: Problem) -> Formulation:
    """The problem as high precision takes it. Raises InputError if it cannot be evaluated on power series."""
    if isinstance(problem, ChuteProblem):
        return PreciseChute(problem)
    if isinstance(problem, ClosedForm):
        return ClosedFormulation(problem)
    raise InputError(
        f"{type(problem).__name__}: more than 13 digits ask for a problem with exact_ends, exact_pencil, exact_far and exact_wall"
    )


class Search:
    """The mode in one arithmetic, from its double-precision value on; what is known of it grows."""

    def __init__(self, formulation: Formulation, ring: Arithmetic, seed: Mode, clock: Clock) -> None:
        self._formulation, self._ring, self._seed, self._clock = formulation, ring, seed, clock
        sigma = mpmath.mpmathify(seed.sigma)
        self._real = formulation.real and abs(sigma.imag) <= seed.error
        self._sigma = sigma.real if self._real else mpmath.mpc(sigma)
        self._slope: Any = None
        self.evaluations = seed.evaluations

    def mode(self, digits: int, rtol: Any) -> Mode:
        """The mode to about so many digits, with its error bound."""
        top = digits + SPARE
        rungs = _rungs(top)
        self._clock.plan(
            [_cost(d) * (2 if d == LOWEST else 1) for d in rungs] + [_cost(top)] * (4 if self._formulation.has_base_flow else 3)
        )
        for d in rungs:
            settings = Settings.of(d)
            with self._ring.working(settings.digits):
                shooting = self._climb(settings)
            self._clock.done()
        with self._ring.working(settings.digits):
            parts = self._budget(settings, shooting)
        return self._result(settings, parts, rtol)

    def _shooting(self, settings: Settings, base: Settings) -> PreciseShooting:
        tick = self._clock.tick
        course = self._formulation.course(self._ring, settings, base, tick)
        self.evaluations += 1
        return PreciseShooting(self._ring, self._formulation.size, settings, course, self._number(self._sigma), tick)

    def _number(self, sigma: Any) -> Any:
        return self._ring.number(sigma) if self._real else self._ring.complex(sigma)

    def _value(self, shooting: PreciseShooting, sigma: Any) -> Any:
        self.evaluations += 1
        return shooting(sigma)

    def _climb(self, settings: Settings) -> PreciseShooting:
        """Secants from the σ and the slope known, until a step is as short as the settings allow."""
        ring = self._ring
        shooting = self._shooting(settings, settings)
        sigma = self._number(self._sigma)
        if self._slope is None:
            self._slope = self._first_slope(shooting, sigma)
        slope = self._number(self._slope)
        goal = ring.log2(sigma) - (settings.tolerance - 1) * math.log2(10)
        before: tuple[Any, Any] | None = None
        for _ in range(SECANTS):
            value = self._value(shooting, sigma)
            if before is not None and ring.log2(sigma - before[0]) > -math.inf:
                slope = (value - before[1]) / (sigma - before[0])
            step = ring.rounded(value / slope)
            before = sigma, value
            sigma = ring.rounded(sigma - step)
            if ring.log2(step) < goal:
                self._keep(sigma, slope, step, value)
                return shooting
            self._require_near(sigma)
        raise ConvergenceError(f"the secants do not settle to {settings.tolerance:.0f} digits")

    def _first_slope(self, shooting: PreciseShooting, sigma: Any) -> Any:
        """D′ from a central difference: with steps of 2^−24 and 20 digits it holds to about 13."""
        h = sigma * self._ring.number(2.0**-PROBE)
        above, below = self._value(shooting, sigma + h), self._value(shooting, sigma - h)
        return self._ring.to_mpmath(self._ring.rounded((above - below) / (2 * h)))

    def _keep(self, sigma: Any, slope: Any, step: Any, value: Any) -> None:
        to = self._ring.to_mpmath
        self._sigma, self._slope, self._step = to(sigma), to(slope), abs(to(step))

    def _require_near(self, sigma: Any) -> None:
        found, seed = self._ring.to_mpmath(sigma), self._seed
        moved = abs(found - mpmath.mpmathify(seed.sigma))
        if not moved <= WANDER * seed.error + 1e-10 * abs(seed.sigma):
            raise ConvergenceError(
                f"in high precision the iteration leaves the mode that double precision found, by {float(moved):.1e} with a bound of "
                f"{float(seed.error):.1e}"
            )

    def _budget(self, settings: Settings, shooting: PreciseShooting) -> Budget:
        """What σ moves by when one thing is done better, each measured by the change of D at the same σ over D′."""
        ring = self._ring
        sigma = self._number(self._sigma)
        here = self._value(shooting, sigma)

        def moved(better: Settings, base: Settings) -> Any:
            with ring.working(better.digits):
                other = self._shooting(better, base)(self._number(self._sigma))
                change = ring.to_mpmath(ring.rounded((other - here) / self._number(self._slope)))
            self._clock.done()
            return _plain(SAFETY * abs(change))

        integration = moved(settings.finer(), settings)
        far = moved(settings.farther(), settings)
        rounding = moved(settings.more_precise(), settings.more_precise())
        steady = moved(settings, settings.finer().farther()) if self._formulation.has_base_flow else 0.0
        root = abs(ring.to_mpmath(ring.rounded(here / self._number(self._slope))))
        epsilon = abs(self._sigma) * mpmath.mpf(10) ** -settings.digits
        return Budget(integration, far, steady, _plain(SAFETY * root), _plain(rounding + epsilon))

    def _result(self, settings: Settings, parts: Budget, rtol: Any) -> Mode:
        with mpmath.workdps(settings.digits):
            error = _plain(mpmath.fsum(parts.as_dict().values()))
            self._require_near(self._number(self._sigma))
            status = (
                CONVERGED if error <= rtol * abs(self._sigma) else f"not converged: the error bound {mpmath.nstr(error, 2)} is too large"
            )
            return Mode(mpmath.mpc(self._sigma), error, parts, status, METHOD, self.evaluations, 0.0)


def _rungs(top: float) -> list[float]:
    """LOWEST, and from top down in steps of RISE what lies above it."""
    rungs = [float(top)]
    while rungs[0] / RISE > LOWEST:
        rungs.insert(0, rungs[0] / RISE)
    return [LOWEST, *rungs] if rungs[0] > LOWEST else rungs


def _cost(digits: float) -> float:
    """Relative time of one course: measured to grow about as (digits + 20)^2.3."""
    return float((digits + 20) ** 2.3)


def _plain(x: Any) -> Any:
    """A double where one can hold it."""
    return float(x) if x == 0 or 1e-290 < x < 1e290 else mpmath.mpf(x)


def _failed(seed: Mode, status: str, began: float) -> Mode:
    error = seed.error if math.isfinite(seed.error) else math.inf
    return replace(
        seed, sigma=mpmath.mpc(seed.sigma), error=error, budget=UNKNOWN, status=status, method=METHOD, seconds=perf_counter() - began
    )
