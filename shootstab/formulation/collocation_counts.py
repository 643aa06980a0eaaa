"""How many coefficients each unknown has in a collocation, and at how many points each equation holds.

Unknown u_j has N + d_j coefficients and equation i holds at N + c_i points; conditions make up the difference. With S_ij the highest
derivative of u_j in equation i, the integers are the smallest with

    d_j − c_i ≥ S_ij, and equality on n entries, one in each row and column, whose sum is largest,

so that Σ d_j − Σ c_i is the number of conditions: in the Navier–Stokes equations the pressure has one coefficient fewer than the
velocities, and continuity holds at one point more than momentum. At an end that is singular, or at infinity, functions of the basis obey
by themselves what singles out the solutions that are wanted: no condition stands there, and the unknowns have as many coefficients fewer.

Source: J. D. Pryce, BIT 41 (2001) 364 (c and d).
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import linear_sum_assignment

from shootstab.core.errors import InputError
from shootstab.formulation.system import System

MINUS_INFINITY = -1000.0  # chosen: stands for −∞ in S

ADVICE = "allowed is a file of eigenvalues"
Counts = tuple[tuple[int, ...], tuple[int, ...]]  # d, c


def counts(system: System) -> Counts:
    """d, of the unknowns, and c, of the equations. Raises InputError where they cannot be paired so that each holds its own unknown."""
    unknowns = system.unknowns
    S = np.full((len(unknowns), len(unknowns)), MINUS_INFINITY)
    for i, row in enumerate(system.rows):
        for name, order in row:
            S[i, unknowns.index(name)] = max(S[i, unknowns.index(name)], order)
    _, chosen = linear_sum_assignment(-S)
    if S[np.arange(len(S)), chosen].min() < 0:
        told = f"{', '.join(system.names)} cannot be paired with {', '.join(unknowns)} so that each holds its own"
        raise InputError(f"no collocation of the equations as they stand: {told}: {ADVICE}")
    c = np.zeros(len(S))
    d = S.max(axis=0)
    for _ in range(int(S.max() + 2) * len(S) + 1):
        d = (S + c[:, None]).max(axis=0)
        following = d[chosen] - S[np.arange(len(S)), chosen]
        if (following == c).all():
            break
        c = following
    return tuple(int(x) for x in d), tuple(int(x) for x in c)


def conditions_needed(found: Counts) -> int:
    """Σ d_j − Σ c_i."""
    return sum(found[0]) - sum(found[1])


def without(found: Counts, fewer: int) -> Counts:
    """The counts with so many coefficients fewer, one at a time from the unknown that has most."""
    d, c = list(found[0]), found[1]
    for _ in range(fewer):
        d[int(np.argmax(d))] -= 1
    return tuple(d), c
