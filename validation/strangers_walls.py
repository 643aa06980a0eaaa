"""Strangers between two walls: strings, beams, wells with jumps and kinks, periodic and nearly double pairs, defective blocks."""

from __future__ import annotations

import math
from typing import Any

import mpmath
import numpy as np
from stranger import Fixed, Stranger, collocated, exactly, jumps, second_order, walls

import shootstab as st

PI = math.pi
DIRICHLET, NEUMANN = [[1, 0]], [[0, 1]]  # exact


def string(z: Any) -> Any:
    return second_order(0, 0)


def two_strings(a: float, b: float) -> Any:
    """y₁″ = (π²/a)σ y₁, y₂″ = (π²/b)σ y₂: σ = −a n², −b n²."""
    D0, D1 = np.zeros((4, 4)), np.zeros((4, 4))
    D0[0, 1] = D0[2, 3] = 1
    D1[1, 0], D1[3, 2] = PI**2 / a, PI**2 / b
    return lambda z: (D0, D1)


ROWS4 = np.eye(4)[[0, 2]]  # exact
SLOW_LENGTH = 12.0  # chosen: a length over which D of the fast part follows its law of growth before the slow part feels σ


def two_times(epsilon: float) -> Any:
    """y″ = σ y, w″ = (εσ − 2) k² w, k = π/L: σ = −k² n² and (2 − n²)/ε, of which one grows."""
    square = (PI / SLOW_LENGTH) ** 2
    D0, D1 = np.zeros((4, 4)), np.zeros((4, 4))
    D0[0, 1] = D0[2, 3] = D1[1, 0] = 1
    D0[3, 2], D1[3, 2] = -2 * square, epsilon * square
    return lambda z: (D0, D1)


def beam(z: Any) -> Any:
    """y⁗ = −σ y."""
    D0, D1 = np.eye(4, k=1), np.zeros((4, 4))
    D1[3, 0] = -1
    return D0, D1


def beam_roots(count: int, sign: int) -> list[tuple[complex, float]]:
    """σ = −β⁴ with cos β cosh β = sign."""
    with mpmath.workdps(30):
        roots = [
            mpmath.findroot(lambda b: mpmath.cos(b) * mpmath.cosh(b) - sign, (k + mpmath.mpf(1) / 2) * mpmath.pi)
            for k in range(1, count + 1)
        ]
        if sign == -1:
            roots = [
                mpmath.findroot(lambda b: mpmath.cos(b) * mpmath.cosh(b) + 1, (k - mpmath.mpf(1) / 2) * mpmath.pi)
                for k in range(1, count + 1)
            ]
        return [(complex(-(b**4)), 3e-16 * float(b**4)) for b in roots]


def mathieu(q: float) -> Any:
    """y″ = (2q cos 2x + σ) y: σ = −a."""
    return lambda x: second_order(2 * q * np.cos(2 * x), 0)


def mathieu_values(q: float, kind: str, count: int) -> list[tuple[complex, float]]:
    """a_{2n} ('even') and b_{2n+2} ('odd'), and a_{2n+1}, b_{2n+1} of period 2π, from their tridiagonal matrices in mpmath."""
    with mpmath.workdps(30):
        size = 40
        M = mpmath.zeros(size)
        for i in range(size):
            k = {"even": 2 * i, "odd": 2 * i + 2, "even1": 2 * i + 1, "odd1": 2 * i + 1}[kind]
            M[i, i] = mpmath.mpf(k * k)
            if i + 1 < size:
                M[i, i + 1] = M[i + 1, i] = mpmath.mpf(q)
        if kind == "even":
            M[0, 1] = M[1, 0] = mpmath.sqrt(2) * q
        if kind == "even1":
            M[0, 0] += q
        if kind == "odd1":
            M[0, 0] -= q
        values = mpmath.eigsy(M, eigvals_only=True)
        return [(complex(-v), 2.3e-16 * float(abs(v))) for v in sorted(values)[:count]]


