"""The curve σ_c(z) on which C(σ) is singular, from the pencil itself.

With σ_j(z) the zeros of det C(σ), as often as they are such,

    tr[C⁻¹ dC/dσ] = Σ_j 1/(σ − σ_j),

so that one curve of multiplicity m has tr = m/(σ − σ_c): two values of σ give both, a third tests it. No eigenvalue at infinity, of
which a singular leading coefficient has many, ever enters, and σ_c is as analytic in z as the pencil is.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from shootstab.core import polynomial
from shootstab.core.errors import InputError
from shootstab.problems.pencil_function import PencilFunction
from shootstab.problems.protocol import ComplexArray

# chosen: σ of no property, in the scale that the sizes of C0, C1, … give
PROBE_SIGMAS = np.array([0.83 + 1.31j, -1.17 + 0.59j, 0.41 - 1.73j])
TRACE_NOISE = 1e-9  # chosen: relative, what is told from 0 or from another number in the trace; a solve of a good C leaves 1e-14
CURVE_PROBES = 65  # chosen: points of a subdomain at which the pencil is asked for curves
DIFFERENCE_STEP = 1e-5  # chosen: step, in the subdomain, by which derivatives along and across the real axis are compared
ANALYTIC_TOLERANCE = 1e-4  # chosen: relative; differences err by DIFFERENCE_STEP² and by rounding over DIFFERENCE_STEP
COMPARED_AT = (0.137, 0.419, 0.731)  # chosen: places in the subdomain at which they are compared
MULTIPLICITY_NOISE = 1e-6  # chosen: the distance of a multiplicity from a whole number, and of the trace from its pole, that rounding makes


@dataclass(frozen=True, eq=False)
class SingularCurve:
    """One curve of multiplicity m; scale is a size of σ on it."""

    pencil: PencilFunction
    scale: float
    multiplicity: int

    def __call__(self, z: Any) -> ComplexArray:
        """σ_c at a point or at points z (p,), real or complex."""
        sigma, points = self.scale * PROBE_SIGMAS[0], np.atleast_1d(np.asarray(z, dtype=np.complex128))
        curve = sigma - self.multiplicity / traces(self.pencil, points, np.array([sigma]))[0]
        return np.asarray(curve.reshape(np.shape(z)))


@dataclass(frozen=True, eq=False)
class ContinuumOnLine:
    """σ_c(z) as somebody gave it, or a SingularCurve; the spectrum is its image of the real line from low to high."""

    curve: Callable[[Any], Any]
    vectorized: bool
    low: float
    high: float

    def heights(self, points: int) -> NDArray[np.float64]:
        return np.linspace(self.low, self.high, points)

    def __call__(self, z: ComplexArray) -> ComplexArray:
        """σ_c (m,) at points z (m,). Raises InputError where the function gives no numbers."""
        given = self.curve(z) if self.vectorized else [self.curve(p) for p in z.tolist()]
        sigma = np.asarray(given, dtype=np.complex128)
        if sigma.shape != z.shape or not np.isfinite(sigma).all():
            raise InputError("continuum(z) is not a finite number for every z: allowed is a function that gives σ_c at z")
        return sigma


def traces(function: PencilFunction, z: ComplexArray, sigmas: ComplexArray) -> ComplexArray:
    """tr[C⁻¹ dC/dσ] for sigmas (s,) at points z (p,): (s, p). Not finite where C is singular at one of these σ."""
    C = function(z).C
    with np.errstate(all="ignore"):
        try:
            solved = [np.linalg.solve(polynomial.value(C, sigma), polynomial.slope(C, sigma)) for sigma in sigmas.tolist()]
        except np.linalg.LinAlgError:
            return np.full((len(sigmas), len(z)), np.nan + 0j)
    return np.asarray(np.trace(np.array(solved), axis1=2, axis2=3))


def singular_curves(function: PencilFunction, z: ComplexArray) -> SingularCurve | tuple[ComplexArray, ...]:
    """The one curve that there is over a line z (p,), or every curve by its σ (p,) at these points; an empty tuple if there is none.

    It is one that a path in z may lead around if it is not constant and the pencil is analytic next to the line.
    """
    C = function(z).C
    scale = polynomial.size_of_root([float(np.abs(M).max()) for M in C])
    if scale == 0.0:
        return ()
    t = scale * traces(function, z, np.asarray(scale * PROBE_SIGMAS, dtype=np.complex128))
    if not np.isfinite(t).all() or np.abs(t).max() < TRACE_NOISE:
        return ()
    with np.errstate(all="ignore"):
        m = (PROBE_SIGMAS[0] - PROBE_SIGMAS[1]) / (1.0 / t[0] - 1.0 / t[1])
        sigma = PROBE_SIGMAS[0] - m / t[0]
        off = np.abs(t[2] - m / (PROBE_SIGMAS[2] - sigma)) / np.abs(t[2])
    multiplicity = round(float(m[0].real)) if np.isfinite(m[0]) else 0
    if multiplicity < 1 or not (np.abs(m - multiplicity) < MULTIPLICITY_NOISE).all() or not (off < MULTIPLICITY_NOISE).all():
        return _several(C)
    if np.ptp(np.abs(sigma - sigma[0])) > TRACE_NOISE * max(1.0, float(np.abs(sigma).max())) and _analytic(function, z):
        return SingularCurve(function, scale, multiplicity)
    return (np.asarray(scale * sigma),)


def _several(C: Sequence[ComplexArray]) -> tuple[ComplexArray, ...]:
    """The curves that are finite everywhere, joined from point to point by the least total distance."""
    from scipy.optimize import linear_sum_assignment

    pairs = zip(*polynomial.companion(C), strict=True)
    alphas, betas = zip(*(scipy.linalg.eig(a, b, right=False, homogeneous_eigvals=True) for a, b in pairs), strict=True)
    size = np.abs(np.array(betas)) / np.hypot(np.abs(np.array(alphas)), np.abs(np.array(betas)))
    count = int((size > np.sqrt(TRACE_NOISE)).sum(axis=1).min())
    rows: list[ComplexArray] = []
    for alpha, beta, finite in zip(alphas, betas, size, strict=True):
        keep = np.argsort(finite)[::-1][:count]
        sigma = alpha[keep] / beta[keep]
        if rows:
            _, order = linear_sum_assignment(np.abs(np.subtract.outer(rows[-1], sigma)))
            sigma = sigma[order]
        rows.append(sigma)
    return tuple(np.array(rows, dtype=np.complex128).T) if count else ()


def _analytic(function: PencilFunction, z: ComplexArray) -> bool:
    """Whether the pencil takes complex z and obeys the equations of Cauchy and Riemann: f_x = f_y/i."""
    length = complex(z[-1] - z[0])
    places = z[0] + length * np.array(COMPARED_AT)
    h = DIFFERENCE_STEP * abs(length)
    try:
        along, across = (_difference(function, places, step) for step in (h + 0j, 1j * h))
    except Exception:  # whatever a function of real z raises for a complex one, it does not take it
        return False
    return bool(np.abs(along - across).max() <= ANALYTIC_TOLERANCE * max(float(np.abs(along).max()), float(np.abs(across).max())))


def _difference(function: PencilFunction, places: ComplexArray, step: complex) -> NDArray[np.complex128]:
    """The derivative of C0, C1, …, D0, … by a central difference, (2q, p, n, n)."""
    ahead, behind = (function(places + sign * step).named for sign in (1, -1))
    return np.array([(ahead[name] - behind[name]) / (2.0 * step) for name in ahead])
