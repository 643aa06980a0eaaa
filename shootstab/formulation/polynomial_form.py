"""The problem with polynomial coefficients, c(ξ, σ) dψ/dξ = B(ξ, σ) ψ in exact numbers, for a checker of its own to verify a proof of.

ξ is the coordinate itself, or where coefficients are rational in an exponential x = e^{−κz} it is −x or x between a wall and infinity, and
tanh(κz/2) = (1 − x)/(1 + x) on the whole line. At a regular singular end ψ_j = (ξ − ξ_0)^{s_j} φ_j, as in regular_singular.py.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any

from shootstab.core.errors import InputError
from shootstab.formulation.conditions import Axis, Conditions
from shootstab.formulation.enclosed_axis import is_enclosed
from shootstab.formulation.exponentials import exponential_end
from shootstab.formulation.expression import Expression
from shootstab.formulation.gaussian import Gaussian
from shootstab.formulation.rational_functions import (
    CERTIFIED_SIGMA,
    GaussianPolynomial,
    RationalFunction,
    X,
    common_denominator,
    constant,
    evaluated,
    in_coordinate,
    polynomial,
    power,
    solved,
)
from shootstab.formulation.regular_singular import regular_singular_end
from shootstab.formulation.state_pencil import Powers, StatePencil
from shootstab.formulation.statement import Statement
from shootstab.problems.ends import INFINITIES, Infinity

NO_PENCIL = "a certificate asks for conditions at finite ends or axes, or ends at infinity, and coefficients that are rational functions"


def polynomial_pencil(statement: Statement, system: StatePencil, decaying: Mapping[str, int], bounded: list[int]) -> dict[str, Any]:
    """The problem as a checker takes it, without the lengths of series; decaying counts solutions at infinity, bounded are states.

    Raises InputError where it has no such form.
    """
    if statement.joints or statement.base is not None or statement.denominators or statement.domain.given:
        raise InputError(f"{NO_PENCIL}: layers and base flows are none")
    n, ends = system.size, (statement.left, statement.right)
    A, places = _in_one_coordinate(statement, system)
    shifts, out = [[0] * n, [0] * n], []
    for side, (end, at) in enumerate(zip(ends, places, strict=True)):
        if isinstance(end, Axis):
            regular = regular_singular_end(system, Fraction(Gaussian.of(end.at).re), 1 - 2 * side, bounded, f"z = {end.at:g}")
            if not is_enclosed(regular, bounded):
                raise InputError(f"{NO_PENCIL}: regular solutions are power series of several families")
            shifts[side] = list(regular.shifts)
            orders = max(1, round(regular.families[0].exponent.real) + regular.families[0].count)
            least = [-s if j in bounded else 0 for j, s in enumerate(regular.shifts)]
            out.append({"kind": "axis", "at": str(at), "admitted": regular.columns, "orders": orders, "least": least})
        elif isinstance(end, Infinity):
            out.append({"kind": "infinity", "at": str(at), "admitted": decaying[INFINITIES[2 * side - 1]]})
        elif isinstance(end, Conditions):
            out.append({"kind": "wall", "at": str(at)})
        else:
            raise InputError(f"{NO_PENCIL}: periodic ends are none")
    scale = [polynomial(X) - constant(places[0]), constant(places[1]) - polynomial(X)]
    for s, factor, sign in zip(shifts, scale, (1, -1), strict=True):
        if any(s):
            A = [[A[i][j] * power(factor, s[j] - s[i]) for j in range(n)] for i in range(n)]
            for i in range(n):
                A[i][i] = A[i][i] - constant(sign * s[i]) * factor.inverse()
    for side, (kind, parts, count) in enumerate(zip(out, (system.left, system.right), (system.left_rows, system.right_rows), strict=True)):
        if kind["kind"] == "wall":
            length = places[1] - places[0]
            kind["rows"] = _rows(parts, count, n, _place(ends[side]), [length ** shifts[1 - side][j] for j in range(n)])
    c = common_denominator([f for row in A for f in row])
    for kind, factor in zip(out, scale, strict=True):
        if kind["kind"] != "wall" and divmod(c, factor.re)[1]:
            c = c * factor.re
    B = [[i, j, _written(A[i][j].times(c))] for i in range(n) for j in range(n) if A[i][j]]
    layer = {"from": str(places[0]), "to": str(places[1]), "steps": [], "c": _written(polynomial(c).times(polynomial(X).den)), "B": B}
    return {"name": "polynomial pencil", "size": n, "layers": [layer], "joints": [], "left": out[0], "right": out[1]}


def _place(end: Any) -> Fraction:
    return Fraction(Gaussian.of(end.at).re)


def _in_one_coordinate(statement: Statement, system: StatePencil) -> tuple[list[list[RationalFunction]], tuple[Fraction, Fraction]]:
    """dψ/dξ = A ψ, and the places of the ends."""
    finite = statement.finite
    if all(finite):
        return _matrix(system, system.C, system.D, polynomial(X)), (_place(statement.left), _place(statement.right))
    direction = -1 if finite == (False, True) else 1
    end = exponential_end(system, direction)
    rate = evaluated(in_coordinate(polynomial(X)), end.rate**2)
    square = constant(Gaussian(0)) if rate.den.total_degree() + rate.re.total_degree() or rate.im else rate
    if not square:
        raise InputError(f"{NO_PENCIL}: the square of the rate of an exponential is no rational number")
    if finite == (False, False):
        x = (constant(1) - polynomial(X)) * (constant(1) + polynomial(X)).inverse()
        slope = constant(2) * (constant(1) - polynomial(X * X)).inverse()  # κ dz/dξ
        places = Fraction(-1), Fraction(1)
    else:
        wall = _place(statement.left if finite[0] else statement.right)
        if wall and not end.constant:
            raise InputError(f"{NO_PENCIL}: beside exponentials a wall at 0")
        x = -polynomial(X) if finite[0] else polynomial(X)
        slope = constant(-direction) * polynomial(X).inverse()  # z = −(d/κ) ln x
        places = (Fraction(-1), Fraction(0)) if finite[0] else (Fraction(0), Fraction(1))
    A = _matrix(system, end.C, end.D, x)
    powers = _powers_of_rate(end.rate, A, [system.left, system.right])
    n = range(system.size)
    return [[A[i][j] * slope * powers(i, j, square) if A[i][j] else A[i][j] for j in n] for i in n], places


def _powers_of_rate(rate: Expression, A: list[list[RationalFunction]], ends: Sequence[Powers]) -> Callable[[int, int, Any], Any]:
    """κ^{p_j − p_i − 1} for the entries of A: with the states ψ_j = κ^{p_j} φ_j, p_j 0 or 1, only even powers occur; for rational κ 1/κ.

    Raises InputError where there are none.
    """
    n = len(A)
    known = rate.constant
    if known is not None:
        factor = constant(Fraction(known.re)).inverse()
        return lambda i, j, square: factor
    if any(part for end in ends for part in end):
        raise InputError(f"{NO_PENCIL}: the rate of an exponential is no rational number")
    p: dict[int, int] = {}
    for first in range(n):
        waiting = [first] if first not in p else []
        p.setdefault(first, 0)
        while waiting:
            i = waiting.pop()
            for j in range(n):
                if (A[i][j] or A[j][i]) and j not in p:
                    p[j] = 1 - p[i]
                    waiting.append(j)
    if any(A[i][j] and (p[j] - p[i] - 1) % 2 for i in range(n) for j in range(n)):
        raise InputError(f"{NO_PENCIL}: the rate of an exponential is no rational number")
    return lambda i, j, square: power(square, (p[j] - p[i] - 1) // 2)


def _matrix(system: StatePencil, C: Powers, D: Powers, x: RationalFunction) -> list[list[RationalFunction]]:
    at, s = in_coordinate(x), polynomial(CERTIFIED_SIGMA)

    def whole(parts: Powers) -> dict[tuple[int, int], RationalFunction]:
        out: dict[tuple[int, int], RationalFunction] = {}
        for p, part in enumerate(parts):
            for place, entry in part.items():
                term = evaluated(at, entry) * power(s, p)
                out[place] = out[place] + term if place in out else term
        return out

    return solved(whole(C), whole(D), system.size)


def _rows(parts: Powers, count: int, n: int, at: Fraction, scale: Sequence[Fraction]) -> list[list[Any]]:
    """The conditions at a wall by powers of σ."""
    evaluator = in_coordinate(constant(at))

    def number(entry: Expression, factor: Fraction) -> Any:
        (found,) = evaluated(evaluator, entry).times(polynomial(X).den).values()
        return _text((found[0] * factor, found[1] * factor))

    return [[[number(part[i, j], scale[j]) if (i, j) in part else "0" for part in parts] for j in range(n)] for i in range(count)]


def _written(p: GaussianPolynomial) -> list[list[Any]]:
    """Coefficients by powers of σ and of ξ."""
    zero = Fraction(0), Fraction(0)
    return [
        [_text(p.get((i, j), zero)) for i in range(1 + max((a for a, b in p if b == j), default=0))]
        for j in range(1 + max(b for _, b in p))
    ]


def _text(c: tuple[Fraction, Fraction]) -> Any:
    return [str(c[0]), str(c[1])] if c[1] else str(c[0])
