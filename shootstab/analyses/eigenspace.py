"""All solutions that belong to a mode, simple or multiple, and the chain of one that has fewer solutions than its multiplicity.

With E(σ) = B Q_N the boundary matrix (see discriminants/back_substitution.py), the solutions at a zero σ0 of D = det E, but for a factor,
are the kernel of E(σ0). Its dimension g is the geometric multiplicity, the order m of the zero the algebraic one. g = m is a semisimple
mode; for g < m, a defective one, there are chains φ_0, φ_1, …, the coefficients of the Taylor series of a root function φ(σ), which solves
the equations for every σ, and the conditions at the wall but for a remainder with a zero of the length of the chain:

    C0 φ_j′ + σ0 C1 φ_j′ − (D0 + σ0 D1) φ_j = D1 φ_{j−1} − C1 φ_{j−1}′,    φ_{−1} = 0,    for a pencil affine in σ.

Source: V. A. Kozlov & V. G. Maz'ya, Differential Equations with Operator Coefficients (1999), appendix A; I. Gohberg & E. I. Sigal, Math.
USSR Sbornik 13 (1971) 603. A singular value of E belongs to the kernel where it grows with the distance from the mode. For g = 1 the root
function is the solution of the bordered problem, and its coefficients are means over a circle.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shootstab.analyses.condition import Conditioning, joint_conditioning
from shootstab.analyses.eigenfunction_budget import Variants, cardinal_places
from shootstab.analyses.eigenfunction_double import OF_A_FUNCTION, Eigenfunction, eigenfunction_double, eigenfunction_on, normalized
from shootstab.analyses.jordan_chain import ChainFunction, chain_of
from shootstab.analyses.multiple import count_in
from shootstab.analyses.on_the_line import OnTheLine, in_unknowns
from shootstab.analyses.refine import refine
from shootstab.analyses.refine_double import tolerance_for
from shootstab.core.allowed import RTOL
from shootstab.core.errors import ConvergenceError
from shootstab.core.records import Mode
from shootstab.core.regions import Disc
from shootstab.discriminants.back_substitution import BoundaryMatrix, Solution
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.product import Product
from shootstab.discriminants.shooting import Shooting
from shootstab.problems.protocol import Problem
from shootstab.problems.unknowns import Unknowns, unknowns
from shootstab.roots.separation import separation

FARTHER_OUT = 10.0  # chosen: the distance from a mode at which singular values are seen to have grown, in how far its zeros may lie from it
GROWN = 3.0  # chosen: how many times as large such a value is there at least; another one has hardly grown
NO_CONDITION = Conditioning(math.inf, math.inf, math.inf)  # derived: a change ε moves the zeros of a defective mode by a root of ε


@dataclass(frozen=True, eq=False)
class Eigenspace:
    """basis: g eigenfunctions that span all solutions at the mode, as (unknown, z) → value 1 of each and 0 of the others.

    chain: φ_1, φ_2, … of a defective mode with g = 1, which are 0 where φ_0 = basis[0] is 1; empty for any other.
    """

    mode: Mode
    basis: tuple[Eigenfunction, ...]
    chain: tuple[ChainFunction, ...] = ()

    def __repr__(self) -> str:
        return f"Eigenspace({self.structure}, at {complex(self.mode.sigma)})"

    @property
    def geometric_multiplicity(self) -> int:
        """How many independent solutions there are."""
        return len(self.basis)

    @property
    def algebraic_multiplicity(self) -> int:
        """How many zeros of D the mode stands for, with multiplicity."""
        return self.mode.multiplicity

    @property
    def error(self) -> float:
        """The largest error of a function of the basis."""
        return max(f.error for f in self.basis)

    @property
    def structure(self) -> str:
        """What kind of mode it is, in words."""
        m, g = self.algebraic_multiplicity, self.geometric_multiplicity
        if m == 1:
            return "simple"
        kind = "semisimple" if g == m else "defective"
        return f"{kind}: geometric multiplicity {g}, algebraic {m}"


def eigenspace(
    problem: Problem, mode: Mode | complex, rtol: float = RTOL, progress: Callable[[int, int], None] | None = None
) -> Eigenspace:
    """All solutions that belong to a mode, or to the one next to a guess, along the real line, to the accuracy of eigenfunction_double.

    Zeros of D that are not told apart count as one mode: what is said of it holds for all problems as far from this one as the error of the
    mode says. Raises InputError for a mode that did not converge, ConvergenceError where the real line passes too near to a singular point,
    or D is too inaccurate on this mesh to show the structure.
    """
    found = mode if isinstance(mode, Mode) else refine(problem, mode, rtol)
    if not found.converged or found.multiplicity == 1:
        return Eigenspace(found, (eigenfunction_double(problem, found, rtol, progress),))
    whole = Frame(rtol=tolerance_for(OF_A_FUNCTION * rtol)).on(problem).at(complex(found.sigma))
    members = whole.members if isinstance(whole, Product) else (whole,)
    parts = [_of_subsystem(problem, found, member, progress) for member in members]
    told = tuple(f for part in parts for f in part.basis)
    chains = [part.chain for part in parts if part.basis]
    if not told:
        raise ConvergenceError(f"no solution is seen at {complex(found.sigma):.12g}: take a smaller rtol")
    return Eigenspace(found, told, chains[0] if len(chains) == 1 else ())


def _of_subsystem(problem: Problem, mode: Mode, coarse: Shooting, progress: Callable[[int, int], None] | None) -> Eigenspace:
    """The solutions at a multiple mode that a subsystem has; none where it has no zero there."""
    sigma, error = complex(mode.sigma), float(mode.error)
    order = count_in(coarse, Disc(sigma, error)).count
    if order == 0:
        return Eigenspace(mode, ())
    fine, named = coarse.refined(), unknowns(problem)
    if order == 1:  # another subsystem has the other zeros, and this one knows its own
        alone = replace(mode, scale=separation(fine, fine.with_derivative(sigma)))
        return Eigenspace(mode, (replace(eigenfunction_on(problem, alone, coarse, fine, progress), mode=mode),))
    at_mode = BoundaryMatrix.of(fine, sigma)
    kernel = _dimension(fine, at_mode, error)
    if not 1 <= kernel <= order:
        raise ConvergenceError(f"{kernel} solutions are seen at {sigma:.12g}, where D has {order} zeros: take another rtol")
    solutions, peaks = _cardinal(problem, named, at_mode.solutions(kernel))
    conditions = (NO_CONDITION,) * kernel
    if kernel == order:
        slopes = np.array([[left.change_per_sigma_of(right) for right in solutions] for left in solutions])
        solutions = tuple(_summed(solutions, i, row, "chi", "wall") for i, row in enumerate(np.linalg.inv(slopes)))
        conditions = joint_conditioning(solutions)
    budget = Variants(problem, coarse, fine, named, mode, kernel).budget(progress)
    basis = tuple(
        Eigenfunction(mode, problem, OnTheLine(problem, solved), peak, budget, condition, tuple(other for other in peaks if other != peak))
        for solved, peak, condition in zip(solutions, peaks, conditions, strict=True)
    )
    return Eigenspace(mode, basis, chain_of(basis[0], coarse, fine, order) if kernel == 1 < order else ())


def _dimension(shooting: Shooting, at_mode: BoundaryMatrix, error: float) -> int:
    """How many singular values of E grow with the distance from the mode, the smallest ones, in whatever direction."""
    here = at_mode.singular_values
    there = [BoundaryMatrix.of(shooting, at_mode.sigma + turn * FARTHER_OUT * error).singular_values for turn in (1.0, 1j)]
    grown = np.all([farther > GROWN * here for farther in there], axis=0)
    return int(np.argmin([*grown, False]))


def _cardinal(
    problem: Problem, named: Unknowns, solutions: Sequence[Solution]
) -> tuple[tuple[Solution, ...], tuple[tuple[str, float], ...]]:
    """The basis in which each function is 1 at one place, (unknown, z), and the others are 0, and these places."""
    if len(solutions) == 1:
        solved, peak = normalized(OnTheLine(problem, solutions[0]), named)
        return (solved,), (peak,)
    lines = [OnTheLine(problem, solved).at_nodes() for solved in solutions]
    z = lines[0][0]
    values = np.array([in_unknowns(named, solutions[0].sigma, z, states) for _, states in lines])
    places = cardinal_places(values)
    turned = np.linalg.inv(values.reshape(len(values), -1)[:, places])
    where = [divmod(int(place), values.shape[2]) for place in places]
    cardinal = tuple(_summed(solutions, i, row, "phi", "coefficients") for i, row in enumerate(turned))
    return cardinal, tuple((named.names[which], float(z[node])) for node, which in where)


def _summed(solutions: Sequence[Solution], place: int, row: NDArray[np.complex128], *names: str) -> Solution:
    """The solution at this place, with the sum of all times the entries of the row in the arrays of these names."""
    arrays: dict[str, Any] = {name: np.tensordot(row, [getattr(one, name) for one in solutions], 1) for name in names}
    return replace(solutions[place], **arrays)
