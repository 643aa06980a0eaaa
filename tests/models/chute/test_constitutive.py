"""The constitutive functions against the table of guide/theory.md 1.1, which `linearization.table` states in SymPy on its own."""

from __future__ import annotations

import itertools
import math

import mpmath
import numpy as np
import pytest
import sympy as sp
from linearization import EP, NU, NU_MAX, evaluator, table
from numba import njit

from shootstab.core.errors import InputError, ShootstabError
from shootstab.core.series import Series
from shootstab.models.chute import constitutive as law
from shootstab.models.chute.parameters import Chute
from shootstab.models.chute.registry import BY_NAME

RADIAL = list(law.RADIAL_DISTRIBUTIONS)
NAMES = ("g0", "g1", "g2", "g3", "g4", "g5", "g6", "A")
NUS = (1e-12, 0.003, 0.11, 0.37, 0.58)
RESTITUTIONS = (0.3, 0.8, 0.95)
NU_M = 0.62


def direct(nu, ep, radial, pi):
    """g0 … g6 and A from the functions themselves, in the order of NAMES; nothing but arithmetic on nu."""
    g0, dg0 = law.radial(nu, radial)
    return (
        g0,
        nu * law.f1(nu, g0, ep),
        law.g2(nu, g0, ep, pi),
        law.g3(nu, g0, ep, pi),
        law.g4(nu, g0, dg0, ep, pi),
        nu * nu * law.f5(g0, ep, pi),
        nu * nu * law.f6(g0, ep, pi),
        law.wall_shear(nu, g0, pi),
    )


compiled = njit(
    lambda nu, ep, radial, pi: (
        law.radial(nu, radial)[0],
        nu * law.f1(nu, law.radial(nu, radial)[0], ep),
        law.g2(nu, law.radial(nu, radial)[0], ep, pi),
        law.g3(nu, law.radial(nu, radial)[0], ep, pi),
        law.g4(nu, law.radial(nu, radial)[0], law.radial(nu, radial)[1], ep, pi),
        nu * nu * law.f5(law.radial(nu, radial)[0], ep, pi),
        nu * nu * law.f6(law.radial(nu, radial)[0], ep, pi),
        law.wall_shear(nu, law.radial(nu, radial)[0], pi),
    )
)

CASES = list(itertools.product(RADIAL, NUS, RESTITUTIONS))


# ------------------------------------------------------------------------------------------------ values
@pytest.mark.parametrize("radial", RADIAL)
def test_symbolically_equal_to_the_table(radial):
    """With ν, η_p and ν_m symbols, every function is the table's expression: equal at 50 digits at random points, for SymPy arguments."""
    ours = direct(NU, EP, (law.RADIAL_DISTRIBUTIONS[radial], NU_MAX), sp.pi)
    for name, expression in zip(NAMES[:-1], ours[:-1], strict=True):  # SymPy takes (π²/288)**0.5 of A for a float; 60 digits below
        for nu, ep in ((sp.Rational(1, 7), sp.Rational(9, 10)), (sp.Rational(5, 11), sp.Rational(2, 3))):
            point = {NU: nu, EP: ep, NU_MAX: sp.Rational(16, 25)}
            # pi**0.5 is a float power to SymPy: make it the root that it is
            exact = sp.nsimplify(expression, rational=True)
            assert abs(sp.N((exact - table(radial)[name]).subs(point), 60)) < sp.Float("1e-50"), name


@pytest.mark.parametrize(("radial", "nu", "e"), CASES)
def test_values(radial, nu, e):
    ep, model = (1 + e) / 2, law.RADIAL_DISTRIBUTIONS[radial]
    with mpmath.workdps(30):
        expected = evaluator(radial, NAMES, 0, "mpmath")(mpmath.mpf(nu), mpmath.mpf(ep), mpmath.mpf(NU_M))
    for function in (direct, compiled):
        for name, got, value in zip(NAMES, function(nu, ep, (model, NU_M), math.pi), expected, strict=True):
            assert got == pytest.approx(float(value), rel=2e-14, abs=0.0), name


