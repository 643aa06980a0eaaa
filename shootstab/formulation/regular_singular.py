"""A regular singular end, such as the axis r = 0: the exponents there, and which solutions are regular.

With x = |z − z_0| and ψ_j = x^{s_j} φ_j, every row multiplied by the power of x that makes it finite, the system becomes

    Ĉ (x φ′ + S φ) = D̂ φ,   S = diag(s),   Ĉ = Σ Ĉ_q x^q,  D̂ = Σ D̂_q x^q,   Ĉ_0 regular.

The s are the largest integers ≤ 0 with s_i ≤ s_j + (pole orders), found by relaxation; where they do not settle the point is irregular.
Solutions without logarithms φ = Σ φ_m x^{ρ+m} satisfy

    L_0(ρ + m) φ_m + Σ_{q≥1} L_q(ρ + m − q) φ_{m−q} = 0,   L_q(μ) = μ Ĉ_q + Ĉ_q S − D̂_q,

and the exponents are the zeros of det L_0. Regular are those solutions in which no unknown has a power of x with a negative real part.
All m up to the largest exponent are taken together: the regular solutions are the null space of one matrix, a polynomial in σ.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from shootstab.core import polynomial
from shootstab.core.errors import InputError
from shootstab.core.scaled import TINY
from shootstab.formulation.expression import VARIABLE, Expression, Z, number
from shootstab.formulation.first_order import ExpressionEntries
from shootstab.formulation.state_pencil import Powers, StatePencil
from shootstab.formulation.substitution import substituted
from shootstab.problems.protocol import GENERIC_SIGMA

INTEGER_TOLERANCE = 1e-6  # chosen: exponents and their differences are told from integers by this
RANK_TOLERANCE = 1e-9  # chosen: singular values below this part of the largest are zero
MOST_ORDERS = 60  # chosen: orders between the smallest and the largest exponent
SIGMA_SAMPLES = 16  # chosen: values of σ on a circle by which a basis is shown to be a polynomial in it
RADII = (0.7, 19.0)  # chosen: radii of two circles in σ, far apart, on which that is shown
MOST_TERMS = 80  # chosen: the series has so many terms at most
FIRST_TERMS = 12  # chosen: the number of terms of the coefficients that tells the length
COMPLEX_GENERIC_SIGMA = GENERIC_SIGMA * (1 + 0.37j)  # chosen: a complex σ of no property
OTHER_SIGMA = 2.3  # chosen: size of another σ of no property, in the first one, for exponents that must not depend on it
SHORTEST_SERIES = 1e-12  # chosen: the length of the series is sought down to here
SCATTERED = 1e-3  # chosen: a computed exponent this near to an integer is that, as multiple eigenvalues scatter
INDEPENDENT = 1e-6  # chosen: singular values below this make rows of a basis dependent
ANALYTIC_NOISE = 1e-8  # chosen: Fourier coefficients that a polynomial has not are below this part of the largest

ScaledPencil = tuple[Powers, Powers]  # Ĉ and D̂
SeriesArrays = tuple[list[NDArray[np.complex128]], list[NDArray[np.complex128]]]  # the same, (terms, n, n) for every power of σ


@dataclass(frozen=True, eq=False)
class SolutionFamily:
    """Solutions φ = Σ_{m<count} φ_m x^{ρ+m} + …; allowed are the coefficients (m n + j) that regularity leaves. Of these, by their
    places there, free are those that a basis is named by, and rows the equations that find the others.
    """

    exponent: complex
    count: int
    free: tuple[int, ...]
    rows: tuple[int, ...]
    allowed: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class RegularSingularEnd:
    """The scaled pencil Ĉ, D̂ by entries without poles in x (the variable of the expressions), s, and the families.

    Series are in x/length, a length over which the coefficients are of the size of their values at the end.
    """

    parts: ScaledPencil
    shifts: tuple[int, ...]
    length: float
    families: tuple[SolutionFamily, ...]
    exponents: tuple[complex, ...]

    @property
    def columns(self) -> int:
        """The number of regular solutions."""
        return sum(len(family.free) for family in self.families)

    @cached_property
    def arrays(self) -> SeriesArrays:
        """The series of the coefficients, (MOST_TERMS, n, n) for every power of σ."""
        return coefficient_arrays(self.parts, len(self.shifts), MOST_TERMS, self.length)


def regular_singular_end(system: StatePencil, z0: Fraction, direction: int, bounded: Sequence[int], where: str) -> RegularSingularEnd:
    """The end at z0, from which the domain goes in this direction; bounded are the states that are unknowns.

    Raises InputError for an irregular point, exponents that depend on σ, solutions that no basis polynomial in σ is found for, and
    coefficients whose series leave the range of doubles.
    """
    with np.errstate(all="ignore"):  # what is not finite is refused
        try:
            return _end(system, z0, direction, bounded, where)
        except np.linalg.LinAlgError:
            raise InputError(f"at {where} the series of the coefficients leave the range of doubles: that is not offered") from None


def _end(system: StatePencil, z0: Fraction, direction: int, bounded: Sequence[int], where: str) -> RegularSingularEnd:
    parts, shifts = _scaled(system, z0, direction, where)
    length = _length(parts, system.size)
    exponents = _exponents(parts, shifts, COMPLEX_GENERIC_SIGMA, where)
    other = _exponents(parts, shifts, -OTHER_SIGMA * COMPLEX_GENERIC_SIGMA.conjugate(), where)
    if np.abs(exponents - other).max() > INTEGER_TOLERANCE * (1.0 + np.abs(exponents).max()):
        raise InputError(f"at {where} the exponents depend on the eigenvalue: that is not offered")
    families = []
    left = list(exponents)
    while left:
        first = left[0]
        members = [x for x in left if abs((x - first) - round((x - first).real)) < INTEGER_TOLERANCE]
        left = [x for x in left if x not in members]
        lowest = min(members, key=lambda x: float(x.real))
        rho = complex(round(lowest.real), 0.0) if abs(lowest - round(lowest.real)) < INTEGER_TOLERANCE else complex(lowest)
        count = 1 + round(max(float((x - lowest).real) for x in members))
        if count > MOST_ORDERS:
            raise InputError(f"at {where} exponents differ by {count - 1}: allowed are differences up to {MOST_ORDERS - 1}")
        families.append(_family(parts, shifts, length, rho, count, bounded, where))
    found = tuple(family for family in families if family is not None)
    return RegularSingularEnd(parts, shifts, length, found, tuple(complex(x) for x in exponents))


def coefficient_arrays(parts: ScaledPencil, n: int, terms: int, length: float = 1.0) -> SeriesArrays:
    """Ĉ and D̂ as arrays (terms, n, n) of their power series in x/length, one a power of σ. Raises InputError where they have none."""
    from shootstab.core.series import Series
    from shootstab.formulation.series_evaluation import on_double_series

    at = on_double_series(terms)
    powers = length ** np.arange(terms)

    def array(entries: ExpressionEntries) -> NDArray[np.complex128]:
        out = np.zeros((terms, n, n), dtype=np.complex128)
        for (i, j), entry in entries.items():
            try:
                value = at(entry)
            except ArithmeticError:  # a division by zero or an overflow of Python's own numbers
                value = float("nan")
            out[:, i, j] = powers * (value.coefficients if isinstance(value, Series) else [value, *[0.0] * (terms - 1)])
        if not np.isfinite(out).all():
            raise InputError("at a regular singular end a coefficient is no power series with a pole: allowed are powers of the coordinate")
        return out

    return [array(part) for part in parts[0]], [array(part) for part in parts[1]]


def blocks(arrays: SeriesArrays, shifts: Sequence[int], family: complex, count: int) -> list[NDArray[np.complex128]]:
    """The matrices before σ⁰, σ¹, … of all equations for m < count, (count·n, count·n), from arrays (terms, n, n)."""
    n, S = len(shifts), np.diag(np.array(shifts, dtype=float))
    out = []
    for C, D in zip(*arrays, strict=True):
        M = np.zeros((count, n, count, n), dtype=np.complex128)
        for m in range(count):
            for q in range(m + 1):
                M[m, :, m - q] = (family + m - q) * C[q] + C[q] @ S - D[q]
        out.append(M.reshape(count * n, count * n))
    return out


def _scaled(system: StatePencil, z0: Fraction, direction: int, where: str) -> tuple[ScaledPencil, tuple[int, ...]]:
    n = system.size
    place = number(z0) + (Z if direction > 0 else -Z)
    C, D = ([{at: substituted(e, VARIABLE, place) for at, e in part.items()} for part in powers] for powers in (system.C, system.D))
    if direction < 0:
        D = [{at: -entry for at, entry in part.items()} for part in D]
    # the reduction matches each highest derivative with an equation that holds it, which a nonsingular C allows: the diagonal is there
    own = [min(_valuation(part[i, i]) for part in C if (i, i) in part) for i in range(n)]
    bounds = [(i, j, _valuation(e) - own[i]) for part in C for (i, j), e in part.items()]
    bounds += [(i, j, _valuation(e) + 1 - own[i]) for part in D for (i, j), e in part.items()]
    s = [0] * n
    for _ in range(n + 1):
        changed = False
        for i, j, w in bounds:
            if s[j] + w < s[i]:
                s[i], changed = s[j] + w, True
        if not changed:
            break
    else:
        raise InputError(f"{where} is an irregular singular point of the equations: allowed are regular ones")

    def scaled(part: ExpressionEntries, extra: int) -> ExpressionEntries:
        return {(i, j): e * Z ** (s[j] - s[i] - own[i] + extra) for (i, j), e in part.items()}

    return (tuple(scaled(part, 0) for part in C), tuple(scaled(part, 1) for part in D)), tuple(s)


def _length(parts: ScaledPencil, n: int) -> float:
    """The x at which the later terms of the coefficients together are as large as the first, for σ of the size 1."""
    arrays = coefficient_arrays(parts, n, FIRST_TERMS)
    sizes = [float(max(np.abs(array[q]).max() for part in arrays for array in part)) for q in range(FIRST_TERMS)]
    x = 1.0
    while sum(a * x**q for q, a in enumerate(sizes[1:], 1)) > sizes[0] and x > SHORTEST_SERIES:
        x *= 0.5
    return x


def _valuation(entry: Expression) -> int:
    """The smallest power of z in its monomials."""
    return min(int(dict(monomial).get(VARIABLE, 0)) for monomial in entry.terms)


def _exponents(parts: ScaledPencil, shifts: Sequence[int], sigma: complex, where: str) -> NDArray[np.complex128]:
    n = len(shifts)
    C, D = (polynomial.value([array[0] for array in part], sigma) for part in coefficient_arrays(parts, n, 2))
    if np.linalg.cond(C) > 1 / RANK_TOLERANCE:
        raise InputError(f"at {where} the highest derivatives are dependent: that is not offered")
    found = np.linalg.eigvals(np.linalg.solve(C, D) - np.diag(np.array(shifts, dtype=float)))
    rounded = np.where(np.abs(found - np.round(found.real)) < SCATTERED, np.round(found.real), found)  # multiple ones scatter
    return np.asarray(rounded[np.lexsort((rounded.imag, rounded.real))])


def _family(
    parts: ScaledPencil, shifts: tuple[int, ...], length: float, rho: complex, count: int, bounded: Sequence[int], where: str
) -> SolutionFamily | None:
    n = len(shifts)
    powers = blocks(coefficient_arrays(parts, n, count + 1, length), shifts, rho, count)
    forbidden = {m * n + j for m in range(count) for j in bounded if (rho + m).real + shifts[j] < -INTEGER_TOLERANCE}
    allowed = [i for i in range(count * n) if i not in forbidden]

    def matrix(sigma: complex) -> NDArray[np.complex128]:
        M = polynomial.value(powers, sigma)[:, allowed]
        sizes = sum(np.abs(part[:, allowed]).max(axis=1) for part in powers)
        return np.asarray(M / np.where(sizes > 0.0, sizes, 1.0)[:, None])

    M = matrix(COMPLEX_GENERIC_SIGMA)
    sizes = np.linalg.svd(M, compute_uv=False)
    k = len(allowed) - int((sizes > RANK_TOLERANCE * sizes[0]).sum())
    if k == 0:
        return None
    _, _, order = scipy.linalg.qr(M.conj().T, pivoting=True)
    rows = sorted(order[: len(allowed) - k].tolist())
    for free in _candidates(scipy.linalg.null_space(M, rcond=RANK_TOLERANCE), k):
        if _is_polynomial(matrix, rows, free):
            return SolutionFamily(rho, count, tuple(free), tuple(rows), tuple(allowed))
    raise InputError(f"at {where} no basis of the regular solutions is found that is a polynomial in the eigenvalue: that is not offered")


def _candidates(basis: NDArray[np.complex128], k: int) -> list[list[int]]:
    """Coefficients that may name a basis: the first ones that are independent, counted from the lowest order, or from any later one."""
    found: list[list[int]] = []
    for start in range(len(basis)):
        chosen: list[int] = []
        for i in [*range(start, len(basis)), *range(start)]:
            trial = basis[[*chosen, i]]
            if np.linalg.matrix_rank(trial, tol=INDEPENDENT) == len(trial):
                chosen.append(i)
            if len(chosen) == k:
                break
        if len(chosen) == k and sorted(chosen) not in found:
            found.append(sorted(chosen))
    return found


def _is_polynomial(matrix: object, rows: list[int], free: list[int]) -> bool:
    """Whether the basis named by these coefficients has no poles: its values on circles have no negative Fourier coefficients."""
    for radius in RADII:
        sigmas = radius * np.exp(2j * np.pi * np.arange(SIGMA_SAMPLES) / SIGMA_SAMPLES)
        values = []
        for sigma in sigmas.tolist():
            M = matrix(sigma)[rows]  # type: ignore[operator]
            dependent = [i for i in range(M.shape[1]) if i not in free]
            if dependent and np.linalg.cond(M[:, dependent]) > 1 / RANK_TOLERANCE:
                return False
            values.append(np.linalg.solve(M[:, dependent], -M[:, free]))
        waves = np.fft.fft(np.array(values), axis=0)
        if np.abs(waves[SIGMA_SAMPLES // 2 :]).max(initial=0.0) > ANALYTIC_NOISE * np.abs(waves).max(initial=TINY):
            return False
    return True
