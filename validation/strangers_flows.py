"""Strangers from hydrodynamics: Orr–Sommerfeld, Squire, convection, rotation, stratification, baroclinic waves, layers, free surfaces."""

from __future__ import annotations

import math
from typing import Any

import mpmath
import numpy as np
from collocation import stretched
from stranger import ElementJoint, Far, Fixed, Stranger, collocated, exactly, jumps, walls

import shootstab as st

PI = math.pi
CLAMPED = np.eye(2, 4)  # exact


def orr_sommerfeld(U: Any, U2: Any, R: float, alpha: float) -> Any:
    """(iα(U − c)(D² − α²) − iαU″)φ = (D² − α²)²φ/R, σ = −iαc, ψ = (φ, φ′, φ″, φ‴)."""
    a2 = alpha * alpha

    def pencil(y: Any) -> Any:
        u, u2 = U(y), U2(y)
        D0, D1 = np.zeros((4, 4), dtype=type(1j * y)), np.zeros((4, 4))
        D0[0, 1] = D0[1, 2] = D0[2, 3] = 1
        D0[3, 0], D0[3, 2] = -a2 * a2 - 1j * alpha * R * (u * a2 + u2), 2 * a2 + 1j * alpha * R * u
        D1[3, 0], D1[3, 2] = -R * a2, R
        return D0, D1

    return pencil


def poiseuille(R: float, alpha: float) -> Any:
    return orr_sommerfeld(lambda y: 1 - y * y, lambda y: -2.0, R, alpha)


def couette(R: float, alpha: float) -> Any:
    return orr_sommerfeld(lambda y: y, lambda y: 0.0, R, alpha)


def sech(x: Any) -> Any:
    y = -x if complex(x).real < 0 else x
    e = np.exp(-y)
    return 2 * e / (1 + e * e)


def bickley(R: float, alpha: float) -> Any:
    """U = sech²y: U″ = 4 sech² − 6 sech⁴."""
    return orr_sommerfeld(lambda y: sech(y) ** 2, lambda y: 4 * sech(y) ** 2 - 6 * sech(y) ** 4, R, alpha)


def mixing(R: float, alpha: float) -> Any:
    """U = tanh y: U″ = −2 tanh sech²."""
    return orr_sommerfeld(np.tanh, lambda y: -2 * np.tanh(y) * sech(y) ** 2, R, alpha)


def channel(name: str, source: str, pencil: Any, guesses: list[complex], N: int = 64, cuts: tuple[float, ...] = (), **kw: Any) -> Stranger:
    """A channel between walls at ±1, truth by collocation."""
    return Stranger(
        name,
        source,
        "collocation",
        walls(4, pencil, -1, CLAMPED, 1, CLAMPED),
        collocated(4, pencil, Fixed(-1, CLAMPED), Fixed(1, CLAMPED), guesses, N=N, cuts=cuts),
        **kw,
    )


EVEN, ODD = np.eye(4)[[1, 3]], np.eye(4)[[0, 2]]  # exact


def half_channel(R: float, rows: Any, guesses: list[complex]) -> Any:
    """Modes of one parity of Poiseuille flow, on elements that resolve the layer at the centre."""
    return collocated(4, poiseuille(R, 1.0), Fixed(-1, CLAMPED), Fixed(0, rows), guesses, cuts=(-0.97, -0.8, -0.4, -0.2, -0.1), N=28)


def squire(y: Any) -> Any:
    """η″ = (α² + iαR U + Rσ)η in plane Couette flow, R = 800, α = 1."""
    return np.array([[0, 1], [1 + 800j * y, 0]]), np.array([[0, 0], [800, 0]])


def benard(Ra: float, k: float, Pr: float) -> Any:
    """(D² − k²)(D² − k² − σ/Pr)w = k² Ra θ, (D² − k² − σ)θ = −w: ψ = (w, w′, w″, w‴, θ, θ′)."""
    a = k * k

    def pencil(z: Any) -> Any:
        D0, D1 = np.zeros((6, 6)), np.zeros((6, 6))
        D0[0, 1] = D0[1, 2] = D0[2, 3] = D0[4, 5] = 1
        D0[3, 0], D0[3, 2], D0[3, 4] = -a * a, 2 * a, a * Ra
        D1[3, 0], D1[3, 2] = -a / Pr, 1 / Pr
        D0[5, 0], D0[5, 4] = -1, a
        D1[5, 4] = 1
        return D0, D1

    return pencil