def folded(a: Any, length: float) -> Any:
    """y″ = (a(x) + σ) y on a ring of circumference 2·length: y₁(x) = y(x), y₂(x) = y(−x), 0 < x < length."""

    def pencil(x: Any) -> Any:
        D0 = np.zeros((4, 4), dtype=type(1j * a(x)))
        D1 = np.zeros((4, 4))
        D0[0, 1] = D0[2, 3] = 1
        D0[1, 0], D0[3, 2] = a(x), a(-x)
        D1[1, 0] = D1[3, 2] = 1
        return D0, D1

    coupled = [[1, 0, -1, 0], [0, 1, 0, 1]]
    return lambda: st.problem(4, pencil, st.Wall(0, coupled), st.Wall(length, coupled))


def coffey_evans(beta: float) -> Any:
    """−y″ + (β² sin² 2x − 2β cos 2x) y = −σ y, y(±π/2) = 0."""
    return lambda x: second_order(beta**2 * np.sin(2 * x) ** 2 - 2 * beta * np.cos(2 * x), 0)


def coffey_evans_values(beta: int, count: int) -> list[tuple[complex, float]]:
    """Eigenvalues from a basis of sines of n(x + π/2): β²/2 − (β²/2) cos 4x − 2β cos 2x couples n to n ± 2 and n ± 4; in mpmath."""
    with mpmath.workdps(30):
        size, b = 44, mpmath.mpf(beta)
        out = []
        for first in (1, 2):
            M = mpmath.zeros(size)
            for i in range(size):
                n = first + 2 * i
                M[i, i] += n * n + b * b / 2
                # cos 2x = −cos 2X and cos 4x = cos 4X, X = x + π/2; sin nX cos mX = (sin (n+m)X + sin (n−m)X)/2
                for m, coefficient in ((2, 2 * b), (4, -b * b / 2)):
                    for k in (n + m, n - m):
                        sign = 1 if k > 0 else -1
                        j = (abs(k) - first) // 2
                        if k != 0 and 0 <= j < size:
                            M[j, i] += sign * coefficient / 2
            out += list(mpmath.eigsy(M, eigvals_only=True))
        return [(complex(-v), 4e-16 * float(abs(v)) + 1e-17) for v in sorted(out)[:count]]


def double_well(h: float) -> Any:
    """−h²y″ + (x² − 1)² y = σ y."""
    return lambda x: second_order((x * x - 1) ** 2 / h**2, 0, -1 / h**2)


def double_well_values(h: float, count: int) -> list[tuple[complex, float]]:
    """Values in the basis of the oscillator −h²y″ + 4x²y, whose width both wells share, in mpmath; truncated at 110 of either parity."""
    with mpmath.workdps(30):
        size = 130
        w = mpmath.mpf(2)  # −h² y″ + w² x²: x² = (h/2w)(a + a†)²
        X = mpmath.zeros(size + 6)
        for n in range(size + 5):
            X[n, n + 1] = X[n + 1, n] = mpmath.sqrt(mpmath.mpf(h) / (2 * w) * (n + 1))
        import flint

        flint.ctx.dps = 30
        F = flint.arb_mat([[flint.arb(str(X[i, j])) if X[i, j] else flint.arb(0) for j in range(size + 6)] for i in range(size + 6)])
        X2 = F * F
        X4 = X2 * X2
        out = []
        for parity in (0, 1):
            index = list(range(parity, size, 2))
            M = mpmath.zeros(len(index))
            for a, i in enumerate(index):
                for b, j in enumerate(index):
                    value = X4[i, j] - (2 + 4) * X2[i, j]  # V − w²x² with w² = 4
                    if abs(i - j) <= 4:
                        M[a, b] = mpmath.mpf(value.mid().str(28, radius=False))
                    if i == j:
                        M[a, b] += mpmath.mpf(h) * w * (2 * i + 1) + 1
            out += list(mpmath.eigsy(M, eigvals_only=True))
        return [(complex(v), 1e-15) for v in sorted(out)[:count]]


def well_modes(a: float, V: float, count: int) -> list[tuple[complex, float]]:
    """y″ = (σ + V [x > a]) y, y(0) = y(1) = 0: y′/y to the left and to the right of a agree; σ = −s², scanned in mpmath."""

    def f(s2: Any) -> Any:
        k, q = mpmath.sqrt(s2), mpmath.sqrt(mpmath.mpc(V) - s2)
        left = mpmath.cos(k * a) * k
        ratio = mpmath.exp(-mpmath.re(q) * (1 - a))
        return mpmath.re(ratio * (left * mpmath.sinh(q * (1 - a)) / q + mpmath.sin(k * a) * mpmath.cosh(q * (1 - a))))

    with mpmath.workdps(30):
        a = mpmath.mpf(a)
        found: list[Any] = []
        s2, step = mpmath.mpf("0.5"), mpmath.mpf("0.35")
        before = f(s2)
        while len(found) < count:
            now = f(s2 + step)
            if before * now < 0:
                found.append(mpmath.findroot(f, (s2, s2 + step), solver="anderson", tol=1e-45))
            s2, before = s2 + step, now
        return [(complex(-v), 3e-16 * float(v)) for v in found]


