"""The steady, fully developed flow (DESIGN.md 1.2): p′ = −ν, u′ = tanθ p/η, q′ = tanθ² p²/η − γ.

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
from numba import njit
from numba.extending import register_jitable
from numpy.typing import NDArray

from shootstab.kernels.tableau import E3, E5, STAGES, A, B
from shootstab.problems.chute import constitutive as law
from shootstab.problems.chute.parameters import Chute
from shootstab.vocabulary.errors import ConvergenceError, InputError, NoFlowError

NU_TOP = 1e-18
TOLERANCE = 2e-14
SIZE = 6  # ln ν, T, u, Q, ∫p, ∫νu


@register_jitable
def slopes(nu: Any, T: Any, Q: Any, ep: Any, tan_theta: Any, nu_max: Any, model: int, pi: Any) -> Any:
    """(ν′/ν, T′, u′, Q′) at a state, for numbers, arrays and series alike; Q = q/ν.

    T′ and ν′ follow from p = g1 T with p′ = −ν and from q = −K T′ + K* ν′.
    """
    g0, dg0 = law.radial(nu, nu_max, model)
    f1, g2, g3 = law.f1(nu, g0, ep), law.g2(nu, g0, ep, pi), law.g3(nu, g0, ep, pi)
    g4, f5 = law.g4(nu, g0, dg0, ep, pi), law.f5(g0, ep, pi)
    g1, dg1 = nu * f1, 1 + 8 * ep * nu * g0 + 4 * ep * nu * nu * dg0
    root_T = T**0.5
    mixed = dg1 * g3 + g1 * g4  # (a K + b K*)/T^(3/2)
    log_nu_z = (g1 * Q - g3 * root_T) / (mixed * T * root_T)
    T_z = -nu * (dg1 * Q + g4 * root_T) / (mixed * root_T)
    u_z = tan_theta * g1 * root_T / g2
    Q_z = nu * T * root_T * (tan_theta * tan_theta * f1 * f1 / g2 - f5) - Q * log_nu_z
    return log_nu_z, T_z, u_z, Q_z


@register_jitable
def slip(nu: Any, T: Any, u_z: Any, g0: Any, r: Any, tan_theta: Any, pi: Any) -> Any:
    """The velocity that the base allows: tanθ = T^(−1/2) √(2/π) (κu − (κ − ½A r²)u′)."""
    kappa = law.slip_coefficient(r)
    return (tan_theta * (T * pi / 2) ** 0.5 + (kappa - law.wall_shear(nu, g0, pi) * r * r / 2) * u_z) / kappa


@njit(cache=True, error_model="numpy")
def _rhs(y, chute, out):  # type: ignore[no-untyped-def]
    if not (y[0].real < 50.0 and 1e-100 < abs(y[1]) < 1e100):  # a wild stage: complex division by an underflowed zero would raise
        out[:] = np.nan
        return
    ep, tan_theta, nu_max, model = chute[0], chute[1], chute[2], int(chute[3])
    nu = np.exp(y[0])
    out[0], out[1], out[2], out[3] = slopes(nu, y[1], y[3], ep, tan_theta, nu_max, model, math.pi)
    g0, _ = law.radial(nu, nu_max, model)
    out[4] = -nu * law.f1(nu, g0, ep) * y[1]
    out[5] = -nu * y[2]


@njit(cache=True, error_model="numpy")
def _energy_defect(y, chute):  # type: ignore[no-untyped-def]
    """(q − tanθ p u_slip + Δ p √T)/p, zero at the base."""
    ep, tan_theta, nu_max, model, r, delta = chute[0], chute[1], chute[2], int(chute[3]), chute[4], chute[5]
    nu, T, Q = np.exp(y[0]), y[1], y[3]
    g0, _ = law.radial(nu, nu_max, model)
    _, _, u_z, _ = slopes(nu, T, Q, ep, tan_theta, nu_max, model, math.pi)
    defect = Q / (law.f1(nu, g0, ep) * T) - tan_theta * slip(nu, T, u_z, g0, r, tan_theta, math.pi) + delta * T**0.5
    return defect.real


@njit(cache=True, error_model="numpy")
def _step(y, h, chute, stages, out):  # type: ignore[no-untyped-def]
    """One Runge–Kutta step of length h (complex); returns its error relative to the tolerance."""
    for i in range(STAGES):
        for c in range(SIZE):
            total = 0j
            for j in range(i):
                total += A[i, j] * stages[j, c]
            out[c] = y[c] + h * total
        _rhs(out, chute, stages[i])
    worst = 0.0
    for c in range(SIZE):
        total, error5, error3 = 0j, 0j, 0j
        for j in range(STAGES):
            total += B[j] * stages[j, c]
            error5 += E5[j] * stages[j, c]
            error3 += E3[j] * stages[j, c]
        out[c] = y[c] + h * total
        if c == 0:
            scale = 1.0
        elif c == 2:
            scale = abs(y[2]) + abs(y[1]) ** 0.5
        elif c == 3:
            scale = abs(y[3]) + 1e-2 * abs(np.exp(y[0])) * abs(y[1]) ** 0.5
        else:
            scale = abs(y[c])
        e5, e3 = abs(error5) ** 2, abs(error3) ** 2
        error = 0.0 if e5 == 0.0 else abs(h) * e5 / np.sqrt(e5 + 0.01 * e3) / scale
        if not error <= worst:  # a NaN must win
            worst = error
    return worst


@njit(cache=True, error_model="numpy")
def _descend(y0, chute, far_temperature, tolerance, z, states):  # type: ignore[no-untyped-def]
    """Follow the flow down from z = 0 until the base lies inside a step. Returns (steps taken, found)."""
    states[0] = y0
    stages = np.empty((STAGES, SIZE), dtype=np.complex128)
    trial = np.empty(SIZE, dtype=np.complex128)
    h = -0.3 * far_temperature
    count = 0
    side = _energy_defect(y0, chute) > 0.0
    while count < len(z) - 1:
        error = _step(states[count], h, chute, stages, trial) / tolerance
        physical = trial[1].real > 0.0 and np.exp(trial[0].real) < 0.9999 * chute[2]
        if error <= 1.0 and physical:
            z[count + 1] = z[count] + h
            states[count + 1] = trial
            count += 1
            if (_energy_defect(trial, chute) > 0.0) != side:
                return count, True
        if not physical and abs(h) < 1e-9 * far_temperature:
            return count, False
        grow = 5.0 if error == 0.0 else 0.9 * error ** (-0.125)
        h *= min(5.0, max(0.2, grow)) if error == error and physical else 0.2
        if abs(h) < 1e-14 * far_temperature:
            return count, False
    return count, False


@njit(cache=True, error_model="numpy")
def _follow(y, start, nodes, chute, tolerance, out):  # type: ignore[no-untyped-def]
    """Carry the state y from the point start through the nodes, in their order, by steps as short as the tolerance asks.

    Returns the number of nodes reached.
    """
    stages = np.empty((STAGES, SIZE), dtype=np.complex128)
    trial = np.empty(SIZE, dtype=np.complex128)
    current = y.copy()
    here = start
    longest = np.inf
    for k in range(len(nodes)):
        tries = 0
        while here != nodes[k]:
            left = nodes[k] - here
            last = abs(left) <= longest
            h = left if last else left / abs(left) * longest
            error = _step(current, h, chute, stages, trial) / tolerance
            tries += 1
            if error <= 1.0:
                current[:] = trial
                here = nodes[k] if last else here + h
                longest = max(longest, abs(h) * min(5.0, 0.9 * max(error, 1e-10) ** (-0.125)))
            else:
                longest = abs(h) * (max(0.2, 0.9 * error ** (-0.125)) if error == error else 0.2)
            if tries > 10000:
                return k
        out[k] = current
    return len(nodes)


@njit(cache=True, error_model="numpy")
def _from_nodes(nodes, states, place, z, chute, tolerance, out):  # type: ignore[no-untyped-def]
    """The state at each z, from the node at its place. Returns the number of points reached."""
    for k in range(len(z)):
        i = place[k]
        if _follow(states[i], complex(nodes[i]), z[k : k + 1], chute, tolerance, out[k : k + 1]) < 1:
            return k
    return len(z)


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

    def at(self, z: Any, order: str = "any") -> NDArray[np.complex128]:
        """States (…, 6) at z. With order='path' the points are followed one after the other, from the first one on:
        off the real axis this continues the flow analytically along the path they make.
        """
        z = np.asarray(z)
        flat = np.ravel(z).astype(np.complex128)
        out = np.empty((flat.size, SIZE), dtype=np.complex128)
        if order == "path":
            self._continue(flat, out)
        else:
            ranks = np.argsort(-flat.real)
            sorted_out = np.empty_like(out)
            self._near_nodes(flat[ranks], sorted_out)
            out[ranks] = sorted_out
        return out.reshape(*z.shape, SIZE)

    def _continue(self, z: NDArray[np.complex128], out: NDArray[np.complex128]) -> None:
        first = z[:1]
        self._near_nodes(first, out[:1])
        reached = _follow(out[0].copy(), first[0], z, self.chute.numbers, self.tolerance, out)
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
        points, found = z[inside], np.empty((inside.size, SIZE), dtype=np.complex128)
        reached = _from_nodes(self.nodes, self.states, place, points, self.chute.numbers, self.tolerance, found)
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
            y = self.at(z)
            rate = slopes(np.exp(y[0]), y[1], y[3], self.chute.ep, self.chute.tan_theta, self.chute.nu_max, self.chute.model, math.pi)[0]
            step = (target - y[0].real) / rate.real
            z += step
            if abs(step) < 1e-12 * (self.far_temperature + abs(z)):
                return float(z)
        raise ConvergenceError(f"no height found at which nu = {nu:g}")

    @cached_property
    def base(self) -> dict[str, float]:
        """ν, T, u at the base."""
        y = self.states[-1].real
        return {"nu": float(np.exp(y[0])), "T": float(y[1]), "u": float(y[2])}

    @cached_property
    def hold_up(self) -> float:
        """M0 = ∫ν dz of (2.8); it is the pressure at the base, since p′ = −ν."""
        nu, T = self.base["nu"], self.base["T"]
        g0, _ = law.radial(nu, self.chute.nu_max, self.chute.model)
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
    c = law.coefficients(0.0, chute.ep, chute.nu_max, chute.model, math.pi)
    g2, g3, g4, f5 = (float(g[0]) for g in (c.g2, c.g3, c.g4, c.f5))
    out = np.empty((len(nu), SIZE), dtype=np.complex128)
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
    chute.require_temperature(far_temperature)
    if law.slip_coefficient(chute.r) == 0.0:
        raise NoFlowError(f"r = {chute.r:g}: no steady flow, for a smooth base bears no shear; r must be above 0")
    z = np.zeros(6000)
    states = np.empty((z.size, SIZE), dtype=np.complex128)
    y0 = top_state(chute, far_temperature, np.array([math.log(NU_TOP) + 0j]))[0]
    count, found = _descend(y0, chute.numbers, far_temperature, tolerance, z, states)
    if not found:
        nu = math.exp(states[count, 0].real)
        raise NoFlowError(
            f"no steady flow with far_temperature = {far_temperature:g} and these parameters: the flow that decays "
            f"to it meets no base (followed down to nu = {nu:.3g})"
        )
    z, states = z[: count + 1], states[: count + 1]
    _place_base(chute, z, states)
    return _with_slip(chute, far_temperature, z - z[-1], states, tolerance)


def _place_base(chute: Chute, z: NDArray[np.float64], states: NDArray[np.complex128]) -> None:
    """Shorten the last step so that it ends where the energy defect vanishes."""
    from scipy.optimize import brentq

    stages, trial = np.empty((STAGES, SIZE), dtype=np.complex128), np.empty(SIZE, dtype=np.complex128)
    start, length = states[-2], z[-1] - z[-2]

    def defect(fraction: float) -> float:
        _step(start, fraction * length, chute.numbers, stages, trial)
        return float(_energy_defect(trial, chute.numbers))

    fraction = brentq(defect, 0.0, 1.0, xtol=1e-16, rtol=1e-15)
    defect(fraction)
    z[-1] = z[-2] + fraction * length
    states[-1] = trial


def _with_slip(chute: Chute, far_temperature: float, z: NDArray[np.float64], states: NDArray[np.complex128], tolerance: float) -> Flow:
    """Add the constant to u that the slip condition asks for, and carry it into ∫νu."""
    log_nu, T, u, Q = states[-1, :4].real
    nu = math.exp(log_nu)
    g0, _ = law.radial(nu, chute.nu_max, chute.model)
    u_z = slopes(nu, T, Q, chute.ep, chute.tan_theta, chute.nu_max, chute.model, math.pi)[2]
    far_velocity = slip(nu, T, u_z, g0, chute.r, chute.tan_theta, math.pi) - u
    states = states.copy()
    states[:, 2] += far_velocity
    # ∫_z^∞ ν dz = p
    nus = np.exp(states[:, 0])
    g0s, _ = law.radial(nus, chute.nu_max, chute.model)
    states[:, 5] += far_velocity * nus * law.f1(nus, g0s, chute.ep) * states[:, 1]
    return Flow(chute, far_temperature, z, states, float(far_velocity), tolerance)
