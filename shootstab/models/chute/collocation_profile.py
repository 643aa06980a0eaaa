"""The steady flow on a collocation grid, and a grid that suits the flow."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import product

import numpy as np

from shootstab.models.chute import constitutive as law
from shootstab.models.chute.balance import slopes
from shootstab.models.chute.steady_flow import Flow
from shootstab.spectral import chebyshev
from shootstab.spectral.chebyshev import RealArray

NU_TRUNCATED = 1e-14  # chosen: ν0(z_m); (2.20)–(2.22) cost a relative error in σ of 10 to 1500 ν0(z_m) on the paper's flows
FOCI = (0.0, 1.0, 2.0, 3.0, 4.0, 6.0)  # chosen: foci of candidate grids, among which the profile decides
COMPARED_DEGREE = 64  # chosen: the degree at which candidate grids are compared
CANDIDATE_HALVES = (0.05, 0.7, 13)  # chosen: heights below which half the nodes lie, in z_m: from, to, and how many
LEAST_COEFFICIENT = 1e-13  # chosen: coefficients below this part of the largest are rounding


@dataclass(frozen=True, eq=False)
class SteadyProfile:
    """Steady quantities at points z, each of shape (m,), in the paper's letters: (2.7), (2.10) and table 1.

    nu_z, T_z, u_z are z-derivatives, log_nu_z = ν0′/ν0. a … m are the derivatives of p, η, K, K*, γ by ν and T.
    """

    nu: RealArray
    T: RealArray
    u: RealArray
    log_nu_z: RealArray
    T_z: RealArray
    u_z: RealArray
    p: RealArray
    q: RealArray
    eta: RealArray
    xi: RealArray
    K: RealArray
    K_star: RealArray
    a: RealArray
    b: RealArray
    c: RealArray
    d: RealArray
    e: RealArray
    h: RealArray
    e_star: RealArray
    h_star: RealArray
    l: RealArray  # noqa: E741
    m: RealArray

    @property
    def nu_z(self) -> RealArray:
        """ν0′ (m,)."""
        return self.nu * self.log_nu_z


def profile(flow: Flow, z: RealArray) -> SteadyProfile:
    """The steady flow at the points z (m,)."""
    chute = flow.chute
    states = flow.states_at(z).real
    nu, T, u, Q = np.exp(states[:, 0]), states[:, 1], states[:, 2], states[:, 3]
    log_nu_z, T_z, u_z, _ = slopes(nu, T, Q, chute.ep, chute.tan_theta, chute.radial_law, math.pi)
    g = law.coefficients(nu, chute.ep, chute.radial_law, math.pi)
    root = np.sqrt(T)
    return SteadyProfile(
        nu=nu, T=T, u=u, log_nu_z=log_nu_z, T_z=T_z, u_z=u_z,
        p=g.g1[0] * T, q=Q * nu, eta=g.g2[0] * root, xi=g.g6[0] * root, K=g.g3[0] * root, K_star=g.g4[0] * T * root,
        a=g.g1[1] * T, b=g.g1[0],
        c=g.g2[1] * root, d=g.g2[0] / (2 * root),
        e=g.g3[1] * root, h=g.g3[0] / (2 * root),
        e_star=g.g4[1] * T * root, h_star=1.5 * g.g4[0] * root,
        l=g.g5[1] * T * root, m=1.5 * g.g5[0] * root,
    )  # fmt: skip


def truncation_height(flow: Flow, nu: float = NU_TRUNCATED) -> float:
    """The z_m where ν0 = nu, from the nodes of the flow; above them ν0 falls as exp(−z/T_∞)."""
    logs, target = flow.states[:, 0].real, math.log(nu)
    if target < logs[0]:
        return float(flow.nodes[0] + flow.far_temperature * (logs[0] - target))
    below = int(np.argmax(logs > target))  # the first node that is denser
    return float(np.interp(target, logs[below - 1 : below + 1], flow.nodes[below - 1 : below + 1]))


@lru_cache(maxsize=64)
def clustering(
    flow: Flow, z_max: float, kx: float, ky: float, z_half: float | None = None, focus: float | None = None
) -> tuple[float, float]:
    """(z_h, β) of the grid on which flow and perturbation have the fastest falling Chebyshev coefficients; what is given stays.

    Compared is the area under log10 |a_n|, down to LEAST_COEFFICIENT of the largest, of ν0, T0, u0, q0/ν0, exp(−Kz), and c/(c + s) with
    c = ν0(a0 K0 + b0 K0*)/(K0(ξ0 + 4η0/3)) = −Re σ_c of (2.13): its poles at complex z are where a likely mode makes det C
    vanish, s = K√T_∞/10 + ik_x(u0 − Q0/M0).
    """
    heights = z_max * np.geomspace(*CANDIDATE_HALVES) if z_half is None else [z_half]
    pairs = product(heights, FOCI if focus is None else (focus,))
    best = min(pairs, key=lambda pair: _area(flow, *_candidate(flow, z_max, *map(float, pair)), kx, ky))
    return float(best[0]), float(best[1])


@lru_cache(maxsize=256)
def _candidate(flow: Flow, z_max: float, z_half: float, focus: float) -> tuple[RealArray, SteadyProfile]:
    """The points of a grid and the flow at them: for all waves they are the same."""
    z = chebyshev.malik(COMPARED_DEGREE, z_max, z_half, focus).z
    return z, profile(flow, z)


def _area(flow: Flow, z: RealArray, s: SteadyProfile, kx: float, ky: float) -> float:
    K, mean = math.hypot(kx, ky), flow.mass_flux / flow.hold_up
    c = s.nu * (s.a * s.K + s.b * s.K_star) / (s.K * (s.xi + 4 / 3 * s.eta))
    resonance = c / (c + K * flow.far_temperature**0.5 / 10 + 1j * kx * (s.u - mean))
    sizes = np.abs(chebyshev.coefficients(np.array([s.nu, s.T, s.u, s.q / s.nu, np.exp(-K * z), resonance])))
    sizes /= sizes.max(axis=1, keepdims=True)
    return float(np.log10(np.maximum(sizes, LEAST_COEFFICIENT).max(axis=0)).sum())
