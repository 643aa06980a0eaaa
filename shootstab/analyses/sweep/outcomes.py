"""What a sweep says of one point."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from shootstab.core.records import UNRESOLVED

PROVED = "proved"
FOLLOWED = "followed"
NONE_GROWS = "no growing mode"
NO_WAVE = "no wave"
NO_FLOW = "no flow"
OUTCOMES = (PROVED, FOLLOWED, NONE_GROWS, NO_WAVE, NO_FLOW, UNRESOLVED)  # exact: all that a point can come to


@dataclass(frozen=True)
class Outcome:
    """The dominant mode at one point, with |true − sigma| ≤ error, and how that is known.

    status: 'proved', sigma grows and a count says that no mode with a larger Re σ exists, at this point; 'followed', sigma grows and is
    continued from points where that is proved; 'no growing mode', no mode has Re σ > floor, by a count here if proved and by
    counts at the proved points on either side if not; 'no wave', k_x = k_y = 0; 'no flow: …' and 'unresolved: …' say why.
    floor: the Re σ above which modes were counted here, half that of the dominant one; where none grows the one asked for, or 1e−7 of
    the frequencies of the continuous spectrum where that is more.
    beside: what else there is to be said of the problem at this point, such as T_∞ of a flow that was chosen by its mass flux.
    sigma is None where nothing grows: decaying modes are not counted, for next to the continuous spectrum nothing would tell which of them
    decays least. below: where nothing grows next to a point where something does, the fastest mode of such neighbours, followed to here
    (see neutral.py), or its continuation where it meets the continuous spectrum; None where none is, or none arrives. It has no bound.
    """

    status: str
    proved: bool = False
    sigma: complex | None = None
    error: float | None = None
    floor: float | None = None
    evaluations: int = 0
    beside: Mapping[str, float] = field(default_factory=dict)
    below: complex | None = None

    @property
    def growth(self) -> float | None:
        """Re σ."""
        return None if self.sigma is None else self.sigma.real
