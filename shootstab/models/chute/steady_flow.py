"""The steady, fully developed flow (guide/theory.md 1.2): p′ = −ν, u′ = tanθ p/η, q′ = tanθ² p²/η − γ.

The state is regular at infinity: (ln ν, T, u, Q) with Q = q/ν, and three quadratures, ∫p dz, ∫νu dz and ∫ν dz from z to infinity.
The equations do not contain z, so the flow that decays for a given T_∞ is one curve: it is started at ν = 1e−18, where the
first terms of its expansion in ν are exact to rounding, and followed down to the base, where the energy condition holds.

What is kept are the Taylor polynomials of this integration: the flow at any z in one of their discs is a value of one of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import ConvergenceError, InputError, NoFlowError
from shootstab.kernels.taylor_pieces import along_path, from_pieces, integrate, terms_for
from shootstab.models.chute import constitutive as law
from shootstab.models.chute import descent
from shootstab.models.chute.balance import slip, slopes
from shootstab.models.chute.descent import DESCENT_SIZE
from shootstab.models.chute.parameters import Chute
from shootstab.models.chute.registry import BY_NAME

TOLERANCE = 1e-16  # chosen: what a polynomial leaves out, relative; below the rounding of doubles
BEGINNING = 1e-2  # chosen: ν0 where the integration begins, in the tolerance; what the first order in ν0 leaves out is below it
NU_TOP = BEGINNING * TOLERANCE
HEIGHT_NEWTONS = 30  # chosen: the most steps of Newton to a height, each of which doubles its digits
HEIGHT_KNOWN = 1e-12  # chosen: the last step to a height, in T_∞ and the height
MOST_PIECES = 500  # chosen: the most pieces of a flow; the paper's flows have some 60
HOTTEST = 1e5  # chosen: T in T_∞ beyond which it rises with depth without end, and z some 1e4 T_∞ down has lost four digits


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


@dataclass(frozen=True, eq=False, repr=False)
class Flow:
    """One steady flow, known at any z, real or complex.

    nodes (m,), descending from the top to the base at 0; pieces (m, 7, N), the Taylor coefficients of the state around each of them,
    good to the tolerance in discs of these radii (m,).
    """

    chute: Chute
    far_temperature: float
    nodes: NDArray[np.float64]
    pieces: NDArray[np.float64]
    radii: NDArray[np.float64]
    far_velocity: float
    tolerance: float = TOLERANCE
    asked_flux: float | None = None  # the mass flux by which the flow was chosen, if it was

    def __repr__(self) -> str:
        return f"Flow({self.chute!r}, far_temperature={self.far_temperature!r})"

    @property
    def states(self) -> NDArray[np.float64]:
        """States (m, 6) at the nodes."""
        return self.pieces[:, :6, 0]

    def states_at(self, z: Any, order: str = "any") -> NDArray[np.complex128]:
        """States (…, 6) at z: (ln ν, T, u, Q, ∫p, ∫νu).

        With order='path' the points are followed one after the other, from the first one on: far off the real axis this continues the
        flow analytically along the path they make.

        Raises InputError where z holds what is no finite number, ConvergenceError where the flow cannot be continued to a point.
        """
        z = np.asarray(z)
        flat = np.ravel(z).astype(np.complex128)
        if not np.isfinite(flat).all():
            raise InputError("z holds what is no finite number: allowed are heights above the base")
        out = np.empty((flat.size, DESCENT_SIZE), dtype=np.complex128)
        # nodes descend: the last node with nodes[i] ≥ Re z
        places = np.searchsorted(-self.nodes, -flat.real, side="right") - 1
        below = places >= 0
        if not below.all():
            out[~below] = self._beyond_top(flat[~below])
        inside = np.flatnonzero(below)
        out[inside] = self._by_pieces(flat[inside], places[inside], order)
        return out[:, :6].reshape(*z.shape, 6)

    def _by_pieces(self, z: NDArray[np.complex128], places: NDArray[np.int64], order: str) -> NDArray[np.complex128]:
        """States (p, 7) at points z (p,) below the top; places (p,) are those of the nodes next above Re z."""
        out, known = np.empty((z.size, DESCENT_SIZE), dtype=np.complex128), np.empty(z.size, dtype=np.bool_)
        from_pieces(self.nodes, self.pieces, self.radii, places, z, out, known)
        if known.all():
            return out
        equations = descent.equations(self.chute.radial_law[0], real=False), self.chute.numbers.astype(np.complex128)
        radii, terms = self.radii[places], self.pieces.shape[2]
        for p in range(1) if order == "path" else np.flatnonzero(~known).tolist():
            path = slice(p, None if order == "path" else p + 1)
            beginning = complex(max(z[p].real, self.nodes[places[p]] - radii[p]))
            start = self._by_pieces(np.array([beginning]), places[p : p + 1], order)[0]
            reached = along_path(*equations, radii[path], self.tolerance, terms, beginning, start, z[path], known[path], out[path])
            if reached < len(z[path]):
                z_lost = z[p + reached]
                why = "a singularity of the flow lies there, or a root in its equations changes its branch"
                raise ConvergenceError(f"the steady flow cannot be continued to z = {z_lost:.6g}: {why}")
        return out

    def at(self, z: Any) -> Fields:
        """The fields at heights z, real or complex, each of the shape of z, numbers at one height."""
        states: NDArray[Any] = self.states_at(z)
        states = states.real if np.isrealobj(z) else states
        nu, T, u, Q = np.exp(states[..., 0]), states[..., 1], states[..., 2], states[..., 3]
        f1 = law.reduced_pressure(nu, self.chute.ep, self.chute.radial_law)
        decay, T_z, u_z, _ = slopes(nu, T, Q, self.chute.ep, self.chute.tan_theta, self.chute.radial_law, math.pi)
        fields = nu, u, T, nu * f1 * T, nu * Q, nu * decay, u_z, T_z
        return Fields(*(np.asarray(field).item() if np.ndim(z) == 0 else field for field in fields))

    def _beyond_top(self, z: NDArray[np.complex128]) -> NDArray[np.complex128]:
        log_nu = self.pieces[0, 0, 0] - (z - self.nodes[0]) / self.far_temperature
        states = top_state(self.chute, self.far_temperature, log_nu)
        states[:, 2] += self.far_velocity
        states[:, 5] += self.far_velocity * states[:, 6]
        return states

    def height(self, nu: float) -> float:
        """The real z, nearest to the top, at which ν0 = nu; nu must lie below the value at the base and on the way up."""
        log_nu = self.states[:, 0]
        target = math.log(nu)
        if target <= log_nu[0]:
            return float(self.nodes[0] - (target - log_nu[0]) * self.far_temperature)
        i = int(np.argmax(log_nu > target)) - 1
        if i < 0:
            raise InputError(f"nu = {nu:g}: allowed is a volume fraction that the flow reaches, at most {math.exp(log_nu.max()):.6g}")
        z = float(self.nodes[i])
        for _ in range(HEIGHT_NEWTONS):
            y = self.states_at(z)
            rate = slopes(np.exp(y[0]), y[1], y[3], self.chute.ep, self.chute.tan_theta, self.chute.radial_law, math.pi)[0]
            step = (target - y[0].real) / rate.real
            z += step
            if abs(step) < HEIGHT_KNOWN * (self.far_temperature + abs(z)):
                return float(z)
        raise ConvergenceError(f"no height found at which nu = {nu:g}")

    @cached_property
    def rising(self) -> float:
        """The ν0 up to which ν0 rises on all the way down from infinity: that of the base, or of the densest place above it.

        Below it ν0 is a coordinate, as the series of the far field take it.
        """
        log_nu = self.states[:, 0]
        falls = np.flatnonzero(np.diff(log_nu) <= 0.0)
        return math.exp(log_nu[falls[0]] if falls.size else log_nu[-1])

    def inside(self, nu: float) -> float:
        """nu, or half of what ν0 rises to if that is less: a place for the far field to end that the flow does have."""
        return min(nu, self.rising / 2)

    @cached_property
    def base(self) -> dict[str, float]:
        """ν, T, u at the base."""
        y = self.states[-1]
        return {"nu": float(np.exp(y[0])), "T": float(y[1]), "u": float(y[2])}

    @cached_property
    def hold_up(self) -> float:
        """M0 = ∫ν dz of (2.8); it is the pressure at the base, since p′ = −ν."""
        nu, T = self.base["nu"], self.base["T"]
        return float(nu * law.reduced_pressure(nu, self.chute.ep, self.chute.radial_law) * T)

    @cached_property
    def mass_flux(self) -> float:
        """Q0 = ∫νu dz of (2.8)."""
        return float(self.states[-1, 5])

    @cached_property
    def centre_of_mass(self) -> float:
        """h0 = ∫νz dz / M0 of (2.8); the integral is ∫p dz, by parts."""
        return float(self.states[-1, 4]) / self.hold_up


def top_state(chute: Chute, far_temperature: float, log_nu: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """States (m, 7) at log_nu (m,), so high up that only the first terms of the expansion in ν count; u is taken relative to u_∞.

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
    out[:, 6] = nu * far_temperature
    return out


