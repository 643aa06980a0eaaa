"""Check a certificate that exactly n modes of plane Poiseuille flow lie in a disc. Run as `python plane_poiseuille.py CERTIFICATE`.

This file shares nothing with the program that wrote the certificate: no formula, no code, no library but mpmath. It
derives everything anew.

Equation.  (D² − α²)² φ = R [(σ + iαU)(D² − α²) − iαU″] φ with U = 1 − y², that is φ⁗ = p φ″ + q φ with

    p = 2α² + R s,  q = −α⁴ − R α² s + 2iαR,  s = σ + iα(1 − y²).

φ even: φ_1, φ_2 begin at y = 0 with (1, 0, 0, 0) and (0, 0, 1, 0); otherwise at y = −1 with (0, 0, 1, 0) and (0, 0, 0, 1). Modes are the
zeros of D(σ) = φ_1 φ_2′ − φ_1′ φ_2 at y = 1, counted with multiplicity.

Steps.  φ = Σ f_m t^m, y = y_0 + h t; with h² p = Σ p_j t^j, h⁴ q = Σ q_j t^j (j ≤ 2)

    (m+4)(m+3)(m+2)(m+1) f_{m+4} = Σ_j p_j (m−j+2)(m−j+1) f_{m−j+2} + Σ_j q_j f_{m−j}.

If |f_m| ≤ A 2^−m for the last six m below N, and Σ|p_j| 2^{2+j}/(N(N−1)) + Σ|q_j| 2^{4+j}/(N(N−1)(N−2)(N−3)) ≤ 1, then by induction
|f_m| ≤ A 2^−m for all m ≥ N, and as (N + i)/N ≤ 1 + i, Σ_{m≥N} m³ |f_m| ≤ A N³ 2^−N Σ_i (1 + i)³ 2^−i = 52 A N³ 2^−N, which bounds what
φ, φ′, φ″, φ‴ lack.

Growth.  The minors y = ([01], [02], [03], [12], [13], [23]) of (φ_1, φ_2) obey y_1′ = y_2, y_2′ = y_3 + y_4, y_3′ = p y_2 + y_5, y_4′ =
y_5, y_5′ = y_6 + p y_4 − q y_1, y_6′ = −q y_2. In the norm max |y_i|/w_i, w = (1, k, k², k², k³, k⁴), the logarithmic norm is at most
k max(2, 1 + |p|/k² + |q|/k⁴): so |D| ≤ |y(start)|_w exp ∫ of that.

Count.  From K values of D on |σ − c| = r and |D| ≤ M on |σ − c| ≤ ρ, q = r/ρ: the discrete Fourier coefficients miss d_k r^k by at most
M q^{k+K}/(1 − q^K), the rest of the Taylor series is below M q^K/(1 − q); |d_n| r^n > Σ_{k≠n} |d_k| r^k + rest proves n zeros (Pellet).
"""

import json
import math
import re
import sys
from pathlib import Path
from typing import Any

from mpmath import iv

KEYS = {"format", "problem", "count", "disc", "outer", "weight", "points", "bits", "order", "steps"}
MOST_CHECKING = 10**6  # chosen: points × steps × order, minutes; certificates of a thousand digits take 10⁵
DECIMAL = re.compile(r"-?\d{1,2000}(\.\d{1,2000})?(e-?\d{1,4})?")
ORIGIN = iv.mpc(0)


def check(certificate: Any) -> str | None:
    """None where the certificate proves what it says; else the reason why it does not."""
    try:
        problem, disc = _read(certificate)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        return f"not a certificate of this kind: {error}"
    saved = iv.prec
    iv.prec = certificate["bits"]
    try:
        return _check(certificate, problem, disc)
    finally:
        iv.prec = saved


