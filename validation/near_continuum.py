"""Discrete modes next to the continuous spectrum: what a raw QZ spectrum says at three truncations, and what shooting says."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from claims import Case, Claim, main
from scenes import problem

import shootstab as st
from shootstab.discriminants.continuation import Continuation
from shootstab.essential_spectrum.interior import continuum_of
from shootstab.models.chute import chute_collocation as chute

MODES = {"fig2": (0.00169243 - 0.00156624j, -0.0035033 - 0.0070879j), "low": (0.00727558 - 0.01186505j, -0.009473 - 0.050454j)}


# chosen
OFFSETS = (1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 0.0)  # distances of the singular point from the real axis, in the scale of the curve


def costs(name: str, quick: bool) -> Iterator[Case]:
    """Steps of the mesh for one D(σ) near the curve and on it, from both sides: the most must be at most 1.2 times the fewest."""
    p = problem(name)
    curve = continuum_of(p)
    assert curve is not None
    for z in curve.z[-1] * np.array([0.1] if quick else [0.02, 0.1, 0.3, 0.6]):
        for side in (1, -1):
            steps = []
            for offset in OFFSETS:
                sigma = complex(p.continuum(np.array([z + 1j * side * offset * curve.scale(z)]))[0])
                branch = Continuation(p, st.Frame(rtol=1e-9)).at(sigma)
                branch.discriminant(sigma)
                steps.append(branch.discriminant.steps)
            kept = "at most 1.2" if max(steps) <= 1.2 * min(steps) else f"{max(steps) / min(steps):.2f}"
            where = "above" if side > 0 else "below"
            yield Case(f"{name}: cost at z = {z:.3g}, {where}", "at most 1.2", kept, 0.0, f"steps {steps} at offsets {OFFSETS}")


def cases(quick: bool) -> Iterator[Case]:
    """Shooting must be the limit: at the largest truncation the nearest QZ eigenvalue agrees with it to what M allows."""
    for name in MODES:
        yield from costs(name, quick)
    for name, guesses in MODES.items():
        p = problem(name)
        for guess in guesses:
            mode = st.refine(p, guess=guess, rtol=1e-10)
            proved = st.verify(p, [mode.sigma], digits=8, region=None).verdicts[0]
            yield Case(f"{name}: counted", guess, mode.sigma, 1e-5, f"{proved.verdict}, {mode.continuum_distance:.1e} off the continuum")
            truncations = (60, 100) if quick else (60, 100, 160)
            for M in truncations:
                raw = chute.spectrum(p.flow, p.kx, p.ky, M, filtered=False).raw
                nearest = raw[np.argmin(np.abs(raw - mode.sigma))]
                balloon = int((np.abs(raw - mode.sigma) < 0.3 * abs(mode.sigma)).sum()) - 1
                allowed = 1e-6 if truncations[-1] == M else None
                yield Case(f"{name}: QZ, M = {M}", mode.sigma, nearest, allowed, f"{balloon} more eigenvalues within 30 %")
                printed = chute.spectrum(p.flow, p.kx, p.ky, M, filtered=False, z_max=p.flow.height(1e-10), focus=0.0).raw
                nearest = printed[np.argmin(np.abs(printed - mode.sigma))]
                yield Case(f"{name}: QZ, M = {M}, the paper's map", mode.sigma, nearest, None)


CLAIM = Claim(
    "The modes next to the continuous spectrum of fig2 and low are those that shooting counts, at a cost that no distance changes.",
    "Woodhouse & Hogg 2010, figure 2 and section 3.1 (the balloon of poorly converged eigenvalues)",
    cases,
)

if __name__ == "__main__":
    main(CLAIM)
