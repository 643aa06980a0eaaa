"""Check a certificate on modes of a granular chute flow. Run as `python granular_chute.py CERTIFICATE`.

It claims that a steady flow with exactly this mass flux exists whose T_∞ lies in a bracket, and that for every such flow (or for the
flow of a T_∞ that is typed) exactly n eigenvalues, with multiplicity, lie in a disc. This file shares nothing with the program that wrote
it but mpmath: π, exp, log and √ of numbers in intervals. An interval of ν tells at which base the flow ends; that its energy condition
holds nowhere above is not claimed. Lemmas: C2, C3, C5, E5, E6, E7, K1, K2, K3 of the guide's page on proofs.

Models (K1).  (c, r) stands for every f(t) with ‖f − Σ c_m t^m‖ ≤ r, ‖·‖ the ℓ¹ norm of coefficients on |t| ≤ 1; c_m are integers times
2^−P. Radii and norms are doubles; what adds or multiplies fewer than 10⁶ of them, all ≥ 0, is made larger by a part of 2^−30.

Steady flow.  p′ = −ν, u′ = tanθ p/η, q′ = tanθ² p²/η − γ, q = −K T′ + K* ν′, with p = g1 T, η = g2 √T, K = g3 √T, K* = g4 T^{3/2},
γ = g5 T^{3/2}. With Q = q/ν and M = g1′ g3 + g1 g4,

    ν′/ν = (g1 Q − g3 √T)/(M T^{3/2}),   T′/ν = −(g1′ Q + g4 √T)/(M √T),   Φ′ = −ν (u − u_∞).

From ν = 0 to `start` T, u, Q, Φ are series in ν, below Taylor series on `steps`; guesses of their terms are verified by comparison (K2).
At the base q/p = tanθ u − Δ √T and tanθ = T^{−1/2} √(2/π) (κu − (κ − ½A r²) u′), which gives u_∞; the mass flux is Φ + u_∞ p.

Perturbations.  Π = (p − ξ ∇·u) − 2η (∇u)°, unknowns n = ν̂/ν, û, v̂/i, ŵ, T̂, τ = −Π̂_xz, θ = −Π̂_yz/i, q̂. By conservation of mass
∇· = −Ω n − (ν′/ν) ŵ, Ω = σ + i k_x u. Then τ = η (û′ + i k_x ŵ) + η̂ u′ gives û′, and v̂′, ŵ′ are alike; momentum along x and y gives
τ′ and θ′, energy q̂′. The derivative of

    Π̂_zz = X n + b T̂ + λ (ν′/ν) ŵ + 2η (i k_x û + i k_y v̂),   X = aν + λΩ,   λ = ξ + 4η/3,

from momentum along z, and q̂ = −K T̂′ + K* ν̂′ + …, give n′ and T̂′: their determinant is X K + b K* ν. No coefficient is differentiated
but aν, b, η, λ and λν′/ν. Wall: ŵ = 0; with M = Π̂_zz − p S_z/√T, τ + (M S_x/√T)^ = 0, θ + p S_y/√T = 0, −q̂ + (τu)^ − Δ (M √T)^ = 0,

    S_x = √(2/π) (−κu + (κ − ½A r²) u′),   S_z = √(2/π) (−½A r² ∂u/∂x + B ∂w/∂z),   S_y like S_x,

and −½A r² ∂v/∂y in S_z where the wall is isotropic. D is the determinant of these rows on four solutions that decay.

Far field (K3).  In x = ν/start and with ∂ŵ/∂z in place of n, x ψ′ = B(x) ψ, ψ = P(x) x^Λ, Λ = ρ + Z: (m + ρ) P_m + P_m Z = Σ_j B_j P_{m−j}.
P_0 and Λ are those of ∇²u + ⅓∇∇·u = 0 and ∇²T̂ = 0: e^{−Bz}, B = K − s sᵀ/(7K), s = (i k_x, i k_y, −K), and e^{−Kz}.
"""

import json
import math
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction
from itertools import accumulate, chain
from operator import mul
from pathlib import Path
from typing import Any

from mpmath import iv, mp

NAMED = {
    "format",
    "problem",
    "count",
    "region",
    "flow",
    "outer",
    "points",
    "bits",
    "order",
    "far_order",
    "start",
    "steps",
    "slack",
    "lemmas",
}
RELIED_ON = ["C2", "C3", "C5", "E5", "E6", "E7", "K1", "K2", "K3"]
NUMBERS = ("e", "e_w", "r", "tan_theta", "nu_max", "kx", "ky")  # exact: parameters of a certificate that are decimals
ALLOWED_COUNTS = {
    "count": (0, 60),
    "points": (2, 64),
    "bits": (64, 480),
    "order": (8, 256),
    "far_order": (8, 256),
}  # chosen: what is checked in minutes
MOST_LENGTHS, MOST_PRODUCTS = 400, 10**8  # chosen: steps, and points × steps × order², an hour
DECIMAL_TEXT = re.compile(r"-?\d{1,400}(\.\d{1,400})?(e-?\d{1,3})?")
UP = 1 + 2.0**-30  # derived: more than 10⁶ additions of doubles lose
MORE = 1 + 2.0**-20  # derived: more than a thousand products made larger by UP
LARGEST = 10**6  # chosen: what numbers of a certificate lie below
VANISHED = 1e-300  # derived: what products of powers of q may lose below the smallest double
FEW_TERMS, TUBE = 16, 2.0**-24  # chosen: terms of a flow's derivative; half width of the tube in which a flow is looked for, in its size
LONGEST = 200.0  # chosen: ‖L‖ of a step, whose exponential is a double
TERMS_OF_EXPONENTIAL, TERMS_OVER_NORM = 80, 4  # chosen: terms of the exponential of a matrix, and more of them for its norm
EXTRA_BITS = 32  # chosen: bits of mpmath's intervals beyond P
MOST_ITERATIONS, POWERS = 500, 256  # chosen: turns of an iteration that gains a digit in each or so; powers of a matrix that contracts
NEWTONS = 6  # chosen: steps of Newton's iteration to the base
FLUX_FIELD = 3  # exact: the place of Q in (ν, T, u, Q, Φ)
n_, u_, v_, w_, T_, x_, y_, q_ = EVERY = range(8)  # exact: the places of n, û, v̂/i, ŵ, T̂, τ, θ, q̂ in a state
FOUR = range(4)  # exact: the solutions that decay


class RefusedError(Exception):
    """Why a certificate does not hold."""


class Ring:
    """What follows from +, − and · of one's own."""

    def __radd__(self: Any, other: Any) -> Any:
        return self + other

    def __sub__(self: Any, other: Any) -> Any:
        return self + (-other)

    def __rsub__(self: Any, other: Any) -> Any:
        return (-self) + other

    def __rmul__(self: Any, other: Any) -> Any:
        return self * other


