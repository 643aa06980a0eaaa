"""Lemma E11 of the guide: what the terms of a linear system leave out is never more than its bound, on a step and at a singular end."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

flint = pytest.importorskip("flint")

from flint import acb, arb, ctx  # noqa: E402

from shootstab.multiprecision.tailed_pencil import TailedPencil  # noqa: E402
from shootstab.multiprecision.tailed_series import TailedSeries  # noqa: E402

N, LONG, SIZE = 12, 70, 3  # terms of the series under test, and of the truth; unknowns
TRIALS = 16


def random_part(rng: np.random.Generator, at_zero: np.ndarray[Any, Any], rate: float, size: float) -> dict[tuple[int, int], list[Any]]:
    """LONG coefficients of every entry: those at 0, then ones that decay."""
    out = {}
    for i in range(SIZE):
        for j in range(SIZE):
            later = size * rate ** np.arange(1, LONG) * (rng.standard_normal(LONG - 1) + 1j * rng.standard_normal(LONG - 1))
            out[i, j] = [acb(complex(at_zero[i, j])), *(acb(x) for x in later.tolist())]
    return out


def shortened(part: dict[tuple[int, int], list[Any]], terms: int) -> dict[tuple[int, int], TailedSeries]:
    """With so many coefficients and the norm of the others as tails."""
    return {at: TailedSeries(c[:terms], terms, sum(map(abs, c[terms:]), arb(0))) for at, c in part.items()}


def pencils(rng: np.random.Generator, C0: Any, D0: Any) -> tuple[TailedPencil, TailedPencil]:
    """One with N and one with LONG terms, (C + σ C1, D + σ D1)."""
    rate, nothing = rng.uniform(0.1, 0.4), np.zeros((SIZE, SIZE))
    size = rng.uniform(0.02, 0.15)
    parts = [random_part(rng, at, rate, size) for at in (C0, nothing, D0, nothing)]
    short, long = ([shortened(part, terms) for part in parts] for terms in (N, LONG))
    return TailedPencil(SIZE, short[:2], short[2:], N), TailedPencil(SIZE, long[:2], long[2:], LONG)


def contained(found: Any, truth: Any) -> None:
    """The ball is wider than the truth, which is known to more digits than it, and holds it."""
    for row, exact in zip(found, truth, strict=True):
        for x, y in zip(row, exact, strict=True):
            assert acb(x).contains(acb(y).mid())


def test_a_step_encloses_what_a_much_longer_series_gives() -> None:
    rng = np.random.default_rng(11)
    bounded = 0
    with ctx.workprec(160):
        for _ in range(TRIALS):
            C0 = np.eye(SIZE) + 0.2 * rng.standard_normal((SIZE, SIZE))
            short, long = pencils(rng, C0, rng.uniform(0.1, 1.0) * rng.standard_normal((SIZE, SIZE)))
            sigma = acb(*rng.standard_normal(2).tolist())
            found = short.transition(sigma)
            if found is None:
                continue
            bounded += 1
            truth = long.transition(sigma)
            assert truth is not None and max(float(acb(x).rad()) for row in truth for x in row) < 1e-12
            contained(found, truth)
    assert bounded > TRIALS // 2


@pytest.mark.parametrize("jordan", [0.0, 0.7])
def test_a_singular_end_encloses_what_a_much_longer_series_gives(jordan: float) -> None:
    rng = np.random.default_rng(12)
    bounded = 0
    with ctx.workprec(160):
        for _ in range(TRIALS):
            rate = float(rng.uniform(0.05, 2.0))
            D0 = np.array([[rate, jordan, 0.0], [0.0, rate, 0.0], [0.0, 0.0, -rate]])
            short, long = pencils(rng, np.eye(SIZE), D0)
            sigma = acb(*rng.standard_normal(2).tolist())
            P0 = [[arb(1), arb(0)], [arb(0), arb(1)], [arb(0), arb(0)]]
            nilpotent = [[arb(0), arb(jordan)], [arb(0), arb(0)]]
            found, truth = (pencil.decaying(sigma, P0, arb(rate), nilpotent) for pencil in (short, long))
            if found is None:
                continue
            bounded += 1
            assert truth is not None and max(float(acb(x).rad()) for row in truth for x in row) < 1e-12
            contained(found, truth)
    assert bounded > TRIALS // 2


def test_a_step_on_which_c_may_be_singular_has_no_enclosure() -> None:
    with ctx.workprec(100):
        one, steep = TailedSeries([acb(1)], N), TailedSeries([acb(1), acb(-1.2)], N)
        pencil = TailedPencil(2, [{(0, 0): steep, (1, 1): one}], [{(0, 1): one, (1, 0): one}], N)
        assert pencil.transition(acb(0)) is None
        assert not pencil.holds(acb(0), 0.9)
        vanishing = TailedPencil(1, [{(0, 0): TailedSeries([acb(0), acb(1)], N)}], [{(0, 0): one}], N)
        assert vanishing.transition(acb(0)) is None
