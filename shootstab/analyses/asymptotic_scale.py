"""The |σ| from which on σ rules everywhere: a problem of several scales of time has no law of growth before the last of them.

Where |σ| is large, the rates λ of (C(σ) λ − D(σ)) ψ = 0 at every z follow powers of σ or are constants, and in every condition at the end
the terms with σ, or those without, prevail for each of these solutions. A rate that is a constant for small |σ| because a slow part of
the problem does not feel σ yet (y″ = (εσ − V) y up to |σ| = V/ε) is told from one that stays so by following all of them to far larger |σ|.
"""

from __future__ import annotations

import math

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from shootstab.core.polynomial import companion, value
from shootstab.problems.capabilities import PLACEMENTS
from shootstab.problems.protocol import GENERIC_SIGMA, ComplexArray, Pencil, Problem

SCALE_RATIO = 8.0  # chosen: ratio of neighbouring |σ|
SIGMA_SCALES = 0.01 * SCALE_RATIO ** np.arange(17.0)  # chosen: |σ| that are compared, up to 2.8e12
SIGMA_DIRECTIONS = np.exp(1j * np.array([0.0, 0.4, -0.4]) * math.pi)  # chosen: directions of σ, away from the essential spectrum
RATE_POINTS = 17  # chosen: z at which rates are taken, of the first mesh
ANOTHER_POWER = 0.25  # chosen: difference of exponents that counts: those of rates differ by 1/4 or more
RATE_NOISE = 1e-10  # chosen: part of the largest rate below which others are noise of rounding
CONDITION_NOISE = 1e-12  # chosen: part of the terms with σ of all conditions below which one is noise of rounding
CROSSED_BY = 4.0  # chosen: factor by which a ratio of τ to σ has changed where it is not near 1 by chance
BEGIN_ACCURACY = 1e-8  # chosen: accuracy of the far frame that places the first end


def asymptotic_scale(problem: Problem, known: float = 0.0) -> float:
    """The least of SIGMA_SCALES, not below the known one, from which on rates and conditions are as at the largest.

    Infinite where they are not even next to that, and where C is singular at a z at which rates are taken.
    """
    scales = SIGMA_SCALES[known <= SIGMA_SCALES]
    points = problem.mesh(problem.start(GENERIC_SIGMA, BEGIN_ACCURACY))
    z = points[np.unique(np.linspace(0, len(points) - 1, RATE_POINTS).round().astype(int))].astype(np.complex128)
    sigmas = np.asarray(scales[:, None] * SIGMA_DIRECTIONS, dtype=np.complex128)
    try:
        matrices = _matrices(problem.pencil(z), sigmas)
    except np.linalg.LinAlgError:
        return math.inf
    if not np.isfinite(matrices).all():
        return math.inf
    arriving = _arriving(problem, points, matrices[:, :, 0], matrices[:, :, -1])
    settled = _rates_settled(matrices) & _conditions_settled(problem.wall_rows(), arriving, sigmas)
    last = np.flatnonzero(~settled)
    if len(last) == 0:
        return float(scales[0])
    return float(scales[last[-1] + 1]) if last[-1] + 2 < len(scales) else math.inf


def _matrices(pencil: Pencil, sigmas: ComplexArray) -> ComplexArray:
    """C(σ)⁻¹ D(σ), (scales, directions, m, n, n)."""
    C, D = (value(part, sigmas[..., None, None, None]) for part in (pencil.C, pencil.D))
    return np.asarray(np.linalg.solve(C, D))


def _rates_settled(matrices: ComplexArray) -> NDArray[np.bool_]:
    """Whether from each scale to the next |λ| of all rates rise by their last power of σ, (scales,)."""
    size = np.sort(np.abs(np.linalg.eigvals(matrices)), axis=-1)
    known = size > RATE_NOISE * size[..., -1:]
    powers = np.diff(np.log(np.where(known, size, 1.0)), axis=0) / math.log(SCALE_RATIO)
    known = known[1:] & known[:-1]
    last = np.zeros_like(powers[0])
    for power, sure in zip(powers, known, strict=True):
        last = np.where(sure, power, last)
    changes = known & (np.abs(powers - last) > ANOTHER_POWER)
    return np.append(~changes.any(axis=(1, 2, 3)), True)


