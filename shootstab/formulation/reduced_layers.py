"""The first-order systems of the layers that interfaces divide a domain into: all with the same states."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import InputError
from shootstab.formulation.continuous_spectrum import InteriorSpectrum, interior_spectrum
from shootstab.formulation.domain import Domain
from shootstab.formulation.evaluation import filled, on_arrays
from shootstab.formulation.first_order import FirstOrder, first_order
from shootstab.formulation.layers import Layer
from shootstab.formulation.state_pencil import StatePencil, state_pencil
from shootstab.formulation.system import shown
from shootstab.problems.protocol import ComplexArray


@dataclass(frozen=True, eq=False)
class ReducedLayer:
    """What the reduction made of one layer."""

    first_order: FirstOrder
    spectrum_inside: InteriorSpectrum
    domain: Domain

    @property
    def states(self) -> StatePencil:
        """The system by powers of σ, without conditions."""
        return state_pencil(self.first_order, [], [])


def reduced_layers(layers: Sequence[Layer]) -> tuple[ReducedLayer, ...]:
    """Raises InputError, as the reduction does, and where layers have different states."""
    out = []
    for layer in layers:
        first = first_order(layer.system, layer.domain.vanishing, layer.domain.regular)
        out.append(ReducedLayer(first, interior_spectrum(first, layer.domain, layer.names), layer.domain))
    for layer, reduced in zip(layers, out, strict=True):
        if reduced.first_order.states != out[0].first_order.states:
            told = " and ".join(", ".join(map(shown, r.first_order.states)) for r in (out[0], reduced))
            raise InputError(
                f"the states are {told} in different layers (to {layer.domain.right:g}): allowed are equations of one form in all"
            )
    return tuple(out)


def curves_along(layers: Sequence[ReducedLayer], lines: Sequence[ComplexArray]) -> tuple[tuple[NDArray[np.float64], ComplexArray], ...]:
    """The curves (z, σ_c(z)), each (m,), on which C is singular along lines (m,) of points z that lie in one layer each."""
    found = []
    for z in lines:
        middle = z[len(z) // 2].real
        inside = next(layer.spectrum_inside for layer in layers if layer.domain.left < middle < layer.domain.right)
        if inside.curves:
            branches = [inside.curve(z)] if inside.single else inside.branches(z)
            found += [(z.real, np.asarray(branch, dtype=np.complex128)) for branch in branches]
    return tuple(found)


def pencil_of(systems: Sequence[StatePencil], domains: Sequence[Domain]) -> Callable[[ComplexArray], tuple[ComplexArray, ...]]:
    """C0, C1, …, D0, D1, … as a function of z (m,), real or complex; in several layers each holds between its own real ends."""
    if len(systems) == 1:
        return _pencil_in(systems[0], domains[0])
    most = max(len(system.C) for system in systems)
    members = [_pencil_in(system, domain, most) for system, domain in zip(systems, domains, strict=True)]
    joints = [domain.right for domain in domains[:-1]]

    def pencil(z: ComplexArray) -> tuple[ComplexArray, ...]:
        owner = np.searchsorted(joints, z.real)
        n = systems[0].size
        out = tuple(np.zeros((len(z), n, n), dtype=np.complex128) for _ in range(2 * most))
        for j, member in enumerate(members):
            at = owner == j
            if at.any():
                for whole, part in zip(out, member(z[at]), strict=True):
                    whole[at] = part
        return out

    return pencil


def _pencil_in(system: StatePencil, domain: Domain, powers: int = 0) -> Callable[[ComplexArray], tuple[ComplexArray, ...]]:
    """The pencil of a system with as many powers of σ as the system has, or so many."""
    empty: tuple[Any, ...] = ({},) * (max(powers, len(system.C)) - len(system.C))
    parts = (*system.C, *empty, *system.D, *empty)

    def pencil(z: ComplexArray) -> tuple[ComplexArray, ...]:
        at = on_arrays(z, domain.given)
        return tuple(filled(part, (system.size, system.size), z, at) for part in parts)

    return pencil