@pytest.mark.parametrize("radial", RADIAL)
@pytest.mark.parametrize("nu", NUS)
def test_compiled_and_uncompiled_agree_for_complex_arguments(radial, nu):
    ep, model = 0.9, law.RADIAL_DISTRIBUTIONS[radial]
    for argument in (nu + 0.02j, nu * (1 - 0.3j)):
        for name, a, b in zip(
            NAMES, direct(argument, ep, (model, NU_M), math.pi), compiled(argument, ep, (model, NU_M), math.pi), strict=True
        ):
            assert abs(a - b) <= 1e-14 * abs(a), name


@pytest.mark.parametrize("radial", RADIAL)
def test_arrays_and_scalars_agree(radial):
    nu, model = np.array(NUS), law.RADIAL_DISTRIBUTIONS[radial]
    whole = direct(nu, 0.9, (model, NU_M), math.pi)
    for i, value in enumerate(NUS):
        for name, a, b in zip(NAMES, whole, direct(value, 0.9, (model, NU_M), math.pi), strict=True):
            assert a[i] == pytest.approx(b, rel=1e-14, abs=0.0), name


@pytest.mark.parametrize("radial", RADIAL)
@pytest.mark.parametrize("digits", [40, 60])
def test_no_double_constant_hides_in_the_formulas(radial, digits):
    """With mpmath arguments all digits are right: a 2**0.5 or a 0.6 in a formula would leave 1e−17."""
    with mpmath.workdps(digits):
        nu, ep, nu_max = mpmath.mpf("0.337"), mpmath.mpf("0.91"), mpmath.mpf("0.63")
        got = direct(nu, ep, (law.RADIAL_DISTRIBUTIONS[radial], nu_max), mpmath.pi)
        g = law.coefficients(nu, ep, (law.RADIAL_DISTRIBUTIONS[radial], nu_max), mpmath.pi)
    with mpmath.workdps(digits + 10):
        expected = evaluator(radial, NAMES, 0, "mpmath")(nu, ep, nu_max)
        slopes = evaluator(radial, NAMES, 1, "mpmath")(nu, ep, nu_max)
        bound = mpmath.mpf(10) ** (5 - digits)
        for name, a, b in zip(NAMES, got, expected, strict=True):
            assert abs(a - b) <= bound * abs(b), name
        for name, b, b_nu in zip(NAMES[1:7], expected[1:7], slopes[1:7], strict=True):
            a, a_nu = getattr(g, name).coefficients
            assert abs(a - b) <= bound * abs(b) and abs(a_nu - b_nu) <= bound * abs(b_nu), name


@pytest.mark.parametrize("digits", [40, 60])
def test_no_double_constant_hides_in_the_wall_functions(digits):
    r, e_w = sp.Rational(37, 100), sp.Rational(81, 100)
    s = sp.sqrt(1 - r**2)
    kappa = sp.Rational(2, 3) * (2 / (1 + s) - s)
    A = sp.Rational(17, 10)
    exact = (kappa, A * (r**2 - 2) + kappa + 2 * s, sp.sqrt(2 / sp.pi) * 2 * (1 - e_w) / (1 + s))
    with mpmath.workdps(digits):
        roughness, hardness, shear = mpmath.mpf("0.37"), mpmath.mpf("0.81"), mpmath.mpf("1.7")
        got = law.slip_coefficient(roughness), law.wall_normal(shear, roughness), law.wall_dissipation(roughness, hardness, mpmath.pi)
        for a, b in zip(got, exact, strict=True):
            assert abs(a - mpmath.mpmathify(str(sp.N(b, digits + 10)))) <= mpmath.mpf(10) ** (3 - digits)


