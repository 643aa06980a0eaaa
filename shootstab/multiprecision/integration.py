"""What the engine asks of a problem that is to be solved to any number of digits, and what it makes of it.

A `MultiprecisionProblem` is a problem with its parameters taken as exact decimals; an `Integration` is one way through it, from the far
end to the wall, in one arithmetic with one choice of settings. All numbers and series are those of the arithmetic.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from shootstab.core.progress import StepDone
from shootstab.multiprecision.arithmetic import Arithmetic, Matrix
from shootstab.multiprecision.linear_step import TaylorEntries
from shootstab.multiprecision.settings import Settings

UnknownRows = Mapping[str, Mapping[int, Any]]  # the factors of each unknown by name on components of ψ: series, or numbers
BaseFlowNumbers = tuple[Any, ...]  # what a base flow had to be solved for, as mpmath numbers; empty if nothing


@dataclass(frozen=True)
class Expansion:
    """The pencil about a point of the path, as series in the fraction t of a step of length h: C dψ/dt = h D ψ.

    C and D are given by their coefficients of σ⁰, σ¹, …; the step ends at t = part, and at_wall says whether that is the wall.
    """

    h: Any
    C: Sequence[TaylorEntries]
    D: Sequence[TaylorEntries]
    at_wall: bool
    part: float = 1.0


class Integration(Protocol):
    """One way from the far end to the wall."""

    def begin(self, sigma: Any) -> None:
        """Choose where to start, so that the far frame holds at σ."""
        ...

    def far_frame(self, sigma: Any) -> tuple[Matrix, Any]:
        """The decaying space (n, k) at the start, and the factor with which its determinant counts."""
        ...

    def expand(self, longest: float) -> Expansion:
        """The pencil about the place reached, for a step of length longest at most; may be asked for again with a shorter one."""
        ...

    def advance(self, part: float) -> None:
        """Go to this part of the last expansion's step."""
        ...

    def unknowns(self, sigma: Any) -> UnknownRows:
        """What the user's unknowns are of ψ, along the step of the last expansion."""
        ...

    @property
    def farthest(self) -> float:
        """How far beyond the start solutions are known: 0 where it is an end of the domain, infinite up to infinity."""
        ...

    def farther(self, sigma: Any, c: Matrix, place: Any, distance: Any) -> Mapping[str, Any] | None:
        """The unknowns by name at a place so far beyond the start, of the solution that is the combination c (k, 1) of the far frame.

        None where no solution is known there.
        """
        ...

    @property
    def wall(self) -> Any:
        """z of the wall."""
        ...

    def wall_rows(self) -> Sequence[Matrix]:
        """W0, W1, … (k, n), asked for at the wall."""
        ...

    def corrected_base(self) -> BaseFlowNumbers:
        """The numbers of the base flow, corrected by what this integration found at the wall."""
        ...


class MultiprecisionProblem(Protocol):
    """A problem that can be set up in any precision."""

    @property
    def size(self) -> int:
        """n."""
        ...

    @property
    def real(self) -> bool:
        """Whether D is real for real σ."""
        ...

    def base(self, arithmetic: Arithmetic, settings: Settings, progress: StepDone) -> BaseFlowNumbers:
        """The base flow, found with these settings; to be called inside the working precision.

        Raises ConvergenceError where the parameters do not determine it.
        """
        ...

    def integration(self, arithmetic: Arithmetic, settings: Settings, base: BaseFlowNumbers) -> Integration:
        """A integration with these settings on this base flow; to be called inside the working precision."""
        ...
