"""Where the mode nearest to a claim lies that is none, as far as modes are known, and how far the continuous spectrum is."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from shootstab.analyses import reference
from shootstab.analyses.refine_double import refine_double
from shootstab.core.errors import ShootstabError
from shootstab.core.records import SPURIOUS, Mode, Verdict
from shootstab.problems.protocol import Problem

STARTS = 3  # chosen: claims from which a mode is looked for where none is known; each costs about a verdict
START_DIGITS = 6  # chosen: digits of the reference, whose values are starts only
NEIGHBOUR_RTOL = 1e-6  # chosen: the accuracy of such a mode, the six figures that are told of it


def with_nearest(problem: Problem, verdicts: Sequence[Verdict], missing: Sequence[Mode]) -> list[Verdict]:
    """The verdicts; every spurious one says where the nearest mode known is and how far the continuous spectrum.

    Known are the modes of other claims and those that are missing; if there are none, a few modes are looked for, from the values of the
    bundled reference that lie nearest to claims, or from the claims themselves.
    """
    modes = [complex(v.sigma) for v in verdicts if v.sigma is not None] + [complex(m.sigma) for m in missing]
    lost = [v for v in verdicts if v.verdict == SPURIOUS]
    if not modes:
        modes = _iterated(problem, _starts(problem, [v.claimed for v in lost]))
    known = np.array(modes, dtype=np.complex128)
    return [_told(v, known) if v.verdict == SPURIOUS else v for v in verdicts]


def _told(verdict: Verdict, modes: NDArray[np.complex128]) -> Verdict:
    why = verdict.why
    if len(modes):
        nearest = modes[np.abs(modes - verdict.claimed).argmin()]
        why += f"; the nearest mode known here is {nearest:.6g}, {abs(nearest - verdict.claimed):.1e} away"
    if math.isfinite(verdict.continuum_distance):
        why += f"; the continuous spectrum is {verdict.continuum_distance:.1e} away"
    return replace(verdict, why=why)


def _starts(problem: Problem, claims: Sequence[complex]) -> list[complex]:
    """Where modes are looked for, from the smallest claim to the largest."""
    ordered = sorted(dict.fromkeys(claims), key=abs)
    ordered = ordered[:: max(1, math.ceil(len(ordered) / STARTS))]
    values = reference.eigenvalues(problem, START_DIGITS)
    return list(dict.fromkeys(complex(values[np.abs(values - claim).argmin()]) for claim in ordered)) if len(values) else ordered


def _iterated(problem: Problem, starts: Sequence[complex]) -> list[complex]:
    """The modes to which iterations come."""
    found = []
    for start in starts:
        try:
            mode = refine_double(problem, start, NEIGHBOUR_RTOL)
        except ShootstabError:
            continue
        if mode.converged:
            found.append(complex(mode.sigma))
    return found
