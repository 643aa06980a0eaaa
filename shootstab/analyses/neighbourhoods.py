"""What is known around every claim: the zeros seen there, and the modes that they are, each with its error bar.

A neighbourhood belongs to its claim alone, so that claims may be shared out among processes.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial

from shootstab.analyses.sighting import Sighting
from shootstab.analyses.verifier import Verifier
from shootstab.analyses.workers import parcel, spread
from shootstab.core.errors import ConvergenceError
from shootstab.core.records import Mode
from shootstab.roots.search import Zero

CONFUSED_WITHIN = 3.0  # chosen: radii of the circle of the digits within which zeros are told apart together
WIDER_THAN_CONFUSED = 2.0  # chosen: a circle around zeros that were confused, in the largest distance from their mean
SAME_AS = 1e-12  # chosen: relative distance of two modes that are one, beside their error bounds
CLAIMS_TOGETHER = 4  # chosen: neighbouring claims that are judged one after the other by one process, on meshes that they share

ClaimBlock = tuple[tuple[int, complex], ...]  # claims with their places in the list


@dataclass(frozen=True)
class Neighbourhood:
    """A claim as it was seen, the modes that zeros around it are, and why one of the zeros has no error bound."""

    seen: Sighting
    modes: Mapping[Zero, tuple[Mode, ...]] = field(default_factory=dict)
    lost: str | None = None


def neighbourhoods(
    verifier: Verifier, claims: Sequence[complex], workers: int | None, cluster: str | None, done: Callable[[], None]
) -> dict[int, Neighbourhood]:
    """The neighbourhood of every claim, by its place in the list; done is called after each.

    They are gone through by |σ|: neighbours share meshes, which are not kept for ever, and in one order, whatever the list's, a mode is
    refined from the same place.
    """
    order = sorted(range(len(claims)), key=lambda i: (abs(claims[i]), claims[i].real, claims[i].imag))
    blocks = [tuple((i, claims[i]) for i in order[k : k + CLAIMS_TOGETHER]) for k in range(0, len(order), CLAIMS_TOGETHER)]
    found: dict[int, Neighbourhood] = {}
    here = partial(_around_each, verifier)
    with closing(spread(here, lambda: partial(_around_sent, parcel(*verifier.settings)), blocks, workers, cluster)) as results:
        for block, (around, farthest) in results:
            verifier.reach_no_farther(farthest)
            for (i, _), one in zip(block, around, strict=True):
                found[i] = one
                done()
    return {i: found[i] for i in order}


def _around_each(verifier: Verifier, block: ClaimBlock) -> tuple[list[Neighbourhood], float]:
    """The neighbourhoods of a block, and the largest |σ| that can be judged as far as that is known by then."""
    return [neighbourhood(verifier, claim) for _, claim in block], verifier.farthest


def _around_sent(settings: bytes, block: ClaimBlock) -> tuple[list[Neighbourhood], float]:
    """The same in another process."""
    return _around_each(_verifier_of(settings), block)


@lru_cache(maxsize=1)
def _verifier_of(settings: bytes) -> Verifier:
    return Verifier(*pickle.loads(settings))


def neighbourhood(verifier: Verifier, claim: complex) -> Neighbourhood:
    """The nearest zero around a claim, and those that the claim may mean as well."""
    seen = verifier.look(claim)
    if not seen.zeros:
        return Neighbourhood(seen)
    nearest = min(seen.zeros, key=lambda zero: abs(zero.sigma - claim))
    reach = max(CONFUSED_WITHIN * seen.radius, abs(nearest.sigma - claim) + CONFUSED_WITHIN * seen.radius)
    meant = [z for z in seen.zeros if z is nearest or abs(z.sigma - claim) <= reach + z.radius]
    return with_modes(verifier, Neighbourhood(seen), meant)


def with_modes(verifier: Verifier, around: Neighbourhood, zeros: Sequence[Zero]) -> Neighbourhood:
    """The neighbourhood with the modes that these zeros are; those close to each other together, as iterations confuse them."""
    left = list(zeros)
    while left:
        near = [z for z in left if abs(z.sigma - left[0].sigma) <= CONFUSED_WITHIN * around.seen.radius + z.radius + left[0].radius]
        left = [z for z in left if z not in near]
        around = _with_mode(verifier, around, _together(near))
    known: list[Mode] = []
    for mode in (mode for some in around.modes.values() for mode in some):
        if not any(same(mode, other) for other in known):
            known.append(mode)
    if around.lost is not None and len(zeros) > 1:  # those that the loose mesh tells apart may be one on another
        whole = _with_mode(verifier, replace(around, modes={}, lost=None), _together(zeros))
        return around if whole.lost is not None else whole
    if around.lost is None and sum(m.multiplicity for m in known) < sum(z.multiplicity for z in zeros):
        return _with_mode(verifier, around, _together(zeros))  # iterations from several of them came to one mode
    return around


def _with_mode(verifier: Verifier, around: Neighbourhood, zero: Zero) -> Neighbourhood:
    """The neighbourhood with the modes that a zero is."""
    if zero in around.modes or around.lost is not None:
        return around
    try:
        return replace(around, modes={**around.modes, zero: tuple(verifier.modes(zero, around.seen))})
    except ConvergenceError as error:
        return replace(around, lost=str(error))


def same(mode: Mode, other: Mode) -> bool:
    """Whether two modes lie within each other's bounds."""
    return bool(abs(mode.sigma - other.sigma) <= mode.error + other.error + SAME_AS * abs(other.sigma))


def _together(zeros: Sequence[Zero]) -> Zero:
    """Several zeros as one multiple zero about their mean."""
    if len(zeros) == 1:
        return zeros[0]
    count = sum(z.multiplicity for z in zeros)
    mean = sum(z.multiplicity * z.sigma for z in zeros) / count
    return Zero(mean, count, WIDER_THAN_CONFUSED * max(abs(z.sigma - mean) + z.radius for z in zeros))
