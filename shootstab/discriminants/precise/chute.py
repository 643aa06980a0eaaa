"""The chute to any number of digits: exact parameters, the steady flow for the exact mass flux, its far field and its pencil."""

from __future__ import annotations

import math
from typing import Any

from shootstab.discriminants.precise import matrices
from shootstab.discriminants.precise.arithmetic import Arithmetic, Matrix, exact, simplified
from shootstab.discriminants.precise.protocol import Expansion, Tick
from shootstab.discriminants.precise.reduction import affine, explicit
from shootstab.discriminants.precise.regular_singular import decaying_series
from shootstab.discriminants.precise.settings import Settings, step_limit
from shootstab.discriminants.precise.steady import Descent, descend, evaluate, far_series, start_of
from shootstab.discriminants.precise.taylor import Taylor, real_series
from shootstab.problems.chute import constitutive as law
from shootstab.problems.chute import system
from shootstab.problems.chute.background import Background, background, fields
from shootstab.problems.chute.parameters import Chute
from shootstab.problems.chute.problem import ChuteProblem
from shootstab.problems.chute.wall import wall_rows
from shootstab.vocabulary.errors import ConvergenceError
from shootstab.vocabulary.series import Series

SPANWISE = (2, 6)  # v̂ and v̂′, which k_x = 0 makes imaginary
NEWTONS = 8
PROBE = 20  # binary digits of the relative change of T_∞ from which its influence is found
WANDER = 1e-6  # relative change of T_∞ beyond which the double-precision flow was another one


class PreciseChute:
    """A chute problem; T_∞ of a given mass flux improves from one course to the next."""

    size = system.SIZE
    has_base_flow = True

    def __init__(self, problem: ChuteProblem) -> None:
        self.problem = problem
        self._rate: Any = None  # d ln Q0/d ln T_∞
        self._temperature: Any = None  # the best T_∞ so far
        self._solved: dict[Any, tuple[Any, ...]] = {}

    @property
    def real(self) -> bool:
        """k_x = 0: with v → iv everything is real."""
        return self.problem.kx == 0.0

    def chute(self, ring: Arithmetic) -> Chute:
        """The parameters as exact decimals."""
        c = self.problem.flow.chute
        e, e_w, r, tan_theta, nu_max = (ring.number(exact(x)) for x in (c.e, c.e_w, c.r, c.tan_theta, c.nu_max))
        return Chute(e, e_w, r, tan_theta, nu_max, c.radial, c.wall)

    def course(self, ring: Arithmetic, settings: Settings, base_settings: Settings, tick: Tick) -> ChuteCourse:
        """See protocol.Formulation."""
        chute = self.chute(ring)
        key = ring.name, base_settings
        if key not in self._solved:
            self._solved[key] = tuple(map(ring.to_mpmath, self._far_values(ring, chute, base_settings, tick)))
        T, u = map(ring.number, self._solved[key])
        return ChuteCourse(ring, chute, settings, self.problem, T, u)

    def _far_values(self, ring: Arithmetic, chute: Chute, settings: Settings, tick: Tick) -> tuple[Any, Any]:
        """(T_∞, u_∞): for a given mass flux by Newton on ln Q0(ln T_∞), the derivative from a difference in low precision."""
        flow = self.problem.flow

        def solve(T: Any) -> Any:
            return descend(ring, chute, T, settings, flow.height, tick)

        if flow.asked_flux is None:
            T = ring.number(exact(flow.far_temperature))
            return T, solve(T).far_velocity
        first = ring.number(flow.far_temperature)
        T = first if self._temperature is None else ring.number(self._temperature)
        flux = ring.number(exact(flow.asked_flux))
        goal = -settings.tolerance * math.log2(10)
        if self._rate is None:
            step = ring.number(2.0**-PROBE)
            above, below = (solve(T * (1 + s)).mass_flux for s in (step, -step))
            self._rate = ring.to_mpmath((above - below) / (flux * 2 * step))
        rate = ring.number(self._rate)
        before: tuple[Any, Any] | None = None
        for _ in range(NEWTONS):
            base = solve(T)
            misfit = (base.mass_flux - flux) / flux
            if before is not None and before[0] != T and before[1] != misfit:
                rate = (misfit - before[1]) / ((T - before[0]) / T)
            if matrices.vanishes(rate):
                break
            step = ring.rounded(misfit / rate)
            size = ring.log2(step)
            if size < goal:
                self._rate, self._temperature = ring.to_mpmath(rate), ring.to_mpmath(T)
                return T, base.far_velocity
            before = T, misfit
            T = ring.rounded(T * (1 - step))
            if ring.log2((T - first) / first) > math.log2(WANDER):
                break
        raise ConvergenceError(
            "the base flow is not determined to this many digits: it lies at a fold of the family of flows, where the mass flux "
            f"hardly changes with far_temperature (d ln Q0/d ln T = {float(ring.to_mpmath(rate)):.1e})"
        )


