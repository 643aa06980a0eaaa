"""Perturbations of a steady chute flow with wavenumbers kx, ky, behind the problem protocol: all that shooting asks for."""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Self

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import InputError
from shootstab.core.given import require_real
from shootstab.models.chute import first_order_system as system
from shootstab.models.chute.background import Background
from shootstab.models.chute.family import with_base_flow_error
from shootstab.models.chute.far_field import FarField
from shootstab.models.chute.steady_flow import Flow
from shootstab.models.chute.tabulated import FIELD_COUNT, as_background, pencil_formula, tabulated
from shootstab.models.chute.wall import wall_rows
from shootstab.problems.protocol import ComplexArray, FarFrame, Pencil
from shootstab.problems.recorded_pencil import Entries, RecordedPencil
from shootstab.problems.unknowns import Unknowns

PERTURBED = ("nu", "u", "v", "w", "T")

NU_OUTERMOST = 1e-14  # chosen: ν0 where the continuous spectrum ends; beyond, σ_c differs from its limit by less than rounding


@dataclass(frozen=True)
class ChuteContinuum:
    """σ_c(z) of (2.13)."""

    flow: Flow
    kx: float

    def heights(self, points: int) -> NDArray[np.float64]:
        """Heights from the base to ν0 = NU_OUTERMOST."""
        return np.linspace(0.0, self.flow.height(NU_OUTERMOST), points)

    def __call__(self, z: ComplexArray) -> ComplexArray:
        """σ_c (m,) at points z (m,)."""
        values = as_background(tabulated(self.flow.chute, self.flow.states_at(z), derivatives=False), derivatives=False)
        return np.asarray(system.continuum(values, self.kx)[0], dtype=np.complex128)


@dataclass(frozen=True, eq=False)
class Perturbations:
    """Normal modes exp(σt + i k_x x + i k_y y) on a steady flow; order 8, four decaying solutions, four wall rows.

    Units: grain diameter and √(d/(g cosθ)) for 1/σ.
    """

    flow: Flow
    kx: float
    ky: float
    _crude: dict[float, Self] = field(default_factory=dict, repr=False)
    _log_nu: dict[float, float] = field(default_factory=dict, repr=False)  # ln ν0 at the heights where a far frame was asked for

    def __post_init__(self) -> None:
        for name, value in (("kx", self.kx), ("ky", self.ky)):
            require_real(name, value, lambda _: True, "a finite number")
        if self.kx == 0.0 and self.ky == 0.0:
            raise InputError("kx = 0 and ky = 0: allowed is any pair but this one, at which nothing decays")

    @property
    def unchanging(self) -> bool:
        """A flow and two numbers."""
        return True

    @property
    def structure(self) -> Hashable:
        """The flow and which wavenumbers are 0: all other waves on it have the same entries."""
        return self.flow, self.kx == 0.0, self.ky == 0.0

    @property
    def size(self) -> int:
        return system.SIZE

    @property
    def decaying(self) -> int:
        return system.DECAYING

    def pencil(self, z: ComplexArray) -> Pencil:
        """The scaled first-order system (see first_order_system.py) at z (m,); off the real axis the flow is continued along z."""
        parts = system.pencil_entries(self._background(z), self.flow.chute.tan_theta, self.kx, self.ky)
        C0, C1, D0, D1 = (_dense(entries, len(z)) for entries in parts)
        return Pencil(C0, C1, D0, D1)

    @cached_property
    def recorded(self) -> RecordedPencil:
        """The same system as a formula of the fields."""
        parameters = np.array([self.flow.chute.tan_theta, self.kx, self.ky])
        return RecordedPencil(pencil_formula, (self.kx == 0.0, self.ky == 0.0), self.size, self._fields, parameters, FIELD_COUNT)

    def start(self, sigma: complex, tolerance: float) -> float:
        """Where the series of the far field holds to the tolerance."""
        return self.flow.height(self.flow.inside(self._far.largest_start(sigma, tolerance)))

    def far_frame(self, z: float, sigma: complex) -> FarFrame:
        if z not in self._log_nu:
            self._log_nu[z] = float(self.flow.states_at(z)[0].real)
        log_nu = self._log_nu[z]
        frame, tangent, error = self._far.at(math.exp(log_nu), sigma)
        return FarFrame(frame, tangent, self._far.trace * log_nu, error)

    def mesh(self, start: float) -> NDArray[np.float64]:
        """The start and the centres, (m,) in all, of the steady flow's own Taylor polynomials."""
        return np.concatenate(([start], self.flow.nodes[self.flow.nodes < start]))

    def wall_rows(self) -> tuple[ComplexArray, ComplexArray]:
        return self._wall_rows

    @cached_property
    def _wall_rows(self) -> tuple[ComplexArray, ComplexArray]:
        return wall_rows(self.flow.chute, _base(self.flow), self.kx, self.ky, math.pi)

    def with_base_flow_error(self, factor: float) -> Self:
        """The same problem on a steady flow computed with a tolerance larger by this factor."""
        if factor not in self._crude:
            self._crude[factor] = type(self)(with_base_flow_error(self.flow, factor), self.kx, self.ky)
        return self._crude[factor]

    @property
    def continuum(self) -> ChuteContinuum:
        """σ_c(z), where det C = 0 (A 9)."""
        return ChuteContinuum(self.flow, self.kx)

    @property
    def unknowns(self) -> Unknowns:
        """ν̂, û, v̂, ŵ, T̂, in units of ρ_p, √(d g cosθ) and d g cosθ: the state with its first component times ν0."""

        def matrix(z: ComplexArray, sigma: complex) -> ComplexArray:
            out = np.zeros((len(z), len(PERTURBED), system.SIZE), dtype=np.complex128)
            out[:, np.arange(len(PERTURBED)), np.arange(len(PERTURBED))] = 1.0
            out[:, 0, 0] = np.exp(self.flow.states_at(z)[:, 0])
            return out

        return Unknowns(PERTURBED, matrix)

    def _background(self, z: ComplexArray) -> Background:
        return as_background(self._fields(z))

    def _fields(self, z: ComplexArray) -> NDArray[np.inexact]:
        return _along_path(self.flow, np.ascontiguousarray(z, dtype=np.complex128).tobytes())

    @cached_property
    def _far(self) -> FarField:
        return FarField(self.flow.chute, self.flow.far_temperature, self.flow.far_velocity, self.kx, self.ky)


@lru_cache(maxsize=8)
def _along_path(flow: Flow, points: bytes) -> NDArray[np.inexact]:
    """The fields at points of a path: for all waves that share a mesh they are the same."""
    return tabulated(flow.chute, flow.states_at(np.frombuffer(points, dtype=np.complex128), order="path"))


@lru_cache(maxsize=16)
def _base(flow: Flow) -> Background:
    """The background at the base, in numbers."""
    return as_background(tabulated(flow.chute, flow.states_at(np.zeros(1)))[:, 0].tolist())


def _dense(entries: Entries, points: int) -> ComplexArray:
    out = np.zeros((points, system.SIZE, system.SIZE), dtype=np.complex128)
    for (i, j), entry in entries.items():
        out[:, i, j] = entry
    return out
