"""Pieces of a boundary and squares on ellipses, chosen by the distance to a half-line that is singular."""

from __future__ import annotations

import math

import numpy as np
import pytest

flint = pytest.importorskip("flint")

import shootstab as st  # noqa: E402
from shootstab.analyses.piece_plan import REACH_OF_BOX, REACH_OF_PIECE, covered, samples, sigma_at, told_by, with_room  # noqa: E402
from shootstab.core.errors import ConvergenceError  # noqa: E402
from shootstab.roots.pieces import pieces  # noqa: E402


def room(sigma: complex) -> float:
    """The distance to the negative axis."""
    return abs(sigma) if sigma.real > 0 else abs(sigma.imag)


REGIONS = [st.Disc(0.004, 0.003), st.Rectangle(0.001 - 0.01j, 0.02 + 0.01j), st.HalfAnnulus(0.0, 0.001, 0.05)]


@pytest.mark.parametrize("region", REGIONS)
@pytest.mark.parametrize("real", [False, True])
def test_parts_are_short_against_their_distance_and_together_the_boundary(region: object, real: bool) -> None:
    whole = pieces(region, real)  # type: ignore[arg-type]
    parts = [part for piece in whole for part in with_room(piece, room)]
    assert sum(part.times * (part.high - part.low) for part in parts) == sum(piece.times * (piece.high - piece.low) for piece in whole)
    for part in parts:
        middle = sigma_at(part, 0.0)
        reach = max(abs(sigma_at(part, t) - middle) for t in np.linspace(-1, 1, 9).tolist())
        assert reach <= 1.05 * REACH_OF_PIECE * min(room(sigma_at(part, t)) for t in np.linspace(-1, 1, 9).tolist())


def test_squares_cover_the_ellipse_and_are_small_against_their_distance() -> None:
    for piece in pieces(REGIONS[0], False):
        for part in with_room(piece, room):
            found = covered(part, 1.5, room)
            assert found is not None
            for x, y, half in found:
                middle = sigma_at(part, complex(x, y))
                assert abs(sigma_at(part, complex(x + half, y + half)) - middle) <= 1.01 * math.sqrt(2) * REACH_OF_BOX * room(middle)
            for angle in np.linspace(0, 2 * np.pi, 60):
                t = complex((1.5 + 1 / 1.5) / 2 * np.cos(angle), (1.5 - 1 / 1.5) / 2 * np.sin(angle))
                assert any(abs(t.real - x) <= half and abs(t.imag - y) <= half for x, y, half in found)
            nearest = min(found, key=lambda box: room(sigma_at(part, complex(*box[:2]))))
            told = told_by(found, part, room)
            assert nearest in [job.box for job in told] and all(job.cuts == 0 for job in told) and 2 <= len(told) <= 5


def test_an_ellipse_that_meets_what_is_singular_is_not_covered() -> None:
    whole = pieces(REGIONS[1], True)
    assert covered(whole[0], 2.2, room) is not None  # the right side, far away
    assert covered(whole[2], 1.2, room) is None  # the left side as a whole
    assert len(samples(whole[2])) == 6 and {len(samples(part)) for part in with_room(whole[2], room)} == {3}


def test_a_boundary_across_what_is_singular_is_refused_where_it_is_met() -> None:
    (left,) = [piece for piece in pieces(st.Rectangle(-0.1 - 0.5j, 0.9 + 0.5j), True) if abs(sigma_at(piece, 0.0) + 0.1) < 1e-12]
    with pytest.raises(
        ConvergenceError, match=r"meets the boundary of the region, or is too near to it, from -0\.1\+0\.000244141j to -0\.1"
    ):
        with_room(left, room)
