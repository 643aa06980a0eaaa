"""Certificates for the checker of polynomial pencils, with settings chosen in doubles: it trusts none of them."""

from __future__ import annotations

import copy
import math
from collections.abc import Iterator, Mapping
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shootstab.analyses.proof import Proof
from shootstab.checkers.polynomial_pencil import PENCIL_LEMMAS, PENCIL_LIMITS, PENCIL_MOST_STEPS, RefusedPencilError, sizes
from shootstab.core.errors import ConvergenceError, InputError
from shootstab.core.scaled import TINY
from shootstab.multiprecision.tails import ABOVE_RADIUS, OF_LARGEST_ENTRY

FIRST_BITS, CERTIFIED_KNOWN_BITS = 96, 28  # chosen: bits beyond those of the radius, and of D on the circle
MOST_ATTEMPTS, LESS_BITS = 7, 1.4  # chosen: attempts, and the factor of bits where the checker has no value
MOST_REFUSED = 2  # chosen: attempts without a value on any circle, for a singular point is that with any bits
TERMS_OF_BITS, LEAST_TERMS = 0.7, 40  # chosen: terms of a series, for its tail to be below 2^−bits with the lengths below
STEP_SHARE = 8  # chosen: the norm of a step over the number of terms, inverse: terms fall like (e/8)^N
RADIUS = 4  # chosen: the series of coefficients hold in a disc so many times as large
SHORTEST = 2.0**-30  # chosen: steps and reaches are no shorter
ORDERS_WIDER = (40, 24, 12, 6, 3, 1)  # chosen: binary orders of the outer circle over the disc, in the order in which they are tried
FARTHEST_OUTER = 0.05  # chosen: the outer circle is no farther out, in |σ|, where a disc is small
# chosen: parts of what the inequalities of a series allow that are used; a step is rounded down by less than this
CERTIFIED_ROOM, COMMON_ROOM, CERTIFIED_SHORTER = 0.9, 0.7, 0.99
CERTIFIED_PLACES = 33  # chosen: places at which entries are sampled for weights
FEW_POINTS = 12  # chosen: points with which no other circle is tried
TAIL_BITS = 12  # chosen: bits by which the tail of the Taylor series of D lies below D


def candidates(problem: Mapping[str, Any], proof: Proof, count: int) -> Iterator[dict[str, Any]]:
    """Certificates of a proof on a disc, each with more bits. Raises InputError for one on another region, ConvergenceError for none."""
    if proof.region["shape"] != "disc" or proof.floor is not None:
        raise InputError("a proof on another region than a disc or rectangle: allowed is a certificate of one on these")
    centre, radius = proof.region["centre"], proof.region["radius"]
    sigma = complex(float(centre["re"]), float(centre["im"]))
    size = max(abs(sigma), float(radius))
    bits = FIRST_BITS + max(0, math.ceil(math.log2(size / float(radius))))
    reason, refused = "no attempt was made", 0
    for _ in range(MOST_ATTEMPTS):
        if bits > PENCIL_LIMITS["bits"][1] or refused == MOST_REFUSED:
            break
        made = settled(problem, sigma, bits)
        made |= {"count": count, "region": {**centre, "radius": radius}}
        fewest: tuple[int, int] | None = None
        lacking = 0
        for wider in ORDERS_WIDER:
            if float(radius) * 2.0**wider > FARTHEST_OUTER * size and wider != ORDERS_WIDER[-1] and float(radius) < FARTHEST_OUTER * size:
                continue
            outer = str(Fraction(radius) * 2**wider)
            try:
                M, least, spread = sizes({**made, "outer": outer})
            except RefusedPencilError as refusal:
                reason = str(refusal)
                continue
            if least <= 0 or spread << CERTIFIED_KNOWN_BITS > least:
                lacking = max(4, spread.bit_length() - max(least, 1).bit_length() + CERTIFIED_KNOWN_BITS + 4)
                break
            points = max(PENCIL_LIMITS["points"][0], count + 2, math.ceil((M.bit_length() - least.bit_length() + TAIL_BITS) / wider) + 2)
            if points <= PENCIL_LIMITS["points"][1] and (fewest is None or points < fewest[0]):
                fewest = points, wider
            if fewest is not None and fewest[0] <= FEW_POINTS:
                break
        if fewest is not None and not lacking:
            yield {**made, "points": fewest[0], "outer": str(Fraction(radius) * 2 ** fewest[1])}
        refused += fewest is None and not lacking
        bits = bits + lacking if lacking else math.ceil(LESS_BITS * bits)
    raise ConvergenceError(f"no settings for a certificate are found: {reason}")


