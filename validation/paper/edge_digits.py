"""Figure 8: the edges of stability in T_∞ hold four digits, for the sign of d_x or d_y is known on both sides of each.

Edges are zeros of d_x or d_y, found by edges.py, which has d_y from waves at 45 degrees; here it is that of waves nearly across the slope.
The error of d is what its extrapolation to k → 0 leaves, with the bounds of the modes.
"""

from __future__ import annotations

import math

from claims import Case

from paper.edges import long_wave, steady
from paper.rows import Item, Reproduction, Row, if_all_hold

# measured by edges.py: tan θ, T_∞ at the edge, and what vanishes there
EDGES = (
    (0.29, 1.05366, "x"),
    (0.29, 1.3831, "y"),
    (0.30, 1.00998, "x"),
    (0.30, 1.92101, "y"),
    (0.31, 0.983915, "x"),
    (0.31, 2.57753, "y"),
    (0.32, 0.87495, "x"),
    (0.32, 3.37042, "y"),
)
NEARLY_ACROSS = math.atan(10.0)  # chosen: the direction of waves that give d_y, of which d_x is a hundredth
HALF_A_UNIT = 5e-5  # derived: relative, half of 1e-4: four digits


def growth(tan_theta: float, far_temperature: float, axis: str) -> tuple[float, float]:
    """d along an axis, and its error."""
    flow = steady(tan_theta, far_temperature)
    along = long_wave(flow, 0.0)
    if axis == "x":
        return along.d, along.error
    between, share = long_wave(flow, NEARLY_ACROSS), math.cos(NEARLY_ACROSS) ** 2
    return (between.d - share * along.d) / (1 - share), (between.error + share * along.error) / (1 - share)


def four_digits(quick: bool) -> Row:
    """The sign of d at half a unit of the fourth digit below and above each edge."""
    cases = []
    for tan, edge, axis in EDGES[2:4] if quick else EDGES:
        (below, e), (above, f) = (growth(tan, edge * (1 + step), axis) for step in (-HALF_A_UNIT, HALF_A_UNIT))
        known = abs(below) > e and abs(above) > f
        changes = "yes" if known and below * above < 0 else "no"
        note = f"{below:.2e} ± {e:.0e} below, {above:.2e} ± {f:.0e} above"
        cases.append(Case(f"tan θ = {tan:.2f}, T_∞ = {edge:.6g}: the sign of d_{axis} changes", "yes", changes, 0.0, note))
    where = ", ".join(f"{edge:.6g} (d_{axis} = 0, tan θ = {tan:.2f})" for tan, edge, axis in EDGES)
    return Row(
        "the edges of stability in T_∞ are located to four digits",
        "3.3, figure 8",
        "edges between the flows of a sample; no numbers",
        if_all_hold(cases, f"the sign of d changes within half a unit of the fourth digit, beyond the error of d, at {where}"),
        tuple(cases),
    )


REPRODUCTION = Reproduction("edge_digits", "Figure 8: the digits of the edges", (Item("four digits", four_digits),))
