"""The chute to any number of digits: exact parameters, the steady flow for the exact mass flux, its far field and its pencil."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import mpmath

from shootstab.core.errors import ConvergenceError
from shootstab.core.progress import StepDone
from shootstab.core.series import Series
from shootstab.models.chute import first_order_system as system
from shootstab.models.chute.background import Background, background, fields
from shootstab.models.chute.multiprecision_far import SPANWISE, leading, turned, wavenumber
from shootstab.models.chute.multiprecision_flow import FLOW_NEWTONS, PLACED, Descent, FlowAtBase, descend, evaluate, far_series, start_of
from shootstab.models.chute.parameters import Chute
from shootstab.models.chute.perturbations import PERTURBED, Perturbations
from shootstab.models.chute.wall import wall_rows
from shootstab.multiprecision import small_matrices as matrices
from shootstab.multiprecision.arithmetic import TAIL_TERMS, Arithmetic, Matrix, exact, simplified
from shootstab.multiprecision.integration import BaseFlowNumbers, Expansion, UnknownRows
from shootstab.multiprecision.linear_step import at_sigma
from shootstab.multiprecision.regular_singular_end import decaying_series
from shootstab.multiprecision.secant import Secant, Values
from shootstab.multiprecision.settings import LIMIT_SLACK, Settings, step_limit
from shootstab.multiprecision.taylor import Taylor, real_series

RESPONSE_DIGITS = 0.72  # chosen: the response of a flow to T_∞ is found first with this part of its digits
FLOW_WANDER = 1e-6  # chosen: relative change of T_∞ beyond which the double-precision flow was another one
FLATTEST = 1e-5  # chosen: |d ln Q0/d ln T_∞| below which a flow lies at a fold of the family: doubles cannot tell there which one is meant
GUESSED_DIGITS, GUESSED_TERM = 14, 18  # chosen: a guess that is too near is moved out, and one too far costs a few steps


class ChuteDigits:
    """A chute problem; what is known of T_∞ improves from one precision to the next."""

    size = system.SIZE

    def __init__(self, problem: Perturbations) -> None:
        self.problem = problem
        self._secant: Secant | None = None

    @property
    def real(self) -> bool:
        """k_x = 0: with v → iv everything is real."""
        return self.problem.kx == 0.0

    def chute(self, arithmetic: Arithmetic) -> Chute:
        """The parameters as exact decimals."""
        return self.problem.flow.chute.with_numbers(lambda x: arithmetic.number(exact(x)))

    def integration(self, arithmetic: Arithmetic, settings: Settings, base: BaseFlowNumbers) -> ChuteIntegration:
        """See protocol.MultiprecisionProblem."""
        return ChuteIntegration(self, arithmetic, settings, base)

    def base(self, arithmetic: Arithmetic, settings: Settings, progress: StepDone) -> BaseFlowNumbers:
        """(T_∞, u_∞): for a given mass flux by secants on Q0(T_∞), from a rougher precision on; u_∞ comes along."""
        flow = self.problem.flow

        def end(at: Settings, T: Any) -> FlowAtBase:
            return descend(arithmetic, self.chute(arithmetic), arithmetic.number(T), at, flow, progress)

        def found(at: Settings, T: Any) -> Values:
            base = end(at, T)
            return self.misfit(arithmetic, base.mass_flux), arithmetic.to_mpmath(base.far_velocity)

        if flow.asked_flux is None:
            T = arithmetic.to_mpmath(arithmetic.number(exact(flow.far_temperature)))
            return T, arithmetic.to_mpmath(end(settings, T).far_velocity)
        secant = self._secant or Secant(mpmath.mpf(flow.far_temperature))
        try:
            for at in (settings,) if self._secant else (Settings.of(RESPONSE_DIGITS * settings.tolerance + 1.0), settings):
                with arithmetic.working(at.digits), mpmath.workdps(at.digits):
                    secant.settle(partial(found, at), at.tolerance)
        except ConvergenceError:
            raise self._undetermined(secant) from None
        if not abs(secant.slope * secant.x) > FLATTEST or not abs(secant.x / flow.far_temperature - 1) < FLOW_WANDER:
            raise self._undetermined(secant)
        self._secant = secant
        return secant.x, *secant.others

    def misfit(self, arithmetic: Arithmetic, mass_flux: Any) -> Any:
        """Q0 relative to what was asked for, minus one."""
        assert self.problem.flow.asked_flux is not None
        asked = arithmetic.number(exact(self.problem.flow.asked_flux))
        return arithmetic.to_mpmath(arithmetic.rounded((mass_flux - asked) / asked))

    def corrected_base(self, arithmetic: Arithmetic, end: FlowAtBase, base: BaseFlowNumbers) -> BaseFlowNumbers:
        """(T_∞, u_∞) after one secant step from the flow with which this integration ended."""
        T, _ = base
        u = arithmetic.to_mpmath(end.far_velocity)
        if self._secant is None:
            return T, u
        rate, drift = self._secant.slopes
        step = self.misfit(arithmetic, end.mass_flux) / rate
        return T - step, u - drift * step

    def _undetermined(self, secant: Secant) -> ConvergenceError:
        rate = float(secant.slope * secant.x)
        return ConvergenceError(
            "the mass flux does not determine the base flow to this many digits: the flow lies at a fold of the family, "
            f"where the mass flux hardly changes with far_temperature (d ln Q0/d ln T = {rate:.1e})"
        )


class ChuteIntegration:
    """One way down a chute flow of known T_∞ and u_∞. See protocol.Integration."""

    def __init__(self, problem_in_digits: ChuteDigits, arithmetic: Arithmetic, settings: Settings, base: BaseFlowNumbers) -> None:
        self.arithmetic, self.chute, self.settings = arithmetic, problem_in_digits.chute(arithmetic), settings
        self._problem_in_digits, self._base, self._problem = problem_in_digits, base, problem_in_digits.problem
        self._kx, self._ky = (arithmetic.complex(exact(k)) for k in (self._problem.kx, self._problem.ky))
        self._rotated = problem_in_digits.real
        self._far_temperature, self._far_velocity = map(arithmetic.number, base)
        self._series = far_series(arithmetic, self.chute, self._far_temperature, settings.far_terms, settings.far_tolerance)
        self._frames: dict[str, list[Matrix]] = {}
        self._place: list[list[Any]] | None = None

    def begin(self, sigma: Any) -> None:
        """The start is guessed from the radius of convergence that doubles see, and moved out until the series holds."""
        flow = self._problem.flow
        log_start = min(start_of(self.arithmetic, self._series, self.settings), self._guess(sigma), math.log2(flow.rising) - 1)
        while True:
            self._start = self.arithmetic.number(2.0**log_start)
            self._far_pencil = self._scaled_pencil(self._series, self._start, self.settings.far_terms, in_nu=True)
            self._frames = {}
            limit = self._limit(self._decaying(sigma))
            if limit >= 0.0:
                break
            log_start += limit - LIMIT_SLACK
        state = [evaluate(self.arithmetic, c, self._start) for c in self._series]
        self._descent = Descent(self.arithmetic, self.chute, self.settings, state, flow.height(2.0**log_start))

    def _guess(self, sigma: Any) -> float:
        """log2 of a start: where term m of a series is 10^−d, its radius is 10^(d/m) times as far; the d and m of doubles are GUESSED_…."""
        z = self._problem.start(complex(self.arithmetic.to_mpmath(sigma)), 10.0**-GUESSED_DIGITS)
        gain = GUESSED_DIGITS / GUESSED_TERM - self.settings.far_tolerance / self.settings.far_terms
        return float(self._problem.flow.states_at(z)[0].real) / math.log(2) + gain * math.log2(10) - self.settings.far_shift

    def _limit(self, terms: list[Matrix]) -> float:
        """log2 of the fraction of the start at which the terms left out are small, row by row."""
        limits = []
        for i in range(system.SIZE):
            first, last = ([max(map(self.arithmetic.log2, P[i])) for P in part] for part in (terms[:2], terms[-TAIL_TERMS:]))
            scale = max(first)
            if scale > -math.inf:
                limits.append(step_limit(last, len(terms), scale, self.settings.far_tolerance))
        return min(limits)

    def far_frame(self, sigma: Any) -> tuple[Matrix, Any]:
        terms = self._decaying(sigma)
        cells = range(system.DECAYING)
        frame = [
            [self.arithmetic.rounded(sum((P[i][q] for P in reversed(terms)), self.arithmetic.number(0))) for q in cells]
            for i in range(system.SIZE)
        ]
        return frame, self._start ** (4 * self._wavenumber * self._far_temperature)

    def expand(self, longest: float) -> Expansion:
        if self._place is None:
            self._place, self._reach = self._descent.expand()
        h = min(self._reach, longest)
        at_wall = h >= self._descent.remaining
        self._step = self._descent.to_base(self._place) if at_wall else self.arithmetic.number(-h)
        C0, C1, D0, D1, _ = self._scaled_pencil(self._place, self._step, self.settings.order)
        return Expansion(self._step, (C0, C1), (D0, D1), at_wall)

    def advance(self, part: float) -> None:
        assert self._place is not None
        self._descent.advance(self._place, self._step * self.arithmetic.number(part))
        self._place = None

    def wall_rows(self) -> tuple[Matrix, Matrix]:
        nu, T, u, Q, _ = (self.arithmetic.complex(x) for x in self._descent.state)
        bg = background(self.chute, nu, T, u + self._far_velocity, Q, self.arithmetic.pi)
        rows = wall_rows(self.chute, bg, self._kx, self._ky, self.arithmetic.pi)
        W0, W1 = ([[self._turned(row[j], 2 if i == 2 else 0, j) for j in range(system.SIZE)] for i, row in enumerate(W)] for W in rows)
        return W0, W1

    def unknowns(self, sigma: Any) -> UnknownRows:
        """ν̂ = ν0 (ν̂/ν0), and the next four components; v̂ is turned back."""
        assert self._place is not None
        powers = [self.arithmetic.number(1)]
        for _ in range(self.settings.order - 1):
            powers.append(self.arithmetic.rounded(powers[-1] * self._step))
        nu = real_series(self.arithmetic, [c * p for c, p in zip(self._place[0], powers, strict=True)])
        turned = 1j if self._rotated else 1
        return {name: {j: nu if j == 0 else turned if j == SPANWISE[0] else 1} for j, name in enumerate(PERTURBED)}

    farthest = math.inf

    def farther(self, sigma: Any, c: Matrix, place: Any, distance: Any) -> dict[str, Any]:
        """ψ = P(τ) τ^Λ c with τ = ν0 over that at the start, and z from there, ∫ dτ/(τ ν0′/ν0) = ln τ/λ_0 + Σ l_m (τ^m − 1)/m."""
        arithmetic = self.arithmetic
        log_tau = self._log_tau(distance)
        tau = _exponential(arithmetic, log_tau)
        powers = [arithmetic.number(1)]
        for _ in range(self.settings.far_terms - 1):
            powers.append(arithmetic.rounded(powers[-1] * tau))
        turned = matrices.combined(c, matrices.product(arithmetic, self._exponents, c), log_tau)
        decayed = _exponential(arithmetic, self._wavenumber * self._far_temperature * log_tau)
        frames = [matrices.product(arithmetic, P, turned) for P in self._decaying(sigma)]
        psi = [
            arithmetic.rounded(sum((p * frame[i][0] for p, frame in zip(powers, frames, strict=True)), arithmetic.number(0)) * decayed)
            for i in range(len(PERTURBED))
        ]
        psi[0] = psi[0] * self._start * tau
        if self._rotated:
            psi[SPANWISE[0]] = 1j * arithmetic.complex(psi[SPANWISE[0]])
        return dict(zip(PERTURBED, psi, strict=True))

    def _log_tau(self, distance: Any) -> Any:
        """ln τ at so great a distance above the start, by Newton."""
        arithmetic, terms = self.arithmetic, self.settings.far_terms
        lengths = (1 / self._far_pencil[4]).coefficients(terms)  # dz/d(ln τ)
        x = arithmetic.rounded(distance / lengths[0])
        for _ in range(FLOW_NEWTONS):
            tau = _exponential(arithmetic, x)
            power, height, slope = arithmetic.number(1), lengths[0] * x, lengths[0]
            for m in range(1, terms):
                power = arithmetic.rounded(power * tau)
                height, slope = height + lengths[m] * (power - 1) / m, slope + lengths[m] * power
            step = arithmetic.rounded((height - distance) / slope)
            x = arithmetic.rounded(x - step)
            if arithmetic.log2(step) < -PLACED * math.log2(10) * self.settings.digits:
                return x
        raise ConvergenceError(f"no volume fraction is found at a distance of {float(arithmetic.to_mpmath(distance)):.3g} above the start")

    @property
    def wall(self) -> Any:
        return self.arithmetic.number(0)

    def corrected_base(self) -> BaseFlowNumbers:
        return self._problem_in_digits.corrected_base(self.arithmetic, self._descent.at_base(), self._base)

    @property
    def _wavenumber(self) -> Any:
        return wavenumber(self.arithmetic, self._kx, self._ky)

    def _scaled_pencil(self, series: list[list[Any]], unit: Any, terms: int, in_nu: bool = False) -> tuple[Any, ...]:
        """C0, C1, D0, D1 and ν0′/ν0 as series in z/unit, or in ν0/unit."""
        powers = [self.arithmetic.number(1)]
        for _ in range(terms - 1):
            powers.append(self.arithmetic.rounded(powers[-1] * unit))
        nu, T, u, Q = (real_series(self.arithmetic, [c * p for c, p in zip(y, powers, strict=True)]) for y in series[:4])
        plain = fields(self.chute, nu, T, u + self._far_velocity, Q, self.arithmetic.pi)
        # d/dz with z = unit t, or with ν0 = unit t: (ν0′/ν0) t d/dt
        rate = plain.decay if in_nu else 1 / unit
        bg = Background(**{name: Series((F, rate * F.derivative(int(in_nu)))) for name, F in vars(plain).items()})
        parts = system.pencil_entries(bg, self.chute.tan_theta, self._kx, self._ky)
        return *({at: self._turned(e, *at) for at, e in part.items()} for part in parts), bg.decay[0]

    def _turned(self, entry: Any, i: int, j: int) -> Any:
        """An entry after v → iv, if k_x = 0."""
        if self._rotated:
            entry = turned(entry if isinstance(entry, Taylor) else self.arithmetic.complex(entry), i, j)
        return entry if isinstance(entry, Taylor) else simplified(self.arithmetic, entry)

    def _decaying(self, sigma: Any) -> list[Matrix]:
        """P_m ν^m at the start."""
        key = str(sigma)
        if key not in self._frames:
            C0, C1, D0, D1, decay = self._far_pencil
            C0, C1 = ({at: e * decay for at, e in part.items()} for part in (C0, C1))
            C, D = at_sigma((C0, C1), sigma), at_sigma((D0, D1), sigma)
            far = self._far_temperature, self._far_velocity
            P0, self._exponents = leading(self.arithmetic, self.chute, (self._kx, self._ky), far, sigma)
            rate = self._wavenumber * self._far_temperature
            self._frames = {key: decaying_series(self.arithmetic, C, D, P0, rate, self._exponents, self.settings.far_terms)}
        return self._frames[key]


def _exponential(arithmetic: Arithmetic, x: Any) -> Any:
    """e^x of a real number."""
    return arithmetic.number(mpmath.exp(arithmetic.to_mpmath(x)))
