"""D(σ) by the Riccati equation: the decaying space in a chart of the Grassmannian, carried to the wall."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from shootstab.core.discriminant import Value
from shootstab.core.scaled import Scaled
from shootstab.discriminants.deformed_path import DeformedPath
from shootstab.discriminants.product import Product, shoot
from shootstab.discriminants.sampled_system import SampledSystem
from shootstab.discriminants.shooting import Shooting
from shootstab.kernels.elimination import wall_determinant
from shootstab.kernels.riccati_transport import enter_chart, leave_chart, transport_chart
from shootstab.problems.protocol import ComplexArray, FarFrame, Problem

LARGE = 100.0  # charts chosen at another σ are kept as long as no |S_ij| at a node is beyond this


@dataclass(frozen=True)
class Riccati:
    """The Riccati equation with changes of chart, with local errors below rtol relative to each row of the frame [I; S].

    The fewest unknowns of the three methods, k(n−k), and no direction to lose; the price is poles, near which the steps are short.
    """

    rtol: float = 1e-11
    name: str = "riccati"

    def on(self, problem: Problem, path: DeformedPath | None = None) -> Shooting | Product:
        """D(σ) of the problem, along the real axis or along a path; the mesh is made at the first σ and grows where another needs it."""
        return shoot(problem, lambda: Charted(self.rtol), path)

    def propagate(
        self, sampled: SampledSystem, rows: tuple[ComplexArray, ComplexArray], far: FarFrame, sigma: complex, tangent: bool
    ) -> tuple[Value, np.ndarray]:
        """D = det(W_p + W_q S) det U, W = W0 + σW1, in charts chosen for this σ."""
        return Charted(self.rtol).propagate(sampled, rows, far, sigma, tangent)


class Charts(NamedTuple):
    """order (n,) lists the rows of the state, the pivots first; at the points z (M,) pairs (M, 2) of other row and pivot change places."""

    order: NDArray[np.int64]
    z: ComplexArray
    pairs: NDArray[np.int64]

    def on(self, nodes: ComplexArray) -> NDArray[np.int64] | None:
        """The exchanges (M, 3) as (node, i, j), or None if the changes are not at nodes."""
        where = np.nonzero(self.z[:, None] == nodes)[1]
        return np.column_stack((where, self.pairs)) if len(where) == len(self.z) else None


class Charted:
    """Carries as `Riccati` does, and remembers the charts.

    In other charts the same mesh gives another D, by the error of integration. In the same charts all is a rational function of σ, so
    that D is analytic to rounding, and a mesh with every step halved errs less. So the charts stay as long as the nodes at which they
    change do and S does not grow large.
    """

    def __init__(self, rtol: float) -> None:
        self.rtol = rtol
        self._charts: Charts | None = None

    def propagate(
        self, sampled: SampledSystem, rows: tuple[ComplexArray, ComplexArray], far: FarFrame, sigma: complex, tangent: bool
    ) -> tuple[Value, np.ndarray]:
        """As `Riccati.propagate`, in the charts in which the space was carried before, if they serve."""
        if self._charts is not None:
            swaps = self._charts.on(sampled.nodes)
            if swaps is not None:
                value, errors, largest, _ = _propagate(sampled, rows, far, sigma, tangent, self._charts.order, swaps)
                if largest <= LARGE and cmath.isfinite(value.D.mantissa) and math.isfinite(value.D.log_scale):
                    return value, errors
        order = _pivots_first(far.frame)
        value, errors, _, swaps = _propagate(sampled, rows, far, sigma, tangent, order, None)
        self._charts = Charts(order, sampled.nodes[swaps[:, 0]], swaps[:, 1:])
        return value, errors


def _propagate(
    sampled: SampledSystem,
    rows: tuple[ComplexArray, ComplexArray],
    far: FarFrame,
    sigma: complex,
    tangent: bool,
    first: NDArray[np.int64],
    swaps: NDArray[np.int64] | None,
) -> tuple[Value, np.ndarray, float, NDArray[np.int64]]:
    """D and local errors in the charts given or, with None, in those chosen for this σ; the largest |S_ij|; the exchanges made."""
    order, units = first.copy(), _units(far.frame)
    S, dS, start, start_slope = enter_chart(far.frame, far.tangent, units, order)
    errors = np.full(len(sampled.nodes) - 1, np.nan)
    given = np.empty((0, 3), dtype=np.int64) if swaps is None else swaps
    system, at, S, dS = sampled.numbers(sigma, S, dS)
    log_det, dlog_det, largest, made = transport_chart(system, at, units, order, S, dS, tangent, errors, given, swaps is None)
    det, slope = wall_determinant(*rows, sigma, *leave_chart(S, dS, units, order))
    # a mesh too coarse for S gives no numbers: the errors tell
    with np.errstate(invalid="ignore", over="ignore"):
        factor = start * np.exp(1j * log_det.imag)
        D, dD = det * factor, (slope + det * (dlog_det + start_slope / start)) * factor
    return Value(sigma, Scaled(complex(D), log_det.real + far.log_scale), complex(dD)), errors, largest, made


def _units(Y: ComplexArray) -> NDArray[np.float64]:
    """Units (n,) for the state, between 1/2 and 1, that depend on the basis: in another one everything rounds otherwise."""
    mantissas = np.frexp(np.linalg.norm(Y, axis=1))[0]
    return np.where(mantissas > 0.0, mantissas, 1.0)


def _pivots_first(Y: ComplexArray) -> NDArray[np.int64]:
    """The rows of n×k Y, k of them first that make a well-conditioned square: QR of its transpose with column pivoting."""
    return np.asarray(scipy.linalg.qr(Y.T, mode="r", pivoting=True)[1], dtype=np.int64)
