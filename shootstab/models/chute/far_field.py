"""The decaying space of the perturbations at infinity, as a convergent series in ν0 (guide/theory.md 2, Far field).

In x = ν0 the system is C̃(x) x dψ/dx = D(x) ψ with C̃ = (ν0′/ν0) C, and infinity is a regular singular point. The decaying
space is the range of P(x) x^Λ, P = Σ P_m x^m, where Λ = T_∞ diag(B, K), B = K I − s sᵀ/(7K), s = (i k_x, i k_y, −K), and

    (m C̃_0 − D_0) P_m + C̃_0 P_m Λ = Σ_{j≥1} [D_j P_{m−j} − C̃_j ((m−j) P_{m−j} + P_{m−j} Λ)].

Λ = K T_∞ I + N with N² = 0 (because s·s = 0), and no eigenvalue of m + Λ is one of the system's: no logarithms, although Λ is
defective. The leading order P_0 x^Λ is (2.20)–(2.22); this form is regular as k_x → 0 or k_y → 0, where (2.16) is not.
"""

from __future__ import annotations

import math
from collections import OrderedDict
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from shootstab.core.series import Series, constant
from shootstab.core.straight_line import Program, Recorder, program
from shootstab.kernels.frobenius import Recurrence, recurrence, row_sizes, series_terms, series_value
from shootstab.kernels.recorded_programs import series
from shootstab.models.chute.balance import slopes
from shootstab.models.chute.first_order_system import DECAYING, SIZE
from shootstab.models.chute.parameters import Chute
from shootstab.models.chute.tabulated import FIELD_COUNT, as_background, expanded, pencil_formula
from shootstab.problems.protocol import ComplexArray

Terms = NDArray[np.inexact]
KEPT_SERIES = 16  # chosen: the series of so many σ: a mode is asked for on several meshes, which begin at different heights
FAR_TERMS = 12  # chosen: more cost more than the steps they save
LARGEST_START = 1e-2  # chosen: ν0 at which an integration begins at most
# Multiplying v̂ and all that goes with it by i makes a series that is real where k_x and σ's imaginary part are zero
TURNED_STATES, TURNED_EQUATIONS, TURNED_SOLUTIONS = [2, 6], [2, 6], [1]  # exact: what of states, equations and solutions goes with v̂


def flow_series(chute: Chute, far_temperature: Any, far_velocity: Any, terms: int, pi: Any) -> tuple[Series, Series, Series, Series]:
    """(ν, T, u, Q) of the steady flow as series in ν0, by fixed-point iteration that gains one order a turn.

    x dT/dx = T′/(ν0′/ν0) and so on; for Q the term −Q on the right is moved to the left.
    """
    nothing = 0 * far_temperature
    nu = Series((nothing, 1 + nothing, *(nothing,) * (terms - 2)))
    T, u, Q = constant(far_temperature, terms), constant(far_velocity, terms), constant(nothing, terms)
    for _ in range(1, terms):
        decay, T_z, u_z, Q_z = slopes(nu, T, Q, chute.ep, chute.tan_theta, chute.radial_law, pi)
        T_x, u_x, Q_x = T_z / decay, u_z / decay, Q_z / decay + Q
        T = Series((far_temperature, *(T_x[m] / m for m in range(1, terms))))
        u = Series((far_velocity, *(u_x[m] / m for m in range(1, terms))))
        Q = Series((nothing, *(Q_x[m] / (m + 1) for m in range(1, terms))))
    return nu, T, u, Q


@lru_cache(maxsize=16)
def _far_fields(chute: Chute, far_temperature: float, far_velocity: float) -> ComplexArray:
    """The fields (44, FAR_TERMS) of the steady flow far up, as series in ν0: the same for all waves on it."""
    states = flow_series(chute, far_temperature, far_velocity, FAR_TERMS, math.pi)
    return expanded(chute, np.array([part.coefficients for part in states]))


