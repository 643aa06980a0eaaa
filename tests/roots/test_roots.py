"""Iterations and counts on functions whose zeros are known."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shootstab.core.allowed import LARGEST_GUESS
from shootstab.core.discriminant import Value
from shootstab.core.division import divisions
from shootstab.core.errors import ConvergenceError
from shootstab.core.regions import Disc, Polygon, Rectangle, Region, size
from shootstab.core.scaled import Scaled
from shootstab.roots.iterations import muller, newton, newton_steps
from shootstab.roots.search import Arrival, Search, Zero, find, moments, polish
from shootstab.roots.separation import separation
from shootstab.roots.winding import Deflated, count_around, power_sums, whole_turns, wind


class KnownZeros:
    """c Π (σ − z) e^{aσ}, scaled so that it would overflow as a number."""

    def __init__(self, zeros: Sequence[complex], exponent: complex = 0.0) -> None:
        self.zeros, self.exponent, self.evaluations = zeros, exponent, 0

    def __call__(self, sigma: complex) -> Scaled:
        return self.with_derivative(sigma).D

    def with_derivative(self, sigma: complex) -> Value:
        self.evaluations += 1
        product, slope = 1 + 0j, 0j
        for z in self.zeros:
            slope = slope * (sigma - z) + product
            product *= sigma - z
        turn = self.exponent * sigma
        phase = complex(0, turn.imag)
        import cmath

        return Value(
            sigma,
            Scaled(product * cmath.exp(phase), 900.0 + turn.real),
            (slope + self.exponent * product) * cmath.exp(phase),
        )


@pytest.mark.parametrize("iteration", [newton, muller])
def test_iterations_find_a_zero_to_rounding(iteration) -> None:
    root = iteration(KnownZeros([0.3 + 0.4j, -1.0, 2j], exponent=3 - 1j), 0.33 + 0.35j, 1e-13)
    assert root.converged
    assert root.sigma == pytest.approx(0.3 + 0.4j, abs=1e-13)


def test_newton_converges_quadratically() -> None:
    assert newton(KnownZeros([1.0, -1.0]), 1.1, 1e-14).iterations <= 5


def test_newton_learns_the_curvature_from_two_points() -> None:
    """With e the error, e₂ is of size e₀² e₁² and no longer e₁²; it is foreseen, and evaluations are saved."""
    zeros, guess = [0.3 + 0.4j, -1.0, 2j], 0.305 + 0.402j
    steps = itertools.islice(newton_steps(KnownZeros(zeros, exponent=3 - 1j), guess), 2)
    e = [abs(guess - zeros[0]), *(abs(step.sigma - zeros[0]) for step in steps)]
    assert e[2] < 300 * (e[0] * e[1]) ** 2 < 1e-2 * e[1] ** 2
    foreseen = list(itertools.islice(newton_steps(KnownZeros(zeros, exponent=3 - 1j), guess), 2))[1].ahead
    assert 0.1 * e[2] < foreseen < 10 * e[2]
    assert newton(KnownZeros(zeros, exponent=3 - 1j), guess, 1e-9).iterations == 2


@pytest.mark.parametrize("m", [2, 3, 4, 5])
@pytest.mark.parametrize("zero", [0.0, 0.2 + 0.1j])
def test_newton_notices_a_multiple_zero(zero: complex, m: int) -> None:
    """Steps that shrink by 1 − 1/m lead there in 1/log(m/(m−1)) evaluations a digit: m times as long they are quadratic."""
    root = newton(KnownZeros([zero] * m + [3.0], exponent=0.3j), zero + 0.3, 1e-13)
    assert root.converged
    assert root.multiplicity == m
    assert root.iterations < 15
    assert abs(root.sigma - zero) < 1e-5


@pytest.mark.parametrize("iteration", [newton, muller])
@pytest.mark.parametrize("guess", [0.3, 1e-13, -1e-20j])
def test_iterations_end_at_zero_though_no_step_is_short_against_it(iteration, guess: complex) -> None:
    root = iteration(KnownZeros([0.0, 2.0, -3j], exponent=1.0), guess, 1e-12)
    assert root.converged
    assert abs(root.sigma) < 1e-15


@given(st.floats(-12, 3), st.complex_numbers(min_magnitude=0.1, max_magnitude=10.0))
def test_separation_is_the_distance_of_the_other_zero(exponent: float, other: complex) -> None:
    """D = (σ − z) (σ − w) has |2D′/D″| = |z − w|, wherever z is; 0 included."""
    gap = other * 10.0**exponent
    for zero in (0.0, gap, 300 * gap):
        D = KnownZeros([zero, zero - gap])
        assert separation(D, D.with_derivative(zero)) == pytest.approx(abs(gap), rel=0.15)


def test_where_nothing_bends_the_separation_is_infinite() -> None:
    D = KnownZeros([1.0])
    assert separation(D, D.with_derivative(1.0)) == math.inf


def test_an_exact_hit_is_a_root() -> None:
    for iteration in (newton, muller):
        assert iteration(KnownZeros([0.5]), 0.5, 1e-12).converged


class NearlyConstant:
    """σ^−p, with a small p: Newton's steps are σ/p, and each takes the iterate 1/p times as far out as it was."""

    def __init__(self, p: float) -> None:
        self.p, self.farthest = p, 0.0

    def with_derivative(self, sigma: complex) -> Value:
        self.farthest = max(self.farthest, abs(sigma))
        return Value(sigma, Scaled(1 + 0j, 0.0), -self.p / sigma)


