"""The numerical range of equations as a bound on growing modes: identities of the forms, and modes that lie inside."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

import shootstab as st
from shootstab.formulation.domain import Domain
from shootstab.formulation.evaluation import on_arrays
from shootstab.formulation.expression import Z, number
from shootstab.formulation.gaussian import ONE
from shootstab.formulation.growth_bound import LEMMA, growing_region
from shootstab.formulation.numerical_range import energy_form, sampled
from shootstab.formulation.sesquilinear_form import real_part
from shootstab.formulation.vanishing import Vanishing

PRIMITIVE = (
    "sigma*u + i*a*U*u + v*d(U) + i*a*p - (d(u,2) - a**2*u)/R",
    "sigma*v + i*a*U*v + d(p) - (d(v,2) - a**2*v)/R",
    "i*a*u + d(v)",
)
STREAMFUNCTION = "(sigma + i*a*U)*(d(v,2) - a**2*v) - i*a*d(U,2)*v - (d(v,4) - 2*a**2*d(v,2) + a**4*v)/R"


def channel(unknowns: list[str], equations: list[str], conditions: list[str], R: float = 1e4, U: str = "1 - z**2"):
    ends = st.Conditions(-1, conditions), st.Conditions(1, conditions)
    return st.equations(unknowns, equations, *ends, parameters={"R": R, "a": 1}, where={"U": U})


def primitive(R: float = 1e4, U: str = "1 - z**2"):
    return channel(["u", "v", "p"], list(PRIMITIVE), ["u", "v"], R, U)


def test_a_form_and_its_real_part_have_the_same_integral() -> None:
    """∫ ū c v⁗ and others with functions that do not vanish at the ends: what stands there is part of the statement."""
    rng = np.random.default_rng(2)
    form = {
        (("u", 0), ("v", 4)): number(2 - 1j) * Z,
        (("v", 0), ("u", 1)): number(1j) * Z * Z,
        (("u", 0), ("u", 3)): number(3 + 2j),
        (("v", 0), ("v", 0)): Z,
        (("u", 0), ("v", 1)): number(1 + 1j),
    }
    polynomials = {name: np.polynomial.Polynomial(rng.normal(size=6) + 1j * rng.normal(size=6)) for name in "uv"}
    z, weights = np.polynomial.legendre.leggauss(20)
    at = {(name, k): (lambda x, p=p, k=k: p.deriv(k)(x) if k else p(x)) for name, p in polynomials.items() for k in range(6)}

    def value(entries, where) -> np.ndarray:
        terms = [np.conj(at[u](where)) * on_arrays(where, {})(c) * at[v](where) for (u, v), c in entries.items()]
        return np.sum(np.broadcast_arrays(*terms), axis=0) if terms else np.zeros(len(where))

    found = real_part(form, Vanishing(-1.0, 1.0, {}))
    ends = value(found.at_ends, np.array([-1.0, 1.0])).real
    assert np.sum(weights * value(form, z)).real == pytest.approx(np.sum(weights * value(found.entries, z)).real + ends[1] - ends[0])
    jets = sorted({jet for at_ in found.entries for jet in at_})
    matrices = sampled(found.entries, jets, Domain(-1.0, 1.0, {}), np.linspace(0.0, 1.0, 7))
    assert matrices == pytest.approx(matrices.conj().transpose(0, 2, 1))


def test_pressure_drops_out_of_the_energy() -> None:
    form = energy_form(primitive().statement, ONE)
    assert form is not None
    assert {name for name, _ in form.jets} == {"u", "v"}


@pytest.mark.parametrize("problem", [primitive(), channel(["v"], [STREAMFUNCTION], ["v", "d(v)"])], ids=["u, v, p", "v"])
def test_growth_in_a_channel_is_no_faster_than_half_the_shear(problem) -> None:
    """|v′ U ū| ≤ ½ max|U′|(|u|² + |v|²): Re σ ≤ 1; −Im σ/α in U's range, widened by ½ max|U′| at most on this way."""
    region, lemma = problem.growing_region(1e-8)
    assert lemma == LEMMA
    assert 1.0 < region.upper_right.real < 1.02
    assert -1.3 < region.lower_left.imag < -1.0
    assert 0.0 < region.upper_right.imag < 1.1
    mode = st.refine(problem, 0.0037 - 0.2375j)
    assert region.contains(complex(mode.sigma))