def settled(problem: Mapping[str, Any], sigma: complex, bits: int) -> dict[str, Any]:
    """Everything but the disc and its circles, with as few points as there may be. Raises ConvergenceError where steps are too many."""
    order = max(LEAST_TERMS, math.ceil(TERMS_OF_BITS * bits))
    found = copy.deepcopy(dict(problem))
    layers = [_SampledLayer(given, problem["size"], sigma) for given in found["layers"]]
    starts = [Fraction(0), Fraction(0)]
    singular = [(name, layer) for name, layer in (("left", layers[0]), ("right", layers[-1])) if found[name]["kind"] != "wall"]
    at_ends = [layer.leading(float(Fraction(found[name]["at"]))) / (layer.high - layer.low) for name, layer in singular]
    weights = _weights([*(layer.between(CERTIFIED_PLACES) for layer in layers), *(part[None] for part in at_ends)])
    for side, (name, layer) in enumerate((("left", layers[0]), ("right", layers[-1]))):
        if found[name]["kind"] != "wall":
            starts[side], terms = layer.reach(float(Fraction(found[name]["at"])), order, weights)
            found[name]["reach"], order = str(starts[side]), max(order, terms)
    total = 0
    for at, (layer, given) in enumerate(zip(layers, found["layers"], strict=True)):
        low = Fraction(given["from"]) + (starts[0] if at == 0 else 0)
        high = Fraction(given["to"]) - (starts[1] if at == len(layers) - 1 else 0)
        given["steps"] = [str(h) for h in layer.steps(low, high, order, weights)]
        total += len(given["steps"])
    if total > PENCIL_MOST_STEPS:
        raise ConvergenceError(f"a certificate would take {total} steps")
    return {
        "format": 2,
        "problem": found,
        "points": PENCIL_LIMITS["points"][0],
        "bits": bits,
        "order": order,
        "weights": weights,
        "lemmas": PENCIL_LEMMAS,
    }


