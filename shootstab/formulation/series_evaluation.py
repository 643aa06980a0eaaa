"""Expressions on power series of doubles about z = 0."""

from __future__ import annotations

import operator
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from shootstab.core.series import Series
from shootstab.formulation.analytic_series import SeriesFunctions, natural_power
from shootstab.formulation.evaluation import Evaluator, apply_numpy, power_numpy


def on_double_series(terms: int) -> Evaluator:
    """z is the series x + 0 x² + …; without given functions."""

    def dot(a: Sequence[Any], b: Sequence[Any]) -> Any:
        return sum(x * y for x, y in zip(a, b, strict=False))

    def seed(name: str, x: Any) -> Any:
        return np.pi if name == "pi" else complex(apply_numpy(name, np.complex128(x)))

    functions = SeriesFunctions(dot, seed, lambda x, e: complex(power_numpy(np.complex128(x), e)))

    def apply(name: str, x: Any) -> Any:
        return Series(functions.apply(name, list(x.coefficients))) if isinstance(x, Series) else seed(name, x)

    def power(x: Any, e: Fraction) -> Any:
        with np.errstate(all="ignore"):
            if not isinstance(x, Series):
                return complex(power_numpy(np.complex128(x), e))
            if x.coefficients[0] == 0:
                return Series([complex("nan")] * terms)
            return Series(functions.power(list(x.coefficients), e))

    def given(name: str, order: int) -> Any:
        return Series([complex("nan")] * terms)

    z = Series([0j, 1 + 0j, *[0j] * (terms - 2)])
    return Evaluator(complex, apply, power, {"z": z, "pi": np.pi}, given, lambda x, n: natural_power(x, n, operator.mul))