def test_a_string_does_not_grow() -> None:
    region, _ = st.equations(["y"], ["d(y,2) - sigma*y"], st.Conditions(0, ["y"]), st.Conditions(1, ["d(y)"])).growing_region(1e-8)
    assert region.upper_right.real < 1e-5


def test_modes_of_random_systems_lie_within_the_bound() -> None:
    """σ u = A(z) u + B u′ + u″, order 4, against collocation."""
    rng = np.random.default_rng(5)
    for _ in range(3):
        a = [[f"({x:.3f} + {y:.3f}*i)*(1 + z**2/2)" for x, y in rng.normal(size=(2, 2))] for _ in range(2)]
        b = rng.normal(size=(2, 2)).round(3)
        equations = [
            f"sigma*{name} - d({name},2) - ({' + '.join(f'{a[k][j]}*{other}' for j, other in enumerate('uv'))})"
            f" - ({b[k][0]})*d(u) - ({b[k][1]})*d(v)"
            for k, name in enumerate("uv")
        ]
        problem = st.equations(["u", "v"], equations, st.Conditions(-2, ["u", "v"]), st.Conditions(2, ["u", "v"]))
        region, _ = problem.growing_region(0.0)
        sigmas = np.asarray(problem.pseudospectral.spectrum(32).eigenvalues)
        growing = sigmas[(sigmas.real > 0) & (abs(sigmas) < 50)]
        assert all(region.contains(complex(s)) for s in growing)


def test_growing_modes_of_random_stratified_flows_lie_within_the_bound() -> None:
    """Pressure, a scalar with a weight of its own that varies, and shear: what two truncations agree on, against the theorem."""
    rng = np.random.default_rng(7)
    seen = 0
    for _ in range(4):
        c, g, R, a = rng.normal(size=4).round(2), (5 * rng.normal(size=2)).round(2), 10 ** rng.uniform(1, 3), round(rng.uniform(0.3, 3), 2)
        equations = [*PRIMITIVE, f"sigma*T*(2 + z) + i*a*U*T + ({g[1]})*v + ({c[3]})*d(T) - 3*(d(T,2) - a**2*T)/R"]
        equations[1] += f" - ({g[0]})*T"
        problem = st.equations(
            ["u", "v", "p", "T"],
            equations,
            st.Conditions(-1, ["u", "v", "T"]),
            st.Conditions(1.5, ["u", "v", "T"]),
            parameters={"R": float(R), "a": a},
            where={"U": f"({c[0]}) + ({c[1]})*z + ({c[2]})*z**2 + ({c[3]})*sin(2*z)"},
        )
        region, _ = problem.growing_region(0.0)
        crude, fine = (problem.pseudospectral.spectrum(M, filtered=False).raw for M in (32, 44))
        growing = [s for s in crude if s.real > 1e-6 and np.abs(fine - s).min() < 1e-4 * abs(s) < 1e-2]
        assert all(region.contains(complex(s)) for s in growing)
        seen += len(growing)
    assert seen > 0


@pytest.mark.parametrize(
    ("equation", "left"),
    [
        ("d(y,2) + sigma*y", "y"),  # −π² n²: not bounded to the right
        ("d(y,2) - sigma**2*y", "y"),
        ("d(y,2)*(1 + i*z)/10 - sigma*y", "d(y) + 3*y"),  # something is left at the end
    ],
)
def test_no_theorem_is_no_bound(equation: str, left: str) -> None:
    assert growing_region(st.equations(["y"], [equation], st.Conditions(0, [left]), st.Conditions(1, ["y"])).statement) is None


def test_functions_must_be_real_where_they_are_taken_to_be() -> None:
    """√(z − 1/2) is imaginary on half of the interval: its conjugate is another function there."""
    problem = st.equations(["y"], ["d(y,2) - sqrt(z)*y - sigma*y"], st.Conditions(0.5, ["y"]), st.Conditions(1, ["y"]))
    assert problem.growing_region is not None
    problem = st.equations(["y"], ["d(y,2) - sqrt(z)*y - sigma*y"], st.Conditions(-1, ["y"]), st.Conditions(-0.5, ["y"]))
    assert problem.growing_region is None


