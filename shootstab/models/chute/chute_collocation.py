"""The linearized granular chute by Chebyshev collocation, from the conservative form of (2.1)–(2.7).

Unknowns X = (ν̂/ν0, û, −i v̂, ŵ, T̂) on M + 1 Gauss–Lobatto points, 5M + 5 in all, modes exp(σt + ik_x x + ik_y y). The points are
those of Malik's map, packed closer around z_h where that pays (`chebyshev.malik`, `profile.clustering`).
The perturbations of pressure tensor and heat flux are formed as matrices, and the differentiation matrix is applied to them as
whole fluxes; nothing is expanded, and no second derivative of the steady flow is needed.

Arrangement: mass, which differentiates ν̂ nowhere, is collocated on all M + 1 points, so that it can be solved for ν̂ where ŵ is
known; momentum and energy on the M − 1 inner points; the 4 + 4 conditions take the place of momentum and energy at the ends.
All fields share one grid and one degree, so fluxes are differentiated where they are formed and nothing is interpolated.
−i v̂ in place of v̂ makes A real for k_x = 0; ν̂/ν0 keeps the mass rows of order one where ν0 is 1e−12.

Source: Woodhouse & Hogg (2010), §2 and the conditions (2.20)–(2.22), (A 10)–(A 18); not their (A 1)–(A 6) or (A 26).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import InputError
from shootstab.models.chute.collocation_profile import SteadyProfile, clustering, profile, truncation_height
from shootstab.models.chute.collocation_wall import Trace, conditions
from shootstab.models.chute.steady_flow import Flow
from shootstab.spectral import chebyshev, inverse, qz
from shootstab.spectral.chebyshev import ChebyshevGrid
from shootstab.spectral.inverse import Refined
from shootstab.spectral.qz import DenseMatrix, Spectrum

Way = Callable[[int, complex], tuple[complex, int]]
FIELDS = 5  # exact: ν, u, v, w, T
PHASE = 1j  # exact: v̂ = PHASE · (the unknown)
CHUTE_TRUNCATION = 60  # chosen: the order that resolves the modes of the paper's flows


def window(
    flow: Flow, kx: float, ky: float, z_max: float | None = None, z_half: float | None = None, focus: float | None = None
) -> tuple[float, float, float]:
    """(z_m, z_h, β) of the grid for this flow and these wavenumbers; what is not given is chosen. β = 0: the paper's own map.

    Raises InputError for kx = ky = 0, where the far-field conditions are singular.
    """
    if not 0.0 < math.hypot(kx, ky) < math.inf:
        raise InputError(f"kx = {kx!r}, ky = {ky!r}: allowed are finite numbers that are not both 0")
    z_max = truncation_height(flow) if z_max is None else float(z_max)
    if not (0.0 < z_max < math.inf and (z_half is None or 0.0 < z_half < z_max) and (focus is None or 0.0 <= focus < math.inf)):
        raise InputError(f"z_half = {z_half!r}, z_max = {z_max!r}, focus = {focus!r}: allowed is 0 < z_half < z_max, focus >= 0")
    if z_half is None or focus is None:
        z_half, focus = clustering(flow, z_max, kx, ky, z_half, focus)
    return z_max, float(z_half), float(focus)


def assemble(
    flow: Flow, kx: float, ky: float, M: int, z_max: float | None = None, z_half: float | None = None, focus: float | None = None
) -> tuple[DenseMatrix, DenseMatrix]:
    """(A, B), each (5M + 5, 5M + 5), with A X = σ B X; rows scaled to largest element 1 in A; real for kx = 0.

    Raises InputError for kx = ky = 0, where the far-field conditions are singular, and for M < 4.
    """
    if M < 4:
        raise InputError(f"M = {M!r}: allowed is an integer of at least 4")
    points = chebyshev.malik(M, *window(flow, kx, ky, z_max, z_half, focus))
    A, B = _pencil(flow, profile(flow, points.z), points, kx, ky)
    scale = np.abs(A).max(axis=1)
    A, B = A / scale[:, None], B / scale[:, None]
    return (A.real.copy(), B.real.copy()) if kx == 0.0 else (A, B)


def _pencil(flow: Flow, s: SteadyProfile, points: ChebyshevGrid, kx: float, ky: float) -> tuple[DenseMatrix, DenseMatrix]:
    """The rows in the order mass, x-, y-, z-momentum, energy, M + 1 of each."""
    D, m = points.D, len(points.z)
    unit = np.eye(FIELDS * m, dtype=complex).reshape(FIELDS, m, FIELDS * m)
    n, u, v, w, T = unit[0], unit[1], PHASE * unit[2], unit[3], unit[4]
    ikx, iky = 1j * kx, 1j * ky

    def times(f: NDArray[np.float64], op: DenseMatrix) -> DenseMatrix:
        return np.asarray(f[:, None] * op)

    nu = times(s.nu, n)
    u_z, v_z, w_z, T_z = D @ u, D @ v, D @ w, D @ T
    nu_z = times(s.nu, D @ n) + times(s.nu_z, n)  # (ν0 n)′
    p, eta = times(s.a, nu) + times(s.b, T), times(s.c, nu) + times(s.d, T)
    K, K_star = times(s.e, nu) + times(s.h, T), times(s.e_star, nu) + times(s.h_star, T)
    gamma = times(s.l, nu) + times(s.m, T)

    # (2.4)–(2.6), perturbed about P0 = p0 I − η0 u0′ (x z + z x) and q0 = −K0 T0′ + K0* ν0′
    div = ikx * u + iky * v + w_z
    isotropic = p - times(s.xi - 2 / 3 * s.eta, div)
    P_xx, P_yy, P_zz = (isotropic - 2 * times(s.eta, rate) for rate in (ikx * u, iky * v, w_z))
    P_xy = -times(s.eta, iky * u + ikx * v)
    P_xz = -times(s.eta, u_z + ikx * w) - times(s.u_z, eta)
    P_yz = -times(s.eta, v_z + iky * w)
    q_z = -times(s.K, T_z) - times(s.T_z, K) + times(s.K_star, nu_z) + times(s.nu_z, K_star)
    sideways = (kx * kx + ky * ky) * (times(s.K, T) - times(s.K_star, nu))  # ik_x q_x + ik_y q_y
    heating = times(s.p, div) - 2 * times(s.eta * s.u_z, u_z + ikx * w) - times(s.u_z**2, eta)  # P : ∇u

    def carried(f: DenseMatrix) -> DenseMatrix:
        """u0 ∂f/∂x."""
        return times(s.u, ikx * f)

    A = np.empty((FIELDS, m, FIELDS * m), dtype=complex)
    A[0] = -carried(n) - div - times(s.log_nu_z, w)
    A[1] = flow.chute.tan_theta * nu - times(s.nu, carried(u) + times(s.u_z, w)) - ikx * P_xx - iky * P_xy - D @ P_xz
    A[2] = (-times(s.nu, carried(v)) - ikx * P_xy - iky * P_yy - D @ P_yz) / PHASE
    A[3] = -nu - times(s.nu, carried(w)) - ikx * P_xz - iky * P_yz - D @ P_zz
    A[4] = -1.5 * times(s.nu, carried(T) + times(s.T_z, w)) - heating - sideways - D @ q_z - gamma
    B = np.stack([n, times(s.nu, u), times(s.nu, v) / PHASE, times(s.nu, w), 1.5 * times(s.nu, T)])

    at = Trace(*(op[0] for op in (nu, u, v, T, u_z, v_z, w_z, ikx * u, iky * v, P_xz, P_yz, P_zz, q_z)))
    along, across, energy = conditions(flow.chute, s, at)
    A[1, 0], A[2, 0], A[3, 0], A[4, 0] = along, across / PHASE, w[0], energy

    # velocities e^{−𝔹z}α at z_m, 𝔹 = K I − s sᵀ/(7K), s = (ik_x, ik_y, −K): (2.20)–(2.21); temperature e^{−Kz}: (2.22)
    k = math.hypot(kx, ky)
    direction = np.array([ikx, iky, -k])
    decay = k * np.eye(3) - np.outer(direction, direction) / (7 * k)
    for row, f_z in enumerate((u_z, v_z, w_z)):
        A[1 + row, -1] = f_z[-1] + sum(c * f[-1] for c, f in zip(decay[row], (u, v, w), strict=True))
    A[2, -1] /= PHASE
    A[4, -1] = T_z[-1] + k * T[-1]
    B[1:, [0, -1]] = 0.0
    return A.reshape(FIELDS * m, -1), B.reshape(FIELDS * m, -1)


def spectrum(
    flow: Flow,
    kx: float,
    ky: float,
    M: int = CHUTE_TRUNCATION,
    filtered: bool = True,
    z_max: float | None = None,
    z_half: float | None = None,
    focus: float | None = None,
    cross_stream: bool = True,
) -> Spectrum:
    """The spectrum at truncation M by QZ; with filtered=False raw, by a single QZ.

    For k_y = 0 v̂ separates, and the two blocks are solved apart; cross_stream=False then leaves the modes of v̂ alone out.
    """
    chosen = window(flow, kx, ky, z_max, z_half, focus)
    blocks = [(0, 1, 2, 3, 4)] if ky != 0.0 else [(0, 1, 3, 4), (2,)] if cross_stream else [(0, 1, 3, 4)]

    def block(fields: tuple[int, ...]) -> Spectrum:
        def part(degree: int) -> tuple[DenseMatrix, DenseMatrix]:
            A, B = assemble(flow, kx, ky, degree, *chosen)
            keep = np.concatenate([np.arange(degree + 1) + f * (degree + 1) for f in fields])
            return A[np.ix_(keep, keep)], B[np.ix_(keep, keep)]

        return qz.spectrum(part, M, lambda vectors: chebyshev.coefficients(vectors.T.reshape(-1, len(fields), M + 1)), filtered)

    return qz.union([block(fields) for fields in blocks])


def refine(
    flow: Flow,
    kx: float,
    ky: float,
    guess: complex,
    M: int,
    z_max: float | None = None,
    z_half: float | None = None,
    focus: float | None = None,
) -> Refined:
    """The one eigenvalue next to guess at truncation M, by inverse iteration: a few LU factorizations, about a tenth of one QZ."""
    return inverse.refine(*assemble(flow, kx, ky, M, z_max, z_half, focus), guess)


@dataclass(frozen=True, eq=False)
class ChuteCollocation:
    """The twin of a chute problem: see problems.capabilities.Pseudospectral."""

    flow: Flow
    kx: float
    ky: float

    def spectrum(self, M: int, filtered: bool = True) -> Spectrum:
        """The spectrum at truncation M on the grid that suits the flow."""
        return spectrum(self.flow, self.kx, self.ky, M, filtered=filtered)

    @property
    def ways(self) -> Mapping[str, Way]:
        """QZ and inverse iteration, each on the grid that suits the flow, which is chosen anew, and on the paper's."""
        return {
            "qz": self._qz(None),
            "qz, paper's grid": self._qz(0.0),
            "inverse iteration": self._inverse(None),
            "inverse iteration, paper's grid": self._inverse(0.0),
        }

    def _qz(self, focus: float | None) -> Way:
        def nearest(M: int, guess: complex) -> tuple[complex, int]:
            clustering.cache_clear()
            return qz.nearest(spectrum(self.flow, self.kx, self.ky, M, filtered=False, focus=focus), guess), 1

        return nearest

    def _inverse(self, focus: float | None) -> Way:
        def nearest(M: int, guess: complex) -> tuple[complex, int]:
            clustering.cache_clear()
            found = refine(self.flow, self.kx, self.ky, guess, M, focus=focus)
            return found.sigma, found.iterations

        return nearest
