"""The essential spectrum of an end at infinity as a formula: known ones, and the zeros of the relation against the limit in doubles."""

from __future__ import annotations

import numpy as np
import pytest

import shootstab as st
from shootstab.formulation.dispersion import dispersion_relation, free_name, zero_in_sigma
from shootstab.formulation.evaluation import on_arrays
from shootstab.formulation.expression import Expression
from shootstab.formulation.system import coefficients
from shootstab.models.catalogue.scene_files import scene_files


def test_what_is_told_of_known_ones() -> None:
    """A kink: σ² = −2 − q²; a front: −1/2 − q²; advection: −q² + 2iq and the two limits of the potential; sheets at rest have none."""
    told = {name: dict(scene_files()[name].problem().explanation) for name in ("kink", "bistable-front", "holmboe")}  # type: ignore[attr-defined]
    assert told["kink"]["essential spectrum, +infinity"] == "the zeros in sigma of -q**2 - 2 - sigma**2, q real"
    assert told["bistable-front"]["essential spectrum, -infinity"] == "sigma = -q**2 - 1/2, q real"
    assert told["holmboe"]["essential spectrum, +infinity"] == "none: -q**2 - 36/25 does not hold the eigenvalue"
    advection = st.equations(["y"], ["d(y,2) + 2*d(y) + tanh(z)*y = sigma*y"], st.Infinity(), st.Infinity(), reference=3)
    for side, limit in (("-", "- 1"), ("+", "+ 1")):
        assert dict(advection.explanation)[f"essential spectrum, {side}infinity"] == f"sigma = -q**2 + 2*i*q {limit}, q real"


LINES: dict[str, tuple[list[str], list[str]]] = {
    "advection": (["y"], ["d(y,2) + 2*(1 + sech(z))*d(y) + tanh(z)*y = sigma*y"]),
    "Orr-Sommerfeld": (["f"], ["(sigma + 0.3*i*U)*(d(f,2) - 0.09*f) - 0.3*i*d(U,2)*f = (d(f,4) - 0.18*d(f,2) + 0.0081*f)/50"]),
    "a system in sigma squared": (["a", "b"], ["d(a,2) + U*b = sigma*a", "(sigma**2 - 2*sigma)*b - d(b) + (2 - tanh(2*z)**2)*a = 0"]),
}


@pytest.mark.parametrize("direction", [-1, 1])
@pytest.mark.parametrize("name", LINES)
def test_where_the_relation_holds_the_limit_has_an_imaginary_rate(name: str, direction: int) -> None:
    """By another way: C and D in doubles at z = ±60."""
    problem = st.equations(*LINES[name], st.Infinity(), st.Infinity(), where={"U": "tanh(z)"}, reference=3)
    relation = dispersion_relation(problem.states, direction, "q")
    assert relation is not None
    far = problem.function.at(60.0 * direction)
    for q in (0.7, -1.9):
        values = {power: value_at(c, q) for power, c in coefficients(relation).items()}
        sigmas = np.roots([values.get(k, 0.0) for k in range(max(values), -1, -1)])
        assert len(sigmas)
        for sigma in sigmas:
            C, D = (sum(sigma**k * part for k, part in enumerate(parts)) for parts in (far.C, far.D))
            assert np.abs(np.linalg.eigvals(np.linalg.solve(C, D)) - 1j * q).min() < 1e-9


def value_at(coefficient: Expression, q: float) -> complex:
    """At a wavenumber; the coordinate is not in it."""
    at = on_arrays(np.array([0.0]), {})
    wanted = [(int(outer[0][1]) if outer else 0, rest) for outer, rest in coefficient.collected(lambda atom: atom.name == "q")]
    return sum(complex(np.ravel(at(rest))[0]) * q**power for power, rest in wanted)


def test_no_formula_where_there_is_no_exponential() -> None:
    gauss = st.equations(["y"], ["d(y,2) + 2*exp(-z**2)*y = sigma*y"], st.Infinity(), st.Infinity())
    assert dispersion_relation(gauss.states, 1, "q") is None
    assert not any(heading.startswith("essential") for heading, _ in gauss.explanation)


def test_the_wavenumber_has_a_name_of_its_own() -> None:
    assert free_name(["y", "z"]) == "q"
    assert free_name(["q", "z"]) == "m"
    assert zero_in_sigma(dispersion_relation(scene_files()["kink"].problem().states, 1, "q")) is None  # type: ignore[attr-defined,arg-type]


def test_an_essential_spectrum_of_one_point_holds_no_wavenumber() -> None:
    """Rayleigh's equation for tanh z in u, v, p: all waves of the outer streams have the frequency of these."""
    layer = st.equations(
        ["u", "v", "p"],
        ["sigma*u + i*a*U*u + v*d(U) + i*a*p", "sigma*v + i*a*U*v + d(p)", "i*a*u + d(v)"],
        st.Infinity(),
        st.Infinity(),
        parameters={"a": 0.5},
        where={"U": "tanh(z)"},
    )
    assert dict(layer.explanation)["essential spectrum, +infinity"] == "sigma = -1/2*i"
