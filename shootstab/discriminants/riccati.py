"""D(σ) by the Riccati equation: the decaying space in a chart of the Grassmannian, carried to the wall."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from shootstab.discriminants.frame import det_with_slope
from shootstab.discriminants.paths import Bend
from shootstab.discriminants.paths import Bend
from shootstab.discriminants.protocol import Value
from shootstab.discriminants.shooting import Shooting
from shootstab.discriminants.table import Table
from shootstab.kernels.riccati import transport_chart
from shootstab.problems.protocol import ComplexArray, FarFrame, Problem
from shootstab.vocabulary.scaled import Scaled

LARGE = 30.0  # charts chosen at another σ are kept as long as no |S_ij| at a node is beyond this


@dataclass(frozen=True)
class Riccati:
    """The Riccati equation, with changes of chart, with local errors below rtol relative to each row of the frame [I; S]."""

    rtol: float = 1e-11
    name: str = "riccati"

    def on(self, problem: Problem, bend: Bend | None = None) -> Shooting:
        """D(σ) of the problem, along the real axis or along a bend; the mesh is made at the first σ and grows where another needs it."""
        return Shooting(problem, Charted(self.rtol), bend)

    def carry(
        self, table: Table, rows: tuple[ComplexArray, ComplexArray], far: FarFrame, sigma: complex, tangent: bool
    ) -> tuple[Value, np.ndarray]:
        """D = det(W_p + W_q S) det U, W = W0 + σW1, in charts chosen for this σ."""
        return Charted(self.rtol).carry(table, rows, far, sigma, tangent)


class Charts(NamedTuple):
    """Where the chart changes along a mesh: order (n,) lists the rows of the state, the pivots first, before the first of the swaps (M, 3)."""

    order: NDArray[np.int64]
    swaps: NDArray[np.int64]


class Charted:
    """Carries as `Riccati` does and remembers the charts of every mesh.

    In other charts the same mesh gives another D, by the error of integration. In the same charts all is a rational function of σ,
    so that D is analytic to rounding; they are chosen anew where S grows large.
    """

    def __init__(self, rtol: float) -> None:
        self.rtol = rtol
        self._charts: WeakKeyDictionary[Table, Charts] = WeakKeyDictionary()

    def carry(
        self, table: Table, rows: tuple[ComplexArray, ComplexArray], far: FarFrame, sigma: complex, tangent: bool
    ) -> tuple[Value, np.ndarray]:
        """As `Riccati.carry`, in the charts in which this mesh was used before, if they serve."""
        known = self._charts.get(table)
        if known is not None:
            value, errors, largest, _ = _carry(table, rows, far, sigma, tangent, known, False)
            if largest <= LARGE:
                return value, errors
        fresh = Charts(_pivots_first(far.frame), np.empty((0, 3), dtype=np.int64))
        value, errors, _, self._charts[table] = _carry(table, rows, far, sigma, tangent, fresh, True)
        return value, errors


def _carry(
    table: Table, rows: tuple[ComplexArray, ComplexArray], far: FarFrame, sigma: complex, tangent: bool, charts: Charts, choose: bool
) -> tuple[Value, np.ndarray, float, Charts]:
    k = far.frame.shape[1]
    order = charts.order.copy()
    p, q = order[:k], order[k:]
    U, dU = far.frame[p], far.tangent[p]
    S = np.linalg.solve(U.T, far.frame[q].T).T.copy()
    dS = np.linalg.solve(U.T, (far.tangent[q] - S @ dU).T).T.copy()
    errors = np.full(len(table.nodes) - 1, np.nan)
    system = table.steps, table.X, table.V, table.G, table.T
    log_det, dlog_det, largest, swaps = transport_chart(*system, sigma, order, S, dS, tangent, errors, charts.swaps, choose)
    start, start_slope = det_with_slope(U, dU)
    p, q = order[:k], order[k:]
    W = rows[0] + sigma * rows[1]
    det, slope = det_with_slope(W[:, p] + W[:, q] @ S, rows[1][:, p] + rows[1][:, q] @ S + W[:, q] @ dS)
    factor = start * complex(math.cos(log_det.imag), math.sin(log_det.imag))
    D, dD = det * factor, (slope + det * (dlog_det + start_slope / start)) * factor
    return Value(sigma, Scaled(D, log_det.real + far.log_scale), dD), errors, largest, Charts(charts.order, swaps)


def _pivots_first(Y: ComplexArray) -> NDArray[np.int64]:
    """The rows of n×k Y, k of them first that make a well-conditioned square: QR of its transpose with column pivoting."""
    return np.asarray(scipy.linalg.qr(Y.T, mode="r", pivoting=True)[1], dtype=np.int64)
