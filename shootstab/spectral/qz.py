"""A whole spectrum by QZ, and which of its eigenvalues a second truncation and the eigenvectors bear out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import InputError
from shootstab.spectral import chebyshev

DenseMatrix = NDArray[Any]
Assemble = Callable[[int], tuple[DenseMatrix, DenseMatrix]]
Unfold = Callable[[DenseMatrix], DenseMatrix]

SECOND_TRUNCATION = 1.2  # chosen: the second truncation over the first
TAIL_PART = 0.1  # chosen: the part of the coefficients that counts as the tail
FAINT = 1e-3  # chosen: a field smaller than this part of the largest is measured by the largest
DRIFT_TOLERANCE = 1e-5  # chosen: relative change of an eigenvalue between the two truncations with which it is kept
ROUNDING = 1e-12  # chosen: what QZ of matrices of some hundred rows leaves of an eigenvalue 0, in the median of all
MOST_ZERO = 4  # chosen: the multiplicity of an eigenvalue 0; that of a soliton with its symmetries is 4
OF_MEAN = 1e-2  # chosen: the mean of values that are one eigenvalue 0, at most, in the least of them
OF_DRIFT = 0.1  # chosen: how far they drift, at least, likewise
TAIL_TOLERANCE = 3e-4  # chosen: the tail of its eigenvector with which an eigenvalue is kept


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Eigenvalues of a discretized problem, most of which are not eigenvalues of the problem.

    raw (n,): all that are finite. eigenvalues (k,): those kept, by falling real part; drift (k,): distance of each to the nearest
    of the larger truncation; tail (k,): size of the last tenth of its Chebyshev coefficients against the largest, worst field.
    Unfiltered, eigenvalues is raw in that order, drift and tail are NaN, and larger_truncation is 0.
    """

    raw: NDArray[np.complex128]
    truncation: int
    eigenvalues: NDArray[np.complex128]
    drift: NDArray[np.float64]
    tail: NDArray[np.float64]
    larger_truncation: int = 0

    @property
    def rounding(self) -> float:
        """The drift of an eigenvalue that is 0 but for rounding."""
        return rounding(self.raw)


def rounding(raw: NDArray[np.complex128]) -> float:
    """A part of the median of the eigenvalues raw (n,); 0 where there are so many below it that they are a continuous spectrum."""
    size = ROUNDING * float(np.median(np.abs(raw))) if len(raw) else 0.0
    return size if np.count_nonzero(np.abs(raw) <= size) <= MOST_ZERO else 0.0


def multiple_zero(raw: NDArray[np.complex128], others: NDArray[np.complex128]) -> NDArray[np.intp]:
    """The places in raw (n,) of m values, 2 ≤ m ≤ MOST_ZERO, that are one eigenvalue 0 of a Jordan block of order m; (0,) if none are.

    An error δ of the matrices moves such an eigenvalue to the m values of δ^{1/m}, about 0 in all directions. So it is where the m
    smallest have the mean 0, their m-th power is small against the next value's, and they are others at another truncation.
    """
    order, theirs = np.argsort(np.abs(raw), kind="stable"), np.sort(np.abs(others))
    for m in range(2, min(MOST_ZERO + 1, len(raw), len(others))):
        cluster = raw[order[:m]]
        least, size, beyond = float(np.abs(cluster[0])), float(np.abs(cluster[-1])), float(np.abs(raw[order[m]]))
        alone = all(
            (one / next_one) ** m <= DRIFT_TOLERANCE for one, next_one in ((size, beyond), (theirs[m - 1], theirs[m])) if next_one > 0.0
        )
        if size > 0.0 and alone and abs(cluster.mean()) <= OF_MEAN * least and (_nearest(cluster, others) >= OF_DRIFT * least).all():
            return order[:m]
    return order[:0]


