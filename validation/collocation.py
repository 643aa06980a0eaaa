"""Eigenvalues by Chebyshev collocation, from a pencil and its ends alone: the truth where there is no formula. Independent of shootstab.

(C0 + σ C1) ψ′ = (D0 + σ D1) ψ on elements. On each the n components are polynomials of degree N, given by their Chebyshev coefficients; the
equation holds at the N zeros of T_N, and n conditions an element (walls, continuity or interfaces) close the count n(N + 1): no row of a
square collocation matrix is thrown away (T. A. Driscoll & N. Hale, IMA J. Numer. Anal. 36 (2016) 108). Where an end is at infinity,
ψ at z = ±reach is made orthogonal to what the limiting matrix at the σ at hand lets grow, and σ is iterated.

An eigenvalue found in doubles is improved by Newton's method on (ψ, σ), with residuals in long double: the error is then that of the
truncation, which two resolutions show, and not the condition of the matrices.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

Array = NDArray[Any]
Real, Complex = np.longdouble, np.clongdouble
STEPS = 40  # chosen: the most steps of an iteration
SETTLED = 1e-13  # chosen: relative change of σ at which the iteration in doubles ends


@dataclass(frozen=True)
class Fixed:
    """(rows + σ moving) ψ = 0 at z."""

    z: float
    rows: Any
    moving: Any = None


@dataclass(frozen=True)
class Far:
    """Solutions decay beyond z; `decaying` of n do. The coefficients at z are taken for their limit."""

    z: float
    decaying: int


@dataclass(frozen=True)
class ElementJoint:
    """(before + σ before_moving) ψ(z−) + (behind + σ behind_moving) ψ(z+) = 0."""

    z: float
    before: Any
    behind: Any
    before_moving: Any = None
    behind_moving: Any = None


@dataclass(frozen=True)
class Discretization:
    """A σ-problem on elements between `left` and `right`, cut at the joints and at `cuts`; N is the degree of every element."""

    size: int
    pencil: Callable[[Any], Sequence[Any]]
    left: Fixed | Far
    right: Fixed | Far
    joints: tuple[ElementJoint, ...] = ()
    cuts: tuple[float, ...] = ()
    N: int = 32

    @property
    def breaks(self) -> list[float]:
        return sorted({self.left.z, self.right.z, *(j.z for j in self.joints), *self.cuts})

    def matrices(self, sigma: complex = 1.0) -> tuple[Array, Array]:
        """A, B (m, m) in long double with A x = σ B x; sigma is where the ends at infinity are taken."""
        n, N, breaks = self.size, self.N, self.breaks
        elements, width = len(breaks) - 1, n * (N + 1)
        A, B = (np.zeros((elements * width, elements * width), dtype=Complex) for _ in range(2))
        theta = (2 * np.arange(N, dtype=Real) + 1) * (np.arctan(Real(1)) * 4) / (2 * N)
        k = np.arange(N + 1, dtype=Real)
        T = np.cos(theta[:, None] * k)
        dT = k * np.sin(theta[:, None] * k) / np.sin(theta)[:, None]
        row = 0
        for e in range(elements):
            a, b = Real(breaks[e]), Real(breaks[e + 1])
            z = (a + b) / 2 + (b - a) / 2 * np.cos(theta)
            C0, C1, D0, D1 = (np.array(part, dtype=Complex) for part in zip(*(self._four(p) for p in z), strict=True))
            slope = dT * 2 / (b - a)
            at = slice(e * width, (e + 1) * width)
            # rows (point, equation), columns (component, coefficient)
            A[row : row + n * N, at] = _spread(C0, slope) - _spread(D0, T)
            B[row : row + n * N, at] = _spread(D1, T) - _spread(C1, slope)
            row += n * N
        for e, (end, sign) in ((0, (self.left, -1)), (elements - 1, (self.right, 1))):
            for fixed, out in zip(self._rows(end, sign, sigma), (A, -B), strict=True):
                block = _spread(fixed[None], (sign**k)[None])
                if out is A:
                    A[row : row + len(fixed), e * width : (e + 1) * width] = block
                else:
                    B[row : row + len(fixed), e * width : (e + 1) * width] = -block
            row += len(fixed)
        named = {j.z: j for j in self.joints}
        for e in range(elements - 1):
            z = breaks[e + 1]
            joint = named.get(z, ElementJoint(z, np.eye(n), -np.eye(n)))
            for side, part, moving, sign in ((e, joint.before, joint.before_moving, 1), (e + 1, joint.behind, joint.behind_moving, -1)):
                at = slice(side * width, (side + 1) * width)
                A[row : row + n, at] = _spread(np.array(part, dtype=Complex)[None], (Real(sign) ** k)[None])
                if moving is not None:
                    B[row : row + n, at] = -_spread(np.array(moving, dtype=Complex)[None], (Real(sign) ** k)[None])
            row += n
        if row != len(A):
            raise ValueError(f"{row} equations for {len(A)} unknowns")
        return A, B

    def spectrum(self, sigma: complex = 1.0) -> Array:
        """All finite eigenvalues in doubles, the ends at infinity taken at sigma."""
        A, B = _scaled(*(np.asarray(M, dtype=np.complex128) for M in self.matrices(sigma)))
        if not A.imag.any() and not B.imag.any():
            A, B = A.real, B.real
        values = scipy.linalg.eigvals(A, B)
        return np.asarray(values[np.isfinite(values)])

    def around(self, centre: float, largest: float, sigma: complex = 1.0) -> Array:
        """The eigenvalues with |σ − centre| < largest, from those of (A − centre·B)⁻¹B: a third of the work."""
        A, B = _scaled(*(np.asarray(M, dtype=np.complex128) for M in self.matrices(sigma)))
        if not A.imag.any() and not B.imag.any():
            A, B = A.real, B.real
        inverse = scipy.linalg.eigvals(scipy.linalg.lu_solve(_factored(A - centre * B), B))
        return np.asarray(centre + 1 / inverse[np.abs(inverse) > 1 / largest])

    def near(self, guess: complex, given: tuple[Array, Array] | None = None) -> complex:
        """The eigenvalue that inverse iteration from guess leads to, to long double's rounding of this discretization.

        given are its matrices, if they are at hand and do not depend on σ."""
        sigma = complex(guess)
        at_infinity = isinstance(self.left, Far) or isinstance(self.right, Far)
        exact: Any = sigma
        history: list[complex] = []
        for _ in range(STEPS if at_infinity else 1):
            A, B = given or self.matrices(sigma)
            exact = _improved(A, B, *_inverse_iteration(A, B, sigma))
            moved = abs(complex(exact) - sigma)
            history.append(sigma)
            sigma = complex(exact)
            if moved <= 1e-14 * abs(sigma):
                break
            if len(history) >= 3 and at_infinity:
                a, b, c = history[-2], history[-1], sigma
                if abs(c - 2 * b + a) > 1e-3 * abs(c - b) and abs(c - b) > 1e-14 * abs(c):
                    sigma = c - (c - b) ** 2 / (c - 2 * b + a)  # Aitken
                    history.clear()
        return complex(exact)

    def truth(self, guess: complex, finer: float = 1.4) -> tuple[complex, float]:
        """The eigenvalue near guess at finer·N, and by how much it moved from N."""
        coarse = self.near(guess)
        fine = replace(self, N=int(finer * self.N)).near(coarse)
        return fine, abs(fine - coarse)

    def _four(self, z: Any) -> tuple[Any, ...]:
        parts = tuple(self.pencil(z))
        return parts if len(parts) == 4 else (np.eye(self.size), np.zeros((self.size, self.size)), *parts)

    def _rows(self, end: Fixed | Far, sign: int, sigma: complex) -> tuple[Array, Array]:
        """The conditions at an end: fixed and times σ."""
        if isinstance(end, Fixed):
            W0 = np.array(end.rows, dtype=Complex)
            return W0, np.zeros_like(W0) if end.moving is None else np.array(end.moving, dtype=Complex)
        C0, C1, D0, D1 = (np.array(M, dtype=np.complex128) for M in self._four(Real(end.z)))
        M = np.linalg.solve(C0 + sigma * C1, D0 + sigma * D1)
        # a Schur form of Mᴴ: its first vectors span what is orthogonal to all but the solutions that grow outwards
        rates = np.sort(sign * np.linalg.eigvals(M).real)
        middle = 0.5 * (rates[end.decaying - 1] + rates[end.decaying]) if 0 < end.decaying < self.size else None
        grows = (lambda x: sign * x.real > middle) if middle is not None else (lambda x: end.decaying == 0)
        _, Z, held = scipy.linalg.schur(M.conj().T, output="complex", sort=grows)
        if held != self.size - end.decaying:
            raise ValueError(f"{held} solutions grow at z = {end.z}, not {self.size - end.decaying}")
        W0 = np.array(Z[:, :held].conj().T, dtype=Complex)
        return W0, np.zeros_like(W0)


def stretched(pencil: Callable[[Any], Sequence[Any]], reach: float, width: float = 1.0) -> Callable[[Any], Sequence[Any]]:
    """The pencil in t, z = width sinh(κt), −1 ≤ t ≤ 1 for −reach ≤ z ≤ reach: one element resolves what happens near z = 0."""
    kappa = np.arcsinh(Real(reach) / Real(width))

    def mapped(t: Any) -> Sequence[Any]:
        *C, D0, D1 = pencil(Real(width) * np.sinh(kappa * t))
        slope = Real(width) * kappa * np.cosh(kappa * t)
        return (*C, slope * np.asarray(D0), slope * np.asarray(D1))

    return mapped


def _spread(M: Array, T: Array) -> Array:
    """Matrices (p, r, n) at p points and polynomials (p, k) there as rows (p·r) and columns (n·k)."""
    p, r, n = M.shape
    return np.asarray((M[:, :, :, None] * T[:, None, None, :]).reshape(p * r, n * T.shape[1]))


def _scaled(A: Array, B: Array) -> tuple[Array, Array]:
    """Rows of size one."""
    size = np.maximum(np.abs(A).max(axis=1), np.abs(B).max(axis=1))
    return A / size[:, None], B / size[:, None]


def _inverse_iteration(A: Array, B: Array, sigma: complex) -> tuple[Array, complex]:
    """ψ and σ in doubles."""
    a, b = _scaled(np.asarray(A, dtype=np.complex128), np.asarray(B, dtype=np.complex128))
    x = np.random.default_rng(1).standard_normal(len(a)) + 0j
    shift = sigma * (1 + 1e-9) + 1e-30
    for round_ in range(4):
        lu = _factored(a - shift * b)
        new = shift
        before = new
        for _ in range(6 if round_ == 0 else 3):
            y = scipy.linalg.lu_solve(lu, b @ x)
            before, new = new, shift + np.vdot(y, x) / np.vdot(y, y)
            x = y / np.linalg.norm(y)
        if abs(new - before) <= 1e-8 * (abs(new) + 1e-3 * abs(sigma)):
            return x, complex(new)  # near enough for Newton's method
        if abs(new - shift) <= SETTLED * (abs(new) + 1e-3 * abs(sigma)):
            return x, complex(new)
        shift = complex(new)
    return x, complex(shift)


def _factored(M: Array) -> Any:
    """LU factors; a pivot that is zero, where the shift is an eigenvalue to the last bit, is replaced by rounding."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", scipy.linalg.LinAlgWarning)
        lu, pivots = scipy.linalg.lu_factor(M)
    small = np.flatnonzero(np.abs(np.diag(lu)) < 1e-30)
    lu[small, small] = 1e-17 * np.abs(M).max()
    return lu, pivots


