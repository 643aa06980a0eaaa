"""The arithmetic of truncated series: a commutative ring with division and powers, over any coefficients, nested to any depth."""

from __future__ import annotations

from fractions import Fraction
from functools import reduce

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from shootstab.core.series import Series, constant, depth

x = sp.Symbol("x")
TERMS = 5

rationals = st.fractions(min_value=-5, max_value=5, max_denominator=7)
units = rationals.filter(lambda q: q != 0)
series = st.lists(rationals, min_size=TERMS, max_size=TERMS).map(Series)
invertible = st.tuples(units, *[rationals] * (TERMS - 1)).map(Series)
nested = st.lists(st.lists(rationals, min_size=3, max_size=3).map(Series), min_size=3, max_size=3).map(Series)
nested_invertible = st.tuples(
    st.tuples(units, rationals, rationals).map(Series), *[st.lists(rationals, min_size=3, max_size=3).map(Series)] * 2
).map(Series)
prove = settings(deadline=None, derandomize=True, max_examples=60)


def flat(s):
    """Coefficients of a nested series, one after the other."""
    return reduce(lambda head, c: head + flat(c), s.coefficients, []) if isinstance(s, Series) else [s]


def same(a, b):
    assert depth(a) == depth(b)
    assert flat(a) == flat(b)


def of(expression, terms, at=0):
    """The Taylor coefficients of a SymPy expression, by differentiation."""
    return [sp.nsimplify(sp.diff(expression, x, m).subs(x, at)) / sp.factorial(m) for m in range(terms)]


# ------------------------------------------------------------------------------------------------ ring identities
@prove
@given(series, series, series)
def test_commutative_ring(a, b, c):
    same(a + b, b + a)
    same((a + b) + c, a + (b + c))
    same(a * b, b * a)
    same((a * b) * c, a * (b * c))
    same(a * (b + c), a * b + a * c)
    same(a - b, a + (-b))
    same(a - a, constant(Fraction(0), TERMS))
    same(a * constant(Fraction(1), TERMS), a)
    same(a + constant(Fraction(0), TERMS), a)


@prove
@given(series, invertible, rationals, units)
def test_division_and_constants(a, b, q, unit):
    same((a / b) * b, a)
    same(a / b, a * (1 / b))
    same((q / b) * b, constant(q, TERMS))
    same(a + q, a + constant(q, TERMS))
    same(q + a, a + q)
    same(q - a, -(a - q))
    same(a - q, a + (-q))
    same(q * a, a * constant(q, TERMS))
    same(a * q, q * a)
    same((a / unit) * unit, a)


@prove
@given(nested, nested_invertible, nested)
def test_ring_of_nested_series(a, b, c):
    assert depth(a) == 2
    same(a * (b + c), a * b + a * c)
    same((a * b) * c, a * (b * c))
    same((a / b) * b, a)


@prove
@given(series, series)
def test_derivative_is_a_derivation(a, b):
    assert len(a.derivative()) == TERMS - 1
    same((a * b).derivative(), a.derivative() * b + a * b.derivative())
    same((a + b).derivative(), a.derivative() + b.derivative())


@prove
@given(st.integers(1, 7), st.integers(1, 7))
def test_the_shorter_operand_decides_how_many_terms_are_known(m, n):
    a, b = Series([Fraction(1)] * m), Series([Fraction(2)] * n)
    for result in (a + b, a - b, a * b, a / b):
        assert len(result) == min(m, n)


# ------------------------------------------------------------------------------------------------ powers
@prove
@given(invertible, st.integers(-4, 6))
def test_integer_powers_are_products(a, n):
    product = constant(Fraction(1), TERMS)
    for _ in range(abs(n)):
        product = product * a
    same(a**n, product if n >= 0 else 1 / product)


@prove
@given(st.lists(rationals, min_size=TERMS - 1, max_size=TERMS - 1), st.integers(0, 3))
def test_powers_up_to_three_allow_a_vanishing_constant_term(tail, n):
    a = Series([Fraction(0), *tail])
    product = constant(Fraction(1), TERMS)
    for _ in range(n):
        product = product * a
    same(a**n, product)


@pytest.mark.parametrize("exponent", [sp.Rational(1, 2), sp.Rational(-5, 2), sp.Rational(-31, 20), sp.Rational(4), sp.Integer(-1)])
def test_powers_against_sympy(exponent):
    f = 2 + 3 * x - x**2 / 3 + 5 * x**3
    power = Series(of(f, 7)) ** exponent
    assert [sp.simplify(a - b) for a, b in zip(power.coefficients, of(f**exponent, 7), strict=True)] == [0] * 7


def test_quotient_and_composition_against_sympy():
    t = Series((sp.Integer(0), sp.Integer(1), *[sp.Integer(0)] * 5))

    def formula(s):
        return (1 + s) ** sp.Rational(1, 2) * (3 - s * s) / (2 + s / (1 - 3 * s)) - s**3

    ours = formula(t).coefficients
    assert [sp.simplify(a - b) for a, b in zip(ours, of(formula(x), 7), strict=True)] == [0] * 7


@prove
@given(invertible, invertible)
def test_powers_multiply(a, b):
    """(a^r)(a^s) = a^(r+s) and (ab)^r = a^r b^r, in floating point."""
    a, b = (Series([abs(float(c[0])) + 1.0, *map(float, c.coefficients[1:])]) for c in (a, b))
    for left, right in ((a**0.3 * a**-1.7, a**-1.4), ((a * b) ** 0.5, a**0.5 * b**0.5), ((a**2.5) ** 0.4, a)):
        scale = max(map(abs, flat(left) + flat(right)))
        assert np.allclose(flat(left), flat(right), rtol=1e-11, atol=1e-12 * scale + 1e-9)