@pytest.mark.parametrize("p", [1e-3, 1e-9, 1e-80, 1e-300, 1e-308])
def test_an_iteration_that_runs_away_ends_before_its_squares_overflow(p: float) -> None:
    D = NearlyConstant(p)
    root = newton(D, 0.7 + 0.7j, 1e-12)
    assert not root.converged
    assert D.farthest <= LARGEST_GUESS < abs(root.sigma)


def test_a_function_without_zeros_does_not_converge() -> None:
    for iteration in (newton, muller):
        assert not iteration(KnownZeros([], exponent=1.0), 1.0, 1e-12).converged


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.complex_numbers(max_magnitude=2.0, allow_nan=False, allow_infinity=False), max_size=6),
    st.complex_numbers(max_magnitude=20.0, allow_nan=False, allow_infinity=False),
)
def test_count_in_a_disc_is_the_number_of_zeros(zeros: list[complex], exponent: complex) -> None:
    disc = Disc(0.2 + 0.1j, 1.0)
    if any(abs(abs(z - disc.centre) - 1) < 1e-3 for z in zeros):
        return
    winding = wind(KnownZeros(zeros, exponent), disc)
    assert winding.count == sum(disc.contains(z) for z in zeros)
    assert winding.closure < 0.5


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.complex_numbers(max_magnitude=2.0, allow_nan=False, allow_infinity=False), max_size=5),
    st.complex_numbers(max_magnitude=0.9),
)
def test_a_zero_that_is_divided_out_is_one_less_and_one_that_is_none_a_pole(zeros: list[complex], known: complex) -> None:
    disc = Disc(0.2 + 0.1j, 1.2)
    if any(abs(abs(z - disc.centre) - 1.2) < 1e-3 for z in (*zeros, known)):
        return
    inside = sum(disc.contains(z) for z in zeros)
    for D, count in ((KnownZeros(zeros), inside), (KnownZeros([*zeros, known]), inside + 1)):
        assert wind(Deflated(D, known), disc).count + 1 == count
        assert count_around(D, disc, known) == count


def test_a_zero_alone_is_counted_by_two_values() -> None:
    D = KnownZeros([1.0, 3.0 - 1j], exponent=2.0)
    assert count_around(D, Disc(1.0 + 0j, 1e-6), 1.0 + 1e-9) == 1
    assert D.evaluations == 2
    assert count_around(D, Disc(1.0 + 3e-6, 1e-6), 1.0) == 0  # the zero lies outside
    assert count_around(D, Disc(1.0 + 3e-6, 1e-6), 1.0 + 2.9e-6) == 0  # no zero, but a pole


