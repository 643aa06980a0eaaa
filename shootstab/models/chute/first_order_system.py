"""The first-order system C φ′ = D φ of (A 8), with the errata of guide/theory.md 1.3, and the wall rows of (A 26).

The state is ψ = (ν̂/ν0, û, v̂, ŵ, T̂, û′, v̂′, β̂) with β = −K0 T̂′ + K0* ν̂′: ν̂ decays as ν0 does, and divided by it everything is of
order one and regular at infinity. Against (A 8) the first row is divided by ν0, and with φ = Sψ, S = diag(ν0, 1, …, 1),
the matrices are C S and D S − C S′. The entries are written with the divisions by ν0 carried out.

Every entry is affine in σ and stands as a pair (part without σ, factor of σ); indices count from 0.
"""

from __future__ import annotations

from typing import Any

from shootstab.core.series import Series
from shootstab.models.chute.background import Background
from shootstab.problems.recorded_pencil import Entries

SIZE = 8  # exact: states of the first-order system, of which half decay
DECAYING = 4  # exact: decaying states, and rows at the wall


def pencil_entries(bg: Background, tan_theta: Any, kx: Any, ky: Any) -> tuple[Entries, Entries, Entries, Entries]:
    """Non-zero entries of C0, C1, D0, D1 in (C0 + σ C1) ψ′ = (D0 + σ D1) ψ, in the ring of the background's coefficients."""
    ikx, iky, K2 = 1j * kx, 1j * ky, kx * kx + ky * ky
    nu, u_z, decay = bg.nu, bg.u_z, bg.decay
    viscous = bg.xi + 4 * bg.eta / 3  # L44
    mixed = (bg.xi + bg.eta / 3)[0]  # M24/(i k_x)
    e_flux = bg.e * bg.T_z - bg.e_star * bg.nu_z
    h_flux = bg.h * bg.T_z - bg.h_star * bg.nu_z
    shear_work = bg.c[0] * u_z[0] * u_z[0] + K2 * bg.K_star[0] - bg.l[0]

    n, eta, eta_z, lam, lam_z, ell = nu[0], bg.eta[0], bg.eta[1], viscous[0], viscous[1], decay[0]
    p, slope = bg.p[0], u_z[0]
    # Ω = σ + i k_x u0 multiplies what the paper writes as N11 − σΣ11: (part without σ, factor of σ)
    advect = ikx * bg.u[0]

    C0: Entries = {
        (0, 3): one(n),
        (1, 0): n * bg.c[0] * slope,
        (1, 4): bg.d[0] * slope,
        (1, 5): eta,
        (2, 6): eta,
        (3, 0): -n * bg.a[0] - lam * advect,
        (3, 4): -bg.b[0],
        (4, 0): n * e_flux[0],
        (4, 4): h_flux[0],
        (4, 7): -one(n),
        (5, 1): one(n),
        (6, 2): one(n),
        (7, 0): n * bg.K_star[0],
        (7, 4): -bg.K[0],
    }
    C1: Entries = {(3, 0): -lam}
    D0: Entries = {
        (0, 0): -advect,
        (0, 1): -ikx * one(n),
        (0, 2): -iky * one(n),
        (0, 3): -ell,
        (1, 0): ikx * (mixed * advect + n * bg.a[0]) - n * tan_theta - z_derivative(nu * bg.c * u_z),
        (1, 1): n * advect + K2 * eta,
        (1, 3): ikx * (mixed * ell - eta_z) + n * slope,
        (1, 4): ikx * bg.b[0] - z_derivative(bg.d * u_z),
        (1, 5): -eta_z,
        (2, 0): iky * (mixed * advect + n * bg.a[0]),
        (2, 2): n * advect + K2 * eta,
        (2, 3): iky * (mixed * ell - eta_z),
        (2, 4): iky * bg.b[0],
        (2, 6): -eta_z,
        (3, 0): (lam_z - lam * ell) * advect + n * (1 - ikx * bg.c[0] * slope) + z_derivative(nu * bg.a) + ikx * lam * slope,
        (3, 1): ikx * (2 * eta_z - lam * ell),
        (3, 2): iky * (2 * eta_z - lam * ell),
        (3, 3): lam_z * ell + n * advect + K2 * eta + lam * (decay[1] - ell * ell),
        (3, 4): bg.b[1] - ikx * bg.d[0] * slope,
        (3, 5): ikx * eta,
        (3, 6): iky * eta,
        (4, 0): -p * advect - n * shear_work - z_derivative(nu * e_flux),
        (4, 3): -p * ell + 3 * n * bg.T_z[0] / 2 - 2 * ikx * eta * slope,
        (4, 4): 3 * n * advect / 2 - bg.d[0] * slope * slope + K2 * bg.K[0] - h_flux[1] + bg.m[0],
        (4, 5): -2 * eta * slope,
        (5, 5): one(n),
        (6, 6): one(n),
        (7, 0): -bg.K_star[0] * bg.nu_z[0],
        (7, 7): one(n),
    }
    D1: Entries = {
        (0, 0): -one(n),
        (1, 0): ikx * mixed,
        (1, 1): n,
        (2, 0): iky * mixed,
        (2, 2): n,
        (3, 0): lam_z - lam * ell,
        (3, 3): n,
        (4, 0): -p,
        (4, 4): 3 * n / 2,
    }
    return C0, C1, D0, D1


def z_derivative(product: Series) -> Any:
    """F′ of F + F′ε."""
    return product[1]


def one(like: Any) -> Any:
    """1, of the shape and type of like."""
    return 1 + 0 * like


def continuum(bg: Background, kx: Any) -> Any:
    """σ_c of (2.13), where det C = 0, of fields in any ring: derivatives are not needed."""
    viscous = bg.xi + 4 * bg.eta / 3
    return -bg.nu * (bg.a * bg.K + bg.b * bg.K_star) / (bg.K * viscous) - 1j * kx * bg.u
