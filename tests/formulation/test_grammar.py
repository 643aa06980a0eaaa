"""Formulas as text: what they mean, and what is told where they mean nothing."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from shootstab.core.errors import InputError
from shootstab.formulation.domain import Domain
from shootstab.formulation.evaluation import on_arrays, on_mpmath
from shootstab.formulation.expression import Expression
from shootstab.formulation.names import Names

NAMES = Names(("u", "v"), {"R": 10000, "a": 0.1, "c": 1 - 2j}, {"U": "1 - z**2", "V": "U + d(U)"}, "lambda_", "z")

SAME = (
    ("d(u*U)", "U*d(u) - 2*z*u"),
    ("d(u, 3)", "d(d(d(u)))"),
    ("V*u", "(1 - z**2 - 2*z)*u"),
    ("-z**2*u", "-(z**2)*u"),
    ("2**-1*u", "u/2"),
    ("z^3*u", "z*z*z*u"),
    ("1e-3*u + 1j*v = 0", "u/1000 + i*v"),
    ("a*u", "u/10"),
    ("sqrt(1+z**2)**2*u", "(1+z**2)*u"),
    ("u*(1-z**2)/(1+z)", "u*(1-z)"),
    ("d(exp(sin(z))*u)", "exp(sin(z))*(d(u) + cos(z)*u)"),
    ("d(u/cosh(z))", "d(u)/cosh(z) - sinh(z)/cosh(z)**2*u"),
    ("c*u", "u - 2j*u"),
)
ZERO = (
    "sin(z)**2 + cos(z)**2 - 1",
    "d(tanh(z)) - 1 + tanh(z)**2",
    "exp(2*z) - exp(z)**2",
    "d(erf(z)) - 2/sqrt(pi)*exp(-z**2)",
    "z**0.5*z**0.5 - z",
)
NOT_ZERO = ("sin(z)**2 + cos(z)**2 - 1 + 1e-30", "tanh(z) - z")


def read(text: str) -> Expression:
    return NAMES.expression(text, "equation 1")


@pytest.mark.parametrize(("one", "other"), SAME)
def test_two_ways_to_write_the_same(one: str, other: str) -> None:
    assert Domain(-0.9, 1.0, {}).vanishing(read(one) - read(other))


def test_what_vanishes_and_what_does_not() -> None:
    vanishing = Domain(0.1, 1.0, {}).vanishing
    assert all(vanishing(read(text)) for text in ZERO)
    assert not any(vanishing(read(text)) for text in NOT_ZERO)


@pytest.mark.parametrize(
    "text",
    [
        "exp(-z)+log(2+z)",
        "sin(z)*cos(3*z)+tan(z/2)",
        "sinh(z)-cosh(z/3)",
        "tanh(2*z)*sech(z)",
        "erf(z)",
        "sqrt(3+z)**3",
        "(2+z)**(-1/3)",
        "pi/(1+z**2)",
    ],
)
def test_values_and_derivatives_on_doubles_and_on_mpmath(text: str) -> None:
    """The derivative by rules is that of mpmath's differences, at real and at complex z."""
    value, slope = read(text), read(f"d({text})")
    for z in (0.3, -0.2 + 0.4j):
        with mpmath.workdps(30):
            expected = mpmath.diff(lambda x: on_mpmath(x, {})(value), mpmath.mpmathify(z))
            assert abs(on_mpmath(mpmath.mpmathify(z), {})(slope) - expected) < 1e-12 * abs(expected)
        assert abs(on_arrays(np.array([z]), {})(slope)[0] - complex(expected)) < 1e-14 * max(1.0, abs(complex(expected)))


WRONG = (
    ("u + Re*v", "equation 1, column 5, at 'Re': unknown name 'Re': allowed are u, v"),
    ("(u + v", "equation 1, column 7, at the end: the parenthesis opened at column 1 is not closed here"),
    ("u + v)", "column 6, at '.': a parenthesis that was never opened"),
    ("sin(u)", "sin of an unknown or of the eigenvalue: the problem is not linear"),
    ("v/u", "column 2, at '/': a division by an unknown: the equation is not linear"),
    ("u/(1 - 1)", "a division by zero"),
    ("d(u, z)", "allowed is d.f. or d.f, n. with n from 0 to 16"),
    ("u**z", "a power of an unknown: allowed are natural ones"),
    ("R u", "column 3, at 'u': allowed is an operator or the end"),
    ("u $ v", "column 3: the character '.' has no meaning here"),
    ("__import__('os')", "the character"),
    ("U(u)", "'U' is no function: allowed are d, exp"),
    ("1e999999*u", "a number out of range"),
    ("(" * 100 + "u" + ")" * 100, "allowed are 60 parentheses"),
    ("sin*u", "sin is a function"),
)


@pytest.mark.parametrize(("text", "told"), WRONG)
def test_what_is_wrong_is_told_with_its_place(text: str, told: str) -> None:
    with pytest.raises(InputError, match=told):
        read(text)


def test_names_mean_one_thing() -> None:
    for words, told in (
        ((("u", "i"), {}, {}), "the name i is reserved and an unknown too"),
        ((("u",), {"u": 1}, {}), "the name u is an unknown and a parameter too"),
        ((("u",), {"2": 1}, {}), "the parameter '2': allowed is a name"),
        ((("u",), {}, {"A": "B", "B": "A"}), "A uses B uses A"),
    ):
        with pytest.raises(InputError, match=told):
            Names(*words).expression("A*u", "equation 1")


def test_sympy_expressions_mean_what_their_text_means() -> None:
    import sympy as sp

    z, R, s = sp.symbols("z R lambda_")
    u, v = (sp.Function(name)(z) for name in "uv")
    formula = sp.Eq(s * u + sp.I * (1 - z**2) * sp.tanh(z) * v, sp.diff(u, z, 2) / R - sp.sqrt(2) * sp.exp(-z) * sp.diff(v, z))
    text = "lambda_*u + i*U*tanh(z)*v - d(u,2)/R + sqrt(2)*exp(-z)*d(v)"
    assert Domain(-1, 1, {}).vanishing(NAMES.expression(formula, "equation 1") - read(text))
    with pytest.raises(InputError, match="equation 1, at Q: unknown name 'Q'"):
        NAMES.expression(sp.Symbol("Q") * u, "equation 1")
    with pytest.raises(InputError, match="the problem is not linear"):
        NAMES.expression(sp.sin(u), "equation 1")
