"""Check a certificate on modes of plane Poiseuille flow. Run as `python plane_poiseuille.py CERTIFICATE`.

It claims that exactly n even or odd modes, with multiplicity, lie in a disc or rectangle, or have Re σ ≥ a floor. This file shares
nothing with the program that wrote it but mpmath: cos, sin, exp and π in intervals. A `Ball` (x, y, r) of integers is |z − (x + iy) 2^−P|
≤ r 2^−P.

Equation.  (D² − α²)² φ = R [(σ + iαU)(D² − α²) − iαU″] φ with U = 1 − y², that is φ⁗ = p φ″ + q φ with

    p = 2α² + R s,  q = −α⁴ − R α² s + 2iαR,  s = σ + iα(1 − y²).

φ_1, φ_2 begin at y = 0 with (φ, φ′, φ″, φ‴) = (1, 0, 0, 0), (0, 0, 1, 0) for even φ, (0, 1, 0, 0), (0, 0, 0, 1) for odd ones. Modes are
the zeros of D(σ) = φ_1 φ_2′ − φ_1′ φ_2 at y = 1.

Steps.  φ = Σ f_m t^m, y = y_0 + h t; with h² p = Σ p_j t^j, h⁴ q = Σ q_j t^j (j ≤ 2)

    (m+4)(m+3)(m+2)(m+1) f_{m+4} = Σ_j p_j (m−j+2)(m−j+1) f_{m−j+2} + Σ_j q_j f_{m−j}.

If |f_m| ≤ A 2^−m for the last six m below N, and Σ|p_j| 2^{2+j}/(N(N−1)) + Σ|q_j| 2^{4+j}/(N(N−1)(N−2)(N−3)) ≤ 1, then |f_m| ≤ A 2^−m
for all m ≥ N by induction; as (N + i)/N ≤ 1 + i, Σ_{m≥N} m³ |f_m| ≤ 52 A N³ 2^−N, which bounds what φ, φ′, φ″, φ‴ lack.

Growth.  The minors y = ([01], [02], [03], [12], [13], [23]) of (φ_1, φ_2) obey y_1′ = y_2, y_2′ = y_3 + y_4, y_3′ = p y_2 + y_5, y_4′ =
y_5, y_5′ = y_6 + p y_4 − q y_1, y_6′ = −q y_2. In the norm max |y_i|/w_i, w = (1, k, k², k², k³, k⁴), the logarithmic norm is at most
k max(2, 1 + |p|/k² + |q|/k⁴): so |D| ≤ |y(start)|_w exp ∫ of that.

Disc.  From K values of D on |σ − c| = r and |D| ≤ M on |σ − c| ≤ ρ, q = r/ρ: the discrete Fourier coefficients miss d_k r^k by at most
M q^{k+K}/(1 − q^K), the rest of the Taylor series is below M q^K/(1 − q); |d_n| r^n > Σ_{k≠n} |d_k| r^k + rest proves n zeros (Pellet).

Growing.  With Q = ∫|φ′|² + α²|φ|², φ* times the equation gives c_r Q = ∫U(|φ′|² + α²|φ|²) − ∫|φ|² and c_i Q ≤ 2 ∫|φ′||φ|; with λ = π²/4
and ∫|φ′|² ≥ λ ∫|φ|², every mode has −α ≤ Im σ ≤ α/(λ + α²) and Re σ ≤ 2α√λ/(λ + α²), or 1 where α² > λ. On the disc around that
rectangle D = Σ_{k<K} a_k u^k up to a spread e. Where Σ_{k≥1} |c_k| s^k + 4e < |c_0| for the series about the middle of a piece of the
boundary of half length s, D is there within a quarter turn of its value at the middle, and the turns of the pieces add up to the count.
So it is for a rectangle that the certificate names.
"""

import json
import math
import re
import sys
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple

from mpmath import iv, mp

