"""C(σ) ψ′ = D(σ) ψ, polynomials in σ, between two ends, written down by whoever has it: see `problem`."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shootstab.core.errors import InputError, shortened
from shootstab.core.given import is_complex
from shootstab.core.regions import Rectangle
from shootstab.problems.capabilities import ENCLOSABLE, FAMILY, MULTIPRECISION, POLYNOMIAL_PENCIL, VARIED
from shootstab.problems.decaying_space import AsymptoticRates, DecayingSpace
from shootstab.problems.ends import Infinity, Interface, Wall
from shootstab.problems.first_mesh import resolving
from shootstab.problems.inside_curves import Crossings, inside_curves
from shootstab.problems.knots import CoefficientFunction, as_knots, find_knots, with_pairs
from shootstab.problems.pencil_function import PencilFunction
from shootstab.problems.protocol import ComplexArray, FarFrame, Pencil
from shootstab.problems.singular_curve import CURVE_PROBES, TRACE_NOISE, ContinuumOnLine
from shootstab.problems.splitting import AsymptoticPencil
from shootstab.problems.subdomains import blocks, frames
from shootstab.problems.two_point import TwoPointReduction, reduce_to_two_points
from shootstab.problems.unknowns import Placement, Unknowns

MOST_STATES = 64  # chosen: n of a problem; the minors of more states are not to be held
FIRST_MESH = 33  # chosen: points of it
BESIDE = 1.0371  # chosen: times the reference, a σ where the decaying spaces are known to exist, of no property of its own
GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)  # derived: multiples of it less integers are spread evenly, and on no regular points
KNOT_PROBES = 64  # chosen: points at which an entry is asked whether it varies
GRADING = 3.0  # chosen: grading of the first mesh towards the wall, where the other end is at infinity; redistribution undoes it


def problem(
    size: int,
    pencil: Callable[[Any], Any],
    left: Wall | Infinity,
    right: Wall | Infinity,
    *,
    interfaces: Sequence[Interface] = (),
    continuum: Callable[[Any], Any] | Literal[False] | None = None,
    fold: float | None = None,
    reference: complex | None = None,
    vectorized: bool = False,
    coarser: Callable[[float], LinearProblem] | None = None,
    written: Callable[[], Any] | None = None,
    growing_region: Callable[..., tuple[Rectangle, str]] | None = None,
    unknowns: Mapping[str, ArrayLike] | Sequence[str] = (),
    variable: str = "z",
    knots: ArrayLike = (),
) -> LinearProblem:
    """The eigenvalue problem (C0 + σ C1) ψ′ = (D0 + σ D1) ψ, or one of higher degree in σ, ψ of this size, between a left and a right end.

    pencil(z) returns D0, D1 (C is the identity) or C0, C1, D0, D1, arrays (size, size), or C0, …, Cq, D0, …, Dq for powers of σ up to
    the q-th; compiled with numba it is fast; vectorized, it takes z (m,) and returns (m, size, size). An end is a
    `Wall` with rows or an `Infinity`, of whose limiting matrix the decaying space is found; both may be infinite: the two sides then
    meet at z = fold, by default at 0, or in the middle of where the coefficients vary if they are at their limits there. Interfaces
    couple ψ(z−) and ψ(z+). continuum(z) is σ_c(z), the σ for which C is singular at z; by default it is found from the pencil, and led
    around where it is one curve and analytic; with continuum=False it is not looked for. coarser(factor) is the problem on a base flow
    computed less accurately by this factor, if the base flow is computed at all; written makes the same problem by `equations`, which
    gives it many digits and proofs; growing_region(floor) is a rectangle with every σ of Re σ ≥ floor, and the theorem that says so.

    Coefficients are sampled at a few thousand points, so that what they do far from the origin is seen. A feature that is narrower than a
    2000th of its subdomain, or than a 50th of its distance from a fold or a wall, may lie between samples: an interface at its place, or
    the fold, shows where it is.

    knots are points at which coefficients jump or have kinks, in any of their derivatives; to them are added those that their values tell
    of (see knots.py). Every knot is made a node of the mesh, and the coefficients are taken on either side of it.

    reference is a σ at which the solutions that decay are as many as are wanted, in the part of the plane where modes are looked for; found
    on the axes if it is not given, which does where that part is not cut off from them by continuous spectra.

    unknowns is what eigenfunctions are shown in: names of the first components of ψ, or {name: a row of numbers over them}; psi1, psi2, …
    by default. variable is what z is called beside them.

    Raises InputError, which names what is wrong: shapes, numbers that are not finite, dependent rows, or conditions that are too many or
    too few for the solutions that decay.
    """
    if not isinstance(size, int) or isinstance(size, bool) or not 1 <= size <= MOST_STATES:
        raise InputError(f"size = {size!r}: allowed is an integer from 1 to {MOST_STATES}")
    if continuum is not None and continuum is not False and not callable(continuum):
        raise InputError(f"continuum = {continuum!r}: allowed is a function of z, or False for a curve that is not to be looked for")
    if not callable(pencil):
        raise InputError(f"pencil = {pencil!r}: allowed is a function of z")
    for name, end in (("left", left), ("right", right)):
        if not isinstance(end, Wall | Infinity):
            raise InputError(f"{name} = {end!r}: allowed is st.Wall(z, rows) or st.Infinity()")
        if isinstance(end, Wall):
            end.require_place(name)
    if reference is not None and not (is_complex(reference) and reference != 0):
        raise InputError(f"reference = {shortened(reference)}: allowed is a finite number other than 0, where solutions decay as wanted")
    shown = Unknowns.named(unknowns, size, variable) if len(unknowns) or variable != "z" else None
    function = PencilFunction(size, pencil, vectorized)
    low, high = (end.z if isinstance(end, Wall) else math.copysign(math.inf, side) for end, side in ((left, -1), (right, 1)))
    given = as_knots(knots, low, high)
    reduction = reduce_to_two_points(function, left, right, tuple(interfaces), fold, reference)
    farther = None
    if any(isinstance(end, Wall) and end.approximates is not None for end in (left, right)):
        ends = [end.twice_as_far if isinstance(end, Wall) else end for end in (left, right)]
        try:
            moved = reduce_to_two_points(function, ends[0], ends[1], tuple(interfaces), fold, reference)
        except InputError as error:
            raise InputError(f"with walls twice as far from the points that they approximate, {error}") from error
        moved = moved.over(reduction.start, reduction.end)
        farther = LinearProblem(function, moved, *inside_curves(function, moved, continuum), given=given)
    curve, fixed = inside_curves(function, reduction, continuum)
    return LinearProblem(function, reduction, curve, fixed, coarser, farther, written, growing_region, shown, given)


@dataclass(frozen=True, eq=False, repr=False)
class LinearProblem:
    """A user's problem behind the problem protocol; made by `problem`.

    curve is σ_c(z), fixed are continuous spectra (z, σ_c), each (m,), that no path avoids. coarser is the problem on a base flow that is
    less accurate by a factor, farther_walls that with its approximate walls twice as far from the points that they approximate, written
    the same in equations; bounded is the growing_region of `problem`; eigenfunctions are shown in unknowns; given are the user's knots;
    made_by is the call that makes the problem again, where it is known.
    """

    function: PencilFunction
    reduction: TwoPointReduction
    curve: Callable[[Any], Any] | None = None
    fixed: Crossings = ()
    coarser: Callable[[float], LinearProblem] | None = None
    farther_walls: LinearProblem | None = None
    written: Callable[[], Any] | None = None
    bounded: Callable[..., tuple[Rectangle, str]] | None = None
    unknowns: Unknowns | None = None
    given: tuple[float, ...] = ()
    made_by: Callable[[], LinearProblem] | None = None

    def __reduce_ex__(self, protocol: Any) -> Any:
        """The call that makes the problem again, for other processes: functions inside functions are not sent. Otherwise its fields."""
        family_of = FAMILY.of(self)
        if family_of is not None:
            return family_of(()).problem, ({},)
        return super().__reduce_ex__(protocol) if self.made_by is None else (self.made_by, ())

    def __repr__(self) -> str:
        return f"{type(self).__name__}(order {self.size}, {self.decaying} conditions at its first end)"

    @property
    def size(self) -> int:
        return self.reduction.size

    @property
    def decaying(self) -> int:
        return len(self.reduction.rows[0])

    def pencil(self, z: ComplexArray) -> Pencil:
        """The pencil at points z (m,) of the line on which the problem is laid out: the user's own if it has one subdomain."""
        return blocks([subdomain.pencil(self.function, z) for subdomain in self.reduction.subdomains])

    def start(self, sigma: complex, tolerance: float) -> float:
        """The same for all σ: the coefficients are at their limit to rounding."""
        return self.reduction.start

    def far_frame(self, z: float, sigma: complex) -> FarFrame:
        """The spaces with which the subdomains begin, normalized as in kato_frame.py."""
        return frames([subdomain.frame(sigma) for subdomain in self.reduction.subdomains])

    def mesh(self, start: float) -> NDArray[np.float64]:
        """Points (m,) from start, which is that of the problem, to the end: denser there if another end is at infinity, and where the
        coefficients vary; two at every knot."""
        points = self._first_mesh
        return points if len(self.knots) == 0 else with_pairs(points, self.reduction.pairs(self.knots))

    @cached_property
    def knots(self) -> NDArray[np.float64]:
        """The points z (k,) at which coefficients are not smooth: those given, those that interfaces leave, and those found."""
        known = np.unique(np.concatenate((self.given, self.reduction.jumps)))
        return np.unique(np.concatenate([find_knots(self._varying, *line, known) for line in self.reduction.intervals]))

    @cached_property
    def _varying(self) -> CoefficientFunction:
        """The entries of the pencil that are not the same everywhere, as a function of real z."""
        (low, high) = np.array(self.reduction.intervals).T
        x = np.modf(GOLDEN * np.arange(1, KNOT_PROBES + 1))[0]
        probes = self._entries((low[:, None] + (high - low)[:, None] * x).ravel())
        entries = np.flatnonzero((probes != probes[0]).any(axis=0))
        return lambda z: self._entries(z)[:, entries]

    def _entries(self, z: NDArray[np.float64]) -> ComplexArray:
        """All entries of all matrices at real z, (m, entries)."""
        at = self.function(z.astype(np.complex128))
        return np.concatenate([M.reshape(len(z), -1) for M in (*at.C, *at.D)], axis=1)

    def wall_rows(self) -> tuple[ComplexArray, ...]:
        return self.reduction.rows

    def with_base_flow_error(self, factor: float) -> LinearProblem:
        """The problem on a base flow computed less accurately by this factor; itself if the base flow is in closed form."""
        if self.coarser is None:
            return self
        if factor not in self._crude:
            self._crude[factor] = self.coarser(factor)
        return self._crude[factor]

    @property
    def continuum(self) -> ContinuumOnLine | None:
        """σ_c(z); None where the problem has none, or is not analytic in z: then its curves are crossings."""
        alone = len(self.reduction.subdomains) == 1 and (self.curve is None or (len(self.knots) == 0 and self._curve_moves))
        return self._on_line if alone else None

    @cached_property
    def _curve_moves(self) -> bool:
        """Whether σ_c is more than one number: a path in z leads around a curve, and around no point."""
        line = self._on_line
        if line is None:
            return False
        sigma = line(line.heights(CURVE_PROBES).astype(np.complex128))
        return bool(np.abs(sigma - sigma[0]).max() > TRACE_NOISE * max(1.0, float(np.abs(sigma).max())))

    @property
    def asymptotics(self) -> tuple[tuple[AsymptoticPencil, int], ...]:
        """The limiting pencil of every end at infinity that has one, and how many solutions decay there."""
        return tuple((end.kato_frame.limit, end.columns) for end in self.at_infinity if end.has_limit)

    @property
    def crossings(self) -> Crossings:
        """(z, σ_c(z)), each (m,), of every curve that no path in z leads around: in several subdomains, or of several curves in one."""
        curve = self._on_line
        if curve is None or self.continuum is not None:
            return self.fixed
        return tuple((z.real, curve(z)) for z in self.reduction.lines)

    @property
    def multiprecision(self) -> Any:
        """The problem to many digits, where this one was posed in equations; otherwise None."""
        return None if self._in_equations is None else MULTIPRECISION.of(self._in_equations)

    @property
    def enclosable(self) -> Any:
        """The problem in balls, where this one was posed in equations; otherwise None."""
        return None if self._in_equations is None else ENCLOSABLE.of(self._in_equations)

    @property
    def polynomial_pencil(self) -> Any:
        """The problem with polynomial coefficients, for certificates; None where it is not in equations."""
        return None if self._in_equations is None else POLYNOMIAL_PENCIL.of(self._in_equations)

    @property
    def varied(self) -> Any:
        """The problem in balls with a parameter left open, where this one was posed in equations; otherwise None."""
        return None if self._in_equations is None else VARIED.of(self._in_equations)

    @property
    def at_infinity(self) -> tuple[DecayingSpace, ...]:
        """The ends at infinity."""
        return tuple(subdomain.far for subdomain in self.reduction.subdomains if isinstance(subdomain.far, DecayingSpace))

    @property
    def generic_sigma(self) -> complex:
        """A σ without any property at which the decaying spaces exist: next to the one that they are normalized at."""
        return BESIDE * (self.at_infinity[0].kato_frame.reference if self.at_infinity else 1.0)

    def ends(self, sigma: complex) -> tuple[AsymptoticRates, ...]:
        """How solutions behave at the ends at infinity: rates, how many decay, and the gap by which they are told apart."""
        return tuple(end.at(complex(sigma)) for end in self.at_infinity)

    @property
    def _on_line(self) -> ContinuumOnLine | None:
        low, high = sorted((self.reduction.start, self.reduction.end))
        return None if self.curve is None else ContinuumOnLine(self.curve, self.function.vectorized, low, high)

    @cached_property
    def growing_region(self) -> Callable[..., tuple[Rectangle, str]] | None:
        """See problems.capabilities: as it was given, or that of the same problem in equations."""
        return self.bounded or getattr(self._in_equations, "growing_region", None)

    @property
    def placements(self) -> tuple[Placement, ...]:
        """Where the components of each subdomain live; of an augmented one those of ψ, behind those of a."""
        return self.reduction.placements(self.function.size)

    @cached_property
    def _in_equations(self) -> Any:
        return None if self.written is None else self.written()

    @cached_property
    def _first_mesh(self) -> NDArray[np.float64]:
        start, end, x = self.reduction.start, self.reduction.end, np.linspace(1.0, 0.0, FIRST_MESH)
        graded = np.sinh(GRADING * x) / math.sinh(GRADING) if self.at_infinity else x
        return resolving(self.function, self.reduction.subdomains, np.asarray(end + (start - end) * graded))

    @cached_property
    def _crude(self) -> dict[float, LinearProblem]:
        return {}
