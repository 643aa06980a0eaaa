"""How many regular solutions there are at a regular singular end, exactly: an upper bound of a rank in rational arithmetic.

The coefficients φ_m, m < count, of all regular solutions are the null space of a matrix M(σ), a polynomial in σ (regular_singular.py).
If its rank is at most r at more σ than a minor of r + 1 rows can have zeros, all these minors vanish identically, and it is at most r for
every σ (theory, lemma E14).
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from shootstab.core.balls import ctx, fmpq, fmpq_mat, fmpq_series
from shootstab.core.errors import InputError
from shootstab.formulation.evaluation import Evaluator
from shootstab.formulation.gaussian import Gaussian
from shootstab.formulation.regular_singular import RegularSingularEnd, SolutionFamily

INEXACT = "the series of a coefficient at a singular end are not rational: allowed are rational functions of the coordinate and decimals"


class ExactSeries:
    """A power series with Gaussian rational coefficients: its real and imaginary part."""

    def __init__(self, re: Any, im: Any) -> None:
        self.re, self.im = re, im

    def __neg__(self) -> ExactSeries:
        return ExactSeries(-self.re, -self.im)

    def __add__(self, other: Any) -> ExactSeries:
        other = _series(other)
        return ExactSeries(self.re + other.re, self.im + other.im)

    def __mul__(self, other: Any) -> ExactSeries:
        other = _series(other)
        return ExactSeries(self.re * other.re - self.im * other.im, self.re * other.im + self.im * other.re)

    __radd__, __rmul__ = __add__, __mul__

    def inverse(self) -> ExactSeries:
        """1/x. Raises InputError where it has a pole."""
        size = self.re * self.re + self.im * self.im
        if not len(size) or size[0] == 0:
            raise InputError(INEXACT)
        return ExactSeries(self.re / size, -self.im / size)

    def coefficient(self, m: int) -> tuple[Any, Any]:
        """Real and imaginary part of that of x^m."""
        return self.re[m], self.im[m]


def shown_exactly(end: RegularSingularEnd, family: SolutionFamily) -> bool:
    """Whether the null space of a family has as many dimensions as it has free coefficients at least, for every σ: shown exactly.

    Raises InputError for coefficients that are not rational.
    """
    n, rank = len(end.shifts), len(family.allowed) - len(family.free)
    parts = _blocks(end, family)
    degree = max(power for power, part in enumerate(parts) if part) if any(parts) else 0
    rows = family.count * n
    place = {at: i for i, at in enumerate(family.allowed)}
    return all(_rank(parts, sigma, rows, place) <= rank for sigma in range(1, degree * (rank + 1) + 2))


def _rank(parts: Sequence[dict[tuple[int, int], tuple[Any, Any]]], sigma: int, rows: int, place: dict[int, int]) -> int:
    """The rank of M at a rational σ, half that of (Re M, −Im M; Im M, Re M)."""
    columns = len(place)
    M = fmpq_mat(2 * rows, 2 * columns)
    for power, part in enumerate(parts):
        for (i, at), (re, im) in part.items():
            if at in place:
                j, factor = place[at], fmpq(sigma) ** power
                for r, c, value in ((i, j, re), (rows + i, columns + j, re), (i, columns + j, -im), (rows + i, j, im)):
                    M[r, c] = M[r, c] + value * factor
    return int(M.rank()) // 2


def _blocks(end: RegularSingularEnd, family: SolutionFamily) -> list[dict[tuple[int, int], tuple[Any, Any]]]:
    """The entries of M before σ⁰, σ¹, …: L_q(ρ + m − q) in the rows of order m and the columns of order m − q."""
    n, rho, count, shifts = len(end.shifts), round(family.exponent.real), family.count, end.shifts
    before, ctx.cap = ctx.cap, count
    try:
        at = _on_series(count)
        C, D = ([{place: _series(at(e)) for place, e in part.items()} for part in powers] for powers in end.parts)
        out: list[dict[tuple[int, int], tuple[Any, Any]]] = [{} for _ in range(max(len(C), len(D)))]
        for powers, is_C in ((C, True), (D, False)):
            for power, part in enumerate(powers):
                for (i, j), series in part.items():
                    for q in range(count):
                        re, im = series.coefficient(q)
                        for m in range(q, count):
                            factor = rho + m - q + shifts[j] if is_C else -1
                            known = out[power].get((m * n + i, (m - q) * n + j), (fmpq(0), fmpq(0)))
                            out[power][m * n + i, (m - q) * n + j] = known[0] + factor * re, known[1] + factor * im
        return out
    finally:
        ctx.cap = before


def _on_series(terms: int) -> Evaluator:
    """Expressions on exact series in z."""
    z = ExactSeries(fmpq_series([0, 1], prec=terms), fmpq_series([0], prec=terms))

    def refused(*_: Any) -> Any:
        raise InputError(INEXACT)

    def power(x: Any, e: Fraction) -> ExactSeries:
        return _natural(_series(x).inverse(), -int(e)) if e.denominator == 1 else refused()

    return Evaluator(_series, refused, power, _Variable(z), refused, lambda x, e: _natural(_series(x), e))


class _Variable(dict[str, Any]):
    """z alone."""

    def __init__(self, z: ExactSeries) -> None:
        super().__init__(z=z)

    def __missing__(self, name: str) -> Any:
        raise InputError(INEXACT)


def _natural(x: ExactSeries, exponent: int) -> ExactSeries:
    out = x
    for _ in range(exponent - 1):
        out = out * x
    return out


def _series(x: Any) -> ExactSeries:
    if isinstance(x, ExactSeries):
        return x
    c = x if isinstance(x, Gaussian) else Gaussian(x)
    re, im = (fmpq(y.numerator, y.denominator) for y in (Fraction(c.re), Fraction(c.im)))
    return ExactSeries(fmpq_series([re], prec=ctx.cap), fmpq_series([im], prec=ctx.cap))
