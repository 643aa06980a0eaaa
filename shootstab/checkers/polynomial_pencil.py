"""Check a certificate on a boundary eigenvalue problem with polynomial coefficients. Run as `python polynomial_pencil.py CERTIFICATE`.

It claims that exactly n eigenvalues σ, with multiplicity, lie in a disc or rectangle. The problem stands in the certificate in exact
numbers: layers with c(ξ, σ) dψ/dξ = B(ξ, σ) ψ, c and the entries of B polynomials, the ends, and at every joint L(σ) ψ(before) + R(σ)
ψ(behind) = 0. An end is a wall, W(σ) ψ = 0; or an axis, at which c has a zero of order one and ψ is a power series whose component j
begins with order least[j]; or infinity, a zero of c too, the x = e^{−κz} = 0 or ξ = tanh = ±1 of an unbounded domain, where ψ decays.
This file shares nothing with the program that wrote the certificate but mpmath, whose eigenvectors are guesses. A `IntegerBall` (x, y, r)
of integers is |z − (x + iy) 2^−P| ≤ r 2^−P.

D.  y are the k-minors of the solutions that the left end admits, carried to the right end: c dy/dξ = B^(k) y with the compound matrix. w
are the minors of the rows at a wall, or ± the complementary ones of the solutions that the right end admits. D = Σ w_I y_I is zero where a
solution ψ ≠ 0 is admitted by both, and its order is the multiplicity.

R1 (steps).  With ξ = ξ_0 + h t, f_j = c_j/c_0 and G_j = h B_j/c_0 by powers of t,

    m y_m = Σ_{j≥0} G_j y_{m−1−j} − Σ_{j≥1} (m − j) f_j y_{m−j}.

In a norm max |y_i|/2^{e_i}, |y_m| ≤ Σ_{i≥1} b_i |y_{m−i}| for m ≥ N, b_i = |f_i| + ‖G_{i−1}‖/N, since (m − j)/m ≤ 1. If Σ b_i 2^i ≤ 1
and |y_{N−i}| ≤ A 2^i for i up to the last b then |y_m| ≤ A 2^{N−m} for m ≥ N by induction: what is left out is 2A at most.

R2 (singular ends).  With c = t ĉ, ψ = t^μ Σ P_m t^m, G_j = ± h B_j/ĉ_0,

    (m + μ − G_0) P_m = Σ_{j≥1} (G_j − (m − j + μ) f_j) P_{m−j}.

For m below N these matrices are inverted. For m ≥ N > ‖G_0‖ and Re μ ≥ 0, |m + μ| ≥ N and |m − j + μ| ≤ |m + μ|, so that R1 holds with
b_i = (|f_i| + ‖G_i‖/N)/(1 − ‖G_0‖/N). At infinity μ are the eigenvalues of G_0 with Re μ > 0,
simple, P_0 their eigenvectors: if M = V⁻¹ G_0 V has disjoint Gershgorin discs of radii ρ_j about its diagonal, each holds one μ, and its
eigenvector is V (e_q + w), |w_j| ≤ ρ_j/(|M_qq − M_jj| − ρ_q), w_q = 0. All others must have Re μ < 0. Minors are divided by one of the
P_0, which takes away lengths and order. At an axis μ = 0 and the P_m with m < count are the null space of one matrix, a polynomial in σ:
that its rank is at most r is found in rational arithmetic at as many σ as a minor of r + 1 rows has zeros, and one more; a block of r
rows is inverted.

Disc.  From K values of D on |σ − c| = r and |D| ≤ M on |σ − c| ≤ ρ, q = r/ρ: the discrete Fourier coefficients miss d_k r^k by at most
M q^{k+K}/(1 − q^K), the rest of the Taylor series is below M q^K/(1 − q); |d_n| r^n > Σ_{k≠n} |d_k| r^k + rest proves n zeros (Pellet).
M is |D| computed for all σ of the larger disc at once.

Rectangle.  M is the largest |D| on squares that cover the larger one of two discs around it, `cells` in a row, for all σ of a square at
once. On the smaller disc D = Σ_{k<K} a_k u^k up to a spread e. Where Σ_{k≥1} |c_k| s^k + 4e < |c_0| for the series about the middle of a
piece of the boundary of half length s, D is there within a quarter turn of its value at the middle: the turns add up to the count.
"""

import json
import math
import re
import sys
from fractions import Fraction
from itertools import combinations
from pathlib import Path
from typing import Any, NamedTuple

from mpmath import iv, mp

PENCIL_KEYS = {"format", "problem", "count", "region", "outer", "points", "bits", "order", "weights", "lemmas"}
RECTANGLE_SIDES = {"left", "low", "right", "high"}
PENCIL_LEMMAS = ["E5", "E6", "E7", "E8", "R1", "R2"]
PENCIL_LIMITS = {"count": (0, 64), "points": (3, 256), "bits": (40, 6000), "order": (8, 6000)}  # chosen: what a certificate may ask for
PENCIL_MOST_STATES, PENCIL_MOST_STEPS, MOST_LAYERS = 8, 2000, 16  # chosen: the same
PENCIL_MOST_NUMBERS, PENCIL_MOST_ORDERS, MOST_WEIGHT = 20_000, 24, 3000  # chosen: the same
NUMBER = re.compile(r"-?\d{1,2000}((\.\d{1,2000})?(e-?\d{1,4})?|/\d{1,2000})")
SHOWN = 40  # chosen: characters of what is no number that are told
MOST_CELLS, PENCIL_MOST_PIECES = 16, 4000  # chosen: the same, squares in a row and pieces of a boundary
LONGEST_PIECE, LEAST_PIECE = Fraction(1, 64), Fraction(1, 2**48)  # chosen: the first piece of a side, and the shortest one
RIM_OF_SIDE = 6  # chosen: points of a side at which |D| is judged
ROOT_BITS = 20  # chosen: bits of a square root beyond those of what it is taken of
QUOTIENT_BITS, LACKING_TURN = 60, 0.01  # chosen: bits of a ratio; part of a turn by which a sum of doubles may miss a whole one
PENCIL_MOST_WORK = 4 * 10**8  # chosen: products of numbers that a certificate may ask for

