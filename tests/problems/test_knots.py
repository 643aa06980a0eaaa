"""problems/knots.py: where coefficients are not smooth, found from their values; every knot a node, every bound held."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import mpmath
import numpy as np
import pytest

import shootstab as st
from shootstab.core.errors import InputError
from shootstab.discriminants.mesh import across_knots, halved, redistribute
from shootstab.problems.knots import find_knots

D1 = np.array([[0.0, 0.0], [1.0, 0.0]])
FIXED = [[1.0, 0.0]]


def found(f: Callable[[Any], Any], low: float = 0.0, high: float = 1.0, given: Any = ()) -> np.ndarray:
    return find_knots(lambda z: np.asarray(f(z), dtype=np.complex128).reshape(len(z), -1), low, high, np.array(given, dtype=float))


def schroedinger(V: Callable[[float], float], **options: Any) -> st.LinearProblem:
    """y″ = (σ + V) y, y = 0 at 0 and 1."""
    return st.problem(2, lambda x: (np.array([[0.0, 1.0], [V(x), 0.0]]), D1), st.Wall(0, FIXED), st.Wall(1, FIXED), **options)


def by_series(breaks: Any, polynomials: Any, guess: float) -> Any:
    """σ of y″ = (σ + V) y, y(0) = y(1) = 0, V a polynomial in z − breaks[j] on each piece: power series of 60 terms, 32 digits."""

    def miss(sigma: Any) -> Any:
        y, slope = mpmath.mpf(0), mpmath.mpf(1)
        for a, b, p in zip(breaks[:-1], breaks[1:], polynomials, strict=True):
            h = mpmath.mpf(float(b)) - mpmath.mpf(float(a))
            c = [mpmath.mpf(float(x)) for x in p]
            c[0] += sigma
            t = [y, slope]
            for n in range(60):
                t.append(sum(c[i] * t[n - i] for i in range(min(len(c), n + 1))) / ((n + 1) * (n + 2)))
            y, slope = mpmath.polyval(t[::-1], h), mpmath.polyval([k * t[k] for k in range(len(t) - 1, 0, -1)], h)
        return y

    with mpmath.workdps(32):
        return mpmath.findroot(miss, (guess, guess * (1 + mpmath.mpf("1e-6"))), tol=1e-30, verify=False)  # y itself may be 1e100


# where they are


@pytest.mark.parametrize("a", [0.37, 0.5, 1 / 3, 0.9999])
def test_a_jump_is_found_to_a_rounding(a: float) -> None:
    for f in (lambda x: 10.0 * (x > a), lambda x: np.sin(x) - (x >= a)):
        (knot,) = found(f)
        assert abs(knot - a) <= 4e-16 * a


def test_a_jump_at_zero_is_found_to_a_rounding_of_the_line() -> None:
    (knot,) = found(lambda x: np.sign(x), -1.0, 2.0)
    assert abs(knot) < 1e-16


@pytest.mark.parametrize(("p", "near"), [(1, 1e-12), (2, 1e-7), (3, 1e-4)])
def test_a_jump_of_a_derivative_is_found_as_far_as_it_is_one(p: int, near: float) -> None:
    """To where s δ^p is a rounding of the coefficient."""
    (knot,) = found(lambda x: np.sin(x) + np.where(x > 0.3, (x - 0.3) ** p, 0.0))
    assert abs(knot - 0.3) < near


def test_two_jumps_next_to_each_other_are_two() -> None:
    assert found(lambda x: 10.0 * (x > 0.5) - 3.0 * (x > 0.500001)) == pytest.approx([0.5, 0.500001], rel=1e-14)


@pytest.mark.parametrize(
    "smooth",
    [
        lambda x: 1 / np.cosh(10 * x) ** 2,
        lambda x: 1 - np.tanh(30 * (x - 0.5)) ** 2,  # whose roundings are those of 1
        lambda x: np.tanh(1e4 * (x - 0.3)),
        lambda x: np.exp(-1e5 * (1 - x)) + np.exp(-1e3 * x),
        lambda x: 1 / (1e-8 + (x - 0.7) ** 2),
        lambda x: np.cos(1000 * x),
        lambda x: 1 / (x + 1e-6) ** 4,
        lambda x: np.sqrt(x),  # singular at the end, which is a node
        lambda x: np.zeros_like(x),
    ],
)
def test_smooth_coefficients_have_none(smooth: Callable[[Any], Any]) -> None:
    assert len(found(smooth)) == 0


@pytest.mark.parametrize("p", [1 / 3, 0.5, 0.7, 1.5])
def test_a_power_that_is_no_integer_is_refused_with_its_place(p: float) -> None:
    with pytest.raises(InputError, match=r"not analytic on the (left|right) of z = 0\.(3|29999|30000)"):
        found(lambda x: np.sin(x) + np.abs(x - 0.3) ** p)


def test_more_than_can_be_held_are_refused_with_the_first() -> None:
    z = np.linspace(0, 1, 2001)
    with pytest.raises(InputError, match=r"not smooth at more than 512 points, from z = 0\.000"):
        found(lambda x: np.interp(x, z, np.tanh(5 * z)))
    with pytest.raises(InputError, match="not smooth at more than 512 points"):
        found(lambda x: np.sign(np.sin(1 / x)), 1e-6)


def test_knots_that_are_given_are_not_looked_for() -> None:
    asked: list[int] = []
    z = np.linspace(0, 1, 32)

    def table(x: Any) -> Any:
        asked.append(len(x))
        return np.interp(x, z, np.tanh(z))

    assert np.array_equal(found(table, given=z[1:-1]), z[1:-1])
    assert sum(asked) < 4000


# the mesh


def test_the_nodes_beside_a_knot_stay() -> None:
    problem = schroedinger(lambda x: 5.0 * (x > 0.37))
    nodes = problem.mesh(0.0).astype(complex)
    assert across_knots(nodes).sum() == 1
    pair = nodes[:-1][across_knots(nodes)]
    errors = np.where(across_knots(nodes), 0.0, 1e-3)
    for other in (redistribute(nodes, errors, 1e-9), halved(nodes), halved(nodes, 1)):
        assert np.isin(pair, other).all()
        assert (np.diff(other.real) > 0).all()
    assert (problem.pencil(nodes).D0[:, 1, 0] == 5.0 * (nodes.real > 0.37)).all()


def test_knots_of_several_subdomains_are_nodes_of_one_mesh() -> None:
    """A square well on the whole line, −1 < x < 1, in which the fold lies: k tan k = κ and its like."""
    P = st.problem(2, lambda x: (np.array([[0.0, 1.0], [-5.0 * (abs(x) < 1), 0.0]]), D1), st.Infinity(), st.Infinity(), fold=0.3)
    assert P.knots == pytest.approx([-1.0, 1.0], rel=1e-15)
    with mpmath.workdps(30):
        k = mpmath.findroot(lambda k: k * mpmath.tan(k) - mpmath.sqrt(5 - k * k), 1.1)
        truth = 5 - k * k
    mode = st.refine(P, guess=float(truth) * 1.001)
    assert mode.converged
    assert abs(mode.sigma - complex(truth)) <= mode.error < 1e-10


# the bounds


@pytest.mark.parametrize("a", [0.3, 0.37, 0.6180339])
@pytest.mark.parametrize("V", [10.0, 1e3, 1e5])
def test_a_jump_inside_breaks_no_bound(a: float, V: float) -> None:
    pieces = [0.0, a, 1.0] if V < 100 else [0.0, a, *np.linspace(a, 1.0, 41)[1:]]
    guess = float(st.refine(schroedinger(lambda x: V * (x > a)), guess=-9.87 / a**2, rtol=1e-8).sigma.real)
    truth = by_series(pieces, [[0.0], *[[V]] * (len(pieces) - 2)], guess)
    # behind a high wall a solution that decays is followed against its direction, and charts that suit one mesh do not suit its half
    riccati = ((1e-8, "riccati"),) if V < 100 else ()
    for rtol, method in ((1e-10, "frame"), (1e-6, "frame"), (1e-8, "compound"), *riccati):
        mode = st.refine(schroedinger(lambda x: V * (x > a)), guess=guess, rtol=rtol, method=method)
        assert mode.converged, mode.status
        assert abs(mode.sigma - complex(truth)) <= mode.error


def test_a_kink_inside_breaks_no_bound() -> None:
    truth = by_series([0.0, 0.37, 1.0], [[22.2, -60.0], [0.0, 60.0]], -24.0)
    for rtol in (1e-10, 1e-6):
        mode = st.refine(schroedinger(lambda x: 60 * abs(x - 0.37)), guess=float(truth.real) * 1.0001, rtol=rtol)
        assert mode.converged, mode.status
        assert abs(mode.sigma - complex(truth)) <= mode.error


@pytest.mark.parametrize("kind", ["interp", "CubicSpline", "PchipInterpolator", "Akima1DInterpolator"])
def test_a_table_breaks_no_bound(kind: str) -> None:
    from scipy import interpolate

    z = np.linspace(0, 1, 31)
    values = 30 * np.tanh(5 * z)
    if kind == "interp":
        made: Any = interpolate.PPoly(np.array([np.diff(values) / np.diff(z), values[:-1]]), z)
        V: Callable[[float], float] = lambda x: float(np.interp(x, z, values))  # noqa: E731
    else:
        made = getattr(interpolate, kind)(z, values)
        V = lambda x: float(made(x))  # noqa: E731
    truth = by_series(z, made.c[::-1].T, float(st.refine(schroedinger(V), guess=-38.0, rtol=1e-8).sigma.real))
    for rtol in (1e-10, 1e-6):
        mode = st.refine(schroedinger(V), guess=float(truth.real), rtol=rtol)
        assert mode.converged, mode.status
        assert abs(mode.sigma - complex(truth)) <= mode.error


# what is given


def test_knots_that_are_none_are_refused() -> None:
    for knots, told in (
        ([1.5], "a knot lies at z = 1.5"),
        ([np.nan], "z = nan"),
        ("a", "no numbers"),
        ([0.0], "between the ends, 0 and 1"),
    ):
        with pytest.raises(InputError, match=told):
            schroedinger(lambda x: 0.0, knots=knots)
    assert schroedinger(lambda x: 0.0, knots=[0.7, 0.2, 0.7]).given == (0.2, 0.7)


def test_a_feature_that_is_too_narrow_to_be_found_is_met_where_it_is_given() -> None:
    def narrow(x: float) -> float:
        return 1e4 * (0.4 < x < 0.40001)

    truth = by_series([0.0, 0.4, 0.40001, 1.0], [[0.0], [1e4], [0.0]], -10.0)
    mode = st.refine(schroedinger(narrow, knots=[0.4, 0.40001]), guess=-10.0)
    assert abs(mode.sigma - complex(truth)) <= mode.error < 1e-10


@pytest.mark.parametrize("order", [1, 3, 5, 7])
def test_a_profile_is_a_piecewise_polynomial_with_its_knots(order: int) -> None:
    from scipy.interpolate import PPoly

    z = np.linspace(0, 1, 25)
    U = st.profile(z, 40 * np.cos(7 * z), order=order)
    assert np.abs(U(z) - 40 * np.cos(7 * z)).max() < 1e-13
    assert isinstance(U(0.3), float)
    pieces = PPoly.from_spline(U.spline)
    kept = np.flatnonzero(np.diff(pieces.x) > 0)
    breaks = np.append(pieces.x[kept], 1.0)
    assert np.allclose(U.knots, breaks[1:-1], atol=1e-15)
    truth = by_series(breaks, pieces.c[::-1].T[kept], float(st.refine(schroedinger(U, knots=U.knots), guess=-14.0).sigma.real))
    mode = st.refine(schroedinger(U, knots=U.knots), guess=float(truth.real))
    assert mode.converged
    assert abs(mode.sigma - complex(truth)) <= mode.error
    assert len(schroedinger(U, knots=U.knots).knots) == len(U.knots)


def test_equations_learn_the_knots_of_a_profile() -> None:
    z = np.linspace(0, 1, 21)
    U = st.profile(z, np.tanh(3 * z), order=3)
    walls = st.Conditions(0, ["y"]), st.Conditions(1, ["y"])
    P = st.equations(["y"], ["d(y, 2) - U*y - sigma*y"], *walls, given={"U": U})
    assert np.allclose(P.knots, U.knots, rtol=1e-14)
    mode = st.refine(P, guess=-10.0)
    other = st.refine(schroedinger(U, knots=U.knots), guess=-10.0)
    assert abs(mode.sigma - other.sigma) <= mode.error + other.error < 1e-10


def test_a_profile_refuses_what_its_data_do_not_hold() -> None:
    U = st.profile([0.0, 0.5, 1.0, 2.0], [0.0, 1.0, 0.0, 1.0])
    for ask, told in (
        (lambda: U(2.5), r"at z = 2\.5: its data reach from 0 to 2"),
        (lambda: U(np.array([0.1, -0.1])), r"at z = -0\.1"),
        (lambda: U(0.5 + 0.1j), "complex z"),
        (lambda: st.profile([0, 1], [0, 1], order=2), "order = 2"),
        (lambda: st.profile([0, 1], [0, 1]), "2 points: allowed are 4"),
        (lambda: st.profile([0, 2, 1, 3], [0, 1, 2, 3]), "z = 1 follows 2"),
        (lambda: st.profile([0, 1, np.nan, 3], [0, 1, 2, 3]), "point 3"),
        (lambda: st.profile([0, 1, 2, 3], [0, 1]), "shapes"),
        (lambda: st.profile(["a"], [0]), "no real numbers"),
    ):
        with pytest.raises(InputError, match=told):
            ask()


def test_what_the_data_leave_open_is_seen_with_every_other_point() -> None:
    """The error of a cubic spline falls by 16: thinned, σ is off by about that many times what it was."""
    z = np.linspace(0, 1, 41)
    U = st.profile(z, 40 * np.cos(7 * z))
    exact, fine, thin = (
        st.refine(P, guess=-10.0).sigma
        for P in (
            schroedinger(lambda x: float(40 * np.cos(7 * x))),
            schroedinger(U, knots=U.knots),
            schroedinger(U.thinned(), knots=U.thinned().knots),
        )
    )
    assert 5 < abs(thin - exact) / abs(fine - exact) < 50
