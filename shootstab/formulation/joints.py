"""Conditions at an interface between two layers, in the language of the equations, as matrices over the states on both sides.

before(f) and behind(f) are f on the side of smaller and of larger coordinate, with the definitions of that layer, and jump(f) is behind(f)
− before(f). Amplitudes are unknown numbers that occur in the conditions alone, such as the elevation of a free surface. Each is found from
one of the conditions and removed from the others,

    (row) ← p (row) − x (pivot row),   p and x coprime polynomials in σ,

so that n conditions are left over the n + n states. By Schur's complement the determinant of all conditions is that of those that are left
times the pivot over the product of the p. What is lacking of it multiplies one row, and where more than it would be there the conditions
are refused: D has the zeros that are modes, and no others.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shootstab.core.errors import InputError
from shootstab.formulation.evaluation import Given, on_arrays
from shootstab.formulation.expression import VARIABLE, Expression, number, quotient
from shootstab.formulation.first_order import FirstOrder, reduced_to
from shootstab.formulation.grammar import Reader, Scope
from shootstab.formulation.linear_algebra import coprime, minus
from shootstab.formulation.names import Names
from shootstab.formulation.substitution import substituted
from shootstab.formulation.system import Jet, Row, coefficients, degree, jet, row_of
from shootstab.formulation.vanishing import Vanishing
from shootstab.problems.ends import Interface

INTERFACE_SIDES = ("before", "behind")


@dataclass(frozen=True, eq=False)
class InterfaceConditions:
    """`conditions` hold at the coordinate `at` inside, formulas with before(f), behind(f), jump(f) and the amplitudes: see joints.py."""

    at: float
    conditions: Sequence[str]
    amplitudes: Sequence[str] = ()


@dataclass(frozen=True, eq=False)
class Joint:
    """An interface whose conditions have been read: rows over before(u), behind(u) and the amplitudes."""

    at: float
    rows: tuple[tuple[str, Row], ...]
    amplitudes: tuple[str, ...]

    def conditions(self, layers: tuple[FirstOrder, FirstOrder]) -> list[Row]:
        """The rows over the states of both sides. Raises InputError where they are too many, too few, or say nothing."""
        states = {_on(side, state) for side, layer in zip(INTERFACE_SIDES, layers, strict=True) for state in layer.states}
        states |= {(name, 0) for name in self.amplitudes}
        rules = {
            _on(side, (name, 0))[0]: (_on(side, at), {_on(side, key): c for key, c in rule.items()})
            for side, layer in zip(INTERFACE_SIDES, layers, strict=True)
            for name, (at, rule) in layer.rules.items()
        }
        vanishing = layers[0].vanishing
        rows = [{at: self._here(c) for at, c in reduced_to(row, states, rules, vanishing).items()} for _, row in self.rows]
        rows = [{at: c for at, c in row.items() if not vanishing(c)} for row in rows]
        for (where, _), row in zip(self.rows, rows, strict=True):
            if not row:
                raise InputError(
                    f"{where} says nothing: the equations themselves make it true; allowed are conditions that they leave open"
                )
        for name in self.amplitudes:
            rows = self._without(name, rows, vanishing)
        n = layers[0].order
        if len(rows) != n:
            told = f"{len(self.rows)} conditions and {len(self.amplitudes)} amplitudes at the interface {self.at:g}"
            raise InputError(f"{told}: allowed are {n} conditions, the order of the equations, and one for each amplitude")
        return rows

    def _here(self, coefficient: Expression) -> Expression:
        return substituted(coefficient, VARIABLE, number(self.at))

    def _without(self, name: str, rows: list[Row], vanishing: Vanishing) -> list[Row]:
        """Without an amplitude, and the condition that finds it."""
        at = (name, 0)
        holders = [i for i, row in enumerate(rows) if at in row]
        if not holders:
            raise InputError(
                f"no condition at the interface {self.at:g} holds the amplitude {name}: allowed are amplitudes that they determine"
            )
        pivot = min(holders, key=lambda i: (degree(rows[i][at]), len(rows[i][at].terms), len(rows[i])))
        out, factors = [], number(1)
        for i, row in enumerate(rows):
            if i == pivot:
                continue
            if at in row:
                p, x = coprime(rows[pivot][at], row[at])
                factors = factors * p if degree(p) else factors
                row = minus(row, rows[pivot], p, x, vanishing)
                row.pop(at, None)
            out.append(row)
        lacking = rows[pivot][at] if not degree(factors) else quotient(rows[pivot][at], factors)
        if lacking is None:
            raise InputError(
                f"at the interface {self.at:g} each of {len(holders)} conditions multiplies the amplitude {name} by the eigenvalue: "
                "allowed are two such ones, or one in which a number multiplies it"
            )
        if degree(lacking) and out:
            out[0] = {key: lacking * c for key, c in out[0].items()}
        return out

    def interface(self, layers: tuple[FirstOrder, FirstOrder], given: Given) -> Interface:
        """The same as matrices over the states."""
        rows, n = self.conditions(layers), layers[0].order
        places = {
            _on(side, state): k * n + j
            for k, (side, layer) in enumerate(zip(INTERFACE_SIDES, layers, strict=True))
            for j, state in enumerate(layer.states)
        }
        highest = max(1, *(degree(c) for row in rows for c in row.values()))
        M = np.zeros((highest + 1, n, 2 * n), dtype=np.complex128)
        at = on_arrays(np.array([float(self.at)]), given)
        for i, row in enumerate(rows):
            for key, c in row.items():
                for power, part in coefficients(c).items():
                    M[power, i, places[key]] = complex(np.ravel(at(part))[0])
        return Interface(float(self.at), M[0, :, :n], M[0, :, n:], M[1:, :, :n], M[1:, :, n:])


def read_joint(given: InterfaceConditions, names: tuple[Names, Names], layered: Sequence[str]) -> Joint:
    """layered are the definitions that differ from layer to layer. Raises InputError with the place."""
    where = f"the interface {given.at:g}"
    for name in given.amplitudes:
        if name in names[0].unknowns or not isinstance(name, str):
            raise InputError(f"{where}: the amplitude {name!r} is an unknown of the equations too: allowed is one meaning")

    def outside(name: str) -> Expression:
        if name in given.amplitudes:
            return jet(name)
        if name in names[0].unknowns or name in layered:
            raise InputError(f"{where}: {name} stands without a side: allowed are before({name}), behind({name}) and jump({name})")
        return names[0].meaning(name)

    def on(side: str, layer: Names) -> Scope:
        def scope(name: str) -> Expression:
            if name in given.amplitudes:
                return jet(name)
            return jet(f"{side}({name})") if name in layer.unknowns else layer.meaning(name)

        return scope

    scopes = {side: on(side, layer) for side, layer in zip(INTERFACE_SIDES, names, strict=True)}

    def listed() -> str:
        return ", ".join([*given.amplitudes, "before(...)", "behind(...)", "jump(...)", names[0].listed()])

    rows = []
    for i, formula in enumerate(given.conditions, 1):
        place = f"{where}, condition {i}"
        row = row_of(Reader(formula, place, outside, listed, scopes).equation(), place)
        for name, order in row:
            if name in given.amplitudes and order:
                raise InputError(f"{place}: a derivative of the amplitude {name}, which is a number: allowed is {name} alone")
        rows.append((place, row))
    return Joint(float(given.at), tuple(rows), tuple(given.amplitudes))


def _on(side: str, at: Jet) -> Jet:
    return f"{side}({at[0]})", at[1]


def between(joints: Sequence[Joint], layers: Sequence[FirstOrder], given: Given) -> tuple[Interface, ...]:
    """All interfaces, from left to right, between as many layers and one more."""
    return tuple(joint.interface(pair, given) for joint, pair in zip(joints, itertools.pairwise(layers), strict=True))
