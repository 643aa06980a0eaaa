"""What D(σ) is enclosed of: a pencil and the minors at both ends, in balls; and closed forms as that."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any, Protocol

from shootstab.core.balls import acb, arb, fmpq
from shootstab.multiprecision import small_matrices as matrices
from shootstab.multiprecision.arithmetic import exact
from shootstab.multiprecision.minors import MinorEntries, minors
from shootstab.problems.closed_form import ClosedForm


class Enclosable(Protocol):
    """A problem between two ends whose every number is a ball at the working precision: D = Σ_I w_I y_I at the second end.

    y are the C(n, k) minors of a basis of the solutions that the first end admits, the subsets I of rows in lexicographic order, w those of
    the conditions at the second end; both are analytic in σ, which may be thick.
    """

    lemmas: tuple[str, ...]  # lemmas of the guide's page on proofs that this formulation relies on beside the common ones

    @property
    def size(self) -> int:
        """n."""
        ...

    @property
    def decaying(self) -> int:
        """k."""
        ...

    def ends(self) -> tuple[Any, Any]:
        """z of the first and of the second end, arb."""
        ...

    def pencil(self, z: Any) -> tuple[Sequence[MinorEntries], Sequence[MinorEntries]]:
        """C and D at z, an acb or a TailedSeries, by powers of σ and non-zero entries."""
        ...

    def start(self, sigma: Any) -> list[Any]:
        """y at the first end."""
        ...

    def wall(self, sigma: Any) -> list[Any]:
        """w."""
        ...


class ClosedFormEnclosable:
    """See Enclosable: a closed form, whose floats stand for their shortest decimals."""

    lemmas: tuple[str, ...] = ()

    def __init__(self, form: ClosedForm) -> None:
        self._form = form

    @property
    def size(self) -> int:
        return self._form.size

    @property
    def decaying(self) -> int:
        return self._form.decaying

    def ends(self) -> tuple[Any, Any]:
        far, wall = (ball(exact(end)) if isinstance(end, float) else ball(end) for end in self._form.exact_ends(_exact))
        return far, wall

    def pencil(self, z: Any) -> tuple[Sequence[MinorEntries], Sequence[MinorEntries]]:
        parts = [dict(part) for part in self._form.exact_pencil(z, _exact)]
        half = len(parts) // 2
        return parts[:half], parts[half:]

    def start(self, sigma: Any) -> list[Any]:
        rows = [[acb(x) for x in row] for row in self._form.exact_far(sigma, _exact)]
        return minors(rows, self.decaying)

    def wall(self, sigma: Any) -> list[Any]:
        return row_minors(matrices.polynomial([[[acb(x) for x in row] for row in W] for W in self._form.exact_wall(_exact)], sigma))


def row_minors(rows: Sequence[Sequence[Any]]) -> list[Any]:
    """The minors of k rows of length n, the subsets of columns in lexicographic order."""
    return minors([list(column) for column in zip(*rows, strict=True)], len(rows))


def ball(x: Any) -> Any:
    """A Fraction, or a real number that flint knows, as an arb at the working precision."""
    return arb(fmpq(x.numerator, x.denominator)) if isinstance(x, Fraction) else acb(x).real


def _exact(x: float) -> Any:
    """The decimal that a float stands for."""
    return acb(ball(exact(x)))
