"""Pieces of a boundary, ellipses of their t-planes and the squares that cover these, chosen by the room that what is singular leaves.

Next to a continuous spectrum |D| has a bound on squares that are small against their distance to it. A piece is cut until it is short
against its own, and a square in four until it is small against its own. These are choices: a bound is proved of the squares as they are.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

from shootstab.analyses.enclosed_jobs import PieceValue, SquareBound
from shootstab.core.balls import acb
from shootstab.core.errors import ConvergenceError
from shootstab.roots.ellipses import Square, boxes, meets, point, points_on_ellipse, quarters
from shootstab.roots.pieces import ContourPiece

LONGEST_BOX, SIDES_OF_PIECE = 0.05, 16  # chosen: half a side of a square for |D|, in |dσ/dt| over |σ − centre|; sides of one on a segment
LARGEST_BOX = 0.25  # chosen: half a side of a square at most, for −1 ≤ t ≤ 1: of a short piece one would reach far beyond its ellipse
REACH_OF_BOX = 0.07  # chosen: half a side over the distance to what is singular: |D| is bounded ten nats worse at 0.1 than at 0.03
REACH_OF_PIECE = 0.75  # chosen: half a piece over its distance to what is singular: an ellipse has the most room where its ρ comes to 2
SMALLEST_BOX = Fraction(1, 2**10)  # chosen: half a side below which the ellipse reaches what is singular
MOST_CUTS = 12  # chosen: how often a piece is halved: each time where it fails alone, so that a few dozen more are planned
MOST_SQUARES = 2400  # chosen: squares on an ellipse above which a smaller one is taken
SAMPLES_OF_PIECE, SAMPLES_OF_PART = 6, 3  # chosen: points of a piece at which the size of D is judged, and of one that had to be cut
SQUARE = 0.2  # chosen: the time of a bound of |D| over that of a value of D; of the high chute 0.08 s to 0.23 s (σ real) and 0.44 s
PLACES_OF_PIECE = (-1.0, -0.5, 0.0, 0.5, 1.0)  # chosen: t at which the room of a piece is looked at

Room = Callable[[complex], float]  # σ ↦ about its distance to what is singular


@dataclass(frozen=True)
class PlannedPiece:
    """A piece with the ellipse of its t-plane, the squares that cover it and ln |D| above which they are cut.

    least is ln of the spread that is allowed, bound that of ln |D| which its points are chosen for.
    """

    piece: ContourPiece
    rho: float
    boxes: tuple[Square, ...]
    allowed: float
    least: float
    bound: float

    @property
    def squares(self) -> list[SquareBound]:
        """The bounds that are asked for."""
        return [SquareBound(self.piece, box, self.allowed) for box in self.boxes]

    @property
    def points(self) -> int:
        """K of lemma E13."""
        return points_on_ellipse(self.bound, self.least, self.rho)

    @property
    def values(self) -> list[PieceValue]:
        """What is asked of D on it; of a mirrored piece those with t ≥ 0, the others being conjugates."""
        asked = math.ceil(self.points / 2) if self.piece.mirrored else self.points
        return [PieceValue(self.piece, j, self.points) for j in range(asked)]

    @property
    def cost(self) -> float:
        """Its cost, in values of D."""
        return SQUARE * len(self.boxes) + len(self.values)


def with_room(piece: ContourPiece, room: Room) -> list[ContourPiece]:
    """The piece, or parts of it that are short against their distance to what is singular.

    Raises ConvergenceError where they would have to be too short.
    """
    places = [sigma_at(piece, t) for t in PLACES_OF_PIECE]
    if max(abs(places[0] - places[2]), abs(places[-1] - places[2])) <= REACH_OF_PIECE * min(map(room, places)):
        return [piece]
    if shortest(piece):
        raise ConvergenceError(f"the continuous spectrum meets the boundary of the region, or is too near to it, {between(piece)}")
    return [part for half in piece.halves() for part in with_room(half, room)]


def samples(piece: ContourPiece) -> list[PieceValue]:
    """Values of D by which its size on a piece is judged."""
    count = SAMPLES_OF_PIECE if piece.high - piece.low == 2 else SAMPLES_OF_PART
    return [PieceValue(piece, j, count) for j in range(count)]


def sampled_places(piece: ContourPiece) -> list[complex]:
    """σ of these."""
    return [complex(piece.at(point(job.j, job.K)).mid()) for job in samples(piece)]


def covered(piece: ContourPiece, rho: float, room: Room) -> tuple[Square, ...] | None:
    """Squares that cover the ellipse, of a mirrored piece the right half of it; None where they would have to be too small or too many."""
    if math.isinf(room(sigma_at(piece, 0.0))):
        longest = min(LONGEST_BOX / piece.rate, LARGEST_BOX) if piece.rate else 1 / SIDES_OF_PIECE
        return tuple(boxes(rho, longest, piece.mirrored))
    todo, found = list(boxes(rho, LARGEST_BOX, piece.mirrored)), []
    while todo:
        x, y, half = box = todo.pop()
        middle, corner = (sigma_at(piece, complex(x + d, y + d)) for d in (0, half))
        if abs(corner - middle) <= math.sqrt(2) * REACH_OF_BOX * room(middle):
            found.append(box)
        elif half <= SMALLEST_BOX or len(todo) + len(found) > MOST_SQUARES:
            return None
        else:
            todo += [part for part in quarters(box) if meets(part, rho)]
    return tuple(found)


def told_by(found: tuple[Square, ...], piece: ContourPiece, room: Room) -> list[SquareBound]:
    """Bounds of two squares at least, next to what is singular and at the ends of the ellipse, that tell about how large all are."""
    chosen = {
        min(found, key=lambda box: room(sigma_at(piece, complex(*box[:2])))),
        *(max(found, key=lambda box: s * box[axis]) for axis in (0, 1) for s in (1, -1)),  # type: ignore[misc]
    }
    return [SquareBound(piece, box, math.inf, 0) for box in sorted(chosen)]


def sigma_at(piece: ContourPiece, t: complex) -> complex:
    """σ(t) in doubles."""
    return complex(piece.at(acb(t)).mid())


def shortest(piece: ContourPiece) -> bool:
    """Whether it is cut no more."""
    return piece.high - piece.low <= Fraction(2, 2**MOST_CUTS)


def between(piece: ContourPiece) -> str:
    """Where a piece lies, in words."""
    start, end = (sigma_at(piece, t) for t in (-1, 1))
    return f"from {start:.6g} to {end:.6g}"
