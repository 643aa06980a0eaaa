"""Base flows that are layers: functions that come to their limits through what a growing one carries away.

One function f grows, f′ = φ(w), and all others settle, w_i″ = p_i′,

    p_i′ = −(f a_i(w) + c_i(w)) p_i + q_i(w, p),   q_i of the second order in p,

with values of some states at a wall and w_i → W_i at infinity: Blasius' layer with w = f′, and the compressible plate with w = (U, T). A
single w may be pulled to its limit, p′ = −(f a + c) p + B(w) (w − W): Falkner and Skan's wedges.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from shootstab.formulation.atoms import Atom
from shootstab.formulation.base_flow import BaseEnd, BaseFlow, fixed_at_origin, of_state
from shootstab.formulation.expression import SLOPES, Expression, number, of_atom, quotient
from shootstab.formulation.gaussian import ONE


@dataclass(frozen=True, eq=False)
class BoundaryLayerForm:
    """f is the carrier; settling are the places of the w_i among the states, falling those of the p_i. limits are the W_i, damping the
    pairs (a_i, c_i), products the q_i, pull the B if there is one, fixed the values at the wall by places.
    """

    flow: BaseFlow
    wall: Fraction
    carrier: int
    settling: tuple[int, ...]
    falling: tuple[int, ...]
    limits: tuple[Fraction, ...]
    damping: tuple[tuple[Expression, Expression], ...]
    products: tuple[Expression, ...]
    fixed: Mapping[int, Expression]
    pull: Expression | None = None

    @property
    def free(self) -> tuple[int, ...]:
        """The places of the states whose values at the wall are sought, as many as there are w_i."""
        return tuple(i for i in range(len(self.flow.states)) if i not in self.fixed)

    @property
    def drift(self) -> Expression:
        """φ."""
        return self.flow.slopes[self.carrier]

    @property
    def scaled(self) -> bool:
        """Whether it is f‴ = −c f f″ from f = f′ = 0, c > 0, whose solution is one alone by its scaling (theory, lemma E18)."""
        (a, c), *more = self.damping
        blasius = not more and self.pull is None and self.carrier == 0 and self.settling == (1,) and set(self.fixed) == {0, 1}
        if not blasius or c or self.products[0] or any(self.fixed.values()):
            return False
        return a.constant is not None and a.constant.re > 0 and self.limits[0] > 0

    def derivatives(self) -> dict[tuple[int, int], Expression]:
        """∂F_i/∂y_j where it does not vanish."""
        found = {(i, j): partial(F, Atom("given", *y)) for i, F in enumerate(self.flow.slopes) for j, y in enumerate(self.flow.states)}
        return {at: entry for at, entry in found.items() if entry}


def boundary_layer_form(flow: BaseFlow) -> BoundaryLayerForm | None:
    """The flow as a layer to the right of a wall; None where it is none."""
    states, slopes = flow.states, flow.slopes
    if len(flow.ends) != 1 or flow.ends[0][0] < 0 or flow.ends[0][1].at is not None or flow.origin.at is None:
        return None
    falling = tuple(j for j in range(len(states)) if any(of_state(states[j]) == slope for slope in slopes) and not _chained(flow, j))
    settling = tuple(next(i for i, slope in enumerate(slopes) if slope == of_state(states[j])) for j in falling)
    rest = [i for i in range(len(states)) if i not in (*falling, *settling)]
    limits = _limits(flow, settling)
    fixed, others = fixed_at_origin(flow)
    if len(rest) != 1 or not falling or limits is None or others or len(states) - len(fixed) != len(settling):
        return None
    (carrier,) = rest
    f, p = Atom("given", *states[carrier]), [Atom("given", *states[j]) for j in falling]
    w = {Atom("given", *states[i]) for i in settling}
    drift = slopes[carrier]
    if not _given(drift) <= w or any(_held(slopes[j]) or not _given(slopes[j]) <= {f, *p, *w} for j in falling):
        return None
    parts = [_split(slopes[j], f, p, i) for i, j in enumerate(falling)]
    if any(part is None for part in parts) or _held(drift):
        return None
    damping = tuple((part[0], part[1]) for part in parts if part is not None)
    products = tuple(part[2] for part in parts if part is not None)
    rests = [part[3] for part in parts if part is not None]
    pull = None
    if any(rests):
        pull = quotient(rests[0], of_state(states[settling[0]]) - number(limits[0]))
        if len(falling) > 1 or products[0] or pull is None:
            return None
    return BoundaryLayerForm(flow, flow.origin.at, carrier, settling, falling, limits, damping, products, fixed, pull)


def partial(expression: Expression, atom: Atom) -> Expression:
    """∂/∂atom, other atoms held."""
    total = number(0)
    for monomial, c in expression.terms.items():
        for k, (factor, e) in enumerate(monomial):
            inner = number(1) if factor == atom else number(0) if factor.argument is None else partial(factor.argument, atom)
            if not inner:
                continue
            outer = SLOPES[factor.name](factor.argument) if factor.kind == "function" else number(1)
            rest = Expression({monomial[:k] + monomial[k + 1 :]: c})
            total = total + number(e) * rest * of_power(factor, e) * outer * inner
    return total


def of_power(factor: Atom, e: int | Fraction) -> Expression:
    """The factor to the power e − 1."""
    base: Expression = factor.argument if factor.kind == "base" else of_atom(factor)
    return base ** (e - 1)


def _chained(flow: BaseFlow, j: int) -> bool:
    """Whether the slope of this state is another state alone: it is then no last one of its unknown."""
    return any(flow.slopes[j] == of_state(state) for state in flow.states)


def _given(expression: Expression) -> set[Atom]:
    return {atom for atom in expression.atoms() if atom.kind == "given"}


def _held(expression: Expression) -> bool:
    """Whether it holds the coordinate."""
    return any(atom.kind == "variable" for atom in expression.atoms())


def _limits(flow: BaseFlow, settling: Sequence[int]) -> tuple[Fraction, ...] | None:
    """W_i, where the conditions at infinity give one for every w_i and nothing else."""
    ((_, end),) = flow.ends
    found, others = fixed_at_origin(replace(flow, origin=BaseEnd(flow.origin.at, end.conditions)))
    if others or set(found) != set(settling):
        return None
    values = [found[i].constant for i in settling]
    if any(value is None or value.im for value in values):
        return None
    return tuple(Fraction(value.re) for value in values if value is not None)


def _split(slope: Expression, f: Atom, p: Sequence[Atom], i: int) -> tuple[Expression, Expression, Expression, Expression] | None:
    """(a_i, c_i, q_i) of p_i′, and what holds neither f nor p; None where it is not of the form."""
    linear, products, rest = [number(0), number(0)], number(0), number(0)
    for outer, coefficient in slope.collected(lambda atom: atom == f or atom in p):
        if coefficient.atoms() & {f, *p}:
            return None
        powers = dict(outer)
        degree = sum(powers.get(atom, 0) for atom in p)
        carried = powers.get(f, 0)
        if any(Fraction(e).denominator != 1 or e < 0 for e in powers.values()):
            return None
        if not outer:
            rest = rest + coefficient
        elif degree >= 2 and not carried:
            products = products + coefficient * Expression({outer: ONE})
        elif degree == 1 and powers.get(p[i]) == 1 and carried in (0, 1):
            linear[int(carried)] = linear[int(carried)] - coefficient
        else:
            return None
    return linear[1], linear[0], products, rest