@pytest.mark.parametrize("others", [[0.9j], [0.9j, -0.9j], [1e-3, -1e-3], [0.99, -0.99], [0.3, 0.5j, -0.8]])
def test_zeros_beside_the_known_one_are_not_overlooked(others: list[complex]) -> None:
    """Pairs whose slopes cancel on the axis, and such next to the two points that are looked at first."""
    D = KnownZeros([1.0, *(1.0 + 1e-6 * z for z in others), 3.0 - 1j])
    assert count_around(D, Disc(1.0 + 0j, 1e-6), 1.0 + 1e-9) == 1 + len(others)


def test_the_separation_is_seen_where_a_search_passed() -> None:
    """At a σ neither too near nor too far, and one evaluation at a point of its own where there is none."""
    D = KnownZeros([1.0, 1.5])
    passed = (1.3 + 0j, 1.004 + 0j, 1.0 + 1e-7j)
    assert separation(D, D.with_derivative(1.0), passed) == pytest.approx(0.5, rel=0.02)
    last: list[complex] = []
    original = D.with_derivative
    D.with_derivative = lambda sigma: (last.append(sigma), original(sigma))[1]  # type: ignore[method-assign]
    for places, asked in ((passed, 1.004), ((1.3 + 0j,), 1.001)):
        separation(D, original(1.0), places)
        assert last[-1] == asked


def test_count_in_a_rectangle_with_steep_phase_between_samples() -> None:
    """e^{300σ} turns the phase by some hundred times on the way: no turn may be missed."""
    box = Rectangle(-1 - 1j, 1 + 1j)
    assert wind(KnownZeros([0.5j, 0.5j, -0.9, 3.0], exponent=300.0), box).count == 3


def test_a_zero_next_to_the_boundary_is_counted_on_its_side() -> None:
    for offset, count in ((-1e-9, 1), (1e-9, 0)):
        assert wind(KnownZeros([1.0 + offset]), Disc(0j, 1.0)).count == count


def test_a_zero_on_the_boundary_is_refused() -> None:
    with pytest.raises(ConvergenceError, match="boundary"):
        wind(KnownZeros([1.0]), Disc(0j, 1.0))
    with pytest.raises(ConvergenceError, match="boundary"):
        wind(KnownZeros([0.3 - 1j]), Rectangle(-1 - 1j, 1 + 1j))


def search(D: KnownZeros) -> Search:
    return Search(lambda region: wind(D, region), lambda disc: wind(D, disc), polish(D))


REGIONS = (
    Rectangle(-1 - 1j, 1 + 1j),
    Disc(0.1j, 1.05),
    Polygon((-1 - 1j, 1 - 1j, 0.02 + 0.95j)),
    Polygon((-1 - 1j, 1 - 1j, 0.03 + 0.12j, 1 + 1j, -1 + 1j)),
)


@settings(max_examples=25, deadline=None)
@given(st.sampled_from(REGIONS), st.lists(st.tuples(st.integers(-9, 9), st.integers(-9, 9)), max_size=12, unique=True))
def test_find_returns_all_zeros_and_no_other(region: Region, cells: list[tuple[int, int]]) -> None:
    zeros = [complex(a / 10 + 0.013, b / 10 + 0.007) for a, b in cells]
    if any(abs(z - region.boundary(region.parameter(z))) < 1e-4 for z in zeros):
        return
    found = find(search(KnownZeros(zeros, exponent=5 + 2j)), region)
    key = lambda z: (round(z.real, 6), round(z.imag, 6))  # noqa: E731
    assert sorted(key(z.sigma) for z in found) == sorted(key(z) for z in zeros if region.contains(z))
    assert all(z.multiplicity == 1 for z in found)


