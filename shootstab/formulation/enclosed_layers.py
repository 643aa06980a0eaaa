"""Layers with interfaces, and periodic ends, in balls (theory, lemmas E15 and E16).

At an interface L(σ) ψ(before) + R(σ) ψ(behind) = 0, and the minors behind it are Λ^k T y, T = −R⁻¹L. Between periodic ends
D = det(Φ − 1) with the matrix Φ that carries ψ from one to the other, between ends that conditions L ψ(left) + R ψ(right) = 0 couple
D = det(L + R Φ).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from typing import Any, Protocol

from shootstab.core.balls import acb, acb_mat
from shootstab.core.errors import ConvergenceError
from shootstab.formulation.enclosed import NOWHERE, EquationEnclosable, on_balls
from shootstab.formulation.expression import Expression
from shootstab.formulation.state_pencil import Powers, StatePencil
from shootstab.formulation.system import coefficients
from shootstab.multiprecision.enclosable import BoundedDiscriminant, Enclosable, EnclosableSystem, ball
from shootstab.multiprecision.enclosure import MOST_POINTS, OUTER, Enclosure
from shootstab.multiprecision.minors import MinorEntries

EntriesByPlace = dict[tuple[int, int], Expression]  # polynomials in σ by row and column


class Carrying(Protocol):
    """What a way through layers makes D of."""

    @property
    def lemmas(self) -> tuple[str, ...]:
        """What it rests on beside steps."""
        ...

    def value(self, bits: int, sigma: Any) -> Any:
        """D(σ), at the working precision."""
        ...

    @property
    def multiple(self) -> tuple[Any, ...]:
        """See enclosable.BoundedDiscriminant."""
        ...


@dataclass(frozen=True, eq=False)
class EnclosedWay:
    """See enclosable.Enclosable."""

    way: Carrying
    outer: float = OUTER
    most_points: int = MOST_POINTS
    premise: str = ""

    @property
    def lemmas(self) -> tuple[str, ...]:
        """The lemmas of steps and of the way."""
        return ("E2", "E3", *self.way.lemmas)

    def enclosure(self, bits: int, *regions: Any) -> WayEnclosure:
        """One and the same D for every region."""
        return WayEnclosure(self.way, bits)


@dataclass(frozen=True, eq=False)
class WayEnclosure:
    """See enclosable.BoundedDiscriminant; |D| is bounded by its values for thick σ."""

    way: Carrying
    bits: int
    real: bool = False

    @property
    def multiple(self) -> tuple[Any, ...]:
        """The multiple of the way."""
        return self.way.multiple

    def __call__(self, sigma: Any) -> Any:
        return self.way.value(self.bits, sigma)

    def growth(self, sigma: Any) -> Any:
        """An upper bound of ln |D|."""
        return abs(self(sigma)).upper().log()

    def analytic(self, sigma: Any) -> bool:
        """Whether |D| has a bound on the whole ball σ."""
        try:
            return bool(self.growth(sigma).is_finite())
        except ConvergenceError:
            return False

    def rougher(self, bits: int) -> WayEnclosure:
        """Itself: its values are cheap, and where it begins may depend on the precision."""
        return self

    def room(self, sigma: complex) -> float:
        """Infinite: where D is singular is not known beforehand."""
        return math.inf


@dataclass(frozen=True, eq=False)
class LayerBetween:
    """The pencil of one layer from one place to another, both arb, of which k-minors are carried; see enclosable.EnclosableSystem."""

    states: StatePencil
    decaying: int
    places: tuple[Any, Any]

    @property
    def size(self) -> int:
        return self.states.size

    def ends(self) -> tuple[Any, Any]:
        return self.places

    def pencil(self, z: Any) -> tuple[list[MinorEntries], list[MinorEntries]]:
        at = on_balls(z, {})
        C, D = ([{place: at(entry) for place, entry in part.items()} for part in powers] for powers in (self.states.C, self.states.D))
        return C, D

    def carried(self, bits: int, sigma: Any, y: Any) -> Any:
        """The minors y (m, 1) at the other place."""
        return Enclosure(self, bits).carried(sigma, y)  # type: ignore[arg-type]


@dataclass(frozen=True, eq=False)
class EnclosedJoint:
    """L and R at an interface at a place, by entries."""

    at: Any
    before: EntriesByPlace
    behind: EntriesByPlace
    size: int

    def across(self, sigma: Any, y: Any, k: int) -> Any:
        """The k-minors behind it. Raises ConvergenceError where R may be singular."""
        at = on_balls(acb(ball(self.at)), {})
        L, R = (self._matrix(at, part, sigma) for part in (self.before, self.behind))
        try:
            T = (R.inv() * L * -1).tolist()
        except ZeroDivisionError:
            raise ConvergenceError("conditions at an interface may not determine what is behind it: take a smaller disc") from None
        subsets = list(combinations(range(self.size), k))
        minors = [[acb_mat([[T[i][j] for j in columns] for i in rows]).det() for columns in subsets] for rows in subsets]
        return acb_mat(minors) * y

    def _matrix(self, at: Any, entries: EntriesByPlace, sigma: Any) -> Any:
        out = acb_mat(self.size, self.size)
        for place, entry in entries.items():
            for power, part in coefficients(entry).items():
                out[place] += acb(at(part)) * sigma**power
        return out


@dataclass(frozen=True, eq=False)
class LayeredWay:
    """Layers from left to right and the interfaces between them; ends gives the minors at the left and those of conditions at the right."""

    ends: EnclosableSystem
    layers: Sequence[StatePencil]
    joints: Sequence[EnclosedJoint]

    @property
    def lemmas(self) -> tuple[str, ...]:
        """Those of the ends, and of interfaces."""
        return (*self.ends.lemmas, "E15")

    @property
    def multiple(self) -> tuple[Any, ...]:
        """What the ends chose."""
        return self.ends.multiple

    def value(self, bits: int, sigma: Any) -> Any:
        """D(σ)."""
        k, first = self.ends.decaying, self.ends.start(sigma)
        left, right = self.ends.ends()
        places = [left, *(ball(joint.at) for joint in self.joints), right]
        y = acb_mat(len(first), 1, first)
        for j, layer in enumerate(self.layers):
            y = LayerBetween(layer, k, (places[j], places[j + 1])).carried(bits, sigma, y)
            if j < len(self.joints):
                y = self.joints[j].across(sigma, y, k)
        return sum((w * y[i, 0] for i, w in enumerate(self.ends.wall(sigma))), acb(0))


@dataclass(frozen=True, eq=False)
class MatchedWay:
    """One layer between two infinities: decaying solutions grow inwards, and D is the determinant of both at z = 0."""

    ends: EquationEnclosable
    states: StatePencil

    @property
    def lemmas(self) -> tuple[str, ...]:
        """The lemmas of the ends."""
        return self.ends.lemmas

    @property
    def multiple(self) -> tuple[Any, ...]:
        """What the ends chose."""
        return self.ends.multiple

    def value(self, bits: int, sigma: Any) -> Any:
        """D(σ)."""
        k, n = self.ends.decaying, self.ends.size
        found = []
        for place, count, first in zip(self.ends.ends(), (k, n - k), (self.ends.start(sigma), self.ends.arriving(sigma)), strict=True):
            y = LayerBetween(self.states, count, (place, acb(0).real)).carried(bits, sigma, acb_mat(len(first), 1, first))
            found.append([y[i, 0] for i in range(len(first))])
        left, right = found
        return sum((w * y for w, y in zip(self.ends.complementary(right), left, strict=True)), acb(0))


@dataclass(frozen=True, eq=False)
class FirstBounded:
    """See enclosable.Enclosable: the first of several forms that has a bound for the regions asked for, or else a value in the middle."""

    forms: Sequence[Enclosable]

    @property
    def lemmas(self) -> tuple[str, ...]:
        """The lemmas of the form that was used last, or else of all."""
        return self.forms[self._last[-1]].lemmas if self._last else tuple(dict.fromkeys(x for form in self.forms for x in form.lemmas))

    outer: float = OUTER
    most_points: int = MOST_POINTS
    premise: str = ""
    _last: list[int] = field(default_factory=list, repr=False)

    def enclosure(self, bits: int, *regions: Any) -> BoundedDiscriminant:
        """The enclosure of the form."""

        def bounded(found: BoundedDiscriminant) -> bool:
            return all(found.growth(region).is_finite() for region in regions)

        def known(found: BoundedDiscriminant) -> bool:
            return all(found(acb(region).mid()).is_finite() for region in regions)

        chosen = next((j for holds in (bounded, known) for j, form in enumerate(self.forms) if _holds(holds, form, bits, regions)), 0)
        self._last[:] = [chosen]
        return self.forms[chosen].enclosure(bits, *regions)


def _holds(test: Callable[[BoundedDiscriminant], bool], form: Enclosable, bits: int, regions: Sequence[Any]) -> bool:
    try:
        return test(form.enclosure(bits, *regions))
    except ConvergenceError:
        return False


def first_that_holds(forms: Sequence[Enclosable]) -> Enclosable:
    """One form alone, or the first of several that holds."""
    return forms[0] if len(forms) == 1 else FirstBounded(forms)


@dataclass(frozen=True, eq=False)
class CoupledWay:
    """det(L + R Φ), Φ from one place to another, with the rows (L, R) (n, 2n) by powers of σ of all conditions; det(Φ − 1) without rows."""

    states: StatePencil
    places: tuple[Any, Any]
    rows: Powers = ()
    lemmas: tuple[str, ...] = ("E8", "E16")
    multiple: tuple[Any, ...] = ()

    def value(self, bits: int, sigma: Any) -> Any:
        """D(σ)."""
        n, at = self.states.size, on_balls(NOWHERE, {})
        way = LayerBetween(self.states, 1, (ball(self.places[0]), ball(self.places[1])))
        columns = [way.carried(bits, sigma, acb_mat([[int(i == j)] for i in range(n)])) for j in range(n)]
        Phi = acb_mat([[columns[j][i, 0] for j in range(n)] for i in range(n)])
        if not self.rows:
            return (Phi - acb_mat([[int(i == j) for j in range(n)] for i in range(n)])).det()
        L, R = acb_mat(n, n), acb_mat(n, n)
        for power, part in enumerate(self.rows):
            for (i, j), entry in part.items():
                side = L if j < n else R
                side[i, j % n] += acb(at(entry)) * sigma**power
        return (L + R * Phi).det()
