"""Richman's conditions at the base, linearized anew from (A 12)–(A 18).

With Φ = νχ the tractions are M_x = Φ√T S_x, M_y = Φ√T S_y, M_z = Φ(T + √T S_z), and the dissipation is ΔΦT^{3/2}: χ and ν enter as
this one product, which the normal stress balance (A 22) determines. Steady: S_z = 0 and Φ0 = p0/T0.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from shootstab.core.series import Series
from shootstab.models.chute import constitutive as law
from shootstab.models.chute.collocation_profile import SteadyProfile
from shootstab.models.chute.parameters import Chute

WallRow = NDArray[Any]


class Trace(NamedTuple):
    """Perturbations at z = 0 as rows (n,) that act on the unknowns: fields, slopes, x- and y-derivatives, and fluxes towards z."""

    nu: WallRow
    u: WallRow
    v: WallRow
    T: WallRow
    u_z: WallRow
    v_z: WallRow
    w_z: WallRow
    u_x: WallRow
    v_y: WallRow
    P_xz: WallRow
    P_yz: WallRow
    P_zz: WallRow
    q_z: WallRow


def conditions(chute: Chute, flow: SteadyProfile, at: Trace) -> tuple[WallRow, WallRow, WallRow]:
    """Three rows (n,) that vanish: the tractions along x and y, and the energy balance q_z = −M·u − ΔΦT^{3/2}. The fourth is w = 0."""
    r, pi = chute.r, math.pi
    nu, T, u, u_z, p = (float(f[0]) for f in (flow.nu, flow.T, flow.u, flow.u_z, flow.p))
    g0 = law.radial(Series((nu, 1.0)), chute.radial_law)[0]
    A, dA = law.wall_shear(Series((nu, 1.0)), g0, pi)
    kappa, B, delta = law.slip_coefficient(r), law.wall_normal(A, r), chute.wall_dissipation(pi)
    unit, root = math.sqrt(2 / pi), math.sqrt(T)
    stretch, splay = kappa - A * r * r / 2, -A * r * r / 2

    S_x0 = unit * (-kappa * u + stretch * u_z)
    S_x = unit * (-kappa * at.u + stretch * at.u_z - dA * r * r / 2 * u_z * at.nu)
    S_y = unit * (-kappa * at.v + stretch * at.v_z)
    S_z = unit * (B * at.w_z + splay * at.u_x)
    if chute.wall == "isotropic":  # (A 14) as printed lacks ∂v/∂y
        S_z = S_z + unit * splay * at.v_y

    phi0 = p / T
    phi = (at.P_zz - phi0 * at.T - phi0 * root * S_z) / T
    M_x0 = phi0 * root * S_x0
    M_x = root * S_x0 * phi + phi0 * S_x0 / (2 * root) * at.T + phi0 * root * S_x
    M_y = phi0 * root * S_y
    dissipation = delta * (T * root * phi + 1.5 * phi0 * root * at.T)
    return np.asarray(at.P_xz - M_x), np.asarray(at.P_yz - M_y), np.asarray(at.q_z + M_x * u + M_x0 * at.u + dissipation)
