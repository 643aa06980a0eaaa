"""Certificates for the checker of granular chutes, with settings chosen by its own arithmetic: it trusts none of them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain
from typing import Any

from shootstab.checkers import granular_chute as checker
from shootstab.checkers.granular_chute import Certified, Model, RefusedError, Steady, exact
from shootstab.core.errors import ConvergenceError

MODEL_BITS, BITS_EACH_ATTEMPT, MODEL_ATTEMPTS = 72, 48, 3  # chosen: bits beyond those of the radius; more of them in each attempt
TERMS_A_BIT = 0.46  # chosen: terms of a series for each bit: steps are then as long as the series of powers allow
HIGHEST_NU, LOWEST_NU = 2.0**-7, 2.0**-40  # chosen: volume fractions between which a start of the steps is looked for, by halves
FAR_LOSS = 32  # chosen: bits that a far field may lose
STEP_LOSS, STEP_ROUNDING = 64.0, 16384.0  # chosen: the factor by which a step may widen radii, and the last places that it may add
FIRST_LENGTH_TRIED = 0.25  # chosen: the first step, in T_∞
NEXT_LENGTH, TRIED_LENGTH = 1.2, 0.75  # chosen: factors from one step to the next, and to the next try
SHORTEST_LENGTH_TRIED, LENGTH_PLACES = 1e-6, 6  # chosen: the shortest step, and its decimals
BASE_SLACK = "1e-6"  # chosen: half of the interval that holds the base, in the last step
FLUX_SECANT, FLUX_SECANTS = 1e-9, 12  # chosen: relative distance of the first two T_∞ of a secant, and how often one is taken
TOLD_BITS = 8  # chosen: bits of D on the circle, at least
BRACKET_ROOM = 64  # chosen: half width of the bracket of T_∞ over what the radius of the mass flux means
TOLD_BASE = 1e-12  # chosen: half width of the interval of ν in which the base is told to be, relative
OUTER_SHARE, POINTS_ROOM = 64, 1e3  # chosen: the outer circle is the mean of the disc's and |σ|/64; its tail is so much smaller than D
CLOSEST_OUTER = 4.0  # chosen: the outer circle over that of the disc, at least
STEP_BUDGET = 400  # chosen: steps of a certificate

ModelMatrix = list[list[Model]]


@dataclass(frozen=True)
class Asked:
    """What a certificate is to say: the problem, the disc and the count as decimals, and T_∞ in doubles."""

    problem: Mapping[str, str]
    region: Mapping[str, str]
    count: int
    far_temperature: float


def candidates(asked: Asked) -> Iterator[dict[str, Any]]:
    """Certificates to be tried, each with more bits. Raises ConvergenceError where a flow has no base in sight."""
    bits = max(math.ceil(-math.log2(Fraction(asked.region["radius"]))) + MODEL_BITS, MODEL_BITS + FAR_LOSS)
    T, start, steps, lacking = Fraction(repr(asked.far_temperature)), "", list[str](), 0
    for _ in range(MODEL_ATTEMPTS):
        with checker.precision(bits):
            terms = math.ceil(TERMS_A_BIT * bits)
            made = {"format": 2, "problem": dict(asked.problem), "count": asked.count, "region": dict(asked.region), "bits": bits}
            made |= {
                "order": terms,
                "far_order": terms,
                "slack": BASE_SLACK,
                "lemmas": checker.RELIED_ON,
                "outer": repr(_outer(asked.region)),
            }
            if not steps:
                start, steps = _mesh(made, exact(T))
            made |= {"start": start, "steps": steps}
            T, lacking = _completed(made, T)
        if lacking <= 0:
            yield made
        bits += max(lacking, BITS_EACH_ATTEMPT)
    if lacking > 0:
        raise ConvergenceError(f"the checker's D would lack {lacking} bits: allowed is a disc that is closer about its mode, or wider")


def _outer(region: Mapping[str, str]) -> float:
    radius = float(region["radius"])
    return math.sqrt(radius * max(math.hypot(float(region["re"]), float(region["im"])) / OUTER_SHARE, CLOSEST_OUTER**2 * radius))


def _mesh(made: dict[str, Any], T: Model) -> tuple[str, list[str]]:
    """The start and the steps of a flow; those of more bits have more terms.

    The u_∞ that k_x brings in follows from the base, which a first way down finds.
    """
    region, drift = made["region"], exact(0)
    sigma = exact(Fraction(region["re"]), Fraction(region["im"]))
    for _ in range(2 if Fraction(made["problem"]["kx"]) else 1):
        places = drift, sigma, sigma.wide(float(made["outer"]))
        start, Y = _start({**made, "steps": []}, T, *places)
        steps = _steps({**made, "start": start, "steps": []}, T, Y, places)
        drift = Model(_flow({**made, "start": start, "steps": steps}, T)[0].re)
    return start, steps


def _completed(made: dict[str, Any], T: Fraction) -> tuple[Fraction, int]:
    """T_∞, and the bits that D lacks on the circle; bracket, interval of the base and number of points go into the certificate."""
    problem, region, room = made["problem"], made["region"], Fraction(0)
    if "mass_flux" in problem:
        T, room = _bracket(made, T, Fraction(problem["mass_flux"]))
    places = math.ceil(Model.P * math.log10(2))
    chute = Certified(made)
    chute.descend(exact(T).wide(float(room)))
    chute.linearize()
    nu, ends = _fraction(chute.end[0]), [problem.get("far_temperature")] * 2
    made["flow"] = {
        "far_temperature": [_decimal(T - room, places), _decimal(T + room, places)] if room else ends,
        "nu": [_decimal(nu * (1 - sign * Fraction(repr(TOLD_BASE))), places) for sign in (1, -1)],
    }
    sigma = exact(Fraction(region["re"]), Fraction(region["im"]))
    value, M = chute.D(sigma + Fraction(region["radius"])), chute.D(sigma.wide(float(made["outer"]))).norm
    seen, q = max(value.sizes[0], checker.ulp()), float(region["radius"]) / float(made["outer"])
    made["points"] = max(2, made["count"] + 1, math.ceil(math.log(M / seen * POINTS_ROOM) / -math.log(q)))
    return T, math.ceil(math.log2(value.r / seen)) + TOLD_BITS


def _start(told: dict[str, Any], T: Model, drift: Model, sigma: Model, thick: Model) -> tuple[str, ModelMatrix]:
    """The largest ν, by halves, below which the series of the far field hold in nearly all bits, and the solutions there."""
    nu = HIGHEST_NU
    while nu > LOWEST_NU:
        found = repr(nu)
        chute = Certified({**told, "start": found})
        with suppress(RefusedError):  # what is not verified there may be nearer to ν = 0
            f_nu, f_T, f_u, f_Q, _ = chute.far_flow(T)
            steady = Steady(chute.g, f_nu, f_T, f_u + drift, f_Q)
            checker.far_space(steady, thick, chute.kx, chute.ky, T, drift)
            Y = checker.far_space(steady, sigma, chute.kx, chute.ky, T, drift)
            if max(x.r for row in Y for x in row) < 2.0 ** (FAR_LOSS - Model.P) * max(x.size for row in Y for x in row):
                return found, Y
        nu /= 2
    raise ConvergenceError("no volume fraction is small enough for the checker's far field: its wave is too short, or |σ| too small")


def _steps(told: dict[str, Any], T: Model, Y: ModelMatrix, places: tuple[Model, Model, Model]) -> list[str]:
    """Steps from the start to the base, the last one a little longer."""
    chute = Certified(told)
    y, h = _ends(chute.far_flow(T)), FIRST_LENGTH_TRIED * checker.ulp() * T.re[0]
    Y = checker.product(Y, checker.basis(Y))
    steps: list[str] = []
    while len(steps) < STEP_BUDGET:
        length = f"{h:.{LENGTH_PLACES}f}"
        if h < SHORTEST_LENGTH_TRIED:
            raise ConvergenceError("no step is short enough for the checker along the steady flow")
        try:
            piece, moved = _step(chute, y, Y, Fraction(length), places)
        except RefusedError:
            h *= TRIED_LENGTH
            continue
        chute.steps = [Fraction(length)]
        if chute.defect(_ends(piece)).a.re[0] > 0:
            t = _placed(chute, piece)
            return [*steps, _decimal(chute.steps[-1] * t / (1 - Fraction(BASE_SLACK)), math.ceil(Model.P * math.log10(2)))]
        steps.append(length)
        y, Y, h = _ends(piece), moved, h * NEXT_LENGTH
    raise ConvergenceError(f"the base does not lie within {STEP_BUDGET} steps of the checker")


def _step(
    chute: Certified, y: list[Model], Y: ModelMatrix, h: Fraction, places: tuple[Model, Model, Model]
) -> tuple[list[Model], ModelMatrix]:
    """The flow and the perturbations on a step. Raises RefusedError where it is too long."""
    drift, sigma, thick = places
    piece = chute.step(y, h)
    nu, T, u, Q, _ = piece
    steady = Steady(chute.g, nu, T, u + drift, Q)
    checker.system(steady, thick, chute.kx, chute.ky)
    A = [{j: x * -h for j, x in row.items()} for row in checker.system(steady, sigma, chute.kx, chute.ky)]
    moved = checker.carried(A, Y, chute.terms)
    for before, after in ((y, piece), (list(chain(*Y)), list(chain(*moved)))):
        if max(x.r for x in after) > STEP_LOSS * max(x.r for x in before) + STEP_ROUNDING * checker.ulp():
            raise RefusedError("what the terms leave out is seen")
    found = [_ends(row) for row in moved]
    return piece, checker.product(found, checker.basis(found))


def _placed(chute: Certified, piece: list[Model]) -> Fraction:
    """t of the base on a piece, by Newton."""
    t = Fraction(1)
    for _ in range(checker.NEWTONS):
        found = chute.defect([x.at(t) for x in piece])
        t = min(max(t - Fraction(found.a.re[0], found.b.re[0]), Fraction(0)), Fraction(1))
        t = Fraction(int(t * 2**Model.P), 2**Model.P)
    return t


def _flow(told: dict[str, Any], T: Model) -> tuple[Model, Model]:
    """u_∞ and the mass flux."""
    chute = Certified(told)
    _, u_far, flux = chute.at_base(chute.flow(T)[-1])
    return u_far, flux


def _bracket(told: dict[str, Any], T: Fraction, asked: Fraction) -> tuple[Fraction, Fraction]:
    """T_∞ by secants, and half the width of a bracket between whose ends the mass flux is seen to differ."""
    last, off = T * (1 + Fraction(repr(FLUX_SECANT))), Fraction(0)
    last_off = _fraction(_flow(told, exact(last))[1]) - asked
    for _ in range(FLUX_SECANTS):
        flux = _flow(told, exact(T))[1]
        off = _fraction(flux) - asked
        if off == last_off:
            break
        slope = (off - last_off) / (T - last)
        room = Fraction(BRACKET_ROOM * flux.r) / abs(slope)
        if abs(off / slope) < room / BRACKET_ROOM:
            return T, room
        places = 2 ** (Model.P + checker.EXTRA_BITS)
        T, last, last_off = Fraction(int((T - off / slope) * places), places), T, off
    raise ConvergenceError("the mass flux does not determine the far temperature to so many digits")


def _ends(series: list[Model]) -> list[Model]:
    return [x.at(Fraction(1)) for x in series]


def _fraction(x: Model) -> Fraction:
    """The middle of a real number."""
    return Fraction(x.re[0], 2**Model.P)


def _decimal(x: Fraction, places: int) -> str:
    """A decimal next to it."""
    whole = round(x * 10**places)
    digits = str(abs(whole)).rjust(places + 1, "0")
    return f"{'-' if whole < 0 else ''}{digits[:-places]}.{digits[-places:]}"
