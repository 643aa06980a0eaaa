"""One problem that somebody else posed, with its truth and where that comes from."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from collocation import Discretization, ElementJoint, Far, Fixed

import shootstab as st

SECONDS = 20.0  # seconds of CPU for one question: chosen; a refusal should take 5
DIGITS = 8  # chosen
GUESS = 2e-3  # chosen: the relative distance from the truth at which refine begins
ROUNDING = 2.3e-16  # derived: 2^−52, rounded up


@dataclass(frozen=True)
class Stranger:
    """A problem with its truth. modes() gives what eigenvalues it has in region (repeated by multiplicity) and how sure each is.

    origin says where the truth comes from: "exact", "independent", "collocation", "published". spurious are claims that are no modes, on
    claims on the essential spectrum. scale is what a number is small against, where 0 is a mode. also: what else is asked.
    """

    name: str
    source: str
    origin: str
    problem: Callable[[], Any]
    modes: Callable[[], Sequence[tuple[complex, float]]]
    region: Any = None
    spurious: tuple[complex, ...] = ()
    on: tuple[complex, ...] = ()
    unstable: int | None = None
    scale: float = 0.0
    quick: bool = False
    digits: int = DIGITS
    guess: float = GUESS
    refined: int = 3  # the number of modes that are refined
    seconds: float = SECONDS
    also: Callable[[Any, Sequence[tuple[complex, float]]], Iterator[tuple[str, str, str]]] | None = None
    skip: tuple[str, ...] = ()


def exactly(*values: complex) -> Callable[[], Sequence[tuple[complex, float]]]:
    """Modes known to the last bit of a double."""
    return lambda: [(complex(v), 2.3e-16 * abs(v)) for v in values]


def collocated(
    size: int, pencil: Callable[[Any], Any], left: Fixed | Far, right: Fixed | Far, guesses: Sequence[complex], **kw: Any
) -> Any:
    """Modes near the guesses by collocation at two resolutions; how far they moved, and rounding, is how sure they are."""

    def modes() -> list[tuple[complex, float]]:
        form = Discretization(size, pencil, left, right, **kw)
        found = [(v, 3 * moved + 4 * ROUNDING * abs(v)) for v, moved in (form.truth(g) for g in guesses)]
        if any(sure > 1e-6 * (abs(v) + 1e-3) for v, sure in found):
            raise ValueError(f"two resolutions differ: {found}")
        return found

    return modes


def walls(size: int, pencil: Callable[[Any], Any], a: float, rows_a: Any, b: float, rows_b: Any, **kw: Any) -> Callable[[], Any]:
    """The problem between two walls, as shootstab takes it."""
    return lambda: st.problem(size, pencil, st.Wall(a, rows_a), st.Wall(b, rows_b), **kw)


def line(size: int, pencil: Callable[[Any], Any], **kw: Any) -> Callable[[], Any]:
    """The problem on the whole line."""
    return lambda: st.problem(size, pencil, st.Infinity(), st.Infinity(), **kw)


def second_order(a: Any, b: Any, weight: Any = 1.0) -> tuple[Any, Any]:
    """D0, D1 of y″ = (a + σ weight) y + b y′."""
    return np.array([[0, 1], [a, b]]), np.array([[0, 0], [weight, 0]])


def jumps(places: Sequence[float], n: int) -> list[Any]:
    """Interfaces at which ψ itself is continuous."""
    return [st.Interface.jump(z, np.eye(n)) for z in places]


__all__ = [
    "DIGITS",
    "Discretization",
    "ElementJoint",
    "Far",
    "Fixed",
    "Stranger",
    "collocated",
    "exactly",
    "jumps",
    "line",
    "second_order",
    "walls",
]
