"""The chute's perturbations enclosed: the pencil of many digits on series with tails, along an enclosed flow."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import mpmath

from shootstab.core.balls import acb, arb, ctx
from shootstab.core.errors import ConvergenceError
from shootstab.models.chute import first_order_system as system
from shootstab.models.chute.background import background
from shootstab.models.chute.enclosed_flow import EnclosedDescent, EnclosedFlow, Piece
from shootstab.models.chute.flow_set import TailedFields
from shootstab.models.chute.multiprecision_far import leading, turned, wavenumber
from shootstab.models.chute.multiprecision_problem import ChuteDigits
from shootstab.models.chute.parameters import Chute
from shootstab.models.chute.perturbations import Perturbations
from shootstab.models.chute.wall import wall_rows
from shootstab.multiprecision.arithmetic import Matrix, exact
from shootstab.multiprecision.flint_backend import FlintArithmetic
from shootstab.multiprecision.frame_enclosure import CELLS_OF_STEP, FrameEnclosure
from shootstab.multiprecision.mapped_tails import AIM
from shootstab.multiprecision.settings import GUARD_DIGITS, Settings
from shootstab.multiprecision.tailed_pencil import BALLS, TailedPencil

LEMMAS = ("C1", "C2", "C3", "C4", "C5", "C6", "E4", "E11")  # lemmas of the guide's page on proofs; E4 where |D| is bounded by it
FIRST_START = 2.0**-9  # chosen: ν0 from which on a start of the far field is looked for
REUSED = 1.5  # chosen: bits, over those asked for, with which an enclosure serves again
REGION_ROOM = 1.25  # chosen: the region that an enclosure holds for, over the one asked for
HARDEST = 2  # chosen: balls of σ, those nearest to the end of the continuous spectrum, for which the start of the far field is chosen
NO_BRACKET = "no bracket of the far temperature is proved to hold a flow of this mass flux: take more bits"
LEAST_DIGITS = 6.0  # chosen: fewest digits of a flow
CHUTE_OUTER = 2.0**-4  # chosen: the far field begins hardly lower for so thick a σ, and the bound of |D| is 20 nats above it
CHUTE_POINTS = 18  # chosen: a value of D takes half a second
FAR_CELLS = 24  # chosen: cells of the far field, each half of the next, on which the continuous spectrum is enclosed
LEAST_FAR_TERMS = 64  # chosen: the tail of the far field contracts by |A_0|/N at best
FLUX_ROOM = 1e2  # chosen: half width of the bracket of T_∞, over 10^−digits of it
BRACKET_WIDER, WIDENINGS = 1e3, 3  # chosen: factor by which the bracket is widened, and how often it is


class ChutePath:
    """See multiprecision.frame_enclosure.EnclosedPath: a chute's perturbations on one enclosed flow."""

    size, decaying = system.SIZE, system.DECAYING

    def __init__(self, flow: EnclosedFlow, pencils: Pencils) -> None:
        self.flow, self._kx, self._ky, velocity = flow, pencils.kx, pencils.ky, flow.base.far_velocity
        self.steps: Sequence[TailedPencil] = [step_pencil(pencils(piece.fields, velocity), piece.h) for piece in flow.pieces]
        self._far_pencil = far_pencil(pencils(flow.far, velocity))

    @property
    def multiple(self) -> tuple[Any, ...]:
        """Where the far field begins, and of which flows."""
        flow = self.flow
        balls = flow.start, flow.far_temperature, flow.base.state[0]
        return tuple(int(x) for ball in balls for part in (ball.mid(), ball.rad()) for x in part.man_exp())

    def far(self, sigma: Any) -> Matrix:
        flow = self.flow
        P0, nilpotent = leading(BALLS, flow.chute, (self._kx, self._ky), (flow.far_temperature, flow.base.far_velocity), sigma)
        rate = wavenumber(BALLS, self._kx, self._ky) * flow.far_temperature
        found = self._far_pencil.decaying(sigma, P0, acb(rate).real, nilpotent)
        if found is None:
            raise ConvergenceError(f"the far field starts too low for an enclosure at sigma = {complex(acb(sigma).mid()):.6g}")
        return found

    @cached_property
    def singular(self) -> Sequence[Any]:
        """Balls that hold the continuous spectrum σ_c(z) from the base to infinity, where det C = 0 (theory, lemma C4).

        Raises ConvergenceError where det C may vanish for all σ.
        """
        flow, halves = self.flow, [arb(0), *(arb(2) ** (i - FAR_CELLS) for i in range(FAR_CELLS + 1))]
        cells = [[y.at(low.union(high)) for y in flow.far[:4]] for low, high in pairwise(halves)]
        parts = [arb(i) / CELLS_OF_STEP for i in range(CELLS_OF_STEP + 1)]
        cells += [piece.at(low.union(high))[:4] for piece in flow.pieces for low, high in pairwise(parts)]
        found = []
        for nu, T, u, Q in ([acb(x) for x in cell] for cell in cells):
            bg = background(flow.chute, nu, T, u + flow.base.far_velocity, Q, arb.pi())
            place = system.continuum(bg, self._kx)[0]
            if not place.is_finite() or bg.eta[0].contains(0):
                raise ConvergenceError("the continuous spectrum of the flow is not enclosed: take more bits")
            found.append(place)
        return found

    def analytic(self, sigma: Any) -> bool:
        """Whether the ball σ holds nothing of the continuous spectrum."""
        return not any(acb(sigma).overlaps(place) for place in self.singular)

    def wall(self, sigma: Any) -> Matrix:
        flow = self.flow
        nu, T, u, Q, _ = (acb(x) for x in flow.base.state)
        bg = background(flow.chute, nu, T, u + flow.base.far_velocity, Q, arb.pi())
        W0, W1 = wall_rows(flow.chute, bg, self._kx, self._ky, arb.pi())
        rows = [[acb(W0[i, j]) + sigma * acb(W1[i, j]) for j in range(self.size)] for i in range(self.decaying)]
        return [[turned(x, 2 if i == 2 else 0, j) if self._kx == 0 else x for j, x in enumerate(row)] for i, row in enumerate(rows)]


