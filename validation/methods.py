"""Three discriminants that fail differently: digits, evaluations, time and size of D, by method and scene."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from claims import Case, Claim, main
from scenes import GUESS, problem

import shootstab as st
from shootstab.analyses.reference import claims

GRAINS = {"e": 0.8, "e_w": 0.8, "r": 0.6, "tan_theta": 0.3}
METHODS = (st.Frame(rtol=1e-11), st.Compound(rtol=1e-11), st.Riccati(rtol=1e-11))  # chosen


def scenes(quick: bool) -> Iterator[tuple[str, object, complex]]:
    """The four built-in scenes and the extremes, each with a guess."""
    for name in ("high", "low") if quick else ("high", "mid", "low", "fig2"):
        yield name, problem(name), GUESS[name]
    flow = problem("high").flow
    yield "K = 1e-6", st.chute.problem(flow, 0.0, 1e-6), 1.2e-9
    if not quick:
        short = st.chute.problem(flow, 0.0, 1.0)
        yield "K = 1", short, claims(short, 7, 120)[0]
        yield "T = 0.03", st.chute.problem(st.chute.steady(far_temperature=0.03, **GRAINS), 0.01, 0.0), 0.0075 + 0.0056j
        yield "T = 60", st.chute.problem(st.chute.steady(far_temperature=60.0, **GRAINS), 0.0, 0.001), 0.0018


def cases(quick: bool) -> Iterator[Case]:
    """Each method against orthonormalized shooting at its tightest, within the sum of the error bounds."""
    for name, p, guess in scenes(quick):
        truth = st.refine(p, guess=guess, rtol=1e-12, method=st.Frame(rtol=1e-13))  # type: ignore[arg-type]
        for method in METHODS:
            st.refine(p, guess=guess, rtol=1e-9, method=method)  # type: ignore[arg-type]
            mode = st.refine(p, guess=guess, rtol=1e-9, method=replace(method))  # type: ignore[arg-type]
            D = method.on(p).with_derivative(complex(mode.sigma) * (1 + 1e-3)).D  # type: ignore[arg-type]
            allowed = (mode.error + truth.error) / abs(mode.sigma)
            size = f"log10|D| {D.log_abs / math.log(10):+.0f}"
            note = f"{mode.digits:.1f} digits by its bound, {mode.evaluations} evaluations, {1e3 * mode.seconds:.0f} ms, {size}"
            yield Case(f"{name}: {method.name}", truth.sigma, mode.sigma, allowed, note)


CLAIM = Claim(
    "Orthonormalized shooting, compound matrices and Riccati agree on every mode to their error bounds, at the extremes too.",
    "three ways to the same boundary determinant in this repository",
    cases,
)

if __name__ == "__main__":
    main(CLAIM)
