"""Decaying solutions as graphs in balls: against Airy's and parabolic cylinder functions, and random systems with an exact one."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

pytest.importorskip("flint")

import shootstab as st
from shootstab.analyses.prove import prove, prove_disc
from shootstab.core.balls import acb, acb_mat, arb, ctx
from shootstab.core.errors import ConvergenceError
from shootstab.formulation.asymptotic_end import asymptotic_end
from shootstab.formulation.enclosed_graph import EnclosedGraph
from shootstab.multiprecision.decaying_graph import decaying_rows, graph
from shootstab.multiprecision.tailed_series import TailedSeries

TERMS = 40


def held(x: object, truth: object) -> float:
    """The distance of the truth from a ball's middle over its radius, both parts."""
    parts = ((x.real, truth.real), (x.imag, truth.imag))  # type: ignore[attr-defined]
    ratios = []
    for part, exact in parts:
        off = abs(mpmath.mpf(part.mid().str(60, radius=False)) - exact)
        radius = mpmath.mpf(part.rad().str(20, radius=False))
        ratios.append(float(off / radius) if radius else float(off > 1e-50))
    return max(ratios)


def test_graphs_of_random_systems_hold_the_exact_one() -> None:
    """ψ = (1 + x S) φ with dφ/ds = Λ φ, Λ diagonal and dx/ds = −x: the space over the first columns of 1 + x S decays."""
    rng, ratios = np.random.default_rng(4), []
    with ctx.workprec(100), mpmath.workdps(50):
        for _ in range(120):
            n, k = ((2, 1), (3, 1), (3, 2), (4, 2))[int(rng.integers(4))]
            x0 = 2.0 ** -int(rng.integers(4, 8))
            S = (rng.standard_normal((n, n)) + 1j * rng.standard_normal((n, n))) * 0.7
            rates = np.concatenate((-rng.uniform(0.3, 2, k), rng.uniform(0.3, 2, n - k))) + 1j * rng.uniform(-1, 1, n)
            V = np.eye(n) + 0.3 * rng.standard_normal((n, n))
            x = TailedSeries([acb(0), acb(x0)], TERMS, real=True)
            one = TailedSeries([acb(1)], TERMS)
            Y = [[x * acb(S[i, j]) + acb(V[i, j]) for j in range(n)] for i in range(n)]
            right = [[Y[i][j] * acb(rates[j]) - x * acb(S[i, j]) for j in range(n)] for i in range(n)]  # A Y = Y Λ + dY/ds
            A = _times_inverse(right, Y, one)
            rows = decaying_rows(acb_mat([[entry.c[0] for entry in row] for row in A]), k)
            try:
                X = graph(A, rows, lambda f: TailedSeries([c * -m for m, c in enumerate(f.c)], f.terms), TERMS // 2)
            except ConvergenceError:
                continue
            exact = mpmath.matrix(V.tolist()) + mpmath.mpf(x0) * mpmath.matrix(S.tolist())
            others = [i for i in range(n) if i not in rows]
            top = mpmath.matrix([[exact[i, j] for j in range(k)] for i in rows])
            low = mpmath.matrix([[exact[i, j] for j in range(k)] for i in others])
            truth = low * top**-1
            ratios += [held(X[i, j], truth[i, j]) for i in range(n - k) for j in range(k)]
    assert len(ratios) > 100
    assert max(ratios) <= 1.0 and max(ratios) > 1e-3


def _times_inverse(B: list, Y: list, one: TailedSeries) -> list:
    """B Y⁻¹ by elimination of columns."""
    n = len(Y)
    rows = [[Y[j][i] for j in range(n)] + [B[j][i] for j in range(n)] for i in range(n)]  # transposed
    for c in range(n):
        top = max(range(c, n), key=lambda r: float(abs(rows[r][c].c[0])))
        rows[c], rows[top] = rows[top], rows[c]
        inverse = one / rows[c][c]
        rows[c] = [e * inverse for e in rows[c]]
        for r in range(n):
            if r != c:
                factor = rows[r][c]
                rows[r] = [a - factor * b for a, b in zip(rows[r], rows[c], strict=True)]
    return [[rows[j][n + i] for j in range(n)] for i in range(n)]


@pytest.mark.parametrize("sigma", [0.3, 2.5 + 1j, -0.7 - 0.2j])
def test_airy_functions_lie_in_their_enclosures(sigma: complex) -> None:
    """y″ = (z + σ) y: y′/y = Ai′/Ai at z + σ, a series in powers of z^{−1/2}."""
    problem = st.equations(["y"], ["d(y,2) = (z + sigma)*y"], st.Conditions(0, ["y"]), st.Infinity())
    with ctx.workprec(100), mpmath.workdps(60):
        end = EnclosedGraph(asymptotic_end(problem.states, 1), 2, 1, 0.5)
        y, slope = end.minors(acb(sigma.real, sigma.imag))
        at = mpmath.mpf(end.place.mid().str(60, radius=False)) + mpmath.mpmathify(sigma)
        truth = mpmath.airyai(at, 1) / mpmath.airyai(at)
        ratio = slope / y
        assert abs(ratio.real - arb(mpmath.nstr(truth.real, 50))).lower() < arb("1e-45")
        assert held(ratio, truth) < 1.001 and ratio.rel_accuracy_bits() > 60


def test_zeros_of_airys_function_and_levels_of_oscillators_are_proved() -> None:
    half = st.equations(["y"], ["d(y,2) = (z + sigma)*y"], st.Conditions(0, ["y"]), st.Infinity())
    proof = prove(half, -2.338, 12)
    with mpmath.workdps(30):
        assert abs(mpmath.mpf(proof.region["centre"]["re"]) - mpmath.airyaizero(1)) < 1e-12
    assert proof.count == 1 and "E17" in proof.lemmas
    assert prove_disc(half, -3.2, 1e-3).count == 0
    well = st.equations(["u"], ["-d(u,2) + z**2*u = sigma*u"], st.Infinity(), st.Infinity())
    assert prove_disc(well, 3.0, 1e-8).count == 1
    assert prove_disc(well, 4.0, 0.1).count == 0


def test_a_soliton_whose_rates_differ_by_a_whole_number_is_proved() -> None:
    """The series of each solution by itself would have logarithms, the graph has none."""
    well = st.equations(["y"], ["d(y,2) + 6*sech(x)**2*y = sigma*y"], st.Infinity(), st.Infinity(), variable="x")
    found = prove(well, 4.0, 12)
    assert found.count == 1
    for sigma in (1.0, 4.0):
        assert prove_disc(well, sigma, 1e-3).count == 1