RIGID = np.eye(6)[[0, 1, 4]]  # exact
FREE = np.eye(6)[[0, 2, 4]]  # exact


def free_benard(Ra: float, k: float, Pr: float, count: int) -> list[complex]:
    """Both surfaces free: (σ/Pr + q)(σ + q) q = k² Ra, q = n²π² + k²."""
    out = []
    for n in range(1, count + 1):
        q = n * n * PI * PI + k * k
        roots = np.roots([1 / Pr, q + q / Pr, q * q - k * k * Ra / q])
        out += [complex(r) for r in roots]
    return out


def free_benard_modes(Ra: float, k: float, Pr: float, count: int) -> Any:
    def modes() -> list[tuple[complex, float]]:
        out = []
        with mpmath.workdps(30):
            for n in range(1, count + 1):
                q = n * n * mpmath.pi**2 + mpmath.mpf(k) ** 2
                P = mpmath.mpf(Pr)
                for r in mpmath.polyroots([1 / P, q + q / P, q * q - mpmath.mpf(k) ** 2 * Ra / q]):
                    out.append((complex(r), 2.3e-16 * float(abs(r))))
        return out

    return modes


def rotating_couette(R: float, Ro: float, k: float) -> Any:
    """Streamwise vortices in plane Couette flow U = y on [−1, 1] that rotates, Coriolis Ro, in (v, v′, v″, v‴, u, u′).

    (D² − k² − Rσ)u = R(1 − Ro)v, (D² − k²)(D² − k² − Rσ)v = −k² R Ro u: Bénard's equations."""
    a = k * k

    def pencil(y: Any) -> Any:
        D0, D1 = np.zeros((6, 6)), np.zeros((6, 6))
        D0[0, 1] = D0[1, 2] = D0[2, 3] = D0[4, 5] = 1
        D0[3, 0], D0[3, 2], D0[3, 4] = -a * a, 2 * a, -a * R * Ro
        D1[3, 0], D1[3, 2] = -a * R, R
        D0[5, 0], D0[5, 4] = R * (1 - Ro), a
        D1[5, 4] = R
        return D0, D1

    return pencil


def eady(mu: float) -> Any:
    """ψ″ = μ²ψ, (z − c)ψ′ = ψ at z = 0, 1, σ = c."""
    return lambda: st.problem(
        2,
        lambda z: (np.array([[0, 1], [mu * mu, 0]]), np.zeros((2, 2))),
        st.Wall(0, [[-1, 0]], moving=[[0, -1]]),
        st.Wall(1, [[-1, 1]], moving=[[0, -1]]),
    )


def eady_modes(mu: float) -> Any:
    def modes() -> list[tuple[complex, float]]:
        with mpmath.workdps(40):
            h = mpmath.mpf(mu) / 2
            root = mpmath.sqrt((h - mpmath.coth(h)) * (h - mpmath.tanh(h))) / mu
            return [(complex(0.5 + s * root), 1e-16 if abs(root) > 1e-3 else 1e-15) for s in (1, -1)]

    return modes


