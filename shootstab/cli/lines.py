"""Sentences on the lines of a page: no number is broken, and a complex one is written as in the tables."""

from __future__ import annotations

import re

PAGE = 80  # chosen: columns that a table or a sentence may have
GAP = 2  # chosen: blanks between two columns
NUMERAL = r"\d[\d.]*(?:e[-+]?\d+)?"
PYTHONIC = re.compile(rf"(?<![\w.])([-+]?{NUMERAL})([-+])({NUMERAL})j\b")
WORD = re.compile(r"\S*\d [-+] \d\S*i\S*|\S+")  # a - bi is one word
UNSEEN = 1e-12  # chosen: a part of a complex number smaller than this times the other part is rounding


def filled(text: str, hanging: str = "", width: int = PAGE) -> str:
    """The lines of a text, each on as many lines of so many columns as it needs, those that follow behind `hanging`.

    A complex number stands on one line, or where it is too long for that on two; no other word is broken.
    """
    return "\n".join(_filled_line(line, hanging, width) for line in text.split("\n"))


def _filled_line(line: str, hanging: str, width: int) -> str:
    if len(line) <= width:
        return line
    lines, now = [], line[: len(line) - len(line.lstrip())]
    empty = True
    for word in WORD.findall(line):
        pieces = [word] if len(hanging) + len(word) <= width else re.split(r" (?=[-+] )", word)
        for piece in pieces:
            if not empty and len(now) + 1 + len(piece) > width:
                lines.append(now)
                now, empty = hanging, True
            now += piece if empty else f" {piece}"
            empty = False
    return "\n".join([*lines, now])


def with_i(text: str) -> str:
    """The text with every a-bj as a - bi, without a part that is rounding."""
    return PYTHONIC.sub(_with_i, text)


def _with_i(found: re.Match[str]) -> str:
    re_text, sign, im_text = found.groups()
    re_size, im_size = abs(float(re_text)), float(im_text)
    if im_size <= UNSEEN * re_size:
        return re_text
    imaginary = f"{im_text}i"
    if re_size <= UNSEEN * im_size:
        return f"-{imaginary}" if sign == "-" else imaginary
    return f"{re_text} {sign} {imaginary}"


def numbered(numbers: list[int]) -> str:
    """Rising numbers with their runs: 1-4, 7."""
    runs: list[list[int]] = []
    for n in numbers:
        if runs and n == runs[-1][-1] + 1:
            runs[-1].append(n)
        else:
            runs.append([n])
    return ", ".join(f"{run[0]}–{run[-1]}" if len(run) > 1 else str(run[0]) for run in runs)
