"""C dψ/dt = D ψ on series with tails: the matrix of a step, and the decaying solutions of a regular singular end, as balls."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from shootstab.core.balls import acb, acb_mat, acb_series, arb, arb_series, ctx
from shootstab.core.errors import ConvergenceError
from shootstab.multiprecision import small_matrices as matrices
from shootstab.multiprecision.arithmetic import Matrix
from shootstab.multiprecision.flint_backend import FlintArithmetic
from shootstab.multiprecision.linear_step import at_sigma
from shootstab.multiprecision.minors import at_sigma as numbers_at_sigma
from shootstab.multiprecision.minors import solved
from shootstab.multiprecision.regular_singular_end import decaying_series
from shootstab.multiprecision.tailed_series import TailedSeries, capped, widened
from shootstab.multiprecision.tails import Beyond, QuotientBounds, SizedEntries, SolutionBounds, TailedEntries, largest, spectral_radius
from shootstab.multiprecision.taylor import Taylor

BALLS = FlintArithmetic(radii=True)  # exact: the arithmetic of every enclosure
QUOTIENT_CONTRACTION, SOLUTION_CONTRACTION = 0.85, 0.5  # chosen: spectral radii of the two G up to which a step is not too long

ROUGH_PART = 0.65  # chosen: part of the terms of a step for solutions that are wanted roughly; by half of them the tail is not bounded
Quotient = tuple[dict[tuple[int, int], Any], SizedEntries, list[Any]]  # the terms of A = C⁻¹D, their moduli, and X of A
SEEN_BITS = 16  # chosen: bits above the working precision from which on terms left out would be seen


@dataclass(frozen=True, eq=False)
class TailedPencil:
    """C and D by powers of σ as series with tails: C dψ/dt = D ψ on a step, C t dψ/dt = D ψ at a singular end."""

    size: int
    C: Sequence[TailedEntries]
    D: Sequence[TailedEntries]
    terms: int
    _kept: dict[str, Any] = field(default_factory=dict, repr=False)

    @property
    def polynomials(self) -> tuple[Sequence[Mapping[tuple[int, int], Taylor]], Sequence[Mapping[tuple[int, int], Taylor]]]:
        """The terms of the entries alone."""
        if "terms" not in self._kept:
            self._kept["terms"] = [[{at: _terms(y) for at, y in part.items()} for part in parts] for parts in (self.C, self.D)]
        C, D = self._kept["terms"]
        return C, D

    @property
    def _flint(self) -> tuple[Sequence[Mapping[tuple[int, int], Any]], Sequence[Mapping[tuple[int, int], Any]]]:
        """The entries as FLINT's series, real ones where they are."""
        if "flint" not in self._kept:
            self._kept["flint"] = [[{at: _flint(y) for at, y in part.items()} for part in parts] for parts in (self.C, self.D)]
        C, D = self._kept["flint"]
        return C, D

    @property
    def beyond(self) -> tuple[Beyond, Beyond]:
        """What the bounds ask for."""
        if "beyond" not in self._kept:
            self._kept["beyond"] = Beyond(self.C), Beyond(self.D)
        C, D = self._kept["beyond"]
        return C, D

    def expansion(self, sigma: Any) -> tuple[list[Matrix], list[Any]] | None:
        """The terms of Φ(t) (n, n), ψ(t) = Φ(t) ψ(0), and bounds (n,) of what they leave out in each row; None where it is not bounded."""
        found = self._quotient(sigma)
        return (
            None
            if found is None
            else self._solutions(found, [[BALLS.number(int(i == j)) for j in range(self.size)] for i in range(self.size)], self.terms)
        )

    def carried(self, sigma: Any, Y: Matrix, Z: Matrix) -> tuple[Matrix, Matrix] | None:
        """Φ Y (n, k) and, by fewer terms and so less closely, Φ Z (n, q), as balls; None where they are not bounded."""
        found = self._quotient(sigma)
        if found is None:
            return None
        few = math.ceil(ROUGH_PART * self.terms)
        parts = [self._solutions(found, start, terms) for start, terms in ((Y, self.terms), (Z, few))]
        if parts[1] is None:
            parts[1] = self._solutions(found, Z, self.terms)
        first, second = (None if part is None else _summed(*part) for part in parts)
        return None if first is None or second is None else (first, second)

    def shortened(self, terms: int) -> TailedPencil:
        """The same pencils by fewer terms."""
        C, D = ([{at: y.shortened(terms) for at, y in part.items()} for part in parts] for parts in (self.C, self.D))
        return TailedPencil(self.size, C, D, terms)

    def _solutions(self, quotient: Quotient, start: Matrix, terms: int) -> tuple[list[Matrix], list[Any]] | None:
        """Terms of the solutions from a matrix (n, k) on, and bounds (n,) of the rest."""
        A, sizes, rest = quotient
        every = range(self.size)
        with capped(self.terms):
            rows = [[_parts(A.get((i, j))) for j in every] for i in every]
            nothing = [[(None, None)] * self.size] * self.size
            identity = [[BALLS.number(int(i == j)) for j in every] for i in every]
            found = BALLS.expanded([*rows, *nothing], identity, start, terms)
        tail = SolutionBounds.of_step(self.size, sizes, rest, terms).tail(found)
        return None if tail is None else (found, tail)

    def decaying(self, sigma: Any, P0: Matrix, rate: Any, nilpotent: Matrix) -> Matrix | None:
        """P(1) (n, k) of the solutions P(t) t^(rate + nilpotent (k, k)), P(0) = P0, at a singular end, as balls; None where not bounded.

        rate has a real part above 0.
        """
        found = self._quotient(sigma)
        if found is None:
            return None
        with capped(self.terms):
            C, D = (at_sigma(parts, sigma) for parts in self.polynomials)
            terms = decaying_series(BALLS, C, D, P0, rate, nilpotent, self.terms)
        tail = SolutionBounds.of_singular_end(self.size, *found[1:], self.terms, acb(rate).real, nilpotent).tail(terms)
        return None if tail is None else _summed(terms, tail)

    def continued(self, sigma: Any, first: Sequence[Matrix], exponent: int) -> Matrix | None:
        """P(1) (n, k) of the solutions P(t) t^exponent at a singular end, whose terms (n, k) begin with first; None where not bounded.

        Raises ConvergenceError where a later term is not determined by those before it.
        """
        found = self._quotient(sigma)
        if found is None:
            return None
        A, sizes, rest = found
        series, every = {at: y.coeffs() for at, y in A.items()}, range(self.size)
        parts = [acb_mat([[_nth_of(series.get((i, j), ()), m) for j in every] for i in every]) for m in range(self.terms)]
        identity, P = acb_mat([[int(i == j) for j in every] for i in every]), [acb_mat(term) for term in first]
        for m in range(len(P), self.terms):
            right = sum((parts[j] * P[m - j] for j in range(2, m + 1)), parts[1] * P[m - 1])
            try:
                P.append(((m + exponent) * identity - parts[0]).inv() * right)
            except ZeroDivisionError:
                raise ConvergenceError(f"the term of order {m + exponent} at a singular end is not determined: take more bits") from None
        terms = [term.tolist() for term in P]
        tail = SolutionBounds.of_singular_end(self.size, sizes, rest, self.terms, arb(exponent), [[arb(0)]]).tail(terms)
        return None if tail is None else _summed(terms, tail)

    def contraction(self, sigma: Any, rate: Any = None, nilpotent: Matrix | None = None) -> float:
        """How fast the tails contract for σ in a ball, over what is allowed: on a step, or at a singular end with nilpotent (k, k).

        Where it is above 1 the step, or t at the end, is too long by about this factor; so it is where the terms left out would be seen.
        """
        bounds, found = self._quotient_bounds(sigma), self._quotient(acb(sigma).mid())
        if bounds is None or found is None:
            return math.inf
        if nilpotent is None:
            solution = SolutionBounds.of_step(self.size, *found[1:], self.terms)
        else:
            solution = SolutionBounds.of_singular_end(self.size, *found[1:], self.terms, rate, nilpotent)
        _, sizes, rest = found
        whole = largest([x for entry in sizes.values() for x in entry])
        seen = float((largest(rest) / whole).log()) / math.log(2) + ctx.prec - SEEN_BITS if largest(rest) > 0 else -math.inf
        contracted = max(spectral_radius(bounds.G) / QUOTIENT_CONTRACTION, spectral_radius(solution.G) / SOLUTION_CONTRACTION)
        return float(max(contracted, 2.0 ** (seen / self.terms)))

    def on_cell(self, sigma: Any, low: Any, high: Any) -> dict[tuple[int, int], Any]:
        """C⁻¹ D for all t between two numbers, as balls."""
        t = acb(low.union(high))
        C, D = ([{at: y.at(t) for at, y in part.items()} for part in parts] for parts in (self.C, self.D))
        return solved(self.size, numbers_at_sigma(C, sigma), numbers_at_sigma(D, sigma))

    def _leading(self, sigma: Any) -> Matrix:
        """C_0 at σ."""
        every = range(self.size)
        numbers = numbers_at_sigma([{at: y.c[0] for at, y in part.items()} for part in self.C], sigma)
        return [[numbers.get((i, j), acb(0)) for j in every] for i in every]

    def _quotient_bounds(self, sigma: Any) -> QuotientBounds | None:
        inverse = _inverse(self._leading(sigma))
        return None if inverse is None else QuotientBounds.of(inverse, *self.beyond, abs(sigma).upper())

    def _quotient(self, sigma: Any) -> Quotient | None:
        """The terms of A = C⁻¹D, their moduli, and X of A; None where it is not bounded."""
        bounds = self._quotient_bounds(sigma)
        if bounds is None:
            return None
        with capped(self.terms):
            try:
                A = solved(self.size, *(_whole(parts, sigma) for parts in self._flint))
            except ConvergenceError:
                return None
        sizes = {at: [abs(x).upper() for x in y.coeffs()] for at, y in A.items()}
        rest = bounds.tail(sizes, self.terms)
        return None if rest is None else (A, sizes, rest)


