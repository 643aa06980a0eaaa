"""The bundled pseudospectral reference of a problem: the claims that `verify` judges when nobody else's are given."""

from __future__ import annotations

import numpy as np

from shootstab.core.allowed import LEAST_TRUNCATION, MOST_TRUNCATION
from shootstab.core.errors import ShootstabError
from shootstab.core.given import require_whole
from shootstab.problems.capabilities import PSEUDOSPECTRAL, Pseudospectral
from shootstab.problems.protocol import ComplexArray, Problem
from shootstab.spectral.qz import Spectrum

TRUNCATION = 80  # chosen: order of a pseudospectral reference, as large as QZ is done with in seconds
DRIFT = 0.1  # chosen: the drift of an eigenvalue that is right to some digits, in a unit of the last of them


def spectrum(problem: Problem, M: int | None = None, filtered: bool = True) -> Spectrum:
    """The spectrum at truncation M (80 by default); filtered against a second truncation 20 % larger, or one raw QZ.

    Raises InputError for a problem that has no bundled reference.
    """
    M = TRUNCATION if M is None else M
    require_whole("M", M, LEAST_TRUNCATION, MOST_TRUNCATION)
    twin: Pseudospectral = PSEUDOSPECTRAL.required(problem)
    found: Spectrum = twin.spectrum(M, filtered)
    return found


def claims(problem: Problem, digits: int, M: int | None = None) -> ComplexArray:
    """The eigenvalues (m,) that the reference itself holds to be 0, or right to so many digits, by a drift below DRIFT of the last one."""
    found = spectrum(problem, M)
    return np.asarray(found.eigenvalues[found.drift <= np.maximum(DRIFT * 10.0**-digits * np.abs(found.eigenvalues), found.rounding)])


def eigenvalues(problem: Problem, digits: int) -> ComplexArray:
    """The eigenvalues (m,) of `claims`; none, (0,), where a problem has no reference, or its reference no spectrum at these parameters."""
    if PSEUDOSPECTRAL.of(problem) is None:
        return np.empty(0, dtype=np.complex128)
    try:
        return claims(problem, digits)
    except ShootstabError:
        return np.empty(0, dtype=np.complex128)
