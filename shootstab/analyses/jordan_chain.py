"""The chain of a defective mode with one solution: the coefficients of the Taylor series of a root function (see eigenspace.py).

φ(z; σ), the solution of the bordered problem with the value 1 of one unknown at one place, is analytic in σ, and

    φ_j(z) = 1/(K ρ^j) Σ_k φ(z; σ0 + ρ e^{iθ_k}) e^{−ijθ_k},    θ_k = 2πk/K,

but for the coefficients of the orders j + K, j + 2K, … times ρ^K, ρ^2K, …; errors of φ(z; σ) come in as ρ^−j.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shootstab.analyses.eigenfunction_double import Eigenfunction
from shootstab.analyses.error_budget import SAFETY
from shootstab.analyses.on_the_line import OnTheLine, in_unknowns, real_points
from shootstab.core.errors import ConvergenceError
from shootstab.discriminants.back_substitution import BoundaryMatrix
from shootstab.discriminants.shooting import Shooting
from shootstab.problems.protocol import ComplexArray
from shootstab.problems.unknowns import Unknowns, unknowns

ON_CIRCLE = 16  # chosen: solutions on the circle: the next coefficients come in by the power of so many of CIRCLE
CIRCLE = 0.1  # chosen: the radius of the circle in the distance over which D is a power: a digit is lost for each place in the chain
OTHER_CIRCLE = 0.5  # chosen: the circle with which the chain is compared, in this one
CHAIN_HEIGHTS = 41  # chosen: heights at which chains are compared
FIRST_LOOK = 10.0  # chosen: the first distance at which D is looked at, in the error of the mode
NEXT_LOOK = 2.0  # chosen: the next one, in the one before
MOST_LOOKS = 60  # chosen: distances that are tried: 2^60 is beyond any scale of a problem
NO_POWER = 0.1  # chosen: how far off the number of zeros h D′/D is where D ceases to be a power
SEEN_LATE = 1.0  # chosen: how far off it may be there, for the scale to be right to a digit


@dataclass(frozen=True, eq=False)
class ChainFunction:
    """φ_j by name at any z, as an `Eigenfunction` is asked: a sum of solutions next to the mode.

    weights (K,) are those of the solutions. |true − shown| ≤ error times the largest value of all unknowns.
    """

    lines: tuple[OnTheLine, ...]
    weights: ComplexArray
    unknowns: Unknowns
    error: float

    def __call__(self, z: ArrayLike) -> Mapping[str, ComplexArray]:
        """The unknowns by name, each of the shape of z. Raises InputError for a z outside the domain."""
        values = _coefficient(self.lines, self.weights, self.unknowns, real_points(z))
        return {name: values[:, i].reshape(np.shape(z)) for i, name in enumerate(self.unknowns.names)}


def chain_of(first: Eigenfunction, coarse: Shooting, fine: Shooting, length: int) -> tuple[ChainFunction, ...]:
    """φ_1 … φ_{length−1} behind φ_0 = first; coarse and fine are D of its subsystem on a mesh and on the halved one.

    Raises ConvergenceError where D does not show over which distance it is a power.
    """
    sigma, error = complex(first.mode.sigma), float(first.mode.error)
    radius = CIRCLE * _power_up_to(fine, sigma, error, length)
    families = [
        _family(first, shooting, sigma, centre, size)
        for shooting, centre, size in (
            (fine, sigma, radius),
            (coarse, sigma, radius),
            (fine, sigma, OTHER_CIRCLE * radius),
            (fine, sigma + error, radius),
        )
    ]
    named = unknowns(first.problem)
    z = np.linspace(*families[0][0].ends, CHAIN_HEIGHTS)
    z = z[(z >= max(lines[0].ends[0] for lines in families)) & (z <= min(lines[0].ends[1] for lines in families))]
    chain = []
    for j in range(1, length):
        values = [
            _coefficient(lines, _weights(j, size), named, z)
            for lines, size in zip(families, (radius, radius, OTHER_CIRCLE * radius, radius), strict=True)
        ]
        off = sum(float(np.abs(other - values[0]).max() / np.abs(values[0]).max()) for other in values[1:])
        chain.append(ChainFunction(families[0], _weights(j, radius), named, first.error + SAFETY * off))
    return tuple(chain)


def _power_up_to(discriminant: Shooting, sigma: complex, error: float, order: int) -> float:
    """The h at which h D′/D, at the distance h from so many zeros, is off their number by about 1, which h^(order) has at all distances."""
    distance = FIRST_LOOK * error
    for _ in range(MOST_LOOKS):
        off = abs(distance * discriminant.with_derivative(sigma + distance).logarithmic_derivative - order)
        if off > NO_POWER:
            break
        distance *= NEXT_LOOK
    if not 0.0 < off < SEEN_LATE or distance == FIRST_LOOK * error:
        raise ConvergenceError(f"D is like no power of the distance from {sigma:.12g}, where it has {order} zeros: its chain is not known")
    return distance / off


def _family(first: Eigenfunction, shooting: Shooting, sigma: complex, centre: complex, radius: float) -> tuple[OnTheLine, ...]:
    """φ(·; σ) at the points of a circle."""
    at_mode, lines = BoundaryMatrix.of(shooting, sigma), []
    unknown, z = first.peak
    named = unknowns(first.problem)
    which = named.names.index(unknown)
    for turn in _turns():
        line = OnTheLine(first.problem, BoundaryMatrix.of(shooting, centre + radius * turn).near_kernel(at_mode))
        points = np.array([z])
        value = complex(in_unknowns(named, line.solution.sigma, points, line.right(points))[0, which])
        lines.append(OnTheLine(first.problem, line.solution.scaled(1.0 / value, 1.0)))
    return tuple(lines)


def _turns() -> ComplexArray:
    return np.asarray(np.exp(2j * np.pi * np.arange(ON_CIRCLE) / ON_CIRCLE))


def _weights(j: int, radius: float) -> ComplexArray:
    return np.asarray(_turns() ** -j / (ON_CIRCLE * radius**j))


def _coefficient(lines: Sequence[OnTheLine], weights: ComplexArray, named: Unknowns, z: NDArray[np.float64]) -> ComplexArray:
    """The unknowns (m, q) of a coefficient at z (m,)."""
    values = np.array([in_unknowns(named, line.solution.sigma, z, line.right(z)) for line in lines])
    return np.asarray(np.tensordot(weights, values, 1))
