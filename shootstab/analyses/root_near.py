"""The root next to a guess, found by iterations, by a count around it, or from the other side of the continuous spectrum."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from shootstab.analyses.affordable import Affordable, WanderedOff
from shootstab.analyses.multiple import count_in
from shootstab.core.discriminant import Discriminant
from shootstab.core.errors import ConvergenceError
from shootstab.core.regions import Disc
from shootstab.discriminants.continuation import Continuation
from shootstab.discriminants.method import AdaptiveDiscriminant
from shootstab.roots.iterations import LEAST_D_ERROR, Root, muller, newton
from shootstab.roots.search import moments
from shootstab.roots.separation import neutral, surroundings

COUNTED_AROUND = (1e-3, 4e-3, 1.6e-2)  # chosen: radii, in |σ|, of circles in which zeros are counted where no iteration arrives at one
ACROSS = 1e-2  # chosen: the farthest mode, in |σ|, that a guess on the other side of the continuous spectrum means


@dataclass(frozen=True)
class SearchFrom:
    """A search for the root next to a guess, by D continued from one side of the continuous spectrum; farthest is the farthest meant."""

    discriminant: AdaptiveDiscriminant
    guess: complex
    tolerance: float
    farthest: float = float("inf")

    def means(self, sigma: complex) -> bool:
        """Whether a mode is near enough to be what the guess means."""
        return abs(sigma - self.guess) <= self.farthest

    def root(self) -> Root:
        """The root. Raises ConvergenceError where none is found."""
        try:
            return find_near(Affordable(self.discriminant, self.guess), self.guess, self.tolerance)
        except ConvergenceError:
            found = counted_near(self.discriminant, self.guess, self.tolerance) or among_noise(self.discriminant, self.guess)
            if found is None:
                raise
            return found


def searches(continuation: Continuation, guess: complex, tolerance: float) -> Iterator[SearchFrom]:
    """Searches by D itself, and next to the continuous spectrum by D continued from its other side: a guess may lie on the wrong one."""
    discriminant, _, side = continuation.along(guess)
    yield SearchFrom(discriminant, guess, tolerance)
    if side != 0 and (other := continuation.across(guess)) is not None:
        yield SearchFrom(other, guess, tolerance, ACROSS * abs(guess))


def find_near(discriminant: Discriminant, guess: complex, tolerance: float) -> Root:
    """Newton from the guess; Muller if that fails.

    Raises ConvergenceError if both do.
    """
    try:
        root = newton(discriminant, guess, tolerance)
    except WanderedOff:
        root = None
    if root is None or not root.converged:
        root = muller(discriminant, guess, tolerance)
    if not root.converged:
        raise ConvergenceError(f"neither Newton nor Muller arrives anywhere from {guess:.6g}; the last step was {root.step:.1e}")
    return root


def counted_near(discriminant: AdaptiveDiscriminant, guess: complex, tolerance: float) -> Root | None:
    """The zero nearest to the guess in the first circle around it that holds any, by its moments (see roots.search); None without one.

    Where D varies like e^{gσ}, as between far walls, iterations arrive from within 1/|g| only; a count does not see such a factor.
    """
    for size in COUNTED_AROUND if guess != 0 else ():
        disc = Disc(guess, size * abs(guess))
        try:
            counted = count_in(discriminant.around(guess, disc.radius), disc)
        except ConvergenceError:
            return None  # D is noise, or too steep for so wide a circle
        if counted.count > 0:
            root = newton(discriminant, min(moments(counted)[1], key=lambda zero: abs(zero - guess)), tolerance)
            return root if root.converged and disc.contains(root.sigma) else None
    return None


def among_noise(discriminant: Discriminant, guess: complex) -> Root | None:
    """Zeros so near to the guess that iterations find noise only: as many as are seen from afar, to be counted; None for fewer than two."""
    around = surroundings(discriminant, guess)
    if around.multiplicity < 2:
        return None
    return Root(guess, max(abs(guess), neutral(around, LEAST_D_ERROR)), 0, True, around.multiplicity)