def spectrum(
    assemble: Assemble,
    M: int,
    unfold: Unfold,
    filtered: bool = True,
    drift_tolerance: float = DRIFT_TOLERANCE,
    tail_tolerance: float = TAIL_TOLERANCE,
) -> Spectrum:
    """The spectrum of A x = σ B x, (A, B) = assemble(M), by LAPACK's QZ; infinite eigenvalues are dropped.

    unfold takes eigenvectors (n, k) to coefficients (k, fields, modes), from low to high. Kept is an eigenvalue whose drift
    from M to ⌈1.2 M⌉ is at most drift_tolerance·|σ|, or rounding, and whose tail is at most tail_tolerance; the values of a multiple_zero
    are kept as 0. Unfiltered: one QZ, and no eigenvectors.
    """
    if not filtered:
        raw = _by_growth(_finite(*assemble(M))[0])
        unknown = np.full(len(raw), np.nan)
        return Spectrum(raw, M, raw, unknown, unknown)
    if not (drift_tolerance > 0.0 and tail_tolerance > 0.0):
        raise InputError(f"drift_tolerance = {drift_tolerance!r}, tail_tolerance = {tail_tolerance!r}: allowed are numbers above 0")
    larger = int(np.ceil(SECOND_TRUNCATION * M))
    others = _finite(*assemble(larger))[0]
    raw, vectors = _finite(*assemble(M), vectors=True)
    together = multiple_zero(raw, others)
    resolved = raw.copy()
    resolved[together] = 0.0
    drift = _nearest(raw, others)
    drift[together] = 0.0
    kept = np.flatnonzero(drift <= np.maximum(drift_tolerance * np.abs(raw), rounding(raw)))
    tail = tails_of(unfold(vectors[:, kept])) if kept.size else np.empty(0)
    kept, tail = kept[tail <= tail_tolerance], tail[tail <= tail_tolerance]
    order = np.argsort(-resolved[kept].real, kind="stable")
    kept = kept[order]
    return Spectrum(_by_growth(raw), M, resolved[kept], drift[kept], tail[order], larger)


def nearest(spectrum: Spectrum, guess: complex) -> complex:
    """The raw eigenvalue next to guess."""
    return complex(spectrum.raw[np.abs(spectrum.raw - guess).argmin()])


def union(parts: list[Spectrum]) -> Spectrum:
    """One spectrum from those of blocks that nothing couples."""
    raw = _by_growth(np.concatenate([p.raw for p in parts]))
    eigenvalues, drift, tail = (np.concatenate(columns) for columns in zip(*((p.eigenvalues, p.drift, p.tail) for p in parts), strict=True))
    order = np.argsort(-eigenvalues.real, kind="stable")
    return Spectrum(raw, parts[0].truncation, eigenvalues[order], drift[order], tail[order], parts[0].larger_truncation)


def tails(nodal: DenseMatrix) -> NDArray[np.float64]:
    """tails_of the Chebyshev coefficients of nodal values (k, fields, N + 1) on the extrema."""
    return tails_of(chebyshev.coefficients(nodal))


def tails_of(coefficients: DenseMatrix) -> NDArray[np.float64]:
    """(k,) from coefficients (k, fields, modes): the largest of the last tenth of them over the largest of all, in the worst field.

    Fields below FAINT of the largest field are noise as likely as not, and are measured against FAINT of it.
    """
    sizes = np.abs(coefficients)
    count = max(3, round(TAIL_PART * sizes.shape[-1]))
    largest = sizes.max(axis=-1)
    floor = FAINT * largest.max(axis=-1, keepdims=True)
    return np.asarray((sizes[..., -count:].max(axis=-1) / np.maximum(largest, floor)).max(axis=-1))


def _finite(A: DenseMatrix, B: DenseMatrix, vectors: bool = False) -> tuple[NDArray[np.complex128], DenseMatrix]:
    """Finite eigenvalues and, if asked for, their right eigenvectors as columns."""
    from scipy.linalg import eig, eigvals

    if vectors:
        sigma, x = eig(A, B, check_finite=False)
        finite = np.isfinite(sigma)
        return sigma[finite], x[:, finite]
    sigma = eigvals(A, B, check_finite=False)
    return sigma[np.isfinite(sigma)], np.empty((0, 0))


def _by_growth(sigma: NDArray[np.complex128]) -> NDArray[np.complex128]:
    return sigma[np.argsort(-sigma.real, kind="stable")]


def _nearest(sigma: NDArray[np.complex128], others: NDArray[np.complex128]) -> NDArray[np.float64]:
    return np.asarray(np.abs(sigma[:, None] - others[None, :]).min(axis=1))
