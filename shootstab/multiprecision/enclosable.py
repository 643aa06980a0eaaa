"""What D(σ) is enclosed of: problems that offer an enclosure, and systems between two ends in balls, of which one is made."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any, Protocol

from shootstab.core.balls import acb, arb, fmpq
from shootstab.multiprecision.minors import MinorEntries, minors


class BoundedDiscriminant(Protocol):
    """D in balls, to be called at its working precision."""

    @property
    def real(self) -> bool:
        """Whether D(σ̄) is known to be the conjugate of D(σ)."""
        ...

    @property
    def multiple(self) -> tuple[Any, ...]:
        """What tells, in exact numbers, which multiple of D it is and of which base flows; the same of two enclosures: the same D."""
        ...

    def __call__(self, sigma: Any) -> Any:
        """A ball that holds D(σ) for every σ in the ball given, which should be thin. Raises ConvergenceError where there is none."""
        ...

    def growth(self, sigma: Any) -> Any:
        """An upper bound of ln |D| over the whole ball σ, on which D is then analytic."""
        ...

    def analytic(self, sigma: Any) -> bool:
        """Whether D is seen to be analytic on the whole ball σ, which may be wide."""
        ...

    def rougher(self, bits: int) -> BoundedDiscriminant:
        """The same D, no other multiple, to be called at so many bits, where that costs less, or else itself.

        It is to be asked for at the working precision of this one.
        """
        ...

    def room(self, sigma: complex) -> float:
        """The distance of σ to what is singular, about, infinite where that is not known; a choice of sizes, and no bound."""
        ...


class Enclosable(Protocol):
    """A problem whose D can be enclosed."""

    @property
    def lemmas(self) -> tuple[str, ...]:
        """Lemmas of the guide's page on proofs that this formulation relies on beside the common ones."""
        ...

    @property
    def outer(self) -> float:
        """The circle about σ on which |D| is bounded, over |σ|: nearer circles need more points, wider ones more bits."""
        ...

    @property
    def most_points(self) -> int:
        """The most values of D that one circle may take."""
        ...

    @property
    def premise(self) -> str:
        """The base flows of the enclosure made last, as the beginning of a sentence; empty where there is no question."""
        ...

    def enclosure(self, bits: int, *regions: Any) -> BoundedDiscriminant:
        """D at so many bits, made for σ in some balls; for others it may be another multiple of D, by a factor without zeros."""
        ...


class EnclosableSystem(Protocol):
    """A problem between two ends whose every number is a ball at the working precision: D = Σ_I w_I y_I at the second end.

    y are the C(n, k) minors of a basis of the solutions that the first end admits, the subsets I of rows in lexicographic order, w those of
    the conditions at the second end; both are analytic in σ, which may be thick.
    """

    @property
    def lemmas(self) -> tuple[str, ...]:
        """Lemmas, see Enclosable."""
        ...

    @property
    def multiple(self) -> tuple[Any, ...]:
        """What tells which multiple of the minors at infinity its ends take, see BoundedDiscriminant; empty between finite ends."""
        ...

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


def row_minors(rows: Sequence[Sequence[Any]]) -> list[Any]:
    """The minors of k rows of length n, the subsets of columns in lexicographic order."""
    return minors([list(column) for column in zip(*rows, strict=True)], len(rows))


def ball(x: Any) -> Any:
    """A Fraction, or a real number that flint knows, as an arb at the working precision."""
    return arb(fmpq(x.numerator, x.denominator)) if isinstance(x, Fraction) else acb(x).real
