"""Constitutive functions of Lun et al. (1984) with the boundary functions of Richman (1988).

Every function here is written once, for anything that can be added, multiplied and raised to a power: floats (compiled by
numba), complex numbers, NumPy arrays, SymPy symbols, mpmath numbers and `Series`. ν-derivatives are taken by evaluating
them on a series in ν, never typed.

Units: grain diameter d, grain density ρ_p, normal gravity g cosθ.
Source: guide/theory.md 1.1; C. K. K. Lun, S. B. Savage, D. J. Jeffrey & N. Chepurniy, J. Fluid Mech. 140 (1984) 223.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from numba.extending import register_jitable

from shootstab.core.series import Series
from shootstab.models.chute.registry import RADIAL

RADIAL_DISTRIBUTIONS = {name: number for number, name in enumerate(RADIAL)}
LUN_SAVAGE, CARNAHAN_STARLING = RADIAL_DISTRIBUTIONS["lun-savage"], RADIAL_DISTRIBUTIONS["carnahan-starling"]
RADIAL_PARAMETERS = ("nu_max",)  # what a law holds beside its number, in this order: fields of Chute


@register_jitable
def radial(nu: Any, law: Any) -> Any:
    """(g0, g0′): the radial distribution at contact and its ν-derivative, by law = (number, *RADIAL_PARAMETERS), a tuple or an array.

    Lun & Savage: g0 = (1 − ν/ν_m)^(−5ν_m/2). Carnahan & Starling: g0 = (2 − ν)/(2(1 − ν)³).
    Only this function and `densest` look into a law.
    """
    nu_max = law[1]
    if law[0] == LUN_SAVAGE:
        gap = 1 - nu / nu_max
        g0 = gap ** (-5 * nu_max / 2)
        return g0, 5 * g0 / gap / 2
    gap = 1 - nu
    return (2 - nu) / gap**3 / 2, (5 - 2 * nu) / gap**4 / 2


@register_jitable
def densest(law: Any) -> Any:
    """The volume fraction below which a law is used: ν_m, at which grains are packed, in all of them."""
    return law[1]


@register_jitable
def f1(nu: Any, g0: Any, ep: Any) -> Any:
    """g1/ν, where p = g1 T: 1 + 4 η_p ν g0."""
    return 1 + 4 * ep * nu * g0


@register_jitable
def g2(nu: Any, g0: Any, ep: Any, pi: Any) -> Any:
    """η = g2 √T."""
    x = ep * nu * g0
    kinetic = (1 + 8 * x / 5) * (1 + 8 * (3 * ep - 2) * x / 5) / (ep * (2 - ep) * g0)
    return 5 * pi**0.5 / 96 * (kinetic + 768 * x * nu / (25 * pi))


@register_jitable
def _conduction(g0: Any, ep: Any, pi: Any) -> Any:
    return 25 * pi**0.5 / (16 * ep * (41 - 33 * ep)) / g0


@register_jitable
def g3(nu: Any, g0: Any, ep: Any, pi: Any) -> Any:
    """K = g3 √T."""
    x = ep * nu * g0
    bracket = (1 + 12 * x / 5) * (1 + 12 * ep * (4 * ep - 3) * x / 5) + 64 * (41 - 33 * ep) * x * x / (25 * pi)
    return _conduction(g0, ep, pi) * bracket


@register_jitable
def g4(nu: Any, g0: Any, dg0: Any, ep: Any, pi: Any) -> Any:
    """K* = g4 T^(3/2), the conductivity of the heat flux driven by ∇ν; dg0 = g0′."""
    x = ep * nu * g0
    return _conduction(g0, ep, pi) * (1 + 12 * x / 5) * (12 * ep * (2 * ep - 1) * (1 - ep) / 5) * (2 * g0 + nu * dg0)


@register_jitable
def f5(g0: Any, ep: Any, pi: Any) -> Any:
    """g5/ν², where γ = g5 T^(3/2)."""
    return 48 * ep * (1 - ep) / pi**0.5 * g0


@register_jitable
def f6(g0: Any, ep: Any, pi: Any) -> Any:
    """g6/ν², where ξ = g6 √T."""
    return 8 * ep / (3 * pi**0.5) * g0


class Coefficients(NamedTuple):
    """g1 … g6 of (2.7) at one ν (or array, or series), each a pair (value, ν-derivative); g1, g5, g6 also without ν, ν², ν²."""

    g1: Any
    g2: Any
    g3: Any
    g4: Any
    g5: Any
    g6: Any
    f1: Any
    f5: Any


def coefficients(nu: Any, ep: Any, law: Any, pi: Any) -> Coefficients:
    """All of them with their first ν-derivatives, from one evaluation on the series ν + x."""
    x = Series((nu, 1 + 0 * nu))
    g0, dg0 = radial(x, law)
    reduced1, reduced5, reduced6 = f1(x, g0, ep), f5(g0, ep, pi), f6(g0, ep, pi)
    return Coefficients(
        g1=x * reduced1,
        g2=g2(x, g0, ep, pi),
        g3=g3(x, g0, ep, pi),
        g4=g4(x, g0, dg0, ep, pi),
        g5=x * x * reduced5,
        g6=x * x * reduced6,
        f1=reduced1,
        f5=reduced5,
    )


@register_jitable
def reduced_pressure(nu: Any, ep: Any, law: Any) -> Any:
    """f1 = p/(νT) at ν itself."""
    return f1(nu, radial(nu, law)[0], ep)


@register_jitable
def steady(nu: Any, ep: Any, law: Any, pi: Any) -> Any:
    """(f1, g2, g3, g4, f5, g1, g1′): what the steady equations take, each at ν itself."""
    g0, dg0 = radial(nu, law)
    reduced = f1(nu, g0, ep)
    rest = g2(nu, g0, ep, pi), g3(nu, g0, ep, pi), g4(nu, g0, dg0, ep, pi), f5(g0, ep, pi)
    return reduced, *rest, nu * reduced, 1 + 8 * ep * nu * g0 + 4 * ep * nu * nu * dg0


@register_jitable
def wall_shear(nu: Any, g0: Any, pi: Any) -> Any:
    """A(ν) of (A 15)."""
    return 1 + (pi * pi / 288) ** 0.5 * (1 + 5 / (8 * nu * g0))


@register_jitable
def slip_coefficient(r: Any) -> Any:
    """κ(r) of (A 15), with the cancellation of 2/(1 + s) − s, s = √(1 − r²), at small r carried out: ⅔ r² (2 + s)/(1 + s)²."""
    s = (1 - r * r) ** 0.5
    return 2 * r * r * (2 + s) / (3 * (1 + s) * (1 + s))


def wall_normal(A: Any, r: Any) -> Any:
    """B of (A 16) for A = A(ν)."""
    return A * (r * r - 2) + slip_coefficient(r) + 2 * (1 - r * r) ** 0.5


def wall_dissipation(r: Any, e_w: Any, pi: Any) -> Any:
    """Δ of (A 18)."""
    return (2 / pi) ** 0.5 * 2 * (1 - e_w) / (1 + (1 - r * r) ** 0.5)