def layers(r: float, g: float, k: float) -> Any:
    """Two inviscid layers, −1 < z < 0 of density 1 at speed 0 and 0 < z < 1 of density r at speed 1, wave k, gravity g.

    q = w/(σ + ikU), the displacement: q″ = k²q, continuous; pressure: [ρ(σ + ikU)²q′] = (1 − r) g k² q at z = 0. Affine in σ with Q = σq
    beside it, state (q, q′, Q, Q′)."""
    a = k * k

    def pencil(z: Any) -> Any:
        D0 = np.zeros((4, 4))
        D0[0, 1] = D0[2, 3] = 1
        D0[1, 0] = D0[3, 2] = a
        return D0, np.zeros((4, 4))

    # states (q, q′, Q, Q′), Q = σq holds at all z if it does at the wall and at one more condition; walls: q = 0, Q = 0
    before, behind, moving_before, moving_behind = (np.zeros((4, 4), dtype=complex) for _ in range(4))
    before[0, 0], behind[0, 0] = 1, -1  # q continuous
    before[1, 2], behind[1, 2] = 1, -1  # Q continuous
    moving_before[2, 0], before[2, 2] = -1, 1  # Q = σ q at 0
    # σ² q′ = σ Q′ below and r(σ + ik)² q′ = r(σQ′ + 2ik Q′ − k² q′) above; their difference is −(1 − r) g k² q
    moving_before[3, 3] = 1
    moving_behind[3, 3], behind[3, 3], behind[3, 1] = -r, -2j * k * r, r * k * k
    before[3, 0] = (1 - r) * g * a
    wall = [[1, 0, 0, 0], [0, 0, 1, 0]]
    return lambda: st.problem(
        4, pencil, st.Wall(-1, wall), st.Wall(1, wall), interfaces=[st.Interface(0.0, before, behind, moving_before, moving_behind)]
    )


def layers_modes(r: float, g: float, k: float) -> list[complex]:
    """σ² + r(σ + ik)² + (1 − r) g k tanh k = 0: coth k on both sides."""
    return [complex(v) for v in np.roots([1 + r, 2j * k * r, -r * k * k + (1 - r) * g * k * math.tanh(k)])]


def film(R: float, alpha: float, beta: float) -> Any:
    """A film down a plane at angle β, U = 1 − y², its free surface at y = 0 and the wall at y = 1, no surface tension (Yih 1963).

    The displacement η of the surface is a fifth, constant component."""
    a2 = alpha * alpha
    base = poiseuille(R, alpha)

    def pencil(y: Any) -> Any:
        d0, d1 = base(y)
        D0, D1 = np.zeros((5, 5), dtype=d0.dtype), np.zeros((5, 5))
        D0[:4, :4], D1[:4, :4] = d0, d1
        return D0, D1

    # c = iσ/α. Kinematic: φ = (c − 1)η. No shear: φ″ + α²φ + U″η = 0, U″ = −2.
    # No normal stress: iαR(1 − c)φ′ = φ‴ − 3α²φ′ + 2iα cot β η, as a film with surface speed 1 has gravity g cos β = 2 cot β/R
    rows = np.zeros((3, 5), dtype=complex)
    moving = np.zeros((3, 5), dtype=complex)
    rows[0, 0], rows[0, 4], moving[0, 4] = 1, 1, -1j / alpha
    rows[1, 2], rows[1, 0], rows[1, 4] = 1, a2, -2
    rows[2, 3], rows[2, 1], rows[2, 4] = 1, -3 * a2 - 1j * alpha * R, 2j * alpha / math.tan(beta)
    moving[2, 1] = -R
    wall = np.eye(2, 5)
    return pencil, rows, moving, wall


def film_stranger() -> Stranger:
    pencil, rows, moving, wall = film(20.0, 0.3, PI / 3)
    return Stranger(
        "falling film, free surface, R = 20",
        "Yih 1963",
        "collocation",
        lambda: st.problem(5, pencil, st.Wall(0, rows, moving=moving), st.Wall(1, wall)),
        collocated(5, pencil, Fixed(0, rows, moving), Fixed(1, wall), [-0.3j * 1.9 + 0.02], N=32),
        also=lambda p, modes: long_waves(),
    )


def long_waves() -> Any:
    """The growth of long waves changes sign at R = (5/4) cot β, Yih's exact limit: α = 1e-3, R 2 % to either side."""
    for factor, sign in ((0.98, -1), (1.02, 1)):
        pencil, rows, moving, wall = film(1.25 / math.tan(0.5) * factor, 1e-3, 0.5)
        m = st.refine(st.problem(5, pencil, st.Wall(0, rows, moving=moving), st.Wall(1, wall)), -2e-3j)
        good = m.converged and m.sigma.real * sign > m.error
        yield f"long waves, R = {factor} R_c", "right" if good else "WRONG" if m.converged else "lost", f"{m.sigma} ± {m.error}: {m.status}"


