"""Where to begin: the nearest place at which the decaying space of a constant matrix is that of the problem.

Where the coefficients come to a limit, that is where they have come to it, whatever the solutions do: a mode that decays as e^{−0.02 z}
in a potential sech² z starts at z = 20. The error left is, to first order and component by component in the basis V of the solutions at
infinity,

    |V⁻¹| ∫_z^∞ |C⁻¹(ΔD − ΔC A)| ds |V|.

Where they have no limit the matrix is frozen at z. Its space turns at the rate |ℓ2 A_z X|; of what it is wrong by, only that which
the integration towards the wall has not damped by the gap between the rates after half the way is an error of the mode.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import InputError
from shootstab.problems.pencil_function import PencilFunction
from shootstab.problems.protocol import Pencil
from shootstab.problems.splitting import AsymptoticPencil, SpectralSplitting, gap

NEGLIGIBLE = 1e-20  # of the largest entry of each matrix: coefficients are at their limit
NEAREST, FARTHEST = 2.0**-10, 2.0**20
SAMPLES = 64
TAIL = 2.0  # the tail is sampled out to so many times the distance, 1 more
WAY = 9  # points at which the gap is sampled between a frozen end and half the way


def limit_at(matrices: PencilFunction, direction: int, given: tuple[object, ...] | None, where: str) -> AsymptoticPencil:
    """The pencil at ±∞, as given or as the function says. Raises InputError where it says nothing finite."""
    source = matrices if given is None else PencilFunction(matrices.size, lambda z: given)
    try:
        return AsymptoticPencil(*source.at(direction * math.inf), direction)
    except InputError as error:
        if given is not None:
            raise InputError(f"the limit given at {where}: {error}") from error
        advice = "allowed is a finite limit there, or st.Infinity(limit=...), or st.Infinity(start=...) where there is none"
        raise InputError(f"at {where}: {error}: {advice}") from error


def truncation_distance(matrices: PencilFunction, limit: AsymptoticPencil, origin: float, where: str) -> float:
    """How far from origin the coefficients have come to their limit, to rounding.

    Raises InputError where they come to it slower than exponentially.
    """

    def settled(distance: float) -> bool:
        pencil = matrices((origin + limit.direction * distance * np.geomspace(1.0, 1.0 + TAIL, SAMPLES)).astype(np.complex128))
        for at, there in zip(_parts(pencil), (limit.C0, limit.C1, limit.D0, limit.D1), strict=True):
            if (np.abs(at - there) > NEGLIGIBLE * np.abs(there).max()).any():
                return False
        return True

    far = NEAREST
    while not settled(far):
        far *= 2.0
        if far > FARTHEST:
            raise InputError(
                f"at {where} the coefficients are not at their limit at |z| = {far / 2:.0e}: "
                "allowed are coefficients that come to it exponentially, or st.Infinity(start=...)"
            )
    if far == NEAREST:
        return far
    low, high = far / 2, far
    for _ in range(5):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if settled(middle) else (middle, high)
    return high


def tails(matrices: PencilFunction, limit: AsymptoticPencil, origin: float, distance: float) -> tuple[NDArray[np.float64], ...]:
    """∫|ΔC0|, ∫|ΔC1|, ∫|ΔD0|, ∫|ΔD1| (n, n) from there outwards."""
    s = distance * np.geomspace(1.0, 1.0 + TAIL, SAMPLES)
    pencil = matrices((origin + limit.direction * s).astype(np.complex128))
    there = limit.C0, limit.C1, limit.D0, limit.D1
    return tuple(np.trapezoid(np.abs(at - end), s, axis=0) for at, end in zip(_parts(pencil), there, strict=True))


def tail_error(limit: AsymptoticPencil, tail: tuple[NDArray[np.float64], ...], split: SpectralSplitting, sigma: complex) -> float:
    """The relative error of the frame, largest over its rows, that coefficients off their limit make."""
    if not any(part.any() for part in tail):
        return 0.0
    C0, C1, D0, D1 = tail
    size = abs(sigma)
    moved = np.abs(np.linalg.inv(limit.C0 + sigma * limit.C1)) @ (D0 + size * D1 + (C0 + size * C1) @ np.abs(split.A))
    return _relative(split, np.abs(np.concatenate((split.left, split.left2))) @ moved @ np.abs(split.X))


def frozen_error(
    matrices: PencilFunction, limit: AsymptoticPencil, origin: float, z: float, split: SpectralSplitting, k: int, sigma: complex
) -> float:
    """The relative error that the frozen space at z makes after half the way to the origin, damped by the gap."""
    step = 1e-3 * (z - origin)
    near = AsymptoticPencil(*matrices.at(z - step), limit.direction).matrix(sigma)[0]
    turning = np.abs(split.left2 @ (split.A - near) @ split.X) / abs(step)
    way = np.linspace(1.0, 0.5, WAY)
    gaps = [gap(AsymptoticPencil(*matrices.at(origin + (z - origin) * x), limit.direction).rates(sigma), k) for x in way]
    damped = math.exp(-float(np.trapezoid(gaps[::-1], abs(z - origin) * way[::-1])))
    return damped * _relative(split, np.concatenate((np.zeros((k, k)), turning / gaps[0])))


def _relative(split: SpectralSplitting, moved: NDArray[np.float64]) -> float:
    """|V| moved against the size of X, row by row; rows of X that are as good as zero count as 1e−8 of the largest."""
    rows = np.linalg.norm(split.X, axis=1)
    change = (np.abs(np.concatenate((split.X, split.X2), axis=1)) @ moved).max(axis=1)
    return float((change / np.maximum(rows, 1e-8 * rows.max())).max())


def _parts(pencil: Pencil) -> tuple[NDArray[np.complex128], ...]:
    return pencil.C0, pencil.C1, pencil.D0, pencil.D1
