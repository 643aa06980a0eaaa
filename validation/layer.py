"""A family of problems that costs milliseconds a member, to be swept, killed and asked for often: σ = a − k_x² − k_y² − (mπ)².

y″ + (a − k_x² − k_y² − σ) y = 0, y(0) = y(1) = 0. The command line is given `layer:scene`, with this folder in PYTHONPATH; a goes by the
name of an option that it has, --far-temperature. A sweep over k_x and a has one short line for each a.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

import shootstab as st
from shootstab.core.errors import InputError
from shootstab.problems.linear_problem import LinearProblem

SOURCE = "far_temperature"  # what a is called
A = 60.0  # two modes grow at k = 0, with σ = 60 − (mπ)²


@dataclass(frozen=True)
class Layers:
    """All layers of one a, by k_x and k_y."""

    a: float

    @property
    def sharing(self) -> tuple[str, ...]:
        return ("kx", "ky")

    def checked(self, values: Mapping[str, float]) -> None:
        for name in values:
            if name not in (*self.sharing, SOURCE):
                raise InputError(f"{name}: cannot be swept: allowed is kx, ky or {SOURCE}")

    def absent(self, values: Mapping[str, float]) -> str | None:
        return None

    def problem(self, values: Mapping[str, float]) -> SweptLayer:
        return layer(values.get(SOURCE, self.a), math.hypot(values.get("kx", 0.0), values.get("ky", 0.0)))

    def beside(self, values: Mapping[str, float]) -> Mapping[str, float]:
        return {}

    def as_dict(self) -> dict[str, Any]:
        return {"a": self.a}


@dataclass(frozen=True, eq=False)
class SweptLayer(LinearProblem):
    """One layer, which knows its family."""

    a: float = A

    def family(self, swept: tuple[str, ...]) -> Layers:
        return Layers(self.a)


def layer(a: float = A, k: float = 0.0) -> SweptLayer:
    """The layer with this a at the wavenumber k."""

    def pencil(z: Any) -> Any:
        one, zero = np.ones_like(z), np.zeros_like(z)
        D0 = np.array([[zero, one], [(k * k - a) * one, zero]]).transpose(2, 0, 1)
        D1 = np.array([[zero, zero], [one, zero]]).transpose(2, 0, 1)
        return D0, D1

    found = st.problem(2, pencil, st.Wall(0.0, [[1, 0]]), st.Wall(1.0, [[1, 0]]), vectorized=True)
    return SweptLayer(found.function, found.reduction, found.curve, found.fixed, a=a)


def exact(a: float, k: float, m: int = 1) -> float:
    """σ of mode m."""
    return a - k * k - (m * math.pi) ** 2


scene = layer()
other = layer(50.0)
