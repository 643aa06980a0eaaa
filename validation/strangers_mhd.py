"""Strangers with singular pencils: Alfvén waves, the tearing mode, baroclinic instability with β; and Taylor and Couette's cylinders."""

from __future__ import annotations

from typing import Any

import numpy as np
from collocation import stretched
from stranger import Fixed, Stranger, collocated, walls

import shootstab as st

FIXED = [[1, 0]]  # exact


def alfven(x: Any) -> Any:
    """((σ − ω_A²)ξ′)′ = k²(σ − ω_A²)ξ, ω_A² = 1 + x + x²/2, σ = ω², k = 2, in (ξ, (σ − ω_A²)ξ′). No mode: a theorem by energy."""
    a = 1 + x + x * x / 2
    return np.array([[-a, 0], [0, 1]]), np.array([[1.0, 0], [0, 0]]), np.array([[0, 1], [-4 * a, 0]]), np.array([[0, 0], [4.0, 0]])


def alfven_curve(x: Any) -> Any:
    return 1 + x + x * x / 2


def tearing(S: float, k: float) -> Any:
    """γψ = kBφ + (ψ″ − k²ψ)/S, γ(φ″ − k²φ) = −k[B(ψ″ − k²ψ) − B″ψ], B = tanh x; in (ψ, ψ′, φ, φ′). C is singular at γ = 0."""

    def pencil(x: Any) -> Any:
        B = np.tanh(x)
        B2 = -2 * B * (1 - B * B)
        C0, C1 = np.diag([1.0, 1, 1, 0]), np.diag([0, 0, 0, 1.0])
        D0 = np.array([[0, 1, 0, 0], [k * k, 0, -S * k * B, 0], [0, 0, 0, 1], [k * B2, 0, k * k * S * B * B, 0]])
        D1 = np.array([[0, 0, 0, 0], [S, 0, 0, 0], [0, 0, 0, 0], [-k * S * B, 0, k * k, 0]])
        return C0, C1, D0, D1

    return pencil


def green(beta: float, mu: float) -> Any:
    """Eady's problem with β (Green 1960): (z − c)(ψ″ − μ²ψ) + βψ = 0, (z − c)ψ′ = ψ at z = 0, 1; σ = c."""

    def pencil(z: Any) -> Any:
        return (
            np.array([[1, 0], [0, z]]),
            np.array([[0, 0], [0, -1.0]]),
            np.array([[0, 1], [mu * mu * z - beta, 0]]),
            np.array([[0, 0], [-mu * mu, 0]]),
        )

    return pencil


def taylor_couette(R: float, k: float) -> Any:
    """Axisymmetric, radii 1 and 2, outer cylinder at rest: L = ∂∂* − k², (L − σ)Lu = 2k²RΩv, (L − σ)v = 2ARu, Ω = A + B/r²."""
    A, B = -1.0 / 3.0, 4.0 / 3.0
    a = k * k

    def pencil(r: Any) -> Any:
        D0, D1 = np.zeros((6, 6), dtype=type(r + 0j)), np.zeros((6, 6))
        for i in (0, 2, 4):
            D0[i, i + 1] = 1
            D0[i + 1, i], D0[i + 1, i + 1] = 1 / (r * r) + a, -1 / r
        D0[1, 2] = 1
        D0[3, 4] = 2 * a * R * (A + B / (r * r))
        D0[5, 0] = 2 * A * R
        D1[3, 2] = D1[5, 4] = 1
        return D0, D1

    return pencil


CYLINDERS = np.eye(6)[[0, 1, 4]]  # exact


def no_modes() -> list[tuple[complex, float]]:
    return []


ON = tuple(alfven_curve(x) for x in np.linspace(0.02, 0.98, 28))  # chosen
TEARING = [[1, 0, 0, 0], [0, 0, 1, 0]]  # exact
LOW, HIGH = [[-1, 0]], [[-1, 1]]  # exact

STRANGERS = [
    Stranger(
        "Alfvén continuum, with continuum=",
        "a fault report",
        "exact",
        walls(2, alfven, 0, FIXED, 1, FIXED, continuum=alfven_curve),
        no_modes,
        spurious=(0.5, 3.0, 1.5 + 0.4j),
        on=ON,
        region=st.Rectangle(0.2 - 0.5j, 4 + 0.6j),
    ),
    Stranger(
        "Alfvén continuum, without continuum=",
        "a fault report",
        "exact",
        walls(2, alfven, 0, FIXED, 1, FIXED),
        no_modes,
        spurious=(0.5, 3.0, 1.5 + 0.4j),
        on=ON,
    ),
    Stranger(
        "tearing mode, S = 1000, k = 0.5",
        "Furth, Killeen & Rosenbluth 1963",
        "collocation",
        walls(4, tearing(1e3, 0.5), -10, TEARING, 10, TEARING),
        collocated(4, stretched(tearing(1e3, 0.5), 10.0, 0.15), Fixed(-1, TEARING), Fixed(1, TEARING), [0.0131], N=110),
        spurious=(0.03, 0.02 + 0.01j),
    ),
    Stranger(
        "Green: baroclinic instability with β",
        "Green 1960",
        "collocation",
        lambda: st.problem(
            2, green(0.3, 1.2), st.Wall(0, LOW, moving=[[0, -1]]), st.Wall(1, HIGH, moving=[[0, -1]]), continuum=lambda z: z
        ),
        collocated(2, green(0.3, 1.2), Fixed(0, LOW, [[0, -1]]), Fixed(1, HIGH, [[0, -1]]), [0.4 + 0.25j, 0.4 - 0.25j], N=60),
        on=(0.5, 0.7),
        spurious=(0.8 + 0.3j,),
    ),
    Stranger(
        "Taylor–Couette, radius ratio 1/2, critical",
        "a published critical Reynolds number of 11 digits, which leave the growth rate 0 within 3e-7",
        "published",
        walls(6, taylor_couette(68.186268346, 3.162475910), 1, CYLINDERS, 2, CYLINDERS),
        lambda: [(0j, 3e-7)],
        scale=10.0,
        skip=("small", "verify"),
    ),
    Stranger(
        "Taylor–Couette, radius ratio 1/2, Re = 80",
        "textbook",
        "collocation",
        walls(6, taylor_couette(80.0, 3.16), 1, CYLINDERS, 2, CYLINDERS),
        collocated(6, taylor_couette(80.0, 3.16), Fixed(1, CYLINDERS), Fixed(2, CYLINDERS), [2.5], N=24),
        unstable=1,
    ),
]
