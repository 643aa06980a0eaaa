"""The problem in balls: by its own formulation or its closed form, whole or in factors of D."""

from __future__ import annotations

from shootstab.multiprecision.closed_form_enclosure import ClosedFormEnclosable
from shootstab.multiprecision.enclosable import Enclosable
from shootstab.multiprecision.enclosure import BetweenEnds
from shootstab.problems.capabilities import CLOSED_FORM, ENCLOSABLE, FACTORS
from shootstab.problems.protocol import Problem

POLYNOMIAL_POINTS = 48  # chosen: values of D that a circle may take where a rectangle is one polynomial, which takes some hundreds


def whole(problem: Problem) -> Enclosable:
    """The problem in balls: by its own formulation, or by its closed form. Raises InputError where it has neither."""
    form = CLOSED_FORM.of(problem)
    return ENCLOSABLE.required(problem) if form is None else BetweenEnds(ClosedFormEnclosable(form))  # type: ignore[no-any-return]


def factors(problem: Problem) -> tuple[Enclosable, ...]:
    """The problem in balls in factors, as many as it offers: D is their product, up to a constant."""
    return tuple(BetweenEnds(ClosedFormEnclosable(form)) for form in FACTORS.of(problem)) or (whole(problem),)


def one_polynomial(forms: tuple[Enclosable, ...]) -> bool:
    """Whether values of D are cheap enough for a rectangle to be proved by one polynomial on a disc around it."""
    return all(form.most_points >= POLYNOMIAL_POINTS for form in forms)
