"""How many modes a region of the σ-plane holds."""

from __future__ import annotations

from shootstab.discriminants.continuum import continuum_of
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.protocol import Method
from shootstab.problems.protocol import Problem
from shootstab.roots.winding import wind
from shootstab.vocabulary.errors import ConvergenceError
from shootstab.vocabulary.regions import Region


def count(problem: Problem, region: Region, method: Method | None = None) -> int:
    """The number of modes in the region, by the argument principle.

    Raises ConvergenceError when the region touches the continuous spectrum, on which D is not defined, or when a mode lies on its boundary.
    """
    require_clear(problem, region)
    return wind((method or Frame(rtol=1e-9)).on(problem), region).count


def require_clear(problem: Problem, region: Region) -> None:
    """Raise ConvergenceError if any point of the continuous spectrum lies in the region."""
    curve = continuum_of(problem)
    if curve is None:
        return
    for sigma in curve.sigma:
        if region.contains(complex(sigma)):
            raise ConvergenceError(f"the region holds a part of the continuous spectrum, {complex(sigma):.4g}: D is not analytic there")