def _read(certificate: Any) -> tuple[Any, Any]:
    """The numbers that are texts, after a look at the form of everything. Raises ValueError and its like."""
    if set(certificate) != KEYS or certificate["format"] != 1:
        raise ValueError(f"its keys are to be {', '.join(sorted(KEYS))}, its format 1")
    problem, disc = certificate["problem"], certificate["disc"]
    if (
        set(problem) != {"name", "reynolds", "alpha", "even"}
        or problem["name"] != "plane Poiseuille"
        or not isinstance(problem["even"], bool)
    ):
        raise ValueError("problem")
    texts = [problem["reynolds"], problem["alpha"], disc["re"], disc["im"], disc["radius"], certificate["outer"], certificate["weight"]]
    if not all(isinstance(x, str) and DECIMAL.fullmatch(x) for x in (*texts, *certificate["steps"])):
        raise ValueError("a number is no decimal in quotes")
    for name, low, high in (("count", 0, 64), ("points", 2, 4096), ("bits", 53, 20000), ("order", 12, 5000)):
        if type(certificate[name]) is not int or not low <= certificate[name] <= high:
            raise ValueError(f"{name} = {certificate[name]!r}")
    if not 1 <= len(certificate["steps"]) <= 10000:
        raise ValueError("steps")
    if certificate["points"] * (len(certificate["steps"]) + 1) * certificate["order"] > MOST_CHECKING:
        raise ValueError("points, steps and order ask for more work than any certificate needs")
    return problem, disc


def _check(certificate: Any, problem: Any, disc: Any) -> str | None:
    R, alpha, even = iv.mpf(problem["reynolds"]), iv.mpf(problem["alpha"]), problem["even"]
    centre = iv.mpc(iv.mpf(disc["re"]), iv.mpf(disc["im"]))
    radius, outer, k = iv.mpf(disc["radius"]), iv.mpf(certificate["outer"]), iv.mpf(certificate["weight"])
    steps = [iv.mpf(h) for h in certificate["steps"]]
    start = iv.mpf(0 if even else -1)
    if not (R > 0 and alpha > 0 and radius > 0 and outer > radius and k > 0 and all(h > 0 for h in steps)):
        return "a number that must be positive is not, or the outer circle is not the larger one"
    if not sum(steps, start).b < 1:
        return "the steps do not end before the wall"
    steps.append(1 - sum(steps, start))
    K, n = certificate["points"], certificate["count"]
    values = []
    roots = [iv.mpc(iv.cos(2 * iv.pi * j / K), iv.sin(2 * iv.pi * j / K)) for j in range(K)]
    for root in roots:
        D = _value(R, alpha, even, centre + radius * root, start, steps, certificate["order"])
        if D is None:
            return "the tail of a Taylor step is not bounded: the order is too low for the steps"
        values.append(D)
    M = bound(R, alpha, even, centre, outer, k, start)
    q = radius / outer
    sizes = []
    for m in range(K):
        d = abs(sum((v * roots[-j * m % K] for j, v in enumerate(values)), ORIGIN)) / K
        off = M * q ** (m + K) / (1 - q**K)
        sizes.append(iv.mpf([max(0, (d - off).a), (d + off).b]))
    if n >= K:
        return "more zeros are claimed than there are points"
    rest = sum((x for m, x in enumerate(sizes) if m != n), iv.mpf(0)) + M * q**K / (1 - q)
    return None if sizes[n].a > rest.b else f"Pellet's inequality does not hold for n = {n}"


def _coefficients(R: Any, alpha: Any, sigma: Any, y: Any) -> tuple[Any, Any]:
    """p and q at y, as polynomials in y − y_0 about it: each (p_0, p_1, p_2)."""
    s = (sigma + 1j * alpha * (1 - y * y), -2j * alpha * y, iv.mpc(0, -alpha))
    p = tuple(R * x for x in s)
    q = tuple(-R * alpha**2 * x for x in s)
    return (2 * alpha**2 + p[0], p[1], p[2]), (q[0] - alpha**4 + 2j * alpha * R, q[1], q[2])


def _value(R: Any, alpha: Any, even: bool, sigma: Any, start: Any, steps: Any, N: int) -> Any:
    """D(σ), None where a tail is not bounded."""
    states = [[iv.mpc(int(i == j)) for i in range(4)] for j in ((0, 2) if even else (2, 3))]
    y = start
    for h in steps:
        p, q = _coefficients(R, alpha, sigma, y)
        p, q = [x * h ** (2 + j) for j, x in enumerate(p)], [x * h ** (4 + j) for j, x in enumerate(q)]
        room = sum(abs(x) * 2 ** (2 + j) for j, x in enumerate(p)) / (N * (N - 1))
        room += sum(abs(x) * 2 ** (4 + j) for j, x in enumerate(q)) / (N * (N - 1) * (N - 2) * (N - 3))
        if not room <= 1:
            return None
        states = [_step(state, h, p, q, N) for state in states]
        y = y + h
    (f, f1), (g, g1) = (state[:2] for state in states)
    return f * g1 - f1 * g


