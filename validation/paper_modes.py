"""The most unstable modes of the three flows at Q0 = 3, and where the high flow grows fastest."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from claims import Case, Claim, main
from scenes import GUESS, problem

import shootstab as st

PAPER = {"high": 0.00397, "mid": 0.00102, "low": 0.00727 - 0.0119j}
RECOMPUTED = {"high": 0.0039705, "mid": 0.0010229, "low": 0.0072756 - 0.0118650j}


def cases(quick: bool) -> Iterator[Case]:
    """The paper's three digits (the low flow one unit off in the third), and the re-computed ones, every digit."""
    for name in PAPER:
        mode = st.refine(problem(name), guess=GUESS[name], rtol=1e-11)
        unit = 0.0101e-3 if name == "low" else 0.5e-5
        note = f"error bound {mode.error:.1e}"
        yield Case(f"{name}, as printed", PAPER[name], mode.sigma, (unit + 0.5e-4 * (name == "low")) / abs(PAPER[name]), note)
        yield Case(f"{name}, re-computed", RECOMPUTED[name], mode.sigma, 0.75e-7 / abs(RECOMPUTED[name]))
    flow, step = problem("high").flow, 1e-4
    kys = np.arange(0.0098, 0.01021, step) if quick else np.arange(0.0080, 0.01201, step)
    rates = [st.refine(st.chute.problem(flow, 0.0, ky), guess=0.00397, rtol=1e-8).sigma.real for ky in kys]
    yield Case("high, fastest growing k_y", 0.0100, float(kys[int(np.argmax(rates))]), 0.5 * step / 0.01)


CLAIM = Claim(
    "The most unstable modes at Q0 = 3 are 0.0039705 (high, largest at k_y = 0.0100), 0.0010229 (mid), 0.0072756 - 0.0118650i (low).",
    "Woodhouse & Hogg 2010, section 3.2: 0.00397, 0.00102, 0.00727 - 0.0119i",
    cases,
)

if __name__ == "__main__":
    main(CLAIM)
