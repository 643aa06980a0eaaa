"""All solutions at a multiple mode, and its chain, against exact ones: strings, coupled or not, in mixed unknowns."""

from __future__ import annotations

import math

import numpy as np
import pytest

import shootstab as st
from shootstab.analyses.eigenspace import Eigenspace, eigenspace
from shootstab.core.errors import InputError
from shootstab.problems import LinearProblem

PI2 = math.pi**2
Z = np.linspace(0.0, 1.0, 9)


def strings(coupling: np.ndarray, seed: int | None = None) -> tuple[LinearProblem, np.ndarray]:
    """u″ = (σ + coupling) u, u = 0 at both walls, in unknowns ψ = X (u₁, u₁′, u₂, …) that a seed mixes, with rows that it mixes; and X."""
    m = len(coupling)
    D0, D1 = np.zeros((2 * m, 2 * m)), np.zeros((2 * m, 2 * m))
    D0[::2, 1::2] = D1[1::2, ::2] = np.eye(m)
    D0[1::2, ::2] = coupling
    rows = np.eye(2 * m)[::2]
    random = np.random.default_rng(seed)
    X, Y = (np.eye(n) if seed is None else random.normal(size=(n, n)) for n in (2 * m, m))
    back = np.linalg.inv(X)
    A, B = X @ D0 @ back, X @ D1 @ back
    return st.problem(2 * m, lambda z: (A, B), st.Wall(0, Y @ rows @ back), st.Wall(1, Y @ rows @ back)), X


def in_strings(found: Eigenspace, X: np.ndarray) -> list[np.ndarray]:
    """Each function of the basis and of the chain as (u₁, u₁′, u₂, …) (2m, len(Z))."""
    functions = [*found.basis, *found.chain]
    return [np.linalg.solve(X, np.array(list(f(Z).values()))) for f in functions]


@pytest.mark.parametrize(("m", "seed"), [(2, None), (2, 1), (3, 2)])
def test_a_semisimple_mode_has_as_many_solutions_as_its_multiplicity(m: int, seed: int | None) -> None:
    """σ = −π²: (a sin πz, aπ cos πz, b sin πz, …) for all a, b, …"""
    problem, X = strings(np.zeros((m, m)), seed)
    found = eigenspace(problem, -9.8)
    assert (found.geometric_multiplicity, found.algebraic_multiplicity, found.chain) == (m, m, ())
    parts = in_strings(found, X)
    factors = np.array([u[1::2, 0] / math.pi for u in parts])
    assert np.linalg.matrix_rank(factors, tol=1e-3) == m
    for f, u, a in zip(found.basis, parts, factors, strict=True):
        exact = np.ravel(np.outer(a, [np.sin(math.pi * Z), math.pi * np.cos(math.pi * Z)])).reshape(u.shape)
        assert np.abs(X @ (u - exact)).max() <= f.error < 1e-8
        assert f.conditioning.relative >= 3.99  # u and v = u′: κ of one string, in unknowns that are not mixed
        unknown, z = f.peak
        assert f(z)[unknown] == pytest.approx(1.0, abs=1e-12)
        assert all(abs(f(z)[unknown]) < 1e-12 for unknown, z in f.zeros)


def test_one_string_of_a_pair_has_the_condition_that_it_has_alone() -> None:
    pair, alone = (eigenspace(strings(np.zeros((m, m)))[0], -9.8).basis[0].conditioning for m in (2, 1))
    assert pair.relative == pytest.approx(alone.relative, rel=1e-6)


@pytest.mark.parametrize(("m", "seed"), [(2, None), (2, 3), (4, None)])
def test_a_chain(m: int, seed: int | None) -> None:
    """u_k″ = σ u_k + u_{k+1}: u_{k+1} = (−π² − σ) u_k for the root function with u_1 = sin πz, so that φ_j is (−1)^j sin πz in u_{j+1}."""
    problem, X = strings(np.eye(m, k=1), seed)
    found = eigenspace(problem, -9.5, rtol=1e-5)
    assert (found.geometric_multiplicity, found.algebraic_multiplicity, len(found.chain)) == (1, m, m - 1)
    assert math.isinf(found.basis[0].conditioning.absolute)
    parts = in_strings(found, X)
    largest = parts[0][1, 0] / math.pi  # of u₁: the factor of the first one
    own = parts[0][::2] / largest
    assert np.abs(own[0] - np.sin(math.pi * Z)).max() < 1e-4
    # a chain is that but for multiples of the functions before: u₁ = s(σ) sin πz with s = Σ s_j (σ + π²)^j
    s = [u[1, 0] / math.pi for u in parts]
    for j, (f, u) in enumerate(zip([*found.basis, *found.chain], parts, strict=True)):
        exact = np.zeros_like(u)
        for k in range(j + 1):
            exact[2 * k] = (-1) ** k * s[j - k] * np.sin(math.pi * Z)
            exact[2 * k + 1] = (-1) ** k * s[j - k] * math.pi * np.cos(math.pi * Z)
        sizes = max(np.abs(values).max() for values in f(Z).values())
        assert np.abs(X @ (u - exact)).max() <= 3 * f.error * sizes < 1e-2  # s is taken from u itself
    unknown, z = found.basis[0].peak
    assert all(abs(f(z)[unknown]) <= 1e-9 for f in found.chain)


def test_a_chain_beside_a_string_is_told_by_its_multiplicities() -> None:
    coupling = np.zeros((3, 3))
    coupling[0, 1] = 1.0
    found = eigenspace(strings(coupling)[0], -9.8, rtol=1e-5)
    assert (found.geometric_multiplicity, found.algebraic_multiplicity, found.chain) == (2, 3, ())
    assert found.structure == "defective: geometric multiplicity 2, algebraic 3"


def test_a_simple_mode_has_its_eigenfunction_for_a_basis() -> None:
    found = st.eigenspace("benard", 3.4)
    assert found.structure == "simple"
    (f,) = found.basis
    assert f.peak == st.eigenfunction("benard", 3.4).peak


def test_a_multiple_mode_has_no_single_eigenfunction_and_does_not_move_as_one() -> None:
    problem, _ = strings(np.zeros((2, 2)))
    with pytest.raises(InputError, match=r"stands for 2 that are not told apart: allowed is a simple mode; st\.eigenspace"):
        st.eigenfunction(problem, -9.8)
    with pytest.raises(InputError, match="is multiple"):
        eigenspace(problem, -9.8).basis[0].shift(problem)
