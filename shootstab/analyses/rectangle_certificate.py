"""Certificates of rectangles for the checker of polynomial pencils, with settings chosen in doubles: it trusts none of them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from fractions import Fraction
from time import process_time
from typing import Any

from shootstab.analyses.polynomial_certificate import CERTIFIED_KNOWN_BITS, FIRST_BITS, LESS_BITS, TAIL_BITS, settled
from shootstab.checkers.polynomial_pencil import PENCIL_LIMITS, RIM_OF_SIDE, RefusedPencilError, half_diagonal, sizes
from shootstab.core.errors import ConvergenceError

RECTANGLE_ATTEMPTS = 4  # chosen: attempts, each with more bits
WIDER_CIRCLES = (Fraction(4), Fraction(2), Fraction(3, 2))  # chosen: outer circles over the one around the rectangle
CELLS_TRIED = (1, 2, 4, 8)  # chosen: squares in a row on the outer one
USUAL_POINTS = 48  # chosen: values of D below which no other settings are tried
MORE_TAIL_BITS = 2  # chosen: factor of the bits by which the rest of D's series lies below D, from one attempt to the next
LONGEST_CHECK = 180.0  # chosen: seconds of processor time that the checker of a rectangle may take


def rectangles(problem: Mapping[str, Any], sides: Mapping[str, str], count: int) -> Iterator[dict[str, Any]]:
    """Certificates of a proof on a rectangle, each with more bits.

    Raises ConvergenceError where there is none, or where its check would take too long.
    """
    left, low, right, high = (Fraction(sides[side]) for side in ("left", "low", "right", "high"))
    centre, radius = complex((left + right) / 2, (low + high) / 2), half_diagonal(right - left, high - low)
    bits, tail, reason = FIRST_BITS, TAIL_BITS, "no attempt was made"
    for _ in range(RECTANGLE_ATTEMPTS):
        found: list[tuple[float, dict[str, Any]]] = []
        lacking = 0
        for wider in WIDER_CIRCLES:
            outer = wider * radius
            away = centre / abs(centre) if centre else 1.0
            made = settled(problem, centre + float(outer) * away, bits)  # the steps are shortest where σ is largest
            made |= {"count": count, "region": dict(sides), "outer": str(outer), "points": max(PENCIL_LIMITS["points"][0], count + 2)}
            for cells in CELLS_TRIED:
                began = process_time()
                try:
                    M, least, spread = sizes({**made, "cells": cells})
                except (RefusedPencilError, ValueError) as refusal:
                    reason = str(refusal)
                    continue
                once = (process_time() - began) / (cells**2 + 4 * RIM_OF_SIDE + 1)
                lacking = max(4, spread.bit_length() - max(least, 1).bit_length() + CERTIFIED_KNOWN_BITS + 4)
                if least <= 0 or spread << CERTIFIED_KNOWN_BITS > least:
                    break
                lacking, needed = 0, math.ceil((M.bit_length() - least.bit_length() + tail) / math.log2(wider)) + 2
                points = max(needed, made["points"])
                if points > PENCIL_LIMITS["points"][1]:
                    continue
                found.append((once * (points + cells**2), {**made, "cells": cells, "points": points}))
                if points < USUAL_POINTS or cells**2 > points:
                    break
            if lacking or (found and found[-1][1]["points"] < USUAL_POINTS):
                break
        if found:
            seconds, best = min(found, key=lambda at: at[0])
            if seconds > LONGEST_CHECK:
                raise ConvergenceError(f"a certificate of this rectangle would take its checker about {seconds:.0f} s: take a smaller one")
            yield best
            tail *= MORE_TAIL_BITS
        bits = bits + lacking if lacking else math.ceil(LESS_BITS * bits)
    raise ConvergenceError(f"no settings for a certificate are found: {reason}")
