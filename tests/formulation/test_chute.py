"""The chute from its nonlinear equations: (2.1)–(2.7) linearized as they stand, brought to first order by the machine.

The base flow is a set of functions without any relation between them, so that what agrees agrees identically.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import mpmath
import numpy as np
import sympy as sp
from linearization import BASE_NAMES, KX, KY, SIGMA, TAN, first_order, jet, residuals

from shootstab.formulation.domain import Domain
from shootstab.formulation.evaluation import filled, on_arrays
from shootstab.formulation.first_order import FirstOrder
from shootstab.formulation.first_order import first_order as reduced
from shootstab.formulation.names import Names
from shootstab.formulation.system import System, coefficients

WAVE = {"k_x": 0.3, "k_y": -0.7, "tan_theta": 0.3}
UNKNOWNS = ("nu1", "u1", "v1", "w1", "T1")
PHI = (("nu1", 0), ("u1", 0), ("v1", 0), ("w1", 0), ("T1", 0), ("u1", 1), ("v1", 1))  # and β = −K0 T′ + K0* ν′
POINTS = np.array([0.21, 0.57, 0.83])


def wavy(mean: float, size: float, rate: float, phase: float) -> Callable[[Any, int], Any]:
    """mean + size sin(rate z + phase) and its derivatives, for doubles and for mpmath."""

    def f(z: Any, order: int) -> Any:
        library = np if isinstance(z, np.ndarray) else mpmath
        turn = [library.sin, library.cos, lambda x: -library.sin(x), lambda x: -library.cos(x)][order % 4]
        value = size * rate**order * turn(rate * z + phase)
        return value + mean if order == 0 else value

    return f


@cache
def base_flow() -> dict[str, Callable[[Any, int], Any]]:
    generator = np.random.default_rng(3)
    return {f"{name}0": wavy(*generator.uniform((1.0, 0.1, 0.5, 0.0), (2.0, 0.4, 1.5, 6.0)).tolist()) for name in BASE_NAMES}


@cache
def machine() -> FirstOrder:
    names = Names(UNKNOWNS, WAVE, {}, given=tuple(base_flow()))
    equations = {f"equation {i}": names.expression(r.first.doit(), f"equation {i}") for i, r in enumerate(residuals(), 1)}
    domain = Domain(0.0, 1.0, base_flow())
    return reduced(System.of(UNKNOWNS, equations, names.text), domain.vanishing, domain.regular)


SYMBOLS = [*(jet(name, k) for name in BASE_NAMES for k in range(3)), KX, KY, TAN, SIGMA]


@cache
def appendix() -> Callable[..., Any]:
    return sp.lambdify(SYMBOLS, list(first_order()), "numpy", cse=True)


def by_hand(z: float, sigma: complex) -> tuple[np.ndarray, np.ndarray]:
    """C and D of (A 8), from A.3 in words, at these values of the jets."""
    values = [base_flow()[f"{name}0"](np.array([z]), k)[0] for name in BASE_NAMES for k in range(3)]
    made = appendix()(*values, WAVE["k_x"], WAVE["k_y"], WAVE["tan_theta"], sigma)
    return np.array(made[0], dtype=complex), np.array(made[1], dtype=complex)


def in_psi(z: float) -> tuple[np.ndarray, np.ndarray]:
    """T with ψ = T φ, the machine's states in terms of the paper's, and dT/dz."""
    first, T = machine(), np.zeros((2, 8, 8), dtype=complex)
    at = on_arrays(np.array([z]), base_flow())
    for i, (name, order) in enumerate(first.states):
        if (name, order) in PHI:
            T[0, i, PHI.index((name, order))] = 1.0
            continue
        weights = {at_: (at(w)[0], at(w.derivative())[0]) for at_, w in first.fluxes[name].items()}
        if ("nu1", 1) in weights:  # with T′ it is a multiple of β
            K, K_star = (base_flow()[n](np.array([z]), 0)[0] for n in ("K0", "K_star0"))
            T[0, i, 7] = multiple = weights.pop(("nu1", 1))[0] / K_star
            assert abs(weights.pop(("T1", 1))[0] + multiple * K) < 1e-15 * abs(K), "the flux of the energy equation holds the heat flux"
        for at_, (value, slope) in weights.items():
            T[:, i, PHI.index(at_)] = value, slope
    return T[0], T[1]


def test_fluxes_are_states_and_sigma_stays_linear() -> None:
    """Mass flux, shear stresses and heat flux, as the paper has β: nothing but functions without zeros is divided by."""
    first = machine()
    assert first.order == 8
    assert first.degree == 1
    assert {at_ for weights in first.fluxes.values() for at_ in weights} == {("w1", 0), ("u1", 1), ("v1", 1), ("T1", 1), ("nu1", 1)}


def test_the_system_is_that_of_the_appendix() -> None:
    """ψ′ = C⁻¹D ψ with ψ = T φ is φ′ = C⁻¹D φ of (A 8): T⁻¹(A T − T′), to 1e−13."""
    first = machine()
    for z in POINTS:
        for sigma in (0.4 - 0.3j, -1.7 + 0.9j):
            at = on_arrays(np.array([z]), base_flow(), np.array([sigma]))
            C, D = (filled(part, (8, 8), np.array([z + 0j]), at)[0] for part in (first.C, first.D))
            T, T_z = in_psi(z)
            ours = np.linalg.solve(T, np.linalg.solve(C, D) @ T - T_z)
            theirs = np.linalg.solve(*by_hand(z, sigma))
            assert np.abs(ours - theirs).max() < 1e-13 * np.abs(theirs).max()


def test_det_C_is_the_continuous_spectrum_of_the_paper() -> None:
    """(A 9) up to a factor without σ: the zero of det C in σ is the same, (2.13)."""
    first = machine()
    assert set(first.determinant) == {0, 1}
    at = on_arrays(POINTS, base_flow())
    ours = -at(first.determinant[0]) / at(first.determinant[1])
    for z, sigma_c in zip(POINTS, ours, strict=True):
        dets = [np.linalg.det(by_hand(z, sigma)[0]) for sigma in (0.0, 1.0)]
        assert abs(sigma_c - dets[0] / (dets[0] - dets[1])) < 1e-12 * abs(sigma_c)


def test_no_equation_was_multiplied_by_what_may_vanish() -> None:
    assert machine().factors == ()
    assert all(max(coefficients(c), default=0) <= 1 for c in machine().C.values())
