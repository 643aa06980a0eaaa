"""A stability problem from its equations as they are printed: see `equations`."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import InputError
from shootstab.core.regions import Rectangle
from shootstab.formulation.base_solution import functions
from shootstab.formulation.condition_count import require_count
from shootstab.formulation.conditions import CoupledEnd
from shootstab.formulation.continuous_spectrum import InteriorSpectrum
from shootstab.formulation.coupled_ends import coupled_rows
from shootstab.formulation.digits_of import digits_of
from shootstab.formulation.enclosed_problems import enclosed, varied, varies, with_polynomials
from shootstab.formulation.equation_collocation import EquationCollocation, offered
from shootstab.formulation.equation_family import EquationFamily, family_around
from shootstab.formulation.evaluation import Given
from shootstab.formulation.explanation import Lines, explanation, rates_at
from shootstab.formulation.first_order import FirstOrder
from shootstab.formulation.laid_out import laid_out
from shootstab.formulation.recorded_states import recorded_pencil
from shootstab.formulation.reduced_layers import ReducedLayer, curves_along, pencil_of, reduced_layers
from shootstab.formulation.state_pencil import Condition, StatePencil, in_states, state_pencil
from shootstab.formulation.stated_unknowns import unknowns_of
from shootstab.formulation.statement import Statement, stated
from shootstab.formulation.system import EquationRow
from shootstab.formulation.walls import require_finite, require_independent_ends
from shootstab.problems.knots import as_knots
from shootstab.problems.linear_problem import MOST_STATES, LinearProblem
from shootstab.problems.pencil_function import PencilFunction
from shootstab.problems.protocol import ComplexArray
from shootstab.problems.recorded_pencil import RecordedPencil
from shootstab.problems.singular_curve import ContinuumOnLine
from shootstab.problems.two_point import TwoPointReduction

if TYPE_CHECKING:
    from shootstab.multiprecision.enclosable import Enclosable
    from shootstab.multiprecision.integration import MultiprecisionProblem


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class EquationProblem(LinearProblem):
    """A problem made by `equations`: the engine's view of it, what the reduction found, and what the user wrote.

    states is the system of the first layer with the conditions; posed are the arguments of `equations`.
    """

    statement: Statement
    layers: tuple[ReducedLayer, ...]
    conditions: tuple[list[Condition], list[Condition]]
    states: StatePencil
    coupled: Sequence[EquationRow] = ()
    posed: Mapping[str, Any] | None = None

    @property
    def first_order(self) -> FirstOrder:
        """The first-order system, that of the first layer."""
        return self.layers[0].first_order

    @property
    def spectrum_inside(self) -> InteriorSpectrum:
        """Where C is singular in the first layer."""
        return self.layers[0].spectrum_inside

    def with_parameters(self, values: Mapping[str, complex]) -> EquationProblem:
        """The problem with other values of some of its parameters, which may be complex. Raises InputError for a name that is none."""
        if self.posed is None:
            raise InputError("this problem comes from a statement: allowed is one made by st.equations")
        return remade(self.posed, values)

    @property
    def family(self) -> Callable[[tuple[str, ...]], EquationFamily] | None:
        """The problems that differ in parameters, for sweeps."""
        return None if self.posed is None else partial(family_around, self.posed, make=remade)

    @property
    def continuum(self) -> ContinuumOnLine | None:
        """The continuous spectrum, as for any problem; None where C is singular on several curves, or on one with a pole: see crossings."""
        return super().continuum if self.spectrum_inside.single and not self.spectrum_inside.through_infinity else None

    @property
    def explanation(self) -> Lines:
        """What the reduction found, in words."""
        told = explanation(self.statement, self.layers, self.conditions, self.states, self.coupled)
        return [*told, *rates_at(self.ends(self.generic_sigma), self.statement.names.eigenvalue, self.generic_sigma)]

    @cached_property
    def pseudospectral(self) -> EquationCollocation | None:
        """The equations as they stand, by collocation. None where it is refused: see why_not."""
        return offered(self.statement)[0]

    @property
    def why_not(self) -> Mapping[str, str]:
        """Why capabilities are not offered, by their names."""
        return offered(self.statement)[1]

    @cached_property
    def knots(self) -> NDArray[np.float64]:
        """The knots (k,) of functions that no formula defines, those given, and interfaces; what formulas define is analytic."""
        return super().knots if self.statement.doubles_only else np.unique(np.concatenate((self.given, self.reduction.jumps)))

    @cached_property
    def recorded(self) -> RecordedPencil | None:
        """The entries as programs of what varies with z; None in layers and across interfaces."""
        return recorded_pencil(self.states, self.layers[0].domain, self.reduction) if len(self.layers) == 1 else None

    @property
    def unchanging(self) -> bool:
        """Whether formulas define all of it."""
        return not self.statement.doubles_only

    @property
    def multiprecision(self) -> Callable[[], MultiprecisionProblem]:
        """The problem's expressions on power series. What it returns raises InputError, with the reason, where there is no such way."""
        return partial(digits_of, self.statement, self.states, self.layers, self.reduction, self.coupled)

    @property
    def enclosable(self) -> Enclosable | None:
        """The problem's expressions in balls. None where a function is given to doubles only, an end is singular, without
        rational coefficients, or at infinity without an exponential limit, or the eigenvalue stands in a denominator.
        """
        return enclosed(self.statement, self.layers, self.states, self.ends, self.generic_sigma, self.coupled)

    def polynomial_pencil(self) -> dict[str, Any]:
        """The problem as the checker of certificates takes it. Raises InputError where it has no such form."""
        return with_polynomials(self.statement, self.states, self.ends(self.generic_sigma), self.first_order.states)

    @cached_property
    def growing_region(self) -> Callable[..., tuple[Rectangle, str]] | None:
        """growing_region(floor): see problems.capabilities. None where the numerical range of the equations bounds no growing modes."""
        from shootstab.formulation.growth_bound import growing_region

        return growing_region(self.statement)

    @property
    def varied(self) -> Callable[[str], Callable[[Any], Enclosable]] | None:
        """varied(name)(p) is the problem in balls with another value p, an acb, of that parameter. None as for `enclosable`."""
        return partial(varied, self.statement) if self.enclosable and varies(self.statement) else None

    @property
    def crossings(self) -> tuple[tuple[NDArray[np.float64], ComplexArray], ...]:
        """The curves (z, σ_c(z)), each (m,), as for any problem; where C is singular on several curves, or in layers, all of them."""
        if len(self.layers) == 1 and self.spectrum_inside.through_infinity:
            return self.spectrum_inside.stretches
        if len(self.layers) == 1 and (self.spectrum_inside.single or not self.spectrum_inside.curves):
            return super().crossings
        return curves_along(self.layers, self.reduction.lines)