class Pencils:
    """Pencils on series, each made once as long as u_∞, which k_x alone brings in, does not matter. kx, ky: complex balls."""

    def __init__(self, chute: Chute, kx: Any, ky: Any) -> None:
        self._chute, self.kx, self.ky = chute, kx, ky
        self._kept: dict[int, tuple[TailedFields, tuple[Any, ...]]] = {}  # pencils by the identity of the fields kept beside them

    def __call__(self, fields: TailedFields, far_velocity: Any) -> tuple[Any, ...]:
        """C0, C1, D0, D1 and ν0′/ν0 as series in t, without the entries that vanish; after v → iv if k_x = 0."""
        if self.kx != 0:
            return self._made(fields, far_velocity)
        if id(fields) not in self._kept:
            self._kept[id(fields)] = fields, self._made(fields, far_velocity)
        return self._kept[id(fields)][1]

    def _made(self, fields: TailedFields, far_velocity: Any) -> tuple[Any, ...]:
        nu, T, u, Q = fields[:4]
        bg = background(self._chute, nu, T, u + far_velocity, Q, arb.pi())
        nothing = nu * 0
        out = []
        for part in system.pencil_entries(bg, self._chute.tan_theta, self.kx, self.ky):
            entries = {at: nothing + y for at, y in part.items()}
            out.append({at: turned(y, *at) if self.kx == 0 else y for at, y in entries.items() if not y.zero})
        return *out, bg.decay[0]


def step_pencil(parts: tuple[Any, ...], h: Any) -> TailedPencil:
    """C dψ/dt = h D ψ."""
    C0, C1, D0, D1, decay = parts
    return TailedPencil(system.SIZE, (C0, C1), [{at: y * h for at, y in part.items()} for part in (D0, D1)], decay.terms)


def far_pencil(parts: tuple[Any, ...]) -> TailedPencil:
    """(ν0′/ν0) C t dψ/dt = D ψ, t = ν0 over that at the start."""
    C0, C1, D0, D1, decay = parts
    return TailedPencil(system.SIZE, [{at: y * decay for at, y in part.items()} for part in (C0, C1)], (D0, D1), decay.terms)


