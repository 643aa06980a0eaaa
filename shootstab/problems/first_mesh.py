"""A first mesh that sees what the coefficients do: every step is so short that a quartic through five of its points gives the others.

Where a step steps over a bump, all its stages see is the constant next to it; its error is estimated as that of a constant, and no
refinement ever comes back to it. So the coefficients are sampled at COEFFICIENT_SAMPLES points of every subdomain, and a step in which a
quartic through five of its samples misses another one by a part of what the coefficients change by there is halved. A feature that lies
between two samples is not seen: one narrower than 1/COEFFICIENT_SAMPLES of its subdomain, down to where it is 0 to rounding, needs an
interface at its place.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from shootstab.problems.pencil_function import PencilFunction
from shootstab.problems.protocol import ComplexArray
from shootstab.problems.subdomains import Subdomain

COEFFICIENT_SAMPLES = 2000  # chosen: intervals between samples of the coefficients over all subdomains; some milliseconds
FEWEST_SAMPLES = 64  # chosen: samples in one subdomain at least, where these are many
QUARTIC_POINTS = 5  # chosen: points of a step, through which the quartic runs; a step of the pair has 12 stages
QUARTIC_MISS = 0.1  # chosen: the quartic may miss this part of the change of a coefficient over the step: a smooth one is off by 1 %
UNCHANGED = 1e-10  # chosen: less than this part of a coefficient counts as no change of it


def resolving(function: PencilFunction, subdomains: tuple[Subdomain, ...], nodes: NDArray[np.float64]) -> NDArray[np.float64]:
    """The nodes (N+1,), monotone in t, and others between them, so that every step resolves the coefficients of every subdomain."""
    fractions = np.linspace(0.0, 1.0, max(FEWEST_SAMPLES, COEFFICIENT_SAMPLES // len(subdomains)) + 1)
    t = np.interp(fractions, np.linspace(0.0, 1.0, len(nodes)), nodes)
    seen = [_varying(function, subdomain, t) for subdomain in subdomains]
    places = np.rint(np.linspace(0, len(t) - 1, len(nodes))).astype(int).tolist()
    cuts: set[int] = set()
    for entries in seen:
        for first, last in pairwise(places):
            cuts.update(_halvings(entries, first, last))
    added = t[sorted(cuts)]
    whole = np.unique(np.concatenate((nodes, added)))
    return whole if nodes[-1] > nodes[0] else whole[::-1]


def _varying(function: PencilFunction, subdomain: Subdomain, t: NDArray[np.float64]) -> ComplexArray:
    """The entries (m, ·) of the pencil that change over the samples, each in its largest modulus."""
    pencil = function(subdomain.points(t.astype(np.complex128)))
    entries = np.concatenate([M.reshape(len(t), -1) for M in pencil.named.values()], axis=1)
    entries = entries[:, (entries != entries[0]).any(axis=0)]
    return np.asarray(entries / np.abs(entries).max(axis=0))


def _halvings(entries: ComplexArray, first: int, last: int) -> Iterator[int]:
    """The samples between two at which a step has to be cut."""
    if last - first <= QUARTIC_POINTS - 1:
        return
    samples = entries[first : last + 1]
    if _resolved(samples):
        return
    middle = (first + last) // 2
    yield middle
    yield from _halvings(entries, first, middle)
    yield from _halvings(entries, middle, last)


def _resolved(samples: ComplexArray) -> bool:
    """Whether the quartic through five of the samples (m, ·) tells the others."""
    changes = np.abs(samples - samples[0]).max(axis=0)
    if not (changes > UNCHANGED).any():
        return True
    chosen = np.rint(np.linspace(0, len(samples) - 1, QUARTIC_POINTS)).astype(int)
    x = np.linspace(-1.0, 1.0, len(samples))
    powers = np.vander(x, QUARTIC_POINTS)
    through = powers @ np.linalg.solve(powers[chosen], samples[chosen])
    missed = np.abs(through - samples).max(axis=0)
    return bool((missed <= np.maximum(QUARTIC_MISS * changes, UNCHANGED)).all())