def _step(state: Any, h: Any, p: Any, q: Any, N: int) -> Any:
    """(φ, φ′, φ″, φ‴) at the end of a step."""
    f = [state[0], state[1] * h, state[2] * h**2 / 2, state[3] * h**3 / 6]
    for m in range(N - 4):
        total = ORIGIN
        for j in range(min(m, 2) + 1):  # where j > m the factors vanish
            total += p[j] * f[m - j + 2] * ((m - j + 2) * (m - j + 1)) + q[j] * f[m - j]
        f.append(total / ((m + 4) * (m + 3) * (m + 2) * (m + 1)))
    A = max((abs(f[m]) * 2**m).b for m in range(N - 6, N))
    lack = (52 * iv.mpf(A) * N**3 / iv.mpf(2) ** N).b
    wide = iv.mpf([-lack, lack])
    weights = (lambda m: 1, lambda m: m, lambda m: m * (m - 1), lambda m: m * (m - 1) * (m - 2))
    ends = [sum((f[m] * w(m) for m in range(N - 1, -1, -1)), ORIGIN) + iv.mpc(wide, wide) for w in weights]
    return [x / h**i for i, x in enumerate(ends)]


def bound(R: Any, alpha: Any, even: bool, centre: Any, outer: Any, k: Any, start: Any, pieces: int = 64) -> Any:
    """M ≥ |D| on |σ − centre| ≤ outer, numbers of mpmath.iv; also for whoever writes a certificate and must choose weight and points."""
    square = iv.mpf([-outer.b, outer.b])
    sigma = centre + iv.mpc(square, square)
    total = iv.mpf(0)
    for i in range(pieces):
        low, high = start + (1 - start) * i / pieces, start + (1 - start) * (i + 1) / pieces
        y = iv.mpf([low.a, high.b])
        s = sigma + 1j * alpha * (1 - y * y)
        p, q = 2 * alpha**2 + R * s, -(alpha**4) - R * alpha**2 * s + 2j * alpha * R
        rate = 1 + abs(p) / k**2 + abs(q) / k**4
        total += k * max(2, rate.b) * (1 - start) / pieces
    # the minors begin with [02] = 1 (even) or [23] = 1
    return iv.exp(total) / (k if even else k**4)


def settings(problem: Any, disc: Any, outer: str, log_size: float) -> dict[str, Any]:
    """Weight, points, bits, order and steps with which a certificate is likely to be accepted: choices, of which nothing is trusted.

    log_size is ln |D| on the circle.
    """
    R, alpha = iv.mpf(problem["reynolds"]), iv.mpf(problem["alpha"])
    centre = iv.mpc(iv.mpf(disc["re"]), iv.mpf(disc["im"]))
    start = iv.mpf(0 if problem["even"] else -1)
    length = 1.0 if problem["even"] else 2.0
    rate = float((abs(_coefficients(R, alpha, centre, iv.mpf(0))[0][0]) + abs(_coefficients(R, alpha, centre, iv.mpf(1))[0][0])).b) ** 0.5
    weights = [f"{rate * 1.1**j:.4g}" for j in range(-10, 6)]
    nats = {w: float(iv.log(bound(R, alpha, problem["even"], centre, iv.mpf(outer), iv.mpf(w), start)).b) for w in weights}
    weight = min(nats, key=lambda w: nats[w])
    points = max(4, math.ceil((nats[weight] - log_size) / math.log(float(outer) / float(disc["radius"]))) + 2)
    digits = -math.log2(float(disc["radius"]) / max(1e-300, float(abs(centre).b)))
    bits = math.ceil(48 + digits + 2.0 * length * rate)
    count = max(2, math.ceil(length * rate * 16 / bits))
    step = math.floor(1e6 * length / count) / 1e6
    order, size = 1, 0.0
    while size > -bits or order < 24:
        size += math.log2(2.0 * rate * step / order)
        order += 1
    return {"outer": outer, "weight": weight, "points": points, "bits": bits, "order": order, "steps": [f"{step:.6f}"] * (count - 1)}


def main() -> int:
    """Exit status 0 where the certificate proves its statement, 1 where it does not."""
    if len(sys.argv) != 2:
        print(str(__doc__).split("\n")[0])
        return 2
    try:
        certificate = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        print(f"{sys.argv[1]}: not a certificate: {error}")
        return 2
    reason = check(certificate)
    print("proved" if reason is None else f"refused: {reason}")
    return int(reason is not None)


if __name__ == "__main__":
    sys.exit(main())