def equations(
    unknowns: Sequence[str],
    equations: Sequence[Any],
    left: Any,
    right: Any,
    *,
    interfaces: Sequence[Any] = (),
    coupled: Sequence[Any] = (),
    parameters: Mapping[str, Any] | None = None,
    where: Mapping[str, Any] | None = None,
    eigenvalue: str = "sigma",
    variable: str = "z",
    given: Given | None = None,
    base: Mapping[str, Any] | None = None,
    fold: float | None = None,
    reference: complex | None = None,
    knots: Sequence[float] = (),
) -> EquationProblem:
    """The eigenvalue problem that equations linear in the unknowns and their derivatives pose, with conditions in the same language.

    Equations and conditions are text (see grammar.py) or SymPy expressions, and stand for 'vanishes'. The eigenvalue may occur to any
    natural power. parameters are numbers, where holds definitions by name. An end is Conditions(at, [...]), Infinity(), or Axis(at), a
    regular singular point of the equations at which solutions are regular; or both ends are Periodic(at). interfaces divide the domain
    into layers, in which parameters and definitions that are lists have one value each: see joints.py. coupled are conditions that join
    values left(f) and right(f) at two finite ends, which may then have none of their own: see coupled_conditions.py. given are
    functions of the coordinate that no formula defines, as name: f(z, order) ↦ the derivative of that order, for arrays z; one with
    knots, as a `profile` has them, has a jump in one of its derivatives there. base is a flow that solves ordinary differential equations
    of its own, whose unknowns are functions in the equations: see base_table.py. fold, reference and knots are those of `problem`.

    Raises InputError, which names the equation or condition and the place: an unknown name, a term that is not linear, as many equations
    as unknowns, dependent equations, a point at which the order changes, and conditions that are too many, too few, or say nothing.
    """
    posed = {
        "unknowns": unknowns,
        "equations": equations,
        "left": left,
        "right": right,
        "interfaces": interfaces,
        "coupled": coupled,
        "parameters": parameters or {},
        "where": where or {},
        "eigenvalue": eigenvalue,
        "variable": variable,
        "given": given or {},
        "base": base,
        "fold": fold,
        "reference": reference,
        "knots": knots,
    }
    tables = parameters or {}, where or {}
    statement = stated(unknowns, equations, left, right, interfaces, *tables, eigenvalue, variable, given or {}, base, coupled)
    return assembled(statement, fold, reference, posed, knots=knots)