# ------------------------------------------------------------------------------------------------ derivatives
@pytest.mark.parametrize(("radial", "nu", "e"), CASES)
def test_derivatives(radial, nu, e):
    """`coefficients` against SymPy's derivative, and against a complex step through the functions themselves."""
    ep, model = (1 + e) / 2, law.RADIAL_DISTRIBUTIONS[radial]
    g = law.coefficients(nu, ep, (model, NU_M), math.pi)
    with mpmath.workdps(30):
        arguments = (mpmath.mpf(nu), mpmath.mpf(ep), mpmath.mpf(NU_M))
        values = dict(zip(NAMES, evaluator(radial, NAMES, 0, "mpmath")(*arguments), strict=True))
        slopes = dict(zip(NAMES, evaluator(radial, NAMES, 1, "mpmath")(*arguments), strict=True))
    step = dict(zip(NAMES, direct(nu + 1e-50j, ep, (model, NU_M), math.pi), strict=True))
    for name in NAMES[1:7]:
        value, slope = getattr(g, name).coefficients
        size = abs(float(slopes[name])) + abs(float(values[name]))  # a derivative may vanish where the function does not
        assert value == pytest.approx(float(values[name]), rel=2e-14, abs=0.0), name
        assert slope == pytest.approx(float(slopes[name]), rel=1e-12, abs=1e-13 * size), name
        assert slope == pytest.approx(step[name].imag / 1e-50, rel=1e-12, abs=1e-13 * size), name


@pytest.mark.parametrize(("radial", "nu"), list(itertools.product(RADIAL, NUS)))
def test_radial_derivative(radial, nu):
    model = law.RADIAL_DISTRIBUTIONS[radial]
    with mpmath.workdps(30):
        for order in (1, 2):
            expected = evaluator(radial, ("g0",), order, "mpmath")(mpmath.mpf(nu), mpmath.mpf(1), mpmath.mpf(NU_M))[0]
            g0, dg0 = law.radial(Series((nu, 1.0)), (model, NU_M))
            got = (g0[1], dg0[1])[order - 1]
            assert got == pytest.approx(float(expected), rel=1e-13, abs=0.0)
            assert dg0[0] == pytest.approx(g0[1], rel=1e-14, abs=0.0)


def test_reduced_functions_are_g1_g5_g6_without_their_powers_of_nu():
    """They hold their value where g1, g5, g6 underflow."""
    g = law.coefficients(1e-200, 0.9, (law.LUN_SAVAGE, NU_M), math.pi)
    assert g.f1[0] == 1.0 and g.g5[0] == 0.0
    assert g.f5[0] == pytest.approx(48 * 0.9 * 0.1 / math.sqrt(math.pi), rel=1e-15, abs=0.0)
    g = law.coefficients(0.2, 0.9, (law.LUN_SAVAGE, NU_M), math.pi)
    assert g.g1[0] == pytest.approx(0.2 * g.f1[0], rel=1e-15, abs=0.0) and g.g5[0] == pytest.approx(0.04 * g.f5[0], rel=1e-15, abs=0.0)


# ------------------------------------------------------------------------------------------------ limits
@pytest.mark.parametrize("radial", RADIAL)
@pytest.mark.parametrize("e", RESTITUTIONS)
def test_dilute_limits(radial, e):
    """ν → 0: a gas. g0 = 1, p = νT; the viscosity and the conductivities tend to constants; approached as O(ν)."""
    ep, model = (1 + e) / 2, law.RADIAL_DISTRIBUTIONS[radial]
    root_pi = math.sqrt(math.pi)
    dg0 = {"lun-savage": 2.5, "carnahan-starling": 2.5}[radial]
    limit = {
        "g0": 1.0,
        "g2": 5 * root_pi / (96 * ep * (2 - ep)),
        "g3": 25 * root_pi / (16 * ep * (41 - 33 * ep)),
        "g4": 25 * root_pi / (16 * ep * (41 - 33 * ep)) * 12 / 5 * ep * (2 * ep - 1) * (1 - ep) * 2,
    }
    at_zero = dict(zip(NAMES, direct(np.array(1e-200), ep, (model, NU_M), math.pi), strict=True))
    for name, value in limit.items():
        assert float(at_zero[name]) == pytest.approx(value, rel=1e-14, abs=1e-300), name
    assert law.radial(1e-200, (model, NU_M))[1] == pytest.approx(dg0, rel=1e-14, abs=0.0)
    for nu, bound in ((1e-4, 1e-2), (1e-6, 1e-4)):
        g = dict(zip(NAMES, direct(nu, ep, (model, NU_M), math.pi), strict=True))
        for name, value in limit.items():
            assert abs(g[name] - value) <= bound * max(abs(value), 1e-12)
        assert abs(g["g1"] / nu - 1) <= bound
        assert g["g5"] / nu**2 == pytest.approx(48 / root_pi * ep * (1 - ep), rel=bound, abs=0.0)
        assert g["g6"] / nu**2 == pytest.approx(8 / (3 * root_pi) * ep, rel=bound, abs=0.0)