def _inverse(A: Matrix) -> Matrix | None:
    try:
        return matrices.inverse(BALLS, A)
    except ConvergenceError:
        return None


def _terms(y: TailedSeries) -> Taylor:
    return Taylor(BALLS, y.terms, *_parts(_flint(y)))


def _flint(y: TailedSeries) -> Any:
    c = y.c + [acb(0)] * (y.terms - len(y.c))  # FLINT's series are known as far as they are long
    return arb_series([x.real for x in c], y.terms) if all(x.imag.is_zero() for x in c) else acb_series(c, y.terms)


def _nth_of(coefficients: Sequence[Any], m: int) -> Any:
    return acb(coefficients[m]) if m < len(coefficients) else acb(0)


def _parts(y: Any) -> tuple[Any, Any]:
    """A series as its real and imaginary parts, None for zero."""
    if y is None:
        return None, None
    c, n = y.coeffs(), y.prec
    parts = [[acb(x).real for x in c], [acb(x).imag for x in c]]
    re, im = (None if all(x.is_zero() for x in part) else arb_series(part, n) for part in parts)
    return re, im


def _whole(parts: Sequence[Mapping[tuple[int, int], Any]], sigma: Any) -> dict[tuple[int, int], Any]:
    """Σ σ^k (part k) of FLINT's series, by non-zero entries; real σ stay real."""
    sigma = acb(sigma)
    out: dict[tuple[int, int], Any] = {}
    factor = sigma.real if sigma.imag.is_zero() else sigma
    for k, part in enumerate(parts):
        for at, y in part.items():
            term = y * factor**k if k else y
            out[at] = out[at] + term if at in out else term
    return out


def _summed(terms: Sequence[Matrix], tail: Sequence[Any]) -> Matrix:
    """Σ_k terms_k, wider by the tail of each row."""
    n, k = len(terms[0]), len(terms[0][0])
    out = []
    for i in range(n):
        sums = [acb(sum((term[i][q] for term in terms[::-1]), arb(0))) for q in range(k)]
        out.append([widened(x, tail[i]) for x in sums])
    return out