def remade(posed: Mapping[str, Any], values: Mapping[str, complex]) -> EquationProblem:
    """The problem that these arguments of `equations` pose, with other parameters. Raises InputError for a name that is none."""
    for name in values:
        if name not in posed["parameters"]:
            listed = ", ".join(posed["parameters"]) or "none, for the problem has no parameters"
            raise InputError(f"{name} is no parameter of the equations: allowed is {listed}")
    return equations(**{**posed, "parameters": {**posed["parameters"], **values}})


def assembled(
    statement: Statement,
    fold: float | None = None,
    reference: complex | None = None,
    posed: Mapping[str, Any] | None = None,
    reduced: tuple[ReducedLayer, ...] | None = None,
    knots: Sequence[float] = (),
    starts: Mapping[int, float] = MappingProxyType({}),
) -> EquationProblem:
    """The reduction of a statement, or that which is known, and the problem that it makes; starts are of ends at infinity, by side."""
    domain = statement.domain
    layers = reduced_layers(statement.layers) if reduced is None else reduced
    first, spectrum = layers[0].first_order, layers[0].spectrum_inside
    conditions = [
        in_states(list(rows), layer.first_order)
        for rows, layer in zip((statement.left_rows, statement.right_rows), (layers[0], layers[-1]), strict=True)
    ]
    ends = statement.left, statement.right
    require_count(first, statement, conditions)
    system = state_pencil(first, conditions[0], conditions[1])
    if system.size > MOST_STATES:
        raise InputError(f"the equations have {system.size} states: allowed are at most {MOST_STATES}")
    systems = [system, *(layer.states for layer in layers[1:])]
    matrices = PencilFunction(system.size, pencil_of(systems, [layer.domain for layer in layers]), vectorized=True)
    require_finite(matrices, statement)
    require_independent_ends(statement, first, conditions)
    curve: Callable[[Any], Any] | None = spectrum.curve if spectrum.curves and len(layers) == 1 else None
    own = statement.left_rows, statement.right_rows
    coupled: list[EquationRow] = []
    if isinstance(ends[0], CoupledEnd) and isinstance(ends[1], CoupledEnd):
        coupled = coupled_rows((ends[0], ends[1]), own, statement.coupled, first, statement.names)
    reduction = laid_out(statement, layers, systems, matrices, coupled, fold, reference, starts)
    has_own_flow = statement.base is not None and reduced is None
    coarser = partial(_on_another_flow, statement, fold, reference, layers, knots, reduction) if has_own_flow else None
    # layers find unknowns that were removed each in its own way, so only those that are states are shown across layers
    shown_unknowns = [name for name in statement.names.unknowns if not statement.joints or (name, 0) in first.states]
    return EquationProblem(
        matrices,
        reduction,
        curve,
        coarser=coarser,
        unknowns=unknowns_of(shown_unknowns, first, system.size, domain.given, statement.names.variable),
        statement=statement,
        layers=layers,
        conditions=(conditions[0], conditions[1]),
        states=system,
        coupled=coupled,
        posed=posed,
        given=(*as_knots(knots, domain.left, domain.right), *(k for f in domain.given.values() for k in getattr(f, "knots", ()))),
    )


def _on_another_flow(
    statement: Statement,
    fold: float | None,
    reference: complex | None,
    layers: tuple[ReducedLayer, ...],
    knots: Sequence[float],
    own: TwoPointReduction,
    factor: float,
) -> LinearProblem:
    """The problem on a base flow that is off by so many roundings; its ends at infinity begin where they did: D has its factor."""
    given: Given = {**statement.domain.given, **functions(statement.base, factor)}
    other = replace(statement, domain=replace(statement.domain, given=given))
    changed = tuple(replace(x, domain=replace(x.domain, given=given)) for x in layers)
    made = assembled(other, fold, own.reference or reference, reduced=changed, knots=knots, starts=own.starts)
    if all(map(math.isfinite, (statement.domain.left, statement.domain.right))):
        return made
    return replace(made, reduction=replace(made.reduction, subdomains=own.subdomains, start=own.start, end=own.end))
