"""Plane Poiseuille flow U = 1 − y²: the Orr–Sommerfeld equation as a first-order system.

(D² − α²)² φ = R [(σ + iαU)(D² − α²) − iαU″] φ with φ = φ′ = 0 at the walls; σ = −iαc.
Source: S. A. Orszag, J. Fluid Mech. 50 (1971) 689: R = 10000, α = 1, c = 0.23752649 + 0.00373967i.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import InputError
from shootstab.core.given import require_above_0
from shootstab.core.regions import Rectangle
from shootstab.models.gallery.orr_sommerfeld import CLAMPED, REGION_MARGIN, orr_sommerfeld, require_positive, velocities
from shootstab.models.gallery.poiseuille_collocation import PoiseuilleCollocation
from shootstab.problems import LinearProblem, Wall
from shootstab.problems.closed_form import Exact
from shootstab.problems.linear_problem import problem
from shootstab.problems.protocol import ComplexArray, FarFrame, Pencil
from shootstab.problems.unknowns import Unknowns

STEPS_OF_HALF = 16  # chosen: steps of the first mesh in half the channel


@dataclass(frozen=True)
class PlanePoiseuille:
    """Normal modes exp(σt + iαx); lengths in half-channels, velocities in the centreline velocity.

    half=True takes half the channel, from the centre to the wall, and the even φ that carry the unstable mode; half=False the whole
    channel, from wall to wall. State (φ, φ′, φ″, φ‴).
    """

    reynolds: float = 10000.0
    alpha: float = 1.0
    half: bool = True

    def __post_init__(self) -> None:
        for name, value in (("reynolds", self.reynolds), ("alpha", self.alpha)):
            require_above_0(name, value)

    @property
    def size(self) -> int:
        return 4

    @property
    def decaying(self) -> int:
        return 2

    def pencil(self, z: ComplexArray) -> Pencil:
        a2, R, advect = self.alpha**2, self.reynolds, 1j * self.alpha * self.reynolds
        U = 1 - z * z
        C0, C1, D0, D1 = (np.zeros((len(z), 4, 4), dtype=np.complex128) for _ in range(4))
        C0[:] = np.eye(4)
        D0[:, [0, 1, 2], [1, 2, 3]] = 1.0
        D0[:, 3, 0] = -a2 * a2 - advect * (U * a2 - 2)
        D0[:, 3, 2] = 2 * a2 + advect * U
        D1[:, 3, 0], D1[:, 3, 2] = -R * a2, R
        return Pencil(C0, C1, D0, D1)

    @property
    def _free(self) -> tuple[int, int]:
        """The states that begin with any value."""
        return (0, 2) if self.half else (2, 3)

    @property
    def factors(self) -> tuple[PlanePoiseuille, ...]:
        """What D of the whole channel is the product of: the even modes and the odd ones (theory, lemma E9)."""
        return () if self.half else (replace(self, half=True), OddPoiseuille(self.reynolds, self.alpha))

    @property
    def unknowns(self) -> Unknowns:
        """The streamfunction and the velocities."""
        return replace(Unknowns.combinations(velocities(self.alpha), self.size), variable="y")

    def exact_unknowns(self, exact: Exact) -> dict[str, dict[int, Any]]:
        """The same for numbers of any kind."""
        return {"phi": {0: 1}, "u": {1: 1}, "v": {0: -1j * exact(self.alpha)}}

    @property
    def pseudospectral(self) -> PoiseuilleCollocation:
        """Chebyshev collocation in vorticity and streamfunction."""
        return PoiseuilleCollocation(self.reynolds, self.alpha, self.half)

    def growing_region(self, floor: float) -> tuple[Rectangle, str]:
        """A rectangle that holds every σ with Re σ ≥ floor, whatever the floor, by lemma P1 of the guide's page on proofs.

        With Q = ∫|φ′|² + α²|φ|², multiplication of the equation by φ* and integration give c_r Q = ∫U(|φ′|² + α²|φ|²) − ∫|φ|² and
        c_i Q ≤ 2 ∫|φ′||φ|. As 0 ≤ U ≤ 1 and ∫|φ′|² ≥ λ∫|φ|², λ = π²/4:

            −1/(λ + α²) ≤ c_r ≤ 1,   c_i ≤ max_{x ≥ √λ} 2x/(x² + α²) = 2√λ/(λ + α²), or 1/α where α² > λ.

        Source: D. D. Joseph, J. Fluid Mech. 33 (1968) 617. The corners are rounded outwards.
        Raises InputError where the floor lies above all of this.
        """
        a2, root = self.alpha**2, 0.5 * math.pi
        top = self.alpha * (2 * root / (root * root + a2) if a2 <= root * root else 1 / self.alpha)
        low, high = -self.alpha, self.alpha / (root * root + a2)
        if not floor < top:
            raise InputError(f"floor = {floor!r}: allowed is a number below {top:.6g}, above which no mode grows")
        return Rectangle(complex(floor, low - REGION_MARGIN), complex(top + REGION_MARGIN, high + REGION_MARGIN)), "P1"

    @property
    def certified(self) -> dict[str, Any] | None:
        """What shootstab/checkers/plane_poiseuille.py knows the problem by; the channel has that of its factors."""
        return {"name": "plane Poiseuille", "reynolds": repr(float(self.reynolds)), "alpha": repr(float(self.alpha)), "modes": self._modes}

    def certificates(self, proof: Any, count: int, spare_bits: int) -> Iterator[dict[str, Any]]:
        """What to try as a certificate of a proof, each with more points and bits."""
        from shootstab.models.gallery.poiseuille_certificate import certificates

        return certificates(self, proof, count, spare_bits)

    @property
    def _modes(self) -> str:
        return "even"

    @property
    def closed_form(self) -> PlanePoiseuille:
        """Itself, by the exact_… methods."""
        return self

    def exact_ends(self, exact: Exact) -> tuple[Any, Any]:
        return exact(0.0 if self.half else -1.0), exact(1.0)

    def exact_pencil(self, z: Any, exact: Exact) -> tuple[dict[tuple[int, int], Any], ...]:
        """The matrices of `pencil` for a power series z and exact parameters."""
        R, alpha = exact(self.reynolds), exact(self.alpha)
        a2, advect, U = alpha * alpha, 1j * alpha * R, 1 - z * z
        above = dict.fromkeys(((0, 1), (1, 2), (2, 3)), 1)
        D0 = {**above, (3, 0): -a2 * a2 - advect * (U * a2 - 2), (3, 2): 2 * a2 + advect * U}
        return {(i, i): 1 for i in range(4)}, {}, D0, {(3, 0): -R * a2, (3, 2): R}

    def exact_far(self, sigma: Any, exact: Exact) -> list[list[int]]:
        return [[int(i == j) for j in self._free] for i in range(4)]

    def exact_wall(self, exact: Exact) -> tuple[list[list[int]], list[list[int]]]:
        return [[int(i == j) for j in range(4)] for i in range(2)], [[0] * 4] * 2

    def start(self, sigma: complex, tolerance: float) -> float:
        """The centre, or the other wall."""
        return 0.0 if self.half else -1.0

    def far_frame(self, z: float, sigma: complex) -> FarFrame:
        """Even solutions at the centre; at a wall those with φ = φ′ = 0."""
        frame = np.eye(4, dtype=np.complex128)[:, list(self._free)]
        return FarFrame(frame, np.zeros_like(frame), 0.0, 0.0)

    def mesh(self, start: float) -> NDArray[np.float64]:
        return np.linspace(start, 1.0, STEPS_OF_HALF + 1 if self.half else 2 * STEPS_OF_HALF + 1)

    def wall_rows(self) -> tuple[ComplexArray, ComplexArray]:
        W0 = np.eye(4, dtype=np.complex128)[:2]
        return W0, np.zeros_like(W0)

    def with_base_flow_error(self, factor: float) -> PlanePoiseuille:
        """Itself: the base flow is in closed form."""
        return self


@dataclass(frozen=True)
class OddPoiseuille(PlanePoiseuille):
    """The modes with odd φ alone, in half the channel."""

    @property
    def _free(self) -> tuple[int, int]:
        return 1, 3

    @property
    def pseudospectral(self) -> None:  # type: ignore[override]
        """None: the collocation of half the channel is that of the even modes."""

    @property
    def _modes(self) -> str:
        return "odd"


def plane_poiseuille(reynolds: complex = 10000.0, alpha: complex = 1.0) -> LinearProblem:
    """The even modes in half the channel, for complex R and α too: the same equation, written down with `problem`."""
    require_positive(reynolds=reynolds, alpha=alpha)

    def profile(y: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        return 1 - y * y, np.full_like(y, -2)

    even = np.eye(4)[[1, 3]]  # φ′ = φ‴ = 0
    return problem(
        4, orr_sommerfeld(profile, reynolds, alpha), Wall(0.0, even), Wall(1.0, CLAMPED), vectorized=True, unknowns=velocities(alpha)
    )
