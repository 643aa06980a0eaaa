"""Lemma E4 of the guide: the moduli of minors, carried by a comparison system, are nowhere below the truth and not far above it."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
import pytest

flint = pytest.importorskip("flint")

from flint import acb, acb_mat, arb, ctx  # noqa: E402

from shootstab.multiprecision.growth import log_bound  # noqa: E402
from shootstab.multiprecision.minors import compound  # noqa: E402


def exact(n: int, k: int, matrices: list[dict[tuple[int, int], acb]], lengths: list[float], start: list[acb], end: list[acb]) -> float:
    """ln |Σ w_I y_I| by exponentials of the compound matrices."""
    y = acb_mat([[x] for x in start])
    for A, h in zip(matrices, lengths, strict=True):
        whole = acb_mat(math.comb(n, k), math.comb(n, k))
        for at, entry in compound(n, k, A).items():
            whole[at] = entry * acb(h)
        y = whole.exp() * y
    return float(abs(sum((w * y[i, 0] for i, w in enumerate(end)), acb(0))).log())


@pytest.mark.parametrize(("n", "k"), [(2, 1), (3, 2), (4, 2), (5, 1), (6, 3)])
def test_no_bound_lies_below_the_truth(n: int, k: int) -> None:
    rng, size = np.random.default_rng(7 * n + k), math.comb(n, k)

    def numbers(*shape: int) -> np.ndarray:
        return rng.normal(size=shape) + 1j * rng.normal(size=shape)

    with ctx.workprec(200):
        for scale in (0.1, 1.0, 10.0, 60.0):
            for _ in range(8):
                tables = [scale * numbers(n, n) for _ in range(3)]
                tables[1] -= 5 * scale * np.eye(n)
                matrices = [{(i, j): acb(complex(table[i, j])) for i in range(n) for j in range(n)} for table in tables]
                lengths = [float(h) for h in rng.uniform(-1.0, 1.0, size=3)]
                start, end = ([acb(complex(x)) for x in numbers(size)] for _ in range(2))
                bound = log_bound(n, k, [(arb(h), A) for h, A in zip(lengths, matrices, strict=True)], start, end)
                assert bound > exact(n, k, matrices, lengths, start, end)


def test_it_is_sharp_where_nothing_cancels() -> None:
    """Of a system with real entries that are not negative beside the diagonal it is the truth, up to what is added to doubles."""
    A = {
        (i, j): acb(0.5 + i + 2 * j) if i != j else acb(-30.0 * i) for i, j in [*combinations(range(3), 2), (1, 0), (2, 1), (1, 1), (2, 2)]
    }
    start, end = [acb(1), acb(2), acb(3)], [acb(1), acb(0), acb(4)]
    with ctx.workprec(100):
        bound = log_bound(3, 1, [(arb(0.7), A), (arb(0.1), A)], start, end)
        assert float(bound) == pytest.approx(exact(3, 1, [A, A], [0.7, 0.1], start, end), abs=1e-6)
        assert not log_bound(3, 1, [(arb(1), {(0, 1): acb("nan")})], start, end).is_finite()
