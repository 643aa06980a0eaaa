"""What the published growth rates depend on: dσ/dp by the adjoint, for parameters that the paper leaves to its sources.

ν_m is a number: its derivative is that of a family of flows of one mass flux. The wall and g0 are choices: what stands here is the
derivative along the straight way from the paper's choice to the other one. The rows at the wall are affine in the term that (A 14) lacks;
a step to the other g0 is finite, and first order tells its direction only, so that σ itself is given too. K* is multiplied by a number s,
of which the package's own flows know nothing: density_flux.py makes them, and s = 1 must give the package's modes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from claims import Case
from scenes import GUESS, problem

import shootstab as st
from paper.density_flux import scaled, with_flux
from paper.rows import Item, Reproduction, Row
from shootstab.models.chute.chute_problem import ChuteProblem
from shootstab.models.chute.family import steady_by_flux

SCENES = ("high", "mid", "low")
PRINTED = {"high": 0.00397, "mid": 0.00102, "low": 0.00727 - 0.0119j}  # published: section 3.2
FLUX = 3.0  # published: the mass flux of the three flows
UNIT = 5e-6  # exact: half a unit of the last digit of Re σ as printed
ASIDE = 1e-3  # chosen: relative step of ν_m for the difference of modes
DIFFERENCE = 1e-4  # chosen: relative, what the square of that step may leave
NAMES = ("nu_max", "e", "e_w", "r", "tan_theta")
RTOL = 1e-11  # chosen: the accuracy of modes
OF_CONDUCTION = 5e-3  # chosen: step of the factor of K* for the differences
DOWN = (0.75, 0.5, 0.25, 0.0)  # chosen: factors of K* over which a mode is followed to none
OWN = 1e-8  # chosen: relative, within which the factor 1 gives the package's modes


def changed(name: str, **changes: object) -> ChuteProblem:
    """The scene with other parameters of the chute, at its own mass flux and waves."""
    own = problem(name)
    flow = steady_by_flux(replace(own.flow.chute, **changes), FLUX, name)  # type: ignore[arg-type]
    return ChuteProblem(flow, own.kx, own.ky)


def by_number(name: str) -> Callable[[bool], Row]:
    """dσ/dν_m of one scene, against a difference of modes, and the other numbers beside it."""

    def row(quick: bool) -> Row:
        own = problem(name)
        found = st.eigenfunction(own, GUESS[name])
        told = st.sensitivities(found, ["nu_max"] if quick else list(NAMES))
        sigma = complex(found.mode.sigma)
        h = ASIDE * own.flow.chute.nu_max
        ends = [complex(st.refine(changed(name, nu_max=own.flow.chute.nu_max + d), sigma, RTOL).sigma) for d in (h, -h)]
        slope = (ends[0] - ends[1]) / (2 * h)
        first = told[0]
        ends_of = sorted(first.value + (PRINTED[name].real + d - sigma.real) / first.derivative.real for d in (-UNIT, UNIT))
        others = ", ".join(f"∂σ/∂{s.parameter} = {s.derivative:.4g}" for s in told[1:])
        return Row(
            f"growth rate of {name} against ν_m, which the paper does not print",
            "3.2",
            f"Re σ = {PRINTED[name].real:g}; nothing of ν_m",
            f"Re σ = {sigma.real:.7f} at ν_m = {first.value:g}; ∂σ/∂ν_m = {first.derivative:.5g}: to first order the printed digits are "
            f"those of {ends_of[0]:.4f} < ν_m < {ends_of[1]:.4f}" + (f"; {others}" if others else ""),
            (
                Case("∂σ/∂ν_m: adjoint against a difference of modes", slope, first.derivative, DIFFERENCE),
                Case(
                    "what the adjoint says of its own error", "small", "small" if first.error <= DIFFERENCE * abs(slope) else "large", 0.0
                ),
            ),
        )

    return row


def wall(quick: bool) -> Row:
    """The term of an isotropic wall that (A 14) lacks."""
    cases, told = [], []
    for name in ("mid",) if quick else SCENES:
        own = problem(name)
        found = st.eigenfunction(own, GUESS[name])
        other = ChuteProblem(replace(own.flow, chute=replace(own.flow.chute, wall="isotropic")), own.kx, own.ky)
        first = found.shift(other)
        mode = st.refine(other, complex(found.mode.sigma), RTOL)
        whole = complex(mode.sigma) - complex(found.mode.sigma)
        told.append(f"{name} {first:.5g} to first order, {whole:.5g} whole")
        if own.ky == 0.0:
            cases.append(Case(f"{name}: σ, for v̂ is 0 along the slope", complex(found.mode.sigma), complex(mode.sigma), 1e-10))
        else:
            cases.append(Case(f"{name}: first order against the whole step", whole, first, 0.02))
    return Row(
        "an isotropic wall instead of (A 14) as printed: ∂σ/∂s of s times the term −½A r² ∂v/∂y",
        "(A 14), 3.2",
        "the term is absent",
        "; ".join(told),
        tuple(cases),
    )


def radial(quick: bool) -> Row:
    """Carnahan & Starling's g0 instead of Lun & Savage's."""
    cases, told = [], []
    for name in ("mid",) if quick else SCENES:
        own = problem(name)
        found = st.eigenfunction(own, GUESS[name])
        sigma = complex(found.mode.sigma)
        try:
            other = changed(name, radial="carnahan-starling")
        except st.ShootstabError as error:
            told.append(f"{name}: {error}")
            continue
        first = found.shift(other)
        mode = st.refine(other, sigma, RTOL)
        if not mode.converged:
            told.append(f"{name}: {first:.3g} to first order; no mode is followed to the other g0")
            continue
        whole = complex(mode.sigma) - sigma
        told.append(f"{name}: {first:.3g} to first order, σ = {complex(mode.sigma):.6g} whole")
        cases.append(
            Case(f"{name}: the printed digits need Lun & Savage", "yes", "yes" if abs(whole.real) > UNIT else "no", 0.0, f"{whole:.3g}")
        )
    return Row("g0 of Carnahan & Starling instead of Lun & Savage's", "2.1, 3.2", "g0 as in Lun et al.", "; ".join(told), tuple(cases))


def conduction(quick: bool) -> Row:
    """The flux K* ∇ν times s: ∂σ/∂s at s = 1, and the modes at s = 0."""
    cases, told = [], []
    for name in ("mid",) if quick else SCENES:
        own = problem(name)
        chute, T, waves = own.flow.chute, own.flow.far_temperature, (own.kx, own.ky)
        z_m = with_flux(chute, FLUX, T, 1.0).z_m
        here, ahead, behind = (scaled(with_flux(chute, FLUX, T, s), *waves, z_m) for s in (1.0, 1.0 + OF_CONDUCTION, 1.0 - OF_CONDUCTION))
        found = st.eigenfunction(here, GUESS[name])
        sigma = complex(found.mode.sigma)
        first = (found.shift(ahead) - found.shift(behind)) / (2 * OF_CONDUCTION)
        ends = [complex(st.refine(p, sigma, RTOL).sigma) for p in (ahead, behind)]
        cases += [
            Case(f"{name}: σ at s = 1 is the package's", complex(st.refine(own, GUESS[name], RTOL).sigma), sigma, OWN),
            Case(f"{name}: ∂σ/∂s, adjoint against a difference of modes", (ends[0] - ends[1]) / (2 * OF_CONDUCTION), first, DIFFERENCE),
        ]
        last, T_s = sigma, T
        for s in DOWN:
            flow = with_flux(chute, FLUX, T_s, s)
            mode = st.refine(scaled(flow, *waves, flow.z_m), last, RTOL)
            if not mode.converged:
                raise RuntimeError(f"{name}, K* times {s:g}: {mode.status}")
            last, T_s = complex(mode.sigma), flow.far_temperature
        needed = "yes" if abs((last - sigma).real) > UNIT else "no"
        cases.append(Case(f"{name}: the printed digits need K*", "yes", needed, 0.0, f"Re σ = {last.real:.7f} at s = 0"))
        told.append(f"{name} ∂σ/∂s = {first:.4g}, Re σ = {sigma.real:.7f} at s = 1 and {last.real:.7f} at s = 0")
    return Row(
        "the heat flux K*∇ν, times s",
        "(2.5), (2.7), 3.2",
        "K* = g4 T^(3/2) of Lun et al.; nothing of its weight",
        "; ".join(told),
        tuple(cases),
    )


REPRODUCTION = Reproduction(
    "parameters",
    "What the published growth rates depend on, by the adjoint",
    (
        *(Item(f"nu_m, {name}", by_number(name), in_quick=name == "mid") for name in SCENES),
        Item("wall", wall),
        Item("g0", radial),
        Item("K*", conduction),
    ),
)
