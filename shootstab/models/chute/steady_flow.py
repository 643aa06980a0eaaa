"""The steady, fully developed flow (guide/theory.md 1.2): p′ = −ν, u′ = tanθ p/η, q′ = tanθ² p²/η − γ.

The state is regular at infinity: (ln ν, T, u, Q) with Q = q/ν, and two quadratures, ∫p dz and ∫νu dz from z to infinity.
The equations do not contain z, so the flow that decays for a given T_∞ is one curve: it is started at ν = 1e−18, where the
first terms of its expansion in ν are exact to rounding, and followed down to the base, where the energy condition holds.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import ConvergenceError, InputError, NoFlowError
from shootstab.kernels.tableau import STAGES
from shootstab.models.chute import constitutive as law
from shootstab.models.chute import descent
from shootstab.models.chute.balance import slip, slopes
from shootstab.models.chute.descent import DESCENT_SIZE
from shootstab.models.chute.parameters import Chute
from shootstab.models.chute.registry import BY_NAME

NU_TOP = 1e-18  # chosen: ν0 where the integration begins; what the first order in ν0 leaves out is below rounding there
TOLERANCE = 2e-14  # chosen: local error of the best flow, some hundred units of rounding, below which steps are lost to noise


@dataclass(frozen=True)
class Fields:
    """ν0, u0, T0, the pressure p0, the flux q0 of fluctuation energy, and the slopes ν0′, u0′, T0′; arrays of one shape."""

    nu: Any
    u: Any
    T: Any
    p: Any
    q: Any
    nu_z: Any
    u_z: Any
    T_z: Any


@dataclass(frozen=True, eq=False)
class Flow:
    """One steady flow, known at any z, real or complex.

    nodes (m,), descending from the top to the base at 0, and states (m, 6) there.
    """

    chute: Chute
    far_temperature: float
    nodes: NDArray[np.float64]
    states: NDArray[np.complex128]
    far_velocity: float
    tolerance: float = TOLERANCE
    asked_flux: float | None = None  # the mass flux by which the flow was chosen, if it was

    def states_at(self, z: Any, order: str = "any") -> NDArray[np.complex128]:
        """States (…, 6) at z. With order='path' the points are followed one after the other, from the first one on:
        off the real axis this continues the flow analytically along the path they make.
        """
        z = np.asarray(z)
        flat = np.ravel(z).astype(np.complex128)
        out = np.empty((flat.size, DESCENT_SIZE), dtype=np.complex128)
        if order == "path":
            self._continue(flat, out)
        else:
            ranks = np.argsort(-flat.real)
            sorted_out = np.empty_like(out)
            self._near_nodes(flat[ranks], sorted_out)
            out[ranks] = sorted_out
        return out.reshape(*z.shape, DESCENT_SIZE)

    def at(self, z: Any) -> Fields:
        """The fields at heights z, real or complex, each of the shape of z."""
        states: NDArray[Any] = self.states_at(z)
        states = states.real if np.isrealobj(z) else states
        nu, T, u, Q = np.exp(states[..., 0]), states[..., 1], states[..., 2], states[..., 3]
        g0, _ = law.radial(nu, self.chute.radial_law)
        decay, T_z, u_z, _ = slopes(nu, T, Q, self.chute.ep, self.chute.tan_theta, self.chute.radial_law, math.pi)
        return Fields(nu, u, T, nu * law.f1(nu, g0, self.chute.ep) * T, nu * Q, nu * decay, u_z, T_z)

    def _continue(self, z: NDArray[np.complex128], out: NDArray[np.complex128]) -> None:
        # what comes before the top is known without being followed
        inside = np.flatnonzero((z.real <= self.nodes[0]) | (z.imag != 0.0))
        begin = min(int(inside[0]) if inside.size else z.size, z.size - 1)
        self._near_nodes(z[: begin + 1], out[: begin + 1])
        reached = begin + descent.follow(out[begin].copy(), z[begin], z[begin:], self.chute.numbers, self.tolerance, out[begin:])
        if reached < z.size:
            raise ConvergenceError(f"the steady flow cannot be continued to z = {z[reached]:.6g}: a singularity of the flow lies there")

    def _near_nodes(self, z: NDArray[np.complex128], out: NDArray[np.complex128]) -> None:
        """Each point by a step of its own from the nearest node above it; beyond the top, by the expansion in ν."""
        above = z.real > self.nodes[0]
        if above.any():
            out[above] = self._beyond_top(z[above])
        inside = np.flatnonzero(~above)
        # nodes descend: the last node with nodes[i] ≥ Re z
        place = np.clip(np.searchsorted(-self.nodes, -z[inside].real, side="right") - 1, 0, len(self.nodes) - 1)
        points, found = z[inside], np.empty((inside.size, DESCENT_SIZE), dtype=np.complex128)
        reached = descent.from_nodes(self.nodes, self.states, place, points, self.chute.numbers, self.tolerance, found)
        if reached < inside.size:
            raise ConvergenceError(f"the steady flow cannot be continued to z = {points[reached]:.6g}: a singularity of the flow lies near")
        out[inside] = found

    def _beyond_top(self, z: NDArray[np.complex128]) -> NDArray[np.complex128]:
        log_nu = math.log(NU_TOP) - (z - self.nodes[0]) / self.far_temperature
        states = top_state(self.chute, self.far_temperature, log_nu)
        states[:, 2] += self.far_velocity
        states[:, 5] += self.far_velocity * np.exp(log_nu) * self.far_temperature
        return states

    def height(self, nu: float) -> float:
        """The real z, nearest to the top, at which ν0 = nu; nu must lie below the value at the base and on the way up."""
        log_nu = self.states[:, 0].real
        target = math.log(nu)
        if target <= log_nu[0]:
            return float(self.nodes[0] - (target - log_nu[0]) * self.far_temperature)
        i = int(np.argmax(log_nu > target)) - 1
        if i < 0:
            raise InputError(f"nu = {nu:g}: the flow does not reach this volume fraction")
        z = float(self.nodes[i])
        for _ in range(30):
            y = self.states_at(z)
            rate = slopes(np.exp(y[0]), y[1], y[3], self.chute.ep, self.chute.tan_theta, self.chute.radial_law, math.pi)[0]
            step = (target - y[0].real) / rate.real
            z += step
            if abs(step) < 1e-12 * (self.far_temperature + abs(z)):
                return float(z)
        raise ConvergenceError(f"no height found at which nu = {nu:g}")

    @cached_property
    def rising(self) -> float:
        """The ν0 up to which ν0 rises on all the way down from infinity: that of the base, or of the densest place above it.

        Below it ν0 is a coordinate, as the series of the far field take it.
        """
        log_nu = self.states[:, 0].real
        falls = np.flatnonzero(np.diff(log_nu) <= 0.0)
        return math.exp(log_nu[falls[0]] if falls.size else log_nu[-1])

    def inside(self, nu: float) -> float:
        """nu, or half of what ν0 rises to if that is less: a place for the far field to end that the flow does have."""
        return min(nu, self.rising / 2)

    @cached_property
    def base(self) -> dict[str, float]:
        """ν, T, u at the base."""
        y = self.states[-1].real
        return {"nu": float(np.exp(y[0])), "T": float(y[1]), "u": float(y[2])}

    @cached_property
    def hold_up(self) -> float:
        """M0 = ∫ν dz of (2.8); it is the pressure at the base, since p′ = −ν."""
        nu, T = self.base["nu"], self.base["T"]
        g0, _ = law.radial(nu, self.chute.radial_law)
        return float(nu * law.f1(nu, g0, self.chute.ep) * T)

    @cached_property
    def mass_flux(self) -> float:
        """Q0 = ∫νu dz of (2.8)."""
        return float(self.states[-1, 5].real)

    @cached_property
    def centre_of_mass(self) -> float:
        """h0 = ∫νz dz / M0 of (2.8); the integral is ∫p dz, by parts."""
        return float(self.states[-1, 4].real) / self.hold_up


def top_state(chute: Chute, far_temperature: float, log_nu: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """States (m, 6) so high up that only the first terms of the expansion in ν count; u is taken relative to u_∞.

    T = T_∞ (1 + (g4/g3) ν), Q = −(tanθ²/g2 − f5) T_∞^{5/2} ν / 2, u − u_∞ = −(tanθ/g2) T_∞^{3/2} ν.
    """
    nu = np.exp(log_nu)
    c = law.coefficients(0.0, chute.ep, chute.radial_law, math.pi)
    g2, g3, g4, f5 = (float(g[0]) for g in (c.g2, c.g3, c.g4, c.f5))
    out = np.empty((len(nu), DESCENT_SIZE), dtype=np.complex128)
    out[:, 0] = log_nu
    out[:, 1] = far_temperature * (1 + g4 / g3 * nu)
    out[:, 2] = -chute.tan_theta / g2 * far_temperature**1.5 * nu
    out[:, 3] = -(chute.tan_theta**2 / g2 - f5) * far_temperature**2.5 * nu / 2
    out[:, 4] = nu * far_temperature**2
    out[:, 5] = nu * out[:, 2] * far_temperature / 2
    return out


def descend(chute: Chute, far_temperature: float, tolerance: float = TOLERANCE) -> Flow:
    """The flow that decays to T_∞ = far_temperature, integrated with local errors below tolerance.

    Raises NoFlowError where the curve never meets the energy condition of the base, and for a smooth base.
    """
    BY_NAME["far_temperature"].check(far_temperature)
    if law.slip_coefficient(chute.r) == 0.0:
        raise NoFlowError(f"r = {chute.r:g}: no steady flow, for a smooth base bears no shear; r must be above 0")
    z = np.zeros(6000)
    states = np.empty((z.size, DESCENT_SIZE), dtype=np.complex128)
    y0 = top_state(chute, far_temperature, np.array([math.log(NU_TOP) + 0j]))[0]
    count, found = descent.descend(y0, chute.numbers, far_temperature, tolerance, z, states)
    if not found:
        nu = math.exp(states[count, 0].real)
        raise NoFlowError(
            f"no steady flow with far_temperature = {far_temperature:g} and these parameters: the flow that decays "
            f"to it meets no base (followed down to nu = {nu:.3g})"
        )
    z, states = z[: count + 1], states[: count + 1]
    place_base(chute, z, states)
    return _with_slip(chute, far_temperature, z - z[-1], states, tolerance)


def place_base(chute: Chute, z: NDArray[np.float64], states: NDArray[np.complex128]) -> None:
    """Shorten the last step of z (N,) and states (N, 6) in place, so that it ends where the energy defect vanishes."""
    from scipy.optimize import brentq

    stages, trial = np.empty((STAGES, DESCENT_SIZE), dtype=np.complex128), np.empty(DESCENT_SIZE, dtype=np.complex128)
    start, length = states[-2], z[-1] - z[-2]

    def defect(fraction: float) -> float:
        descent.step(start, fraction * length, chute.numbers, stages, trial)
        return float(descent.energy_defect(trial, chute.numbers))

    fraction = brentq(defect, 0.0, 1.0, xtol=1e-16, rtol=1e-15)
    defect(fraction)
    z[-1] = z[-2] + fraction * length
    states[-1] = trial


def _with_slip(chute: Chute, far_temperature: float, z: NDArray[np.float64], states: NDArray[np.complex128], tolerance: float) -> Flow:
    """Add the constant to u that the slip condition asks for, and carry it into ∫νu."""
    log_nu, T, u, Q = states[-1, :4].real
    nu = math.exp(log_nu)
    g0, _ = law.radial(nu, chute.radial_law)
    u_z = slopes(nu, T, Q, chute.ep, chute.tan_theta, chute.radial_law, math.pi)[2]
    far_velocity = slip(nu, T, u_z, g0, chute.r, chute.tan_theta, math.pi) - u
    states = states.copy()
    states[:, 2] += far_velocity
    # ∫_z^∞ ν dz = p
    nus = np.exp(states[:, 0])
    g0s, _ = law.radial(nus, chute.radial_law)
    states[:, 5] += far_velocity * nus * law.f1(nus, g0s, chute.ep) * states[:, 1]
    return Flow(chute, far_temperature, z, states, float(far_velocity), tolerance)
