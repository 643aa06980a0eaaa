"""Linearized boundary conditions of Richman (1988) at the base: Q dX/dz + R X = 0, (A 26).

X′ is expressed through ψ = (ν̂/ν0, û, v̂, ŵ, T̂, û′, v̂′, β̂): û′ and v̂′ are components of it, −K0* ν̂′ + K0 T̂′ = −β̂, and ŵ′ comes from
conservation of mass, which brings σ in. Of (A 20)–(A 25) the two readings of ν and v are kept apart as chi_nu and chi_v.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from shootstab.core.series import Series
from shootstab.models.chute import constitutive as law
from shootstab.models.chute.background import Background
from shootstab.models.chute.first_order_system import DECAYING, SIZE
from shootstab.models.chute.parameters import Chute


def wall_rows(chute: Chute, bg: Background, kx: Any, ky: Any, pi: Any) -> tuple[np.ndarray, np.ndarray]:
    """W0, W1 (4, 8): the base holds where (W0 + σ W1) ψ = 0. The background is that of the base, one point."""
    Q, R = base_matrices(chute, bg, kx, ky, pi)
    nu, ell, advect = bg.nu[0], bg.decay[0], 1j * kx * bg.u[0]
    W0 = np.zeros((DECAYING, SIZE), dtype=np.result_type(type(1j * nu)) if not hasattr(nu, "ctx") else object)
    W1 = np.zeros_like(W0)
    for row in range(DECAYING):
        W0[row, 0] = R.get((row, 0), 0) * nu
        for column in range(1, 5):
            W0[row, column] = R.get((row, column), 0)
        W0[row, 5], W0[row, 6] = Q.get((row, 1), 0), Q.get((row, 2), 0)
        # ŵ′ = −(σ + i k_x u0) ν̂/ν0 − i k_x û − i k_y v̂ − (ν0′/ν0) ŵ
        w_z = Q.get((row, 3), 0)
        W0[row, 0] -= w_z * advect
        W0[row, 1] -= w_z * 1j * kx
        W0[row, 2] -= w_z * 1j * ky
        W0[row, 3] -= w_z * ell
        W1[row, 0] = -w_z
    W0[3, 7] = -1
    return W0, W1


def base_matrices(chute: Chute, bg: Background, kx: Any, ky: Any, pi: Any) -> tuple[dict[tuple[int, int], Any], dict[tuple[int, int], Any]]:
    """Q and R of (A 26), 4×5 over (ν̂, û, v̂, ŵ, T̂), by their non-zero entries counted from 0.

    The pair Q[3, 0] = −K0*, Q[3, 4] = K0 stands in for itself: it is −β̂.
    """
    nu, T, u, u_z, p, eta, xi = bg.nu[0], bg.T[0], bg.u[0], bg.u_z[0], bg.p[0], bg.eta[0], bg.xi[0]
    r, root_T, root = chute.r, T**0.5, (2 / pi) ** 0.5
    kappa, delta = law.slip_coefficient(r), chute.wall_dissipation(pi)

    x = Series((nu, 1 + 0 * nu))
    A = law.wall_shear(x, law.radial(x, chute.radial_law)[0], pi)
    B = law.wall_normal(A[0], r)

    S_x0 = root * (-kappa * u + (kappa - A[0] * r * r / 2) * u_z)
    S_x_nu = -root * A[1] * r * r * u_z / 2
    S_x_u = S_y_v = -root * kappa
    S_x_uz = S_y_vz = root * (kappa - A[0] * r * r / 2)
    S_z_u = -root * A[0] * r * r / 2
    S_z_v = S_z_u if chute.wall == "isotropic" else 0
    S_z_wz = root * B

    T32, second = T * root_T, xi - 2 * eta / 3
    chi0 = p / (nu * T)
    chi_nu = (bg.a[0] * nu - p) / (nu * nu * T)
    chi_u = -(second * root_T + p * S_z_u) / (nu * T32)
    chi_v = -(second * root_T + p * S_z_v) / (nu * T32)
    chi_T = (bg.b[0] * T - p) / (nu * T * T)
    chi_wz = -((xi + 4 * eta / 3) * root_T + p * S_z_wz) / (nu * T32)

    traction, loss = nu * root_T * S_x0, delta * nu * T32
    Q = {
        (1, 1): eta + nu * chi0 * root_T * S_x_uz,
        (1, 3): traction * chi_wz,
        (2, 2): eta + nu * chi0 * root_T * S_y_vz,
        (3, 0): -bg.K_star[0],
        (3, 1): eta * u,
        (3, 3): -loss * chi_wz,
        (3, 4): bg.K[0],
    }
    e_flux = bg.e[0] * bg.T_z[0] - bg.e_star[0] * bg.nu_z[0]
    h_flux = bg.h[0] * bg.T_z[0] - bg.h_star[0] * bg.nu_z[0]
    R = {
        (0, 3): 1,
        (1, 0): bg.c[0] * u_z + chi0 * root_T * S_x0 + traction * chi_nu + nu * chi0 * root_T * S_x_nu,
        (1, 1): 1j * kx * traction * chi_u + nu * chi0 * root_T * S_x_u,
        (1, 2): 1j * ky * traction * chi_v,
        (1, 4): bg.d[0] * u_z + traction * chi_T + nu * chi0 / root_T * S_x0 / 2,
        (2, 2): nu * chi0 * root_T * S_y_v,
        (3, 0): e_flux + bg.c[0] * u * u_z - delta * chi0 * T32 - loss * chi_nu,
        (3, 1): eta * u_z - 1j * kx * loss * chi_u,
        (3, 2): -1j * ky * loss * chi_v,
        (3, 4): h_flux + bg.d[0] * u * u_z - loss * chi_T - 3 * delta * nu * chi0 * root_T / 2,
    }
    return Q, R
