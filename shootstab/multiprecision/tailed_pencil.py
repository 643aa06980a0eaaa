"""C dψ/dt = D ψ on series with tails: the matrix of a step, and the decaying solutions of a regular singular end, as balls."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from shootstab.core.balls import acb, acb_series, arb, arb_series
from shootstab.core.errors import ConvergenceError
from shootstab.multiprecision import small_matrices as matrices
from shootstab.multiprecision.arithmetic import Matrix
from shootstab.multiprecision.flint_backend import FlintArithmetic
from shootstab.multiprecision.linear_step import at_sigma
from shootstab.multiprecision.minors import at_sigma as numbers_at_sigma
from shootstab.multiprecision.minors import solved
from shootstab.multiprecision.regular_singular_end import decaying_series
from shootstab.multiprecision.tailed_series import TailedSeries, capped, widened
from shootstab.multiprecision.tails import Beyond, SingularBounds, StepBounds, TailedEntries, spectral_radius
from shootstab.multiprecision.taylor import Taylor

BALLS = FlintArithmetic(radii=True)  # exact: the arithmetic of every enclosure


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
        """Their terms alone."""
        if "terms" not in self._kept:
            self._kept["terms"] = [[{at: _terms(y) for at, y in part.items()} for part in parts] for parts in (self.C, self.D)]
        C, D = self._kept["terms"]
        return C, D

    @property
    def _flint(self) -> tuple[Sequence[Mapping[tuple[int, int], Any]], Sequence[Mapping[tuple[int, int], Any]]]:
        """The same as FLINT's series, real ones where they are."""
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

    def transition(self, sigma: Any) -> Matrix | None:
        """Φ (n, n) with ψ(1) = Φ ψ(0), as balls; None where it is not bounded."""
        bounds = self._step_bounds(sigma)
        if bounds is None:
            return None
        with capped(self.terms):
            A = solved(self.size, *(_whole(parts, sigma) for parts in self._flint))
            rows = [[_parts(A.get((i, j))) for j in range(self.size)] for i in range(self.size)]
            nothing = [[(None, None)] * self.size] * self.size
            identity = [[BALLS.number(int(i == j)) for j in range(self.size)] for i in range(self.size)]
            found = BALLS.expanded([*rows, *nothing], identity, identity, self.terms)
        tail = bounds.tail(found)
        return None if tail is None else _summed(found, tail)

    def decaying(self, sigma: Any, P0: Matrix, rate: Any, nilpotent: Matrix) -> Matrix | None:
        """P(1) (n, k) of the solutions P(t) t^(rate + nilpotent (k, k)), P(0) = P0, at a singular end, as balls; None where not bounded."""
        bounds = self._singular_bounds(sigma, rate, nilpotent)
        if bounds is None:
            return None
        with capped(self.terms):
            C, D = (at_sigma(parts, sigma) for parts in self.polynomials)
            found = decaying_series(BALLS, C, D, P0, rate, nilpotent, self.terms)
        tail = bounds.tail(found)
        return None if tail is None else _summed(found, tail)

    def holds(self, sigma: Any, limit: float, rate: Any = None, nilpotent: Matrix | None = None) -> bool:
        """Whether the tails at σ, a ball, contract by about such a factor: on a step, or at a singular end with nilpotent (k, k)."""
        bounds = self._step_bounds(sigma) if nilpotent is None else self._singular_bounds(sigma, rate, nilpotent)
        return bounds is not None and spectral_radius(bounds.G) < limit

    def on_cell(self, sigma: Any, low: Any, high: Any) -> dict[tuple[int, int], Any]:
        """C⁻¹ D for all t between two numbers, as balls."""
        t = acb(low.union(high))
        C, D = ([{at: y.at(t) for at, y in part.items()} for part in parts] for parts in (self.C, self.D))
        return solved(self.size, numbers_at_sigma(C, sigma), numbers_at_sigma(D, sigma))

    def _leading(self, sigma: Any) -> tuple[Matrix, Matrix]:
        """C_0 and D_0 at σ."""
        every = range(self.size)
        out = []
        for parts in (self.C, self.D):
            numbers = numbers_at_sigma([{at: y.c[0] for at, y in part.items()} for part in parts], sigma)
            out.append([[numbers.get((i, j), acb(0)) for j in every] for i in every])
        return out[0], out[1]

    def _step_bounds(self, sigma: Any) -> StepBounds | None:
        inverse = _inverse(self._leading(sigma)[0])
        return None if inverse is None else StepBounds.of(inverse, *self.beyond, abs(sigma).upper(), self.terms)

    def _singular_bounds(self, sigma: Any, rate: Any, nilpotent: Matrix) -> SingularBounds | None:
        C0, D0 = self._leading(sigma)
        inverse = _inverse(C0)
        if inverse is None:
            return None
        A0 = matrices.product(BALLS, inverse, D0)
        return SingularBounds.of(inverse, A0, *self.beyond, abs(sigma).upper(), self.terms, rate, nilpotent)


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