def test_elastic_grains_dissipate_nothing_and_carry_no_heat_along_grad_nu():
    for model in (law.LUN_SAVAGE, law.CARNAHAN_STARLING):
        g = law.coefficients(0.3, 1.0, (model, NU_M), math.pi)
        assert g.g4[0] == 0.0 and g.g5[0] == 0.0 and g.g4[1] == 0.0 and g.g5[1] == 0.0


def test_lun_savage_diverges_at_nu_max_and_carnahan_starling_does_not():
    assert law.radial(NU_M * (1 - 1e-12), (law.LUN_SAVAGE, NU_M))[0] > 1e18
    assert law.radial(NU_M, (law.CARNAHAN_STARLING, NU_M))[0] == pytest.approx((2 - NU_M) / (2 * (1 - NU_M) ** 3), rel=1e-15, abs=0.0)


# ------------------------------------------------------------------------------------------------ parameters
GOOD = {"e": 0.8, "e_w": 0.8, "r": 0.6, "tan_theta": 0.3}


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("e", 0.0), ("e", -0.1), ("e", 1.0001), ("e", math.nan), ("e_w", 0.0), ("e_w", 1.1), ("e_w", math.nan),
        ("r", -0.1), ("r", 1.0), ("r", math.nan), ("tan_theta", 0.0), ("tan_theta", -0.3), ("tan_theta", math.inf), ("tan_theta", math.nan),
        ("nu_max", 0.0), ("nu_max", 1.0), ("nu_max", math.nan), ("radial", "lun"), ("wall", "rough"),
    ],
)  # fmt: skip
def test_unphysical_parameters_are_named_with_what_is_allowed(name, value):
    with pytest.raises(InputError) as caught:
        Chute(**{**GOOD, name: value})
    text = str(caught.value)
    assert text.startswith(f"{name} = {value!r}") and "allowed is" in text and "\n" not in text
    assert isinstance(caught.value, ShootstabError) and isinstance(caught.value, ValueError)


@pytest.mark.parametrize("temperature", [0.0, -1.0, math.inf, math.nan])
def test_unphysical_far_temperature(temperature):
    with pytest.raises(InputError, match=r"^far_temperature = .*: allowed is a finite number above 0$"):
        BY_NAME["far_temperature"].check(temperature)


def test_chute_numbers():
    chute = Chute(**GOOD, radial="carnahan-starling")
    delta = math.sqrt(2 / math.pi) * 2 * 0.2 / (1 + 0.8)
    assert chute.numbers == pytest.approx([0.9, 0.3, 0.6, delta, law.CARNAHAN_STARLING, 0.62], rel=1e-15, abs=0.0)
    assert chute.radial_law == (law.CARNAHAN_STARLING, 0.62) and Chute(**GOOD).radial_law == (law.LUN_SAVAGE, 0.62)
    assert (Chute(**GOOD).nu_max, Chute(**GOOD).wall) == (0.62, "printed")
    for e, e_w in ((1.0, 1.0), (1e-3, 1e-3)):
        Chute(**{**GOOD, "e": e, "e_w": e_w})
