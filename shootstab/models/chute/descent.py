"""Compiled integration of the steady flow: a Runge–Kutta pair of order 8 on the state (ln ν, T, u, Q, ∫p, ∫νu), along real or complex z."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from shootstab.kernels.step_control import local_error, step_factor
from shootstab.kernels.tableau import E3, E5, STAGES, A, B
from shootstab.models.chute import constitutive as law
from shootstab.models.chute.balance import slip, slopes

DESCENT_SIZE = 6  # exact: ln ν, T, u, Q, ∫p, ∫νu
FILLED = 0.9999  # of the densest packing: a flow is not followed beyond it (chosen: g0 is above 1e6 there, and steps are lost to it)

# chute, here: the array Chute.numbers, (η_p, tanθ, r, Δ, *radial_law)


@njit(cache=True, error_model="numpy")
def rhs(y, chute, out):  # type: ignore[no-untyped-def]
    if not (y[0].real < 50.0 and 1e-100 < abs(y[1]) < 1e100):  # a wild stage: complex division by an underflowed zero would raise
        out[:] = np.nan
        return
    ep, tan_theta, radial_law = chute[0], chute[1], chute[4:]
    nu = np.exp(y[0])
    out[0], out[1], out[2], out[3] = slopes(nu, y[1], y[3], ep, tan_theta, radial_law, math.pi)
    g0, _ = law.radial(nu, radial_law)
    out[4] = -nu * law.f1(nu, g0, ep) * y[1]
    out[5] = -nu * y[2]


@njit(cache=True, error_model="numpy")
def energy_defect(y, chute):  # type: ignore[no-untyped-def]
    """(q − tanθ p u_slip + Δ p √T)/p, zero at the base."""
    ep, tan_theta, r, delta, radial_law = chute[0], chute[1], chute[2], chute[3], chute[4:]
    nu, T, Q = np.exp(y[0]), y[1], y[3]
    g0, _ = law.radial(nu, radial_law)
    _, _, u_z, _ = slopes(nu, T, Q, ep, tan_theta, radial_law, math.pi)
    defect = Q / (law.f1(nu, g0, ep) * T) - tan_theta * slip(nu, T, u_z, g0, r, tan_theta, math.pi) + delta * T**0.5
    return defect.real


@njit(cache=True, error_model="numpy")
def step(y, h, chute, stages, out):  # type: ignore[no-untyped-def]
    """One Runge–Kutta step of length h (complex); returns its error relative to the tolerance."""
    for i in range(STAGES):
        for c in range(DESCENT_SIZE):
            total = 0j
            for j in range(i):
                total += A[i, j] * stages[j, c]
            out[c] = y[c] + h * total
        rhs(out, chute, stages[i])
    worst = 0.0
    for c in range(DESCENT_SIZE):
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
        error = abs(h) * local_error(e5, e3) / scale
        if worst == worst and not error <= worst:  # a NaN must win
            worst = error
    return worst


@njit(cache=True, error_model="numpy")
def descend(y0, chute, far_temperature, tolerance, z, states):  # type: ignore[no-untyped-def]
    """Follow the flow down from z = 0 until the base lies inside a step. Returns (steps taken, found)."""
    states[0] = y0
    stages = np.empty((STAGES, DESCENT_SIZE), dtype=np.complex128)
    trial = np.empty(DESCENT_SIZE, dtype=np.complex128)
    h = -0.3 * far_temperature
    count = 0
    side = energy_defect(y0, chute) > 0.0
    while count < len(z) - 1:
        error = step(states[count], h, chute, stages, trial) / tolerance
        physical = trial[1].real > 0.0 and np.exp(trial[0].real) < FILLED * law.densest(chute[4:])
        if error <= 1.0 and physical:
            z[count + 1] = z[count] + h
            states[count + 1] = trial
            count += 1
            if (energy_defect(trial, chute) > 0.0) != side:
                return count, True
        if not physical and abs(h) < 1e-9 * far_temperature:
            return count, False
        grow = 5.0 if error == 0.0 else step_factor(error)
        h *= min(5.0, max(0.2, grow)) if error == error and physical else 0.2
        if abs(h) < 1e-14 * far_temperature:
            return count, False
    return count, False


@njit(cache=True, error_model="numpy")
def follow(y, start, nodes, chute, tolerance, out):  # type: ignore[no-untyped-def]
    """Carry the state y from the point start through the nodes, in their order, by steps as short as the tolerance asks.

    Returns the number of nodes reached.
    """
    stages = np.empty((STAGES, DESCENT_SIZE), dtype=np.complex128)
    trial = np.empty(DESCENT_SIZE, dtype=np.complex128)
    current = y.copy()
    here = start
    longest = np.inf
    for k in range(len(nodes)):
        tries = 0
        while here != nodes[k]:
            left = nodes[k] - here
            last = abs(left) <= longest
            h = left if last else left / abs(left) * longest
            error = step(current, h, chute, stages, trial) / tolerance
            tries += 1
            if error <= 1.0:
                current[:] = trial
                here = nodes[k] if last else here + h
                longest = max(longest, abs(h) * min(5.0, step_factor(max(error, 1e-10))))
            else:
                longest = abs(h) * (max(0.2, step_factor(error)) if error == error else 0.2)
            if tries > 10000:
                return k
        out[k] = current
    return len(nodes)


@njit(cache=True, error_model="numpy")
def from_nodes(nodes, states, place, z, chute, tolerance, out):  # type: ignore[no-untyped-def]
    """The state at each z, from the node at its place. Returns the number of points reached."""
    for k in range(len(z)):
        i = place[k]
        if follow(states[i], complex(nodes[i]), z[k : k + 1], chute, tolerance, out[k : k + 1]) < 1:
            return k
    return len(z)
