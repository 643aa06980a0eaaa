"""The user's unknowns of states to many digits: along a step as series, and at one place as numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from shootstab.formulation.evaluation import Evaluator
from shootstab.formulation.expression import Expression
from shootstab.formulation.series_digits import on_series
from shootstab.multiprecision.arithmetic import Arithmetic, Matrix
from shootstab.multiprecision.taylor import Taylor, real_series

Shown = Mapping[str, tuple[Mapping[int, Expression], Expression]]  # r_j and −p of each unknown by name, see stated_unknowns.py


def rows_of(shown: Shown, at: Evaluator, shift: int = 0, prefix: str = "") -> dict[str, dict[int, Any]]:
    """Each unknown as Σ r_j ψ_j / p, the states being components from the shift on; names begin with the prefix."""
    return {
        f"{prefix}{name}": {j + shift: -at(factor) / at(divisor) for j, factor in factors.items()}
        for name, (factors, divisor) in shown.items()
    }


def shown_at(arithmetic: Arithmetic, shown: Shown, place: Any, sigma: Any, psi: Matrix) -> dict[str, Any]:
    """The unknowns by name of a state psi (n, 1) at one place."""
    z = real_series(arithmetic, [place, arithmetic.number(1)])
    rows = rows_of(shown, on_series(arithmetic, z, sigma))
    return {
        name: arithmetic.rounded(sum((_first(factor) * psi[j][0] for j, factor in row.items()), arithmetic.number(0)))
        for name, row in rows.items()
    }


def _first(factor: Any) -> Any:
    """The value where a series begins."""
    return factor.coefficients(1)[0] if isinstance(factor, Taylor) else factor
