"""Work against accuracy: every way to one mode, each at a sequence of resolutions, against a value of many digits, in one run.

The sequences: QZ and inverse iteration over the truncation M of the pseudospectral reference, on its own grid and on the paper's; the three
shooting methods over the tolerance of their local errors; Taylor series over digits. Each measurement starts from the problem with its
steady flow in memory and a guess of three digits, makes everything else anew, the choice of a grid or mesh too, and ends with one number.
It is run until it has taken a while, and the shortest run counts; its memory is measured in a run of its own, for measuring slows down.
"""

from __future__ import annotations

import math
import tracemalloc
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, is_dataclass, replace
from functools import partial
from time import perf_counter
from typing import Any

import mpmath

from shootstab.analyses import reference
from shootstab.analyses.refine import refine
from shootstab.analyses.root_near import find_near
from shootstab.core.errors import ConvergenceError, InputError
from shootstab.core.progress import MILLISECONDS, Progress
from shootstab.discriminants.method import Method
from shootstab.discriminants.named import METHODS, make
from shootstab.problems.capabilities import PSEUDOSPECTRAL, Pseudospectral
from shootstab.problems.protocol import Problem

TRUNCATIONS = (12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512)  # chosen: orders of pseudospectral runs, in steps of a half octave
TOLERANCES = tuple(10.0**-k for k in range(2, 14))  # chosen: tolerances of shooting, decade by decade
REFERENCE_DIGITS = (15, 20, 25)  # chosen: the last one is what all others are measured against
SLOWEST = 5.0  # chosen: seconds that a measurement may take; no finer one is made then
ENOUGH = 0.3  # chosen: seconds over which a measurement is repeated
MOST_RUNS = 20  # chosen: repetitions of something quick, of which the least time counts
STALLED = 3  # chosen: measurements without a gain of a factor 2 that end a sequence
FOUND = 1e-2  # chosen: a value with a larger relative error is another number
TARGETS = (4, 8, 11)  # chosen: digits that the recommendation speaks of
ITERATED = 0.1  # chosen: the last step of an iteration, in the local error of its mesh
FINEST_STEP = 1e-14  # chosen: the relative step below which there is rounding only
WHOLE_FROM = 100.0  # derived: a number from here on has two figures without decimals
Run = Callable[[Problem, complex], tuple[Any, int]]  # the mode, and how often D was evaluated or a matrix factorized


@dataclass(frozen=True)
class Measurement:
    """One method at one resolution: its value, how far that is off, and what it took.

    memory is the peak of what Python and NumPy allocate, in bytes; work counts evaluations of D, or factorizations of a matrix.
    by_bound: the error is the method's own bound, for nothing more exact is there to compare with.
    """

    method: str
    parameter: str
    resolution: float
    sigma: Any
    error: float
    seconds: float
    memory: int
    work: int
    by_bound: bool = False

    @property
    def relative(self) -> float:
        """The error in units of |σ|."""
        return self.error / abs(complex(self.sigma))


@dataclass(frozen=True)
class WorkPrecision:
    """All measurements, the value that they are measured against with its bound, the guess, and what follows from it in a sentence."""

    measurements: tuple[Measurement, ...]
    truth: Any
    bound: float
    guess: complex

    def cheapest(self, digits: float) -> Measurement | None:
        """The quickest measurement whose error is below 10^−digits."""
        good = [r for r in self.measurements if r.relative <= 10.0**-digits]
        return min(good, key=lambda r: r.seconds, default=None)

    def quickest(self, method: str, digits: float) -> Measurement | None:
        """The quickest measurement of a method that is so good."""
        good = [r for r in self.measurements if r.method == method and r.relative <= 10.0**-digits]
        return min(good, key=lambda r: r.seconds, default=None)

    @property
    def recommendation(self) -> str:
        """Sentences that say which method serves for how many digits, and what QZ would cost."""
        parts = []
        for digits in TARGETS:
            best, qz = self.cheapest(digits), self.quickest("qz", digits)
            if best is None:
                continue
            against = "which QZ does not reach" if qz is None else f"{qz.seconds / best.seconds:.2g} times faster than QZ"
            if best.method != "qz":
                parts.append(f"{digits} digits by {best.method} in {_time(best.seconds)} ({against})")
            else:
                parts.append(f"{digits} digits by qz in {_time(best.seconds)}")
        most = [r for r in self.measurements if r.method == "taylor series"]
        more = f"; more than 13 digits only by Taylor series, {_time(most[0].seconds)} for {most[0].resolution:.0f}" if most else ""
        return f"From a guess of this mode take {', '.join(parts)}{more}; QZ alone needs no guess and gives the whole spectrum."


def trade(problem: Problem, guess: complex | None = None, progress: Progress | None = None) -> WorkPrecision:
    """Measure every method. The mode is the one next to guess, by default the fastest-growing one of the bundled reference.

    Raises InputError where a problem has no reference and no guess is given, or no evaluation in many digits; ConvergenceError where no
    mode is found next to the guess.
    """
    if guess is None and PSEUDOSPECTRAL.of(problem) is None:
        raise InputError("this problem has no bundled pseudospectral reference that would tell a mode: give a guess")
    start = _three_digits(complex(reference.claims(problem, 6)[0]) if guess is None else guess)
    curves = [*spectral_curves(problem), *_shooting()]
    told = progress or (lambda done, total: None)
    told(0, len(curves) + len(REFERENCE_DIGITS))
    began = perf_counter()
    truth = refine(problem, start, digits=REFERENCE_DIGITS[-1])
    if not truth.converged:
        raise ConvergenceError(f"no value of {REFERENCE_DIGITS[-1]} digits next to {start:.6g}: {truth.status}")
    measurements = [_series(truth, perf_counter() - began, REFERENCE_DIGITS[-1], truth)]
    for i, digits in enumerate(REFERENCE_DIGITS[:-1]):
        told(i + 1, len(curves) + len(REFERENCE_DIGITS))
        began = perf_counter()
        mode = refine(problem, start, digits=digits)
        measurements.insert(i, _series(mode, perf_counter() - began, digits, truth))
    for i, curve in enumerate(curves):
        told(len(REFERENCE_DIGITS) + i, len(curves) + len(REFERENCE_DIGITS))
        measurements += measured(curve, problem, start, truth.sigma)
    told(len(curves) + len(REFERENCE_DIGITS), len(curves) + len(REFERENCE_DIGITS))
    return WorkPrecision(tuple(measurements), truth.sigma, float(truth.error), start)


