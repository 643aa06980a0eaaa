"""The chute with s times the heat flux K* ∇ν, from the constitutive functions and the equations; s = 1 is the package's own chute.


Both the steady flow and the perturbations change with s. The flow is integrated here by DOP853, in place of Taylor series; the half-space
ends at z_m, where ν0 = TRUNCATED, with the conditions (2.20)-(2.22).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np

import shootstab as st
from paper.truncation import conditions
from shootstab.core.series import Series
from shootstab.models.chute import constitutive as law
from shootstab.models.chute.background import Background, fields
from shootstab.models.chute.balance import slip
from shootstab.models.chute.far_field import decay_matrix
from shootstab.models.chute.first_order_system import SIZE, pencil_entries
from shootstab.models.chute.parameters import Chute
from shootstab.models.chute.wall import wall_rows

TOP, TRUNCATED = 1e-16, 1e-13  # chosen: ν0 where the flow begins, and at z_m, of which (2.20)-(2.22) leave out what is of its order
TOLERANCE = 1e-13  # chosen: the local errors of the flow, relative
STEPS = 20  # chosen: steps of the secant rule at most, to the T_∞ of a mass flux
SAME_FLUX = 1e-11  # chosen: relative
LONGEST = 100.0  # chosen: heights in T_∞ on which a base is looked for


def slopes(chute: Chute, s: float, nu: Any, T: Any, Q: Any) -> tuple[Any, Any, Any, Any]:
    """(ν′/ν, T′, u′, Q′) from p′ = −ν, u′ = tanθ p/η, q′ = tanθ² p²/η − γ, q = −K T′ + s K* ν′, p = g1 T; Q = q/ν."""
    ep, radial, tan = chute.ep, chute.radial_law, chute.tan_theta
    g0, dg0 = law.radial(nu, radial)
    f1, g2, g3 = law.f1(nu, g0, ep), law.g2(nu, g0, ep, math.pi), law.g3(nu, g0, ep, math.pi)
    g4, f5 = s * law.g4(nu, g0, dg0, ep, math.pi), law.f5(g0, ep, math.pi)
    g1, dg1, root = nu * f1, 1 + 8 * ep * nu * g0 + 4 * ep * nu * nu * dg0, T**0.5
    # g1 T′ + T g1′ ν′ = −ν and g3 √T T′ − g4 T^(3/2) ν′ = −q, a system of two
    determinant = -(g1 * g4 * T + g3 * dg1 * T) * root
    T_z = (nu * g4 * T * root + T * dg1 * nu * Q) / determinant
    decay = (-g1 * Q + g3 * root) / determinant
    u_z = tan * g1 * root / g2
    return decay, T_z, u_z, nu * (tan * tan * f1 * f1 / g2 - f5) * T * root - Q * decay


@dataclass(frozen=True, eq=False)
class ScaledFlow:
    """The flow of s that decays to T_∞: its dense solution over z ≥ 0, and its mass flux."""

    chute: Chute
    s: float
    far_temperature: float
    solution: Any
    base: float
    far_velocity: float
    mass_flux: float

    @property
    def z_m(self) -> float:
        """The height of TRUNCATED; up there ν0 decays as e^{−z/T_∞}."""
        return -self.base - math.log(TRUNCATED / TOP) * self.far_temperature

    def background(self, z: Any) -> Background:
        """The fields with their derivatives at real heights z (p,)."""
        log_nu, T, u, Q = self.solution(np.real(z) + self.base)[:4]
        nu, u = np.exp(log_nu), u + self.far_velocity
        decay, T_z, u_z, Q_z = slopes(self.chute, self.s, nu, T, Q)
        pairs = (Series(pair) for pair in ((nu, nu * decay), (T, T_z), (u, u_z), (Q, Q_z)))
        nu2, T2, u2, Q2 = pairs
        decay2, T_z2, u_z2, _ = slopes(self.chute, self.s, nu2, T2, Q2)
        own = fields(self.chute, nu2, T2, u2, Q2, math.pi)
        scaled = {name: self.s * getattr(own, name) for name in ("K_star", "e_star", "h_star")}
        return replace(own, decay=decay2, nu_z=nu2 * decay2, T_z=T_z2, u_z=u_z2, **scaled)


def descended(chute: Chute, far_temperature: float, s: float) -> ScaledFlow:
    """The flow from its first order in ν0 at TOP down to the base, where q = tanθ p u − Δ p √T with the slip u. Raises NoFlowError."""
    from scipy.integrate import solve_ivp

    first = law.coefficients(0.0, chute.ep, chute.radial_law, math.pi)
    g2, g3, g4, f5 = (float(g[0]) for g in (first.g2, first.g3, first.g4, first.f5))
    T, tan = far_temperature, chute.tan_theta
    start = [
        math.log(TOP),
        T * (1 + s * g4 / g3 * TOP),
        -tan / g2 * T**1.5 * TOP,
        -(tan**2 / g2 - f5) * T**2.5 * TOP / 2,
        -tan / g2 * T**2.5 * TOP**2 / 2,
        TOP * T,
    ]

    def rate(z: float, y: Any) -> list[float]:
        nu = math.exp(y[0])
        decay, T_z, u_z, Q_z = slopes(chute, s, nu, y[1], y[3])
        return [decay, T_z, u_z, Q_z, -nu * y[2], -nu]

    def energy(z: float, y: Any) -> float:
        nu, T, _, Q = np.exp(y[0]), *y[1:4]
        g0, _ = law.radial(nu, chute.radial_law)
        u = slip(nu, T, slopes(chute, s, nu, T, Q)[2], g0, chute.r, tan, math.pi)
        delta = law.wall_dissipation(chute.r, chute.e_w, math.pi)
        return float(Q - law.f1(nu, g0, chute.ep) * T * (tan * u - delta * T**0.5))

    energy.terminal = True  # type: ignore[attr-defined]
    options = {"rtol": TOLERANCE, "atol": 0.0, "dense_output": True, "events": energy}
    found = solve_ivp(rate, (0.0, -LONGEST * T), start, "DOP853", **options)
    if not found.t_events[0].size:
        raise st.NoFlowError(f"K* times {s:g}, T_∞ = {T:g}: no base within {LONGEST:g} T_∞")
    log_nu, T0, u, Q, flux, hold_up = found.y_events[0][0]
    nu = math.exp(log_nu)
    g0, _ = law.radial(nu, chute.radial_law)
    far = float(slip(nu, T0, slopes(chute, s, nu, T0, Q)[2], g0, chute.r, tan, math.pi) - u)
    return ScaledFlow(chute, s, T, found.sol, float(found.t_events[0][0]), far, float(flux + far * hold_up))


@cache
def with_flux(chute: Chute, mass_flux: float, near: float, s: float) -> ScaledFlow:
    """The flow of this mass flux next to T_∞ = near, by the secant rule in ln T_∞."""
    a, b = near, near * 1.001
    A = descended(chute, a, s).mass_flux - mass_flux
    for _ in range(STEPS):
        flow = descended(chute, b, s)
        B = flow.mass_flux - mass_flux
        if abs(B) <= SAME_FLUX * mass_flux:
            return flow
        step = -B * math.log(b / a) / (B - A)
        a, A, b = b, B, b * math.exp(step)
    raise st.ConvergenceError(f"K* times {s:g}: no flow of Q0 = {mass_flux:g} found next to T_∞ = {near:g}")


def scaled(flow: ScaledFlow, kx: float, ky: float, z_m: float) -> Any:
    """Perturbations of that flow on [0, z_m]."""

    def pencil(z: Any) -> tuple[Any, ...]:
        z = np.atleast_1d(z)
        out = np.zeros((4, z.size, SIZE, SIZE), dtype=complex)
        for matrix, entries in zip(out, pencil_entries(flow.background(z), flow.chute.tan_theta, kx, ky), strict=True):
            for place, value in entries.items():
                matrix[:, *place] = value
        return tuple(out)

    def at(z: float) -> Background:
        bg = flow.background(np.array([z]))
        return Background(**{name: Series([float(F[0]) for F in getattr(bg, name).coefficients]) for name in bg.__dataclass_fields__})

    ends = st.Wall(0.0, *wall_rows(flow.chute, at(0.0), kx, ky, math.pi)), st.Wall(z_m, *conditions(at(z_m), kx, ky, decay_matrix(kx, ky)))
    return st.problem(SIZE, pencil, *ends, continuum=False, vectorized=True)