def test_a_handful_of_zeros_needs_few_evaluations() -> None:
    """Those of the contour, and a few Newton steps a zero: dividing would take hundreds."""
    D = KnownZeros([0.3 + 0.1j, -0.2j, 0.5 + 0.5j, 2.0], exponent=3.0)
    assert len(find(search(D), Disc(0j, 1.0))) == 3
    assert D.evaluations < 80


def test_power_sums_are_those_of_the_zeros() -> None:
    zeros = [0.3, -0.2j, 0.5 + 0.5j]
    sums = power_sums(wind(KnownZeros([*zeros, 2.0], exponent=5 + 2j), Rectangle(-1 - 1j, 1 + 1j)).legs, 0.1, 2.0, 3)
    assert sums == pytest.approx([sum(((z - 0.1) / 2) ** k for z in zeros) for k in range(4)], abs=1e-3)


@pytest.mark.parametrize("multiplicity", [2, 3])
def test_a_multiple_zero_is_one_zero_with_its_multiplicity(multiplicity: int) -> None:
    multiple, simple = sorted(find(search(KnownZeros([0.2 + 0.1j] * multiplicity + [0.5])), Disc(0j, 1.0)), key=lambda z: z.sigma.real)
    assert multiple.multiplicity == multiplicity
    assert abs(multiple.sigma - 0.2 - 0.1j) < 1e-9
    assert 0.0 < multiple.radius < 1e-4
    assert simple == Zero(pytest.approx(0.5))


def test_zeros_between_which_d_is_noise_are_one_zero_where_they_are_near_and_none_where_they_are_not() -> None:
    """No contour passes near them, and no iteration arrives: what is left is one region with both, if it is small enough."""
    zeros = (0.21 + 0.13j, 0.21 + 0.13j + 1e-7)
    D = KnownZeros(zeros)

    def within(noise: float) -> Search:
        def count(region: Region):
            counted = wind(D, region)
            if any(abs(v.sigma - zeros[0]) < noise for _, values in counted.legs for v in values):
                raise ConvergenceError("D is noise here")
            return counted

        return Search(count, count, lambda start, length: None)

    (found,) = find(within(1e-4), Rectangle(-1 - 1j, 1 + 1j))
    assert found.multiplicity == 2
    assert abs(found.sigma - zeros[0]) < found.radius < 1e-2
    with pytest.raises(ConvergenceError, match=r"no way was found to divide a region .* noise"):
        find(within(0.05), Rectangle(-1 - 1j, 1 + 1j))


def test_zeros_that_lie_close_together_are_told_apart() -> None:
    pair = (0.2 + 0.1j, 0.2 + 0.1j + 1e-6)
    found = find(search(KnownZeros([*pair, -0.4])), Disc(0j, 1.0))
    assert sorted(z.sigma.real for z in found) == pytest.approx([-0.4, 0.2, 0.200001], abs=1e-9)
    assert all(z.multiplicity == 1 for z in found)


def test_known_zeros_are_not_found_again() -> None:
    D = KnownZeros([0.3, -0.2j, 0.5 + 0.5j])
    assert [z.sigma for z in find(search(D), Disc(0j, 1.0), [Zero(0.3 + 0j), Zero(-0.2j)])] == pytest.approx([0.5 + 0.5j])
    assert find(search(D), Disc(0j, 1.0), [Zero(z + 0j) for z in D.zeros]) == []
    # a double one, of which one is known
    (left,) = find(search(KnownZeros([0.3, 0.3])), Disc(0j, 1.0), [Zero(0.3 + 0j)])
    assert left.multiplicity == 1
    with pytest.raises(ConvergenceError, match="fewer than are known"):
        find(search(KnownZeros([0.3])), Disc(0j, 1.0), [Zero(0.3 + 0j), Zero(0.4 + 0j)])


