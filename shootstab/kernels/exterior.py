"""Exterior algebra: ∧^k Cⁿ in coordinates, and the matrix A^(k) that A induces on it, for any n and k.

The coordinates of a k-dimensional space, given by n×k Y, are its minors y_I = det Y[I, :] over the k-subsets I of the rows (Plücker
coordinates; Gilbert & Backus, Geophysics 31 (1966) 326, call them compound). ψ′ = Aψ moves them by y′ = A^(k) y,

    (A^(k) y)_I = Σ_{i∈I} Σ_j a_ij (−1)^(pos(i, I) + pos(j, J)) y_J,   J = I with i replaced by j,

so that A^(k) is the derivative of ∧^k exp(tA) at t = 0 (Ng & Reid, J. Comput. Phys. 30 (1979) 125 and 58 (1985) 209; Allen & Bridges,
Numer. Math. 92 (2002) 197). The lists of its entries are generated, never typed.
"""

from __future__ import annotations

import itertools
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from shootstab.kernels.elimination import det_with_slope

ComplexArray = NDArray[np.complex128]


class Induced(NamedTuple):
    """A^(k) as lists: for entry (i, j) of A, those from start[i, j] to start[i, j + 1] put sign · a_ij at (row, column).

    subsets (N, k) are the coordinates in lexicographic order; row, column, sign (M,); start (n, n + 1).
    """

    subsets: NDArray[np.int64]
    row: NDArray[np.int64]
    column: NDArray[np.int64]
    sign: NDArray[np.float64]
    start: NDArray[np.int64]


@lru_cache(maxsize=32)
def induced(n: int, k: int) -> Induced:
    """The lists of A^(k) for 0 < k ≤ n."""
    subsets = list(itertools.combinations(range(n), k))
    index = {subset: place for place, subset in enumerate(subsets)}
    row: list[int] = []
    column: list[int] = []
    sign: list[float] = []
    start = np.zeros((n, n + 1), dtype=np.int64)
    for i in range(n):
        for j in range(n):
            start[i, j] = len(row)
            for subset in subsets:
                if i not in subset or (j != i and j in subset):
                    continue
                other = tuple(sorted((*(s for s in subset if s != i), j)))
                row.append(index[subset])
                column.append(index[other])
                sign.append((-1.0) ** (subset.index(i) + other.index(j)))
        start[i, n] = len(row)
    lists = Induced(np.array(subsets), np.array(row), np.array(column), np.array(sign), start)
    for array in lists:
        array.flags.writeable = False
    return lists


@njit(cache=True, error_model="numpy")
def minors_with_slope(Y, dY, subsets):  # type: ignore[no-untyped-def]
    """The minors (N,) of complex n×k Y, the coordinates of its columns' span, and their derivatives; of a k×n W give Wᵀ.

    Cauchy–Binet: minors of Wᵀ · minors of Y = det(W Y).
    """
    count, k = subsets.shape
    y, dy = np.empty(count, dtype=np.complex128), np.empty(count, dtype=np.complex128)
    M, dM = np.empty((k, k), dtype=np.complex128), np.empty((k, k), dtype=np.complex128)
    for place in range(count):
        for a in range(k):
            for b in range(k):
                M[a, b], dM[a, b] = Y[subsets[place, a], b], dY[subsets[place, a], b]
        y[place], dy[place] = det_with_slope(M, dM)
    return y, dy


@njit(cache=True, error_model="numpy", fastmath={"contract"}, inline="always")
def apply(A, row, column, sign, start, y, out, place):  # type: ignore[no-untyped-def]
    """out[place] ← out[place] + A^(k) y, a loop over the entries of A that are not zero."""
    n = A.shape[0]
    for i in range(n):
        for j in range(n):
            a = A[i, j]
            if a != 0.0:
                for p in range(start[i, j], start[i, j + 1]):
                    out[place, row[p]] += (sign[p] * a) * y[column[p]]


@njit(cache=True, error_model="numpy")
def row_sizes(y, subsets, sizes):  # type: ignore[no-untyped-def]
    """sizes (n,) ← r_i, where r_i² = Σ_{I∋i} |y_I|² / Σ_I |y_I|²: the norms of the rows of an orthonormal frame of the space.

    (They are the diagonal of the orthogonal projection.) Returns Σ |y_I|².
    """
    sizes[:] = 0.0
    total = 0.0
    for place in range(len(y)):
        square = y[place].real ** 2 + y[place].imag ** 2
        total += square
        for c in range(subsets.shape[1]):
            sizes[subsets[place, c]] += square
    for i in range(len(sizes)):
        sizes[i] = np.sqrt(sizes[i] / total) if total > 0.0 else 0.0
    return total
