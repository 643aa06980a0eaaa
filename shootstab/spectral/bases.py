"""Functions in which unknowns are expanded on an interval, a half-line, the line or a period, and the points at which equations hold.

Each basis has `points(count)` and `matrix(points, shape, order)`, the order-th derivative along z of its functions there. Between finite
ends they are T_0 … T_{d−1} and the d-fold integrals of T_0, T_1, …, which span the polynomials too; the matrix of a d-th derivative is
then as well conditioned as that of the identity. On an unbounded domain they vanish at infinity and are rational in z: with y
the Chebyshev variable and L a length,

    half-line  z = a ± L (1 + y)/(1 − y),   φ_n = ½ (1 − y) T_n(y)
    line       z = c + L cot θ,             φ_n = sin (n + 1)θ

so that what decays exponentially is smooth up to the end and asks for no condition there, and what grows is no sum of them.

Sources: L. Greengard, SIAM J. Numer. Anal. 28 (1991) 1071 (integrals); J. P. Boyd, J. Comput. Phys. 69 (1987) 112 and 70 (1987) 63;
Chebyshev and Fourier Spectral Methods (Dover 2001), ch. 17.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.polynomial import chebyshev as series
from numpy.polynomial import polynomial
from numpy.typing import NDArray

from shootstab.spectral import chebyshev

RealArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class BasisPoints:
    """Points z (m,), and what the basis itself computes with: x (m,), the variable or the angle of which it holds polynomials or waves."""

    z: RealArray
    x: RealArray


@dataclass(frozen=True)
class BasisExtent:
    """How many functions an unknown is expanded in, and how many derivatives of it are to be well conditioned: width and d."""

    width: int
    derivatives: int = 0


class Basis(Protocol):
    """Functions on one domain."""

    def points(self, count: int) -> BasisPoints:
        """Where equations hold, all inside."""
        ...

    def end(self, side: int) -> BasisPoints:
        """The end at that side, −1 or 1, where it is finite."""
        ...

    def matrix(self, at: BasisPoints, shape: BasisExtent, order: int) -> RealArray:
        """(m, width)."""
        ...

    def series(self, shape: BasisExtent) -> RealArray:
        """(width, width): what takes coefficients to those of a series whose fall tells whether a function is resolved."""
        ...


@dataclass(frozen=True, eq=False)
class Interval:
    """Chebyshev polynomials between two finite ends, x = y."""

    low: float
    high: float

    def points(self, count: int) -> BasisPoints:
        """The zeros of T_count."""
        y = chebyshev.roots(count - 1)
        return BasisPoints(0.5 * (self.low + self.high) + 0.5 * (self.high - self.low) * y, y)

    def end(self, side: int) -> BasisPoints:
        """An end."""
        return BasisPoints(np.array([self.low if side < 0 else self.high]), np.array([float(side)]))

    def matrix(self, at: BasisPoints, shape: BasisExtent, order: int) -> RealArray:
        """The derivatives of T_n, n < d, and the integrals, d − order times, of T_0, T_1, …"""
        table = _integrals(shape, order)
        return np.asarray(series.chebvander(at.x, len(table) - 1) @ table) * (2 / (self.high - self.low)) ** order

    def series(self, shape: BasisExtent) -> RealArray:
        """Chebyshev coefficients."""
        return _integrals(shape, 0)


@dataclass(frozen=True, eq=False)
class HalfLine:
    """Rational Chebyshev functions from a finite end to infinity on that side, −1 or 1; x = 1 − y, without its rounding."""

    finite: float
    side: int
    length: float

    def points(self, count: int) -> BasisPoints:
        """Half of them nearer than the length."""
        x = 2 * np.sin(0.25 * np.pi * (2 * np.arange(count) + 1) / count) ** 2
        return BasisPoints(self.finite + self.side * self.length * (2 - x) / x, x)

    def end(self, side: int) -> BasisPoints:
        """The finite end."""
        assert side == -self.side
        return BasisPoints(np.array([self.finite]), np.array([2.0]))

    def series(self, shape: BasisExtent) -> RealArray:
        """The coefficients themselves."""
        return np.eye(shape.width)

    def matrix(self, at: BasisPoints, shape: BasisExtent, order: int) -> RealArray:
        """d/dz = side · x²/(2L) d/dy, applied to ½ x T_n: Σ c_m(x) T_n^{(m)}(y), c polynomials in x, dc/dy = −dc/dx."""
        slope = np.array([0.0, 0.0, 0.5 * self.side / self.length])
        factors = [np.array([0.0, 0.5])]
        for _ in range(order):
            fallen = [polynomial.polyder(c) for c in factors] + [np.zeros(1)]
            raised = [np.zeros(1), *factors]
            factors = [polynomial.polymul(slope, polynomial.polysub(a, b)) for a, b in zip(raised, fallen, strict=True)]
        terms = [polynomial.polyval(at.x, c)[:, None] * _derived(1 - at.x, shape.width, m) for m, c in enumerate(factors)]
        return np.asarray(np.sum(terms, axis=0))


@dataclass(frozen=True, eq=False)
class Line:
    """Rational Chebyshev functions between two infinite ends, x = θ."""

    centre: float
    length: float

    def points(self, count: int) -> BasisPoints:
        """Half of them nearer to the centre than the length."""
        theta = 0.5 * np.pi * (2 * np.arange(count) + 1) / count
        return BasisPoints(self.centre + self.length / np.tan(theta), theta)

    def end(self, side: int) -> BasisPoints:
        """None is finite."""
        raise AssertionError(f"the line has no end at {side}")

    def series(self, shape: BasisExtent) -> RealArray:
        """The coefficients themselves."""
        return np.eye(shape.width)

    def matrix(self, at: BasisPoints, shape: BasisExtent, order: int) -> RealArray:
        """d/dz = −sin²θ/L d/dθ, applied to sin kθ: Σ f_m(θ) ∂_θ^m sin kθ, f polynomials in sin θ and cos θ."""
        factors: list[dict[tuple[int, int], float]] = [{(0, 0): 1.0}]
        for _ in range(order):
            factors = [_slowed(_sum(a, _turned(b)), self.length) for a, b in zip([{}, *factors], [*factors, {}], strict=True)]
        sine, cosine, k = np.sin(at.x), np.cos(at.x), np.arange(1, shape.width + 1)
        total = np.zeros((len(at.x), shape.width))
        for m, factor in enumerate(factors):
            f = sum((c * sine**a * cosine**b for (a, b), c in factor.items()), np.zeros(len(sine)))
            total += f[:, None] * k**m * np.sin(np.multiply.outer(at.x, k) + 0.5 * np.pi * m)
        return total


@dataclass(frozen=True, eq=False)
class Period:
    """Fourier's series 1, cos x, sin x, cos 2x, … over a period, x the angle."""

    low: float
    high: float

    def points(self, count: int) -> BasisPoints:
        """Equidistant."""
        x = 2 * np.pi * np.arange(count) / count
        return BasisPoints(self.low + (self.high - self.low) * np.arange(count) / count, x)

    def end(self, side: int) -> BasisPoints:
        """Nothing holds at an end alone."""
        raise AssertionError(f"a period has no end at {side}")

    def series(self, shape: BasisExtent) -> RealArray:
        """The coefficients themselves."""
        return np.eye(shape.width)

    def matrix(self, at: BasisPoints, shape: BasisExtent, order: int) -> RealArray:
        """∂^m cos kx = k^m cos(kx + mπ/2), and sin as a cosine that is a quarter turn behind."""
        n = np.arange(shape.width)
        k = (n + 1) // 2
        phase = 0.5 * np.pi * (order - ((n % 2 == 0) & (n > 0)))
        rate = 2 * np.pi / (self.high - self.low)
        return np.asarray((rate * k) ** order * np.cos(np.multiply.outer(at.x, k) + phase))