@lru_cache
def _recorded(shape: tuple[bool, bool]) -> tuple[Program, tuple[tuple[int, int, int], ...]]:
    """C0 ν0′/ν0, C1 ν0′/ν0, D0 and D1 as a program of the fields and (tanθ, k_x, k_y), and (matrix, row, column) of each result."""
    recorder = Recorder()
    fields = recorder.inputs(FIELD_COUNT)
    matrices = pencil_formula(fields, recorder.parameters(3), shape)
    decay = as_background(fields).decay[0]
    results = {(k, i, j): v * decay if k < 2 else v for k, entries in enumerate(matrices) for (i, j), v in entries.items()}
    return program(recorder, list(results.values())), tuple(results)


class FarField:
    """The series of one flow and one wave; P_m for a σ on demand."""

    def __init__(self, chute: Chute, far_temperature: float, far_velocity: float, kx: float, ky: float) -> None:
        fields = _far_fields(chute, far_temperature, far_velocity)
        formula, places = _recorded((kx == 0.0, ky == 0.0))
        matrices = np.zeros((4, FAR_TERMS, SIZE, SIZE), dtype=np.complex128)
        for place, values in zip(places, series(formula, fields, np.array([chute.tan_theta, kx, ky])), strict=True):
            matrices[place[0], :, place[1], place[2]] = values
        self.exponents = far_temperature * decay_matrix(kx, ky)
        self.trace = float(np.trace(self.exponents).real)
        self._conductivity = float(as_background(fields[:, 0].real).K[0])
        self._far_temperature, self._far_velocity = far_temperature, far_velocity
        self._kx, self._ky = kx, ky
        # Λ = rate·I + left rightᵀ
        left = np.array([1j * kx, 1j * ky, -math.hypot(kx, ky), 0.0])
        constant, pole = self._first()
        # a basis of which only the third column has the pole at Ω = 0: else the columns are parallel where Ω is small
        basis = np.eye(DECAYING, dtype=np.complex128)
        basis[2, :2] = -pole[0, :2] / pole[0, 2]
        at_zero = np.zeros_like(pole)
        at_zero[0, 2] = pole[0, 2]
        states, equations, solutions = _turns(SIZE, TURNED_STATES), _turns(SIZE, TURNED_EQUATIONS), _turns(DECAYING, TURNED_SOLUTIONS)
        of_system = equations.conj()[:, None] * states
        of_frame = states.conj()[:, None] * solutions
        of_flow = _FarSeries(
            recurrence(of_system * matrices[:2], of_system * matrices[2:]),
            self.exponents[3, 3].real,
            solutions.conj() * (2 * left - basis @ left),  # the inverse of basis, applied
            -far_temperature / (7 * math.hypot(kx, ky)) * (left @ basis) * solutions,
            constant @ basis * of_frame,
            at_zero * of_frame,
        )
        self._series, self._real, self._back = of_flow, of_flow.in_real_numbers(), of_frame.conj()
        self._known: OrderedDict[complex, tuple[Terms, Terms]] = OrderedDict()

    def _first(self) -> tuple[ComplexArray, ComplexArray]:
        """P_0 = constant + pole/Ω, Ω = σ + i k_x u_∞, each (8, 4): columns û, v̂, ŵ, T̂ at infinity."""
        B = self.exponents / self._far_temperature
        P, pole = np.zeros((SIZE, DECAYING), dtype=np.complex128), np.zeros((SIZE, DECAYING), dtype=np.complex128)
        P[1:5, :] = np.eye(4)
        P[5, :3], P[6, :3] = -B[0, :3], -B[1, :3]
        P[7, 3] = self._conductivity * B[3, 3]
        # conservation of mass gives ν̂/ν0
        pole[0, :3] = B[2, :3] - np.array([1j * self._kx, 1j * self._ky, -1 / self._far_temperature])
        return P, pole

    def terms(self, sigma: complex, tangent: bool = True) -> tuple[Terms, Terms]:
        """P_m and, if tangent, dP_m/dσ, each (FAR_TERMS, 8, 4); with the phases of v̂, and real where they can be."""
        sigma = complex(sigma)
        known = self._known.get(sigma)
        if known is None:
            if self._real is not None and sigma.imag == 0.0:
                known = self._real.terms(sigma.real, sigma.real, tangent)
            else:
                known = self._series.terms(sigma, sigma + 1j * self._kx * self._far_velocity, tangent)
            if tangent:
                self._known[sigma] = known
                if len(self._known) > KEPT_SERIES:
                    self._known.popitem(last=False)
        return known

    def largest_start(self, sigma: complex, tolerance: float) -> float:
        """The largest ν0 at which the terms left out stay below the tolerance, row by row."""
        sizes = _row_sizes(self.terms(sigma, False)[0])
        m = np.arange(FAR_TERMS - 4, FAR_TERMS)
        with np.errstate(divide="ignore"):
            bounds = np.where(sizes[m] > 0.0, (tolerance / sizes[m]) ** (1.0 / m), np.inf)
        return float(min(bounds.min(), LARGEST_START))

    def at(self, nu: float, sigma: complex) -> tuple[ComplexArray, ComplexArray, float]:
        """Σ P_m ν0^m and its σ-derivative, each (8, 4), and a bound on its relative error from the last terms."""
        P, dP = (terms.astype(np.complex128, copy=False) for terms in self.terms(sigma))
        sizes = _row_sizes(P)
        tail = max(sizes[m] * nu**m for m in range(FAR_TERMS - 4, FAR_TERMS))
        with np.errstate(invalid="ignore"):  # Ω = 0 as in terms below: what is not finite ends as a mesh on which no step is short enough
            return series_value(P, nu) * self._back, series_value(dP, nu) * self._back, float(tail)


