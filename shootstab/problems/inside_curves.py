"""Where C is singular inside the domain of a user's problem: the curve that a path leads around, and those that none does."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from shootstab.problems.pencil_function import PencilFunction
from shootstab.problems.protocol import ComplexArray
from shootstab.problems.singular_curve import CURVE_PROBES, SingularCurve, singular_curves
from shootstab.problems.singular_point import require_regular
from shootstab.problems.two_point import TwoPointReduction

Crossings = tuple[tuple[NDArray[np.float64], ComplexArray], ...]


def inside_curves(
    function: PencilFunction, reduction: TwoPointReduction, given: Callable[[Any], Any] | Literal[False] | None
) -> tuple[Callable[[Any], Any] | None, Crossings]:
    """σ_c as it was given or as the pencil has it, if a path may lead around it; and (z, σ_c(z)) of what no path leads around."""
    for line in reduction.lines:
        require_regular(function, line)
    if given is not None:
        return given or None, ()
    curves: list[tuple[NDArray[np.float64], ComplexArray]] = []
    for z in reduction.lines:
        found = singular_curves(function, z[:: len(z) // CURVE_PROBES])
        if isinstance(found, SingularCurve) and len(reduction.lines) == 1:
            return found, ()
        if found:
            found = singular_curves(function, z)
            curves += [(z.real, sigma) for sigma in ((found(z),) if isinstance(found, SingularCurve) else found)]
    return None, tuple(curves)
