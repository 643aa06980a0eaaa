"""Many digits with ends at infinity: exact eigenvalues on lines and half-lines, the series in the exponential, what is refused and why."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import mpmath
import pytest

import shootstab as st
from shootstab.analyses.refine_digits import refine_digits
from shootstab.core.errors import InputError
from shootstab.formulation.evaluation import on_mpmath
from shootstab.formulation.exponentials import exponential_end
from shootstab.formulation.expression import number
from shootstab.formulation.far_coefficients import kept_far_out
from shootstab.formulation.names import Names
from shootstab.formulation.state_pencil import StatePencil

LINE = st.Infinity(), st.Infinity()


def system_of(formula: str) -> StatePencil:
    """ψ′ = (formula) ψ."""
    entry = Names(("y",), {}, {}).expression(formula, "a test")
    return StatePencil(1, ({(0, 0): number(1)}, {}), ({(0, 0): entry}, {}), ({},), ({},), 0, 0)


@pytest.mark.parametrize("direction", [-1, 1])
@pytest.mark.parametrize(
    ("formula", "rate"),
    [
        ("tanh(2*z) + sech(z - 1/3)", 1),
        ("(1 + 3*tanh(z/2 + 1))**-2 + sqrt(2)*sech(3*z/2)**2", Fraction(1, 2)),
        ("tanh(-z*sqrt(3))**3/(2 + tanh(z*sqrt(3)))", 2 * mpmath.sqrt(3)),
        ("1/cosh(z) + sinh(z - 1)/cosh(z)**3", 1),
    ],
)
def test_coefficients_in_the_exponential_are_what_they_were(formula: str, rate: Any, direction: int) -> None:
    system = system_of(formula)
    end = exponential_end(system, direction)
    with mpmath.workdps(40):
        z = mpmath.mpf(direction) * mpmath.mpf("1.7")
        kappa = on_mpmath(z, {})(end.rate)
        assert abs(kappa - mpmath.mpmathify(rate)) < mpmath.mpf(10) ** -12
        there = on_mpmath(mpmath.exp(-kappa * direction * z), {})(end.D[0][0, 0])
        assert abs(there - on_mpmath(z, {})(system.D[0][0, 0])) < mpmath.mpf(10) ** -38


def test_a_coefficient_that_decays_towards_one_end_alone() -> None:
    end = exponential_end(system_of("exp(-3*z) + exp(-2*z)"), 1)
    assert end.rate == number(1)
    with pytest.raises(InputError, match=r"at -infinity the coefficient .* grows: allowed are coefficients that come to a limit"):
        exponential_end(system_of("exp(-3*z) + exp(-2*z)"), -1)


def well(nu: str, **changed: Any) -> Any:
    settings: dict[str, Any] = {"where": {"nu": nu, "V": "nu*(nu + 1)*sech(x)**2"}, "eigenvalue": "s", "variable": "x", **changed}
    return st.equations(["y"], ["d(y,2) + V*y = s*y"], *LINE, **settings)


def test_wells_on_the_line() -> None:
    """Pöschl & Teller: s = (ν − j)²; on a stretched and shifted line over the square of the stretch."""
    shifted = well("2", where={"V": "6*sech(x/3 - 1)**2/9"})
    for problem, exact, digits in ((well("1/5"), Fraction(1, 25), 40), (well("7/2"), Fraction(25, 4), 16), (shifted, Fraction(1, 9), 16)):
        mode = st.refine(problem, float(exact) * 1.001, digits=digits)
        with mpmath.workdps(50):
            assert abs(mode.sigma - mpmath.mpf(exact.numerator) / exact.denominator) <= mode.error < mpmath.mpf(10) ** -digits


@pytest.mark.parametrize(("side", "arithmetic"), [(-1, "mpmath"), (1, "flint")])
def test_a_half_line_by_a_bessel_function(side: int, arithmetic: str) -> None:
    """y″ + 9 e^{−|x|} y = s y, y(0) = 0: y = J_{2√s}(6 e^{−|x|/2}), so that J_{2√s}(6) = 0."""
    ends = (st.Conditions(0, ["y"]), st.Infinity())
    written = f"d(y,2) + 9*exp({-side}*z)*y = s*y"
    problem = st.equations(["y"], [written], *(ends if side > 0 else ends[::-1]), eigenvalue="s")
    with mpmath.workdps(45):
        exact = mpmath.findroot(lambda s: mpmath.besselj(2 * mpmath.sqrt(s), 6), 1.2)
        assert abs(refine_digits(problem, complex(exact), 30, arithmetic=arithmetic).sigma - exact) < mpmath.mpf(10) ** -29


def test_constant_coefficients_and_the_eigenvalue_in_a_condition() -> None:
    """y = e^{−√(1+s) z}, y′ = −s y at 0: s² = 1 + s."""
    problem = st.equations(["y"], ["d(y,2) = (1 + s)*y"], st.Conditions(0, ["d(y) + s*y"]), st.Infinity(), eigenvalue="s")
    with mpmath.workdps(40):
        assert abs(st.refine(problem, 1.6, digits=35).sigma - mpmath.phi) < mpmath.mpf(10) ** -34


def test_a_decaying_space_that_is_defective() -> None:
    """(d² − 1)² y = s sech² z y: both exponents are 1 whatever s is."""
    problem = st.equations(["y"], ["d(y,4) - 2*d(y,2) + y = s*sech(z)**2*y"], *LINE, eigenvalue="s")
    double = st.refine(problem, 2.6)
    mode = st.refine(problem, double.sigma, digits=14)
    assert mode.converged
    assert abs(complex(mode.sigma) - double.sigma) <= double.error


def test_a_shear_layer_in_primitive_variables() -> None:
    """A. Michalke, J. Fluid Mech. 19 (1964) 543: 0.1897; the digits are those of φ″ alone."""
    layer = st.equations(
        ["u", "v", "p"],
        ["(sigma + i*a*U)*u + v*d(U) + i*a*p = 0", "(sigma + i*a*U)*v + d(p) = 0", "i*a*u + d(v) = 0"],
        *LINE,
        parameters={"a": 0.4446},
        where={"U": "tanh(z)"},
    )
    rayleigh = st.equations(
        ["f"], ["(sigma + i*a*U)*(d(f,2) - a**2*f) = i*a*d(U,2)*f"], *LINE, parameters={"a": 0.4446}, where={"U": "tanh(z)"}
    )
    found = [st.refine(problem, 0.19, digits=14).sigma for problem in (layer, rayleigh)]
    assert abs(found[0] - found[1]) < 1e-13
    assert abs(complex(found[0]) - 0.189702025683) < 1e-12


def test_solutions_with_logarithms() -> None:
    """b″ = (s + 1)² b + e^{−z} a with a = e^{−sz} has z e^{−(s+1)z}: no series in the exponential, but one beyond which it is nothing."""
    problem = st.equations(
        ["a", "b"],
        ["d(a,2) = s**2*a", "d(b,2) = (s + 1)**2*b + exp(-z)*a"],
        st.Conditions(0, ["d(a) + 3*b", "d(b) + a"]),
        st.Infinity(),
        eigenvalue="s",
    )
    with mpmath.workdps(35):
        exact = mpmath.findroot(lambda s: 1 - s * (s + 1) / 3 - 1 / (2 * (s + 1)), 1.1)
    assert abs(st.refine(problem, 1.1).sigma - complex(exact)) < 1e-10
    mode = st.refine(problem, 1.1, digits=20)
    with mpmath.workdps(35):
        assert abs(mode.sigma - exact) <= mode.error < 1e-20


def test_coefficients_that_oscillate_while_they_decay() -> None:
    """w sech(x) with w = 2 + sin(x) sech(x) solves u″ = (1 + V) u exactly: σ = 1."""
    slope, second = "(cos(x)*sech(x) - sin(x)*sech(x)*tanh(x))", "(2*cos(x)*sech(x)*tanh(x) + 2*sin(x)*sech(x)**3)"
    V = f"2*sech(x)**2 + (2*tanh(x)*{slope} + {second})/(2 + sin(x)*sech(x))"
    problem = st.equations(["u"], ["d(u,2) + V*u = sigma*u"], *LINE, where={"V": V}, variable="x")
    mode = st.refine(problem, 0.9999, digits=30)
    with mpmath.workdps(40):
        assert abs(mode.sigma - 1) <= mode.error < 1e-30


@pytest.mark.parametrize("V", ["sech(x)**2*(2 + exp(i*x))", "exp(-x**2)*(2 + cos(x**2))", "sech(x)**2*(2 + cos((1 + i/4)*x))"])
def test_oscillations_beside_what_decays_have_the_digits_that_doubles_have(V: str) -> None:
    problem = st.equations(["u"], ["d(u,2) + V*u = sigma*u"], *LINE, where={"V": V}, variable="x")
    double = st.refine(problem, 1.5)
    mode = st.refine(problem, double.sigma, digits=16)
    assert mode.converged
    assert abs(complex(mode.sigma) - double.sigma) <= double.error


@pytest.mark.parametrize(
    ("V", "told"),
    [
        ("1e-20*sin(x)", r"sin\(x\) has no limit"),
        ("1e-20*exp(i*x)", r"exp\(i\*x\) has no limit"),
        ("1e-20*sech(x)*cos(2*i*x)", r"the coefficient .*cos\(2\*i\*x\)\*sech\(x\) grows exponentially"),
    ],
)
def test_what_has_no_series_at_infinity_is_refused_in_the_users_names(V: str, told: str) -> None:
    entry = Names(("u",), {}, {}, variable="x")
    formula = entry.expression(V, "a test")
    with pytest.raises(InputError, match=f"at .infinity {told}"):
        kept_far_out(formula, 1, "at +infinity", entry.text)


def test_a_logarithm_at_infinity_is_refused_by_its_name() -> None:
    with pytest.raises(
        InputError, match=r"at -infinity log\(2 \+ x\*\*2\) grows as a logarithm: allowed are coefficients that go as powers"
    ):
        st.equations(["u"], ["-d(u,2) + log(2 + x**2)*u = sigma*u"], *LINE, variable="x")


def test_what_has_no_series_in_the_exponential_is_told_in_the_users_names() -> None:
    """Both ways are refused: 1/(1 + x²) beside the exponential, and a sine that does not decay to many digits."""
    problem = st.equations(["u"], ["d(u,2) + (2*sech(x)**2 + 1e-25*sin(x))*u = sigma*u"], *LINE, variable="x", reference=1.0)
    with pytest.raises(
        InputError, match=r"more than 12 digits: at -infinity sin\(x\) is not rational .*, and at -infinity sin\(x\) has no limit"
    ):
        st.refine(problem, 1.0, digits=20)