@pytest.mark.parametrize("region", REGIONS)
def test_divisions_cover_the_region_exactly(region: Region) -> None:
    """Every point of it lies in one of the two parts, and no other point does; divided again, too."""
    ways = list(divisions(region))
    assert len(ways) > 3
    for parts in ways[:4]:
        whole = next(divisions(parts[1]))
        for z in (complex(a, b) / 20 + 0.003 + 0.007j for a in range(-25, 25) for b in range(-25, 25)):
            assert sum(part.contains(z) for part in parts) == region.contains(z)
            assert sum(part.contains(z) for part in whole) == parts[1].contains(z)
        assert all(size(part) <= size(region) for part in parts)


@pytest.mark.parametrize("region", REGIONS)
def test_the_boundary_of_a_section(region: Region) -> None:
    """It is run through counter-clockwise, its corners are where it turns, and `parameter` finds back."""
    for section in next(divisions(region)):
        ts = [k / 400 for k in range(401)]
        points = [section.boundary(t) for t in ts]
        assert sum((p.conjugate() * q).imag for p, q in itertools.pairwise(points)) > 0
        assert section.corners[0] == 0.0
        assert section.corners[-1] == 1.0
        assert list(section.corners) == sorted(section.corners)
        for t in ts[1::7]:
            assert abs(section.boundary(section.parameter(section.boundary(t))) - section.boundary(t)) < 1e-6
        assert section.as_dict()["of"] == region.as_dict()


def test_a_region_that_every_middle_cut_crosses_often_is_divided_at_a_tip() -> None:
    comb = Polygon((0j, 4 + 0j, 4 + 1j, 3 + 1j, 3 + 0.1j, 1 + 0.1j, 1 + 1j, 0.1j))
    for low, high in divisions(comb):
        for z in (complex(a / 10 + 0.03, b / 10 + 0.03) for a in range(40) for b in range(10)):
            assert low.contains(z) + high.contains(z) == comb.contains(z)


def test_a_phase_that_is_no_whole_turn_is_refused() -> None:
    assert whole_turns(-4 * math.pi) == -2
    with pytest.raises(ConvergenceError, match=r"the phase of D does not close: 0\.500000 turns"):
        whole_turns(math.pi)


def test_an_iteration_that_stops_beside_a_zero_is_not_believed() -> None:
    """No zero is where iterations from the moments of the whole region stop: its parts are searched, and their iterations arrive."""
    D, region = KnownZeros([0.3, -0.2j]), Disc(0j, 1.0)
    arrive = polish(D)
    beside = Search(
        lambda part: wind(D, part),
        lambda disc: wind(D, disc),
        lambda start, length: Arrival(start + 0.3, 1e-7) if length > 1e-9 else arrive(start, length),
    )
    assert sorted((z.sigma for z in find(beside, region)), key=abs) == pytest.approx([-0.2j, 0.3])


def test_a_double_zero_next_to_the_boundary_is_found() -> None:
    """No circle around it as wide as the steps of an iteration that converges linearly lies inside the region: parts are smaller."""
    zero = 0.5 - 2e-6 + 0.1j
    (found,) = find(search(KnownZeros([zero, zero])), Rectangle(-0.5 - 0.5j, 0.5 + 0.5j))
    assert found.multiplicity == 2
    assert abs(found.sigma - zero) < 1e-6


def test_few_zeros_among_many_that_are_known_are_found_on_one_contour() -> None:
    """The power sums of those that are not known are those of all less those of the known ones: nothing is divided."""
    known = [0.1 * k + 0.3j * (-1) ** k for k in range(-9, 10)]
    lacking = [0.05 - 0.1j, -0.55 + 0.05j]
    box = Rectangle(-1.2 - 0.8j, 1.3 + 0.9j)
    D = KnownZeros([*known, *lacking])
    counted = wind(D, box)
    spent = D.evaluations
    found = find(search(D), box, [Zero(z) for z in known], counted)
    assert sorted((z.sigma for z in found), key=abs) == [pytest.approx(z, abs=1e-10) for z in lacking]
    assert D.evaluations < 1.5 * spent
    assert sorted(moments(counted, [Zero(z) for z in known])[1], key=abs) == [pytest.approx(z, abs=0.05) for z in lacking]