# ------------------------------------------------------------------------------------------------ nesting
def test_nested_series_are_mixed_partial_derivatives():
    """f(x + s, y + t): the outer series is in t, its coefficients are series in s."""
    s_, t_ = sp.symbols("s t")
    px, py = sp.Rational(3, 2), sp.Rational(2, 3)

    def f(a, b):
        return a**2 * b / (1 + a * b) + b**3 / (a - b / 4)

    inner = Series((px, sp.Integer(1), sp.Integer(0)))
    zero = 0 * inner
    mixed = f(Series((inner, zero, zero, zero)), Series((py + zero, 1 + zero, zero, zero)))
    assert mixed.depth == 2 and len(mixed) == 4
    expression = f(px + s_, py + t_)
    for j in range(4):
        for i in range(3):
            partial = sp.diff(expression, t_, j, s_, i).subs({s_: 0, t_: 0}) / sp.factorial(i) / sp.factorial(j)
            coefficient = mixed[j][i] if isinstance(mixed[j], Series) else mixed[j] * (i == 0)
            assert sp.simplify(coefficient - partial) == 0


@prove
@given(nested_invertible, invertible.map(lambda c: Series(c.coefficients[:3])))
def test_the_deeper_operand_takes_the_other_as_a_constant(outer, inner):
    lifted = Series((inner, 0 * inner, 0 * inner))
    assert (depth(outer), depth(inner), depth(lifted)) == (2, 1, 2)
    same(outer + inner, outer + lifted)
    same(inner + outer, lifted + outer)
    same(outer - inner, outer - lifted)
    same(inner - outer, lifted - outer)
    same(outer * inner, outer * lifted)
    same(inner * outer, lifted * outer)
    same(outer / inner, outer / lifted)
    same(inner / outer, lifted / outer)


def test_depth_of_what_is_not_a_series_is_zero():
    assert [depth(c) for c in (1, 2.0, 1j, np.zeros(3), mpmath.mpf(1), x)] == [0] * 6
    assert depth(Series((Series((Series((1,)),)),))) == 3
    assert depth(Series((1.0, Series((1.0, 2.0))))) == 2


# ------------------------------------------------------------------------------------------------ coefficients of many kinds
@pytest.mark.parametrize(
    "number",
    [
        2,
        2.5,
        2 + 1j,
        np.float64(2.5),
        np.complex128(1 - 2j),
        mpmath.mpf("2.5"),
        mpmath.mpc(1, 2),
        Fraction(5, 2),
        sp.Rational(5, 2),
        sp.I + 2,
    ],
    ids=lambda n: type(n).__name__,
)
def test_every_number_works_from_both_sides(number):
    one = number * 0 + 1
    a = Series((3 * one, one, 2 * one))
    for result, head in (
        (number + a, number + 3), (a + number, number + 3), (number - a, number - 3), (a - number, 3 - number),
        (number * a, 3 * number), (a * number, 3 * number), (number / a, number / (3 * one)), (a / number, 3 * one / number),
    ):  # fmt: skip
        assert isinstance(result, Series) and len(result) == 3 and result.depth == 1
        assert abs(complex(result[0]) - complex(head)) <= 1e-15 * abs(complex(head))


def test_arrays_are_coefficients_never_containers():
    """A series over arrays is the array of the series, on whichever side the array stands."""
    rng = np.random.default_rng(3)
    nodes, weights = rng.uniform(1, 2, 4), rng.uniform(1, 2, 4)

    def formula(s, w):
        return w * s / (1 + s) + (w - s**2.5) / w - w / s + (s * s - w) ** 3

    whole = formula(Series((nodes, 1 + 0 * nodes, 0 * nodes, 0 * nodes)), weights)
    assert isinstance(whole, Series) and len(whole) == 4
    for i in range(4):
        single = formula(Series((nodes[i], 1.0, 0.0, 0.0)), weights[i])
        for m in range(4):
            assert np.shape(whole[m]) == (4,)
            assert whole[m][i] == pytest.approx(single[m], rel=1e-12, abs=1e-12)
    assert isinstance(nodes * Series((1.0, 2.0)), Series) and isinstance(nodes / Series((1.0, 2.0)), Series)
    assert isinstance(np.float64(2.0) ** 1 - Series((1.0, 2.0)), Series)


def test_two_terms_are_a_dual_number():
    """f + f′ε against a complex step, which shares no arithmetic with it."""

    def f(s):
        return s**1.7 * (3 - s) ** -0.5 / (1 + s * s) + 2 / s

    dual = f(Series((0.8, 1.0)))
    assert dual[0] == pytest.approx(f(0.8), rel=1e-15, abs=0.0)
    assert dual[1] == pytest.approx(f(0.8 + 1e-40j).imag / 1e-40, rel=1e-14, abs=0.0)


def test_mpmath_coefficients_keep_their_digits():
    with mpmath.workdps(60):
        c = Series((mpmath.mpf(2), mpmath.mpf(1), mpmath.mpf(0), mpmath.mpf(0))) ** (mpmath.mpf(1) / 3)
        expected = mpmath.taylor(lambda t: mpmath.cbrt(2 + t), 0, 3)
        assert max(abs(a - b) for a, b in zip(c.coefficients, expected, strict=True)) < mpmath.mpf("1e-55")


def test_repr_and_length():
    s = Series((1, 2, 3))
    assert len(s) == 3 and s[2] == 3 and repr(s) == "Series(1, 2, 3)"
