"""The chute on a truncated domain [0, z_m], as the paper solves it: four conditions at z_m in place of the decaying space."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import shootstab as st
from shootstab.models.chute import ChuteProblem
from shootstab.models.chute.tabulated import as_background, tabulated

NU_TRUNCATION = 1e-10  # published: section 2.3, the volume fraction at the truncation


def truncated(p: ChuteProblem, z_m: float, decay: np.ndarray, pencil: Callable[[Any], tuple[Any, ...]] | None = None) -> Any:
    """The equations, or another pencil in the same state, with (û, v̂, ŵ, T̂)′ + decay (û, v̂, ŵ, T̂) = 0 at z_m; decay is (4, 4).

    ŵ′ is that of mass conservation, and K0* ν̂′ is left out of −β̂ = K0 T̂′ − K0* ν̂′, as ν0 is in (2.22).
    """
    bg = as_background(tabulated(p.flow.chute, p.flow.states_at(np.array([z_m]))).real)
    conductivity, ell, u = (float(part[0][0]) for part in (bg.K, bg.decay, bg.u))
    rows, moving = np.zeros((4, p.size), dtype=complex), np.zeros((4, p.size), dtype=complex)
    rows[0, 5] = rows[1, 6] = 1.0
    rows[2, :4] = -1j * p.kx * u, -1j * p.kx, -1j * p.ky, -ell
    moving[2, 0] = -1.0
    rows[:3, 1:4] += decay[:3, :3]
    rows[3, 7], rows[3, 4] = -1.0, conductivity * decay[3, 3]

    def own(z: Any) -> tuple[Any, ...]:
        at = p.pencil(np.asarray(z, dtype=complex))
        return at.C0, at.C1, at.D0, at.D1

    ends = st.Wall(0.0, *p.wall_rows()), st.Wall(z_m, rows, moving)
    return st.problem(p.size, pencil or own, *ends, continuum=False, vectorized=True)
