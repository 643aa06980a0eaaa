"""A problem whose pencil has every entry changed by random relative amounts: what elimination makes of a rounding of C and D.

A sampled system holds C⁻¹D. Where C is the identity a rounding of D is one of that, entry by entry; where C has to be solved with, it is
larger by the condition of C, and only the entries of C and D themselves can be changed by a rounding.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shootstab.problems.capabilities import RECORDED
from shootstab.problems.protocol import ComplexArray, Pencil, PencilSource
from shootstab.problems.recorded_pencil import RecordedPencil


@dataclass(frozen=True, eq=False)
class PerturbedPencil:
    """A PencilSource made of another, changed by relative amounts up to this one."""

    problem: PencilSource
    seed: int
    amount: float

    @property
    def size(self) -> int:
        return self.problem.size

    @property
    def recorded(self) -> RecordedPencil | None:
        """The perturbed pencil of a recorded one, whose known numbers are not rounded and stay."""
        known: RecordedPencil | None = RECORDED.of(self.problem)
        return None if known is None else known.perturbed(self.seed, self.amount)

    def pencil(self, z: ComplexArray) -> Pencil:
        """C and D at z (m,), real and imaginary parts changed apart, so that what is real stays so, and what is zero."""
        random = np.random.default_rng(self.seed)

        def changed(M: ComplexArray) -> ComplexArray:
            re, im = (x * (1.0 + self.amount * random.uniform(-1.0, 1.0, x.shape)) for x in (M.real, M.imag))
            return np.asarray(re + 1j * im)

        return self.problem.pencil(z).each(changed)


def solved_with(problem: PencilSource, z: ComplexArray) -> bool:
    """Whether C is another matrix than the identity at one of the points z (m,)."""
    pencil = problem.pencil(z)
    return bool((np.eye(problem.size) != pencil.C0).any() or any(C.any() for C in pencil.C[1:]))