def well(a: float, V: float, interface: bool) -> Any:
    def pencil(x: Any) -> Any:
        return second_order(V * (x > a), 0)

    return walls(2, pencil, 0, DIRICHLET, 1, DIRICHLET, **({"interfaces": jumps([a], 2)} if interface else {}))


def kinked(x: Any) -> Any:
    """y″ = (60 |x − 0.37| + σ) y."""
    return second_order(60 * abs(x - 0.37), 0)


def spline_profile() -> Any:
    from scipy.interpolate import CubicSpline

    z = np.linspace(0, 1, 31)
    spline = CubicSpline(z, 40 * np.cos(7 * z))
    return z, spline


def splined(x: Any) -> Any:
    """31 points of 40 cos 7x, joined by a cubic spline: third derivatives jump at 29 points."""
    z, c = SPLINE
    i = min(int(float(x) * 30), 29)
    d = x - type(x)(z[i])
    return second_order(((c[0, i] * d + c[1, i]) * d + c[2, i]) * d + c[3, i], 0)


SPLINE = (lambda z, s: (z, s.c))(*spline_profile())


def linear_table(x: Any) -> Any:
    """11 points joined by straight lines (np.interp)."""
    z = np.linspace(0, 1, 11)
    return second_order(float(np.interp(float(x), z, 50 * np.sin(5 * z))), 0)


def linear_exact(x: Any) -> Any:
    z = np.linspace(0, 1, 11)
    v = 50 * np.sin(5 * z)
    i = min(int(float(x) * 10), 9)
    t = (x - type(x)(z[i])) / type(x)(z[i + 1] - z[i])
    return second_order(v[i] * (1 - t) + v[i + 1] * t, 0)


def jordan(k: int) -> Any:
    """k strings y_j″ = σ y_j + ε y_{j+1}: every eigenvalue −n²π² is one Jordan block of size k."""
    n = 2 * k
    D0, D1 = np.zeros((n, n)), np.zeros((n, n))
    for j in range(k):
        D0[2 * j, 2 * j + 1] = 1
        D1[2 * j + 1, 2 * j] = 1
        if j + 1 < k:
            D0[2 * j + 1, 2 * j + 2] = 1.7
    rows = np.eye(n)[::2]
    return walls(n, lambda z: (D0, D1), 0, rows, 1, rows)


def rank_bug(z: Any) -> Any:
    """y′ = x, x′ − σ y′ = 0: C = [[1, 0], [−σ, 1]] has determinant 1; x = σy + c, y(0) = 0, x(1) = 0."""
    return np.eye(2), np.array([[0, 0], [-1.0, 0]]), np.array([[0, 1.0], [0, 0]]), np.zeros((2, 2))


def mixed(z: Any) -> Any:
    """A string under a similarity that moves with σ: C = S(1 + σN), so that C1 stands in two rows of three; w′ = w beside it."""
    S = np.array([[2.0, 0.3 * z, 0.1], [0, 1, 0.4], [0.2, 0, 1]])
    N = np.array([[0, 0, 1.0], [0, 0, -0.5], [0, 0, 0]])
    D0, D1 = np.array([[0, 1.0, 0], [0, 0, 0], [0, 0, 1]]), np.array([[0, 0, 0], [1.0, 0, 0], [0, 0, 0]])
    # (1 + σN)ψ′ = (D0 + σD1)ψ with w′ = w: rows 0 and 1 gain σ(w, −w/2)
    extra = np.array([[0, 0, 1.0], [0, 0, -0.5], [0, 0, 0]])
    return S, S @ N, S @ D0, S @ (D1 + extra)


