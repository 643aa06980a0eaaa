"""Power series as integers with one common exponent: (values, e) stands for Σ values[m] 2^e x^m."""

from __future__ import annotations

from collections.abc import Sequence
from operator import mul
from typing import Any

from mpmath import libmp

Block = tuple[list[int], int]


def fixed(coefficients: Sequence[Any], bits: int) -> Block:
    """mpmath reals (or integers) as a block whose largest value has so many bits."""
    raw = [x._mpf_ if hasattr(x, "_mpf_") else libmp.from_int(x) if isinstance(x, int) else libmp.from_float(x) for x in coefficients]
    top = max((x[2] + x[3] for x in raw if x[1]), default=0)
    exponent = top - bits
    return [libmp.to_int(libmp.mpf_shift(x, -exponent)) for x in raw], exponent


def shifted(values: list[int], left: int) -> list[int]:
    """Every value times 2^left."""
    return [v << left for v in values] if left else values


def trimmed(block: Block, bits: int) -> Block:
    """The block with no more than so many bits in its largest value, rounded."""
    values, exponent = block
    excess = max(v.bit_length() for v in values) - bits
    if excess <= 0:
        return block
    half = 1 << (excess - 1)
    return [(v + half) >> excess for v in values], exponent + excess


def conv(a: list[int], b: list[int]) -> list[int]:
    """The product's values, exact."""
    n = min(len(a), len(b))
    back = b[:n][::-1]
    return [sum(map(mul, a, back[n - 1 - m :])) for m in range(n)]


def inverse_conv(a: Block, b: Block, bits: int) -> Block:
    """c with c b = a: c_m = (a_m − Σ_{j≥1} b_j c_{m−j})/b_0."""
    (x, e), (y, f) = a, b
    n = min(len(x), len(y))
    top = max(v.bit_length() for v in x)
    exponent = e + top - f - y[0].bit_length() - bits
    lift = e - f - exponent
    c: list[int] = []
    for m in range(n):
        carried = sum(map(mul, y[1 : m + 1], reversed(c)))
        numerator = (x[m] << lift if lift >= 0 else x[m] >> -lift) - carried
        c.append(numerator // y[0])
    return c, exponent


def power_conv(a: Block, first: Any, r: Any, bits: int) -> Block:
    """a^r from a c′ = r a′ c with c_0 = first given: m a_0 c_m = (r + 1) Σ j a_j c_{m−j} − m Σ a_j c_{m−j}, j from 1 to m."""
    x, _ = a
    (c0,), exponent = fixed([first], bits)
    (weight,), low = fixed([r + 1], bits)
    weighted = [j * v for j, v in enumerate(x)]
    c = [c0]
    for m in range(1, len(x)):
        back = c[::-1]
        slow, plain = sum(map(mul, weighted[1 : m + 1], back)), m * sum(map(mul, x[1 : m + 1], back))
        top = weight * slow - (plain << -low) if low < 0 else (weight * slow << low) - plain
        bottom = m * x[0] << -low if low < 0 else m * x[0]
        c.append(top // bottom)
    return c, exponent
