"""Chebyshev collocation on [−1, 1] and on an interval mapped from it.

Points are numbered from y = 1 down, as cosines come. Source: L. N. Trefethen, Spectral Methods in MATLAB (SIAM 2000), ch. 6;
J. A. C. Weideman & S. C. Reddy, ACM TOMS 26 (2000) 465; J.-P. Berrut & L. N. Trefethen, SIAM Rev. 46 (2004) 501.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

RealArray = NDArray[np.float64]


def extrema(degree: int) -> RealArray:
    """y_j = cos(πj/N), j = 0 … N: the N + 1 Gauss–Lobatto points (N + 1,), exactly antisymmetric."""
    j = np.arange(degree + 1)
    return np.asarray(np.sin(np.pi * (degree - 2 * j) / (2 * degree)))


def roots(degree: int) -> RealArray:
    """The zeros of T_{N+1}, cos(π(2j + 1)/(2N + 2)), j = 0 … N: the Gauss points (N + 1,)."""
    j = np.arange(degree + 1)
    return np.asarray(np.sin(np.pi * (degree - 2 * j) / (2 * degree + 2)))


@lru_cache(maxsize=16)
def differentiation(degree: int) -> RealArray:
    """D (N + 1, N + 1), to be read only, with (D f)_i = f′(y_i) on the extrema, for every polynomial f of degree ≤ N.

    D_ij = (c_i/c_j)(−1)^{i+j}/(y_i − y_j), c = 2 at both ends and 1 between them. The differences are taken as products of sines
    and the diagonal as the negative sum of its row, so that constants have the derivative zero to rounding.
    """
    j = np.arange(degree + 1)
    angle = np.pi / (2 * degree)
    total, gap = np.add.outer(j, j), np.subtract.outer(j, j)
    differences = -2 * np.sin(angle * total) * np.sin(angle * gap)
    # sin(angle·total) loses digits as total nears 2N: take those rows from the flipped half
    upper = total <= degree
    differences = np.where(upper, differences, -2 * np.sin(angle * (2 * degree - total)) * np.sin(angle * gap))
    np.fill_diagonal(differences, 1.0)
    weights = np.where((j == 0) | (j == degree), 2.0, 1.0) * (-1.0) ** j
    D: RealArray = np.divide.outer(weights, weights) / differences
    np.fill_diagonal(D, 0.0)
    np.fill_diagonal(D, -D.sum(axis=1))
    D.flags.writeable = False
    return D


def interpolation(degree: int, y: RealArray) -> RealArray:
    """The matrix (m, N + 1) from values on the extrema to values at y (m,), by the second barycentric formula."""
    nodes, j = extrema(degree), np.arange(degree + 1)
    weights = (-1.0) ** j * np.where((j == 0) | (j == degree), 0.5, 1.0)
    differences = np.subtract.outer(np.asarray(y, dtype=np.float64), nodes)
    exact = differences == 0.0
    terms = weights / np.where(exact, 1.0, differences)
    matrix: RealArray = terms / terms.sum(axis=1, keepdims=True)
    hit = exact.any(axis=1)
    matrix[hit] = exact[hit]
    return matrix


def coefficients(values: NDArray[Any]) -> NDArray[Any]:
    """Chebyshev coefficients (…, N + 1) of the interpolant with these values on the extrema: f = Σ a_n T_n(y)."""
    degree = values.shape[-1] - 1
    return np.asarray(values @ _to_coefficients(degree).T)


def values(coefficients: NDArray[Any]) -> NDArray[Any]:
    """The inverse of `coefficients`: Σ a_n T_n at the extrema, both of shape (…, N + 1)."""
    degree = coefficients.shape[-1] - 1
    return np.asarray(coefficients @ _cosines(degree))


def _cosines(degree: int) -> RealArray:
    """T_n(y_j) = cos(πnj/N); the product is reduced modulo 2N before it is multiplied by π."""
    j = np.arange(degree + 1)
    return np.cos(np.pi * (np.multiply.outer(j, j) % (2 * degree)) / degree)


@lru_cache(maxsize=16)
def _to_coefficients(degree: int) -> RealArray:
    halves = np.ones(degree + 1)
    halves[[0, -1]] = 0.5
    matrix: RealArray = 2 / degree * halves[:, None] * _cosines(degree) * halves
    matrix.flags.writeable = False
    return matrix


@dataclass(frozen=True, eq=False)
class ChebyshevGrid:
    """Collocation on z(y): points z (N + 1,), z[0] at y = 1, and D = d/dz (N + 1, N + 1)."""

    z: RealArray
    D: RealArray

    @property
    def degree(self) -> int:
        """N."""
        return len(self.z) - 1


def interval(degree: int, first: float = 1.0, last: float = -1.0) -> ChebyshevGrid:
    """The grid on [first, last] by the linear map that takes y = 1 to first and y = −1 to last."""
    y = extrema(degree)
    return ChebyshevGrid((first + last) / 2 + (first - last) / 2 * y, 2 / (first - last) * differentiation(degree))


def malik(degree: int, z_max: float, z_half: float, focus: float = 0.0) -> ChebyshevGrid:
    """Malik's grid, (2.18)–(2.19) of Woodhouse & Hogg (2010), on [0, z_m]: z = 0 at x = 1, z_h at x = 0, z_m at x = −1.

    With s = (1 − y)/2 = 1 − ζ1 the inverse of (2.18) is z = z_m z_h s/(z_m − z_h + (2z_h − z_m)s), which is regular at
    z_h = z_m/2 too, where a and b of (2.19) are not. The paper has y = x, the points of `extrema`. With focus β > 0 comes
    y = tan(x arctan β)/β before it, which packs points around z_h, more closely by the factor arctan(β)/β.

    Source: M. R. Malik, J. Comput. Phys. 86 (1990) 376; A. Bayliss & E. Turkel, J. Comput. Phys. 101 (1992) 349.
    """
    x = extrema(degree)
    if focus > 0.0:
        angle = np.arctan(focus)
        y, y_x = np.tan(angle * x) / focus, angle / focus / np.cos(angle * x) ** 2
        s = (1 - y) / 2
    else:
        s, y_x = np.sin(np.pi * np.arange(degree + 1) / (2 * degree)) ** 2, np.ones(degree + 1)
    s[0], s[-1] = 0.0, 1.0
    denominator = z_max - z_half + (2 * z_half - z_max) * s
    z_x = -0.5 * z_max * z_half * (z_max - z_half) / denominator**2 * y_x
    z = z_max * z_half * s / denominator
    z[-1] = z_max
    return ChebyshevGrid(z, differentiation(degree) / z_x[:, None])
