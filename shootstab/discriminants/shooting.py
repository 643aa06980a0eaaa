"""D(σ) on a mesh: what is common to every method that carries the decaying space from the far field to the wall."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from shootstab.core.discriminant import Value
from shootstab.core.scaled import EPSILON, Scaled
from shootstab.discriminants.mesh import halved, moved, partly_halved
from shootstab.discriminants.method import Propagation, Propagator
from shootstab.discriminants.perturbed_pencil import PerturbedPencil, solved_with
from shootstab.discriminants.sampled_system import SampledSystem, mixed, sample_system
from shootstab.discriminants.zero_gradient import CarriedFrames, Ingredients, ZeroGradient, zero_gradient
from shootstab.problems.capabilities import PLACEMENTS, RECORDED
from shootstab.problems.protocol import ComplexArray, FarFrame, Problem

KEPT = 8  # chosen: evaluations: those of a circle that was asked whether its mesh serves it are asked for again
FAR_SHARE = 1e-3  # chosen: the error that the far frame may have, in the tolerance on local errors: no step shall wait for it
FAR_FINEST = 1e-14  # chosen: the error of a far field that costs little, whatever the tolerance
MESH_SLACK = 4.0  # chosen: factor by which local errors may miss their tolerance at another σ than the one that the mesh was made for
FAR_SLACK = 10.0  # chosen: factor by which a far frame may miss its tolerance at a σ next to the one that the mesh was made for


def far_tolerance(rtol: float) -> float:
    """The relative error that a far frame is asked for."""
    return min(FAR_SHARE * rtol, FAR_FINEST)


class Shooting:
    """D(σ) = det[(W0 + σW1) Y(wall; σ)], Y (n, k) the decaying space, given by the far frame where the mesh begins.

    The mesh and what is chosen on it stay, so that D is analytic to rounding. What is kept changes how long an answer takes, and no answer.
    noise is the local error of rounding, or of noise in the coefficients, that no shorter step takes away: less is not asked of the mesh.
    """

    def __init__(
        self,
        problem: Problem,
        propagator: Propagator,
        sampled: SampledSystem,
        start: Callable[[FarFrame], FarFrame] = lambda far: far,
        noise: float = 0.0,
    ) -> None:
        self.problem, self.propagator, self.sampled, self._start, self.noise = problem, propagator, sampled, start, noise
        self.evaluations = 0
        self._rows = problem.wall_rows()
        self._known: OrderedDict[tuple[complex, bool], tuple[Propagation, float]] = OrderedDict()
        self._way: tuple[complex, CarriedFrames] | None = None
        self._systems: dict[tuple[Problem, bool, int | None], SampledSystem] = {}
        self._perturbed: dict[tuple[int, float], SampledSystem] = {}
        self._mixed: dict[tuple[int, complex], SampledSystem] = {}

    def __call__(self, sigma: complex) -> Scaled:
        return self.propagated(complex(sigma), False).value.D

    def with_derivative(self, sigma: complex) -> Value:
        return self.propagated(complex(sigma), True).value

    def propagated(self, sigma: complex, tangent: bool) -> Propagation:
        """D(σ) with the local errors of its steps."""
        return self._evaluated(sigma, tangent)[0]

    @property
    def tolerance(self) -> float:
        """What local errors are held to: the tolerance of the method, or the noise where that is larger."""
        return max(self.propagator.rtol, self.noise)

    def allowing(self, noise: float) -> Shooting:
        """D(σ) on the same mesh, of which no less than this noise is asked."""
        return self if noise <= self.noise else Shooting(self.problem, self.propagator, self.sampled, self._start, noise)

    def serves(self, sigma: complex, tangent: bool = True) -> bool:
        propagation, far_error = self._evaluated(complex(sigma), tangent)
        holds = bool((propagation.errors <= MESH_SLACK * self.tolerance).all())
        return propagation.sound and holds and self._far_serves(sigma, far_error)

    def _far_serves(self, sigma: complex, error: float) -> bool:
        """Whether the far frame is as good as it is asked to be, or as good as the problem has one: then the error bound says it."""
        asked = far_tolerance(self.propagator.rtol)
        if error <= FAR_SLACK * asked:
            return True
        first, last = self.sampled.nodes[[0, -1]].real
        return bool((self.problem.start(complex(sigma), asked) - first) * (first - last) <= 0.0)

    def refined(self, seed: int | None = None, problem: Problem | None = None) -> Shooting:
        """D(σ), of another problem if one is given, on a mesh with every step halved: the difference is the error of this one.

        With a seed the steps are cut a little off their middle: what differs from the halved mesh is the rounding of mesh and samples.
        """
        problem = self.problem if problem is None else problem
        return self._variant(lambda far: far, self._system(problem, True, seed), problem)

    def partly_refined(self, digit: int, sigma: complex) -> Shooting:
        """D(σ) on a mesh with half of the steps halved: those whose rank by local error at σ has a 0 as this binary digit.

        So the two largest steps are parted by digit 0, the four largest from each other by digits 0 and 1.
        """
        key = (digit, complex(sigma))
        if key not in self._mixed:
            ranks = np.argsort(np.argsort(-self.propagated(complex(sigma), True).errors, kind="stable"))
            fine = self._system(self.problem, True, None)
            self._mixed[key] = mixed(self.problem, partly_halved(self.sampled.nodes, (ranks >> digit) % 2 == 0), self.sampled, fine)
        return self._variant(lambda far: far, self._mixed[key], self.problem)

    def at_other_points(self, seed: int) -> Shooting:
        """D(σ) on a mesh with its nodes moved by so little that only mesh and samples round otherwise."""
        return self._variant(lambda far: far, sample_system(self.problem, moved(self.sampled.nodes, seed)), self.problem)

    def with_rotated_basis(self, seed: int) -> Shooting:
        """D(σ) from the far frame with its columns in another order and with other factors, of product 1, at random.

        They are not mixed: columns of very different size would be spoilt by that, and not by the method. In a real system a real frame
        stays so: its columns change in size, and those of others in phase; so do columns with one component, which a factor leaves the same
        to the last bit once they are normalized. One column has no other basis: its components are changed by a rounding.
        """
        k = self.problem.decaying
        if k == 1:
            return self.with_perturbed_start(seed, EPSILON)
        order = np.random.default_rng(seed).permutation(k)

        def rotated(far: FarFrame) -> FarFrame:
            real = self.sampled.real is not None and not (far.frame.imag.any() or far.tangent.imag.any())
            real = real and bool((np.count_nonzero(far.frame, axis=0) > 1).all())
            basis = np.eye(k)[order] * (np.random.default_rng(seed).uniform(1.0, 2.0, k) if real else _random(seed, k))
            basis[:, 0] /= np.linalg.det(basis)
            return replace(far, frame=far.frame @ basis, tangent=far.tangent @ basis)

        return self._variant(rotated, self.sampled, self.problem)

    def with_perturbed_start(self, seed: int, size: float, real: bool = False) -> Shooting:
        """D(σ) from a far frame with every component changed by a random relative amount of this size, of random phase or real."""
        draws = _random(seed, self.problem.size, self.problem.decaying)
        noise = 1 + size * (np.sign(draws.real) if real else draws)
        return self._variant(lambda far: replace(far, frame=far.frame * noise), self.sampled, self.problem)

    def with_perturbed_system(self, seed: int, size: float) -> Shooting:
        """D(σ) with every entry of the sampled system, and z, changed by random relative amounts of this size.

        Where C has to be solved with, every entry of C and D is changed besides; a pencil recorded with pivots of its own is a formula for
        C⁻¹D.
        """
        if (seed, size) not in self._perturbed:
            sampled = self.sampled
            if self._solved_with:
                sampled = sample_system(PerturbedPencil(self.problem, seed, size), self.sampled.nodes)
            self._perturbed[seed, size] = sampled.perturbed(seed, size, self._places)
        return self._variant(self._start, self._perturbed[seed, size], self.problem)

    @cached_property
    def _solved_with(self) -> bool:
        """Whether entries of C and D round apart from those of the system: a pencil recorded with pivots of its own is a formula."""
        recorded = RECORDED.of(self.problem)
        return (recorded is None or recorded.constant_pivots) and solved_with(self.problem, self.sampled.nodes)

    @cached_property
    def _places(self) -> NDArray[np.float64]:
        """|z| (N,) of the steps, the largest of those that the problem is put together from."""
        at = np.abs(self.sampled.nodes[:-1])
        return np.asarray(np.max([at, *(abs(part.offset) + abs(part.scale) * at for part in PLACEMENTS.of(self.problem))], axis=0))

    def on_same_mesh(self, problem: Problem) -> Shooting:
        """D(σ) of another problem, on the same mesh."""
        return self._variant(lambda far: far, self._system(problem, False, None), problem)

    def vanishing_at(self, sigma: complex) -> Shooting:
        """Itself: it has no subsystems."""
        return self

    def local_errors(self, sigma: complex) -> NDArray[np.float64]:
        """The local errors of all steps at σ, (m,), from the values of D with derivative."""
        return np.asarray(self.propagated(complex(sigma), True).errors, dtype=np.float64)

    def far_error(self, sigma: complex) -> float:
        """The relative error of the far-field frame at σ."""
        return self.far(complex(sigma)).error

    @property
    def steps(self) -> int:
        """How many steps the mesh has."""
        return len(self.sampled.nodes) - 1

    def ingredients(self, sigma: complex) -> Ingredients:
        """What D is made of at σ."""
        return Ingredients(self.sampled, self._rows, self.far(complex(sigma)), None if self._solved_with else self._places)

    def gradient(self, sigma: complex) -> ZeroGradient | None:
        """What the zero next to σ depends on; None where the method cannot tell."""
        sigma = complex(sigma)
        if self._way is None or self._way[0] != sigma:
            self._known.pop((sigma, True), None)
            self.propagated(sigma, True)
        return None if self._way is None else zero_gradient(self.ingredients(sigma), sigma, self._way[1])

    def system_at(self, sigma: complex) -> str:
        """What is integrated at σ, in words."""
        return f"order {self.problem.size} in {'real' if self.real_at(sigma) else 'complex'} numbers"

    def real_at(self, sigma: complex) -> bool:
        """Whether the system is real at σ."""
        return complex(sigma).imag == 0.0 and self.sampled.real is not None

    def _variant(self, start: Callable[[FarFrame], FarFrame], sampled: SampledSystem, problem: Problem) -> Shooting:
        """D(σ) on a given mesh, from a far frame changed on the way."""
        return Shooting(problem, self.propagator, sampled, start, self.noise)

    def _system(self, problem: Problem, halve: bool, seed: int | None) -> SampledSystem:
        """A problem sampled on the mesh, or on the halved one: made once."""
        if problem is self.problem and not halve:
            return self.sampled
        key = (problem, halve, seed)
        if key not in self._systems:
            self._systems[key] = sample_system(problem, halved(self.sampled.nodes, seed) if halve else self.sampled.nodes)
        return self._systems[key]

    def _evaluated(self, sigma: complex, tangent: bool) -> tuple[Propagation, float]:
        """D(σ) and the error of the far frame; with a derivative it rounds otherwise than without, so that both are kept apart."""
        known = self._known.get((sigma, tangent))
        if known is None:
            far = self.far(sigma)
            self.evaluations += 1
            propagation = self.propagator.propagate(self.sampled, self._rows, far, sigma, tangent)
            if propagation.way is not None:  # long arrays: only the latest are kept
                self._way, propagation = (sigma, propagation.way), replace(propagation, way=None)
            known = propagation, far.error
            self._known[sigma, tangent] = known
            if len(self._known) > KEPT:
                self._known.popitem(last=False)
        return known

    def far(self, sigma: complex) -> FarFrame:
        """The frame that the integration begins with at σ."""
        return self._start(self.problem.far_frame(float(self.sampled.nodes[0].real), sigma))


def _random(seed: int, *shape: int) -> ComplexArray:
    """Complex numbers of modulus 1."""
    return np.asarray(np.exp(2j * np.pi * np.random.default_rng(seed).random(shape)))