class Model(Ring):
    """(c, r), c_m = (re_m + i im_m) 2^−P, im None where all is real; products keep n terms. P is set by whoever checks."""

    P = 0
    __slots__ = ("_sizes", "im", "n", "r", "re")

    def __init__(self, re: list[int], im: list[int] | None = None, r: float = 0.0, n: int = 1) -> None:
        self.re, self.im, self.r, self.n = re, im, r, n
        self._sizes: list[float] | None = None

    @property
    def sizes(self) -> list[float]:
        """|c_m|, rounded."""
        if self._sizes is None:
            u = ulp()
            pairs = zip(self.re, self.im or [], strict=True)
            self._sizes = [abs(x) * u for x in self.re] if self.im is None else [math.hypot(x * u, y * u) for x, y in pairs]
        return self._sizes

    @property
    def size(self) -> float:
        """‖Σ c_m t^m‖, an upper bound."""
        return sum(self.sizes) * UP

    @property
    def norm(self) -> float:
        """‖f‖, an upper bound."""
        return (self.size + self.r) * UP

    @property
    def least(self) -> float:
        """A lower bound of |f| for a number f, 0 where there is none."""
        return max(0.0, self.sizes[0] / UP - self.r * UP)

    def __add__(self, other: Any) -> Any:
        if isinstance(other, int | Fraction):
            other = exact(other)
        elif not isinstance(other, Model):
            return NotImplemented
        im = other.im if self.im is None else self.im if other.im is None else _sum(self.im, other.im)
        re = _sum(self.re, other.re)
        return Model(re, None if im is None else im + [0] * (len(re) - len(im)), (self.r + other.r) * UP, max(self.n, other.n))

    def __neg__(self) -> "Model":
        return Model([-x for x in self.re], None if self.im is None else [-x for x in self.im], self.r, self.n)

    def __mul__(self, other: Any) -> Any:
        if isinstance(other, int | Fraction):
            p, q = other.numerator, other.denominator
            re = [x * p // q for x in self.re]
            return Model(re, self.im and [x * p // q for x in self.im], (self.r * abs(p / q) + 2 * len(re) * ulp()) * UP, self.n)
        if not isinstance(other, Model):
            return NotImplemented
        n = max(self.n, other.n)
        im: list[int] | None = None
        re = _product(self.re, other.re, n)
        if self.im is not None and other.im is not None:
            re = [x - y for x, y in zip(re, _product(self.im, other.im, n), strict=True)]
            im = _sum(_product(self.re, other.im, n), _product(self.im, other.re, n))
        elif self.im is not None or other.im is not None:
            im = _product(self.re if self.im is None else self.im, other.re if other.im is None else other.im, n)
        r = self.r * other.norm + other.r * self.size + met(self, other, n) + 4 * len(re) * ulp()
        return Model(re, im, r * UP, n)

    def __pow__(self, exponent: int | Fraction) -> "Model":
        """b^s: s b′ c = b c′, and c_m = Σ_j w u_j c_{m−j} with |w| ≤ max(1, |s|), u = b/b_0 − 1."""
        s, b, m_0 = Fraction(exponent), self, len(self.re)
        a, bound, first, c = abs(float(s)) * UP, max(1.0, abs(float(s)) * UP), self.sizes[0] / UP, _root(self, s)
        u = sum(b.sizes[1:]) / first * UP if first > 0 else 1.0
        off = b.r / (first * (1 - u)) * UP if u < 1 else 1.0
        if not (bound * u < 1 and off < 1):
            raise RefusedError("a step is too long for its series")
        for m in range(1, b.n if m_0 > 1 else 1):
            _extend(c, b, s, m)
        rest = Model([0, *b.re[1:]], None if b.im is None else [0, *b.im[1:]])
        e = (2 * len(c.re) * ulp() + c.r + bound * met(rest, c, b.n) / first * UP) / (1 - bound * u) * UP
        r = e + (c.size + e) * a * off / (1 - off) ** (a + 1) * MORE
        return Model(c.re, c.im, r * UP, b.n)

    def wide(self, r: float) -> "Model":
        """The same with a larger radius."""
        return Model(self.re, self.im, (self.r + r) * UP, self.n)

    def cut(self, n: int) -> "Model":
        """n terms of it, the others in the radius."""
        return Model(self.re[:n], None if self.im is None else self.im[:n], (self.r + sum(self.sizes[n:])) * UP, n)

    def at(self, t: Fraction, spread: float = 0.0) -> "Model":
        """f at every number of [0, 1] within spread of t."""
        x, out = (t.numerator << self.P) // t.denominator, []
        for part in (self.re, self.im or []):
            total = 0
            for c in reversed(part):
                total = c + (total * x >> self.P)
            out.append([total])
        r = self.r + sum(m * s for m, s in enumerate(self.sizes)) * UP * (spread + ulp()) + 2 * len(self.re) * ulp()
        return Model(out[0], None if self.im is None else out[1], r * UP)


class Dual(Ring):
    """a + b ε, ε² = 0: a function and its derivative in one direction."""

    def __init__(self, a: Any, b: Any) -> None:
        self.a, self.b = a, b

    def __add__(self, other: Any) -> "Dual":
        return Dual(self.a + other.a, self.b + other.b) if isinstance(other, Dual) else Dual(self.a + other, self.b)

    def __neg__(self) -> "Dual":
        return Dual(-self.a, -self.b)

    def __mul__(self, o: Any) -> "Dual":
        return Dual(self.a * o.a, self.a * o.b + self.b * o.a) if isinstance(o, Dual) else Dual(self.a * o, self.b * o)

    def __pow__(self, s: int | Fraction) -> "Dual":
        power = self.a**s
        return Dual(power, power * self.a**-1 * self.b * s)


class Guess(Ring):
    """A series whose next coefficient a rule gives, in the order of a tape: without bounds, to be verified."""

    def __init__(self, tape: "list[Guess]", rule: Any) -> None:
        self.re: list[int] = []
        self.im, self.tape, self.rule = None, tape, rule
        tape.append(self)

    def __add__(self, other: Any) -> "Guess":
        if isinstance(other, Guess):
            return Guess(self.tape, lambda m: self.re[m] + other.re[m])
        first = (other if isinstance(other, Model) else exact(other)).re[0]
        return Guess(self.tape, lambda m: self.re[m] + (0 if m else first))

    def __neg__(self) -> "Guess":
        return Guess(self.tape, lambda m: -self.re[m])

    def __mul__(self, other: Any) -> "Guess":
        if isinstance(other, Guess):
            return Guess(self.tape, lambda m: sum(map(mul, self.re, other.re[m::-1])) >> Model.P)
        p, q = (other.re[0], 1 << Model.P) if isinstance(other, Model) else (other.numerator, other.denominator)
        return Guess(self.tape, lambda m: self.re[m] * p // q)

    def __pow__(self, exponent: int | Fraction) -> "Guess":
        s, power = Fraction(exponent), Model([])

        def rule(m: int) -> int:
            if m:
                _extend(power, self, s, m)
            else:
                power.re.append(_root(self, s).re[0])
            return power.re[m]

        return Guess(self.tape, rule)


def ulp() -> float:
    """2^−P."""
    return 2.0**-Model.P


def exact(x: Any, y: Any = 0) -> Model:
    """x + iy of rational numbers."""
    (a, b), P = map(Fraction, (x, y)), Model.P
    return Model([(a.numerator << P) // a.denominator], [(b.numerator << P) // b.denominator] if b else None, 2 * ulp())


def number(x: Any) -> Model:
    """An interval of mpmath."""
    a, b = _fraction(x.a), _fraction(x.b)
    return exact(a).wide(float(b - a) * UP)


def within(x: Fraction) -> Any:
    """A rational number as an interval of mpmath."""
    return iv.mpf(x.numerator) / x.denominator


def _fraction(x: Any) -> Fraction:  # the value of an mpmath.iv with two equal ends, of which mpmath keeps 53 bits if not told otherwise
    mantissa, exponent = mp.mpf(x, prec=2 * iv.prec).man_exp
    return Fraction(int(mantissa) * (-1 if x < 0 else 1)) * (Fraction(1 << exponent) if exponent >= 0 else Fraction(1, 1 << -exponent))


def _sum(a: list[int], b: list[int]) -> list[int]:
    a, b = (a, b) if len(a) >= len(b) else (b, a)
    return [*map(sum, zip(a, b, strict=False)), *a[len(b) :]]


def _product(a: list[int], b: list[int], n: int) -> list[int]:
    a, b, P = (*((a, b) if len(a) <= len(b) else (b, a)), Model.P)
    p, back = len(a), a[::-1]
    if p == 1:
        return [a[0] * x >> P for x in b]
    lows = ((m, max(0, m - p + 1)) for m in range(min(n, p + len(b) - 1)))
    return [sum(map(mul, b[low : m + 1], back[p - 1 - m + low :])) >> P for m, low in lows]


def met(a: Model, b: Model, n: int) -> float:
    """Σ_{j+k≥n} |a_j| |b_k|, an upper bound."""
    p = len(a.re)
    if p + len(b.re) - 1 <= n:
        return 0.0
    beyond = list(accumulate(reversed(a.sizes), initial=0.0))[::-1]
    return sum(x * beyond[min(max(n - k, 0), p)] for k, x in enumerate(b.sizes)) * UP


def _root(b: Any, s: Fraction) -> Model:
    """b_0^s."""
    x, y, P = b.re[0], b.im[0] if b.im else 0, Model.P
    if s == -1 and (x or y):
        square = x * x + y * y
        return Model([(x << 2 * P) // square], None if b.im is None else [(-y << 2 * P) // square], 2 * ulp())
    if y or x <= 0:
        raise RefusedError("a power is taken of what may not be positive")
    return number(iv.exp(iv.log(iv.mpf(x) / (1 << P)) * within(s)))


def _extend(c: Model, b: Any, s: Fraction, m: int) -> None:
    """Coefficient m of c = b^s, each part wrong by 2^−P at most; s = −1 where b is complex."""
    (p, q), low = s.as_integer_ratio(), max(0, m - len(b.re) + 1)
    back, x = c.re[low:m][::-1], b.re[0]
    S = sum(map(mul, b.re[1 : m + 1], back))
    if b.im is None:
        R = sum(j * y * z for j, (y, z) in enumerate(zip(b.re[1 : m + 1], back, strict=True), 1)) if p + q else 0
        c.re.append(((p + q) * R - q * m * S) // (m * q * x))
        return
    assert c.im is not None
    turned, y = c.im[low:m][::-1], b.im[0]
    S = sum(map(mul, b.im[1 : m + 1], turned)) - S
    V = -sum(map(mul, b.re[1 : m + 1], turned)) - sum(map(mul, b.im[1 : m + 1], back))
    c.re.append((S * x + V * y) // (x * x + y * y))
    c.im.append((V * x - S * y) // (x * x + y * y))


class Grains:
    """The constitutive functions of Lun et al. (1984), and the base of Richman (1988)."""

    def __init__(self, problem: dict[str, str]) -> None:
        e, e_w, self.rough, self.tan, self.densest = (Fraction(problem[name]) for name in NUMBERS[:5])
        self.ep, self.radial, self.isotropic, pi = (1 + e) / 2, problem["radial"], problem["wall"] == "isotropic", iv.pi
        ep, s = within(self.ep), iv.sqrt(1 - within(self.rough) ** 2)
        self.shearing, self.collisions = number(5 * iv.sqrt(pi) / 96), number(768 / (25 * pi))
        self.conducting = number(25 * iv.sqrt(pi) / (16 * ep * (41 - 33 * ep)))
        self.conducted = number(64 * (41 - 33 * ep) / (25 * pi))
        self.loss, self.bulk = number(48 * ep * (1 - ep) / iv.sqrt(pi)), number(8 * ep / (3 * iv.sqrt(pi)))
        self.root, self.shear = number(iv.sqrt(2 / pi)), number(iv.sqrt(pi * pi / 288))
        self.kappa, self.s = number(2 * within(self.rough**2) * (2 + s) / (3 * (1 + s) ** 2)), number(s)
        self.delta = number(iv.sqrt(2 / pi) * 2 * (1 - within(e_w)) / (1 + s))

    def laws(self, nu: Any) -> tuple[Any, ...]:
        """g0, g1/ν, g1, g1′, g2, g3, g4, g5/ν², g6/ν²."""
        ep, half = self.ep, Fraction(1, 2)
        if self.radial == "lun-savage":
            gap = 1 - nu * (1 / self.densest)
            g0 = gap ** (-5 * self.densest / 2)
            dg0 = g0 * gap**-1 * (5 * half)
        else:
            over = (1 - nu) ** -1
            g0, dg0 = (2 - nu) * over * over * over * half, (5 - nu * 2) * over * over * over * over * half
        x, over = nu * g0 * ep, g0**-1
        f1, bracket, conduction = 1 + x * 4, 1 + x * Fraction(12, 5), over * self.conducting
        kinetic = (1 + x * Fraction(8, 5)) * (1 + x * (8 * (3 * ep - 2) / 5)) * over * (1 / (ep * (2 - ep)))
        g2 = (kinetic + x * nu * self.collisions) * self.shearing
        g3 = conduction * (bracket * (1 + x * (12 * ep * (4 * ep - 3) / 5)) + x * x * self.conducted)
        g4 = conduction * bracket * (g0 * 2 + nu * dg0) * (12 * ep * (2 * ep - 1) * (1 - ep) / 5)
        return g0, f1, nu * f1, 1 + x * 8 + nu * nu * dg0 * (4 * ep), g2, g3, g4, g0 * self.loss, g0 * self.bulk

    def slopes(self, nu: Any, T: Any, Q: Any) -> tuple[Any, ...]:
        """ν′/ν, T′/ν, u′/ν, q′/ν, the laws, √T and 1/√T."""
        laws, root, over = self.laws(nu), T ** Fraction(1, 2), T ** Fraction(-1, 2)
        _, f1, g1, dg1, g2, g3, g4, f5, _ = laws
        mixed, fluid, cold = (dg1 * g3 + g1 * g4) ** -1, g2**-1, Q * over
        ell, heat = (g1 * cold - g3) * mixed * over * over, -((dg1 * cold + g4) * mixed)
        flux = nu * T * root * (f1 * f1 * fluid * self.tan**2 - f5)
        return ell, heat, f1 * root * fluid * self.tan, flux, laws, root, over

    def down(self, h: Fraction, y: list[Any]) -> list[Any]:
        """h d/dz of (ν, T, u, Q, Φ)."""
        nu, T, u, Q, _ = y
        ell, heat, shear, flux, *_ = self.slopes(nu, T, Q)
        return [x * h for x in (nu * ell, nu * heat, nu * shear, flux - Q * ell, -(nu * u))]

    def far(self, start: Fraction, y: list[Any]) -> list[Any]:
        """d/dx of them, x = ν/start; for Q, (d/dx + 1/x) Q."""
        nu, T, u, Q, _ = y
        ell, heat, shear, _, laws, root, _ = self.slopes(nu, T, Q)
        way, f1 = ell**-1 * start, laws[1]
        rate = T * root * (f1 * f1 * laws[4] ** -1 * self.tan**2 - laws[7])
        return [nu * 0 + start, heat * way, shear * way, rate * way, -(u * way)]

    def wall_shear(self, nu: Any, g0: Any) -> Any:
        """A(ν)."""
        return 1 + (1 + (nu * g0) ** -1 * Fraction(5, 8)) * self.shear

    def slip(self, nu: Any, T: Any, Q: Any) -> Any:
        """The velocity that the base allows."""
        _, _, shear, _, laws, root, _ = self.slopes(nu, T, Q)
        lack = self.wall_shear(nu, laws[0]) * (-(self.rough**2) / 2) + self.kappa
        return (root * (self.root**-1 * self.tan) + nu * shear * lack) * self.kappa**-1

    def defect(self, nu: Any, T: Any, Q: Any) -> Any:
        """q/p − tanθ u + Δ √T."""
        return Q * T**-1 * self.laws(nu)[1] ** -1 - self.slip(nu, T, Q) * self.tan + T ** Fraction(1, 2) * self.delta


def guessed(rates: Any, state: list[int], terms: int, nu: list[int] | None = None) -> list[list[int]]:
    """Terms of y′ = f(y) from a state; in the far field, where ν is known, of (x d/dx + 1) Q = x f for Q."""
    tape: list[Guess] = []

    def rule(i: int) -> Any:
        if nu is not None and i == 0:
            return lambda m: nu[m] if m < len(nu) else 0
        return lambda m: f[i].re[m - 1] // (m + (nu is not None and i == FLUX_FIELD)) if m else state[i]

    y = [Guess(tape, rule(i)) for i in range(len(state))]
    f = rates(y)
    for m in range(terms):
        for node in tape:
            node.re.append(node.rule(m))
    return [node.re for node in y]


def verified(rates: Any, terms: list[list[int]], off: list[float], far: bool = False) -> list[Model]:
    """The solution next to these terms, which it may miss by off at t = 0 (K2)."""
    y = [Model(c, None, 0.0, len(c)) for c in terms]
    rest = []
    for i, (f, c) in enumerate(zip(rates(y), terms, strict=True)):
        slope = [(m + (far and i == FLUX_FIELD)) * x for m, x in enumerate(c)][1:]
        rest.append((f - Model(slope, None, 0.0, len(c))).norm)
    tube, one = [TUBE * (x.size + ulp()) for x in y], exact(1)
    few = [x.wide(d).cut(FEW_TERMS) for x, d in zip(y, tube, strict=True)]
    columns = [[x.b.norm for x in rates([Dual(x, one if k == j else one * 0) for k, x in enumerate(few)])] for j in range(len(y))]
    r = grown([list(row) for row in zip(*columns, strict=True)], [(a + b) * UP for a, b in zip(off, rest, strict=True)])
    if not all(a <= b for a, b in zip(r, tube, strict=True)):
        raise RefusedError("the flow may leave the tube in which it is looked for")
    return [x.wide(a) for x, a in zip(y, r, strict=True)]


def grown(L: list[list[float]], x: list[float]) -> list[float]:
    """An upper bound of exp(L) x, all ≥ 0."""
    total, term, most, left = list(x), list(x), max(map(sum, L)) * UP, 1.0
    if not most < LONGEST:
        raise RefusedError("a step is too long")
    last = TERMS_OF_EXPONENTIAL + TERMS_OVER_NORM * int(most)
    for k in range(1, last):
        term = [sum(map(mul, row, term)) * UP / k for row in L]
        total = [a + b for a, b in zip(total, term, strict=True)]
        left *= most / k * UP
    return [(a + 2 * left * max(x)) * MORE for a in total]  # Σ_{k≥n} l^k/k! ≤ l^{n−1}/(n − 1)! where n ≥ 2l


def combine(*terms: Any) -> dict[int, Any]:
    """Σ factor·row; a place stands for the row that is 1 there, and factors that are None for 0."""
    out: dict[int, Any] = {}
    for factor, row in terms:
        for j, x in ({row: 1} if isinstance(row, int) else row).items() if factor is not None else ():
            term = factor if isinstance(x, int) and x == 1 else x * factor
            out[j] = out[j] + term if j in out else term
    return out


class Steady:
    """What the linearized equations take of the steady flow, each a series or a number; u is the whole velocity."""

    def __init__(self, g: Grains, nu: Model, T: Model, u: Model, Q: Model) -> None:
        ell, heat, shear, flux, *_ = g.slopes(nu, T, Q)
        self.nu, self.T, self.u, self.Q, self.nu_z, self.T_z, self.u_z = nu, T, u, Q, nu * ell, nu * heat, nu * shear
        at, half = (Dual(nu, self.nu_z), Dual(T, self.T_z), Dual(Q, flux - Q * ell)), Fraction(1, 2)
        (self.ell, *_, laws, root, over), by_nu = g.slopes(*at), g.laws(Dual(nu, exact(1)))
        _, _, g1, dg1, g2, g3, g4, _, f6 = laws
        self.slope = g.tan
        self.root, self.over, self.eta, xi = root.a, over.a, g2 * root, at[0] * at[0] * f6 * root
        self.p, self.b, self.a, self.fluid = g1.a * T, g1, at[0] * dg1 * at[1], self.eta.a**-1  # a times ν
        self.lam, self.second = xi + self.eta * Fraction(4, 3), xi.a - self.eta.a * Fraction(2, 3)
        self.K, self.Ks = g3.a * root.a, g4.a * T * root.a
        c, e, es = (by_nu[i].b * x for i, x in ((4, root.a), (5, root.a), (6, T * root.a)))
        d, h, hs = g2.a * over.a * half, g3.a * over.a * half, g4.a * root.a * (3 * half)
        g5 = Dual(nu, exact(1)) * Dual(nu, exact(1)) * by_nu[7]
        self.sheared = {n_: c * nu * self.u_z, T_: d * self.u_z}  # η̂ u0′
        self.conducted = {q_: exact(1), n_: nu * (e * self.T_z - es * self.nu_z) - self.Ks * self.nu_z, T_: h * self.T_z - hs * self.nu_z}
        self.lost = {n_: g5.b * T * root.a * nu, T_: g5.a * root.a * (3 * half)}  # γ̂


def waves(b: Steady, s: Model, kx: Fraction, ky: Fraction) -> tuple[Any, Model, dict[int, Any], dict[int, Any]]:
    """i k_x, Ω, ∇· and i k_x û + i k_y v̂."""
    ik = exact(0, kx) if kx else None
    omega = s if ik is None else s + b.u * ik
    return ik, omega, {n_: -omega, w_: -b.ell.a}, combine((ik, u_), (exact(-ky), v_))


def system(b: Steady, s: Model, kx: Fraction, ky: Fraction) -> list[dict[int, Any]]:
    """A of ψ′ = A ψ, by rows."""
    ik, omega, div, along = waves(b, s, kx, ky)
    minus, k2, inertia, eta = None if ik is None else -ik, kx * kx + ky * ky, b.nu * omega, b.eta.a

    def along_x(x: Model) -> Any:
        return None if ik is None else x * ik

    across, pressure = combine((ik, v_), (exact(ky), u_)), {n_: b.a.a, T_: b.b.a}
    w_z, v_z = combine((1, div), (-1, along)), {y_: b.fluid, w_: exact(-ky)}
    u_z = combine((b.fluid, x_), (-b.fluid, b.sheared), (minus, w_))
    pxx = combine((1, pressure), (-b.second, div), (along_x(eta * -2), u_))
    pyy = combine((1, pressure), (-b.second, div), (eta * (2 * ky), v_))
    x_z = combine((inertia, u_), (b.nu * b.u_z, w_), (ik, pxx), (eta * ky, across), (b.nu * -b.slope, n_))
    y_z = combine((inertia, v_), (along_x(-eta), across), (ky, pyy))
    warmed = (inertia * Fraction(-3, 2) - b.K * k2, T_), (b.nu * b.T_z * Fraction(-3, 2), w_), (b.Ks * b.nu * k2, n_)
    q_z = combine(*warmed, (-b.p, div), (b.u_z * 2, x_), (-b.u_z, b.sheared), (-1, b.lost))
    X, X_z = b.a.a + b.lam.a * omega, b.a.b + b.lam.b * omega + (0 if ik is None else b.lam.a * b.u_z * ik)
    swept = b.lam * b.ell
    rest = (-inertia - swept.b, w_), (-b.nu - X_z, n_), (ik, x_), (exact(-ky), y_), (-b.b.b, T_), (-swept.a, w_z)
    rz = combine(*rest, (b.eta.b * -2, along), (along_x(eta * -2), u_z), (eta * (2 * ky), v_z))
    over, both = (X * b.K + b.b.a * b.Ks * b.nu) ** -1, b.Ks * b.nu
    n_z, T_z = combine((b.K * over, rz), (b.b.a * over, b.conducted)), combine((both * over, rz), (-(X * over), b.conducted))
    return [n_z, u_z, v_z, w_z, T_z, x_z, y_z, q_z]


def walls(g: Grains, b: Steady, s: Model, kx: Fraction, ky: Fraction) -> list[dict[int, Any]]:
    """The rows at the base, where ŵ = 0."""
    ik, omega, _, along = waves(b, s, kx, ky)
    x, r2 = Dual(b.nu, exact(1)), g.rough**2
    A = g.wall_shear(x, g.laws(x)[0])
    lack, B, push = A.a * (-r2 / 2) + g.kappa, A.a * (r2 - 2) + g.kappa + g.s * 2, b.p * b.over * g.root  # push: √(2/π) p/√T
    S_x, part = (lack * b.u_z - g.kappa * b.u) * g.root, push * A.a * (r2 / 2)
    w_z = combine((-omega, n_), (-1, along))
    stretched = (None if ik is None else part * ik, u_), (part * -ky if g.isotropic else None, v_), (-(push * B), w_z)
    M = combine((b.a.a + b.lam.a * omega, n_), (b.b.a, T_), (b.eta.a * 2, along), *stretched)
    u_z, cooled = combine((b.fluid, x_), (-b.fluid, b.sheared)), b.p * S_x * b.over * b.over * b.over * Fraction(-1, 2)
    slid = (-(push * g.kappa), u_), (push * lack, u_z), (push * A.b * b.u_z * b.nu * (-r2 / 2), n_), (cooled, T_)
    along_y = combine((exact(1) + push * lack * b.fluid, y_), (-(push * g.kappa), v_))
    heat = (b.u, x_), (b.eta.a * b.u_z, u_), (-(g.delta * b.root), M), (g.delta * b.p * b.over * Fraction(-1, 2), T_)
    return [{w_: exact(1)}, combine((exact(1), x_), (S_x * b.over, M), *slid), along_y, combine((exact(-1), q_), *heat)]


Pair = tuple[list[int], list[int] | None]  # the parts of some coefficients


def _applied(row: dict[int, Pair], re: Any, im: Any, q: int) -> tuple[int, int]:
    """Σ_j Σ_l a_jl y_{m−l, jq}, in units of 2^−2P; re and im hold the terms of y, the last one first; im is None where all is real."""
    S = V = 0
    for j, (a, c) in row.items():
        S += sum(map(mul, a, re[j][q]))
        if im is not None:
            V += sum(map(mul, a, im[j][q]))
            if c is not None:
                S -= sum(map(mul, c, im[j][q]))
                V += sum(map(mul, c, re[j][q]))
    return S, V


def _series(re: Any, im: Any, terms: int) -> list[list[Model]]:
    return [[Model(re[i][q][::-1], im and im[i][q][::-1], 0.0, terms) for q in FOUR] for i in EVERY]


def _first(Y: list[list[Model]], real: bool) -> tuple[Any, Any]:
    return [[[x.re[0]] for x in row] for row in Y], None if real else [[[x.im[0] if x.im else 0] for x in row] for row in Y]


def carried(A: list[dict[int, Model]], Y: list[list[Model]], terms: int) -> list[list[Model]]:
    """The solutions of ψ′ = A ψ on a step that begin with Y (K2)."""
    real = all(x.im is None for row in (*(row.values() for row in A), *Y) for x in row)
    re, im = _first(Y, real)
    rows = [{j: (x.re, x.im) for j, x in row.items()} for row in A]
    for m in range(1, terms):
        new = [[_applied(row, re, im, q) for q in FOUR] for row in rows]
        for i in EVERY:
            for q in FOUR:
                re[i][q].insert(0, new[i][q][0] // (m << Model.P))
                if im is not None:
                    im[i][q].insert(0, new[i][q][1] // (m << Model.P))
    out = _series(re, im, terms)
    L = [[row[j].norm if j in row else 0.0 for j in EVERY] for row in A]
    for q in FOUR:
        lost = [sum(met(a, out[j][q], terms - 1) + a.r * out[j][q].size for j, a in row.items()) for row in A]
        for i, r in enumerate(grown(L, [(x + terms**2 * ulp() + Y[i][q].r) * UP for i, x in enumerate(lost)])):
            out[i][q].r = r
    return out


def basis(Y: list[list[Model]]) -> list[list[Model]]:
    """X, its numbers exact, for which four rows of Y X are next to those of 1: chosen in doubles."""
    y = [[complex(x.re[0] * ulp(), x.im[0] * ulp() if x.im else 0.0) for x in row] for row in Y]
    X, left = [[complex(i == j) for j in FOUR] for i in FOUR], set(EVERY)
    for q in FOUR:
        i = max(left, key=lambda i: abs(y[i][q]))
        left.remove(i)
        for p in FOUR:
            f = y[i][p] / y[i][q]
            for row in (*y, *X) if p != q else ():
                row[p] -= f * row[q]
        f = 1 / y[i][q]
        for row in (*y, *X):
            row[q] *= f
    found = [[exact(x.real, x.imag) for x in row] for row in X]
    return [[Model(x.re, x.im) for x in row] for row in found]


def product(A: list[list[Model]], B: list[list[Model]]) -> list[list[Model]]:
    """A B of numbers."""
    return [[sum((a * b for a, b in zip(row, column, strict=True)), exact(0)) for column in zip(*B, strict=True)] for row in A]


def determinant(A: list[list[Model]]) -> Model:
    """The determinant, by the first row."""
    if len(A) == 1:
        return A[0][0]
    minors = (determinant([row[:j] + row[j + 1 :] for row in A[1:]]) for j in range(len(A)))
    return sum((x * minor * (-1) ** j for j, (x, minor) in enumerate(zip(A[0], minors, strict=True))), exact(0))


def far_space(b: Steady, s: Model, kx: Fraction, ky: Fraction, T: Model, u_far: Model) -> list[list[Model]]:
    """The decaying solutions at the start, the columns û, v̂/i, ŵ and T̂ at infinity."""
    ik, ell, K = exact(0, kx) if kx else None, b.ell.a**-1, number(iv.sqrt(within(kx * kx + ky * ky)))
    omega, cool = s if ik is None else s + u_far * ik, T**-1
    over, minus = omega**-1, None if ik is None else -ik
    swap = combine((-over, n_), (None if ik is None else -(over * ik), u_), (over * ky, v_), (over * cool, w_))  # n by ∂ŵ/∂z at its place
    rows = [combine((1, {j: x for j, x in row.items() if j != n_}), (row.get(n_), swap)) for row in system(b, s, kx, ky)]
    rows[n_] = combine((-omega, rows[n_]), (minus, rows[u_]), (exact(ky), rows[v_]), (cool, rows[w_]))
    left, right, seventh = (exact(0, kx), exact(ky), -K), (exact(0, kx), exact(-ky), -K), K**-1 * Fraction(-1, 7)
    tilt = [[left[i] * right[j] * seventh if i < 3 and j < 3 else exact(0) for j in FOUR] for i in FOUR]
    eta, first = b.eta.a.at(Fraction(0)), [[exact(0) for _ in FOUR] for _ in EVERY]
    for q, place in enumerate((u_, v_, w_)):
        fall = [-tilt[i][q] - (K if i == q else 0) for i in range(3)]
        first[place][q], first[n_][q] = exact(1), fall[2]
        first[x_][q] = eta * (fall[0] + (exact(0, kx) if place == w_ else 0))
        first[y_][q] = eta * (fall[1] + (ky if place == w_ else 0))
    first[T_][3], first[q_][3] = exact(1), b.K.at(Fraction(0)) * K
    B = [{j: x * ell for j, x in row.items()} for row in rows]
    Y = regular(B, [[x * T for x in row] for row in tilt], K * T, first, b.nu.n)
    Y[n_] = [sum((Y[j][q] * f for j, f in swap.items()), exact(0)) for q in FOUR]
    return Y


def regular(B: list[dict[int, Model]], Z: list[list[Model]], rate: Model, first: list[list[Model]], terms: int) -> list[list[Model]]:
    """P(1) of x ψ′ = B(x) ψ, ψ = P(x) x^{rate + Z}, where B_0 first = first (rate + Z) is known (K3)."""
    real = all(x.im is None for row in (*(row.values() for row in B), *first) for x in row)
    re, im = _first(first, real)
    tails, still = ([{j: (x.re[part], x.im and x.im[part]) for j, x in row.items()} for row in B] for part in (slice(1, None), slice(0, 1)))
    for i in EVERY:
        a, c = still[i].get(i, ([0], None))
        still[i][i] = [a[0] - rate.re[0]], c
    turned = [{p: ([-Z[p][q].re[0]], Z[p][q].im and [-x for x in Z[p][q].im or []]) for p in FOUR} for q in FOUR]
    lost = [[0.0 for _ in FOUR] for _ in EVERY]
    for m in range(1, terms):
        known = [[_applied(row, re, im, q) for q in FOUR] for row in tails]
        now, moved = _settled(known, still, turned, m, real)
        for i in EVERY:
            for q in FOUR:
                (S, V), (x, y) = moved[i][q], now[i][q]
                lost[i][q] += math.hypot((S - (x * m << Model.P)) * ulp() ** 2, (V - (y * m << Model.P)) * ulp() ** 2) * UP
                re[i][q].insert(0, x)
                if im is not None:
                    im[i][q].insert(0, y)
    P = _series(re, im, terms)
    aside = max(sum(Z[p][q].norm for p in FOUR) for q in FOUR) + rate.r
    sizes = [[math.hypot(*((x or [0])[0] * ulp() for x in still[i][j])) if j in still[i] else 0.0 for j in EVERY] for i in EVERY]
    radii = [[row[j].r if j in row else 0.0 for j in EVERY] for row in B]
    H = inverse([[(sizes[i][j] + radii[i][j] + (aside if i == j else 0.0)) * UP for j in EVERY] for i in EVERY])
    plus = [[(sum(row[j].sizes[1:]) + row[j].r) * UP if j in row else 0.0 for j in EVERY] for row in B]
    L = [[sum(map(mul, row, column)) * UP for column in zip(*plus, strict=True)] for row in H]
    off = [0.0 for _ in EVERY]
    for q in FOUR:
        rest = [lost[i][q] + sum(met(a, P[j][q], terms) + a.r * P[j][q].size for j, a in B[i].items()) for i in EVERY]
        rest = [x + rate.r * P[i][q].size + sum(P[i][p].size * Z[p][q].r for p in FOUR) for i, x in enumerate(rest)]
        off = [max(most, (first[i][q].r + sum(map(mul, H[i], rest))) * UP) for i, most in enumerate(off)]
    for row, r in zip(P, grown(L, off), strict=True):  # one bound for all columns, which Z mixes
        for x in row:
            x.r = r
    return [[x.at(Fraction(1)) for x in row] for row in P]


def _settled(known: Any, still: Any, turned: Any, m: int, real: bool) -> tuple[Any, Any]:
    """X with m X = known + C X − X Z, about, by iteration, and the right side."""
    below, moved, now = m << Model.P, known, list[list[tuple[int, int]]]()
    for _ in range(MOST_ITERATIONS):
        before, now = now, [[(S // below, V // below) for S, V in row] for row in moved]
        re, im = ([[[x[part]] for x in row] for row in now] for part in (0, 1))
        across, aside = ([list(column) for column in zip(*part, strict=True)] for part in (re, im))
        moved = []
        for i, row in enumerate(known):
            moved.append([])
            for q, (S, V) in enumerate(row):
                (a, b), (c, d) = _applied(still[i], re, None if real else im, q), _applied(turned[q], across, None if real else aside, i)
                moved[-1].append((S + a + c, V + b + d))
        pairs = zip(chain(*chain(*now)), chain(*chain(*before)), strict=False)
        if before and all(abs(x - y) <= 2 for x, y in pairs):
            break
    return now, moved


def inverse(G: list[list[float]]) -> list[list[float]]:
    """An upper bound of (1 − G)⁻¹ ≥ 0, G ≥ 0: G^k, k < n, and what follows where ‖Gⁿ‖ < ½."""
    power = total = [[float(i == j) for j in EVERY] for i in EVERY]
    for _ in range(POWERS):
        power = [[sum(map(mul, row, column)) * UP for column in zip(*G, strict=True)] for row in power]
        total = [[x + y for x, y in zip(a, b, strict=True)] for a, b in zip(total, power, strict=True)]
    rest = 2 * max(map(sum, power)) * MORE
    if not rest < 1:
        raise RefusedError("the wave is too short for the far field: K T_∞ is too large")
    return [[(x + sum(row) * rest) * MORE for x in row] for row in total]


class Certified:
    """The flows and D of one certificate."""

    def __init__(self, certificate: dict[str, Any]) -> None:
        problem, c = certificate["problem"], certificate
        self.g, self.kx, self.ky = Grains(problem), Fraction(problem["kx"]), Fraction(problem["ky"])
        self.start, self.slack, self.steps = Fraction(c["start"]), Fraction(c["slack"]), [Fraction(h) for h in c["steps"]]
        self.terms, self.far_terms, self.frames = c["order"], c["far_order"], list[list[list[Model]]]()

    def far_flow(self, T: Model) -> list[Model]:
        """(ν, T, u, Q, Φ) as series in ν/start, u without u_∞."""
        nu, off = [0, exact(self.start).re[0]], [ulp(), T.r + ulp(), 0.0, 0.0, 0.0]

        def rates(y: list[Any]) -> list[Any]:
            return self.g.far(self.start, y)

        return verified(rates, guessed(rates, [0, T.re[0], 0, 0, 0], self.far_terms, nu), off, True)

    def step(self, y: list[Model], h: Fraction) -> list[Model]:
        """The flow on a step downwards from a state."""

        def rates(y: list[Any]) -> list[Any]:
            return self.g.down(-h, y)

        return verified(rates, guessed(rates, [x.re[0] for x in y], self.terms), [x.r for x in y])

    def flow(self, T: Model) -> list[list[Model]]:
        """The far field and the steps of the flow of a T_∞."""
        pieces = [self.far_flow(T)]
        for h in self.steps:
            pieces.append(self.step([x.at(Fraction(1)) for x in pieces[-1]], h))
        return pieces

    def defect(self, y: list[Model]) -> Any:
        """The defect of the energy condition and its derivative along the last step."""
        f = self.g.down(-self.steps[-1], y)
        return self.g.defect(*(Dual(y[i], f[i]) for i in (0, 1, FLUX_FIELD)))

    def base(self, piece: list[Model]) -> tuple[Fraction, float]:
        """t of the one base in [1 − 2 slack, 1] of the last step, by interval Newton, and how far off it is at most."""
        t = middle = 1 - self.slack
        for _ in range(NEWTONS):
            found = self.defect([x.at(t) for x in piece])
            moved = t - Fraction(found.a.re[0], found.b.re[0] or 1)
            t = Fraction(int(min(max(moved, 1 - 2 * self.slack), Fraction(1)) * 2**Model.P), 2**Model.P)
        rate = self.defect([x.at(middle, float(self.slack) * UP) for x in piece]).b.least
        off = self.defect([x.at(t) for x in piece]).a.norm / rate * UP if rate > 0 else math.inf
        if not off < float(self.slack) or not 1 - 2 * self.slack < t - Fraction(off) < t + Fraction(off) < 1:
            raise RefusedError("the energy condition is not shown to hold once in the interval of the base")
        return t, off

    def at_base(self, piece: list[Model]) -> tuple[list[Model], Model, Model]:
        """The state there, u_∞ and the mass flux."""
        nu, T, u, Q, flux = y = [x.at(*self.base(piece)) for x in piece]
        u_far = self.g.slip(nu, T, Q) - u
        return y, u_far, flux + u_far * self.g.laws(nu)[2] * T

    def descend(self, T: Model) -> None:
        """The flow on which D is asked for, and its base."""
        self.T, self.fields = T, self.flow(T)
        self.place, (self.end, self.u_far, self.flux) = self.base(self.fields[-1]), self.at_base(self.fields[-1])

    def linearize(self) -> None:
        """What the perturbations take of it."""
        told = (Steady(self.g, nu, T, u + self.u_far, Q) for nu, T, u, Q, _ in (*self.fields, self.end))
        self.far, *self.pieces, self.wall = told

    def D(self, s: Model) -> Model:
        """D(σ) of every σ in the ball, up to a factor that is the same for all of them."""
        kx, ky = self.kx, self.ky
        Y, first = far_space(self.far, s, kx, ky, self.T, self.u_far), not self.frames
        for i, (b, h) in enumerate(zip(self.pieces, self.steps, strict=True)):
            if first:
                self.frames.append(basis(Y))
            A = [{j: x * -h for j, x in row.items()} for row in system(b, s, kx, ky)]
            place = self.place if b is self.pieces[-1] else (Fraction(1), 0.0)
            Y = [[x.at(*place) for x in row] for row in carried(A, product(Y, self.frames[i]), self.terms)]
        if first:
            self.frames.append(basis(Y))
        rows = [[row.get(j, exact(0)) for j in EVERY] for row in walls(self.g, self.wall, s, kx, ky)]
        return determinant(product(rows, product(Y, self.frames[-1])))


@contextmanager
def precision(bits: int) -> Iterator[None]:
    """Models with so many bits behind the point."""
    saved, iv.prec, Model.P = (iv.prec, Model.P), bits + EXTRA_BITS, bits
    try:
        yield
    finally:
        iv.prec, Model.P = saved


def check(certificate: Any) -> str | None:
    """None where the certificate proves what it says, else the reason why it does not."""
    try:
        _read(certificate)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        return f"not a certificate of this kind: {error}"
    try:
        with precision(certificate["bits"]):
            chute = Certified(certificate)
            _flow(chute, certificate)
            return _count(chute, certificate)
    except (RefusedError, OverflowError, ZeroDivisionError) as error:
        return f"{error}"


def _read(c: Any) -> None:
    """A look at the form of everything. Raises ValueError and its like."""
    if set(c) != NAMED or c["format"] != 2 or c["lemmas"] != RELIED_ON:
        raise ValueError(f"its keys are to be {', '.join(sorted(NAMED))}, its format 2, its lemmas {', '.join(RELIED_ON)}")
    problem, region, flow = c["problem"], c["region"], c["flow"]
    given = set(problem) - {"name", "radial", "wall", *NUMBERS}
    if problem["name"] != "granular chute" or len(given) != 1 or not given <= {"mass_flux", "far_temperature"}:
        raise ValueError("problem")
    if problem["radial"] not in ("lun-savage", "carnahan-starling") or problem["wall"] not in ("printed", "isotropic"):
        raise ValueError("radial, or wall")
    if set(region) != {"re", "im", "radius"} or set(flow) != {"far_temperature", "nu"} or not all(len(x) == 2 for x in flow.values()):
        raise ValueError("region, or flow")
    texts = [problem[x] for x in (*NUMBERS, *given)] + [
        *region.values(),
        *chain(*flow.values()),
        c["outer"],
        c["start"],
        c["slack"],
        *c["steps"],
    ]
    if not all(isinstance(x, str) and DECIMAL_TEXT.fullmatch(x) for x in texts) or not 0 < len(c["steps"]) <= MOST_LENGTHS:
        raise ValueError("a number is no decimal in quotes, or there are too many steps")
    for name, (low, high) in ALLOWED_COUNTS.items():
        if type(c[name]) is not int or not low <= c[name] <= high:
            raise ValueError(f"{name} = {c[name]!r}")
    if c["points"] * len(c["steps"]) * c["order"] ** 2 > MOST_PRODUCTS:
        raise ValueError("points, steps and order ask for more work than any certificate needs")
    e, e_w, r, tan, densest, kx, ky = (Fraction(problem[x]) for x in NUMBERS)
    if not max(abs(Fraction(x)) for x in texts) < LARGEST:
        raise ValueError(f"a number is not below {LARGEST}")
    positive = (
        e,
        r,
        tan,
        densest,
        *(Fraction(x) for x in (region["radius"], c["start"], c["slack"], *c["steps"], *flow["far_temperature"])),
    )
    if not (all(x > 0 for x in positive) and max(e, e_w, r) <= 1 and e_w >= 0 and densest < 1 and kx * kx + ky * ky > 0):
        raise ValueError("a number lies outside of what it can be")
    if not (Fraction(c["outer"]) > Fraction(region["radius"]) and Fraction(c["slack"]) < Fraction(1, 4) and c["count"] < c["points"]):
        raise ValueError("the outer circle is not the larger one, the slack too large, or there are more zeros than points")


def _flow(chute: Certified, c: dict[str, Any]) -> None:
    """That a flow exists as it is told, and what D takes of all of them."""
    problem, (low, high), (least, most) = c["problem"], *([Fraction(x) for x in c["flow"][name]] for name in ("far_temperature", "nu"))
    if "far_temperature" in problem:
        if not low == high == Fraction(problem["far_temperature"]):
            raise RefusedError("the far temperature is not the one that is typed")
    else:
        asked = Fraction(problem["mass_flux"])
        signs = [_sign(chute.at_base(chute.flow(exact(T))[-1])[2] - asked) for T in (low, high)]
        if not low < high or sorted(signs) != [-1, 1]:
            raise RefusedError("the mass flux is not shown to lie between those of the ends of the bracket")
    chute.descend(exact((low + high) / 2).wide(float((high - low) / 2) * UP))
    if _sign(chute.end[0] - least) != 1 or _sign(most - chute.end[0]) != 1:
        raise RefusedError("the base does not lie where it is told")
    chute.linearize()


def _sign(x: Model) -> int:
    """The sign of a real number, 0 where it is not known."""
    return 0 if x.least == 0 else 1 if x.re[0] > 0 else -1


def _count(chute: Certified, c: dict[str, Any]) -> str | None:
    """Pellet's inequality on the disc."""
    (x, y, r), R, K, n = (Fraction(c["region"][name]) for name in ("re", "im", "radius")), Fraction(c["outer"]), c["points"], c["count"]
    turns = [(iv.cos(2 * iv.pi * j / K), iv.sin(2 * iv.pi * j / K)) for j in range(K)]
    roots = [number(a) + (number(b) * exact(0, 1) if 2 * j % K else 0) for j, (a, b) in enumerate(turns)]
    half = K // 2 if chute.kx == 0 == y else K - 1  # D is real then: the other values are conjugates
    values = [chute.D(exact(x, y) + w * r) for w in roots[: half + 1]]
    values += [Model(v.re, v.im and [-z for z in v.im], v.r) for v in (values[K - j] for j in range(half + 1, K))]
    M, q = chute.D(exact(x, y).wide(float(R) * UP)).norm, float(r / R) * UP
    if not q < 1 / UP:
        return "the outer circle is not wide enough"
    spill, sizes = M * q**K / (1 - q) * MORE + VANISHED, []
    for k in range(K):
        d = sum((v * roots[-j * k % K] for j, v in enumerate(values)), exact(0)) * Fraction(1, K)
        sizes.append(d.wide(spill * q**k + VANISHED))  # M q^{k+K}/(1 − q^K) is less
    others = (sum(d.norm for k, d in enumerate(sizes) if k != n) + spill) * UP
    return None if sizes[n].least > others else f"Pellet's inequality does not hold for n = {n}: {sizes[n].least:.3g} against {others:.3g}"


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