class ChuteCourse:
    """One way down a chute flow of known T_∞ and u_∞. See protocol.Course."""

    def __init__(self, ring: Arithmetic, chute: Chute, settings: Settings, problem: ChuteProblem, T: Any, u: Any) -> None:
        self.ring, self.chute, self.settings = ring, chute, settings
        self._kx, self._ky = (ring.complex(exact(k)) for k in (problem.kx, problem.ky))
        self._rotated = problem.kx == 0.0
        self._far_temperature, self._far_velocity = T, u
        self._problem = problem
        self._series = far_series(ring, chute, T, settings.far_terms)
        self._frames: dict[str, list[Matrix]] = {}
        self._place: list[list[Any]] | None = None

    def launch(self, sigma: Any) -> None:
        """The start is guessed from the radius of convergence that doubles see, and moved out until the series holds."""
        log_start = min(start_of(self.ring, self._series, self.settings), self._guess(sigma))
        while True:
            self._start = self.ring.number(2.0**log_start)
            self._far_pencil = self._scaled_pencil(self._series, self._start, self.settings.far_terms, in_nu=True)
            self._frames = {}
            limit = self._limit(self._decaying(sigma))
            if limit >= 0.0:
                break
            log_start += limit - 0.02
        state = [evaluate(self.ring, c, self._start) for c in self._series]
        self._descent = Descent(self.ring, self.chute, self.settings, state, self._problem.flow.height(2.0**log_start))

    def _guess(self, sigma: Any) -> float:
        """log2 of a start: doubles, whose last terms (16th to 19th) lie below 10^−14, see the radius as about 10^(14/18) times theirs."""
        z = self._problem.start(complex(self.ring.to_mpmath(sigma)), 1e-14)
        gain = 14 / 18 - self.settings.far_tolerance / self.settings.far_terms
        return float(self._problem.flow.at(z)[0].real) / math.log(2) + gain * math.log2(10) - self.settings.far_shift

    def _limit(self, terms: list[Matrix]) -> float:
        """log2 of the fraction of the start at which the terms left out are small, row by row."""
        sizes = [[max(self.ring.log2(x) for x in P[i]) for P in terms] for i in range(system.SIZE)]
        limits = [step_limit(s, max(s[:2]), self.settings.far_tolerance) for s in sizes if max(s[:2]) > -math.inf]
        return min(limits)

    def far_frame(self, sigma: Any) -> tuple[Matrix, Any]:
        terms = self._decaying(sigma)
        cells = range(system.DECAYING)
        frame = [
            [self.ring.rounded(sum((P[i][q] for P in reversed(terms)), self.ring.number(0))) for q in cells] for i in range(system.SIZE)
        ]
        return frame, self._start ** (4 * self._wavenumber * self._far_temperature)

    def expand(self, longest: float) -> Expansion:
        if self._place is None:
            self._place, self._reach = self._descent.expand()
        h = min(self._reach, longest)
        at_wall = h >= self._descent.remaining
        self._step = self._descent.to_base(self._place) if at_wall else self.ring.number(-h)
        C0, C1, D0, D1, _ = self._scaled_pencil(self._place, self._step, self.settings.order)
        return Expansion(self._step, C0, C1, D0, D1, at_wall)

    def advance(self) -> None:
        assert self._place is not None
        self._descent.advance(self._place, self._step)
        self._place = None

    def wall_rows(self) -> tuple[Matrix, Matrix]:
        nu, T, u, Q, _ = (self.ring.complex(x) for x in self._descent.state)
        bg = background(self.chute, nu, T, u + self._far_velocity, Q, self.ring.pi)
        rows = wall_rows(self.chute, bg, self._kx, self._ky, self.ring.pi)
        W0, W1 = ([[self._turned(row[j], 2 if i == 2 else 0, j) for j in range(system.SIZE)] for i, row in enumerate(W)] for W in rows)
        return W0, W1

    @property
    def _wavenumber(self) -> Any:
        return simplified(self.ring, (self._kx * self._kx + self._ky * self._ky) ** 0.5)

    def _scaled_pencil(self, series: list[list[Any]], unit: Any, terms: int, in_nu: bool = False) -> tuple[Any, ...]:
        """C0, C1, D0, D1 and ν0′/ν0 as series in z/unit, or in ν0/unit."""
        powers = [self.ring.number(1)]
        for _ in range(terms - 1):
            powers.append(self.ring.rounded(powers[-1] * unit))
        nu, T, u, Q = (real_series(self.ring, [c * p for c, p in zip(y, powers, strict=True)]) for y in series[:4])
        plain = fields(self.chute, nu, T, u + self._far_velocity, Q, self.ring.pi)
        # d/dz with z = unit t, or with ν0 = unit t: (ν0′/ν0) t d/dt
        rate = plain.decay if in_nu else 1 / unit
        bg = Background(**{name: Series((F, rate * F.derivative(int(in_nu)))) for name, F in vars(plain).items()})
        parts = system.pencil_entries(bg, self.chute.tan_theta, self._kx, self._ky)
        return *({at: self._turned(e, *at) for at, e in part.items()} for part in parts), bg.decay[0]

    def _turned(self, entry: Any, i: int, j: int) -> Any:
        """An entry after v → iv, if k_x = 0."""
        if self._rotated and (i in SPANWISE) != (j in SPANWISE):
            entry = (entry if isinstance(entry, Taylor) else self.ring.complex(entry)) * (-1j if i in SPANWISE else 1j)
        return entry if isinstance(entry, Taylor) else simplified(self.ring, entry)

    def _decaying(self, sigma: Any) -> list[Matrix]:
        """P_m ν^m at the start."""
        key = str(sigma)
        if key not in self._frames:
            C0, C1, D0, D1, decay = self._far_pencil
            C0, C1 = ({at: e * decay for at, e in part.items()} for part in (C0, C1))
            A = explicit(self.ring, system.SIZE, affine(C0, C1, sigma), affine(D0, D1, sigma))
            K = self._wavenumber
            s = [1j * self._kx, 1j * self._ky, -self.ring.complex(K)]
            B = [[-s[i] * s[j] / (7 * K) + (K if i == j else 0) for j in range(3)] for i in range(3)]
            leading, exponents = self._leading(sigma, B, K)
            rate = K * self._far_temperature
            self._frames = {key: decaying_series(self.ring, A, leading, rate, exponents, self.settings.far_terms)}
        return self._frames[key]

    def _leading(self, sigma: Any, B: Matrix, K: Any) -> tuple[Matrix, Matrix]:
        """P_0, with columns û, v̂, ŵ, T̂ at infinity, and N = Λ − K T_∞ I, N² = 0; see problems.chute.far_field."""
        T, zero, one = self._far_temperature, self.ring.number(0), self.ring.number(1)
        omega = sigma + 1j * self._kx * self._far_velocity
        divergence = [-B[2][0] + 1j * self._kx, -B[2][1] + 1j * self._ky, -B[2][2] - 1 / T]
        P = [[zero] * 4 for _ in range(system.SIZE)]
        for q in range(3):
            P[0][q], P[5][q], P[6][q] = -divergence[q] / omega, -B[0][q], -B[1][q]
        for q in range(4):
            P[1 + q][q] = one
        P[7][3] = law.coefficients(zero, self.chute.ep, self.chute.nu_max, self.chute.model, self.ring.pi).g3[0] * T**0.5 * K
        N = [[(B[i][j] - (K if i == j else 0)) * T for j in range(3)] + [zero] for i in range(3)] + [[zero] * 4]
        turn = (0, 2, 0, 0)  # column 1 of the frame belongs to v̂
        P = [[self._turned(x, i, turn[q]) for q, x in enumerate(row)] for i, row in enumerate(P)]
        return P, [[self._turned(x, turn[i], turn[q]) for q, x in enumerate(row)] for i, row in enumerate(N)]
