"""The chute on a truncated domain [0, z_m], as the paper solves it: four conditions at z_m in place of the decaying space."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import shootstab as st
from shootstab.models.chute import ChuteProblem
from shootstab.models.chute.background import Background
from shootstab.models.chute.first_order_system import SIZE
from shootstab.models.chute.tabulated import as_background, tabulated

NU_TRUNCATION = 1e-10  # published: section 2.3, the volume fraction at the truncation


def truncated(p: ChuteProblem, z_m: float, decay: np.ndarray, pencil: Callable[[Any], tuple[Any, ...]] | None = None) -> Any:
    """The equations, or another pencil in the same state, with (û, v̂, ŵ, T̂)′ + decay (û, v̂, ŵ, T̂) = 0 at z_m; decay is (4, 4)."""
    fields = tabulated(p.flow.chute, p.flow.states_at(np.array([z_m]))).real

    def own(z: Any) -> tuple[Any, ...]:
        at = p.pencil(np.asarray(z, dtype=complex))
        return at.C0, at.C1, at.D0, at.D1

    ends = st.Wall(0.0, *p.wall_rows()), st.Wall(z_m, *conditions(as_background(fields[:, 0]), p.kx, p.ky, decay))
    return st.problem(p.size, pencil or own, *ends, continuum=False, vectorized=True)


def conditions(bg: Background, kx: float, ky: float, decay: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """W0, W1 (4, 8) at z_m, with the background of that one point: (W0 + σ W1) ψ = 0.

    ŵ′ is that of mass conservation, and K0* ν̂′ is left out of −β̂ = K0 T̂′ − K0* ν̂′, as ν0 is in (2.22).
    """
    conductivity, ell, u = (float(part[0]) for part in (bg.K, bg.decay, bg.u))
    rows, moving = np.zeros((4, SIZE), dtype=complex), np.zeros((4, SIZE), dtype=complex)
    rows[0, 5] = rows[1, 6] = 1.0
    rows[2, :4] = -1j * kx * u, -1j * kx, -1j * ky, -ell
    moving[2, 0] = -1.0
    rows[:3, 1:4] += decay[:3, :3]
    rows[3, 7], rows[3, 4] = -1.0, conductivity * decay[3, 3]
    return rows, moving
