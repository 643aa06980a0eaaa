"""D(σ) by the Riccati equation: the decaying space in a chart of the Grassmannian, carried to the wall."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from shootstab.core import polynomial
from shootstab.core.discriminant import Value
from shootstab.core.scaled import Scaled
from shootstab.discriminants.adaptive import adaptive
from shootstab.discriminants.method import DEFAULT_RTOL, Propagation, require_tolerance
from shootstab.discriminants.sampled_system import SampledSystem
from shootstab.kernels.elimination import wall_determinant
from shootstab.kernels.riccati_transport import enter_chart, leave_chart, transport_chart
from shootstab.problems.protocol import ComplexArray, FarFrame

LARGE_CHART = 100.0  # charts chosen at another σ are kept as long as no |S_ij| at a node is beyond this


@dataclass(frozen=True)
class Riccati:
    """The Riccati equation with changes of chart, with local errors below rtol relative to each row of the frame [I; S].

    The fewest unknowns of the three methods, k(n−k), and no direction to lose; the price is poles, near which the steps are short.
    """

    rtol: float = DEFAULT_RTOL
    name: str = "riccati"

    on = adaptive

    def __post_init__(self) -> None:
        require_tolerance(self)

    def fixed_at(self, sampled: SampledSystem, far: FarFrame, sigma: complex) -> Charted:
        """The method in the charts that suit this σ."""
        order = _pivots_first(far.frame)
        no_rows = np.zeros((far.frame.shape[1], len(order)), dtype=np.complex128)
        _, swaps = _propagate(sampled, (no_rows, no_rows), far, sigma, False, order, None)
        return Charted(self.rtol, Charts(order, sampled.nodes[swaps[:, 0]], swaps[:, 1:]))

    def propagate(
        self, sampled: SampledSystem, rows: tuple[ComplexArray, ...], far: FarFrame, sigma: complex, tangent: bool
    ) -> Propagation:
        """D = det(W_p + W_q S) det U, W = W(σ), in charts chosen for this σ."""
        return _propagate(sampled, rows, far, sigma, tangent, _pivots_first(far.frame), None)[0]


class Charts(NamedTuple):
    """order (n,) lists the rows of the state, the pivots first; at the points z (M,) pairs (M, 2) of other row and pivot change places."""

    order: NDArray[np.int64]
    z: ComplexArray
    pairs: NDArray[np.int64]

    def on(self, nodes: ComplexArray) -> NDArray[np.int64]:
        """The exchanges (M, 3) as (node, i, j) on a mesh that has the nodes of the one that they were chosen on, or nodes next to them."""
        nearest = np.abs(self.z[:, None] - nodes).argmin(axis=1) if len(self.z) else np.zeros(0, dtype=np.int64)
        return np.column_stack((nearest, self.pairs))


@dataclass(frozen=True)
class Charted:
    """Propagates as `Riccati` does, in charts that stay.

    In other charts the same mesh gives another D, by the error of integration. In the same charts all is a rational function of σ, so
    that D is analytic to rounding, and a mesh with every step halved errs less. The result is not sound where S grows large.
    """

    rtol: float
    charts: Charts

    def fixed_at(self, sampled: SampledSystem, far: FarFrame, sigma: complex) -> Charted:
        """Itself: the charts are chosen."""
        return self

    def propagate(
        self, sampled: SampledSystem, rows: tuple[ComplexArray, ...], far: FarFrame, sigma: complex, tangent: bool
    ) -> Propagation:
        """Propagate as `Riccati.propagate` does, in these charts."""
        return _propagate(sampled, rows, far, sigma, tangent, self.charts.order, self.charts.on(sampled.nodes))[0]


def _propagate(
    sampled: SampledSystem,
    rows: tuple[ComplexArray, ...],
    far: FarFrame,
    sigma: complex,
    tangent: bool,
    first: NDArray[np.int64],
    swaps: NDArray[np.int64] | None,
) -> tuple[Propagation, NDArray[np.int64]]:
    """D and local errors in the charts given or, with None, in those chosen for this σ; the exchanges (M, 3) made."""
    order, units = first.copy(), _units(far.frame)
    S, dS, start, start_slope = enter_chart(far.frame, far.tangent, units, order)
    errors = np.full(len(sampled.nodes) - 1, np.nan)
    given = np.empty((0, 3), dtype=np.int64) if swaps is None else swaps
    system, at, S, dS = sampled.numbers(sigma, S, dS)
    log_det, dlog_det, largest, made = transport_chart(system, at, units, order, S, dS, tangent, errors, given, swaps is None)
    W, dW = polynomial.value(rows, sigma), polynomial.slope(rows, sigma)
    det, slope = wall_determinant(*(a.astype(np.complex128, copy=False) for a in (W, dW, *leave_chart(S, dS, units, order))))
    # a mesh too coarse for S gives no numbers: the errors tell
    with np.errstate(invalid="ignore", over="ignore"):
        factor = start * np.exp(1j * log_det.imag)
        D, dD = det * factor, (slope + det * (dlog_det + start_slope / start)) * factor
    value = Value(sigma, Scaled(complex(D), log_det.real + far.log_scale), complex(dD))
    return Propagation(value, errors, largest <= LARGE_CHART and math.isfinite(value.D.log_scale)), made


def _units(Y: ComplexArray) -> NDArray[np.float64]:
    """Units (n,) for the state, between 1/2 and 1, that depend on the basis: in another one everything rounds otherwise."""
    mantissas = np.frexp(np.linalg.norm(Y, axis=1))[0]
    return np.where(mantissas > 0.0, mantissas, 1.0)


def _pivots_first(Y: ComplexArray) -> NDArray[np.int64]:
    """The rows of n×k Y, k of them first that make a well-conditioned square: QR of its transpose with column pivoting."""
    return np.asarray(scipy.linalg.qr(Y.T, mode="r", pivoting=True)[1], dtype=np.int64)
