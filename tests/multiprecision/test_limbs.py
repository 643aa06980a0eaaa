"""Numbers and series in limbs against the numbers themselves, and compiled recurrences against those of mpmath and of relaxed series."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from mpmath import mpf

pytest.importorskip("flint")

from shootstab.kernels.limbs import HALF_LIMB, LIMB_BITS, LIMB_MASK, add_convolution, add_product, balance, divide
from shootstab.multiprecision.backends import choose
from shootstab.multiprecision.limb_numbers import binary, ends_of, exponent_of, limbs_of, numbers_of, planes
from shootstab.multiprecision.limb_transport import carried_by, terms_of
from shootstab.multiprecision.relaxed_series import RelaxedSystem

FLINT, MPMATH = choose("flint"), choose("mpmath")
DIGITS = 60
CLOSE = mpf(10) ** (4 - DIGITS)


def whole(limbs: Any) -> int:
    """The integer of which the last limb is the unit."""
    total = 0
    for limb in limbs:
        total = (total << LIMB_BITS) + int(limb)
    return total


def drawn(source: random.Random, size: int) -> list[int]:
    """Limbs, the largest ones among them."""
    return [source.choice((0, -HALF_LIMB, HALF_LIMB - 1, source.randrange(-HALF_LIMB, HALF_LIMB))) for _ in range(size)]


def test_products_sums_and_quotients_of_limbs_are_exact() -> None:
    source = random.Random(1)
    for _ in range(200):
        x, y = drawn(source, 4), drawn(source, 3)
        acc = np.zeros(9, dtype=np.int64)
        add_product(acc, 3, 1, np.array(x), np.array(y))
        assert whole(acc[:9]) == whole(x) * whole(y)
        add_product(acc, 3, -1, np.array(x), np.array(y))
        assert not acc.any()
        big, m = np.array([0, 0, *drawn(source, 4)]), source.randrange(1, 2000)
        before = whole(big)
        divide(big, m)
        assert whole(big) == before // m
        loose = np.array([0, *(source.randrange(-(1 << 62), 1 << 62) for _ in range(4))])
        before = whole(loose)
        balance(loose)
        assert whole(loose) == before
        assert all(-HALF_LIMB <= limb < HALF_LIMB for limb in loose[1:])
    assert LIMB_MASK + 1 == 2 * HALF_LIMB


def test_a_convolution_of_limbs_is_exact_and_may_begin_late() -> None:
    source = random.Random(2)
    a, b = (np.array([drawn(source, 12) for _ in range(3)]) for _ in range(2))
    a[0, 7:], b[:, 9:] = 0, 0
    for m, first in ((0, 0), (5, 0), (11, 0), (11, 1), (3, 1)):
        acc = np.zeros(8, dtype=np.int64)
        add_convolution(acc, 3, -1, a, ends_of(a), b, ends_of(b), m, first)
        assert whole(acc) == -sum(whole(a[:, j]) * whole(b[:, m - j]) for j in range(first, m + 1))


def test_numbers_come_back_from_limbs() -> None:
    source = random.Random(3)
    with FLINT.working(DIGITS):
        numbers = [FLINT.number(Fraction(source.randrange(-(10**30), 10**30), 10 ** source.randrange(20, 40))) for _ in range(50)]
        near = [sign * FLINT.number(2) ** k * (1 - FLINT.number(2) ** -150) for k in range(-60, 60) for sign in (1, -1)]
        numbers += [FLINT.rounded(x) for x in near]  # limbs that are HALF_LIMB, but for the last place
        numbers.append(FLINT.number(0))
        parts = [binary(x) for x in numbers]
        sizes = [exponent_of([x]) or 0 for x in parts]
        columns = limbs_of(parts, sizes)
        assert columns.shape == (planes(), 291)
        assert np.all((columns >= -HALF_LIMB) & (columns < HALF_LIMB))
        back = numbers_of(columns, sizes, [3] * 291)
        assert all(y == 8 * x for x, y in zip(numbers, back, strict=True))
        assert exponent_of(parts[290:]) is None


def system(arithmetic: Any, source: random.Random, n: int, terms: int, wide: bool) -> tuple[Any, Any, Any]:
    """A of 2n rows, some entries of which vanish, left and Y: the same numbers in each arithmetic."""

    def number() -> Any:
        return arithmetic.number(Fraction(source.randrange(-1000, 1000), 1001))

    def one() -> Any:
        return arithmetic.complex(number()) + 1j * arithmetic.complex(number()) if wide else number()

    def payload(there: bool) -> Any:
        return arithmetic.series([number() / 3**m for m in range(terms)]) if there else None

    A = [[(payload(source.random() < 0.6), payload(wide and source.random() < 0.3)) for _ in range(n)] for _ in range(2 * n)]
    return A, [[one() / 4 for _ in range(n)] for _ in range(n)], [[one() for _ in range(2)] for _ in range(n)]


@pytest.mark.parametrize("wide", [False, True])
def test_the_terms_of_a_linear_system_are_those_of_mpmath(wide: bool) -> None:
    terms, n = 40, 3
    with FLINT.working(DIGITS), MPMATH.working(DIGITS + 20):
        A, left, Y = system(FLINT, random.Random(4), n, terms, wide)
        found = terms_of(A, left, Y, terms)
        assert found is not None
        ends = carried_by(found), MPMATH.carried(*system(MPMATH, random.Random(4), n, terms, wide), terms)
        for t in (1.0, 0.375):
            ours, theirs = (
                [[arithmetic.to_mpmath(x) for x in row] for row in end(t)]
                for arithmetic, (end, _) in zip((FLINT, MPMATH), ends, strict=True)
            )
            size = max(abs(x) for row in theirs for x in row)
            assert max(abs(x - y) for p, q in zip(ours, theirs, strict=True) for x, y in zip(p, q, strict=True)) < CLOSE * max(size, 1)
        for one, other in zip(ends[0][1], ends[1][1], strict=True):
            off = [abs(FLINT.to_mpmath(x) - y) for p, q in zip(one, other, strict=True) for x, y in zip(p, q, strict=True)]
            assert max(off) < CLOSE * max(1, *(abs(y) for row in other for y in row))


def test_a_recurrence_by_loops_is_that_of_the_numbers() -> None:
    """Every instruction once, a zero among the first coefficients, and units far from the length on which y changes."""
    terms = 40
    with FLINT.working(DIGITS), mpmath.workdps(DIGITS):
        graph = RelaxedSystem(FLINT)
        x, y, z = (graph.unknown() for _ in range(3))
        half, third = FLINT.number(Fraction(1, 2)), FLINT.number(Fraction(1, 3))
        slopes = [(y + 1) ** 0.5 * z, -(x * y) / (2 + z * z) + third / (y + 2), ((x + third) ** 2 + y) ** third * half - z / 7]
        program = FLINT.recurrence(graph, (x, y, z), slopes)
        assert program is not None
        state = [FLINT.number(0), FLINT.number(Fraction(5, 4)), FLINT.number(Fraction(-1, 3))]
        found = {unit: program.expand(state, unit, terms) for unit in (-3, -1, 0)}
        graph.clear()
        for node, value in zip((x, y, z), state, strict=True):
            node.coefficients.append(value)
        for m in range(terms - 1):
            graph.extend(m)
            for node, slope in zip((x, y, z), slopes, strict=True):
                node.coefficients[m + 1 :] = [FLINT.rounded(slope.coefficients[m] / (m + 1))]
        for unit, series in found.items():
            assert series is not None
            for ours, node in zip(series, (x, y, z), strict=True):
                off = [
                    abs(FLINT.to_mpmath(a - b)) * mpf(2) ** (unit * m) for m, (a, b) in enumerate(zip(ours, node.coefficients, strict=True))
                ]
                assert max(off) < CLOSE


def test_a_recurrence_about_a_singular_point_is_that_of_the_numbers() -> None:
    """x y′ + y = 2 y x + x³ + y², x w′ = x w/(1 + y) with y(0) = 0 and w(0) = 3: products of which every first coefficient vanishes."""
    terms, shifts = 30, (1, 0)
    with FLINT.working(DIGITS), mpmath.workdps(DIGITS):
        graph = RelaxedSystem(FLINT)
        x, y, w = (graph.unknown() for _ in range(3))
        slopes = [2 * (y * x) + x * x * x + y * y + x / 3, x * w / (1 + y)]
        program = FLINT.recurrence(graph, (x, y, w), slopes)
        assert program is not None
        zero, three = FLINT.number(0), FLINT.number(3)
        found = program.expand_singular([zero, zero, three], shifts, -2, terms)
        assert found is not None
        graph.clear()
        for m in range(terms):
            for node, value in zip((x, y, w), (FLINT.number(int(m == 1)), zero, zero if m else three), strict=True):
                node.coefficients[m:] = [value]
            graph.extend(m)
            if m:
                for node, slope, shift in zip((y, w), slopes, shifts, strict=True):
                    node.coefficients[m:] = [FLINT.rounded(slope.coefficients[m] / (m + shift))]
                graph.extend(m)
        for ours, node in zip(found, (x, y, w), strict=True):
            off = [abs(FLINT.to_mpmath(a - b)) / 4**m for m, (a, b) in enumerate(zip(ours, node.coefficients, strict=True))]
            assert max(off) < CLOSE


def test_what_has_no_instruction_or_no_number_has_no_loops() -> None:
    with FLINT.working(DIGITS):
        graph = RelaxedSystem(FLINT)
        y = graph.unknown()
        program = FLINT.recurrence(graph, (y,), [1 / y])
        assert program is not None
        assert program.expand([FLINT.number(0)], 0, 10) is None
        other = graph.node(("of its own", id(y)), lambda m, _: y.coefficients[m], y)
        assert FLINT.recurrence(graph, (y,), [other]) is None
        assert MPMATH.recurrence(RelaxedSystem(MPMATH), (), []) is None
