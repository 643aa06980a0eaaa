"""What a list of claims that are all spurious may have meant, with the options that say so."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from shootstab.io.conventions import Convention

if TYPE_CHECKING:
    from shootstab.analyses.hypotheses import Hypothesis

TURNS = (1.0, -1.0, 1j, -1j)  # exact: σ/v of growth rates and frequencies
SAME_FACTOR = 1e-6  # chosen: relative: a factor comes from a claim and a mode that agree to some digits only
OPTIONS_OF_FACTOR = {1.0: "", -1.0: "--as growth --sign -", -1j: "--as frequency", 1j: "--as frequency --sign +"}  # σ/v: what says so
OPTIONS_OF_SPEED = {-1j: "--as phase-speed", 1j: "--as phase-speed --sign +"}  # σ/(αv)
AS_THE_PROBLEM = Convention()


def factors_tried(given: Convention, wavenumber: float | None) -> list[complex]:
    """What the claims, as they were judged, are to be multiplied by to have been meant in one of the conventions without other units."""
    speeds = () if wavenumber is None else (-1j * wavenumber, 1j * wavenumber)
    return [whole / given.unit for whole in (*TURNS, *speeds)]


def sentence(found: Hypothesis, given: Convention = AS_THE_PROBLEM, wavenumber: float | None = None) -> str:
    """The proposal in words, with the options that are to be given in place of those that were."""
    tried = f"All {found.tried}" if found.agreeing == found.tried else f"{found.agreeing} of {found.tried}"
    if found.parts:
        said = f"{tried} claims tried are {found.parts} of eigenvalues of the bundled reference, to {found.digits:.1f} digits"
        return f"{said}: both parts of each are needed."
    factor = complex(found.factor)
    what = ["conjugated"] if found.conjugate else []
    if abs(factor - 1.0) > SAME_FACTOR:
        what.append(f"× {_factor(factor)}")
    said = f"{tried} claims tried, {' '.join(what)}, are modes to {found.digits:.1f} digits"
    whole = in_the_problems_terms(found, given)
    if abs(whole.factor - 1.0) <= SAME_FACTOR and not whole.conjugate:
        return f"{said}: they are eigenvalues as the problem has them: leave out {_given(given)}."
    advice = options(whole, wavenumber)
    instead = "" if given.plain else f" in place of {_given(given)}"
    return f"{said}: try {advice}{instead}." if advice else f"{said}."


def in_the_problems_terms(found: Hypothesis, given: Convention) -> Hypothesis:
    """The same of σ itself: σ = given.unit·w of the claims w as they were judged, which are conjugates of those in the file if so.

    With w = f v or f v̄ by the hypothesis, and v the number in the file or its conjugate.
    """
    return replace(found, factor=given.unit * found.factor, conjugate=found.conjugate != given.conjugate)


def _given(convention: Convention) -> str:
    """The options that were given."""
    named = "" if convention.unit == 1.0 else f"--as {convention.kind}" + (f" --sign {convention.sign}" if convention.sign else "")
    return " ".join(word for word in (named, "--conjugate" * convention.conjugate) if word)


def _factor(factor: complex) -> str:
    """A factor to six figures, without a part that is none to the accuracy of a factor."""
    re, im = (0.0 if abs(part) < SAME_FACTOR * abs(factor) else part for part in (factor.real, factor.imag))
    if im == 0.0:
        return f"{re:.6g}"
    size = "" if abs(abs(im) - 1.0) < SAME_FACTOR else f"{abs(im):.6g}"
    if re == 0.0:
        return f"{'-' if im < 0.0 else ''}{size}i"
    return f"({re:.6g} {'-' if im < 0.0 else '+'} {size}i)"


def options(found: Hypothesis, wavenumber: float | None = None) -> str:
    """The options of verify under which the claims mean these numbers; empty if none do."""
    size = abs(found.factor)
    if wavenumber is not None and abs(wavenumber) != 1.0:
        for unit, said in OPTIONS_OF_SPEED.items():
            if abs(found.factor / wavenumber - unit) < SAME_FACTOR:
                return said + " --conjugate" * found.conjugate
    turn = next((said for unit, said in OPTIONS_OF_FACTOR.items() if abs(found.factor / size - unit) < SAME_FACTOR), None)
    if turn is None:
        return ""
    scaled = abs(size - 1.0) > SAME_FACTOR
    words = [turn or ("--as growth" if scaled else ""), f"--length {1.0 / size:.6g}" if scaled else "", "--conjugate" * found.conjugate]
    return " ".join(word for word in words if word)