class ChuteEnclosable:
    """See problems.capabilities.ENCLOSABLE: a chute, its flow enclosed anew for every working precision and region of σ."""

    lemmas: tuple[str, ...] = LEMMAS
    outer: float = CHUTE_OUTER
    most_points: int = CHUTE_POINTS

    def __init__(self, problem: Perturbations) -> None:
        self._digits, self._problem = ChuteDigits(problem), problem
        self._kept: tuple[int, list[Any], FrameEnclosure] | None = None

    def enclosure(self, bits: int, *regions: Any) -> FrameEnclosure:
        """D at so many bits for σ in some balls, on one flow.

        Raises ConvergenceError where the flow is not enclosed, or a ball comes too near to the continuous spectrum.
        """
        if self._kept is not None:
            known, about, found = self._kept
            if bits <= known <= REUSED * bits and all(any(x.contains(region) for x in about) for region in regions):
                return found
        if any((region + 1j * acb(self._problem.kx) * arb(self._problem.flow.far_velocity)).contains(0) for region in regions):
            raise ConvergenceError(
                "the disc on which D is bounded holds the end of the continuous spectrum at infinity: take a smaller disc"
            )
        with BALLS.working(1), ctx.workprec(bits):
            about = [_wider(region) for region in regions]
            self._kept = bits, about, FrameEnclosure(self._path(bits, about), self._digits.real)
        return self._kept[2]

    @property
    def premise(self) -> str:
        """The flow, as T_∞ and ν0 at the base have it."""
        if self._kept is None:
            return ""
        found, flux = self._kept[2].path.flow, self._problem.flow.asked_flux  # type: ignore[attr-defined]
        T = repr(self._problem.flow.far_temperature) if flux is None else _shown(found.far_temperature)
        place = f"far_temperature = {T} and a base at nu = {_shown(found.base.state[0])}"
        if not found.first:
            place += " (not proved to be the first place at which the energy condition holds)"
        if flux is None:
            return f"for the steady flow with {place}"
        return f"a steady flow with mass_flux = {flux!r} exists with {place}, and for every such flow"

    def _path(self, bits: int, regions: Sequence[Any]) -> ChutePath:
        flow, settings = self._problem.flow, Settings.of(max(bits / math.log2(10) - GUARD_DIGITS, LEAST_DIGITS))
        settings = replace(settings, far_terms=max(settings.far_terms, LEAST_FAR_TERMS))
        chute = self._digits.chute(BALLS)
        kx, ky = (acb(BALLS.complex(exact(k))) for k in (self._problem.kx, self._problem.ky))
        pencils = Pencils(chute, kx, ky)
        about = arb(flow.far_velocity)  # u_∞ follows from the base: what is admitted with this one is bounded again with the true one
        wave = acb(wavenumber(BALLS, kx, ky)).real

        def far_contraction(fields: TailedFields) -> float:
            T = fields[1].c[0].real
            pencil = far_pencil(pencils(fields, about))
            return max(pencil.contraction(region, wave * T, leading(BALLS, chute, (kx, ky), (T, about), region)[1]) for region in hardest)

        def step_contraction(piece: Piece) -> float:
            pencil = step_pencil(pencils(piece.fields, about), piece.h)
            return max(pencil.contraction(region) for region in regions)

        end = 1j * kx * about
        hardest = sorted(regions, key=lambda region: float(abs(region + end).lower()))[:HARDEST]

        nu, _ = EnclosedDescent(chute, arb(flow.far_temperature), settings).far(flow.inside(FIRST_START), far_contraction)

        def flow_of(far_temperature: Any, settings: Settings, contraction: Callable[[Piece], float] = lambda piece: AIM) -> EnclosedFlow:
            descent = EnclosedDescent(self._digits.chute(BALLS), far_temperature, settings)  # parameters in the digits of the flow
            start, far = descent.far(nu)
            return descent.descend(start, far, flow.height(float(start)), contraction)

        far_temperature, ends = self._far_temperature(bits, flow_of)
        found = flow_of(far_temperature, settings, step_contraction)
        if not all(map(found.same_base, ends)):
            raise ConvergenceError(NO_BRACKET)  # a mass flux that is continuous between the ends is that of one base
        return ChutePath(found, pencils)

    def _far_temperature(self, bits: int, flow_of: Callable[[Any, Settings], EnclosedFlow]) -> tuple[Any, Sequence[EnclosedFlow]]:
        """T_∞, or a ball of which the mass flux asked for lies between those of the flows of its ends, and these."""
        digits = bits / math.log2(10)
        settings = Settings.of(digits + GUARD_DIGITS)
        flow = self._problem.flow
        if flow.asked_flux is None:
            return BALLS.number(exact(flow.far_temperature)), ()
        plain, asked = FlintArithmetic(), BALLS.number(exact(flow.asked_flux))
        with plain.working(settings.digits), mpmath.workdps(settings.digits):
            T = arb(self._digits.base(plain, settings, lambda: None)[0])
        room = arb(FLUX_ROOM) * arb(10) ** arb(-digits) * T
        for _ in range(WIDENINGS):
            ends = [(T - room).mid(), (T + room).mid()]
            with BALLS.working(settings.digits):
                flows = [flow_of(end, settings) for end in ends]
            below, above = (found.base.mass_flux - asked for found in flows)
            if (below < 0 and above > 0) or (below > 0 and above < 0):
                return ends[0].union(ends[1]), flows
            room = room * BRACKET_WIDER
        raise ConvergenceError(NO_BRACKET)


def _wider(region: Any) -> Any:
    """A ball about the same middle with room, so that another one asked for soon is held too."""
    room = arb(0, REGION_ROOM * abs(region - region.mid()).upper())
    return acb(region.real.mid() + room, region.imag.mid() + room)


def _shown(ball: Any) -> str:
    """A real ball in decimals, its radius rounded up; with two digits more than are known, it is hardly wider than the ball."""
    digits = max(6, math.ceil(math.log10(2) * ball.rel_accuracy_bits()) + 2)
    return str(ball.str(digits, more=True)).strip("[]").replace(" +/- ", " ± ")