class _SampledLayer:
    """c (p,) and B (n, n, p) by powers of ξ at one σ, in doubles."""

    def __init__(self, given: Mapping[str, Any], n: int, sigma: complex) -> None:
        self.c = _at(given["c"], sigma)
        self.B = np.zeros((n, n, max(len(part) for *_, entry in given["B"] for part in entry)), dtype=np.complex128)
        for i, j, entry in given["B"]:
            at = _at(entry, sigma)
            self.B[i, j, : len(at)] = at
        self.low, self.high = float(Fraction(given["from"])), float(Fraction(given["to"]))

    def between(self, count: int) -> NDArray[np.float64]:
        """|B/c| (count, n, n) at places inside."""
        z = self.low + (self.high - self.low) * (np.arange(count) + 0.5) / count
        c, B = (np.polynomial.polynomial.polyval(z, np.moveaxis(part, -1, 0)) for part in (self.c, self.B))
        return np.asarray(np.abs(np.moveaxis(np.atleast_3d(B), -1, 0)) / np.abs(c)[:, None, None])

    def series(self, at: float) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """c and B about a place."""
        return _about(self.c, at), _about(self.B, at)

    def leading(self, at: float) -> NDArray[np.float64]:
        """|G_0| (n, n) of a singular end."""
        c, B = self.series(at)
        return np.asarray(np.abs(B[:, :, 0] / c[1]))

    def reach(self, at: float, order: int, weights: list[int]) -> tuple[Fraction, int]:
        """How far from a singular end its series are taken, a power of two, and the number of their terms at least."""
        c, B = self.series(at)
        B = B * _scale(weights)[:, :, None]
        norm = float(np.abs(B[:, :, 0] / c[1]).sum(axis=1).max())
        terms = max(order, math.ceil(4 * norm) + LEAST_TERMS)
        h = 2.0 ** math.floor(math.log2((self.high - self.low) / 2))
        while h > SHORTEST:
            f, G = (np.abs(part) * h ** np.arange(part.shape[-1]) for part in (c[1:] / c[1], B / c[1]))
            room = sum(x * RADIUS**i for i, x in enumerate(f.tolist()) if i)
            room += sum(float(G[:, :, i].sum(axis=1).max()) * RADIUS**i / terms for i in range(1, G.shape[-1]))
            if room <= CERTIFIED_ROOM * (1 - norm / terms):
                return Fraction(h), terms
            h /= 2
        raise ConvergenceError("a certificate: the coefficients are singular next to an end")

    def steps(self, low: Fraction, high: Fraction, order: int, weights: list[int]) -> list[Fraction]:
        """The lengths of all steps but the last."""
        here, length = low, float(high - low)
        out: list[Fraction] = []
        scale = _scale(weights)
        h = length
        while len(out) <= PENCIL_MOST_STEPS:
            c, B = self.series(float(here))
            h = min(2 * h, float(high - here))
            while not self._fits(c, B, h, order, scale):
                h /= 2
                if h < SHORTEST * length:
                    raise ConvergenceError("a certificate: the coefficients are singular inside")
            if h >= float(high - here):
                return out
            step = Fraction(f"{CERTIFIED_SHORTER * h:.3g}")
            out.append(step)
            here += step
        raise ConvergenceError(f"a certificate would take more than {PENCIL_MOST_STEPS} steps")

    def _fits(self, c: NDArray[np.complex128], B: NDArray[np.complex128], h: float, order: int, scale: NDArray[np.float64]) -> bool:
        f = np.abs(c[1:] / c[0]) * h ** np.arange(1, len(c))
        G = h * np.abs(B / c[0]) * h ** np.arange(B.shape[-1])
        size = len(scale) / 2  # a compound matrix has rows of up to so many of these
        norms = [size * float((G[:, :, i] * scale).sum(axis=1).max()) for i in range(G.shape[-1])]
        common = sum(x * RADIUS**i for i, x in enumerate(f.tolist(), 1))
        return bool(common <= COMMON_ROOM and sum(x * RADIUS**i for i, x in enumerate(norms)) <= order / STEP_SHARE * max(size / 2, 1.0))


def _weights(samples: list[NDArray[np.float64]]) -> list[int]:
    """e_j for the norm max |ψ_j|/2^{e_j}: of the vector that |B/c| multiplies by its spectral radius."""
    A = np.max(np.concatenate(samples), axis=0)
    n = len(A)
    radius = max(float(np.abs(np.linalg.eigvals(A)).max()), float(A.max()) * OF_LARGEST_ENTRY, TINY)
    w = np.linalg.solve(np.eye(n) - A / (ABOVE_RADIUS * radius), np.ones(n))
    return [round(x) for x in np.log2(np.maximum(w, TINY)).tolist()]


def _scale(weights: list[int]) -> NDArray[np.float64]:
    """2^{e_j − e_i} (n, n)."""
    e = np.array(weights, dtype=float)
    return np.asarray(2.0 ** (e[None, :] - e[:, None]))


def _at(entry: list[list[Any]], sigma: complex) -> NDArray[np.complex128]:
    out = np.zeros(max(map(len, entry)), dtype=np.complex128)
    for power, part in enumerate(entry):
        for j, a in enumerate(part):
            parts = a if isinstance(a, list) else [a, "0"]
            out[j] += complex(*(float(Fraction(x)) for x in parts)) * sigma**power
    return out


def _about(p: NDArray[np.complex128], at: float) -> NDArray[np.complex128]:
    """p(at + t) by powers of t, along the last axis."""
    out = p.copy()
    for i, _ in pairwise(range(p.shape[-1] + 1)):
        for j in range(p.shape[-1] - 2, i - 1, -1):
            out[..., j] += at * out[..., j + 1]
    return out
