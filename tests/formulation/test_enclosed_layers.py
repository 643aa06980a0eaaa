"""Layers and periodic ends in balls: against dispersion relations and eigenvalues known exactly."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest

pytest.importorskip("flint")

import shootstab as st
from shootstab.analyses.prove import prove, prove_disc
from shootstab.analyses.proved_verdicts import proved_verdicts
from shootstab.core.balls import acb, arb
from shootstab.multiprecision.enclosure import at_bits, decimal


def waves(k: float, rho: float, U: float, h: float) -> st.EquationProblem:
    """Two streams between walls at −1 and h with an interface at 0."""
    return st.equations(
        ["u", "w", "p"],
        ["rho*(sigma + i*k*U)*u + i*k*p", "rho*(sigma + i*k*U)*w + d(p)", "i*k*u + d(w)"],
        st.Conditions(-1, ["w"]),
        st.Conditions(h, ["w"]),
        interfaces=[
            st.InterfaceConditions(
                0, ["before(sigma + i*k*U)*h = before(w)", "behind(sigma + i*k*U)*h = behind(w)", "jump(p) = jump(rho)*h"], ["h"]
            )
        ],
        parameters={"k": k, "rho": [1, rho], "U": [0, U]},
    )


def truths(k: float, rho: float, U: float, h: float) -> list[complex]:
    """σ² coth k + ρ (σ + ikU)² coth kh = −k (1 − ρ)."""
    a, b = 1 / math.tanh(k), rho / math.tanh(k * h)
    return list(np.roots([a + b, 2j * k * U * b, -b * (k * U) ** 2 + k * (1 - rho)]).tolist())


def test_waves_at_an_interface_have_their_dispersion_relation() -> None:
    """Twenty waves drawn at random: of each exactly one eigenvalue in a disc about a root, and none in one beside it."""
    rng = np.random.default_rng(1)
    for _ in range(20):
        k, rho, U, h = (round(float(x), 2) for x in (rng.uniform(0.5, 2), rng.uniform(0.3, 0.9), rng.uniform(-1, 1), rng.uniform(0.5, 2)))
        problem, roots = waves(k, rho, U, h), truths(k, rho, U, h)
        root = max(roots, key=lambda s: abs(s) + s.real)
        apart = abs(roots[0] - roots[1])
        radius = min(1e-6, 1e-3 * apart)
        assert prove_disc(problem, root, radius).count == 1
        beside = prove_disc(problem, root + 3 * radius, radius)
        assert beside.count == 0 and "E15" in beside.lemmas


def test_an_interface_without_a_jump_is_none() -> None:
    """D of a string in one piece and in three differs by a constant: by none, where the pieces are joined by the identity."""
    ends = st.Conditions(0, ["y"]), st.Conditions(1, ["y"])
    joints = [st.InterfaceConditions(z, ["jump(y)", "jump(d(y))"]) for z in (0.3, 0.7)]
    one, three = (st.equations(["y"], ["d(y,2) + z*d(y) - sigma*y"], *ends, interfaces=j) for j in ((), joints))
    rng = np.random.default_rng(2)
    with at_bits(140):
        D, E = one.enclosable.enclosure(140), three.enclosable.enclosure(140)  # type: ignore[union-attr]
        for _ in range(300):
            sigma = acb(*rng.uniform(-60, 20, 2).tolist())
            difference = D(sigma) - E(sigma)
            assert difference.contains(0)
            assert abs(difference).upper() < abs(D(sigma)) * arb("1e-25")
        thick = acb(arb(-10, "0.01"), arb(1, "0.01"))
        assert E.growth(thick) >= abs(E(acb("-9.995", "1.005"))).log().lower()
        assert decimal("1") == 1


@pytest.mark.parametrize("phase", [0.7, 2.0])
def test_coupled_ends_turn_a_wave_by_a_phase(phase: float) -> None:
    """y″ = σ y with y(1) = e^{ip} y(0) and y′ alike: σ = −(p + 2nπ)²."""
    turn = {"c": math.cos(phase), "s": math.sin(phase)}
    rows = ["right(y) = (c + i*s)*left(y)", "right(d(y)) = (c + i*s)*left(d(y))"]
    ring = st.equations(["y"], ["d(y,2) = sigma*y"], st.Conditions(0, []), st.Conditions(1, []), parameters=turn, coupled=rows)
    for n in (0, -1):
        assert prove_disc(ring, -((phase + 2 * n * math.pi) ** 2), 1e-6).count == 1
    assert prove_disc(ring, 3.0, 1.0).count == 0


@pytest.mark.parametrize("n", [1, 2])
def test_periodic_ends_have_double_eigenvalues(n: int) -> None:
    """y″ = σ y with period 1: σ = −(2nπ)², twice."""
    ring = st.equations(["y"], ["d(y,2) = sigma*y"], st.Periodic(0), st.Periodic(1))
    proof = prove_disc(ring, -((2 * n * math.pi) ** 2), 1e-8)
    assert proof.count == 2 and "E16" in proof.lemmas
    assert prove_disc(ring, -5.0, 3.0).count == 0


def test_d_between_periodic_ends_is_that_of_the_monodromy_matrix() -> None:
    """y′ = (σ + …) y has D = e^{σ + 1/2} − 1 with the coefficient 1/2 in the mean; of y″ = σ y it is 2 − 2 cosh √σ."""
    first = st.equations(["y"], ["d(y) = (sigma + 1/2)*y"], st.Periodic(0), st.Periodic(1))
    second = st.equations(["y"], ["d(y,2) = sigma*y"], st.Periodic(0), st.Periodic(1))
    rng = np.random.default_rng(3)
    with at_bits(120), mpmath.workprec(160):
        for problem, exact in ((first, lambda s: mpmath.exp(s + 0.5) - 1), (second, lambda s: 2 - 2 * mpmath.cosh(mpmath.sqrt(s)))):
            D = problem.enclosable.enclosure(120)  # type: ignore[union-attr]
            for _ in range(150):
                re, im = rng.uniform(-30, 5, 2).tolist()
                truth, found = exact(mpmath.mpc(re, im)), D(acb(re, im))
                off = acb(*(arb(mpmath.nstr(part, 45)) for part in (truth.real, truth.imag))) - found
                assert abs(off).lower() < arb("1e-40") * abs(found).upper()


def test_a_shear_layer_of_straight_lines() -> None:
    """Rayleigh's: (2σ)² = e^{−4k} − (1 − 2k)², half the layer and half the difference of velocities being 1."""
    scene = st.equations(
        ["w"],
        ["d(w,2) - k**2*w"],
        st.Infinity(),
        st.Infinity(),
        parameters={"k": 0.4},
        where={"U": ["-1", "z", "1"]},
        interfaces=[
            st.InterfaceConditions(z, ["jump(w)", "before(sigma + i*k*U)*jump(d(w)) = i*k*jump(d(U))*before(w)"]) for z in (-1.0, 1.0)
        ],
    )
    proof = prove(scene, 0.5 * math.sqrt(math.exp(-1.6) - 0.04), 20)
    with mpmath.workdps(40):
        truth = mpmath.sqrt(mpmath.exp(-mpmath.mpf(8) / 5) - mpmath.mpf(1) / 25) / 2
        assert abs(mpmath.mpf(proof.region["centre"]["re"]) - truth) < mpmath.mpf(proof.region["radius"])
    assert proof.count == 1 and {"E12", "E15"} <= set(proof.lemmas)


def test_verdicts_on_layers_become_theorems() -> None:
    problem, roots = waves(1.3, 0.8, 0.7, 2.0), truths(1.3, 0.8, 0.7, 2.0)
    report = st.verify(problem, [*roots, roots[0] + 0.05])
    confirmed, other, spurious = proved_verdicts(problem, report)
    for proved in (confirmed, other):
        assert proved.proved is not None and proved.proved.startswith("exactly one eigenvalue lies in") and not proved.contradicts
    assert spurious.proved is not None and spurious.proved.startswith("no eigenvalue lies within")
    assert spurious.within is not None and 0.001 < spurious.within < 0.05
