"""A stability problem from its equations as they are printed: see `equations`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import InputError
from shootstab.formulation.axis import RegularSpace
from shootstab.formulation.conditions import Axis, Conditions, Periodic
from shootstab.formulation.continuous_spectrum import InteriorSpectrum, interior_spectrum
from shootstab.formulation.digits import EquationDigits
from shootstab.formulation.equation_collocation import Collocation, collocation
from shootstab.formulation.evaluation import Given, filled, on_arrays
from shootstab.formulation.explanation import Lines, explanation
from shootstab.formulation.first_order import FirstOrder, first_order
from shootstab.formulation.gaussian import Gaussian
from shootstab.formulation.limits import with_limit
from shootstab.formulation.regular_digits import RegularStart
from shootstab.formulation.singular_ends import between_periodic_ends, between_singular_ends, singular_end
from shootstab.formulation.state_pencil import Condition, Powers, StatePencil, in_states, state_pencil
from shootstab.formulation.stated_unknowns import unknowns_of
from shootstab.formulation.statement import Statement, stated
from shootstab.formulation.system import degree, shown
from shootstab.problems.ends import Infinity, Wall
from shootstab.problems.linear_problem import MOST_STATES, LinearProblem
from shootstab.problems.pencil_function import PencilFunction
from shootstab.problems.protocol import ComplexArray
from shootstab.problems.singular_curve import ContinuumOnLine
from shootstab.problems.two_point import reduce_to_two_points

if TYPE_CHECKING:
    from shootstab.multiprecision.enclosable import Enclosable


@dataclass(frozen=True, eq=False, kw_only=True)
class EquationProblem(LinearProblem):
    """A problem made by `equations`: the engine's view of it, what the reduction found, and what the user wrote."""

    statement: Statement
    first_order: FirstOrder
    conditions: tuple[list[Condition], list[Condition]]
    states: StatePencil
    spectrum_inside: InteriorSpectrum

    @property
    def continuum(self) -> ContinuumOnLine | None:
        """As for any problem; None where C is singular on several curves, which are crossings."""
        return super().continuum if self.spectrum_inside.single else None

    @property
    def explanation(self) -> Lines:
        """What the reduction found, in words."""
        told = explanation(self.statement, self.first_order, self.conditions, self.states, self.spectrum_inside)
        at_ends = [
            (
                f"at {at.where}",
                f"{at.decaying} of {len(at.rates)} solutions decay at {self.statement.names.eigenvalue} = {self.generic_sigma:.4g}, "
                f"the rates are {', '.join(f'{rate:.4g}' for rate in at.rates)}",
            )
            for at in self.ends(self.generic_sigma)
        ]
        return [*told, *at_ends]

    @cached_property
    def pseudospectral(self) -> Collocation | None:
        """The equations as they stand, by collocation. None with an end at infinity."""
        return collocation(self.statement)

    @property
    def multiprecision(self) -> Callable[[], EquationDigits] | None:
        """The same expressions on power series. None where a function is given to doubles only, an end is at infinity, both
        are singular, or the exponents of one are no integers."""
        ends = self.statement.left, self.statement.right
        places = [Fraction(Gaussian.of(end.at).re) for end in ends if not isinstance(end, Infinity)]
        if self.statement.domain.given or len(places) < 2 or not any(self.statement.holding):
            return None
        if all(self.statement.holding):
            return lambda: EquationDigits(self.states, places[0], places[1])
        space = self.reduction.subdomains[0].far
        if not isinstance(space, RegularSpace) or not space.end.integer:
            return None
        start = RegularStart(space.end, Fraction(space.x))
        return lambda: EquationDigits(self.states, places[0], places[1], start, backwards=self.statement.holding[0])

    @property
    def enclosable(self) -> Enclosable | None:
        """The same expressions in balls. None where a function is given to doubles only, or an end has no conditions."""
        if self.statement.domain.given or not all(self.statement.holding):
            return None
        from shootstab.formulation.enclosed import EquationEnclosable

        left, right = (
            Fraction(Gaussian.of(end.at).re) for end in (self.statement.left, self.statement.right) if isinstance(end, Conditions)
        )
        return EquationEnclosable(self.states, left, right)

    @property
    def crossings(self) -> tuple[tuple[NDArray[np.float64], ComplexArray], ...]:
        """As for any problem, (z, σ_c(z)), each (m,); where C is singular on several curves, all of them."""
        if self.spectrum_inside.single or not self.spectrum_inside.curves:
            return super().crossings
        return tuple((z.real, branch) for z in self.reduction.lines for branch in self.spectrum_inside.branches(z))


def equations(
    unknowns: Sequence[str],
    equations: Sequence[Any],
    left: Any,
    right: Any,
    *,
    parameters: Mapping[str, Any] | None = None,
    where: Mapping[str, Any] | None = None,
    eigenvalue: str = "sigma",
    variable: str = "z",
    given: Given | None = None,
    fold: float = 0.0,
    reference: complex | None = None,
) -> EquationProblem:
    """The eigenvalue problem that equations linear in the unknowns and their derivatives pose, with conditions in the same language.

    Equations and conditions are text (see grammar.py) or SymPy expressions, and stand for 'vanishes'. The eigenvalue may occur to any
    natural power. parameters are numbers, where holds definitions by name. An end is Conditions(at, [...]), Infinity(), or Axis(at), a
    regular singular point of the equations at which solutions are regular; or both ends are Periodic(at). given are
    functions of the coordinate that no formula defines, as name: f(z, order) ↦ the derivative of that order, for arrays z. fold and
    reference are those of `problem`.

    Raises InputError, which names the equation or condition and the place: an unknown name, a term that is not linear, as many equations
    as unknowns, dependent equations, a point at which the order changes, and conditions that are too many, too few, or say nothing.
    """
    statement = stated(unknowns, equations, left, right, parameters or {}, where or {}, eigenvalue, variable, given or {})
    return assembled(statement, fold, reference)