def _improved(A: Array, B: Array, x: Array, sigma: complex) -> Any:
    """σ after Newton's method on (A − σB)x = 0, vᴴx = 1, residuals in long double, corrections in double."""
    size = np.maximum(np.abs(A).max(axis=1), np.abs(B).max(axis=1))
    A, B = A / size[:, None], B / size[:, None]
    x = np.asarray(x, dtype=Complex) / np.linalg.norm(np.asarray(x, dtype=np.complex128))
    v = x.conj().copy()
    s: Any = Complex(sigma)
    m = len(A)
    K = np.empty((m + 1, m + 1), dtype=np.complex128)
    K[:m, :m], K[:m, m], K[m, :m], K[m, m] = A - s * B, -(B @ x), v, 0.0
    lu = scipy.linalg.lu_factor(K)
    best, smallest = s, np.inf
    for _ in range(12):
        r = np.append(A @ x - s * (B @ x), v @ x - 1)
        d = scipy.linalg.lu_solve(lu, np.asarray(-r, dtype=np.complex128))
        x = x + d[:m]
        s = s + d[m]
        if abs(d[m]) < smallest:
            best, smallest = s, abs(d[m])
        elif smallest < 1e-15 * abs(s) or abs(d[m]) > 100 * smallest:
            break
    return best
