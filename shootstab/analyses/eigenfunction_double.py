"""The eigenfunction that belongs to a mode, at any z, with its adjoint and with what the mode is sensitive to.

    C φ′ = D φ,    −(Cᴴψ)′ = Dᴴψ,    along rising z,

and ψ's conditions are those that φ's leave open (see discriminants/back_substitution.py). Where the problem changes by δC, δD, and by δB in
its rows at the wall, a simple mode moves, to first order, by

    δσ = −(⟨ψ, (δD − δC d/dz) φ⟩ + λᴴ δB φ) / (⟨ψ, (∂_σD − ∂_σC d/dz) φ⟩ + λᴴ ∂_σB φ),    ⟨ψ, f⟩ = ∫ ψᴴ f dz,

with a like term where the decaying space that the integration begins with depends on σ. ψ is scaled so that the denominator is 1.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shootstab.analyses.condition import Conditioning, conditioning
from shootstab.analyses.eigenfunction_budget import Variants
from shootstab.analyses.on_the_line import OnTheLine, in_unknowns, real_points
from shootstab.analyses.refine import refine
from shootstab.analyses.refine_double import tolerance_for
from shootstab.core.allowed import MODE_HEIGHTS, RTOL
from shootstab.core.errors import InputError
from shootstab.core.records import Budget, Mode
from shootstab.discriminants.back_substitution import Solution, solution
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.product import Product
from shootstab.discriminants.shooting import Shooting
from shootstab.discriminants.subsystems import Subsystem
from shootstab.problems.capabilities import MODE_SHAPE, Shape
from shootstab.problems.protocol import ComplexArray, Problem
from shootstab.problems.unknowns import Unknowns, unknowns

OF_A_FUNCTION = 0.1  # chosen: the accuracy that a mesh is made for, in that of the mode: a function errs where its mode hardly does
OUT_OF_SIGHT = 0.03  # chosen: the part of its largest value that an unknown has fallen to where a picture or a file of it ends
DOUBLINGS = 12  # chosen: doublings of the way from the wall that are tried until it has
POLISHED = 1e-10  # chosen: part of a step to which the place of the largest value is found


@dataclass(frozen=True, eq=False)
class Eigenfunction:
    """f(z) gives the unknowns by name, with a factor that makes the largest of all their values 1: that of peak = (unknown, z).

    |true − shown| ≤ error times the largest value of the unknown, for each unknown and z; budget names the parts of that. conditioning
    says how sensitive the mode is. A function of the basis that a multiple mode has (see eigenspace.py) is 0 at each of
    zeros, (unknown, z), if there are any, and its error is in parts of the largest value of all unknowns.
    """

    mode: Mode
    problem: Problem
    line: OnTheLine
    peak: tuple[str, float]
    budget: Budget
    conditioning: Conditioning
    zeros: tuple[tuple[str, float], ...] = ()

    def __repr__(self) -> str:
        return f"Eigenfunction({', '.join(self.names)} at {complex(self.mode.sigma)}, error {self.error:.1e})"

    @property
    def names(self) -> tuple[str, ...]:
        """The unknowns."""
        return self._unknowns.names

    @property
    def variable(self) -> str:
        """What the problem calls z."""
        return self._unknowns.variable

    @property
    def error(self) -> float:
        """The sum of the budget."""
        return self.budget.total

    @property
    def normalization(self) -> str:
        """What the free factor is, in words."""
        one = f"{self.peak[0]} = 1 at {self.variable} = {self.peak[1]:.6g}"
        if self.zeros:
            return " and ".join([one, *(f"{name} = 0 at {self.variable} = {z:.6g}" for name, z in self.zeros)])
        return f"{one}, the largest of all values"

    def __call__(self, z: ArrayLike) -> Mapping[str, ComplexArray]:
        """The unknowns by name, each of the shape of z. Raises InputError for a z outside the domain."""
        values = self.values(real_points(z))
        return {name: values[:, i].reshape(np.shape(z)) for i, name in enumerate(self.names)}

    def fields(self, z: ArrayLike) -> Mapping[str, ComplexArray]:
        """The fields (m,) at z (m,) that the problem derives from the unknowns (the chute: the mass flux Qx, Qy, Qz); empty if none."""
        shape: Shape | None = MODE_SHAPE.of(self.problem)
        return {} if shape is None else shape.fields(real_points(z), self(real_points(z)))

    @cached_property
    def kind(self) -> str:
        """What the problem calls such a mode (the chute: 'vortex-forming' or 'clustering'); empty if nothing."""
        shape: Shape | None = MODE_SHAPE.of(self.problem)
        return "" if shape is None else shape.kind(shape.heights, self(shape.heights))

    def values(self, z: NDArray[np.float64]) -> ComplexArray:
        """The unknowns (m, q) at z (m,)."""
        return in_unknowns(self._unknowns, self.line.solution.sigma, z, self.line.right(z))

    def state(self, z: ArrayLike) -> ComplexArray:
        """The state φ (…, n) of the first-order system at z (…,)."""
        return self.line.right(real_points(z)).reshape(*np.shape(z), -1)

    def adjoint(self, z: ArrayLike) -> ComplexArray:
        """ψ (…, n) at z (…,): the i-th component belongs to the i-th equation of the first-order system."""
        return self.line.left(real_points(z)).conj().reshape(*np.shape(z), -1)

    def shift(self, other: Problem) -> complex:
        """The displacement of the mode, to first order, where the problem becomes another one of the same structure.

        Raises InputError for a multiple mode, whose zeros move apart.
        """
        if self.mode.multiplicity > 1:
            raise InputError(f"the mode at {complex(self.mode.sigma):.12g} is multiple: allowed is a simple one, that moves as one")
        own = self.line.solution.problem
        return -self.line.solution.change(replace(own, whole=other) if isinstance(own, Subsystem) else other)

    @cached_property
    def extent(self) -> tuple[float, float]:
        """(lowest, highest) z, beyond which every unknown is below OUT_OF_SIGHT of its largest value, or the solution is not known."""
        (low, high), (first, last) = self.line.ends, self.line.allowed
        if np.isfinite((first, last)).all():
            return first, last
        largest = np.abs(self.values(self.line.nodes)).max(axis=0)
        origin = 0.5 * (low + high) if np.isinf((first, last)).all() else low if np.isinf(last) else high
        sides = ((first, -1.0, origin - low), (last, 1.0, high - origin))
        bottom, top = (self._faded(origin, side, length, largest) if np.isinf(end) else end for end, side, length in sides)
        return bottom, top

    def _faded(self, origin: float, side: float, length: float, largest: NDArray[np.float64]) -> float:
        """Where, on this side of an origin, every unknown has fallen to OUT_OF_SIGHT of its largest value (q,)."""
        for _ in range(DOUBLINGS):
            z = origin + side * np.linspace(0.0, length, MODE_HEIGHTS)
            seen = np.flatnonzero((np.abs(self.values(z)) > OUT_OF_SIGHT * largest).any(axis=1))
            if not len(seen) or seen[-1] + 1 < MODE_HEIGHTS:
                return float(z[seen[-1] + 1 if len(seen) else 1])
            length *= 2.0
        return float(origin + side * length)

    def sampled(self, points: int = MODE_HEIGHTS) -> tuple[NDArray[np.float64], Mapping[str, ComplexArray]]:
        """(z, the unknowns by name), each (points,), at heights that rise over the extent."""
        z = np.linspace(*self.extent, points)
        return z, self(z)

    @cached_property
    def _unknowns(self) -> Unknowns:
        return unknowns(self.problem)


def eigenfunction_double(
    problem: Problem, mode: Mode | complex, rtol: float = RTOL, progress: Callable[[int, int], None] | None = None
) -> Eigenfunction:
    """The eigenfunction of a simple mode, or of the one next to a guess, along the real line.

    It is integrated by orthonormalized shooting with local errors that suit rtol, whatever the method and the path by which the mode was
    found, and with every step halved. Raises InputError for a mode that did not converge, or that stands for several, whose
    eigenfunctions it does not tell apart; ConvergenceError where the real line passes too near to a singular point.
    """
    found = mode if isinstance(mode, Mode) else refine(problem, mode, rtol)
    if not found.converged:
        raise InputError(f"no mode at sigma = {complex(found.sigma):.12g}: {found.status}")
    if found.multiplicity > 1:
        told = f"the mode at {complex(found.sigma):.12g} stands for {found.multiplicity} that are not told apart"
        raise InputError(f"{told}: allowed is a simple mode; st.eigenspace gives all solutions of this one")
    coarse = _shooting(problem, complex(found.sigma), tolerance_for(OF_A_FUNCTION * rtol))
    return eigenfunction_on(problem, found, coarse, coarse.refined(), progress)


def eigenfunction_on(
    problem: Problem, mode: Mode, coarse: Shooting, fine: Shooting, progress: Callable[[int, int], None] | None = None
) -> Eigenfunction:
    """The eigenfunction of the simple zero that a subsystem has next to a mode, on a mesh of it and on the halved one."""
    named = unknowns(problem)
    right, peak = normalized(OnTheLine(problem, solution(fine, complex(mode.sigma))), named)
    line = OnTheLine(problem, right.scaled(1.0, 1.0 / right.change_per_sigma))
    parts = Variants(problem, coarse, fine, named, mode).budget(progress)
    return Eigenfunction(mode, problem, line, peak, parts, conditioning(line.solution))


def _shooting(problem: Problem, sigma: complex, rtol: float) -> Shooting:
    """Orthonormalized shooting for the subsystem that the mode belongs to."""
    whole = Frame(rtol=rtol).on(problem).at(sigma)
    if not isinstance(whole, Product):
        return whole
    return min(whole.members, key=lambda member: abs(member.with_derivative(sigma).newton_step))


def normalized(line: OnTheLine, named: Unknowns) -> tuple[Solution, tuple[str, float]]:
    """The solution with a factor that makes the largest of all values 1, and where that is."""
    from scipy.optimize import minimize_scalar

    sigma = line.solution.sigma
    nodes, states = line.at_nodes()
    sizes = np.abs(in_unknowns(named, sigma, nodes, states))
    place, which = np.unravel_index(int(sizes.argmax()), sizes.shape)
    at, steps = nodes[place], line.nodes
    i = int(np.searchsorted(steps, at))
    bracket = steps[max(i - 1, 0)], steps[min(i + 1, len(steps) - 1)]

    def value(z: float) -> complex:
        points = np.array([z])
        return complex(in_unknowns(named, sigma, points, line.right(points))[0, which])

    best = minimize_scalar(
        lambda z: -abs(value(float(z))), bounds=bracket, method="bounded", options={"xatol": POLISHED * (bracket[1] - bracket[0])}
    )
    z = float(best.x) if -best.fun > sizes[place, which] else float(at)
    return line.solution.scaled(1.0 / value(z), 1.0), (named.names[which], z)