class _FarSeries(NamedTuple):
    """What the series is made of, all real or all complex; P_0 = constant + pole/Ω."""

    system: Recurrence
    rate: float
    left: NDArray[np.inexact]
    right: NDArray[np.inexact]
    constant: NDArray[np.inexact]
    pole: NDArray[np.inexact]

    def terms(self, sigma: complex, omega: complex, tangent: bool) -> tuple[Terms, Terms]:
        """P_m and, if tangent, dP_m/dσ."""
        P = np.zeros((FAR_TERMS, SIZE, DECAYING), dtype=self.constant.dtype)
        dP = np.zeros_like(P)
        with np.errstate(divide="ignore", invalid="ignore"):  # Ω = 0, the end of the continuous spectrum: no term is finite, no step holds
            first = self.pole / omega
            P[0], dP[0] = self.constant + first, first / -omega
        series_terms(self.system, sigma, self.rate, self.left, self.right, P, dP, tangent)
        return P, dP

    def in_real_numbers(self) -> _FarSeries | None:
        """The series' constants in float64; None if they are not real."""
        numbers, vectors = (self.system.values, self.system.slopes), self[2:]
        if any(a.imag.any() for a in (*numbers, *vectors)):
            return None
        values, slopes = (a.real.copy() for a in numbers)
        return _FarSeries(self.system._replace(values=values, slopes=slopes), self.rate, *(a.real.copy() for a in vectors))


def _turns(count: int, turned: list[int]) -> ComplexArray:
    """The phases (count,): i for what is turned, 1 for the rest."""
    phases = np.ones(count, dtype=np.complex128)
    phases[turned] = 1j
    return phases


def decay_matrix(kx: float, ky: float) -> ComplexArray:
    """diag(B, K) (4, 4): û, v̂, ŵ decay as e^{−Bz} and T̂ as e^{−Kz}, (2.20)–(2.22) in the form of guide/theory.md 1.3."""
    K = math.hypot(kx, ky)
    s = np.array([1j * kx, 1j * ky, -K, 0.0])
    return np.asarray(K * np.eye(4) - np.outer(s, s) / (7 * K), dtype=np.complex128)


def _row_sizes(P: Terms) -> NDArray[np.float64]:
    """The size of each term (m,): the largest entry of each row against that row's largest entry in the first."""
    sizes = np.empty(len(P))
    row_sizes(P.astype(np.complex128, copy=False), sizes)
    return sizes