NAMED_SIDES = {"left", "low", "right", "high"}
KEYS = {"format", "problem", "count", "region", "outer", "weight", "points", "bits", "order", "steps"}
MOST_CHECKING = 10**6  # chosen: points × steps × order, minutes; certificates of a thousand digits take 10⁵
MOST_BOUNDARY_STEPS, MOST_NUMBERS = 4000, 10_000  # chosen: steps along the boundary of all that grows, some 20 ms each; decimals in a file
LIMITS = {"count": (0, 64), "points": (2, 4096), "bits": (53, 20_000), "order": (12, 5000)}  # chosen: least and most of each
FIRST_PIECE, SHORTEST_PIECE = Fraction(1, 64), Fraction(1, 2**48)  # chosen: pieces of a side of the boundary
GRID, WAY_CELLS, TURN_BITS = 2**20, 64, 60  # chosen: steps of 1 for lengths rounded up; cells of the way for a bound; bits of a ratio
TAIL, LACKING = 52, 0.01  # derived: the 52 under Steps, above; chosen: part of a turn by which a sum of doubles may miss a whole one
DECIMAL = re.compile(r"-?\d{1,2000}(\.\d{1,2000})?(e-?\d{1,4})?")
BEGIN = {"even": ((0, 2), 1), "odd": ((1, 3), 3)}  # the free states, and the power of k in the weight of their minor


class Ball(NamedTuple):
    x: int
    y: int
    r: int


def check(certificate: Any) -> str | None:
    """None where the certificate, or every one of its parts, proves what it says; else the reason why it does not."""
    if isinstance(certificate, dict) and set(certificate) == {"format", "parts"} and isinstance(certificate["parts"], list):
        return next(filter(None, map(check, certificate["parts"])), None)
    try:
        _read(certificate)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        return f"not a certificate of this kind: {error}"
    saved, iv.prec = iv.prec, certificate["bits"]
    try:
        return Checker(certificate).reason()
    finally:
        iv.prec = saved


def _read(certificate: Any) -> None:
    """A look at the form of everything. Raises ValueError and its like."""
    if set(certificate) != KEYS or certificate["format"] != 2:
        raise ValueError(f"its keys are to be {', '.join(sorted(KEYS))}, its format 2")
    problem, region = certificate["problem"], certificate["region"]
    named = set(problem) == {"name", "reynolds", "alpha", "modes"} and problem["name"] == "plane Poiseuille" and problem["modes"] in BEGIN
    if not named or set(region) not in ({"re", "im", "radius"}, {"floor"}, NAMED_SIDES):
        raise ValueError("problem, or region")
    texts = [problem["reynolds"], problem["alpha"], *region.values(), certificate["outer"], certificate["weight"], *certificate["steps"]]
    if len(texts) > MOST_NUMBERS or not all(isinstance(x, str) and DECIMAL.fullmatch(x) for x in texts):
        raise ValueError("a number is no decimal in quotes")
    for name, (low, high) in LIMITS.items():
        if type(certificate[name]) is not int or not low <= certificate[name] <= high:
            raise ValueError(f"{name} = {certificate[name]!r}")
    if certificate["points"] * (len(certificate["steps"]) + 1) * certificate["order"] > MOST_CHECKING:
        raise ValueError("points, steps and order ask for more work than any certificate needs")


