"""How many modes a region of the σ-plane holds."""

from __future__ import annotations

from shootstab.analyses.accuracy import Tightening
from shootstab.analyses.cut_region import RegionCount, count_in_region
from shootstab.core.division import divisions
from shootstab.core.errors import ConvergenceError
from shootstab.core.numerus import number_of
from shootstab.core.regions import Region, require_region
from shootstab.discriminants.continuation import Continuation, Undecidable
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.method import Method
from shootstab.problems.protocol import Problem

COUNTING = Frame(rtol=1e-7)  # chosen: a phase needs few digits, and where it needs more the tolerance is tightened


def count(problem: Problem, region: Region, method: Method | None = None) -> int:
    """The number of modes in the region, by the argument principle; see `counted` for the evidence and for what is left out."""
    return counted(problem, region, method).count


def counted(problem: Problem, region: Region, method: Method | None = None) -> RegionCount:
    """The number of modes in the region, cut along the continuous spectrum where that enters it, and then counted a second time.

    The method (orthonormalized shooting if none is given) is tightened until D is known well enough for the count. Raises Undecidable (a
    ConvergenceError) where the region cannot be cut or the two counts differ, Inaccurate (one, too) where the region is too small for
    double precision, ConvergenceError when a mode lies on its boundary.
    """
    return counted_twice(Tightening(Continuation(problem, method or COUNTING)), region)[1]


def counted_twice(tightening: Tightening, region: Region) -> tuple[Continuation, RegionCount]:
    """The count of a region by the first continuation that is accurate enough for it, and that continuation.

    Where the continuous spectrum enters it, the count rests on which side of a curve is which. There the region is divided and the counts
    of its parts, cut elsewhere, must add up: Undecidable is raised where they do not, or where no division can be counted.
    """
    require_region(region)
    continuation, whole = tightening.first(lambda c: count_in_region(c, region))
    if whole.cut:
        _require_sum(tightening, region, whole)
    return continuation, whole


def _require_sum(tightening: Tightening, region: Region, whole: RegionCount) -> None:
    why = "every straight cut crosses its boundary more than twice"
    for parts in divisions(region):
        try:
            counts = [tightening.first(lambda c, part=part: count_in_region(c, part))[1] for part in parts]  # type: ignore[misc]
        except ConvergenceError as error:
            why = str(error)  # a mode or an end of the continuous spectrum lies on this cut
            continue
        if sum(c.count for c in counts) != whole.count:
            many = number_of(whole.count, "mode is counted", "modes are counted")
            raise Undecidable(
                f"{many} in the region, and {counts[0].count} + {counts[1].count} in the parts of it that a cut "
                f"at {parts[0].chord[0]:.6g} makes: the continuous spectrum is too near to its boundary or to itself"
            )
        return
    raise Undecidable(f"the count of a region that the continuous spectrum enters could not be repeated: {why}")
