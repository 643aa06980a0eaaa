"""Lemma E13 of the guide: a polynomial on a piece of a contour, its spread, and the squares that cover an ellipse."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

flint = pytest.importorskip("flint")

from flint import acb, arb, ctx  # noqa: E402

from shootstab.core.half_annulus import HalfAnnulus  # noqa: E402
from shootstab.core.regions import Rectangle  # noqa: E402
from shootstab.roots.ellipses import ball_of, boxes, ellipse_model, point, points_on_ellipse, quarters  # noqa: E402
from shootstab.roots.pieces import ContourPiece, Segment, Spiral, pieces  # noqa: E402

POLE = 1.3 + 0.4j


def f(t: acb) -> acb:
    return (2 * t).exp() / (t - acb(POLE))


def test_the_polynomial_holds_the_function_within_its_spread() -> None:
    rng = np.random.default_rng(1)
    with ctx.workprec(90):
        for rho in (1.2, 1.6):
            bound = max((abs(f(piece)).upper() for box in boxes(rho, 0.02, False) for piece in [ball_of(box)]), key=float).log()
            for K in (4, 9, 24, 50):
                model = ellipse_model([f(acb(point(j, K))) for j in range(K)], bound, arb(rho))
                for x in rng.uniform(-1, 1, size=30).tolist():
                    assert model(acb(x)).contains(f(acb(x)))
                if K == 50:
                    assert model.spread < (1e-1 if rho == 1.2 else 1e-7)


def test_points_are_chosen_so_that_the_spread_is_the_size_asked_for() -> None:
    K = points_on_ellipse(3.0, -20.0, 1.5)
    assert 4 * np.exp(3.0) * 1.5 ** (1 - K) / 0.5 <= np.exp(-20.0) < 4 * np.exp(3.0) * 1.5 ** (3 - K) / 0.5


@pytest.mark.parametrize("mirrored", [False, True])
def test_squares_cover_the_ellipse(mirrored: bool) -> None:
    rho = 2.5
    found = list(boxes(rho, 0.3, mirrored))
    for angle in np.linspace(0, 2 * np.pi, 200):
        for size in (1.0, 0.6, 0.1):
            z = size * complex((rho + 1 / rho) / 2 * np.cos(angle), (rho - 1 / rho) / 2 * np.sin(angle))
            z = complex(abs(z.real), z.imag) if mirrored else z
            assert any(abs(z.real - x) <= h and abs(z.imag - y) <= h for x, y, h in found)
    whole = ball_of(found[0])
    assert all(whole.contains(ball_of(part).mid()) for part in quarters(found[0]))
    assert sum(part[2] ** 2 for part in quarters(found[0])) == found[0][2] ** 2


def test_the_phase_along_a_piece_grows_by_what_the_zeros_beside_it_say() -> None:
    """D = σ − 1 along the right half of |σ| = 2: the phase grows from that of −2i − 1 to that of 2i − 1."""
    arc = ContourPiece(Spiral(("0.0", "0.0"), ("2.0", Fraction(-1, 2)), ("2.0", Fraction(1, 2))), True)
    assert arc.mirrored and not ContourPiece(arc.curve, False).mirrored
    with ctx.workprec(80):
        model = ellipse_model([arc.at(acb(point(j, 40))) - 1 for j in range(40)], arb(12).log(), arb(2))
        turn, margin = model.turn(acb(-1), acb(1))
        assert margin > 1.0
        assert abs(float(turn) - 2 * (np.pi - np.arctan(2.0))) < 1e-6


@pytest.mark.parametrize("real", [False, True])
@pytest.mark.parametrize("region", [HalfAnnulus(0.5, 0.25, 2.0), Rectangle(0.1 - 1j, 2.0 + 1j), HalfAnnulus(0.5 + 0.1j, 0.25, 2.0)])
def test_pieces_run_around_the_region(region: HalfAnnulus | Rectangle, real: bool) -> None:
    found = pieces(region, real)
    if real and len(found) == 3:
        found = [*found, ContourPiece(found[1].curve, real)]
        assert [piece.times for piece in found[:3]] == [1, 2, 1]
    assert len(found) == 4
    for piece, after in zip(found[:3] if real else found, found[1:3] if real else [*found[1:], found[0]], strict=False):
        assert abs(piece.at(acb(1)) - after.at(acb(-1))) < 1e-12
    for piece in found:
        first, *second = piece.halves()
        assert bool(second) != piece.mirrored and first.times == (1 if second else 2) * piece.times
        for t in (-0.7, 0.1, 0.9):
            at = complex(piece.at(acb(t)).mid())
            assert not region.contains(at + 1e-9 * (at - 1.0)) or not region.contains(at - 1e-9 * (at - 1.0))
            if t < 0 or second:
                assert abs((first if t < 0 else second[0]).at(acb(2 * t + 1 if t < 0 else 2 * t - 1)) - acb(at)) < 1e-12
            else:  # as a mirror image of what the first one passes at −t
                assert abs(first.at(acb(1 - 2 * t)).conjugate() - acb(at)) < 1e-12
        assert piece.mirrored == (real and abs(complex(piece.at(acb(-0.3)).mid()) - complex(piece.at(acb(0.3)).mid()).conjugate()) < 1e-12)


def test_a_segment_is_its_own_mirror_image_across_the_real_axis_only() -> None:
    assert Segment(("1", "-2"), ("1", "2")).mirrored
    assert not Segment(("1", "-2"), ("1.5", "2")).mirrored
    assert Segment(("1", "-2"), ("1", "2")).rate == 0.0
