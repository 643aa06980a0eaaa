"""The bundled pseudospectral reference of a problem: the claims that `verify` judges when nobody else's are given."""

from __future__ import annotations

import numpy as np

from shootstab.problems.chute.problem import ChuteProblem
from shootstab.problems.gallery.poiseuille import PlanePoiseuille
from shootstab.problems.protocol import ComplexArray, Problem
from shootstab.spectral import chute, orr_sommerfeld
from shootstab.spectral.qz import Spectrum
from shootstab.vocabulary.errors import InputError

TRUNCATION = 80


def spectrum(problem: Problem, M: int | None = None, filtered: bool = True) -> Spectrum:
    """The spectrum at truncation M (80 by default); filtered against a second truncation 20 % larger, or one raw QZ.

    Raises InputError for a problem that has no bundled reference.
    """
    M = TRUNCATION if M is None else M
    if not 10 <= M <= 1000:
        raise InputError(f"M = {M}: allowed is 10 to 1000")
    if isinstance(problem, ChuteProblem):
        return chute.spectrum(problem.flow, problem.kx, problem.ky, M, filtered=filtered)
    if isinstance(problem, PlanePoiseuille):
        return orr_sommerfeld.spectrum(problem.reynolds, problem.alpha, M, even=problem.half, filtered=filtered)
    raise InputError("this problem has no bundled pseudospectral reference: give a file of eigenvalues")


def claims(problem: Problem, digits: int, M: int | None = None) -> ComplexArray:
    """The eigenvalues (m,) that the reference itself holds to be right to so many digits: their drift is a tenth of the last one."""
    found = spectrum(problem, M)
    return np.asarray(found.eigenvalues[found.drift <= 0.1 * 10.0**-digits * np.abs(found.eigenvalues)])