def descend(chute: Chute, far_temperature: float, tolerance: float = TOLERANCE) -> Flow:
    """The flow that decays to T_∞ = far_temperature, integrated with local errors below tolerance.

    Raises NoFlowError where the curve never meets the energy condition of the base, and for a smooth base.
    """
    BY_NAME["far_temperature"].check(far_temperature)
    if law.slip_coefficient(chute.r) == 0.0:
        raise NoFlowError(f"r = {chute.r:g}: no steady flow, for a smooth base bears no shear; r must be above 0")
    lists, terms = descent.equations(chute.radial_law[0]), terms_for(tolerance)
    nodes, pieces, radii = np.zeros(MOST_PIECES), np.empty((MOST_PIECES, DESCENT_SIZE, terms)), np.empty(MOST_PIECES)
    start = top_state(chute, far_temperature, np.array([math.log(BEGINNING * tolerance) + 0j]))[0].real.copy()
    limits = descent.limits(law.densest(chute.radial_law), HOTTEST * far_temperature)
    count, found = integrate(lists, chute.numbers, start, tolerance, limits, nodes, pieces, radii)
    nodes, pieces, radii = nodes[:count].copy(), pieces[:count].copy(), radii[:count].copy()
    if not found:
        raise NoFlowError(
            f"no steady flow with far_temperature = {far_temperature:g} and these parameters: the flow that decays "
            f"to it meets no base (followed down to nu = {math.exp(pieces[-1, 0, 0]):.3g})"
        )
    return _with_slip(chute, far_temperature, nodes - nodes[-1], pieces, radii, tolerance)


def _with_slip(
    chute: Chute,
    far_temperature: float,
    nodes: NDArray[np.float64],
    pieces: NDArray[np.float64],
    radii: NDArray[np.float64],
    tolerance: float,
) -> Flow:
    """Add the constant to u that the slip condition asks for, and carry it into ∫νu."""
    log_nu, T, u, Q = pieces[-1, :4, 0]
    nu = math.exp(log_nu)
    g0, _ = law.radial(nu, chute.radial_law)
    u_z = slopes(nu, T, Q, chute.ep, chute.tan_theta, chute.radial_law, math.pi)[2]
    far_velocity = float(slip(nu, T, u_z, g0, chute.r, chute.tan_theta, math.pi) - u)
    pieces[:, 2, 0] += far_velocity
    pieces[:, 5] += far_velocity * pieces[:, 6]
    return Flow(chute, far_temperature, nodes, pieces, radii, far_velocity, tolerance)