def rayleigh_mixing(alpha: float) -> Any:
    """(σ + iαU)(φ″ − α²φ) = iαU″φ, U = tanh: C1 in the pencil; neutral at α = 1."""

    def pencil(y: Any) -> Any:
        u, u2 = np.tanh(y), -2 * np.tanh(y) * (1 - np.tanh(y) ** 2)
        C0, C1 = np.array([[1, 0], [0, 1j * alpha * u]]), np.array([[0, 0], [0, 1.0]])
        D0 = np.array([[0, 1], [alpha**2 * 1j * alpha * u + 1j * alpha * u2, 0]])
        return C0, C1, D0, np.array([[0, 0], [alpha**2, 0]])

    return pencil


def sine_shear(alpha: float) -> Any:
    """Rayleigh's equation for U = sin y between walls at ±π: unstable for α² < 3/4."""

    def pencil(y: Any) -> Any:
        u = np.sin(y)
        C0, C1 = np.array([[1, 0], [0, 1j * alpha * u]]), np.array([[0, 0], [0, 1.0]])
        D0 = np.array([[0, 1], [alpha**2 * 1j * alpha * u - 1j * alpha * u, 0]])
        return C0, C1, D0, np.array([[0, 0], [alpha**2, 0]])

    return pencil


def piecewise_shear(k: float) -> Any:
    """Rayleigh 1880: U = ±1 outside |z| < 1, U = z inside, no wall; φ″ = k²φ; jumps (σ + ikU)[φ′] = ik[U′]φ at z = ±1."""

    def pencil(z: Any) -> Any:
        return np.array([[0, 1], [k * k, 0]]), np.zeros((2, 2))

    def at(z: float, jump: float) -> Any:
        U = z
        before, behind, mb, mh = (np.zeros((2, 2), dtype=complex) for _ in range(4))
        before[0, 0], behind[0, 0] = 1, -1
        before[1, 1], behind[1, 1] = -1j * k * U, 1j * k * U
        before[1, 0] = -1j * k * jump
        mb[1, 1], mh[1, 1] = -1, 1
        return st.Interface(z, before, behind, mb, mh)

    return lambda: st.problem(2, pencil, st.Infinity(), st.Infinity(), interfaces=[at(-1.0, 1.0), at(1.0, -1.0)])


def piecewise_modes(k: float) -> list[complex]:
    """c² = ((1 − 2k)² − e^{−4k})/(4k²), σ = −ikc."""
    c = np.sqrt(complex((1 - 2 * k) ** 2 - math.exp(-4 * k))) / (2 * k)
    return [complex(-1j * k * c), complex(1j * k * c)]


def stratified(J: float, k: float) -> Any:
    """Taylor–Goldstein, U = tanh z, N² = J sech²z, in (w, w′, b): order 2 + 1; chebfun's issue 1575 has it between walls."""
    Ri, half = J, 10.0

    def pencil(z: Any) -> Any:
        t = np.tanh(z)
        s = sech(z) ** 2
        a, N2 = 1j * k * t, Ri * s
        N2p = -2 * t * N2
        C0, C1 = np.diag([1, a, a]), np.diag([0.0, 1, 1])
        D0 = np.array([[0, 1, 0], [k * k * a + 1j * k * (-2 * t * s), 0, -k * k], [-0 - N2p, -N2, -1j * k * s]])
        D0 = D0 + np.array([[0, 0, 0], [0, 0, 0], [0.7 * -N2, 0, 0.7 * -a]]) * -1 * 0
        return C0, C1, D0, np.array([[0, 0, 0], [k * k, 0, 0], [0, 0, 0]])

    # (σ + ikU)b + N²w = 0 differentiated: (σ + ikU)b′ = −N²w′ − N²′w − ikU′b; at the wall b(σ + ikU) = 0 with w = 0
    wall3 = [[1, 0, 0], [0, 0, 1]]
    return (
        lambda: st.problem(3, pencil, st.Wall(-half, wall3), st.Wall(half, [[1, 0, 0]]), continuum=lambda z: -1j * k * np.tanh(z)),
        pencil,
        half,
    )


