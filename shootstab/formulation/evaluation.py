"""Expressions evaluated: on arrays of doubles, on mpmath numbers, and, by the same walk, on anything else that has the operations."""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import InputError
from shootstab.formulation.atoms import Atom, Exponent
from shootstab.formulation.expression import Expression
from shootstab.formulation.gaussian import Gaussian
from shootstab.problems.protocol import ComplexArray

LARGEST_ARGUMENT = 4096  # chosen: binary digits before the point of a function's argument; doubles end at 1024
Given = Mapping[str, Callable[[Any, int], Any]]  # functions by name, each (z, order) ↦ its derivative of that order at z


class Evaluator:
    """One walk over expressions at one z; every atom is evaluated once.

    number takes a Gaussian rational and apply(name, x) a function of expression.FUNCTIONS to what the walk computes with; power(x, e)
    is x^e for an exponent that is no natural number; natural(x, n) for one that is. values are those of the atoms that are
    known beforehand, by their names, parameters those of parameters that are not to have the number that they stand for.
    """

    def __init__(
        self,
        number: Callable[[Gaussian], Any],
        apply: Callable[[str, Any], Any],
        power: Callable[[Any, Fraction], Any],
        values: Mapping[str, Any],
        given: Callable[[str, int], Any],
        natural: Callable[[Any, int], Any] = operator.pow,
        parameters: Mapping[Atom, Any] | None = None,
    ) -> None:
        self._number, self._apply, self._power, self._values, self._given, self._natural = number, apply, power, values, given, natural
        self._parameters = parameters or {}
        self._atoms: dict[Atom, Any] = {}
        self._powers: dict[tuple[Atom, Exponent], Any] = {}

    def __call__(self, expression: Expression) -> Any:
        """The value of an expression; 0 as a plain number where it has no terms."""
        total: Any = None
        for monomial, c in expression.terms.items():
            product: Any = None
            for atom, exponent in monomial:
                factor = self.factor(atom, exponent)
                product = factor if product is None else product * factor
            coefficient = self._number(c)
            term = coefficient if product is None else product if c.re == 1 and not c.im else product * coefficient
            total = term if total is None else total + term
        return 0 if total is None else total

    def factor(self, atom: Atom, exponent: Exponent) -> Any:
        """A power of an atom."""
        if exponent == 1:
            return self._atom(atom)
        if (atom, exponent) not in self._powers:
            base = self._atom(atom)
            natural = Fraction(exponent).denominator == 1 and exponent > 0
            self._powers[atom, exponent] = self._natural(base, int(exponent)) if natural else self._power(base, Fraction(exponent))
        return self._powers[atom, exponent]

    def _atom(self, atom: Atom) -> Any:
        if atom not in self._atoms:
            if atom.kind == "given":
                self._atoms[atom] = self._given(atom.name, atom.order)
            elif atom.argument is None:
                self._atoms[atom] = self._values[atom.name]
            elif atom.kind == "parameter" and atom in self._parameters:
                self._atoms[atom] = self._parameters[atom]
            else:
                inner = self(atom.argument)
                self._atoms[atom] = inner if atom.kind in ("base", "parameter") else self._apply(atom.name, inner)
        return self._atoms[atom]


def on_arrays(z: Any, given: Given, sigma: Any = None) -> Evaluator:
    """Doubles, z real or complex (m,)."""
    values = {"z": z, "pi": np.pi} if sigma is None else {"z": z, "pi": np.pi, "sigma": sigma}
    return Evaluator(_double, apply_numpy, power_numpy, values, lambda name, order: given[name](z, order))


def on_mpmath(z: Any, given: Given, sigma: Any = None, parameters: Mapping[Atom, Any] | None = None) -> Evaluator:
    """mpmath numbers, at the working precision; parameters that are left open have the values given, or those that they stand for."""
    import mpmath

    values = {"z": z, "pi": +mpmath.mp.pi, "sigma": sigma}
    return Evaluator(_multiprecise, _apply_mpmath, _power_mpmath, values, lambda name, order: given[name](z, order), parameters=parameters)


def filled(entries: Mapping[tuple[int, int], Expression], shape: tuple[int, int], z: ComplexArray, at: Evaluator) -> ComplexArray:
    """A matrix (m, *shape) from its entries at z (m,)."""
    out: NDArray[np.complex128] = np.zeros((len(z), *shape), dtype=np.complex128)
    with np.errstate(all="ignore"):  # what is not finite is found, and told with its place, by who asked for the matrix
        for (i, j), entry in entries.items():
            out[:, i, j] = at(entry)
    return out


def _double(c: Gaussian) -> complex | float:
    return complex(c) if c.im else complex(c).real


def apply_numpy(name: str, x: Any) -> Any:
    """A function of doubles; what leaves the real axis becomes complex."""
    if name == "sech":
        decay = np.exp(-np.where(np.real(x) < 0, -x, x))
        return 2 * decay / (1 + decay * decay)
    if name == "erf":
        from scipy.special import erf

        return erf(x)
    if name in ("sqrt", "log") and np.isrealobj(x) and (np.asarray(x) < 0).any():
        x = np.asarray(x, dtype=np.complex128)
    return getattr(np, name)(x)


def power_numpy(x: Any, exponent: Fraction) -> Any:
    """A power that is no natural one."""
    if exponent.denominator == 1:
        return 1.0 / x ** -int(exponent)
    if np.isrealobj(x) and (np.asarray(x) < 0).any():
        x = np.asarray(x, dtype=np.complex128)
    if exponent.denominator == 2:
        root = np.sqrt(x)
        return root**exponent.numerator if exponent > 0 else 1.0 / root**-exponent.numerator
    return x ** float(exponent)


def _multiprecise(c: Gaussian) -> Any:
    import mpmath

    re, im = (mpmath.mpf(x.numerator) / x.denominator for x in (Fraction(c.re), Fraction(c.im)))
    return mpmath.mpc(re, im) if c.im else re


def _apply_mpmath(name: str, x: Any) -> Any:
    import mpmath

    if mpmath.isfinite(x) and mpmath.mag(x) > LARGEST_ARGUMENT:
        raise InputError(f"{name} of a number beyond 2**{LARGEST_ARGUMENT} in a coefficient: allowed are numbers that doubles hold")
    return getattr(mpmath, name)(x)


def _power_mpmath(x: Any, exponent: Fraction) -> Any:
    import mpmath

    return mpmath.power(x, mpmath.mpf(exponent.numerator) / exponent.denominator)