@pytest.mark.parametrize("coefficient", ["i*sqrt(z)", "sqrt(z)", "i*log(z)", "i/(z + 0.7)"])
def test_a_coefficient_of_which_no_real_part_is_seen_is_looked_at_all_the_same(coefficient: str) -> None:
    """i√z is no imaginary number where z < 0, and i/(z + 0.7) is not finite: what drops out of a real part must have been what it seems."""
    sound, unsound = (
        st.equations(["y"], [f"d(y,2) - {coefficient}*y - sigma*y"], st.Conditions(a, ["y"]), st.Conditions(a + 0.5, ["y"])).growing_region
        for a in (0.5, -1.0)
    )
    assert sound is not None
    assert unsound is None


def test_a_condition_with_a_factor_that_vanishes_says_nothing_at_the_end() -> None:
    ends = st.Conditions(0, ["z*u + d(u)*z", "v"]), st.Conditions(1, ["u", "v"])
    with pytest.raises(st.InputError, match="left condition 1 says nothing at z = 0: what it multiplies u, d\\(u\\) by vanishes there"):
        st.equations(["u", "v"], ["d(u,2) - sigma*u", "d(v,2) - sigma*v"], *ends)


def test_growing_modes_are_counted_by_theorem_in_a_moment() -> None:
    found = st.count_unstable(primitive())
    assert (found.count, found.lemma) == (1, LEMMA)
    assert found.radius < 2.0
    assert st.count_unstable(primitive(R=5000)).count == 0
    assert Fraction(found.floor) > 0


LINE = st.Infinity(), st.Infinity()


def flow(U: str, a: float, R: float, *ends):
    return st.equations(["v"], [STREAMFUNCTION], *(ends or LINE), parameters={"R": R, "a": a}, where={"U": U})


@pytest.mark.parametrize(
    ("problem", "guess", "count"),
    [
        (flow("sech(z)**2", 0.8, 100.0), 0.14 - 0.32j, 1),
        (flow("tanh(z)", 0.4, 50.0), 0.15, 1),
        (flow("1 - exp(-z)", 0.1555, 6e4, st.Conditions(0, ["v", "d(v)"]), st.Infinity()), 1e-4 - 0.0228j, None),
        (st.equations(["y"], ["d(y,2) + 6*sech(z)**2*y - sigma*y"], *LINE), 3.9, 2),
        (st.equations(["y"], ["d(y,2) + 6*sech(z - 3)**2*y - sigma*y"], st.Conditions(-2, ["d(y)"]), st.Infinity()), 3.9, 2),
        (st.equations(["y"], ["d(y,2) + 6*sech(z + 3)**2*y - sigma*y"], st.Infinity(), st.Conditions(-1, ["y"])), 3.9, 2),
        (st.equations(["f"], ["(sigma + 0.45*i*tanh(z))*(d(f,2) - 0.2025*f) + 0.9*i*tanh(z)*sech(z)**2*f"], *LINE), 0.19, 1),
    ],
    ids=["jet", "layer", "boundary layer", "well", "half a line", "the other half", "inviscid"],
)
def test_growing_modes_on_lines_lie_within_the_bound_and_are_counted(problem, guess, count) -> None:
    """−u″ − 6 sech² u has the eigenvalues −4 and −1; the others are refined by themselves."""
    region, lemma = problem.growing_region(1e-6)
    assert lemma == LEMMA
    mode = st.refine(problem, guess)
    assert mode.converged
    assert region.contains(complex(mode.sigma))
    if count is not None:
        found = st.count_unstable(problem, 1e-6)
        assert (found.count, found.lemma) == (count, LEMMA)


def test_the_limit_at_infinity_bounds_as_any_other_place() -> None:
    """y″ + tanh(z) y = σ y: the essential spectrum of +∞ ends at 1, and no mode lies right of it."""
    region, _ = st.equations(["y"], ["d(y,2) + tanh(z)*y - sigma*y"], *LINE).growing_region(1e-8)
    assert 1.0 <= region.upper_right.real < 1.1


@pytest.mark.parametrize(
    ("equation", "end"),
    [
        ("d(y,2) - z**2*y - sigma*y", st.Infinity(start=8)),
        ("d(y,2) + sech(z)**2*y - sigma*y", st.Infinity(start=8)),  # a decaying space that is not that of the limits
        ("d(y,2) + sech(z + i)**2*y - sigma*y", st.Infinity()),  # its conjugate is another function
    ],
)
def test_no_theorem_at_infinity_is_no_bound(equation: str, end: st.Infinity) -> None:
    assert st.equations(["y"], [equation], st.Conditions(0, ["y"]), end).growing_region is None