def _conditions_settled(rows: tuple[ComplexArray, ...], arriving: ComplexArray, sigmas: ComplexArray) -> NDArray[np.bool_]:
    """Whether each τ with det((W_0 + τ W_1 + …) E) = 0, E the solutions that arrive, lies as it does at last: beyond σ, or within.

    τ is the eigenvalue that the conditions would have, were σ elsewhere given: where |τ| is far larger than |σ| they do not feel σ yet.
    """
    if all(not W.any() for W in rows[1:]):
        return np.ones(len(sigmas), dtype=np.bool_)
    A, B = companion([W @ arriving for W in rows])
    alpha, beta = (np.empty(A.shape[:-1], dtype=np.complex128) for _ in range(2))
    for at in np.ndindex(A.shape[:-2]):
        alpha[at], beta[at] = scipy.linalg.eig(A[at], B[at], right=False, homogeneous_eigvals=True)
    beta = np.where(np.abs(beta) > CONDITION_NOISE * np.linalg.norm(B, axis=(-2, -1))[..., None], beta, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        beyond = np.sort(np.log(np.abs(alpha)) - np.log(np.abs(beta) * np.abs(sigmas)[..., None]), axis=-1)
        crossed = (np.sign(beyond) != np.sign(beyond[-1])) & ~(np.abs(beyond - beyond[-1]) < math.log(CROSSED_BY))
    return np.asarray(~crossed.any(axis=(1, 2)))


def _arriving(problem: Problem, points: NDArray[np.float64], first: ComplexArray, last: ComplexArray) -> ComplexArray:
    """A basis of the solutions that prevail at the end, (scales, directions, n, k), by the rates there.

    Where a subdomain carries along what it begins with, solutions that decay on the way prevail in that.
    """
    forth = math.copysign(1.0, points[-1] - points[0])
    frame = problem.far_frame(float(points[0]), GENERIC_SIGMA).frame
    found, end = [], 0
    for own in [slice(p.first, p.first + p.size) for p in PLACEMENTS.of(problem)] or [slice(0, problem.size)]:
        n = own.stop - own.start
        there = last[..., own, own] * forth
        carried = own.start > end
        rising = int(frame[own].any(axis=0).sum()) if not carried else None
        basis, count = _rising(there, rising)
        found.append(_placed(basis, own, problem.size))
        if carried:
            found.append(_placed(_rising(-first[..., own, own] * forth, n - count)[0], slice(end, own.start), problem.size))
        end = own.stop
    return np.concatenate(found, axis=-1)


def _rising(matrices: ComplexArray, count: int | None) -> tuple[ComplexArray, int]:
    """A basis (…, n, count) of the solutions of so many largest growth rates, by default of those that grow at the last."""
    if count is None:
        count = int((np.linalg.eigvals(matrices[-1, 0]).real > 0.0).sum())
    n = matrices.shape[-1]
    out = np.empty((*matrices.shape[:-1], count), dtype=np.complex128)
    for at in np.ndindex(matrices.shape[:-2]):
        growth = np.sort(np.linalg.eigvals(matrices[at]).real)
        between = 0.5 * (growth[n - count - 1] + growth[n - count]) if 0 < count < n else -math.inf
        balanced, (units, _) = scipy.linalg.matrix_balance(matrices[at], permute=False, separate=True)
        _, basis, _ = scipy.linalg.schur(balanced, output="complex", sort=lambda rate, b=between: rate.real > b)
        out[at] = units[:, None] * basis[:, :count]
    return out, count


def _placed(basis: ComplexArray, where: slice, size: int) -> ComplexArray:
    """The basis (…, n, m) among the components of the whole, (…, size, m)."""
    out = np.zeros((*basis.shape[:-2], size, basis.shape[-1]), dtype=np.complex128)
    out[..., where, :] = basis
    return out
