"""Where an integration begins: at a wall, with a constant space, or at infinity, with the decaying one."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from shootstab.core.errors import ConvergenceError
from shootstab.problems.expansion import AsymptoticSeries
from shootstab.problems.kato_frame import KatoFrame
from shootstab.problems.pencil_function import PencilFunction
from shootstab.problems.protocol import ComplexArray, FarFrame
from shootstab.problems.splitting import gap
from shootstab.problems.truncation import frozen_error, tail_error

WORST_FRAME = 1e-6  # chosen: relative error of a frame beyond which no digit of a mode is promised and nothing is begun


class StartingSpace(Protocol):
    """The space that an integration begins with."""

    @property
    def columns(self) -> int:
        """The dimension of the space."""
        ...

    def frame(self, sigma: complex) -> FarFrame:
        """A basis, analytic in σ."""
        ...


@dataclass(frozen=True, eq=False)
class ConstantSpace:
    """The same space for every σ: basis (n, k)."""

    basis: ComplexArray

    @property
    def columns(self) -> int:
        return int(self.basis.shape[1])

    def frame(self, sigma: complex) -> FarFrame:
        return FarFrame(self.basis, np.zeros_like(self.basis), 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class AsymptoticRates:
    """How solutions behave at an end for one σ: rates μ (n,) by rising growth outwards, decaying of them counted, the gap behind these.

    margin is −Re μ of the slowest that is counted, and the growth of the slowest other, whichever is smaller: below 0, σ lies beyond the
    continuous spectrum.
    """

    where: str
    rates: ComplexArray
    decaying: int
    gap: float
    margin: float


@dataclass(frozen=True, eq=False)
class DecayingSpace:
    """The decaying space at an end at infinity, begun at z: of the limit there, or frozen.

    tail is bounds (…, n, n) on what C0, C1, D0, D1 differ from their limits by; None where the pencil is frozen, and where the space is
    that of an asymptotic series, the expansion.
    """

    kato_frame: KatoFrame
    pencil: PencilFunction
    origin: float
    z: float
    tail: tuple[NDArray[np.float64], ...] | None
    where: str
    expansion: AsymptoticSeries | None = None

    @property
    def columns(self) -> int:
        return self.kato_frame.k

    @property
    def has_limit(self) -> bool:
        """Whether the rates are those of a limit of the coefficients, so that its essential spectrum is that of the problem."""
        return self.tail is not None if self.expansion is None else self.expansion.bounded

    def frame(self, sigma: complex) -> FarFrame:
        """The frame, with the error that coefficients off their limit, or a frozen pencil, and rounding make.

        Raises Undecidable on the continuous spectrum, ConvergenceError where the space is not known well enough for this σ.
        """
        frame, tangent, log_scale, split = self.kato_frame.frame(sigma)
        limit = self.kato_frame.limit
        if self.expansion is not None:
            found = self.expansion.at(abs(self.z), sigma, split).frame(frame, tangent, log_scale, split)
            frame, tangent, log_scale, error = found.frame, found.tangent, found.log_scale, found.error
        elif self.tail is not None:
            error = tail_error(limit, self.tail, split, sigma)
        else:
            error = frozen_error(self.pencil, limit, self.origin, self.z, split, self.columns, sigma)
        error += split.rounding
        if error > WORST_FRAME:
            where = f"at {self.where}, begun at z = {self.z:g}"
            raise ConvergenceError(f"{where}, the decaying space is known to {error:.1e} only for sigma = {sigma:.6g}")
        return FarFrame(frame, tangent, log_scale, error)

    @property
    def inner(self) -> DecayingSpace | None:
        """Itself, where it is that of the limit of the coefficients (see problems.unknowns.InnerSpace): they stay there up to infinity."""
        return self if self.tail is not None and self.expansion is None else None

    @property
    def place(self) -> float:
        """The end."""
        return self.kato_frame.limit.direction * math.inf

    def nearer(self, z: NDArray[np.float64], sigma: complex) -> ComplexArray:
        """The solutions (m, n, k) of the limit at points z (m,) farther out, those of the frame where the integration begins."""
        F = self.kato_frame.frame(sigma)[0]
        growth = np.linalg.lstsq(F, self.kato_frame.limit.matrix(sigma)[0] @ F, rcond=None)[0]
        return np.array([F @ scipy.linalg.expm(growth * abs(at - self.z)) for at in z.tolist()])

    def at(self, sigma: complex) -> AsymptoticRates:
        """The rates of solutions at this end for one σ."""
        k, rates = self.columns, self.kato_frame.limit.rates(sigma)
        margins = [*(-rates[k - 1 : k].real if k > 0 else ()), *rates[k : k + 1].real]
        return AsymptoticRates(self.where, rates, k, gap(rates, k), float(min(margins)))