def coupled(n: int, seed: int) -> Any:
    """n/2 coupled strings y″ = (A cos 2z + B + σ) y + C y′ with matrices drawn once."""
    rng = np.random.default_rng(seed)
    m = n // 2
    A, B, C = 8 * rng.standard_normal((m, m)), 3 * rng.standard_normal((m, m)), rng.standard_normal((m, m))

    def pencil(z: Any) -> Any:
        D0, D1 = np.zeros((n, n), dtype=type(1j * z)), np.zeros((n, n))
        D0[:m, m:] = np.eye(m)
        D0[m:, :m] = A * np.cos(2 * z) + B
        D0[m:, m:] = C
        D1[m:, :m] = np.eye(m)
        return D0, D1

    return pencil


def coupled_stranger(n: int, seed: int, guesses: list[complex]) -> Stranger:
    p, rows = coupled(n, seed), np.eye(n // 2, n)
    return Stranger(
        f"{n // 2} coupled strings, order {n}",
        "random matrices, order 8–16",
        "collocation",
        walls(n, p, 0, rows, 1, rows),
        collocated(n, p, Fixed(0, rows), Fixed(1, rows), guesses, N=20),
        guess=1e-4,
    )


def forum_beam(x: Any) -> Any:
    """Buckling on a foundation: (E y″)″ + y = −σ y″, E = 1 − 0.9 exp(−4(x − 5)²), clamped on [0, 10]; ψ = (y, y′, Ey″, (Ey″)′)."""
    E = 1 - 0.9 * np.exp(-4 * (x - 5) ** 2)
    D0 = np.array([[0, 1, 0, 0], [0, 0, 1 / E, 0], [0, 0, 0, 1], [-1, 0, 0, 0]])
    D1 = np.zeros((4, 4), dtype=type(E))
    D1[3, 2] = -1 / E
    return D0, D1


def bump(x: Any) -> Any:
    """y″ = (σ + b)y, b a Gaussian of width 1e-4 and area 20 at 0.4137."""
    d = (x - 0.4137) / 1e-4
    return second_order(20e4 / math.sqrt(PI) * np.exp(-d * d), 0)


def noisy(x: Any) -> Any:
    """w″ = (1 + σ)w, b′ = (s w)′ with s = 1 − tanh², noise where it should vanish."""
    s = 1 - np.tanh(30 * (x - 0.5)) ** 2
    slope = -60 * np.tanh(30 * (x - 0.5)) * s
    return np.array([[0, 1, 0], [1, 0, 0], [slope, s, 0.0]]), np.array([[0, 0, 0], [1.0, 0, 0], [0, 0, 0]])


def moving_mass(m: float) -> Any:
    """A string with a mass at its end: y″ = σ y, y(0) = 0, y′(1) + mσ y(1) = 0."""
    return lambda: st.problem(2, string, st.Wall(0, DIRICHLET), st.Wall(1, [[0, 1]], moving=[[m, 0]]))


def moving_mass_values(m: float, count: int) -> list[tuple[complex, float]]:
    """y = sin κx, y′(1) + mσ y(1) = 0: κ cos κ = mκ² sin κ."""
    with mpmath.workdps(30):
        half, tiny = mpmath.mpf("0.5"), mpmath.mpf("1e-9")
        between = [(n * mpmath.pi + tiny, (n + half) * mpmath.pi) for n in range(count)]
        roots = [mpmath.findroot(lambda k: mpmath.cos(k) - m * k * mpmath.sin(k), b, solver="anderson") for b in between]
        return [(complex(-(k**2)), 3e-16 * float(k * k)) for k in roots]


def on_the_boundary(problem: Any) -> Any:
    """A region whose side runs through a mode is refused for that reason, and one whose side passes it at 1e-6 is counted."""
    try:
        n = st.count(problem, st.Rectangle(-(PI**2) - 1j, -1 + 1j))
        yield "side through a mode", "WRONG", f"{n} without a word"
    except st.ConvergenceError as error:
        yield "side through a mode", "right" if "boundary" in str(error) or "contour" in str(error) else "UNTRUE", str(error)
    for d, truth in ((1e-6, 1), (-1e-6, 0)):
        n = st.count(problem, st.Rectangle(-(PI**2) * (1 + d) - 1j, -1 + 1j))
        yield f"side beside a mode, {d}", "right" if n == truth else "WRONG", f"{n}, truth {truth}"


def odd_claims(problem: Any) -> Any:
    """Noise in the imaginary part, a repetition, the mirror image, and far-off numbers."""
    claims = [-9.869604401 + 3e-11j, -9.869604401, 9.869604401, 1e9, -9.88]
    expected = [("confirmed",), ("spurious",), ("spurious",), ("spurious", "unresolved"), ("inaccurate",)]
    report = st.verify(problem, claims[:4], digits=7)
    verdicts = [v.verdict for v in report.verdicts] + [st.verify(problem, claims[4:]).verdicts[0].verdict]
    # either of the first two may answer for the mode
    swapped = [*sorted(verdicts[:2]), *verdicts[2:]]
    for claim, got, right in zip(claims, swapped, expected, strict=True):
        yield f"claim {claim:.10g}", "right" if got in right else "WRONG", f"{got}, not {right}"


def davies_walls(x: Any) -> Any:
    return second_order(1j * x * x, 0, -1)


def davies_box(n: int) -> Stranger:
    rows = DIRICHLET
    guess = (2 * n + 1) * complex(math.sqrt(0.5), math.sqrt(0.5))
    return Stranger(
        f"Davies on [−8, 8], n = {n}",
        "a fault report",
        "collocation",
        walls(2, davies_walls, -8, rows, 8, rows),
        collocated(2, davies_walls, Fixed(-8, rows), Fixed(8, rows), [guess], cuts=(-6, -4.5, -3, -1.5, 0, 1.5, 3, 4.5, 6), N=44),
    )


STRANGERS = [
    Stranger(
        "string, small discs",
        "a fault report",
        "exact",
        walls(2, string, 0, DIRICHLET, 1, DIRICHLET),
        exactly(*(-((k * PI) ** 2) for k in range(1, 11))),
        region=st.Rectangle(-1000 - 20j, -1 + 21j),
        spurious=(-20.0, -39.0 + 1j),
        quick=True,
    ),
    Stranger(
        "string, sides through modes, odd claims",
        "the kind of A2 and A5",
        "exact",
        walls(2, string, 0, DIRICHLET, 1, DIRICHLET),
        exactly(-(PI**2)),
        also=lambda p, modes: [*on_the_boundary(p), *odd_claims(p)],
    ),
    Stranger(
        "narrow bump, width 1e-4",
        "a feature between mesh points",
        "collocation",
        walls(2, bump, 0, DIRICHLET, 1, DIRICHLET),
        collocated(
            2, bump, Fixed(0, DIRICHLET), Fixed(1, DIRICHLET), [-23.97], cuts=(0.4129, 0.4133, 0.4136, 0.4137, 0.4138, 0.4141, 0.4145), N=40
        ),
    ),
    Stranger(
        "string, free at both ends",
        "a fault report",
        "exact",
        walls(2, string, 0, NEUMANN, 1, NEUMANN),
        exactly(0, -(PI**2), -4 * PI**2),
        region=st.Rectangle(-60 - 5j, 5 + 4j),
        scale=PI**2,
        quick=True,
    ),
    Stranger(
        "beam, free at both ends (double zero)",
        "textbook",
        "exact",
        walls(4, beam, 0, np.eye(4)[2:], 1, np.eye(4)[2:]),
        lambda: [(0j, 1e-16)] * 2 + beam_roots(2, 1),
        region=st.Rectangle(-5000 - 300j, 300 + 310j),
        scale=500.0,
    ),
    Stranger(
        "beam, clamped at both ends",
        "textbook",
        "exact",
        walls(4, beam, 0, np.eye(2, 4), 1, np.eye(2, 4)),
        lambda: beam_roots(3, 1),
        region=st.Rectangle(-16000 - 300j, -100 + 310j),
    ),
    Stranger(
        "beam, cantilever",
        "textbook",
        "exact",
        walls(4, beam, 0, np.eye(2, 4), 1, np.eye(4)[2:]),
        lambda: beam_roots(3, -1),
        region=st.Rectangle(-5000 - 300j, -2 + 310j),
    ),
    Stranger(
        "beam of a forum on a foundation, weak in the middle",
        "a forum's value has 10 digits",
        "published",
        walls(4, forum_beam, 0, np.eye(2, 4), 10, np.eye(2, 4)),
        lambda: [(1.61375831795161188 + 0j, 1e-15)],
        region=st.Rectangle(-2 - 0.5j, 1.7 + 0.6j),
        quick=True,
    ),
    Stranger(
        "two strings, 3 digits (assignment)",
        "a fault report",
        "exact",
        walls(4, two_strings(71.910404, 72.046555), 0, ROWS4, 1, ROWS4),
        exactly(-71.910404, -72.046555),
        region=st.Rectangle(-80 - 5j, -60 + 5.1j),
        also=lambda p, modes: assignment(p),
        quick=True,
    ),
    *(
        Stranger(
            f"two strings, relative gap {d:g}",
            "a fault report",
            "exact",
            walls(4, two_strings(PI**2, PI**2 * (1 + d)), 0, ROWS4, 1, ROWS4),
            lambda d=d: [(-(PI**2) + 0j, 1e-15), (-(PI**2) * (1 + d) + 0j, 1e-15)],
            region=st.Rectangle(-12 - 1j, -8 + 1.1j),
            skip=("missing",) if d < 1e-5 else (),
            refined=2 if d >= 1e-5 else 0,
        )
        for d in (1e-4, 1e-6, 1e-7, 1e-8, 1e-10, 1e-12, 0.0)
    ),
    *(
        Stranger(
            f"double well, h = {h:g}",
            "a fault report",
            "independent",
            walls(2, double_well(h), -3, DIRICHLET, 3, DIRICHLET),
            lambda h=h: double_well_values(h, 4),
            region=st.Rectangle(0.02 - 0.3j, 6.3 * h + 0.31j),
            skip=("missing",),
            refined=0,
        )
        for h in (0.15, 0.08)
    ),
    Stranger(
        "Jordan blocks of 2",
        "a fault report",
        "exact",
        jordan(2),
        lambda: [(-(PI**2) + 0j, 1e-15)] * 2,
        region=st.Rectangle(-12 - 1j, -8 + 1.1j),
        quick=True,
    ),
    Stranger(
        "Jordan blocks of 4",
        "a fault report",
        "exact",
        jordan(4),
        lambda: [(-(PI**2) + 0j, 1e-15)] * 4,
        region=st.Rectangle(-14 - 2j, -6 + 2.1j),
    ),
    Stranger(
        "Mathieu, q = 25, even about 0 and π/2",
        "DLMF 28",
        "independent",
        walls(2, mathieu(25.0), 0, NEUMANN, PI / 2, NEUMANN),
        lambda: mathieu_values(25.0, "even", 4),
        region=st.Rectangle(-55 - 3j, 50 + 3.1j),
    ),
    Stranger(
        "Mathieu, q = 25, on a ring of 2π (pairs)",
        "a fault report",
        "independent",
        folded(lambda x: 50 * np.cos(2 * x), PI),
        lambda: [m for k in ("even", "odd", "even1", "odd1") for m in mathieu_values(25.0, k, 5) if m[0].real > -20],
        region=st.Rectangle(-20 - 3j, 50 + 3.1j),
        skip=("missing",),
        refined=0,
    ),
    Stranger(
        "ring, double modes and 0",
        "textbook",
        "exact",
        folded(lambda x: 0.0 * x, PI),
        exactly(0, -1, -1, -4, -4),
        region=st.Rectangle(-6 - 1j, 0.5 + 1.1j),
        scale=1.0,
        skip=("missing",),
    ),
    Stranger(
        "Coffey–Evans, β = 30",
        "Pryce 1993",
        "independent",
        walls(2, coffey_evans(30.0), -PI / 2, DIRICHLET, PI / 2, DIRICHLET),
        lambda: coffey_evans_values(30, 6),
        region=st.Rectangle(-360 - 10j, 10 + 11j),
        scale=100.0,
        skip=("missing",),
        refined=2,
    ),
    *(
        Stranger(
            f"square well, a = {a}, V = {V:g}{'' if i else ', no interface'}",
            "a fault report",
            "exact",
            well(a, V, i),
            lambda a=a, V=V: well_modes(a, V, 2),
            region=None,
        )
        for a, V, i in ((0.37, 1000.0, True), (0.37, 1000.0, False), (0.6180339, 1e5, False), (0.5772, 10.0, False))
    ),
    Stranger(
        "kink |x − 0.37| in a coefficient",
        "a fault report",
        "collocation",
        walls(2, kinked, 0, DIRICHLET, 1, DIRICHLET),
        collocated(2, kinked, Fixed(0, DIRICHLET), Fixed(1, DIRICHLET), [-28, -57, -107], cuts=(0.37,), N=24),
    ),
    Stranger(
        "cubic spline of 31 points",
        "a fault report",
        "collocation",
        walls(2, splined, 0, DIRICHLET, 1, DIRICHLET),
        collocated(2, splined, Fixed(0, DIRICHLET), Fixed(1, DIRICHLET), [-9, -39, -88], cuts=tuple(np.linspace(0, 1, 31)[1:-1]), N=7),
    ),
    Stranger(
        "np.interp of 11 points",
        "a fault report",
        "collocation",
        walls(2, linear_table, 0, DIRICHLET, 1, DIRICHLET),
        collocated(
            2, linear_exact, Fixed(0, DIRICHLET), Fixed(1, DIRICHLET), [-9, -39, -88], cuts=tuple(np.linspace(0, 1, 11)[1:-1]), N=12
        ),
    ),
    Stranger(
        "39 interfaces, order 2",
        "a fault report",
        "exact",
        walls(2, string, 0, DIRICHLET, 1, DIRICHLET, interfaces=jumps([float(z) for z in np.linspace(0, 1, 41)[1:-1]], 2)),
        exactly(-(PI**2), -4 * PI**2),
        region=st.Rectangle(-60 - 5j, -2 + 5.1j),
    ),
    Stranger(
        "19 interfaces, order 4",
        "a fault report",
        "exact",
        walls(4, beam, 0, np.eye(2, 4), 1, np.eye(2, 4), interfaces=jumps([float(z) for z in np.linspace(0, 1, 21)[1:-1]], 4)),
        lambda: beam_roots(2, 1),
    ),
    Stranger(
        "C1 below the diagonal (rank_bug)",
        "a fault report",
        "exact",
        walls(2, rank_bug, 0, DIRICHLET, 1, NEUMANN),
        list,
        region=st.Rectangle(-5 - 4j, 3.3 + 4.1j),
        spurious=(1.0, -0.5),
    ),
    Stranger(
        "C1 in several rows",
        "the kind of rank_bug",
        "exact",
        walls(3, mixed, 0, [[1, 0, 0], [0, 0, 1]], 1, [[1, 0, 0]]),
        exactly(-(PI**2), -4 * PI**2),
        region=st.Rectangle(-60 - 5j, -2 + 5.1j),
    ),
    Stranger(
        "σ in the rows (mass at the end)",
        "textbook",
        "exact",
        moving_mass(0.7),
        lambda: moving_mass_values(0.7, 3),
        region=st.Rectangle(-60 - 5j, -0.3 + 5.1j),
        quick=True,
    ),
    Stranger(
        "two scales of time, 1 and 20",
        "the kind of A2: a growing mode counted away",
        "exact",
        walls(4, two_times(0.05), 0, ROWS4, SLOW_LENGTH, ROWS4),
        exactly(20, -40, *(-((PI / SLOW_LENGTH) ** 2) * n**2 for n in (1, 2, 3))),
        unstable=1,
    ),
    Stranger(
        "noise of rounding in a coefficient",
        "a fault report",
        "exact",
        walls(3, noisy, 0, [[1, 0, 0], [0, 0, 1]], 1, [[1, 0, 0]]),
        exactly(-1 - PI**2, -1 - 4 * PI**2),
        region=st.Rectangle(-60 - 5j, -2 + 5.1j),
    ),
    davies_box(0),
    davies_box(9),
    davies_box(19),
    coupled_stranger(8, 3, [-8.96625, -10.57594, -18.923 + 8.2988j]),
    coupled_stranger(12, 4, [-1.8024 + 3.9314j, -12.7599 - 2.1855j]),
    coupled_stranger(16, 5, [4.5583, -0.8826, -16.6935]),
]


def assignment(problem: Any) -> Any:
    """Two claims, each with three digits of a mode, in order: both are inaccurate, and nothing is missing."""
    report = st.verify(problem, [-71.982182, -72.120542])
    verdicts = [v.verdict for v in report.verdicts]
    good = verdicts == ["inaccurate", "inaccurate"] and not report.missing
    yield "assignment", "right" if good else "WRONG", f"{verdicts}, missing {[complex(m.sigma) for m in report.missing]}"
