"""Figure 8: gentle slopes, flow by flow: long waves grow, or where those are not known a growing wave of finite length is proved.

Long waves are not known where their mode is lost or its extrapolation to k → 0 leaves more than a tenth of d, as on hot flows.
"""

from __future__ import annotations

from claims import Case

from paper.edges import DIRECTIONS, GENTLE, curve, growing, steady, wave
from paper.rows import Item, Reproduction, Row, if_all_hold

HEIGHTS = (0.1, 0.3, 0.03, 1.0)  # chosen: k h0 of the waves that are asked about, in this order
ACROSS_FIRST = (DIRECTIONS[-1], DIRECTIONS[0])  # chosen: across the slope and along it


def gentle(quick: bool) -> Row:
    """All flows of tan θ ≤ 0.28; the quick form asks about one slope and its hottest flow."""
    cases, told = [], []
    for tan in GENTLE[-1:] if quick else GENTLE:
        samples = curve(tan)
        unknown = [s for s in samples if s.grows is not True]
        asked = unknown[-1:] if quick else unknown
        proved = 0
        for s in asked:
            flow = steady(tan, s.far_temperature)
            proved += growing(flow, [wave(kh / s.height, t) for kh in HEIGHTS for t in ACROSS_FIRST]) is not None
        cases.append(
            Case(f"tan θ = {tan}: flows where long waves are not known to grow, and a wave grows", f"{len(asked)}", f"{proved}", 0.0)
        )
        told.append(f"{len(samples) - len(unknown)} and {len(asked)} at tan θ = {tan}")
    said = f"long waves grow on the first number of flows, a wave of finite length is proved to grow on the second: {', '.join(told)}"
    return Row(
        "all steady flows are unstable for tan θ ≤ 0.28: those of a sample from T_∞ = 0.05 to 30",
        "3.3, figure 8",
        "unstable",
        if_all_hold(cases, said),
        tuple(cases),
    )


REPRODUCTION = Reproduction("gentle_slopes", "Figure 8: gentle slopes, flow by flow", (Item("all flows", gentle),))