class Checker:
    """One certificate, its decimals as fractions."""

    def __init__(self, certificate: Any) -> None:
        problem, region = certificate["problem"], certificate["region"]
        self.P, self.N, self.K, self.n = (certificate[name] for name in ("bits", "order", "points", "count"))
        self.R, self.alpha = Fraction(problem["reynolds"]), Fraction(problem["alpha"])
        self.outer, self.k = Fraction(certificate["outer"]), Fraction(certificate["weight"])
        self.free, self.power = BEGIN[problem["modes"]]
        self.steps = [Fraction(h) for h in certificate["steps"]]
        self.along = "radius" not in region
        if not self.along:
            self.centre, self.radius = (Fraction(region["re"]), Fraction(region["im"])), Fraction(region["radius"])
        else:
            sides = [Fraction(region.get(side, 0)) for side in ("left", "low", "right", "high")]
            ends: Any = self.rectangle(Fraction(region["floor"])) if "floor" in region else (sides[:2], sides[2:])
            self.low, self.high = ends
            self.centre = ((self.low[0] + self.high[0]) / 2, (self.low[1] + self.high[1]) / 2)
            half = [(b - a) / 2 for a, b in zip(self.low, self.high, strict=True)]
            self.radius = Fraction(math.isqrt(math.ceil((half[0] ** 2 + half[1] ** 2) * GRID**2)) + 2, GRID)

    def reason(self) -> str | None:
        """Why the certificate does not hold; None where it does."""
        if not all(x > 0 for x in (self.R, self.alpha, self.radius, self.k, *self.steps)) or not self.outer > self.radius:
            return "a number that must be positive is not, or the outer circle is not the larger one"
        if self.n >= self.K or not sum(self.steps) < 1 or (self.along and not all(a < b for a, b in zip(self.low, self.high, strict=True))):
            return "more zeros than points, steps beyond the wall, a floor above all modes, or a rectangle without an inside"
        self.steps.append(1 - sum(self.steps, Fraction(0)))
        turns = [(iv.cos(2 * iv.pi * j / self.K), iv.sin(2 * iv.pi * j / self.K)) for j in range(self.K)]
        roots = [self.exact(_fraction(c.mid), _fraction(s.mid), self.up(c.delta + s.delta)) for c, s in turns]
        centre, radius = self.exact(*self.centre), self.exact(self.radius)
        values: Any = [self.value(self.plus(centre, self.times(radius, w))) for w in roots]
        if any(v is None for v in values):
            return "the tail of a Taylor step is not bounded: the order is too low for the steps"
        M, q = self.bound(self.centre, self.outer), iv.mpf((x := self.radius / self.outer).numerator) / x.denominator
        cut = M * q**self.K / (1 - q)
        if not cut.b < iv.mpf(self.K * max(map(length, values))) / 2**self.P:
            return "what the series leaves out may be larger than all that it holds: no inequality can hold with this outer circle"
        coefficients = []
        for m in range(self.K):
            total = Ball(0, 0, 0)
            for j, v in enumerate(values):
                total = self.plus(total, self.times(v, roots[-j * m % self.K]))
            off = self.up(M * q ** (m + self.K) / (1 - q**self.K))
            coefficients.append(Ball(total.x // self.K, total.y // self.K, total.r // self.K + 3 + off))
        rest = self.up(cut)
        if self.along:
            return self.followed(coefficients, rest)
        leading = coefficients.pop(self.n)
        holds = math.isqrt(leading.x**2 + leading.y**2) - leading.r > sum(map(length, coefficients)) + rest
        return None if holds else f"Pellet's inequality does not hold for n = {self.n}"

    def followed(self, d: list[Ball], rest: int) -> str | None:
        """The turns of D along the boundary of the rectangle, counter-clockwise."""
        spread, a = rest + sum(x.r for x in d), [(x.x, x.y) for x in d]
        off = [0] * self.K  # what the shift to a middle, |u| ≤ 1, loses by rounding, of every coefficient
        for i in range(self.K):
            for j in range(self.K - 2, i - 1, -1):
                off[j] += off[j + 1] + 2
        (left, low), (right, high) = self.low, self.high
        corners, turns, walked = [(left, low), (right, low), (right, high), (left, high)], 0.0, 0
        for begin, end in zip(corners, [*corners[1:], corners[0]], strict=True):
            here, step = Fraction(0), FIRST_PIECE
            while here < 1:
                if (walked := walked + 1) > MOST_BOUNDARY_STEPS:
                    return f"the boundary asks for more than {MOST_BOUNDARY_STEPS} steps"
                ahead = min(Fraction(1), here + step)
                at = [[b + (e - b) * t for b, e in zip(begin, end, strict=True)] for t in (here, (here + ahead) / 2, ahead)]
                s = (ahead - here) / 2 * (abs(end[0] - begin[0]) + abs(end[1] - begin[1])) / self.radius
                c = self.shifted(a, at[1])
                others, power, unit = 0, 1 << self.P, math.ceil(s * 2**self.P) + 2
                for (x, y), lost in zip(c[1:], off[1:], strict=True):
                    power = (power * unit >> self.P) + 1
                    others += ((math.isqrt(x * x + y * y) + 1 + lost) * power >> self.P) + 1
                if others + 4 * (spread + off[0]) >= math.isqrt(c[0][0] ** 2 + c[0][1] ** 2):
                    step = (ahead - here) / 2
                    if step < SHORTEST_PIECE:
                        return f"a mode lies too near to the boundary, {float(here):.3g} of the way from {complex(*map(float, begin)):.6g}"
                    continue
                ends = [self.shifted(a, sigma, 1)[0] for sigma in (at[0], at[2])]
                turns += _turn(ends[0], c[0]) + _turn(c[0], ends[1])
                here, step = ahead, (ahead - here) * 2
        count = turns / (2 * math.pi)
        return None if abs(count - self.n) < LACKING else f"{self.n} are claimed, and {count:.3f} counted"

    def shifted(self, a: list[tuple[int, int]], sigma: list[Fraction], terms: int | None = None) -> list[tuple[int, int]]:
        """The first coefficients of Σ a_k (u + v)^k in powers of v, u that of σ, each rounding below 2 units of the last place."""
        (x, y), P = (math.floor((s - c) / self.radius * 2**self.P) for s, c in zip(sigma, self.centre, strict=True)), self.P
        re, im = [v[0] for v in a], [v[1] for v in a]
        for i in range(self.K if terms is None else terms):
            for j in range(self.K - 2, i - 1, -1):
                b, c = re[j + 1], im[j + 1]
                re[j] += (b * x - c * y) >> P
                im[j] += (b * y + c * x) >> P
        return list(zip(re, im, strict=True))

    def rectangle(self, floor: Fraction) -> Any:
        """Corners of a rectangle that holds all modes with Re σ ≥ floor."""
        a = iv.mpf(self.alpha.numerator) / self.alpha.denominator
        root = iv.pi / 2
        top = 2 * a * root / (root**2 + a**2) if (a**2).b < (root**2).a else iv.mpf(1)
        margin = Fraction(1, GRID)
        return (floor, -self.alpha - margin), (_fraction(top.b) + margin, _fraction((a / (root**2 + a**2)).b) + margin)

    def value(self, sigma: Ball) -> Ball | None:
        """D(σ), None where a tail is not bounded."""
        states = [[self.exact(Fraction(int(i == j))) for i in range(4)] for j in self.free]
        y, N, one, R, a = Fraction(0), self.N, 1 << self.P, self.R, self.alpha
        for h in self.steps:
            s = self.plus(sigma, self.exact(Fraction(0), a * (1 - y * y))), self.exact(Fraction(0), -2 * a * y), self.exact(Fraction(0), -a)
            p = [self.times(x, self.exact(R * h ** (2 + j))) for j, x in enumerate(s)]
            q = [self.times(x, self.exact(-R * a * a * h ** (4 + j))) for j, x in enumerate(s)]
            p[0] = self.plus(p[0], self.exact(2 * a * a * h * h))
            q[0] = self.plus(q[0], self.exact(-(a**4) * h**4, 2 * a * R * h**4))
            room = Fraction(sum(length(x) << (2 + j) for j, x in enumerate(p)), N * (N - 1) * one)
            room += Fraction(sum(length(x) << (4 + j) for j, x in enumerate(q)), N * (N - 1) * (N - 2) * (N - 3) * one)
            if room > 1:
                return None
            states = [self.step(state, h, p, q) for state in states]
            y += h
        (f, f1), (g, g1) = (state[:2] for state in states)
        product = self.times(f1, g)
        return self.plus(self.times(f, g1), Ball(-product.x, -product.y, product.r))

    def step(self, state: list[Ball], h: Fraction, p: list[Ball], q: list[Ball]) -> list[Ball]:
        """(φ, φ′, φ″, φ‴) at the end of a step."""
        f = [self.times(x, self.exact(h**i / math.factorial(i))) for i, x in enumerate(state)]
        size = [length(x) for x in f]
        pq, P = [(x.x, x.y, x.r, length(x) - x.r) for x in (*p, *q)], self.P
        for m in range(self.N - 4):
            x = y = r = 0
            for j in range(6):
                at = m - j + 2 if j < 3 else m - j + 3
                if at < 0 or (j < 3 and at < 2):
                    continue
                a, b, e, long = pq[j]
                u, v, d = f[at]
                w = at * (at - 1) if j < 3 else 1
                x += w * (a * u - b * v)
                y += w * (a * v + b * u)
                r += w * (long * d + e * size[at])
            n = ((m + 4) * (m + 3) * (m + 2) * (m + 1)) << P
            f.append(Ball(x // n, y // n, r // n + 3))
            size.append(length(f[-1]))
        A = max(size[m] << m for m in range(self.N - 6, self.N))
        lack = (TAIL * A * self.N**3 >> self.N) + 1
        ends = []
        for i in range(4):
            weights = [math.perm(m, i) for m in range(self.N)]
            total = Ball(*(sum(w * x[part] for w, x in zip(weights, f, strict=True)) for part in range(3)))
            ends.append(self.times(Ball(total.x, total.y, total.r + lack), self.exact(1 / h**i)))
        return ends

    def bound(self, centre: tuple[Fraction, Fraction], outer: Fraction) -> Any:
        """M ≥ |D| on |σ − centre| ≤ outer, a number of mpmath.iv; also for whoever must choose weight and points."""
        R, a, k, re, im, rim = (iv.mpf(x.numerator) / x.denominator for x in (self.R, self.alpha, self.k, *centre, outer))
        square = iv.mpf([-rim.b, rim.b])
        sigma, total = iv.mpc(re + square, im + square), iv.mpf(0)
        for i in range(WAY_CELLS):
            y = iv.mpf([i / WAY_CELLS, (i + 1) / WAY_CELLS])
            s = sigma + 1j * a * (1 - y * y)
            p, q = 2 * a**2 + R * s, -(a**4) - R * a**2 * s + 2j * a * R
            rate = 1 + abs(p) / k**2 + abs(q) / k**4
            total += k * max(2, rate.b) / WAY_CELLS
        return iv.exp(total) / k**self.power

    def exact(self, re: Fraction, im: Fraction = Fraction(0), off: int = 0) -> Ball:
        return Ball((re.numerator << self.P) // re.denominator, (im.numerator << self.P) // im.denominator, off + 2)

    def up(self, x: Any) -> int:  # an integer ≥ x of mpmath.iv in units of the last place
        return int(_fraction(x.b) * (1 << self.P)) + 2

    def plus(self, a: Ball, b: Ball) -> Ball:
        return Ball(a.x + b.x, a.y + b.y, a.r + b.r)

    def times(self, a: Ball, b: Ball) -> Ball:
        P, long = self.P, abs(a.x) + abs(a.y)
        r = (long * b.r + length(b) * a.r >> P) + 3
        return Ball((a.x * b.x - a.y * b.y) >> P, (a.x * b.y + a.y * b.x) >> P, r)


def length(a: Ball) -> int:  # an integer ≥ |a| in units of the last place
    return abs(a.x) + abs(a.y) + a.r


def _fraction(x: Any) -> Fraction:  # the value of an mpmath.iv with two equal ends, of which mpmath keeps 53 bits if not told otherwise
    mantissa, exponent = mp.mpf(x, prec=2 * iv.prec).man_exp
    return Fraction(int(mantissa) * (-1 if x < 0 else 1)) * (Fraction(1 << exponent) if exponent >= 0 else Fraction(1, 1 << -exponent))


def _turn(a: tuple[int, int], b: tuple[int, int]) -> float:
    """arg b/a; the ends of pieces are the same numbers for both neighbours, so that what doubles lose is all that the sum loses."""
    x, y = b[0] * a[0] + b[1] * a[1], b[1] * a[0] - b[0] * a[1]
    size = max(abs(x), abs(y))
    return math.atan2((y << TURN_BITS) / size, (x << TURN_BITS) / size)


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
