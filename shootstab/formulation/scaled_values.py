"""Expressions in doubles with the size of their exponentials apart: exp, cosh and sech have no real zero, however small they are.

In doubles they are zero or infinite where they are neither; a value here is one of those of the expression up to a positive factor.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shootstab.formulation.atoms import Atom
from shootstab.formulation.evaluation import Evaluator, Given, on_arrays, power_numpy
from shootstab.formulation.expression import Expression, number, of_atom

ValuesAndLogs = tuple[NDArray[Any], NDArray[np.float64]]  # values and logs (m,)


def scaled_values(expression: Expression, z: NDArray[np.float64], given: Given) -> ValuesAndLogs:
    """values and logs (m,) at real z (m,), expression = values · e^logs; logs is that of the largest exponentials of a term."""
    return _sum(expression, z, on_arrays(z, given))


def _sum(expression: Expression, z: NDArray[np.float64], at: Evaluator) -> ValuesAndLogs:
    terms = []
    for monomial, c in expression.terms.items():
        value, log = np.full(z.shape, at(number(c))), np.zeros(z.shape)
        for atom, exponent in monomial:
            own, size = _atom(atom, z, at)
            natural = Fraction(exponent).denominator == 1 and exponent > 0
            value = value * (own ** int(exponent) if natural else power_numpy(own, Fraction(exponent)))
            log = log + float(exponent) * size
        terms.append((value, log))
    largest = np.max([log for _, log in terms], axis=0) if terms else np.zeros(z.shape)
    return np.asarray(sum((value * np.exp(log - largest) for value, log in terms), np.zeros(z.shape))), largest


def _atom(atom: Atom, z: NDArray[np.float64], at: Evaluator) -> ValuesAndLogs:
    if atom.kind == "base":
        return _sum(atom.argument, z, at)
    if atom.kind == "function" and atom.name in ("exp", "cosh", "sech", "sinh"):
        a = np.broadcast_to(np.asarray(at(atom.argument)), z.shape)
        if atom.name == "exp":
            return (np.exp(1j * a.imag) if np.iscomplexobj(a) else np.ones(z.shape)), a.real
        if not np.iscomplexobj(a):
            size, fall = np.abs(a), np.exp(-2 * np.abs(a))
            if atom.name == "sech":
                return 2 / (1 + fall), -size
            return (0.5 * (1 + fall) if atom.name == "cosh" else 0.5 * np.sign(a) * (1 - fall)), size
    return np.broadcast_to(np.asarray(at(of_atom(atom))), z.shape), np.zeros(z.shape)
