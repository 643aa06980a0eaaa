"""What a perturbation of a chute flow does with the grains: its local mass flux, and whether that forms vortices.

    Q1 = (ν0 û + ν̂ u0, ν0 v̂, ν0 ŵ)        (3.1)

In the plane of the wave vector and z, with θ the phase of the wave, the flux is Re(q e^{iθ}), q = (k_x Q_x + k_y Q_y)/K, along the slope
and Re(Q_z e^{iθ}) away from it. Both vanish for one θ where Im(q Q_z*) = 0. If the flux turns around such a point, as it does where its
gradient has complex eigenvalues, the point is the middle of a vortex. The rule, by which the paper's three modes come out as it calls them:
a mode is vortex-forming if there is a vortex below the height that holds all but MASS_LEFT_OUT of the mass, and clustering otherwise.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from shootstab.models.chute import constitutive as law
from shootstab.problems.protocol import ComplexArray

if TYPE_CHECKING:
    from shootstab.models.chute.steady_flow import Flow

MASS_LEFT_OUT = 1e-3  # chosen: the part of the hold-up M0 above the height that is drawn; nobody would see a vortex there
FLUX_HEIGHTS = 801  # chosen: samples of the flux up to there; a vortex smaller than a few of their distances is not found
VORTEX_FORMING, CLUSTERING = "vortex-forming", "clustering"


@dataclass(frozen=True)
class ModeShape:
    """The mode shapes of one flow and one wave; unknowns are ν̂, û, v̂, ŵ, T̂ by name, at heights z (m,)."""

    flow: Flow
    kx: float
    ky: float

    def fields(self, z: NDArray[np.float64], unknowns: Mapping[str, ComplexArray]) -> dict[str, ComplexArray]:
        """The local mass flux (3.1), each component (m,), from unknowns (m,) at z (m,)."""
        states = self.flow.states_at(z)
        nu0, u0 = np.exp(states[:, 0]).real, states[:, 2].real
        return {
            "Qx": nu0 * unknowns["u"] + unknowns["nu"] * u0,
            "Qy": nu0 * unknowns["v"],
            "Qz": nu0 * unknowns["w"],
        }

    @property
    def heights(self) -> NDArray[np.float64]:
        """Where the rule looks: from the base to where the mass above, ∫ν0 dz = p, is MASS_LEFT_OUT of M0."""
        nu, T = np.exp(self.flow.states[:, 0].real), self.flow.states[:, 1].real
        pressure = nu * law.reduced_pressure(nu, self.flow.chute.ep, self.flow.chute.radial_law) * T
        above = np.log(pressure)  # nearly linear between two nodes
        top = np.interp(math.log(MASS_LEFT_OUT * self.flow.hold_up), above, self.flow.nodes)
        return np.linspace(0.0, float(top), FLUX_HEIGHTS)

    def vortices(self, z: NDArray[np.float64], unknowns: Mapping[str, ComplexArray]) -> tuple[float, ...]:
        """The heights of the middles of vortices, of unknowns (m,) at z (m,).

        In each wavelength there are two at every such height, which turn against each other.
        """
        from scipy.interpolate import CubicSpline

        flux, K = self.fields(z, unknowns), math.hypot(self.kx, self.ky)
        q, w = CubicSpline(z, (self.kx * flux["Qx"] + self.ky * flux["Qy"]) / K), CubicSpline(z, flux["Qz"])
        found = []
        for middle in CubicSpline(z, (q(z) * w(z).conj()).imag).roots(extrapolate=False):
            if z[1] < middle < z[-1]:
                larger = max((complex(q(middle)), complex(w(middle))), key=abs)
                turn = 1j * np.conj(larger) / abs(larger)  # e^{iθ} for which both vanish
                gradient = [[(1j * K * f(middle) * turn).real, (f(middle, 1) * turn).real] for f in (q, w)]
                (a, b), (c, d) = gradient
                if (a + d) ** 2 < 4 * (a * d - b * c):
                    found.append(float(middle))
        return tuple(found)

    def kind(self, z: NDArray[np.float64], unknowns: Mapping[str, ComplexArray]) -> str:
        """'vortex-forming' or 'clustering', by unknowns (m,) at the heights z (m,) of the rule.

        Empty for a mode of the velocity across the plane of the wave alone, as v̂ at k_y = 0: it carries no mass in that plane.
        """
        flux = self.fields(z, unknowns)
        if not (np.any(self.kx * flux["Qx"] + self.ky * flux["Qy"]) or np.any(flux["Qz"])):
            return ""
        return VORTEX_FORMING if self.vortices(z, unknowns) else CLUSTERING