GaussianRational = tuple[Fraction, Fraction]  # a Gaussian rational
PENCIL_NOTHING: GaussianRational = (Fraction(0), Fraction(0))


class IntegerBall(NamedTuple):
    x: int
    y: int
    r: int


class RefusedPencilError(Exception):
    """Why a certificate does not prove what it says."""


def check(certificate: Any) -> str | None:
    """None where the certificate proves what it says; else the reason why it does not."""
    try:
        checker = PencilChecker(certificate)
    except (KeyError, TypeError, ValueError, AttributeError, IndexError, ZeroDivisionError) as error:
        return f"not a certificate of this kind: {error}"
    saved = iv.prec, mp.prec
    iv.prec = mp.prec = checker.P
    try:
        return checker.reason()
    except RefusedPencilError as refusal:
        return str(refusal)
    finally:
        iv.prec, mp.prec = saved


def sizes(certificate: Any) -> tuple[int, int, int]:
    """M, a lower bound of |D| at points of the boundary and the radius of its ball, in units of the last place: for a choice of settings.

    Raises RefusedPencilError where there are none.
    """
    checker = PencilChecker(certificate)
    saved = iv.prec, mp.prec
    iv.prec = mp.prec = checker.P
    try:
        checker.prepare()
        checker.value(checker.exact(*checker.centre))
        values = [checker.value(checker.exact(*at)) for at in checker.rim()]
        return checker.bound(), min(map(_least, values)), max(value.r for value in values)
    finally:
        iv.prec, mp.prec = saved


def _require(holds: bool, otherwise: str) -> None:
    if not holds:
        raise ValueError(otherwise)


def _whole(x: Any, low: int, high: int, name: str) -> int:
    _require(type(x) is int and low <= x <= high, f"{name} = {x!r}")
    return int(x)


class NumberReader:
    """Numbers of a certificate, of which there may be so many."""

    def __init__(self) -> None:
        self.left = PENCIL_MOST_NUMBERS

    def number(self, text: Any) -> Fraction:
        self.left -= 1
        _require(
            self.left > 0 and isinstance(text, str) and NUMBER.fullmatch(text) is not None, f"{str(text)[:SHOWN]!r} is no number in quotes"
        )
        return Fraction(text)

    def gaussian(self, x: Any) -> GaussianRational:
        if isinstance(x, list):
            re_part, im_part = x
            return self.number(re_part), self.number(im_part)
        return self.number(x), Fraction(0)

    def polynomials(self, x: Any) -> list[list[GaussianRational]]:
        """Coefficients by powers of σ and of ξ."""
        _require(isinstance(x, list) and len(x) > 0, "a polynomial is a list")
        return [[self.gaussian(a) for a in part] for part in x]

    def rows(self, x: Any, width: int) -> list[list[list[GaussianRational]]]:
        """Entries of rows by powers of σ."""
        _require(isinstance(x, list) and all(len(row) == width for row in x), f"rows of {width} entries")
        return [[[self.gaussian(a) for a in entry] for entry in row] for row in x]


class CertifiedEnd:
    """A wall with rows, or a singular end with the number of solutions that it admits."""

    def __init__(self, read: NumberReader, given: dict[str, Any], n: int, order: int) -> None:
        kind = given["kind"]
        keys = {"wall": {"rows"}, "infinity": {"reach", "admitted"}, "axis": {"reach", "admitted", "orders", "least"}}[kind]
        _require(set(given) == {"kind", "at"} | keys, f"an end has {', '.join(sorted(keys))}")
        self.kind, self.at = kind, read.number(given["at"])
        self.pivots: Any = None
        if kind == "wall":
            self.rows = read.rows(given["rows"], n)
            self.admitted, self.reach = n - len(self.rows), Fraction(0)
            return
        self.admitted, self.reach = _whole(given["admitted"], 0, n, "admitted"), read.number(given["reach"])
        _require(self.reach > 0, "a reach must be positive")
        if kind == "axis":
            self.orders = _whole(given["orders"], 1, min(PENCIL_MOST_ORDERS, order), "orders")
            self.least = [_whole(x, 0, PENCIL_MOST_ORDERS, "least") for x in given["least"]]
            _require(len(self.least) == n, "least is one order for each component")


