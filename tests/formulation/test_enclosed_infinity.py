"""Lemma E12 of the guide: decaying solutions in balls against those in closed form, and theorems on modes between ends at infinity."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
import pytest

flint = pytest.importorskip("flint")

from flint import acb, acb_mat, arb, ctx  # noqa: E402

import shootstab as st  # noqa: E402
from shootstab.analyses.prove import prove_disc  # noqa: E402
from shootstab.core.errors import ConvergenceError  # noqa: E402
from shootstab.formulation.enclosed_infinity import EnclosedInfinity  # noqa: E402
from shootstab.formulation.exponentials import exponential_end  # noqa: E402

WELL = "d(y,2) + (nu*(nu+1)*sech(z)**2 - sigma)*y"  # modes σ = (ν − j)², j < ν; G. Pöschl & E. Teller, Z. Phys. 83 (1933) 143


def well(nu: float, left: Any = None, right: Any = None) -> st.EquationProblem:
    return st.equations(["y"], [WELL], left or st.Infinity(), right or st.Infinity(), parameters={"nu": nu})


def exact(k: Any, z: Any, d: int) -> tuple[Any, Any]:
    """(y, y′) of y″ = (k² − 2 sech² z) y that decays towards d ∞: e^{−d k z} (k + d tanh z), over the exponential."""
    t, s = acb(z).tanh(), acb(z).sech()
    return k + d * t, -d * k * (k + d * t) + d * s * s


@pytest.mark.parametrize("d", [-1, 1])
def test_one_decaying_solution_is_that_in_closed_form(d: int) -> None:
    rng, problem = np.random.default_rng(3), well(1.0)
    with ctx.workprec(160):
        end = EnclosedInfinity(exponential_end(problem.states, d), 2, 1, problem.generic_sigma)
        for _ in range(6):
            k = acb(rng.uniform(0.1, 2.0), rng.uniform(-1.5, 1.5))
            y, slope = end.minors(k * k)
            known = exact(k, end.place, d)
            assert (slope / y).overlaps(known[1] / known[0])
            assert (slope / y).rel_accuracy_bits() > 100


def test_the_minors_of_two_decaying_solutions_are_those_in_closed_form() -> None:
    """With u = a + b, v = a − b: a″ = (σ − 2 sech²) a and b″ = (σ + 3 − 2 sech²) b."""
    told = ["d(u,2) - (sigma - 2*sech(z)**2)*u - 1.5*(u - v)", "d(v,2) - (sigma - 2*sech(z)**2)*v + 1.5*(u - v)"]
    problem = st.equations(["u", "v"], told, st.Infinity(), st.Infinity())
    states = problem.first_order.states
    with ctx.workprec(160):
        end = EnclosedInfinity(exponential_end(problem.states, 1), 4, 2, problem.generic_sigma)
        for sigma in (acb(0.7, 0.2), acb(2.0, -1.0), acb(arb(1.3), arb(0, 1e-12))):
            a, b = (exact(k.sqrt(), end.place, 1) for k in (sigma, sigma + 3))
            columns = [[a[order], (1 if name == "u" else -1) * b[order]] for name, order in states]
            known = [acb_mat([columns[i], columns[j]]).det() for i, j in combinations(range(4), 2)]
            found = end.minors(sigma)
            for x, y in combinations(range(6), 2):
                assert (found[x] * known[y] - found[y] * known[x]).contains(0)
            assert all(x.rad() < 1e-9 for x in found)


def test_modes_between_ends_at_infinity_are_proved() -> None:
    proof = st.prove(well(2.5), guess=6.2, digits=12)
    assert proof.count == 1 and proof.region["centre"]["re"].startswith("6.2500000000000")
    assert {"E2", "E3", "E17"} <= set(proof.lemmas)
    assert {"E4", "E12"} <= set(prove_disc(well(2.3), 1.69, 0.01).lemmas)
    assert prove_disc(well(2.5), 0.25, 0.01).count == 1


@pytest.mark.parametrize("ends", [{"left": st.Conditions(0, ["y"])}, {"right": st.Conditions(0, ["y"])}])
def test_half_of_the_line_has_the_odd_modes(ends: dict[str, Any]) -> None:
    assert prove_disc(well(2.5, **ends), 2.25, 0.03).count == 1
    assert prove_disc(well(2.5, **ends), 6.25, 0.03).count == 0


def test_next_to_the_essential_spectrum_nothing_is_proved() -> None:
    with pytest.raises(ConvergenceError, match="it is not proved that 1 of 2 solutions decay and the others grow"):
        prove_disc(well(2.5), -1.0, 0.1)


def test_exponents_that_are_not_told_apart_are_enclosed_as_a_graph() -> None:
    """Both equations have the same exponents: 1 is a mode of 2 sech² and of 6 sech², and 4 one of the latter."""
    told = ["d(u,2) - (sigma - 2*sech(z)**2)*u", "d(v,2) - (sigma - 6*sech(z)**2)*v - sech(z)**2*u"]
    problem = st.equations(["u", "v"], told, st.Infinity(), st.Infinity())
    proof = prove_disc(problem, 1.0, 0.01)
    assert proof.count == 2 and "E17" in proof.lemmas
    assert prove_disc(problem, 4.0, 0.01).count == 1
