"""Complex numbers as people write them, and as many of their digits as hold."""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Iterable
from typing import Any

from shootstab.core.errors import shortened

_FLAGS = re.IGNORECASE | re.ASCII
_SIZE = r"(?:\d+(?:\.\d*)?|\.\d+)(?:[ed][+-]?\d+)?|nan|inf(?:inity)?"
_REAL = re.compile(rf"([+-]?)\s*({_SIZE})", _FLAGS)
_IMAGINARY = re.compile(rf"([+-]?)\s*({_SIZE})?\s*\*?\s*[ij]", _FLAGS)
# NumPy's savetxt writes 1+-2j
_BOTH = re.compile(rf"([+-]?(?:{_SIZE}))\s*([+-]\s*-?)\s*({_SIZE})?\s*\*?\s*[ij]", _FLAGS)

LONGEST_NUMERAL = 1000  # chosen: characters of a number
LONGEST_FIXED = 6  # chosen: decimal exponents of numbers that are printed without one, from SMALLEST_FIXED to below it
SMALLEST_FIXED = -4  # chosen, as Python prints: 0.0001 and not 1e-4
DIGITS_OF_DOUBLE = 17  # derived: decimals of so many digits stand for one double each
HAIR_OF_UNIT = 1e-6  # chosen: an error so little above a power of ten, as a part of that, is still it


def complex_from(text: str) -> complex:
    """The number that `1`, `2j`, `1+2j`, `1 - 2i`, `(1+2j)` or `1.0D-3` means.

    nan and inf are numbers here: whoever asks says whether they are allowed. Raises ValueError.
    """
    if len(text) > LONGEST_NUMERAL:
        raise ValueError(f"{shortened(text)} is not a number, it has {len(text)} characters")
    plain = text.strip().replace("−", "-")
    if plain.startswith("(") and plain.endswith(")"):
        plain = plain[1:-1].strip()
    if found := _REAL.fullmatch(plain):
        return complex(_signed(*found.groups()), 0.0)
    if found := _IMAGINARY.fullmatch(plain):
        return complex(0.0, _signed(found[1], found[2] or "1"))
    if found := _BOTH.fullmatch(plain):
        return complex(_signed("", found[1]), _signed(found[2], found[3] or "1"))
    raise ValueError(f"{shortened(text)} is not a number")


def floats_from(text: str, count: int | None) -> tuple[float, ...]:
    """The given number of finite numbers (None: any number of them) with commas between them. Raises ValueError."""
    refusal = ValueError(f"{shortened(text)} is not {count or 'a list of'} finite numbers with commas between them")
    try:
        values = [complex_from(cell) for cell in text.split(",")]
    except ValueError:
        raise refusal from None
    if (count is not None and len(values) != count) or any(v.imag != 0.0 or not math.isfinite(v.real) for v in values):
        raise refusal
    return tuple(v.real for v in values)


def nearest(word: str, allowed: Iterable[str]) -> str:
    """ ", did you mean x?" where one of the words allowed is near to this one; otherwise nothing."""
    near = difflib.get_close_matches(word, list(allowed), 1)
    return f", did you mean {near[0]}?" if near else ""


def _signed(sign: str, size: str) -> float:
    value = float(size.replace("d", "e").replace("D", "e"))
    return -value if sign.count("-") % 2 else value


def as_strings(sigma: Any, error: float | None = None) -> dict[str, str]:
    """{"re", "im"} with every digit a double has; of an mpmath number, those that the error leaves and three more."""
    if hasattr(sigma, "ae"):  # an mpmath number
        return {"re": _many_digits(sigma.real, error), "im": _many_digits(sigma.imag, error)}
    z = complex(sigma)
    return {"re": repr(z.real), "im": repr(z.imag)}


def _many_digits(x: Any, error: float | None) -> str:
    import mpmath

    digits: int = mpmath.mp.dps
    if error is not None and 0.0 < error < math.inf and x != 0:
        digits = max(DIGITS_OF_DOUBLE, math.ceil(mpmath.log10(abs(x) / error)) + 3)
    return str(mpmath.nstr(x, digits, strip_zeros=False))


def held(x: Any, error: float | None) -> str:
    """The real number x, cut to the digits that an error of this size leaves.

    Rounded at the last decimal place whose unit is not below the error; 0 if no digit holds.
    """
    if x == 0:
        return "0"
    exponent = math.floor(_log10(abs(x)))
    if error is None or not 0.0 < error < math.inf:
        return _digits(x, 6 if error == math.inf else DIGITS_OF_DOUBLE, exponent)
    # a hair more than the unit is still the unit: 1.0000001e-12 leaves twelve places
    places = math.floor(-math.log10(error) + HAIR_OF_UNIT)
    count = exponent + places + 1
    return _digits(x, count, exponent) if count > 0 else "0"


def held_complex(sigma: Any, error: float | None) -> str:
    """re + im·i, both cut at the same decimal place; a real number without its imaginary part."""
    # the sign goes by the text: abs() of an mpmath number rounds it to the precision of the context
    re_text, im_text = held(sigma.real, error), held(sigma.imag, error).removeprefix("-")
    if im_text == "0":
        return re_text
    sign = "-" if sigma.imag < 0 else "+"
    return f"{re_text} {sign} {im_text}i"


def claimed_digits(claimed: complex, digits: int) -> str:
    """A claimed number, to two digits more than it is asked about."""
    return held_complex(claimed, abs(claimed) * 10.0 ** -(digits + 2) or None)


def _digits(x: Any, count: int, exponent: int) -> str:
    if hasattr(x, "ae"):
        import mpmath

        return str(mpmath.nstr(x, count, strip_zeros=False))
    count = min(count, DIGITS_OF_DOUBLE)
    if SMALLEST_FIXED <= exponent < LONGEST_FIXED and count > exponent:
        return f"{float(x):.{count - exponent - 1}f}"
    return f"{float(x):.{count - 1}e}"


def _log10(x: Any) -> float:
    if hasattr(x, "ae"):
        import mpmath

        return float(mpmath.log10(x))
    return math.log10(x)