def stratified_stranger(J: float, k: float, guess: complex) -> Stranger:
    make, pencil, half = stratified(J, k)
    return Stranger(
        f"stratified shear layer, J = {J:g}, k = {k:g}",
        "Hazel 1972; chebfun issue 1575",
        "collocation",
        make,
        collocated(
            3,
            pencil,
            Fixed(-half, [[1, 0, 0], [0, 0, 1]]),
            Fixed(half, [[1, 0, 0]]),
            [guess],
            cuts=(-6, -3, -1.5, -0.6, 0, 0.6, 1.5, 3, 6),
            N=22,
        ),
        region=st.Rectangle(0.02 - 0.2j, 0.6 + 0.21j),
        spurious=(0.35 + 0.1j,),
        on=(0.5j * k,),
    )


ROTATING = rotating_couette(100.0, 0.5, 1.558)  # chosen

STRANGERS = [
    channel(
        "Poiseuille, R = 10⁴",
        "Orszag 1971",
        poiseuille(1e4, 1.0),
        [-1j * (0.2375265 + 0.0037397j), -1j * (0.96463092 - 0.03516728j), -1j * (0.9646425 - 0.0351866j)],
        spurious=(0.02 - 0.5j, -1j * 0.3),
        also=None,
        quick=True,
    ),
    Stranger(
        "Poiseuille, R = 10⁶, P branch",
        "a fault report",
        "collocation",
        walls(4, poiseuille(1e6, 1.0), -1, CLAMPED, 1, CLAMPED),
        lambda: [m for rows in (EVEN, ODD) for m in half_channel(1e6, rows, [-0.0035339 - 0.9964645j])()],
        refined=2,
    ),
    channel("Couette, R = 800", "textbook", couette(800.0, 1.0), [-0.12952206 - 0.5764738j, -0.12952206 + 0.5764738j], N=48, unstable=0),
    channel(
        "Poiseuille, R = 5772.22, near critical",
        "Orszag 1971",
        poiseuille(5772.22181620970, 1.02054744928533),
        [-1j * 1.0205474 * 0.2640003],
        scale=0.27,
    ),
    Stranger(
        "Squire modes of Couette flow",
        "textbook",
        "collocation",
        walls(2, squire, -1, [[1, 0]], 1, [[1, 0]]),
        collocated(
            2,
            squire,
            Fixed(-1, [[1, 0]]),
            Fixed(1, [[1, 0]]),
            [-0.12718249 + 0.78187852j, -0.2214305 - 0.61863618j, -0.36678798 - 0.36686964j],
            N=60,
        ),
    ),
    Stranger(
        "Bickley jet, R = 100, α = 0.8",
        "a fault report",
        "collocation",
        lambda: st.problem(4, bickley(100.0, 0.8), st.Infinity(), st.Infinity()),
        collocated(4, stretched(bickley(100.0, 0.8), 20.0), Far(-1.0, 2), Far(1.0, 2), [0.145 - 0.321j], N=80),
        region=st.Rectangle(0.01 - 0.7j, 0.3 + 0.05j),
        spurious=(0.05 - 0.1j,),
        unstable=None,
    ),
    Stranger(
        "mixing layer, R = 50, α = 0.4",
        "Betchov & Szewczyk 1963",
        "collocation",
        lambda: st.problem(4, mixing(50.0, 0.4), st.Infinity(), st.Infinity()),
        collocated(4, stretched(mixing(50.0, 0.4), 25.0), Far(-1.0, 2), Far(1.0, 2), [0.163], N=80),
        region=st.Rectangle(0.02 - 0.3j, 0.4 + 0.31j),
        spurious=(0.05 - 0.1j,),
    ),
    Stranger(
        "Rayleigh, tanh, α = 0.4446",
        "Michalke 1964",
        "collocation",
        lambda: st.problem(2, rayleigh_mixing(0.4446), st.Infinity(), st.Infinity(), continuum=lambda y: -0.4446j * np.tanh(y)),
        collocated(2, stretched(rayleigh_mixing(0.4446), 25.0, 0.5), Far(-1.0, 1), Far(1.0, 1), [0.1897], N=110),
        region=st.Rectangle(0.01 - 0.3j, 0.4 + 0.31j),
        spurious=(0.05, 0.3),
        on=(0.2j,),
    ),
    Stranger(
        "Rayleigh, sin y between walls ±π",
        "Drazin & Reid",
        "collocation",
        walls(2, sine_shear(0.5), -PI, [[1, 0]], PI, [[1, 0]], continuum=lambda y: -0.5j * np.sin(y)),
        collocated(2, sine_shear(0.5), Fixed(-PI, [[1, 0]]), Fixed(PI, [[1, 0]]), [0.19], cuts=(-2, -1, -0.4, 0, 0.4, 1, 2), N=24),
        region=st.Rectangle(0.02 - 0.3j, 0.6 + 0.31j),
        on=(0.2j, 0.45j),
    ),
    Stranger(
        "Rayleigh's broken-line layer, k = 0.4",
        "Rayleigh 1880",
        "exact",
        piecewise_shear(0.4),
        exactly(*[v for v in piecewise_modes(0.4) if v.real > 0]),
        region=st.Rectangle(0.02 - 0.3j, 0.6 + 0.31j),
    ),
    Stranger("two layers, Kelvin–Helmholtz", "textbook", "exact", layers(0.6, 1.0, 3.0), exactly(*layers_modes(0.6, 1.0, 3.0))),
    Stranger("two layers, waves only", "textbook", "exact", layers(0.3, 2.0, 1.0), exactly(*layers_modes(0.3, 2.0, 1.0))),
    film_stranger(),
    *(
        Stranger(
            f"Eady, μ = {mu:g}",
            "Eady 1949",
            "exact",
            eady(mu),
            eady_modes(mu),
            region=st.Rectangle(0.1 - 0.6j, 0.9 + 0.61j),
            skip=skip,
            refined=2,
            quick=mu == 1.6061,
        )
        for mu, skip in ((1.6061, ()), (2.39935728052, ("missing", "refine", "small")), (3.5, ()))
    ),
    Stranger(
        "Bénard, rigid, Ra = 1708",
        "a fault report",
        "collocation",
        walls(6, benard(1708.0, 3.117, 1.0), 0, RIGID, 1, RIGID),
        collocated(6, benard(1708.0, 3.117, 1.0), Fixed(0, RIGID), Fixed(1, RIGID), [0.0018125], N=24),
        scale=10.0,
        spurious=(5.0,),
        also=lambda p, modes: published(p, 0.001812557367638, 3e-14, 0.01),
    ),
    Stranger(
        "Bénard, free, Ra = 2000, Pr = 0.7",
        "Rayleigh 1916",
        "exact",
        walls(6, benard(2000.0, 2.2, 0.7), 0, FREE, 1, FREE),
        free_benard_modes(2000.0, 2.2, 0.7, 2),
        region=st.Rectangle(-57 - 8j, 30 + 8.1j),
        unstable=1,
        quick=True,
    ),
    Stranger(
        "Bénard, free, σ = 0 exactly",
        "a fault report",
        "exact",
        walls(6, benard((PI**2 + 5.0) ** 3 / 5.0, math.sqrt(5.0), 1.0), 0, FREE, 1, FREE),
        lambda: [(0j, 1e-13), (complex(-2 * (PI**2 + 5.0)), 1e-13)],
        scale=10.0,
    ),
    Stranger(
        "rotating plane Couette flow",
        "Bénard's equivalence",
        "collocation",
        walls(6, ROTATING, -1, RIGID, 1, RIGID),
        collocated(6, ROTATING, Fixed(-1, RIGID), Fixed(1, RIGID), [0.2], N=28),
    ),
    stratified_stranger(0.1, 0.45, 0.12),
]


def published(problem: Any, value: float, sure: float, guess: float) -> Any:
    """The published digits, from a guess that is not near."""
    m = st.refine(problem, guess)
    off = abs(complex(m.sigma) - value)
    kind = "lost" if not m.converged else "right" if off <= m.error + sure else "WRONG"
    yield "published value", kind, f"{m.sigma} ± {m.error}, published {value}: {m.status}"


__all__ = ["STRANGERS", "ElementJoint", "jumps"]
