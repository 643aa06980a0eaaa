"""Figure 8: waves of every length on flows that are stable to the waves that edges.py counts; k → 0, what lies between, and k → ∞.

Between: the kinematic mode is followed from long waves on until it is damped by the part DAMPED of |c| k. As k → 0 it is the only mode with
Re σ → 0: of long waves it decides.

Straight across the slope it is none: σ would be real and negative, beyond the continuous spectrum of the far field, and decays unseen.

Short waves: inside, coefficients that are frozen at a height leave waves e^{imz} whose σ solve (i m C0 − D0) φ = σ (D1 − i m C1) φ; for
k → ∞ they are the spectrum away from the base. Modes that live at the base are not counted: of waves so short no bound on |σ| is known.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from claims import Case

import shootstab as st
from paper.edges import DIRECTIONS, kinematic_speed, sample, steady, wave
from paper.rows import Item, Reproduction, Row, if_all_hold
from shootstab.models.chute.chute_problem import ChuteProblem

FLOWS = ((0.29, 1.2), (0.30, 1.4), (0.31, 1.6), (0.32, 1.8))  # chosen: (tan θ, T_∞) inside the stable intervals
LONGEST, PER_DECADE, DAMPED = 1e-4, 12, 0.1  # chosen: k h0 of the first wave, waves a decade, −Re σ over |c| k at which following ends
UP_TO = 10.0  # chosen: k h0 beyond which waves are short
FROZEN = (3.0, 10.0, 30.0, 100.0, 300.0)  # chosen: k h0 of the waves with frozen coefficients
VERTICAL = (-10.0, -3.0, -1.0, -0.3, -0.1, 0.0, 0.1, 0.3, 1.0, 3.0, 10.0)  # chosen: m/k of those
FRACTIONS = tuple(10.0**-n for n in range(1, 9))  # chosen: ν0 of the heights at which coefficients are frozen, and the base
FINITE = 1e8  # chosen: |σ| beyond which an eigenvalue of the 8 by 8 pencil is infinite: its matrix D1 − i m C1 is singular


def followed(flow: tuple[float, float], direction: float) -> tuple[list[float], list[complex]]:
    """(k h0, σ) of the kinematic mode from LONGEST on, in one direction, until it is damped, or UP_TO."""
    base, here = steady(*flow), sample(*flow)
    h, c = base.centre_of_mass, kinematic_speed(base)
    form = here.d_x * math.cos(direction) ** 2 + here.d_y * math.sin(direction) ** 2
    k = LONGEST / h
    guess = -1j * c * wave(k, direction)[0] + form * k * k
    reached, found = [], []
    while k * h <= UP_TO:
        mode = st.refine(ChuteProblem(base, *wave(k, direction)), guess=guess, rtol=1e-8)
        if not mode.converged:
            break
        sigma = complex(mode.sigma)
        reached.append(k * h)
        found.append(sigma)
        if -sigma.real > DAMPED * abs(c) * k:
            break
        step = 10.0 ** (1.0 / PER_DECADE)
        # Im σ grows as k, Re σ as k² where waves are long; from two waves on their powers are those seen
        rates = [math.log(abs(b / a)) / math.log(step) if a and b else 1.0 for a, b in _last_two(found)] or [2.0, 1.0]
        guess = complex(sigma.real * step ** rates[0], sigma.imag * step ** rates[1])
        k *= step
    return reached, found


def _last_two(found: list[complex]) -> Iterator[tuple[float, float]]:
    if len(found) > 1:
        yield found[-2].real, found[-1].real
        yield found[-2].imag, found[-1].imag


def falling(quick: bool) -> Row:
    """Re σ of the kinematic mode over k."""
    cases, told = [], []
    for flow in FLOWS[1:2] if quick else FLOWS:
        last, base = [], steady(*flow)
        for direction in (math.pi / 4,) if quick else DIRECTIONS[:-1]:
            reached, found = followed(flow, direction)
            if not found:
                raise st.ConvergenceError(f"no kinematic mode is found at k h0 = {LONGEST}, tan θ = {flow[0]}, T_∞ = {flow[1]}")
            rates = np.array([s.real for s in found])
            damped = -rates[-1] > DAMPED * abs(kinematic_speed(base)) * reached[-1] / base.centre_of_mass
            falls = "yes" if rates[0] < 0 and (np.diff(rates) < 0).all() and damped else "no"
            name = f"tan θ = {flow[0]}, T_∞ = {flow[1]}, {math.degrees(direction):.3g}°"
            cases.append(
                Case(f"{name}: Re σ falls with k, until damped", "yes", falls, 0.0, f"{rates[-1]:.3g} at k h0 = {reached[-1]:.3g}")
            )
            last.append(reached[-1])
        told.append(f"tan θ = {flow[0]}, T_∞ = {flow[1]}: falls up to k h0 = {min(last):.3g} to {max(last):.3g}")
    said = f"Re σ falls from 0 at k = 0 in five directions, from along the slope to nearly across it, until it is damped: {'; '.join(told)}"
    return Row(
        "on a stable flow the kinematic mode, the neutral one of k = 0, decays at every other wavenumber",
        "3.3, figure 8",
        "stable at all the wavenumbers of a set",
        if_all_hold(cases, said),
        tuple(cases),
    )


def frozen(flow: tuple[float, float], kh: float) -> float:
    """The largest Re σ/|σ| of waves with frozen coefficients, over heights, directions and vertical wavenumbers."""
    from scipy.linalg import eigvals

    base = steady(*flow)
    heights = np.array([0.0, *(base.height(nu) for nu in FRACTIONS if nu < base.base["nu"])])
    k, largest = kh / base.centre_of_mass, -math.inf
    for direction in DIRECTIONS:
        at = ChuteProblem(base, *wave(k, direction)).pencil(heights.astype(complex))
        for C0, C1, D0, D1 in zip(at.C0, at.C1, at.D0, at.D1, strict=True):
            for m in k * np.array(VERTICAL):
                sigma = eigvals(1j * m * C0 - D0, D1 - 1j * m * C1)
                sigma = sigma[np.isfinite(sigma) & (np.abs(sigma) < FINITE)]
                largest = max(largest, float((sigma.real / np.abs(sigma)).max()))
    return largest


def short(quick: bool) -> Row:
    """Waves shorter than those of edges.py."""
    cases = []
    for flow in FLOWS[1:2] if quick else FLOWS:
        largest = max(frozen(flow, kh) for kh in FROZEN)
        name = f"tan θ = {flow[0]}, T_∞ = {flow[1]}: frozen waves decay"
        cases.append(Case(name, "yes", "yes" if largest < 0 else "no", 0.0, f"Re σ/|σ| ≤ {largest:.1e}"))
    said = f"waves with frozen coefficients decay at every height asked about, for k h0 from {FROZEN[0]:g} to {FROZEN[-1]:g}"
    return Row(
        "short waves decay on these flows",
        "3.3, figure 8",
        "nothing; its waves are a set of k",
        if_all_hold(cases, said) + "; what lives at the base is not counted: of waves so short no bound on |σ| is known",
        tuple(cases),
    )


REPRODUCTION = Reproduction(
    "all_waves", "Figure 8: waves of every length on stable flows", (Item("from long waves on", falling), Item("short waves", short))
)
