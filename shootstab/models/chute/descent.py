"""The equations of the steady flow as recorded programs, for `kernels.taylor_pieces` to integrate."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shootstab.core.straight_line import Recorder, exp, program
from shootstab.models.chute import constitutive as law
from shootstab.models.chute.balance import slip, slopes

DESCENT_SIZE = 7  # exact: ln ν, T, u, Q, and from z to infinity ∫p, ∫νu, ∫ν
FILLED = 0.9999  # chosen: part of the densest packing beyond which no flow is followed; g0 is above 1e6 there, and pieces are lost to it
HEAT = 1e-2  # chosen: Q counts as ν√T times this at least, for it passes through zero

Lists = tuple[Any, ...]


@lru_cache
def equations(radial: int, real: bool = True) -> Lists:
    """The program of the flow with this radial distribution, in lists for a kernel, in real or complex numbers; parameters are those of
    `Chute.numbers`.

    Its results are the slopes of the state, the sizes its errors are measured against, and the energy defect of the base.
    """
    recorder = Recorder()
    state = recorder.inputs(DESCENT_SIZE)
    ep, tan_theta, r, delta, _, *rest = recorder.parameters(5 + len(law.RADIAL_PARAMETERS))
    radial_law = (radial, *rest)
    log_nu, T, u, Q = state[:4]
    nu = exp(log_nu)
    decay, T_z, u_z, Q_z = slopes(nu, T, Q, ep, tan_theta, radial_law, math.pi)
    pressure = nu * law.reduced_pressure(nu, ep, radial_law) * T
    rates = (decay, T_z, u_z, Q_z, -pressure, -nu * u, -nu)
    sizes = (1.0, T, T**0.5, HEAT * nu * T**0.5, state[4], nu * T**1.5, state[6])
    recorded = program(recorder, [*rates, *sizes, defect(nu, T, u_z, Q, radial_law, ep, tan_theta, r, delta)])
    return recorded.lists(real)


def defect(nu: Any, T: Any, u_z: Any, Q: Any, radial_law: Any, ep: Any, tan_theta: Any, r: Any, delta: Any) -> Any:
    """(q − tanθ p u_slip + Δ p √T)/p, zero at the base."""
    u = slip(nu, T, u_z, law.radial(nu, radial_law)[0], r, tan_theta, math.pi)
    return Q / (law.reduced_pressure(nu, ep, radial_law) * T) - tan_theta * u + delta * T**0.5


def limits(densest: float, hottest: float) -> NDArray[np.float64]:
    """What the components of a state stay above and below, (2, 7): T above 0 and below the hottest, and ν short of the densest packing."""
    out = np.tile([[-np.inf], [np.inf]], DESCENT_SIZE)
    out[0, 1], out[1, 1], out[1, 0] = 0.0, hottest, math.log(FILLED * densest)
    return out
