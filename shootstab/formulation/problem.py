"""A stability problem from its equations as they are printed: see `equations`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import InputError
from shootstab.formulation.affine import AffineSystem, affine
from shootstab.formulation.conditions import Conditions, End, end_of, in_states, rows_of
from shootstab.formulation.continuous_spectrum import InteriorSpectrum, interior_spectrum
from shootstab.formulation.digits import EquationDigits
from shootstab.formulation.domain import Domain
from shootstab.formulation.evaluation import Given, filled, on_arrays
from shootstab.formulation.first_order import FirstOrder, first_order
from shootstab.formulation.gaussian import Gaussian
from shootstab.formulation.limits import with_limit
from shootstab.formulation.names import Names
from shootstab.formulation.system import Row, System
from shootstab.problems.ends import Infinity, Wall
from shootstab.problems.linear_problem import LinearProblem
from shootstab.problems.pencil_function import PencilFunction
from shootstab.problems.protocol import ComplexArray
from shootstab.problems.two_point import reduce_to_two_points

LARGEST = 64  # states, as problems.linear_problem has it


@dataclass(frozen=True, eq=False)
class Formulation:
    """A problem as the user wrote it, read: equations and conditions as rows over the unknowns, the ends, given functions."""

    names: Names
    system: System
    left: End
    right: End
    left_rows: tuple[tuple[str, Row], ...]
    right_rows: tuple[tuple[str, Row], ...]
    domain: Domain


@dataclass(frozen=True, eq=False, kw_only=True)
class EquationProblem(LinearProblem):
    """A problem made by `equations`: the engine's view of it, what the reduction found, and what the user wrote."""

    formulation: Formulation
    first_order: FirstOrder
    affine: AffineSystem
    spectrum_inside: InteriorSpectrum

    def heights(self, points: int) -> NDArray[np.float64] | None:
        return super().heights(points) if self.spectrum_inside.single else None

    @property
    def multiprecision(self) -> Callable[[], EquationDigits] | None:
        """The same expressions on power series. None where a function is given to doubles only, or an end is at infinity."""
        ends = self.formulation.left, self.formulation.right
        if self.formulation.domain.given or not all(isinstance(end, Conditions) for end in ends):
            return None
        left, right = (Gaussian.of(end.at).re for end in ends if isinstance(end, Conditions))
        return lambda: EquationDigits(self.affine, Fraction(left), Fraction(right))

    @property
    def crossings(self) -> tuple[tuple[NDArray[np.float64], ComplexArray], ...]:
        """As for any problem; where C is singular on several curves, all of them."""
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
    natural power. parameters are numbers, where holds definitions by name. An end is Conditions(at, [...]) or Infinity(). given are
    functions of the coordinate that no formula defines, as name: f(z, order) ↦ the derivative of that order, for arrays z. fold and
    reference are those of `problem`.

    Raises InputError, which names the equation or condition and the place: an unknown name, a term that is not linear, as many equations
    as unknowns, dependent equations, a point at which the order changes, and conditions that are too many, too few, or say nothing.
    """
    names = Names(_names(unknowns), dict(parameters or {}), dict(where or {}), eigenvalue, variable, tuple(given or ()))
    if isinstance(equations, str) or not isinstance(equations, Sequence):
        raise InputError(f"equations = {equations!r}: allowed is a list of formulas")
    ends = end_of(left, "left"), end_of(right, "right")
    low = ends[0].at if isinstance(ends[0], Conditions) else -np.inf
    high = ends[1].at if isinstance(ends[1], Conditions) else np.inf
    if not low < high:
        raise InputError(f"the ends lie at {variable} = {low:g} and {high:g}: allowed is a left end below the right one")
    read = {f"equation {i}": names.expression(e, f"equation {i}") for i, e in enumerate(equations, 1)}
    system = System.of(names.unknowns, read)
    rows = [tuple(rows_of(end, side, names)) for end, side in zip(ends, ("left", "right"), strict=True)]
    formulation = Formulation(names, system, *ends, rows[0], rows[1], Domain(float(low), float(high), dict(given or {})))
    return assembled(formulation, fold, reference)


def assembled(formulation: Formulation, fold: float = 0.0, reference: complex | None = None) -> EquationProblem:
    """The reduction of a formulation, and the problem that it makes."""
    domain = formulation.domain
    first = first_order(formulation.system, domain.vanishing, domain.regular)
    spectrum = interior_spectrum(first, domain, formulation.names.variable)
    conditions = [in_states(list(rows), first) for rows in (formulation.left_rows, formulation.right_rows)]
    ends = formulation.left, formulation.right
    finite = [isinstance(end, Conditions) for end in ends]
    _require_count(first, formulation, finite)
    system = affine(first, conditions[0], conditions[1], finite[0], finite[1])
    if system.size > LARGEST:
        raise InputError(f"the equations have {system.size} states: allowed are {LARGEST}")
    matrices = PencilFunction(system.size, pencil_of(system, domain.given), vectorized=True)
    made = [
        _wall(end.at, rows, count, system.size, domain.given) if isinstance(end, Conditions) else with_limit(end, matrices, side)
        for end, rows, count, side in zip(ends, (system.left, system.right), (system.left_rows, system.right_rows), (-1, 1), strict=True)
    ]
    reduction = reduce_to_two_points(matrices, made[0], made[1], (), fold, reference)
    curve: Callable[[Any], Any] | None = spectrum.curve if spectrum.curves else None
    return EquationProblem(matrices, reduction, curve, formulation=formulation, first_order=first, affine=system, spectrum_inside=spectrum)


def pencil_of(system: AffineSystem, given: Given) -> Callable[[ComplexArray], tuple[ComplexArray, ...]]:
    """C0, C1, D0, D1 as a function of z (m,), real or complex."""

    def pencil(z: ComplexArray) -> tuple[ComplexArray, ...]:
        at = on_arrays(z, given)
        return tuple(filled(part, (system.size, system.size), z, at) for part in system.parts)

    return pencil


def _wall(z: float, rows: tuple[Any, Any], count: int, size: int, given: Given) -> Wall:
    place = np.array([float(z)])
    at = on_arrays(place, given)
    W0, W1 = (filled(part, (count, size), place.astype(np.complex128), at)[0] for part in rows)
    return Wall(float(z), W0, W1 if W1.any() else None)


def _names(unknowns: Sequence[str]) -> tuple[str, ...]:
    if isinstance(unknowns, str) or not isinstance(unknowns, Sequence):
        raise InputError(f"unknowns = {unknowns!r}: allowed is a list of names")
    return tuple(unknowns)


def _require_count(first: FirstOrder, formulation: Formulation, finite: list[bool]) -> None:
    """As many conditions as the order, where both ends are finite; at an end at infinity the count is that of what decays."""
    left, right = len(formulation.left_rows), len(formulation.right_rows)
    for side, count, is_finite in (("left", left, finite[0]), ("right", right, finite[1])):
        if is_finite and count == 0:
            raise InputError(f"{side} has no conditions: allowed is at least one (the order of the equations is {first.order})")
        if is_finite and count >= first.order + (not all(finite)):
            raise InputError(f"{side} has {count} conditions: the order of the equations is {first.order}, which leaves none free")
    if all(finite) and left + right != first.order:
        listed = ", ".join(shown(state) for state in first.states)
        told = f"{left} conditions at the left end and {right} at the right"
        raise InputError(f"{told}: allowed are {first.order} in all, the order of the equations, whose states are {listed}")


def shown(state: tuple[str, int]) -> str:
    """A state as the user would write it."""
    name, order = state
    return name if order == 0 else f"d({name})" if order == 1 else f"d({name},{order})"


__all__ = ["Conditions", "EquationProblem", "Infinity", "equations"]
