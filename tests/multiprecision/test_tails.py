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


def transition(pencil: TailedPencil, sigma: Any) -> Any:
    """Φ of a step, None where it is not bounded."""
    found = rough_too(pencil, sigma)
    return None if found is None else found[0]


def rough_too(pencil: TailedPencil, sigma: Any) -> Any:
    """Φ, and the same by fewer terms."""
    identity = [[acb(int(i == j)) for j in range(pencil.size)] for i in range(pencil.size)]
    return pencil.carried(sigma, identity, identity)


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
            found = rough_too(short, sigma)
            if found is None:
                continue
            bounded += 1
            truth = transition(long, sigma)
            assert truth is not None and max(float(acb(x).rad()) for row in truth for x in row) < 1e-12
            for enclosed in found:
                contained(enclosed, truth)
            fewer = transition(long.shortened(LONG // 2), sigma)
            contained(fewer, truth)
            assert float(acb(fewer[0][0]).rad()) > float(acb(truth[0][0]).rad())
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


@pytest.mark.parametrize("f", ["0.05", "0.3", "0.6"])
def test_where_all_terms_have_one_sign_no_part_of_the_bounds_is_to_spare(f: str) -> None:
    """(1 − f t) y′ = d y has (1 − f t)^{−d/f}, and (1 − f t) t ψ′ = A ψ, A = (ρ ν; 0 ρ), has (t/(1 − f t))^A."""
    bounded = 0
    with ctx.workprec(160):
        for terms, d, nu in ((2, "0.01", "0.1"), (3, "0.3", "0.5"), (5, "1e-6", "1"), (12, "2", "2"), (12, "1e-6", "1e-6")):
            C = {at: TailedSeries([acb(1), -acb(f)], terms) for at in ((0, 0), (1, 1))}
            one = TailedPencil(1, [{(0, 0): C[0, 0]}], [{(0, 0): TailedSeries([acb(d)], terms)}], terms)
            found = transition(one, acb(0))
            if found is not None:
                bounded += 1
                assert acb(found[0][0]).contains((1 - acb(f)) ** -(acb(d) / acb(f)))
            rate, jordan = arb(d), arb(nu)
            A = {(0, 0): rate, (0, 1): jordan, (1, 1): rate}
            two = TailedPencil(2, [C], [{at: TailedSeries([acb(x)], terms) for at, x in A.items()}], terms)
            identity = [[arb(1), arb(0)], [arb(0), arb(1)]]
            decaying = two.decaying(acb(0), identity, rate, [[arb(0), jordan], [arb(0), arb(0)]])
            if decaying is not None:
                bounded += 1
                scale = (1 - acb(f)) ** -acb(rate)
                contained(decaying, [[scale, -scale * jordan * (1 - acb(f)).log()], [acb(0), scale]])
    assert bounded > 4


@pytest.mark.parametrize("steep", [0.3, 1.5])
def test_a_step_and_a_singular_end_keep_more_terms_than_flint_does_of_its_own_accord(steep: float) -> None:
    """y′ = y Σ t^m over m < 30, and t y′ = (ρ + t Σ t^m) y: both are multiplied by e^{Σ t^{m+1}/(m + 1)} from 0 to 1."""
    terms, rate = 80, arb("0.7")
    with ctx.workprec(160):
        assert ctx.cap < 30
        c = [acb(steep) / 30] * 30
        truth = sum((x / (m + 1) for m, x in enumerate(c)), acb(0)).exp()
        one = {(0, 0): TailedSeries([acb(1)], terms)}
        found = transition(TailedPencil(1, [one], [{(0, 0): TailedSeries(c, terms)}], terms), acb(0))
        singular = TailedPencil(1, [one], [{(0, 0): TailedSeries([acb(rate), *c], terms)}], terms)
        other = singular.decaying(acb(0), [[arb(1)]], rate, [[arb(0)]])
        assert found is not None and other is not None
        for x in (found[0][0], other[0][0]):
            assert acb(x).overlaps(truth) and acb(x).rad() < 1e-6


def test_a_step_on_which_c_may_be_singular_has_no_enclosure() -> None:
    with ctx.workprec(100):
        one, steep = TailedSeries([acb(1)], N), TailedSeries([acb(1), acb(-1.2)], N)
        pencil = TailedPencil(2, [{(0, 0): steep, (1, 1): one}], [{(0, 1): one, (1, 0): one}], N)
        assert transition(pencil, acb(0)) is None
        assert pencil.contraction(acb(0)) > 1.0
        vanishing = TailedPencil(1, [{(0, 0): TailedSeries([acb(0), acb(1)], N)}], [{(0, 0): one}], N)
        assert transition(vanishing, acb(0)) is None
