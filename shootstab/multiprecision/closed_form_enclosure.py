"""Closed forms in balls."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from shootstab.core.balls import acb
from shootstab.multiprecision import small_matrices as matrices
from shootstab.multiprecision.arithmetic import exact
from shootstab.multiprecision.enclosable import ball, row_minors
from shootstab.multiprecision.minors import MinorEntries, minors
from shootstab.problems.closed_form import ClosedForm


class ClosedFormEnclosable:
    """See enclosable.EnclosableSystem: a closed form, whose floats stand for their shortest decimals."""

    lemmas: tuple[str, ...] = ()
    multiple: tuple[Any, ...] = ()

    def __init__(self, form: ClosedForm) -> None:
        self._form = form

    @property
    def size(self) -> int:
        return self._form.size

    @property
    def decaying(self) -> int:
        return self._form.decaying

    def ends(self) -> tuple[Any, Any]:
        far, wall = (ball(exact(end)) if isinstance(end, float) else ball(end) for end in self._form.exact_ends(_exact))
        return far, wall

    def pencil(self, z: Any) -> tuple[Sequence[MinorEntries], Sequence[MinorEntries]]:
        parts = [dict(part) for part in self._form.exact_pencil(z, _exact)]
        half = len(parts) // 2
        return parts[:half], parts[half:]

    def start(self, sigma: Any) -> list[Any]:
        rows = [[acb(x) for x in row] for row in self._form.exact_far(sigma, _exact)]
        return minors(rows, self.decaying)

    def wall(self, sigma: Any) -> list[Any]:
        return row_minors(matrices.polynomial([[[acb(x) for x in row] for row in W] for W in self._form.exact_wall(_exact)], sigma))


def _exact(x: float) -> Any:
    """The decimal that a float stands for."""
    return acb(ball(exact(x)))