class PencilChecker:
    """One certificate, its numbers as fractions."""

    def __init__(self, certificate: Any) -> None:
        keys = PENCIL_KEYS | ({"cells"} if set(certificate["region"]) == RECTANGLE_SIDES else set())
        _require(set(certificate) == keys and certificate["format"] == 2, f"its keys are to be {', '.join(sorted(keys))}, its format 2")
        _require(certificate["lemmas"] == PENCIL_LEMMAS, f"its lemmas are {', '.join(PENCIL_LEMMAS)}")
        for name, (low, high) in PENCIL_LIMITS.items():
            _whole(certificate[name], low, high, name)
        self.P, self.N, self.K, self.count = (certificate[name] for name in ("bits", "order", "points", "count"))
        problem, region, read = certificate["problem"], certificate["region"], NumberReader()
        _require(set(problem) == {"name", "size", "layers", "joints", "left", "right"}, "problem")
        disc = set(region) == {"re", "im", "radius"}
        _require(problem["name"] == "polynomial pencil" and (disc or set(region) == RECTANGLE_SIDES), "problem, or region")
        n = self.n = _whole(problem["size"], 1, PENCIL_MOST_STATES, "size")
        self.corners: list[tuple[Fraction, Fraction]] = []
        if disc:
            self.cells = 1
            self.centre, self.radius = (read.number(region["re"]), read.number(region["im"])), read.number(region["radius"])
        else:
            self.cells = _whole(certificate["cells"], 1, MOST_CELLS, "cells")
            a, b, c, d = (read.number(region[side]) for side in ("left", "low", "right", "high"))
            _require(a < c and b < d, "a rectangle without an inside")
            self.corners = [(a, b), (c, b), (c, d), (a, d)]
            self.centre, self.radius = ((a + c) / 2, (b + d) / 2), half_diagonal(c - a, d - b)
        self.outer = read.number(certificate["outer"])
        self.left, self.right = (CertifiedEnd(read, problem[side], n, self.N) for side in ("left", "right"))
        self.k = self.left.admitted
        _require(self.right.admitted == n - self.k, "both ends together admit as many solutions as there are components")
        self.weights = [_whole(e, -MOST_WEIGHT, MOST_WEIGHT, "weight") for e in certificate["weights"]]
        _require(len(self.weights) == n and 1 <= len(problem["layers"]) <= MOST_LAYERS, "weights, or layers")
        _require(all(isinstance(problem[part], list) for part in ("layers", "joints")), "layers and joints are lists")
        _require(len(problem["joints"]) == len(problem["layers"]) - 1, "a joint lies between two layers")
        self.joints = [[read.rows(joint[side], n) for side in ("before", "behind")] for joint in problem["joints"]]
        _require(all(len(rows) == n for joint in self.joints for rows in joint), f"{n} conditions at a joint")
        self.subsets = list(combinations(range(n), self.k))
        self.layers = [self.layer(read, given) for given in problem["layers"]]
        places = [len(layer["steps"]) + 1 for layer in self.layers]
        _require(
            sum(places) <= PENCIL_MOST_STEPS and sum(places) * (self.K + self.cells**2) * self.N * len(self.subsets) <= PENCIL_MOST_WORK,
            "more work than is taken",
        )
        _require(all(x > 0 for x in (self.radius, *(h for layer in self.layers for h in layer["steps"]))), "what must be positive is not")
        _require(
            self.outer > self.radius and self.count < self.K, "the outer circle is the larger one, and there are more points than zeros"
        )
        for end, layer, side in ((self.left, self.layers[0], "from"), (self.right, self.layers[-1], "to")):
            _require(end.at == layer[side], "a layer ends elsewhere")

    def layer(self, read: NumberReader, given: dict[str, Any]) -> dict[str, Any]:
        """The interval, the lengths of steps but the last, and polynomials by powers of σ."""
        _require(set(given) == {"from", "to", "steps", "c", "B"}, "a layer")
        entries: dict[tuple[int, int], list[list[GaussianRational]]] = {}
        for i, j, entry in given["B"]:
            at = _whole(i, 0, self.n - 1, "row"), _whole(j, 0, self.n - 1, "column")
            _require(at not in entries, "an entry stands twice")
            entries[at] = read.polynomials(entry)
        low, high, steps = read.number(given["from"]), read.number(given["to"]), [read.number(h) for h in given["steps"]]
        _require(low < high, "a layer has no length")
        return {"from": low, "to": high, "steps": steps, "c": read.polynomials(given["c"]), "B": entries}

    def reason(self) -> str | None:
        """Why the certificate does not hold; None where it does."""
        self.prepare()
        turns = [(iv.cos(2 * iv.pi * j / self.K), iv.sin(2 * iv.pi * j / self.K)) for j in range(self.K)]
        roots = [self.exact(_fraction(c.mid), _fraction(s.mid), self.up(c.delta + s.delta)) for c, s in turns]
        centre, radius = self.exact(*self.centre), self.exact(self.radius)
        self.value(centre)  # what is chosen there serves for every σ
        M = self.bound()
        values = [self.value(self.plus(centre, self.times(radius, w))) for w in roots]
        q = self.radius / self.outer
        cut = _above(M * q**self.K / (1 - q))
        coefficients = []
        for m in range(self.K):
            total = IntegerBall(0, 0, 0)
            for j, v in enumerate(values):
                total = self.plus(total, self.times(v, roots[-j * m % self.K]))
            off = _above(M * q ** (m + self.K) / (1 - q**self.K))
            coefficients.append(IntegerBall(total.x // self.K, total.y // self.K, total.r // self.K + 3 + off))
        if self.corners:
            return self.followed(coefficients, cut)
        leading = coefficients.pop(self.count)
        holds = math.isqrt(leading.x**2 + leading.y**2) - leading.r > sum(map(length, coefficients)) + cut
        return None if holds else f"Pellet's inequality does not hold for n = {self.count}"

    def bound(self) -> int:
        """M: |D| at most on the larger disc, on squares that cover it, or on all of it at once."""
        return max(length(self.value(part)) for part in self.parts())

    def parts(self) -> list[IntegerBall]:
        """Discs that together hold all σ of the outer circle, about squares, or that itself."""
        half = self.outer / self.cells
        reach = self.exact(self.outer if self.cells == 1 else half * 3 / 2).x + 4  # 3/2 is above the root of 2
        places = [(2 * i + 1 - self.cells) * half for i in range(self.cells)]
        about = [self.exact(self.centre[0] + x, self.centre[1] + y) for x in places for y in places]
        return [IntegerBall(at.x, at.y, reach) for at in about]

    def rim(self) -> list[tuple[Fraction, Fraction]]:
        """A point of the circle, or some of the boundary of the rectangle."""
        if not self.corners:
            return [(self.centre[0] + self.radius, self.centre[1])]
        sides = zip(self.corners, [*self.corners[1:], self.corners[0]], strict=True)
        parts = [Fraction(i, RIM_OF_SIDE) for i in range(RIM_OF_SIDE)]
        return [(a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t) for a, b in sides for t in parts]

    def followed(self, d: list[IntegerBall], rest: int) -> str | None:
        """Why the turns of D along the boundary, counter-clockwise, are not as many as are claimed; None where they are."""
        spread, a = rest + sum(x.r for x in d), [(x.x, x.y) for x in d]
        off = [0] * self.K  # what the shift to a middle, |u| ≤ 1, loses by rounding, of every coefficient
        for i in range(self.K):
            for j in range(self.K - 2, i - 1, -1):
                off[j] += off[j + 1] + 2
        turns, walked = 0.0, 0
        for begin, end in zip(self.corners, [*self.corners[1:], self.corners[0]], strict=True):
            here, step = Fraction(0), LONGEST_PIECE
            while here < 1:
                if (walked := walked + 1) > PENCIL_MOST_PIECES:
                    return f"the boundary asks for more than {PENCIL_MOST_PIECES} pieces"
                ahead = min(Fraction(1), here + step)
                at = [[b + (e - b) * t for b, e in zip(begin, end, strict=True)] for t in (here, (here + ahead) / 2, ahead)]
                s = (ahead - here) / 2 * (abs(end[0] - begin[0]) + abs(end[1] - begin[1])) / self.radius
                c = self.moved(a, at[1])
                others, power, unit = 0, 1 << self.P, math.ceil(s * 2**self.P) + 2
                for (x, y), lost in zip(c[1:], off[1:], strict=True):
                    power = (power * unit >> self.P) + 1
                    others += ((math.isqrt(x * x + y * y) + 1 + lost) * power >> self.P) + 1
                if others + 4 * (spread + off[0]) >= math.isqrt(c[0][0] ** 2 + c[0][1] ** 2):
                    step = (ahead - here) / 2
                    if step < LEAST_PIECE:
                        at_side = f"{float(here):.3g} of the way from {complex(*map(float, begin)):.6g}"
                        return f"an eigenvalue lies too near to the boundary, {at_side}"
                    continue
                ends = [self.moved(a, sigma, 1)[0] for sigma in (at[0], at[2])]
                turns += _turned(ends[0], c[0]) + _turned(c[0], ends[1])
                here, step = ahead, (ahead - here) * 2
        count = turns / (2 * math.pi)
        return None if abs(count - self.count) < LACKING_TURN else f"{self.count} are claimed, and {count:.3f} counted"

    def moved(self, a: list[tuple[int, int]], sigma: list[Fraction], terms: int | None = None) -> list[tuple[int, int]]:
        """The first coefficients of Σ a_k (u + v)^k in powers of v, u that of σ, each rounding below 2 units of the last place."""
        (x, y), P = (math.floor((s - c) / self.radius * 2**self.P) for s, c in zip(sigma, self.centre, strict=True)), self.P
        re, im = [v[0] for v in a], [v[1] for v in a]
        for i in range(self.K if terms is None else terms):
            for j in range(self.K - 2, i - 1, -1):
                b, c = re[j + 1], im[j + 1]
                re[j] += (b * x - c * y) >> P
                im[j] += (b * y + c * x) >> P
        return list(zip(re, im, strict=True))

    def prepare(self) -> None:
        """The polynomials about every place at which steps begin, in t, and whether c vanishes as it must at singular ends."""
        one = Fraction(1)
        last = len(self.layers) - 1
        self.ways: list[list[Any]] = []
        self.starts: dict[int, Any] = {}
        for at, layer in enumerate(self.layers):
            begin = layer["from"] + (self.left.reach if at == 0 else 0)
            end = layer["to"] - (self.right.reach if at == last else 0)
            rest = end - begin - sum(layer["steps"], Fraction(0))
            if not (rest > 0 or (rest == 0 and not layer["steps"])):
                raise RefusedPencilError("steps lead beyond the end of a layer")
            here, way = begin, []
            for h in [*layer["steps"], *([rest] if rest else [])]:
                way.append((self.about(layer, here, h, 0), h))
                here += h
            self.ways.append(way)
        for side, (end_, layer, direction) in enumerate(((self.left, self.layers[0], one), (self.right, self.layers[-1], -one))):
            if end_.kind != "wall":
                if any(part[0] != PENCIL_NOTHING for part in _shifted(layer["c"], end_.at, end_.reach)):
                    raise RefusedPencilError("c does not vanish at a singular end")
                self.starts[side] = self.about(layer, end_.at, direction * end_.reach, 1)

    def about(self, layer: dict[str, Any], at: Fraction, h: Fraction, order: int) -> Any:
        """c/t^order and h B by powers of σ and t, as balls."""

        def balls(entry: list[list[GaussianRational]], drop: int, factor: Fraction) -> list[list[IntegerBall]]:
            return [[self.exact(a * factor, b * factor) for a, b in part[drop:]] for part in _shifted(entry, at, h)]

        return balls(layer["c"], order, Fraction(1)), {place: balls(entry, 0, h) for place, entry in layer["B"].items()}

    def value(self, sigma: IntegerBall) -> IntegerBall:
        """D(σ)."""
        y = self.admitted(0, sigma)
        for at, way in enumerate(self.ways):
            for parts, _ in way:
                y = self.step(y, self.compound(*self.at_sigma(parts, sigma)))
            if at < len(self.joints):
                y = self.across(y, self.joints[at], sigma)
        total = IntegerBall(0, 0, 0)
        for w, x in zip(self.conditions(sigma), y, strict=True):
            total = self.plus(total, self.times(w, x))
        return total

    def admitted(self, side: int, sigma: IntegerBall) -> list[IntegerBall]:
        """Minors of the solutions that an end admits: the k-minors, of all sets of rows."""
        end = (self.left, self.right)[side]
        if end.kind != "wall":
            return self.singular(end, self.starts[side], sigma)
        rows, out = self.rows_at(end.rows, sigma), []
        for chosen in combinations(range(self.n), end.admitted):
            others = [j for j in range(self.n) if j not in chosen]
            minor = self.determinant([[row[j] for j in others] for row in rows])
            out.append(IntegerBall(-minor.x, -minor.y, minor.r) if sum(chosen) % 2 else minor)
        return out

    def conditions(self, sigma: IntegerBall) -> list[IntegerBall]:
        """w: that of a set is ± the minor of the right solutions in the rows that are not in it."""
        minors = dict(zip(combinations(range(self.n), self.n - self.k), self.admitted(1, sigma), strict=True))
        out = []
        for chosen in self.subsets:
            w = minors[tuple(j for j in range(self.n) if j not in chosen)]
            out.append(IntegerBall(-w.x, -w.y, w.r) if sum(chosen) % 2 else w)
        return out

    def at_sigma(self, parts: Any, sigma: IntegerBall) -> Any:
        """c_0, f_j and G_j from polynomials in σ."""
        c, B = parts
        series = self.combined(c, sigma)
        inverse = self.inverse(series[0])
        f = [self.times(x, inverse) for x in series[1:]]
        return f, {at: [self.times(x, inverse) for x in self.combined(entry, sigma)] for at, entry in B.items()}

    def combined(self, entry: list[list[IntegerBall]], sigma: IntegerBall) -> list[IntegerBall]:
        out = [IntegerBall(0, 0, 0)] * max(map(len, entry))
        for part in reversed(entry):
            out = [self.times(x, sigma) for x in out]
            for j, x in enumerate(part):
                out[j] = self.plus(out[j], x)
        return out

    def compound(self, f: list[IntegerBall], G: dict[tuple[int, int], list[IntegerBall]]) -> Any:
        """f and the matrix of the minors by its non-zero entries."""
        place, out = {s: i for i, s in enumerate(self.subsets)}, dict[tuple[int, int], list[IntegerBall]]()
        for row, subset in enumerate(self.subsets):
            for at, i in enumerate(subset):
                for j in range(self.n):
                    if (i, j) not in G or (j in subset and j != i):
                        continue
                    J = [*subset[:at], j, *subset[at + 1 :]]
                    odd = sum(a > b for a, b in combinations(J, 2)) % 2
                    cell, known = (row, place[tuple(sorted(J))]), G[i, j]
                    term = [IntegerBall(-x.x, -x.y, x.r) for x in known] if odd else known
                    before = out.get(cell, [])
                    longer, shorter = (term, before) if len(term) > len(before) else (before, term)
                    out[cell] = [self.plus(x, shorter[p]) if p < len(shorter) else x for p, x in enumerate(longer)]
        return f, out

    def step(self, y: list[IntegerBall], parts: Any) -> list[IntegerBall]:
        """y at the end of a step (R1)."""
        f, G = parts
        P, N, size = self.P, self.N, len(y)
        weights = [sum(self.weights[i] for i in subset) for subset in self.subsets]
        last = self.room(f, G, weights, 0, 1)
        sparse = [(i, j, [(x.x, x.y, x.r, abs(x.x) + abs(x.y)) for x in entry]) for (i, j), entry in G.items()]
        common = [(x.x, x.y, x.r, abs(x.x) + abs(x.y)) for x in f]
        terms = [list(y)]
        sizes = [[length(x) for x in y]]
        for m in range(1, N):
            total = [[0, 0, 0] for _ in range(size)]
            for i, j, entry in sparse:
                row = total[i]
                for p, (a, b, e, long) in enumerate(entry[:m]):
                    u, v, d = terms[m - 1 - p][j]
                    row[0] += a * u - b * v
                    row[1] += a * v + b * u
                    row[2] += long * d + e * sizes[m - 1 - p][j]
            for p, (a, b, e, long) in enumerate(common[: m - 1], 1):
                for i, row in enumerate(total):
                    u, v, d = terms[m - p][i]
                    row[0] -= (m - p) * (a * u - b * v)
                    row[1] -= (m - p) * (a * v + b * u)
                    row[2] += (m - p) * (long * d + e * sizes[m - p][i])
            over = m << P
            terms.append([IntegerBall(x // over, z // over, r // over + 3) for x, z, r in total])
            sizes.append([length(x) for x in terms[-1]])
        return self.summed(terms, weights, last)

    def room(self, f: list[IntegerBall], G: dict[tuple[int, int], list[IntegerBall]], weights: list[int], first: int, less: Any) -> int:
        """The last i with a b_i. Raises RefusedPencilError where Σ b_i 2^i > 1: b_i = (|f_i| + ‖G_{i−1+first}‖/N)/less."""
        norms = self.norms(G, weights)
        count = max(len(f), len(norms) - first)
        b = [Fraction(length(f[i - 1])) if i <= len(f) else Fraction(0) for i in range(1, count + 1)]
        b = [x + Fraction(norms[i + first]) / self.N if i + first < len(norms) else x for i, x in enumerate(b)]
        if sum(x * 2**i for i, x in enumerate(b, 1)) > less * 2**self.P:
            raise RefusedPencilError("the tail of a series is not bounded: the order is too low, or a step or reach too long")
        if count >= self.N:
            raise RefusedPencilError("the order is below the degree of the coefficients")
        return count

    def norms(self, G: dict[tuple[int, int], list[IntegerBall]], weights: list[int]) -> list[Fraction]:
        """‖G_j‖ in units of the last place, upper bounds."""
        rows: list[dict[int, Fraction]] = []
        for (i, j), entry in G.items():
            scale = Fraction(2) ** (weights[j] - weights[i])
            for p, x in enumerate(entry):
                while len(rows) <= p:
                    rows.append({})
                rows[p][i] = rows[p].get(i, Fraction(0)) + length(x) * scale
        return [max(row.values(), default=Fraction(0)) for row in rows]

    def summed(self, terms: list[list[IntegerBall]], weights: list[int], last: int) -> list[IntegerBall]:
        """Σ_m, wider by what is left out."""
        A = Fraction(0)
        for i in range(1, last + 1):
            A = max(A, max(Fraction(length(x)) / Fraction(2) ** w for x, w in zip(terms[-i], weights, strict=True)) / 2**i)
        out = []
        for i, w in enumerate(weights):
            total = IntegerBall(*(sum(term[i][part] for term in terms) for part in range(3)))
            out.append(IntegerBall(total.x, total.y, total.r + _above(2 * A * Fraction(2) ** w) + 1))
        return out

    def singular(self, end: CertifiedEnd, start: Any, sigma: IntegerBall) -> list[IntegerBall]:
        """Minors of the solutions that a singular end admits, at its reach (R2)."""
        f, G = self.at_sigma(start, sigma)
        n, N, unit = self.n, self.N, None
        degree = max([len(f), *(len(entry) for entry in G.values())])
        dense = [
            [[G[i, j][p] if (i, j) in G and p < len(G[i, j]) else IntegerBall(0, 0, 0) for j in range(n)] for i in range(n)]
            for p in range(degree)
        ]
        norms = self.norms(G, self.weights)
        leading = Fraction(norms[0]) / 2**self.P if norms else Fraction(0)
        if not leading < N:
            raise RefusedPencilError("the order is below the exponents of a singular end")
        last = self.room(f, G, self.weights, 1, 1 - leading / N)
        if end.kind == "infinity":
            pairs = self.decaying(dense[0], end.admitted)
            columns = []
            for mu, vector in pairs:
                columns += self.continued(f, dense, mu, [[[x] for x in vector]], last)
            if end.pivots is None:
                end.pivots = max(
                    combinations(range(n), end.admitted),
                    key=lambda rows: abs(mp.det(mp.matrix([[self.guess(v[i]) for _, v in pairs] for i in rows])) if rows else mp.one),
                )
            unit = self.determinant([[vector[i] for _, vector in pairs] for i in end.pivots])
        else:
            columns = self.continued(f, dense, IntegerBall(0, 0, 0), self.beginning(end, f, dense, sigma), last)
        minors = [self.determinant([[column[i] for column in columns] for i in rows]) for rows in combinations(range(n), end.admitted)]
        if unit is None:
            return minors
        inverse = self.inverse(unit)
        return [self.times(x, inverse) for x in minors]

    def continued(
        self, f: list[IntegerBall], G: Any, mu: IntegerBall, first: list[list[list[IntegerBall]]], last: int
    ) -> list[list[IntegerBall]]:
        """The columns Σ_m P_m of solutions whose first terms are given, by order, component and column."""
        terms, every = [*first], range(self.n)
        for m in range(len(terms), self.N):
            at = self.plus(mu, self.exact(Fraction(m)))
            L = [[self.plus(at if i == j else IntegerBall(0, 0, 0), self.minus(G[0][i][j])) for j in every] for i in every]
            right = [[IntegerBall(0, 0, 0)] * len(first[0][0]) for _ in every]
            for p in range(1, min(m, max(len(f), len(G) - 1)) + 1):
                weight = self.plus(mu, self.exact(Fraction(m - p)))
                own = self.minus(self.times(f[p - 1], weight)) if p <= len(f) else None
                for i in every:
                    for q, _ in enumerate(right[i]):
                        if own is not None:
                            right[i][q] = self.plus(right[i][q], self.times(own, terms[m - p][i][q]))
                        if p < len(G):
                            for j in every:
                                if G[p][i][j] != (0, 0, 0):
                                    right[i][q] = self.plus(right[i][q], self.times(G[p][i][j], terms[m - p][j][q]))
            terms.append(self.solved(L, right))
        return [self.summed([[row[q] for row in term] for term in terms], self.weights, last) for q in range(len(first[0][0]))]

    def decaying(self, A: list[list[IntegerBall]], count: int) -> list[tuple[IntegerBall, list[IntegerBall]]]:
        """(μ, eigenvector) of the eigenvalues with a positive real part, as many as are claimed, while all others lie on the left."""
        every = range(self.n)
        _, found = mp.eig(mp.matrix([[self.guess(x) for x in row] for row in A]))
        V = [[self.exact(_rational(mp.re(found[i, j])), _rational(mp.im(found[i, j]))) for j in every] for i in every]
        M = self.solved(V, [[self.dot(row, [V[p][q] for p in every]) for q in every] for row in A])
        rho = [sum(length(M[i][j]) for j in every if j != i) for i in every]
        out = []
        for q in every:
            gaps = [_least(self.plus(M[q][q], self.minus(M[j][j]))) - rho[q] if j != q else 1 for j in every]
            if any(gaps[j] <= rho[j] for j in every if j != q):
                raise RefusedPencilError("two exponents at infinity are not told apart")
            mu = IntegerBall(M[q][q].x, M[q][q].y, M[q][q].r + rho[q])
            if mu.x - mu.r > 0:
                w = [IntegerBall(1 << self.P, 0, 0) if j == q else IntegerBall(0, 0, (rho[j] << self.P) // gaps[j] + 1) for j in every]
                out.append((mu, [self.dot(row, w) for row in V]))
            elif not mu.x + mu.r < 0:
                raise RefusedPencilError("an exponent at infinity may lie on the imaginary axis")
        if len(out) != count:
            raise RefusedPencilError(f"{len(out)} of {self.n} solutions decay, where {count} are claimed")
        return out

    def beginning(self, end: CertifiedEnd, f: list[IntegerBall], G: Any, sigma: IntegerBall) -> list[list[list[IntegerBall]]]:
        """The first terms of the solutions that are regular at an axis."""
        n, count = self.n, end.orders
        columns = [(m, j) for m in range(count) for j in range(n) if m >= end.least[j]]
        r, zero = len(columns) - end.admitted, IntegerBall(0, 0, 0)

        def entry(m: int, i: int, q: int, j: int) -> IntegerBall:
            """The factor of P_q,j in the equation of order m, row i."""
            p = m - q
            out = self.minus(G[p][i][j]) if 0 <= p < len(G) else zero
            if i == j and p == 0:
                out = self.plus(out, self.exact(Fraction(m)))
            return self.plus(out, self.times(f[p - 1], self.exact(Fraction(q)))) if i == j and 1 <= p <= len(f) else out

        M = [[entry(m, i, q, j) if q <= m else zero for q, j in columns] for m in range(count) for i in range(n)]
        if end.pivots is None:
            end.pivots = self.pivots(M, r)
            self.require_rank(end, columns, r)
        rows, chosen = end.pivots
        free = [q for q in range(len(columns)) if q not in chosen]
        right = [[self.minus(M[i][q]) for q in free] for i in rows]
        found = self.solved([[M[i][q] for q in chosen] for i in rows], right) if r else []
        out = [[[zero] * end.admitted for _ in range(n)] for _ in range(count)]
        for at, place in enumerate(chosen):
            m, j = columns[place]
            out[m][j] = list(found[at])
        for at, place in enumerate(free):
            m, j = columns[place]
            out[m][j][at] = IntegerBall(1 << self.P, 0, 0)
        return out

    def pivots(self, M: list[list[IntegerBall]], r: int) -> tuple[list[int], list[int]]:
        """Rows and columns of a block of that size, by elimination with the largest pivots."""
        A = [[self.guess(x) for x in row] for row in M]
        rows, columns = [], []
        for _ in range(r):
            left = [(abs(A[i][j]), i, j) for i in range(len(A)) if i not in rows for j in range(len(A[0])) if j not in columns]
            size, i, j = max(left, default=(mp.zero, 0, 0))
            if not size > 0:
                raise RefusedPencilError("more solutions are regular at an axis than is claimed")
            rows.append(i)
            columns.append(j)
            for other in range(len(A)):
                if other not in rows and A[other][j]:
                    factor = A[other][j] / A[i][j]
                    A[other] = [a - factor * b for a, b in zip(A[other], A[i], strict=True)]
        return rows, columns

    def require_rank(self, end: CertifiedEnd, columns: list[tuple[int, int]], r: int) -> None:
        """Raises RefusedPencilError unless the rank of the beginning is r at most for every σ."""
        layer, direction = (self.layers[0], 1) if end is self.left else (self.layers[-1], -1)
        c = [part[1:] for part in _shifted(layer["c"], end.at, direction * end.reach)]
        B = {at: _shifted(entry, end.at, direction * end.reach) for at, entry in layer["B"].items()}
        highest = max([len(c), *(len(entry) for entry in B.values())]) - 1
        for sigma in range(1, highest * (r + 1) + 2):
            at_c = _at(c, sigma)
            at_B = {at: [(x * direction * end.reach, y * direction * end.reach) for x, y in _at(entry, sigma)] for at, entry in B.items()}
            M = []
            for m in range(end.orders):
                for i in range(self.n):
                    row = []
                    for q, j in columns:
                        p, (x, y) = m - q, (Fraction(0), Fraction(0))
                        if 0 <= p < len(at_c) and i == j:
                            x, y = q * at_c[p][0], q * at_c[p][1]
                        if 0 <= p < len(at_B.get((i, j), ())):
                            x, y = x - at_B[i, j][p][0], y - at_B[i, j][p][1]
                        row.append((x, y))
                    M.append(row)
            if _rank(M) > r:
                raise RefusedPencilError("fewer solutions are regular at an axis than is claimed")

    def across(self, y: list[IntegerBall], joint: Any, sigma: IntegerBall) -> list[IntegerBall]:
        """The minors behind a joint."""
        before, behind = (self.rows_at(rows, sigma) for rows in joint)
        T = self.solved(behind, [[self.minus(x) for x in row] for row in before])
        out = []
        for rows in self.subsets:
            total = IntegerBall(0, 0, 0)
            for columns, x in zip(self.subsets, y, strict=True):
                total = self.plus(total, self.times(self.determinant([[T[i][j] for j in columns] for i in rows]), x))
            out.append(total)
        return out

    def rows_at(self, rows: list[list[list[GaussianRational]]], sigma: IntegerBall) -> list[list[IntegerBall]]:
        return [
            [self.combined([[self.exact(*a)] for a in entry], sigma)[0] if entry else IntegerBall(0, 0, 0) for entry in row] for row in rows
        ]

    def determinant(self, A: list[list[IntegerBall]]) -> IntegerBall:
        """The determinant, expanded along rows; every set of columns is taken once."""
        known: dict[tuple[int, ...], IntegerBall] = {(): IntegerBall(1 << self.P, 0, 0)}
        for i, row in enumerate(A):
            found: dict[Any, IntegerBall] = {}
            for chosen in combinations(range(len(A)), i + 1):
                total = IntegerBall(0, 0, 0)
                for at, j in enumerate(chosen):
                    term = self.times(row[j], known[chosen[:at] + chosen[at + 1 :]])
                    total = self.plus(total, self.minus(term) if (i + at) % 2 else term)
                found[chosen] = total
            known = found
        return known[tuple(range(len(A)))]

    def solved(self, A: list[list[IntegerBall]], B: list[list[IntegerBall]]) -> list[list[IntegerBall]]:
        """A⁻¹ B by elimination."""
        rows = [[*a, *b] for a, b in zip(A, B, strict=True)]
        n = len(rows)
        for k in range(n):
            top = max(range(k, n), key=lambda i: _least(rows[i][k]))
            rows[k], rows[top] = rows[top], rows[k]
            inverse = self.inverse(rows[k][k])
            rows[k] = [self.times(x, inverse) if j > k else x for j, x in enumerate(rows[k])]
            for i in range(n):
                if i != k and rows[i][k] != (0, 0, 0):
                    factor = self.minus(rows[i][k])
                    rows[i] = [self.plus(x, self.times(factor, rows[k][j])) if j > k else x for j, x in enumerate(rows[i])]
        return [row[n:] for row in rows]

    def dot(self, a: list[IntegerBall], b: list[IntegerBall]) -> IntegerBall:
        total = IntegerBall(0, 0, 0)
        for x, y in zip(a, b, strict=True):
            total = self.plus(total, self.times(x, y))
        return total

    def exact(self, re_part: Fraction, im_part: Fraction = Fraction(0), off: int = 0) -> IntegerBall:
        x, y = ((v.numerator << self.P) // v.denominator for v in (re_part, im_part))
        whole = (v.denominator & (v.denominator - 1) == 0 and v.denominator <= 1 << self.P for v in (re_part, im_part))
        return IntegerBall(x, y, off + (0 if all(whole) else 2))

    def up(self, x: Any) -> int:  # an integer ≥ x of mpmath.iv in units of the last place
        return int(_fraction(x.b) * (1 << self.P)) + 2

    def guess(self, a: IntegerBall) -> Any:
        return mp.mpc(mp.mpf(a.x), mp.mpf(a.y)) / mp.mpf(2) ** self.P

    def plus(self, a: IntegerBall, b: IntegerBall) -> IntegerBall:
        return IntegerBall(a.x + b.x, a.y + b.y, a.r + b.r)

    def minus(self, a: IntegerBall) -> IntegerBall:
        return IntegerBall(-a.x, -a.y, a.r)

    def times(self, a: IntegerBall, b: IntegerBall) -> IntegerBall:
        P, long = self.P, abs(a.x) + abs(a.y)
        r = (long * b.r + length(b) * a.r >> P) + 3
        return IntegerBall((a.x * b.x - a.y * b.y) >> P, (a.x * b.y + a.y * b.x) >> P, r)

    def inverse(self, a: IntegerBall) -> IntegerBall:
        """1/a: 1/a − 1/b = (b − a)/(ab). Raises RefusedPencilError where a may be 0."""
        least, square = _least(a), a.x**2 + a.y**2
        if least <= 0:
            raise RefusedPencilError("a number that must not vanish may do so: more bits, a smaller outer circle or other steps are needed")
        room = (a.r << 2 * self.P) // (least * math.isqrt(square)) + 3
        return IntegerBall((a.x << 2 * self.P) // square, (-a.y << 2 * self.P) // square, room)


def half_diagonal(width: Fraction, height: Fraction) -> Fraction:
    """No less than that of a rectangle."""
    square = (width**2 + height**2) / 4
    return Fraction(math.isqrt(square.numerator * square.denominator << 2 * ROOT_BITS) + 1, square.denominator << ROOT_BITS)


def _turned(a: tuple[int, int], b: tuple[int, int]) -> float:
    """arg b/a; the ends of pieces are the same numbers for both neighbours, so that what doubles lose is all that the sum loses."""
    x, y = b[0] * a[0] + b[1] * a[1], b[1] * a[0] - b[0] * a[1]
    size = max(abs(x), abs(y))
    return math.atan2((y << QUOTIENT_BITS) / size, (x << QUOTIENT_BITS) / size)


def length(a: IntegerBall) -> int:  # an integer ≥ |a| in units of the last place
    return abs(a.x) + abs(a.y) + a.r


def _least(a: IntegerBall) -> int:  # an integer ≤ |a| in units of the last place
    return math.isqrt(a.x**2 + a.y**2) - a.r


def _above(x: Fraction) -> int:
    return -((-x.numerator) // x.denominator)


def _shifted(entry: list[list[GaussianRational]], at: Fraction, h: Fraction) -> list[list[GaussianRational]]:
    """p(at + h t) by powers of t, for each power of σ."""
    out = []
    for part in entry:
        c = list(part) or [(Fraction(0), Fraction(0))]
        for i in range(len(c)):
            for j in range(len(c) - 2, i - 1, -1):
                c[j] = c[j][0] + at * c[j + 1][0], c[j][1] + at * c[j + 1][1]
        out.append([(x * h**j, y * h**j) for j, (x, y) in enumerate(c)])
    return out


def _at(entry: list[list[GaussianRational]], sigma: int) -> list[GaussianRational]:
    """The polynomial in t at a whole σ."""
    out = [(Fraction(0), Fraction(0))] * max(map(len, entry))
    for power, part in enumerate(entry):
        for j, (x, y) in enumerate(part):
            out[j] = out[j][0] + x * sigma**power, out[j][1] + y * sigma**power
    return out


def _rank(M: list[list[GaussianRational]]) -> int:
    rows, rank = [list(row) for row in M], 0
    for column in range(len(M[0]) if M else 0):
        pivot = next((i for i in range(rank, len(rows)) if rows[i][column] != PENCIL_NOTHING), None)
        if pivot is None:
            continue
        rows[rank], rows[pivot] = rows[pivot], rows[rank]
        a, b = rows[rank][column]
        for i in range(rank + 1, len(rows)):
            u, v = rows[i][column]
            if (u, v) != PENCIL_NOTHING:
                size = a * a + b * b
                s, t = (u * a + v * b) / size, (v * a - u * b) / size
                rows[i] = [(x - s * p + t * q, y - s * q - t * p) for (x, y), (p, q) in zip(rows[i], rows[rank], strict=True)]
        rank += 1
    return rank


def _rational(x: Any) -> Fraction:  # the value of a number of mpmath
    mantissa, exponent = x.man_exp
    sign = -1 if x < 0 else 1
    return Fraction(sign * abs(int(mantissa))) * (Fraction(1 << exponent) if exponent >= 0 else Fraction(1, 1 << -exponent))


def _fraction(x: Any) -> Fraction:  # the value of an mpmath.iv with two equal ends, of which mpmath keeps 53 bits if not told otherwise
    return _rational(mp.mpf(x, prec=2 * iv.prec))


def main() -> int:
    """Exit status 0 where the certificate proves its statement, 1 where it does not."""
    try:
        certificate = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    except (IndexError, OSError, ValueError, RecursionError) as error:
        print(f"{str(__doc__).splitlines()[0]} Not one: {error}")
        return 2
    print("proved" if (reason := check(certificate)) is None else f"refused: {reason}")
    return int(reason is not None)


if __name__ == "__main__":
    sys.exit(main())
