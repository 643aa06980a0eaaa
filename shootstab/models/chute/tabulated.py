"""The fields of `background` at many points of a flow, by programs recorded of the same formulas: one for each radial distribution."""

from __future__ import annotations

import math
from dataclasses import fields as fields_of
from functools import lru_cache
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shootstab.core.series import Series
from shootstab.core.straight_line import Program, Recorded, Recorder, program
from shootstab.kernels.recorded_programs import evaluate, series
from shootstab.models.chute import constitutive as law
from shootstab.models.chute.background import Background, background, fields
from shootstab.models.chute.first_order_system import pencil_entries
from shootstab.models.chute.parameters import Chute
from shootstab.problems.recorded_pencil import Entries

PencilEntries = tuple[Entries, Entries, Entries, Entries]
NAMES = tuple(f.name for f in fields_of(Background))
FIELD_COUNT = 2 * len(NAMES)  # derived: the fields with their derivatives


def tabulated(chute: Chute, states: NDArray[np.complex128], derivatives: bool = True) -> NDArray[np.inexact]:
    """F and F′ of all fields in turn at states (p, 6) of a flow, (44, p), or without derivatives F alone; real where the states are."""
    inputs: NDArray[np.inexact] = np.array(states[:, :4].T, order="C")
    if not inputs.imag.any():
        inputs = inputs.real.copy()
    np.exp(inputs[0], out=inputs[0])
    return evaluate(_recorded(chute.radial_law[0], derivatives), inputs, _parameters(chute).astype(inputs.dtype))


def expanded(chute: Chute, states: NDArray[np.inexact]) -> NDArray[np.complex128]:
    """The fields and their derivatives (44, N) as power series in ν, from the states (ν, T, u, Q) (4, N) as such series."""
    return series(_recorded(chute.radial_law[0], True), states, _parameters(chute))


def as_background(values: Any, derivatives: bool = True) -> Background:
    """The fields as series F + F′ε, or of one term; recorded numbers may stand for them."""
    terms = 2 if derivatives else 1
    return Background(**{name: Series(values[k * terms : (k + 1) * terms]) for k, name in enumerate(NAMES)})


def pencil_formula(
    values: list[Recorded], parameters: list[Recorded], shape: tuple[bool, bool]
) -> tuple[Entries, Entries, Entries, Entries]:
    """The entries of the pencil from the fields and (tanθ, k_x, k_y); shape tells which of the wavenumbers are zero."""
    tan_theta, *waves = parameters
    kx, ky = (0.0 if zero else k for zero, k in zip(shape, waves, strict=True))
    return pencil_entries(as_background(values), tan_theta, kx, ky)


def _parameters(chute: Chute) -> NDArray[np.float64]:
    return np.array([chute.ep, chute.tan_theta, *chute.radial_law[1:]])


@lru_cache
def _recorded(radial: int, derivatives: bool) -> Program:
    """The fields from (ν, T, u, Q) with the parameters (η_p, tanθ, *law.RADIAL_PARAMETERS), for one radial distribution."""
    recorder = Recorder()
    nu, T, u, Q = recorder.inputs(4)
    ep, tan_theta, *rest = recorder.parameters(2 + len(law.RADIAL_PARAMETERS))
    chute: Any = SimpleNamespace(ep=ep, tan_theta=tan_theta, radial_law=(radial, *rest))
    found = (background if derivatives else fields)(chute, nu, T, u, Q, math.pi)
    results = [getattr(found, name) for name in NAMES]
    return program(recorder, [F for pair in results for F in pair.coefficients] if derivatives else results)
