"""How each verdict looks wherever it is shown: in a terminal, on a page by day and by night, as a mark in a picture."""

from __future__ import annotations

from dataclasses import dataclass

from shootstab.core.records import CONFIRMED, CONTINUUM, INACCURATE, SPURIOUS, UNRESOLVED


@dataclass(frozen=True)
class VerdictLook:
    """A style of rich for the terminal, colours of the page by day and by night, and the marker, its colour and its size in a picture."""

    style: str
    by_day: str
    by_night: str
    marker: str
    colour: str
    size: int


# colours of marks are Okabe and Ito's, told apart by the colour-blind
VERDICT_LOOKS = {
    CONFIRMED: VerdictLook("green", "#00704f", "#3fd3a3", "o", "#009E73", 7),
    INACCURATE: VerdictLook("yellow", "#8a5a00", "#f0b545", "^", "#E69F00", 7),
    SPURIOUS: VerdictLook("red", "#b34700", "#ff9a57", "x", "#D55E00", 6),
    CONTINUUM: VerdictLook("cyan", "#005a8c", "#6bbcf0", "+", "#0072B2", 7),
    UNRESOLVED: VerdictLook("magenta", "#a0005a", "#f08fc4", "D", "#CC79A7", 5),
}
MISSING_LOOK = VerdictLook("bold red", "#a0005a", "#f08fc4", "*", "#F0E442", 13)


def css() -> str:
    """The rules that colour the words on a page."""
    looks = {**VERDICT_LOOKS, "missing": MISSING_LOOK}
    day = " ".join(f"b.{word} {{ color: {look.by_day}; }}" for word, look in looks.items())
    night = " ".join(f"b.{word} {{ color: {look.by_night}; }}" for word, look in looks.items())
    return f"{day}\n@media screen and (prefers-color-scheme: dark) {{ {night} }}\n"
