"""Lemmas E5 and E6 of the guide: the coefficients of a Taylor model hold the exact ones, with all that the values leave open."""

from __future__ import annotations

import math

import numpy as np
import pytest

flint = pytest.importorskip("flint")

from flint import acb, acb_poly, arb, ctx  # noqa: E402

from shootstab.core.errors import ConvergenceError  # noqa: E402
from shootstab.roots.pellet import PolynomialModel, TaylorModel, phase_gained, polynomial_model, taylor_model  # noqa: E402

OUTER = 3.0


def pole(root: complex, sigma: acb) -> acb:
    """(σ − root)/(1 − σ/4) about 0: coefficients that fall slowly, so that few values leave much open."""
    return (sigma - acb(root)) / (1 - sigma / 4)


def coefficients(root: complex, terms: int) -> list[acb]:
    return [(acb(4) * (k > 0) - acb(root)) * arb(4) ** -k for k in range(terms)]


def bound(root: complex) -> arb:
    return ((OUTER + abs(acb(root))) / (1 - arb(OUTER) / 4)).log()


def model(root: complex, points: int) -> TaylorModel:
    return taylor_model(lambda sigma: pole(root, sigma), bound(root), acb(0), arb(1), arb(OUTER), points)


@pytest.mark.parametrize("points", [2, 3, 5, 12])
def test_a_taylor_model_holds_the_series(points: int) -> None:
    rng = np.random.default_rng(points)
    with ctx.workprec(100):
        for _ in range(20):
            root = complex(*rng.standard_normal(2))
            found, truth = model(root, points), coefficients(root, 100)
            assert all(size.contains(abs(d).mid()) for size, d in zip(found.sizes, truth, strict=False))
            rest = sum((abs(d) for d in truth[points:]), arb(0))
            assert rest < found.tail
            small = found.shrunk(arb("0.25"))
            assert all(size.contains((abs(d) * arb(4) ** -k).mid()) for k, (size, d) in enumerate(zip(small.sizes, truth, strict=False)))
            assert sum((abs(d) * arb(4) ** -k for k, d in enumerate(truth) if k >= points), arb(0)) < small.tail
            proved = found.proved()
            assert proved is None or proved == int(abs(root) < 1.0)


def test_a_polynomial_is_within_its_spread_of_the_function() -> None:
    rng = np.random.default_rng(7)
    with ctx.workprec(100):
        for points in (2, 5, 12):
            root = complex(*rng.standard_normal(2))
            found = polynomial_model(lambda sigma, root=root: pole(root, sigma), bound(root), acb(0), arb(1), arb(OUTER), points)
            for phase in rng.uniform(0.0, 2 * math.pi, 20):
                sigma = acb(math.cos(phase), math.sin(phase)) * acb("0.999")
                assert found(sigma).contains(pole(root, sigma).mid())
                assert not abs(found.polynomial(sigma) - pole(root, sigma)) > found.spread


def test_nothing_is_concluded_beyond_the_circle_of_the_bound_or_from_no_number() -> None:
    with pytest.raises(ValueError, match="not proved to be wider"):
        taylor_model(lambda sigma: pole(0.5, sigma), arb(1), acb(0), arb(1), arb("0.5"), 4)
    with pytest.raises(ValueError, match="not proved to be wider"):
        polynomial_model(lambda sigma: pole(0.5, sigma), arb(1), acb(0), arb(1), arb(1), 4)
    with pytest.raises(ValueError, match="on its own circle and on smaller ones"):
        model(0.5, 4).shrunk(arb(2))
    square = [acb(-0.5, -0.5), acb(0.5, -0.5), acb(0.5, 0.5), acb(-0.5, 0.5)]
    for spread in (arb.pos_inf(), arb.nan()):
        with pytest.raises(ConvergenceError, match="an eigenvalue lies on the boundary or too near to it"):
            PolynomialModel(acb(0), arb(1), acb_poly([1]), spread).count(square)


def test_the_phase_of_wide_balls_is_as_wide_as_the_first_and_the_last() -> None:
    """Numbers drawn anywhere in balls: the sum of their arguments lies in the one of the balls, which does not grow with their number."""
    rng = np.random.default_rng(11)
    with ctx.workprec(64):
        for count in (20, 2000):
            phases = np.cumsum(rng.uniform(-0.6, 1.0, count))
            middles, wide = np.exp(1j * phases) * rng.uniform(0.7, 1.4, count), 0.1
            sum_of_balls = phase_gained([acb(arb(v.real, wide), arb(v.imag, wide)) for v in middles.tolist()])
            drawn = middles + wide * (rng.uniform(-1, 1, count) + 1j * rng.uniform(-1, 1, count))
            assert sum_of_balls.contains(arb(float(np.angle(drawn[1:] / drawn[:-1]).sum()), 1e-9))
            assert sum_of_balls.rad() < 0.6


@pytest.mark.parametrize("last", [acb(arb(-1, 0.1), arb(0, 0.1)), acb(arb(0, 0.1), arb(0, 0.1))])
def test_a_ball_across_the_cut_or_about_0_has_no_phase(last: acb) -> None:
    with pytest.raises(ConvergenceError, match="how its phase grows"):
        phase_gained([acb(1), last])
    with pytest.raises(ConvergenceError, match="how its phase grows"):
        phase_gained([last, acb(1)])
