"""What was seen around a claimed eigenvalue, before it is known what the zeros there are."""

from __future__ import annotations

from dataclasses import dataclass

from shootstab.roots.search import Zero


@dataclass(frozen=True)
class Sighting:
    """What was seen around a claim.

    radius is that of the circle that the digits mean, and at least atol; near how far off a mode next to 0 is meant; counted that of
    the largest circle whose zeros were counted, zeros are the modes in it. resonance is a zero beyond the continuous spectrum inside
    radius. Where nothing could be counted, refusal is the verdict and the reason.
    """

    claim: complex
    radius: float
    atol: float
    distance: float
    near: float = 0.0
    counted: float = 0.0
    zeros: tuple[Zero, ...] = ()
    resonance: complex | None = None
    refusal: tuple[str, str] | None = None