@dataclass(frozen=True)
class MethodCurve:
    """A method and its resolutions, from coarse to fine: one curve of the diagram."""

    method: str
    parameter: str
    resolutions: tuple[float, ...]
    at: Callable[[float], Run]


def spectral_curves(problem: Problem) -> Iterator[MethodCurve]:
    """Every way that the pseudospectral twin has to one eigenvalue; none where there is no twin."""

    def at(name: str) -> Callable[[float], Run]:
        return lambda M: lambda fresh, guess: PSEUDOSPECTRAL.required(fresh).ways[name](int(M), guess)

    twin: Pseudospectral | None = PSEUDOSPECTRAL.of(problem)
    for name in {} if twin is None else twin.ways:
        yield MethodCurve(name, "M", TRUNCATIONS, at(name))


def _shooting() -> Iterator[MethodCurve]:
    """Every method by name, from the first mesh to the zero, without the error bound."""

    def shoot(made: Callable[..., Method]) -> Callable[[float], Run]:
        def at(rtol: float) -> Run:
            def run(fresh: Problem, guess: complex) -> tuple[Any, int]:
                discriminant = made(rtol=rtol).on(fresh)
                return find_near(discriminant, guess, max(ITERATED * rtol, FINEST_STEP)).sigma, discriminant.evaluations

            return run

        return at

    for name in METHODS:
        yield MethodCurve(name, "rtol", TOLERANCES, shoot(partial(make, name)))


def measured(curve: MethodCurve, problem: Problem, guess: complex, truth: Any) -> list[Measurement]:
    """One measurement after the other, until one is slow or several have gained nothing. What finds another number is left out."""
    measurements: list[Measurement] = []
    with suppress(ConvergenceError):
        curve.at(curve.resolutions[0])(_fresh(problem), guess)  # compile
    for resolution in curve.resolutions:
        run = curve.at(resolution)
        try:
            sigma, work, seconds = _timed(run, problem, guess)
        except ConvergenceError:
            continue
        error = _distance(sigma, truth)
        if error <= FOUND * abs(complex(truth)):
            measurements.append(
                Measurement(curve.method, curve.parameter, resolution, sigma, error, seconds, _peak(run, problem, guess), work)
            )
        if seconds > SLOWEST or _idle(measurements) >= STALLED:
            break
    return measurements


def _idle(measurements: list[Measurement]) -> int:
    """How many measurements at the end gained nothing against an earlier one."""
    errors = [r.error for r in measurements]
    return len(errors) - 1 - next((i for i, e in enumerate(errors) if e <= 2 * min(errors)), 0)


def _timed(run: Run, problem: Problem, guess: complex) -> tuple[Any, int, float]:
    """The result, and the shortest of several runs, or of one if that takes long."""
    best, spent = math.inf, 0.0
    for _ in range(MOST_RUNS):
        fresh = _fresh(problem)
        began = perf_counter()
        sigma, work = run(fresh, guess)
        took = perf_counter() - began
        best, spent = min(best, took), spent + took
        if spent > ENOUGH:
            break
    return sigma, work, best


def _peak(run: Run, problem: Problem, guess: complex) -> int:
    """The most memory that Python and NumPy hold during one more run, in bytes."""
    fresh = _fresh(problem)
    tracemalloc.start()
    try:
        run(fresh, guess)
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def _fresh(problem: Problem) -> Problem:
    """The same problem, on the same flow, that has nothing computed yet."""
    return replace(problem) if is_dataclass(problem) and not isinstance(problem, type) else problem  # type: ignore[return-value]


def _series(mode: Any, seconds: float, digits: int, truth: Any) -> Measurement:
    """A measurement of the Taylor series; the memory of its own kind of numbers is not seen."""
    same = mode is truth
    error = float(mode.error) if same else _distance(mode.sigma, truth.sigma)
    return Measurement("taylor series", "digits", digits, mode.sigma, error, seconds, 0, mode.evaluations, same)


def _distance(sigma: Any, truth: Any) -> float:
    with mpmath.workdps(2 * REFERENCE_DIGITS[-1]):
        return float(abs(mpmath.mpmathify(sigma) - truth))


def _three_digits(sigma: complex) -> complex:
    """The value to three significant digits of its larger part, as a published table would give it."""
    size = max(abs(sigma.real), abs(sigma.imag))
    if not 0.0 < size < math.inf:
        raise InputError(f"guess = {sigma}: allowed is a finite number other than 0")
    places = 2 - math.floor(math.log10(size))
    return complex(round(sigma.real, places), round(sigma.imag, places))


def _time(seconds: float) -> str:
    size, unit = (seconds, "s") if seconds >= 1.0 else (MILLISECONDS * seconds, "ms")
    return f"{size:.2g} {unit}" if size < WHOLE_FROM else f"{size:.0f} {unit}"
