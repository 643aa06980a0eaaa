"""What a list of claims that are all spurious may have meant, with the options that say so."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from shootstab.analyses.hypotheses import Hypothesis

SAME_FACTOR = 1e-6  # chosen: relative: a factor comes from a claim and a mode that agree to some digits only
OPTIONS_OF_FACTOR = {1.0: "", -1.0: "--as growth --sign -", -1j: "--as frequency", 1j: "--as frequency --sign +"}  # σ/v: what says so


def sentence(found: Hypothesis, plain: bool) -> str:
    """The proposal in words; with the options only where none has been given yet."""
    if found.real_parts:
        said = f"All {found.tried} claims tried are real parts of eigenvalues of the bundled reference, to {found.digits:.1f} digits"
        return f"{said}: both parts of each are needed."
    factor = complex(found.factor)
    what = ["conjugated"] if found.conjugate else []
    if abs(factor - 1.0) > SAME_FACTOR:
        what.append(f"× {_factor(factor)}")
    said = f"All {found.tried} claims tried, {' '.join(what)}, are modes to {found.digits:.1f} digits"
    advice = options(found) if plain else ""
    return f"{said}: try {advice}." if advice else f"{said}."


def _factor(factor: complex) -> str:
    """A factor to six figures, without a part that is none to the accuracy of a factor."""
    re, im = (0.0 if abs(part) < SAME_FACTOR * abs(factor) else part for part in (factor.real, factor.imag))
    if im == 0.0:
        return f"{re:.6g}"
    size = "" if abs(abs(im) - 1.0) < SAME_FACTOR else f"{abs(im):.6g}"
    if re == 0.0:
        return f"{'-' if im < 0.0 else ''}{size}i"
    return f"({re:.6g} {'-' if im < 0.0 else '+'} {size}i)"


def options(found: Hypothesis) -> str:
    """The options of verify under which the claims mean these numbers; empty if none do."""
    size = abs(found.factor)
    turn = next((said for unit, said in OPTIONS_OF_FACTOR.items() if abs(found.factor / size - unit) < SAME_FACTOR), None)
    if turn is None:
        return ""
    scaled = abs(size - 1.0) > SAME_FACTOR
    words = [turn or ("--as growth" if scaled else ""), f"--length {1.0 / size:.6g}" if scaled else "", "--conjugate" * found.conjugate]
    return " ".join(word for word in words if word)
