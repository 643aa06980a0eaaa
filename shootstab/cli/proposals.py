"""What a list of claims that are all spurious may have meant, with the options that say so."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from shootstab.analyses.hypotheses import Hypothesis

SAME_FACTOR = 1e-6  # chosen: relative: a factor comes from a claim and a mode that agree to some digits only
OPTIONS_OF_FACTOR = {1.0: "", -1.0: "--as growth --sign -", -1j: "--as frequency", 1j: "--as frequency --sign +"}  # σ/v: what says so


def sentence(found: Hypothesis, plain: bool) -> str:
    """In words; with the options only where none has been given yet."""
    factor = complex(found.factor)
    what = ["conjugated"] if found.conjugate else []
    if abs(factor - 1.0) > SAME_FACTOR:
        what.append(f"× {factor.real:.6g}" if abs(factor.imag) < SAME_FACTOR * abs(factor) else f"× ({factor.real:.6g}{factor.imag:+.6g}i)")
    said = f"All {found.tried} claims tried, {' '.join(what)}, are modes to {found.digits:.1f} digits"
    advice = options(found) if plain else ""
    return f"{said}: try {advice}." if advice else f"{said}."


def options(found: Hypothesis) -> str:
    """The options of verify under which the claims mean these numbers; empty if none do."""
    size = abs(found.factor)
    turn = next((said for unit, said in OPTIONS_OF_FACTOR.items() if abs(found.factor / size - unit) < SAME_FACTOR), None)
    if turn is None:
        return ""
    scaled = abs(size - 1.0) > SAME_FACTOR
    words = [turn or ("--as growth" if scaled else ""), f"--length {1.0 / size:.6g}" if scaled else "", "--conjugate" * found.conjugate]
    return " ".join(word for word in words if word)
