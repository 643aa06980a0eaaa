"""How many modes a region of the σ-plane holds."""

from __future__ import annotations

from shootstab.analyses.cut_region import RegionCount, count_in_region
from shootstab.core.regions import Region
from shootstab.discriminants.continuation import Continuation
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.method import Method
from shootstab.problems.protocol import Problem

COUNTING = Frame(rtol=1e-7)  # a phase needs few digits


def count(problem: Problem, region: Region, method: Method | None = None) -> int:
    """The number of modes in the region, by the argument principle; see `counted` for the evidence and for what is left out."""
    return counted(problem, region, method).count


def counted(problem: Problem, region: Region, method: Method | None = None) -> RegionCount:
    """The number of modes in the region, cut along the continuous spectrum where that enters it.

    Raises Undecidable (a ConvergenceError) where the region cannot be cut, ConvergenceError when a mode lies on its boundary.
    """
    return count_in_region(Continuation(problem, method or COUNTING), region)
