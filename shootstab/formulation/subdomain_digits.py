"""Problems in equations to any number of digits whose solutions are carried through several subdomains, or from an end at infinity.

Each subdomain goes from its beginning to its target in its own z = z_begin + t (target − z_begin), 0 ≤ t ≤ 1, all of them as one system in
blocks, as in problems.subdomains. It begins with what its end allows: with the decaying space at infinity, with the regular solutions at a
singular end, with the solutions that conditions without the eigenvalue leave; or, between two interfaces and where the eigenvalue stands in
the conditions, with all solutions beside their starting values a = ψ(z_begin), as components before ψ. Where all arrive conditions hold.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Protocol

from shootstab.core.errors import InputError
from shootstab.core.progress import StepDone
from shootstab.formulation.asymptotic_digits import AsymptoticSpaceInDigits
from shootstab.formulation.asymptotic_end import AsymptoticEnd
from shootstab.formulation.base_digits import FlowDigits, FlowSeries
from shootstab.formulation.decaying_digits import DecayingSpaceInDigits, LogarithmsError
from shootstab.formulation.exponentials import ExponentialEnd
from shootstab.formulation.expression import Expression
from shootstab.formulation.null_space import null_space
from shootstab.formulation.regular_digits import RegularStart
from shootstab.formulation.series_digits import on_numbers, on_series
from shootstab.formulation.state_pencil import Powers, StatePencil
from shootstab.multiprecision.arithmetic import Arithmetic, Matrix
from shootstab.multiprecision.integration import BaseFlowNumbers, Expansion, UnknownRows
from shootstab.multiprecision.settings import Settings
from shootstab.multiprecision.taylor import Taylor, real_series


class Beginning(Protocol):
    """How a subdomain begins, in one arithmetic."""

    @property
    def place(self) -> Fraction:
        """The z at which the subdomain begins."""
        ...

    def begin(self, sigma: Any) -> None:
        """Choose the place, so that the frame holds there at σ."""
        ...

    def frame(self, sigma: Any) -> tuple[Matrix, Any]:
        """The solutions (n, k) with which it begins, or (2n, n) beside their starting values, and the factor of their determinant."""
        ...


class Begin(Protocol):
    """What a subdomain begins with, in any arithmetic."""

    def beginning(
        self, arithmetic: Arithmetic, settings: Settings, system: StatePencil, target: Fraction, flow: FlowSeries | None
    ) -> Beginning:
        """The beginning in one arithmetic, on a base flow."""
        ...


@dataclass(frozen=True, eq=False)
class AtInfinity:
    """An end at infinity at which so many solutions decay: by series in an exponential, or in inverse powers of the coordinate."""

    end: ExponentialEnd | None
    powers: AsymptoticEnd | None
    columns: int

    def beginning(
        self, arithmetic: Arithmetic, settings: Settings, system: StatePencil, target: Fraction, flow: FlowSeries | None
    ) -> Beginning:
        ways: list[Beginning] = []
        if self.end is not None:
            ways.append(DecayingSpaceInDigits(arithmetic, settings, self.end, system.size, self.columns, target, flow))
        if self.powers is not None:
            ways.append(AsymptoticSpaceInDigits(arithmetic, settings, self.powers, system, self.columns, target))
        return ways[0] if len(ways) == 1 else _FirstThatHolds(ways[0], ways[1])


class _FirstThatHolds:
    """See Beginning: the first of two, or the second where solutions of the first have logarithms."""

    def __init__(self, first: Beginning, second: Beginning) -> None:
        self._chosen, self._second = first, second

    @property
    def place(self) -> Fraction:
        return self._chosen.place

    def begin(self, sigma: Any) -> None:
        try:
            self._chosen.begin(sigma)
        except LogarithmsError:
            self._chosen = self._second
            self._chosen.begin(sigma)

    def frame(self, sigma: Any) -> tuple[Matrix, Any]:
        return self._chosen.frame(sigma)


@dataclass(frozen=True, eq=False)
class AtSingularEnd:
    """A regular singular end; the domain goes from it in this direction."""

    at: Fraction
    direction: int
    start: RegularStart

    def beginning(
        self, arithmetic: Arithmetic, settings: Settings, system: StatePencil, target: Fraction, flow: FlowSeries | None
    ) -> Beginning:
        place = self.at + self.direction * self.start.x / Fraction(2) ** round(settings.far_shift)
        return _FixedBeginning(place, lambda sigma: self.start.frame(arithmetic, settings, sigma), arithmetic.number(1))


@dataclass(frozen=True, eq=False)
class AtWall:
    """A place with so many conditions that do not hold the eigenvalue."""

    at: Fraction
    rows: Mapping[tuple[int, int], Expression]
    count: int

    def beginning(
        self, arithmetic: Arithmetic, settings: Settings, system: StatePencil, target: Fraction, flow: FlowSeries | None
    ) -> Beginning:
        place, nothing, n = arithmetic.number(self.at), arithmetic.number(0), system.size
        at = on_numbers(arithmetic, place, None if flow is None else flow.at(place))
        found = null_space(
            arithmetic, [[at(self.rows[i, j]) if (i, j) in self.rows else nothing for j in range(n)] for i in range(self.count)], n
        )
        return _FixedBeginning(self.at, lambda sigma: found, arithmetic.number(1))


@dataclass(frozen=True, eq=False)
class AugmentedBeginning:
    """A place at which all solutions begin, beside their starting values."""

    at: Fraction

    def beginning(
        self, arithmetic: Arithmetic, settings: Settings, system: StatePencil, target: Fraction, flow: FlowSeries | None
    ) -> Beginning:
        identity = [[arithmetic.number(int(i == j)) for j in range(system.size)] for i in range(system.size)]
        return _FixedBeginning(self.at, lambda sigma: [*identity, *[list(row) for row in identity]], arithmetic.number(1))


class _FixedBeginning:
    """See Beginning: one whose place does not depend on σ."""

    def __init__(self, place: Fraction, made: Any, factor: Any) -> None:
        self.place, self._made, self._factor = place, made, factor

    def begin(self, sigma: Any) -> None:
        """Nothing: this place does not depend on σ."""

    def frame(self, sigma: Any) -> tuple[Matrix, Any]:
        return self._made(sigma), self._factor


@dataclass(frozen=True, eq=False)
class DigitSubdomain:
    """One subdomain: the system that holds in it, what it begins with, and where it arrives."""

    system: StatePencil
    begin: Begin
    target: Fraction

    @property
    def size(self) -> int:
        """The number of components, starting values among them."""
        return self.system.size * (1 + isinstance(self.begin, AugmentedBeginning))


@dataclass(frozen=True, eq=False)
class ArrivalConditions:
    """Conditions where all arrive: by powers of σ, entries by (row, component of all subdomains); the coordinate in them is at."""

    rows: Powers
    count: int
    at: Fraction


def _holds_functions(parts: Powers) -> bool:
    return any(atom.kind == "given" for part in parts for entry in part.values() for atom in entry.atoms())


class SubdomainDigits:
    """See multiprecision.integration.MultiprecisionProblem."""

    real = False

    def __init__(self, subdomains: Sequence[DigitSubdomain], arrivals: Sequence[ArrivalConditions], flow: FlowDigits | None = None) -> None:
        self._subdomains, self._arrivals, self._flow = subdomains, arrivals, flow
        self.size = sum(subdomain.size for subdomain in subdomains)

    def base(self, arithmetic: Arithmetic, settings: Settings, progress: StepDone) -> BaseFlowNumbers:
        return () if self._flow is None else self._flow.base(arithmetic, settings, progress)

    def integration(self, arithmetic: Arithmetic, settings: Settings, base: BaseFlowNumbers) -> SubdomainIntegration:
        flow = None if self._flow is None else self._flow.series(arithmetic, settings, base)
        return SubdomainIntegration(arithmetic, settings, self._subdomains, self._arrivals, flow)


class SubdomainIntegration:
    """See multiprecision.integration.Integration."""

    def __init__(
        self,
        arithmetic: Arithmetic,
        settings: Settings,
        subdomains: Sequence[DigitSubdomain],
        arrivals: Sequence[ArrivalConditions],
        flow: FlowSeries | None,
    ) -> None:
        self._arithmetic, self._settings, self._subdomains, self._arrivals = arithmetic, settings, subdomains, arrivals
        self._flow = flow
        self._over = [(s, flow if _holds_functions((*s.system.C, *s.system.D)) else None) for s in subdomains]  # known where it is held
        self._beginnings = [s.begin.beginning(arithmetic, settings, s.system, s.target, flow) for s, flow in self._over]
        self._t = arithmetic.number(0)
        self._step = arithmetic.number(1) / settings.order  # a first trial; steps double from there

    def begin(self, sigma: Any) -> None:
        for beginning in self._beginnings:
            beginning.begin(sigma)

    def far_frame(self, sigma: Any) -> tuple[Matrix, Any]:
        found = [beginning.frame(sigma) for beginning in self._beginnings]
        width, before, whole = sum(len(frame[0]) for frame, _ in found), 0, []
        factor, nothing = self._arithmetic.number(1), self._arithmetic.number(0)
        for frame, own in found:
            after = width - before - len(frame[0])
            whole += [[*[nothing] * before, *row, *[nothing] * after] for row in frame]
            before += len(frame[0])
            factor = factor * own
        return whole, self._arithmetic.rounded(factor)

    def expand(self, longest: float) -> Expansion:
        arithmetic = self._arithmetic
        left = 1 - self._t
        limit = arithmetic.number(longest) if longest < 1.0 else left
        h = min((self._step, limit, left), key=arithmetic.log2)
        self._h = h
        powers = max(len(subdomain.system.C) for subdomain in self._subdomains)
        C: list[dict[tuple[int, int], Taylor]] = [{} for _ in range(powers)]
        D: list[dict[tuple[int, int], Taylor]] = [{} for _ in range(powers)]
        shift = 0
        for (subdomain, flow), beginning in zip(self._over, self._beginnings, strict=True):
            system = subdomain.system
            way = arithmetic.number(subdomain.target - beginning.place)
            here = arithmetic.number(beginning.place) + way * self._t
            z = real_series(arithmetic, [here, way * h] + [arithmetic.number(0)] * (self._settings.order - 2))
            at = on_series(arithmetic, z, fields=None if flow is None else flow.along(z))
            for still in range(subdomain.size - system.size):
                C[0][shift + still, shift + still] = 0 * z + 1
            shift += subdomain.size - system.size
            for out, parts, factor in ((C, system.C, 1), (D, system.D, way)):
                for whole, part in zip(out, parts, strict=False):
                    whole.update({(i + shift, j + shift): factor * e for (i, j), e in _evaluated(part, at, z).items()})
            shift += system.size
        return Expansion(h, C, D, arithmetic.log2(left - h) == float("-inf"))

    def advance(self) -> None:
        self._t = self._arithmetic.rounded(self._t + self._h)
        self._step = 2 * self._h

    def unknowns(self, sigma: Any) -> UnknownRows:
        told = "an eigenfunction in many digits is not offered with an end at infinity, in layers, or between two singular ends"
        raise InputError(f"{told}: allowed are finite ends of which one holds conditions, or doubles")

    def farther(self, sigma: Any, c: Matrix, distance: Any) -> None:
        """No solution is kept."""

    @property
    def wall(self) -> Any:
        """Where all subdomains arrive, in t."""
        return self._arithmetic.number(1)

    def wall_rows(self) -> list[Matrix]:
        arithmetic, width = self._arithmetic, sum(subdomain.size for subdomain in self._subdomains)
        powers = max(len(arrival.rows) for arrival in self._arrivals)
        out: list[Matrix] = [[] for _ in range(powers)]
        for arrival in self._arrivals:
            place = arithmetic.number(arrival.at)
            flow = self._flow if _holds_functions(arrival.rows) else None
            at = on_numbers(arithmetic, place, None if flow is None else flow.at(place))
            for power, whole in enumerate(out):
                part = arrival.rows[power] if power < len(arrival.rows) else {}
                values = {entry: arithmetic.number(1) * at(part[entry]) for entry in part}
                whole += [[values.get((i, j), arithmetic.number(0)) for j in range(width)] for i in range(arrival.count)]
        return out

    def corrected_base(self) -> BaseFlowNumbers:
        return () if self._flow is None else self._flow.corrected()


def _evaluated(part: Mapping[tuple[int, int], Expression], at: Any, z: Taylor) -> dict[tuple[int, int], Taylor]:
    values = {place: at(entry) for place, entry in part.items()}
    return {place: value if isinstance(value, Taylor) else 0 * z + value for place, value in values.items()}
