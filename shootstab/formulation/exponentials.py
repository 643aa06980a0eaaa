"""An end at infinity that coefficients come to exponentially, as a regular singular point.

Coefficients are rational in exponentials e^{a z + b} whose rates a are whole multiples of one κ > 0 (exp, sinh, cosh, tanh and sech of what
is linear in z). With x = e^{−κ d z}, d = ±1 the direction of the end, they are analytic in x about x = 0, and C ψ′ = D ψ becomes

    C x dψ/dx = −(d/κ) D ψ.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from shootstab.core.errors import InputError
from shootstab.formulation.atoms import Atom
from shootstab.formulation.evaluation import on_arrays
from shootstab.formulation.expression import VARIABLE, Expression, Z, function, held_kinds, number, of_atom
from shootstab.formulation.far_coefficients import Text
from shootstab.formulation.state_pencil import Powers, StatePencil
from shootstab.formulation.substitution import substituted
from shootstab.problems.ends import INFINITIES

EXPONENTIALS = ("exp", "sinh", "cosh", "tanh", "sech")  # chosen: the functions that are rational in an exponential


@dataclass(frozen=True, eq=False)
class ExponentialEnd:
    """C and D by powers of σ as expressions in x, which their variable stands for; rate is κ, direction d."""

    rate: Expression
    direction: int
    C: Powers
    D: Powers

    @property
    def constant(self) -> bool:
        """Whether the coefficients are."""
        return not any(VARIABLE in entry.atoms() for part in (*self.C, *self.D) for entry in part.values())


def exponential_end(system: StatePencil, direction: int, text: Text = str) -> ExponentialEnd:
    """Raises InputError where a coefficient, shown by text, is no series in one exponential that decays towards the end."""
    rate, changed = in_exponential([entry for part in (*system.C, *system.D) for entry in part.values()], direction, text)
    C, D = (tuple({at: changed(entry) for at, entry in part.items()} for part in powers) for powers in (system.C, system.D))
    return ExponentialEnd(rate, direction, C, D)


def in_exponential(
    entries: Sequence[Expression], direction: int, text: Text = str
) -> tuple[Expression, Callable[[Expression], Expression]]:
    """κ, and what writes an expression of the same functions in x = e^{−κ d z}; it raises InputError for one that grows.

    Raises InputError where the entries, shown by text, are not rational in one exponential.
    """
    where = f"at {INFINITIES[direction]}"
    for entry in entries:
        if holds_coordinate(entry):
            raise InputError(
                f"{where} the coefficient {text(entry)} holds the coordinate itself: allowed are {', '.join(EXPONENTIALS)} of it"
            )
    atoms = sorted({atom for entry in entries for atom in entry.atoms() if atom.kind == "function" and _varies(atom)})
    if not atoms:
        return number(1), lambda entry: entry
    if any("given" in held_kinds(entry) for entry in entries):
        raise InputError(
            f"{where} the coefficients hold the base flow and {text(of_atom(atoms[0]))}: allowed is one of them in the coefficients"
        )
    slopes = [_slope(atom, where, text) for atom in atoms]
    unit = slopes[0]
    sign = _sign(unit, where)
    ratios = [_ratio(slope, unit, where, text) for slope in slopes]
    step = _common(abs(r) * (2 if atom.name == "tanh" else 1) for atom, r in zip(atoms, ratios, strict=True))
    values = {atom: _in_x(atom, slope, -direction * ratio * sign / step) for atom, slope, ratio in zip(atoms, slopes, ratios, strict=True)}

    def changed(entry: Expression) -> Expression:
        out = entry
        for atom, value in values.items():
            out = substituted(out, atom, value)
        if any(dict(monomial).get(VARIABLE, 0) < 0 for monomial in out.terms):
            raise InputError(f"{where} the coefficient {text(entry)} grows: allowed are coefficients that come to a limit")
        return out

    return unit * number(step * sign), changed


def holds_coordinate(entry: Expression) -> bool:
    """Whether the coordinate stands outside the arguments of functions."""
    atoms = [atom for monomial in entry.terms for atom, _ in monomial]
    return any(atom == VARIABLE or (atom.kind == "base" and holds_coordinate(atom.argument)) for atom in atoms)


def _varies(atom: Atom) -> bool:
    return VARIABLE in atom.argument.atoms()


def _slope(atom: Atom, where: str, text: Text) -> Expression:
    slope: Expression = atom.argument.derivative()
    if atom.name not in EXPONENTIALS or VARIABLE in slope.atoms():
        allowed = f"allowed are {', '.join(EXPONENTIALS)} of what is linear in the coordinate"
        raise InputError(f"{where} {text(of_atom(atom))} is not rational in an exponential: {allowed}")
    return slope


def _sign(unit: Expression, where: str) -> int:
    value = complex(np.ravel(on_arrays(np.array([0.0]), {})(unit))[0])
    if value.imag or not value.real:
        raise InputError(f"{where} a coefficient has the exponential rate {value:.6g}: allowed are real ones other than 0")
    return 1 if value.real > 0 else -1


def _ratio(slope: Expression, unit: Expression, where: str, text: Text) -> Fraction:
    ratio = (slope / unit).constant
    if ratio is None or ratio.im:
        raise InputError(
            f"{where} the exponential rates {text(slope)} and {text(unit)} have no common measure: allowed are multiples of one"
        )
    return Fraction(ratio.re)


def _common(ratios: Iterable[Fraction]) -> Fraction:
    """The largest number of which all are whole multiples."""
    total = Fraction(0)
    for r in ratios:
        total = Fraction(math.gcd(total.numerator * r.denominator, r.numerator * total.denominator), total.denominator * r.denominator)
    return total


def _in_x(atom: Atom, slope: Expression, power: Fraction) -> Expression:
    """The function as a rational one of x, where e^{a z} is x^power."""
    b: Expression = atom.argument - slope * Z
    outwards = 1 if power > 0 else -1  # the sign in the argument that makes x^{|power|} go to zero with x
    E = function("exp", b * number(outwards)) * Z ** int(abs(power)) if abs(power).denominator == 1 else None
    if atom.name == "tanh":
        Y = function("exp", b * number(2 * outwards)) * Z ** int(2 * abs(power))
        return number(outwards) * (Y - number(1)) / (Y + number(1))
    assert E is not None
    if atom.name == "sech":
        return number(2) * E / (number(1) + E**2)
    if atom.name == "exp":
        return E**outwards
    whole = (E + E**-1) if atom.name == "cosh" else number(outwards) * (E - E**-1)
    return whole / number(2)
