"""A branch of steady flows followed: from one flow, by small steps of mass flux and parameters, to the flow of others that continues it.

Flows of one mass flux Q0 are zeros of ln Q0(T_∞) − ln Q0 in x = ln T_∞, and several where Q0(T_∞) folds. Which of them continues a given
flow is no question of names, for the one flow of Q0 = 2.5 may lie on the low branch of those of Q0 = 3. So mass flux and parameters go
straight from the given flow's own to those wanted, and x follows; where d ln Q0/dx runs into zero the branch ends in a fold.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from shootstab.core.errors import NoFlowError
from shootstab.core.numerus import PERCENT
from shootstab.models.chute.family import SCOUTING, solve_between
from shootstab.models.chute.parameters import Chute
from shootstab.models.chute.registry import CHUTE, names
from shootstab.models.chute.steady_flow import Flow, descend

ASIDE = 1e-4  # chosen: step of x for d ln Q0/dx; scouting flows of 1e-9 leave five digits of it
LONGEST_STEP = 0.1  # |Δx| of one step: chosen, a tenth of what separates the branches of the paper's flows where they are nearest
STEADY = 2.0  # chosen: ratio of the slopes d ln Q0/dx at the ends of a step, at most: next to a fold steps shrink with the way left to it
TO_THE_FOLD = 0.7  # chosen: part of the way to the fold, as it is seen from here, that one step takes at most
SMALLEST_STEP = 1e-6  # step, of the whole way: a fold lies no farther ahead than a few of these (chosen)
# chosen: steps of Newton to a point of the branch, and the relative step that ends them; more mean a shorter step along it
BRANCH_NEWTONS, BRANCH_SETTLED = 4, 1e-8
SCOUTED_WITHIN = 1e-5  # chosen: the most that the best integration moves a flow in x from what scouting flows gave


def continued(flow: Flow, chute: Chute, mass_flux: float) -> Flow:
    """The flow of this chute and mass flux on the branch of the given one.

    Raises NoFlowError, which says where, if the branch ends on the straight way there.
    """
    x, slope = _settled(flow.chute, flow.mass_flux, math.log(flow.far_temperature)) or _ended(0.0, flow.mass_flux)
    place, step, rate = 0.0, 1.0, 0.0
    while place < 1.0:
        step = min(step, 1.0 - place)
        ahead = 1.0 if step >= 1.0 - place else place + step
        flux = flow.mass_flux ** (1 - ahead) * mass_flux**ahead
        found = _settled(_between(flow.chute, chute, ahead), flux, x + rate * (ahead - place))
        if found is not None and abs(found[0] - x) <= LONGEST_STEP and 1 / STEADY <= found[1] / slope <= STEADY:
            rate, done = (found[0] - x) / (ahead - place), ahead - place
            flatter = (found[1] / slope) ** 2
            (x, slope), place = found, ahead
            # the square of the slope falls linearly towards a fold
            step = min(2 * done, TO_THE_FOLD * done * flatter / (1 - flatter)) if flatter < 1.0 else 2 * done
            continue
        step /= 2
        if step < SMALLEST_STEP:
            _ended(place, flow.mass_flux ** (1 - place) * mass_flux**place)
    return solve_between(chute, mass_flux, x - SCOUTED_WITHIN, x + SCOUTED_WITHIN)


def _between(one: Chute, other: Chute, place: float) -> Chute:
    """The chute at a place between 0 and 1 on the straight way from one to the other, which have the same words."""
    if one == other or place == 1.0:
        return other
    changed: dict[str, Any] = {n: (1 - place) * getattr(one, n) + place * getattr(other, n) for n in names(CHUTE, numbers=True)}
    return replace(other, **changed)


def _settled(chute: Chute, mass_flux: float, x: float) -> tuple[float, float] | None:
    """(x, d ln Q0/dx) of the flow next to x, by Newton; None where it does not settle, or no flow exists."""
    goal = math.log(mass_flux)
    try:
        for _ in range(BRANCH_NEWTONS):
            here, aside = (math.log(descend(chute, math.exp(at), SCOUTING).mass_flux) for at in (x, x + ASIDE))
            slope = (aside - here) / ASIDE
            if slope == 0.0:  # a fold, which no step of Newton leaves
                return None
            if abs(goal - here) <= BRANCH_SETTLED * abs(slope):
                return x + (goal - here) / slope, slope
            change = (goal - here) / slope
            if not abs(change) <= LONGEST_STEP:
                return None
            x += change
    except (NoFlowError, ValueError):  # a flow without a positive mass flux has no logarithm
        return None
    return None


def _ended(place: float, mass_flux: float) -> Any:
    raise NoFlowError(
        f"the branch of the scene's flow ends on the way there, after {PERCENT * place:.3g} % of it, at mass_flux = {mass_flux:.6g}: "
        "in a fold of the family, or where its flows end"
    )