def assembled(statement: Statement, fold: float = 0.0, reference: complex | None = None) -> EquationProblem:
    """The reduction of a statement, and the problem that it makes."""
    domain = statement.domain
    first = first_order(statement.system, domain.vanishing, domain.regular)
    spectrum = interior_spectrum(first, domain, statement.names.variable)
    conditions = [in_states(list(rows), first) for rows in (statement.left_rows, statement.right_rows)]
    ends = statement.left, statement.right
    _require_count(first, statement, conditions)
    system = state_pencil(first, conditions[0], conditions[1])
    if system.size > MOST_STATES:
        raise InputError(f"the equations have {system.size} states: allowed are {MOST_STATES}")
    matrices = PencilFunction(system.size, pencil_of(system, domain.given), vectorized=True)
    _require_finite(system, statement)
    curve: Callable[[Any], Any] | None = spectrum.curve if spectrum.curves else None
    made: list[Any] = []
    for end, rows, count, side in zip(ends, (system.left, system.right), (system.left_rows, system.right_rows), (-1, 1), strict=True):
        if isinstance(end, Conditions):
            made.append(_wall(end.at, rows, count, system.size, domain.given))
        elif isinstance(end, Axis):
            bounded = [i for i, (name, order) in enumerate(first.states) if order == 0 and name in statement.names.unknowns]
            made.append(singular_end(system, end.at, -side, bounded, f"{statement.names.variable} = {end.at:g}", domain))
        elif isinstance(end, Infinity):
            made.append(with_limit(end, matrices, side))
    if isinstance(ends[0], Periodic) and isinstance(ends[1], Periodic):
        reduction = between_periodic_ends(matrices, ends[0].at, ends[1].at)
    elif any(isinstance(end, Axis) for end in ends):
        if spectrum.curves:
            raise InputError("C is singular for some sigma at every point up to a regular singular end: that is not offered")
        reduction = between_singular_ends(system.size, made[0], made[1])
    else:
        reduction = reduce_to_two_points(matrices, made[0], made[1], (), fold, reference)
    return EquationProblem(
        matrices,
        reduction,
        curve,
        unknowns=unknowns_of(statement.names.unknowns, first, system.size, domain.given),
        statement=statement,
        first_order=first,
        conditions=(conditions[0], conditions[1]),
        states=system,
        spectrum_inside=spectrum,
    )


def pencil_of(system: StatePencil, given: Given) -> Callable[[ComplexArray], tuple[ComplexArray, ...]]:
    """C0, C1, …, D0, D1, … as a function of z (m,), real or complex."""

    def pencil(z: ComplexArray) -> tuple[ComplexArray, ...]:
        at = on_arrays(z, given)
        return tuple(filled(part, (system.size, system.size), z, at) for part in (*system.C, *system.D))

    return pencil


def _require_finite(system: StatePencil, statement: Statement) -> None:
    """Raise InputError where the coefficients are not finite at an end with conditions."""
    for side, end in (("left", statement.left), ("right", statement.right)):
        if isinstance(end, Conditions):
            parts = pencil_of(system, statement.domain.given)(np.array([complex(end.at)]))
            if not all(np.isfinite(part).all() for part in parts):
                place = f"{statement.names.variable} = {end.at:g}"
                raise InputError(f"at the {side} end, {place}, the equations are singular: allowed is st.Axis({end.at:g}), or another end")


def _wall(z: float, rows: Powers, count: int, size: int, given: Given) -> Wall:
    place = np.array([float(z)])
    at = on_arrays(place, given)
    W0, *later = (filled(part, (count, size), place.astype(np.complex128), at)[0] for part in rows)
    return Wall(float(z), W0, np.array(later))


def _require_count(first: FirstOrder, statement: Statement, conditions: list[list[Condition]]) -> None:
    """As many conditions as the order, where both ends are finite; at an end at infinity the count is that of what decays."""
    left, right = len(statement.left_rows), len(statement.right_rows)
    names = statement.names
    held = [*first.C.values(), *first.D.values(), *(c for rows in conditions for row in rows for c in row.values())]
    if not any(degree(c) for c in held):
        raise InputError(
            f"neither the equations nor the conditions hold the eigenvalue {names.eigenvalue}: they pose no eigenvalue problem"
        )
    for side, count, other in (("left", left, right), ("right", right, left)):
        if all(statement.holding) and count == 0 and other == first.order:
            raise InputError(
                f"all {other} conditions stand at one end: an initial-value problem, whose only solution is zero whatever "
                f"{names.eigenvalue} is; it has no eigenvalues"
            )
        if statement.holding[side == "right"] and count == 0:
            raise InputError(f"{side} has no conditions: allowed is at least one (the order of the equations is {first.order})")
        if count > first.order:
            raise InputError(f"{side} has {count} conditions: allowed are {first.order}, the order of the equations")
    if all(statement.holding) and left + right != first.order:
        listed = ", ".join(shown(state) for state in first.states)
        told = f"{left} conditions at the left end and {right} at the right"
        raise InputError(f"{told}: allowed are {first.order} in all, the order of the equations, whose states are {listed}")
