"""Kato's transport of the decaying space along a line in the σ-plane: how its determinant goes from one basis to another.

A frame that is R at the beginning is R_b M at the end, R_b a basis there, with

    ln det M = ln det(ℓ_b R) − ∫ f dσ,   f = tr[(ℓR)⁻¹ ℓ P′ R],   ℓ_b R_b = I

(kato_frame.py). The line is walked in panels, each from its own basis. On one, f is sampled at Chebyshev points, ends included, and taken
for integrated where its series has come to an end. A panel that crosses an essential spectrum, where the space changes at once, has no such
series, or a space that is not a projection of R: it is halved in vain. Behind one that was passed the next is doubled, so that a line away
from the essential spectrum takes as many panels as its length has doublings.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import Undecidable
from shootstab.problems.protocol import ComplexArray
from shootstab.problems.splitting import AsymptoticPencil

PANEL_DEGREE = 16  # chosen: degree of the series of f on a panel
PANEL_TAIL = 1e-8  # chosen: its last terms, times the length, where it is taken for integrated: what they leave in ∫f is 1/100 of that
PANEL_TAIL_TERMS = 3  # chosen: terms of the tail, for series that hold even or odd ones only
LEAST_PROJECTION = 1e-3  # chosen: the volume of the projection of a basis below which the space is another one
MOST_PANELS = 40  # chosen: panels tried on a line; away from the essential spectrum 30 octaves take 20
SLOW_PANELS = 12  # chosen: panels after which a line is left that runs along an essential spectrum, where panels do not grow
PANEL_GROWN = 4.0  # chosen: times the first panel, to which a panel has grown by then on a line that leads away from it
LEAST_PART = 1 / 64  # chosen: the part of a line that is passed by then where panels need not grow

Stop = Callable[[complex], bool]


def transported(
    limit: AsymptoticPencil, begin: complex, end: complex, R: ComplexArray, length: float, stop: Stop | None = None
) -> tuple[complex, complex, ComplexArray] | None:
    """Where the line from begin, with basis R (n, k), was left, ln det M there, and the basis (n, k); None where it is not passable.

    length is that of the first panel tried. The line is left at its end, or at the end of the first panel where stop says so.
    """
    here, logarithm, grows, first = begin, 0j, False, length
    for tried in range(MOST_PANELS):
        way = end - here
        if tried == SLOW_PANELS and length < PANEL_GROWN * first and abs(way) > (1.0 - LEAST_PART) * abs(end - begin):
            return None
        there = end if length >= abs(way) else here + length * way / abs(way)
        panel = _panel(limit, here, there, R)
        if panel is None:
            length, grows = 0.5 * length, False
            continue
        here, length, grows = there, 2.0 * length if grows else length, True
        logarithm, R = logarithm + panel[0], panel[1]
        if here == end or (stop is not None and stop(here)):
            return here, logarithm, R
    return None


def _panel(limit: AsymptoticPencil, begin: complex, end: complex, R: ComplexArray) -> tuple[complex, ComplexArray] | None:
    """ln det M and the basis at the end of a panel; None where the series of f has no end on it."""
    k, half = R.shape[1], 0.5 * (end - begin)
    nodes, to_series, weights = _chebyshev()
    try:
        f, volumes = slopes(limit, np.asarray(begin + half * (1.0 + nodes), dtype=np.complex128), R)
        split = limit.splitting(end, k)
    except Undecidable:
        return None
    if not np.isfinite(f).all() or not np.abs(volumes).min() > LEAST_PROJECTION:
        return None
    series = to_series @ f * half
    if not np.abs(series[-PANEL_TAIL_TERMS:]).max() <= PANEL_TAIL:
        return None
    determinant = complex(np.linalg.det(split.left @ R))
    return (np.log(determinant) - complex(weights @ f) * half, split.X) if determinant != 0.0 else None


@cache
def _chebyshev() -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Nodes (N + 1,) from −1 to 1, the matrix (N + 1, N + 1) from values to coefficients of T_m, and weights (N + 1,) of the integral."""
    m = np.arange(PANEL_DEGREE + 1)
    angles = np.pi * m[::-1] / PANEL_DEGREE
    ends = np.where(m % PANEL_DEGREE == 0, 0.5, 1.0)
    to_series = 2.0 / PANEL_DEGREE * np.outer(ends, ends) * np.cos(np.outer(m, angles))
    integrals = np.where(m % 2 == 0, 2.0 / (1.0 - np.minimum(m, m - m % 2) ** 2.0), 0.0)
    return np.cos(angles), to_series, integrals @ to_series


def slopes(limit: AsymptoticPencil, sigmas: ComplexArray, R: ComplexArray) -> tuple[ComplexArray, NDArray[np.float64]]:
    """f and the volume |det| of the projection of R (n, k) in an orthonormal basis of the space, each (m,), at sigmas (m,).

    Eigenvectors give them, and Schur forms where the eigenvectors are no basis. Raises Undecidable where there is no such space.
    """
    k = R.shape[1]
    A, slope = limit.matrices(sigmas)
    rates, V = np.linalg.eig(A)
    order = np.argsort(rates.real, axis=1)
    rates = np.take_along_axis(rates, order, axis=1)
    V = np.take_along_axis(V, order[:, None, :], axis=2)
    try:
        dual = np.linalg.inv(V)
    except np.linalg.LinAlgError:
        splits = [limit.splitting(s, k) for s in sigmas.tolist()]
        volumes = [abs(np.linalg.det(np.linalg.qr(split.X)[1] @ split.left @ R)) for split in splits]
        return np.array([split.slope(R) for split in splits]), np.array(volumes)
    B = dual[:, :k] @ slope @ V[:, :, k:]
    with np.errstate(divide="ignore", invalid="ignore"):
        G = B / (rates[:, :k, None] - rates[:, None, k:])
    if not np.isfinite(G).all():
        raise Undecidable("two rates that are to be told apart are one")
    seen = dual[:, :k] @ R
    try:
        inner = np.linalg.solve(seen, G @ (dual[:, k:] @ R))
    except np.linalg.LinAlgError:
        raise Undecidable("the spaces do not project onto one another") from None
    volumes = np.abs(np.linalg.det(np.linalg.qr(V[:, :, :k], mode="r") @ seen))
    return np.asarray(np.trace(inner, axis1=1, axis2=2)), volumes
