"""Shooting against the pseudospectral reference, which shares the steady flow with it and nothing else."""

from __future__ import annotations

from collections.abc import Iterator

from claims import Case, Claim, main
from scenes import GUESS, problem

import shootstab as st
from shootstab.models.chute import chute_collocation as chute

WANTED = {"high": 1e-9, "mid": 1e-9, "low": 1e-7, "fig2": 1e-9}


def cases(quick: bool) -> Iterator[Case]:
    """The truncation grows until the difference is within what is wanted, at most to M = 300."""
    for name, wanted in WANTED.items():
        p = problem(name)
        mode = st.refine(p, guess=GUESS[name], rtol=1e-11)
        for M in (40, 60, 80, 100) if quick else (40, 60, 80, 100, 140, 200, 300):
            found = chute.refine(p.flow, p.kx, p.ky, mode.sigma, M).sigma
            if abs(found - mode.sigma) <= wanted * abs(mode.sigma):
                break
        yield Case(f"{name}, M = {M}", mode.sigma, found, wanted, f"shooting's error bound {mode.error / abs(mode.sigma):.0e}")


CLAIM = Claim(
    "Shooting and the pseudospectral reference agree to 1e-9 on high, mid and fig2, and to 1e-7 on low.",
    "two derivations of the linearized equations in this repository; expected is shooting, obtained is QZ's mode by inverse iteration",
    cases,
)

if __name__ == "__main__":
    main(CLAIM)
