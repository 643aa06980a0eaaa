"""How many modes a region of the σ-plane holds."""

from __future__ import annotations

from shootstab.discriminants.atlas import Atlas
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.protocol import Method
from shootstab.problems.protocol import Problem
from shootstab.questions.survey import Survey, survey
from shootstab.vocabulary.regions import Region

COUNTING = Frame(rtol=1e-7)  # a phase needs few digits


def count(problem: Problem, region: Region, method: Method | None = None) -> int:
    """The number of modes in the region, by the argument principle; see `counted` for the evidence and for what is left out."""
    return counted(problem, region, method).count


def counted(problem: Problem, region: Region, method: Method | None = None) -> Survey:
    """The number of modes in the region, cut along the continuous spectrum where that enters it.

    Raises Undecidable (a ConvergenceError) where the region cannot be cut, ConvergenceError when a mode lies on its boundary.
    """
    return survey(Atlas(problem, method or COUNTING), region)
