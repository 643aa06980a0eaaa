"""How D grows: for large |σ| in the right half-plane ln D = 2A σ^(1/2) + B ln σ + …, so that q = σ D′/D = A σ^(1/2) + B + C σ^(−1/2) + ….

Divided by exp(2A (σ + s)^(1/2)) (σ + s)^B, s > 0, which is analytic and not 0 for Re σ > −s, D has the same zeros in that half-plane and
hardly turns on an arc of the size at which A and B were found: a count then takes a third of the samples.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

import numpy as np

from shootstab.core.discriminant import Value
from shootstab.core.scaled import Scaled
from shootstab.discriminants.method import AdaptiveDiscriminant
from shootstab.discriminants.shared_meshes import SharedMeshes

# chosen: nine directions on a half circle in Re σ > 0 in which the law of D at large |σ| is looked at
ANGLES = np.linspace(-0.5, 0.5, 9) * math.pi
LEAST_TURN = 0.5  # chosen: |σ D′/D|, half of what a single zero far inside adds
LAW_SHIFT = 1 / 16  # chosen: s in the radius of the arc: near 0, where D follows no law, what is divided by is smooth


@dataclass(frozen=True)
class GrowthLaw:
    """A and B on an arc of this radius; departure is max |q − A σ^(1/2) − B − C σ^(−1/2)| on it, infinite where q is no number,
    and where |q| is nowhere as large as LEAST_TURN: there D does not feel σ yet.

    A zero of D adds σ/(σ − σ₀) to q. One that lies between two arcs of radii 1 to 4 departs by 0.24 at least on one of them, as a search
    over σ₀ finds, two by 0.23, three by 0.16, four by 0.10.

    work is the number of steps that were integrated for it.
    """

    radius: float
    A: complex
    B: complex
    departure: float
    work: int

    @classmethod
    def on(cls, discriminant: AdaptiveDiscriminant, radius: float, meshes: SharedMeshes | None = None) -> GrowthLaw:
        """The law fitted to the arc |σ| = radius, Re σ ≥ 0; meshes are those that other arcs left, and receive the new ones."""
        sigmas = radius * np.exp(1j * ANGLES)
        meshes = SharedMeshes() if meshes is None else meshes
        q, work = np.empty_like(sigmas), 0
        for i, s in enumerate(sigmas.tolist()):
            D = meshes.at(discriminant, s)
            q[i] = s * D.with_derivative(s).logarithmic_derivative  # the value by which the mesh was found to serve
            work += D.steps
        if not (np.isfinite(q).all() and np.abs(q).max() >= LEAST_TURN):
            return cls(radius, 0j, 0j, math.inf, work)
        basis = np.stack((np.sqrt(sigmas), np.ones_like(sigmas), 1.0 / np.sqrt(sigmas)), axis=1)
        A, B, C = np.linalg.lstsq(basis, q, rcond=None)[0]
        return cls(radius, complex(A), complex(B), float(np.abs(q - basis @ (A, B, C)).max()), work)

    def divided_out(self, value: Value) -> Value:
        """D over exp(2A (σ + s)^(1/2)) (σ + s)^B, with its derivative, from D where Re σ > −s."""
        at = value.sigma + LAW_SHIFT * self.radius
        root = cmath.sqrt(at)
        grown = 2.0 * self.A * root + self.B * cmath.log(at)
        turned = cmath.exp(-1j * grown.imag)
        slope = value.dD - value.D.mantissa * (self.A / root + self.B / at)
        return Value(value.sigma, Scaled(value.D.mantissa * turned, value.D.log_scale - grown.real), slope * turned)
