"""All modes in a rectangle, without a guess, up to both sides of the continuous spectrum: count, divide, polish."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from shootstab.discriminants.atlas import Atlas, Undecidable
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.protocol import Method
from shootstab.problems.protocol import Problem
from shootstab.questions.refine import refine
from shootstab.questions.resonances import find_resonances
from shootstab.questions.survey import Survey, survey
from shootstab.roots.iterations import newton
from shootstab.vocabulary.errors import ConvergenceError
from shootstab.vocabulary.records import Mode
from shootstab.vocabulary.regions import Disc, Rectangle

SMALLEST = 1e-10  # of the first rectangle's diagonal: modes closer than this are one multiple mode
CUTS = (0.5, 0.47, 0.55, 0.41, 0.62, 0.36)  # where a rectangle is divided; the next if a mode lies on the cut
SAME = 1e-7  # relative distance below which two numbers mean one mode


@dataclass(frozen=True)
class Found:
    """All modes in a region, each with its error bar, the count that says that these are all, and resonances if they were looked for."""

    modes: tuple[Mode, ...]
    survey: Survey
    resonances: tuple[complex, ...] | None = None


def find(problem: Problem, region: Rectangle, rtol: float = 1e-8, resonances: bool = False, method: Method | None = None) -> Found:
    """All modes in a rectangle, a multiple one as often as its multiplicity.

    What lies within survey.left_out, around ends of the continuous spectrum, is not looked for. Raises Undecidable or ConvergenceError
    where the rectangle as a whole cannot be counted.
    """
    atlas = Atlas(problem, method or Frame(rtol=1e-9))
    modes, whole = find_modes(atlas, region)
    refined = tuple(refine(problem, z, rtol) for z in modes)
    return Found(refined, whole, tuple(find_resonances(atlas, region)) if resonances else None)


def find_modes(atlas: Atlas, region: Rectangle, known: Sequence[complex] = ()) -> tuple[list[complex], Survey]:
    """The modes in the rectangle that are not known yet, each as often as its multiplicity, and the count of the whole.

    Raises Undecidable or ConvergenceError where the rectangle as a whole cannot be counted.
    """
    whole = survey(atlas, region)
    diagonal = abs(complex(region.upper_right) - complex(region.lower_left))
    modes = _divide(atlas, region, whole, list(known), SMALLEST * diagonal)
    return modes, whole


def _divide(atlas: Atlas, region: Rectangle, counted: Survey, known: list[complex], smallest: float) -> list[complex]:
    lacking = counted.count - sum(_counted(k, region, counted.left_out) for k in known)
    if lacking <= 0:
        return []
    a, b = complex(region.lower_left), complex(region.upper_right)
    if counted.count == 1 and lacking == 1:
        try:
            root = newton(atlas.at((a + b) / 2).discriminant, (a + b) / 2, 1e-10)
            if root.converged and region.contains(root.sigma) and newton(atlas.at(root.sigma).discriminant, root.sigma, 1e-10).converged:
                return [root.sigma]
        except ConvergenceError:
            pass  # divide on: nearer to the mode the iteration settles
    if abs(b - a) < smallest:
        return [(a + b) / 2] * lacking
    for cut in CUTS:
        halves = _halves(region, cut)
        try:
            counts = [survey(atlas, half) for half in halves]
        except (Undecidable, ConvergenceError):
            continue
        return [z for half, count in zip(halves, counts, strict=True) for z in _divide(atlas, half, count, known, smallest)]
    raise ConvergenceError(f"{lacking} modes lie between {a:.6g} and {b:.6g}, but no way was found to divide the rectangle")


def _counted(mode: complex, region: Rectangle, left_out: Sequence[Disc]) -> bool:
    """Whether a known mode is one of those counted in the region."""
    return region.contains(mode) and not any(disc.contains(mode) for disc in left_out)


def _halves(region: Rectangle, cut: float) -> tuple[Rectangle, Rectangle]:
    a, b = complex(region.lower_left), complex(region.upper_right)
    if b.real - a.real > b.imag - a.imag:
        x = a.real + cut * (b.real - a.real)
        return Rectangle(a, complex(x, b.imag)), Rectangle(complex(x, a.imag), b)
    y = a.imag + cut * (b.imag - a.imag)
    return Rectangle(a, complex(b.real, y)), Rectangle(complex(a.real, y), b)