def _derived(y: RealArray, width: int, order: int) -> RealArray:
    """T_n^{(order)}(y), (m, width)."""
    derivative = series.chebder(np.eye(width), order) if order else np.eye(width)
    return np.asarray(series.chebvander(y, len(derivative) - 1) @ derivative)


def _integrals(shape: BasisExtent, order: int) -> RealArray:
    """The Chebyshev coefficients of each function's derivative of that order, as columns (width, width)."""
    width, d = shape.width, min(shape.derivatives, shape.width)
    out = np.zeros((width, width))
    for columns, count, times in ((slice(0, d), d, -order), (slice(d, width), width - d, d - order)):
        found: NDArray[Any] = np.eye(count)
        if times > 0:
            found = series.chebint(found, times)
        elif times < 0:
            found = series.chebder(found, -times)
        out[: len(found), columns] = found
    return out


Waves = dict[tuple[int, int], float]  # the coefficient of sin^a cos^b by (a, b)


def _sum(one: Waves, other: Waves) -> Waves:
    return {at: one.get(at, 0.0) + other.get(at, 0.0) for at in one.keys() | other.keys()}


def _turned(waves: Waves) -> Waves:
    """The derivative along the angle."""
    out: Waves = {}
    for (a, b), c in waves.items():
        for at, term in (((a - 1, b + 1), a * c), ((a + 1, b - 1), -b * c)):
            if term:
                out[at] = out.get(at, 0.0) + term
    return out


def _slowed(waves: Waves, length: float) -> Waves:
    """Times dθ/dz."""
    return {(a + 2, b): -c / length for (a, b), c in waves.items()}
