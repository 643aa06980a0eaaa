"""Meshes that hold a local error: where to put the steps, from the error that they made."""

from __future__ import annotations

import itertools
import math

import numpy as np
from numpy.typing import NDArray

from shootstab.kernels.step_control import factor

OFF_MIDDLE = 0.02  # chosen: the part of a step by which a cut misses its middle: other roundings, and an error of the same size
MOVED = 1e-9  # chosen: the part of a step by which a node is moved for other roundings: far above them, and the error of the step stays
LONGER, STEP_CUTS = 4.0, 6  # chosen: the most that a step grows, and the most parts it is cut into, as the law of errors holds near only
FITTING = 0.9  # chosen: steps that are needed, in those that there are, for which nodes are not moved once more
KNOT_STEP = 1e-14  # chosen: the part of the largest |z| that a step over a knot may be long; tens of roundings
TURNED = 1e-9  # chosen: the change of direction from step to step, in radians, that rounding does not make


def redistribute(nodes: NDArray[np.complex128], errors: NDArray[np.float64], tolerance: float) -> NDArray[np.complex128]:
    """A mesh on the same polygon on which the local errors, which go with a power of the step, are alike and meet the tolerance.

    From nodes (N + 1,) and the errors (N,) of their steps to nodes (M + 1,). The corners of the polygon stay nodes, and so do those on
    either side of a knot.
    """
    h = np.diff(nodes)
    lengths, knots = np.abs(h), across_knots(nodes)
    with np.errstate(divide="ignore"):
        shrink = 1.0 / factor(np.where(np.isfinite(errors), errors, np.inf) / tolerance)
    shrink = np.clip(shrink, 1.0 / LONGER, STEP_CUTS)
    density = np.where(knots, 0.0, shrink / lengths)
    # a step cannot know what happens in its neighbour
    near = np.maximum(np.append(density[1:], 0.0), np.insert(density[:-1], 0, 0.0))
    density = np.maximum(density, 0.5 * near)
    legs = [nodes[:1]]
    for first, last in _legs(h, knots):
        legs.append(_equidistribute(nodes[first : last + 1], density[first:last]))
    return np.concatenate(legs)


def fits(errors: NDArray[np.float64], tolerance: float) -> bool:
    """Whether the errors (N,) of the steps of a mesh meet the tolerance, and hardly fewer steps would do by the law of errors."""
    if not (errors <= tolerance).all():
        return False
    with np.errstate(divide="ignore"):
        needed = np.maximum(1.0 / factor(errors / tolerance), 1.0 / LONGER)
    return bool(needed.sum() >= FITTING * len(errors))


def subdivide(nodes: NDArray[np.complex128], errors: NDArray[np.float64], tolerance: float) -> NDArray[np.complex128]:
    """Nodes (M + 1,) from nodes (N + 1,) whose steps err by errors (N,): steps whose error exceeds the tolerance are cut.

    Each falls into as many equal ones as its error asks for, two at least.
    """
    out = [nodes[:1]]
    for start, end, error in zip(nodes[:-1], nodes[1:], errors, strict=True):
        parts = 1
        if not error <= tolerance:
            parts = max(2, min(STEP_CUTS, math.ceil(1.0 / factor(error / tolerance)))) if np.isfinite(error) else STEP_CUTS
        out.append(start + (end - start) * np.arange(1, parts + 1) / parts)
        out[-1][-1] = end
    return np.concatenate(out)


def halved(nodes: NDArray[np.complex128], seed: int | None = None) -> NDArray[np.complex128]:
    """Nodes (2N + 1,) from nodes (N + 1,): every step cut in two, in the middle.

    With a seed it is cut a little off the middle, at random, for another mesh as good that rounds otherwise.
    """
    cuts = 0.5 if seed is None else 0.5 + OFF_MIDDLE * (2 * np.random.default_rng(seed).random(len(nodes) - 1) - 1)
    out = np.empty(2 * len(nodes) - 1, dtype=np.complex128)
    out[::2] = nodes
    out[1::2] = nodes[:-1] + cuts * (nodes[1:] - nodes[:-1])
    return np.asarray(out[np.append(True, out[1:] != out[:-1])])  # two neighbouring numbers have no middle


def partly_halved(nodes: NDArray[np.complex128], cut: NDArray[np.bool_]) -> NDArray[np.complex128]:
    """Nodes from nodes (N + 1,): the steps named in cut (N,) are cut in the middle, as all of them are on the halved mesh."""
    out = np.empty(2 * len(nodes) - 1, dtype=np.complex128)
    out[::2] = nodes
    out[1::2] = np.where(cut, nodes[:-1] + 0.5 * (nodes[1:] - nodes[:-1]), nodes[:-1])
    return np.asarray(out[np.append(True, out[1:] != out[:-1])])


def moved(nodes: NDArray[np.complex128], seed: int) -> NDArray[np.complex128]:
    """Nodes (N + 1,) moved along their steps by random parts of these, too small to change more than how everything rounds.

    The ends stay, and nodes on either side of a knot.
    """
    h, knots = np.diff(nodes), across_knots(nodes)
    free = ~(knots[1:] | knots[:-1])
    out = nodes.copy()
    out[1:-1] += np.where(free, MOVED * (2 * np.random.default_rng(seed).random(len(free)) - 1) * h[1:], 0.0)
    return out


def across_knots(nodes: NDArray[np.complex128]) -> NDArray[np.bool_]:
    """The steps (N,) between nodes (N + 1,) with no length but roundings: only these lead over a knot of the coefficients."""
    return np.asarray(np.abs(np.diff(nodes)) <= KNOT_STEP * np.abs(nodes).max())


def _legs(h: NDArray[np.complex128], knots: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Ranges of steps that run in one direction and over no knot, or over one only."""
    direction = h / np.abs(h)
    turns = np.flatnonzero((np.abs(np.diff(direction)) > TURNED) | knots[1:] | knots[:-1]) + 1
    bounds = [0, *turns.tolist(), len(h)]
    return list(itertools.pairwise(bounds))


def _equidistribute(nodes: NDArray[np.complex128], density: NDArray[np.float64]) -> NDArray[np.complex128]:
    """New nodes along one leg, its first one left out: equal shares of ∫ density."""
    lengths = np.abs(np.diff(nodes))
    share = np.concatenate(([0.0], np.cumsum(density * lengths)))
    arc = np.concatenate(([0.0], np.cumsum(lengths)))
    count = max(1, int(np.ceil(share[-1])))
    s = np.interp(np.linspace(0.0, share[-1], count + 1), share, arc)
    out = nodes[0] + (nodes[-1] - nodes[0]) * (s / arc[-1])
    out[-1] = nodes[-1]
    return np.asarray(out[1:])
