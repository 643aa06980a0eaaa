"""Strangers on the whole line and the half-line: fronts, pulses, solitons, wells, with and without advection."""

from __future__ import annotations

import math
from typing import Any

import mpmath
import numpy as np
from collocation import stretched
from stranger import Far, Stranger, collocated, exactly, line, second_order

import shootstab as st

ROOT2 = math.sqrt(2.0)  # exact


def sech(x: Any) -> Any:
    """1/cosh x, without overflow, analytic on either side of 0."""
    y = -x if complex(x).real < 0 else x
    e = np.exp(-y)
    return 2 * e / (1 + e * e)


def advected(c: float, V: float, a: float) -> Any:
    """v″ + c v′ + (V sech²x − a) v = σ v: (ν − k)² − a − c²/4 with ν(ν + 1) = V."""
    return lambda x: second_order(a - V * sech(x) ** 2, -c)


def advected_modes(c: float, V: float, a: float) -> list[complex]:
    nu = (math.sqrt(1 + 4 * V) - 1) / 2
    return [(nu - k) ** 2 - a - c * c / 4 for k in range(math.ceil(nu)) if nu - k > abs(c) / 2]


def nagumo(a: float) -> Any:
    """u_t = u″ + u(1 − u)(u − a) about its front (1 + tanh(x/2√2))/2, in the frame of speed c = √2(a − ½)."""

    def pencil(x: Any) -> Any:
        u = (1 + np.tanh(x / (2 * ROOT2))) / 2
        slope = -3 * u * u + 2 * (1 + a) * u - a
        return second_order(-slope, -ROOT2 * (0.5 - a))

    return pencil


def kdv(c: float = 1.0, p: int = 1) -> Any:
    """v_t = c v_x − ((p + 1) u^p v)_x − v_xxx of u_t + (u^{p+1})_x + u_xxx = 0 about u^p = ((p + 2)c/2) sech²(p√c x/2)."""

    def pencil(x: Any) -> Any:
        k = p * math.sqrt(c) / 2
        q = (p + 1) * (p + 2) * c / 2 * sech(k * x) ** 2
        slope = -2 * k * np.tanh(k * x) * q
        return np.array([[0, 1, 0], [0, 0, 1], [-slope, c - q, 0]]), np.array([[0, 0, 0], [0, 0, 0], [-1, 0, 0]])

    return pencil


def nls(x: Any) -> Any:
    """Cubic NLS about √2 sech x: v_t = L₋w, w_t = −L₊v, with L₊ = −∂² + 1 − 6 sech², L₋ = −∂² + 1 − 2 sech²."""
    s = sech(x) ** 2
    D0, D1 = np.zeros((4, 4), dtype=type(s * 1j)), np.zeros((4, 4))
    D0[0, 1] = D0[2, 3] = 1
    D0[1, 0], D0[3, 2] = 1 - 6 * s, 1 - 2 * s
    D1[1, 2], D1[3, 0] = 1, -1
    return D0, D1


def quintic(p: int) -> Any:
    """NLS of power 2p + 1 about its soliton (p + 1)^{1/2p} sech^{1/p}(p x): unstable for p > 2."""

    def pencil(x: Any) -> Any:
        s = (p + 1) * sech(p * x) ** 2
        D0, D1 = np.zeros((4, 4), dtype=type(s * 1j)), np.zeros((4, 4))
        D0[0, 1] = D0[2, 3] = 1
        D0[1, 0], D0[3, 2] = 1 - (2 * p + 1) * s, 1 - s
        D1[1, 2], D1[3, 0] = 1, -1
        return D0, D1

    return pencil


def burgers(x: Any) -> Any:
    """v_t = v″ + (tanh(x/2) v)′ about the shock u = −tanh(x/2)."""
    return second_order(-0.5 * sech(x / 2) ** 2, -np.tanh(x / 2))


def morse_modes(depth: float) -> list[complex]:
    """−y″ + depth(e^{−2x} − 2e^{−x}) y = −σ y: (√depth − n − ½)²."""
    return [(math.sqrt(depth) - n - 0.5) ** 2 for n in range(int(math.sqrt(depth) + 0.5))]


def morse(depth: float) -> Any:
    return lambda x: second_order(depth * (np.exp(-2 * x) - 2 * np.exp(-x)), 0)


def davies(x: Any) -> Any:
    """−y″ + i x² y = σ y."""
    return second_order(1j * x * x, 0, -1)


def davies_modes(*n: int) -> list[complex]:
    return [(2 * k + 1) * complex(math.sqrt(0.5), math.sqrt(0.5)) for k in n]


def airy_zeros(count: int) -> list[tuple[complex, float]]:
    """−y″ + i x y = σ y on x > 0, y(0) = 0: σ = −a_n e^{iπ/3}, with the zeros a_n of Ai."""
    with mpmath.workdps(30):
        return [(complex(-mpmath.airyaizero(n) * mpmath.expjpi(mpmath.mpf(1) / 3)), 1e-16) for n in range(1, count + 1)]


def scarf(A: float, B: complex) -> Any:
    """Scarf II: −y″ + [(B² − A(A + 1)) sech² + B(2A + 1) sech tanh] y = −σ y, σ = (A − n)²; PT-symmetric for imaginary B."""

    def pencil(x: Any) -> Any:
        s = sech(x)
        return second_order((B * B - A * (A + 1)) * s * s + B * (2 * A + 1) * s * np.tanh(x), 0)

    return pencil


def step_down(x: Any) -> Any:
    """Rosen–Morse: −y″ − 12 sech² y + 2 tanh x·y = −σ y, σ_n = (3 − n)² + 1/(3 − n)² while 1 < (3 − n)²."""
    return second_order(-12 * sech(x) ** 2 + 2 * np.tanh(x), 0)


def tiny(scale: float) -> Any:
    """Pöschl–Teller with ν = 2 in other units: σ = scale·4, scale·1."""
    return lambda x: second_order(-6 * sech(x) ** 2, 0, 1 / scale)


def bessel_in_logarithms(m: int) -> Any:
    """r²y″ + ry′ = (m² + σr²)y in s = ln r, y bounded at −∞: σ = −j²_{m,n}."""
    return lambda s: second_order(m * m, 0, np.exp(2 * s))


def bessel_zeros(m: int, count: int) -> list[tuple[complex, float]]:
    with mpmath.workdps(30):
        return [(complex(-(mpmath.besseljzero(m, n) ** 2)), 3e-16 * float(mpmath.besseljzero(m, n) ** 2)) for n in range(1, count + 1)]


def mixed_axis(s: Any) -> Any:
    """The axisymmetric case, m = 0, of (y, ry′), mixed by T = [[1, 2], [3, 7]]: both rates at −∞ are 0, any gap is rounding."""
    T = np.array([[1.0, 2], [3, 7]])
    back = np.array([[7.0, -2], [-3, 1]])
    return tuple(T @ M @ back for M in (np.array([[0, 1], [0, 0]]), np.array([[0, 0], [np.exp(2 * s), 0]])))


def refused_or_right(make: Any, truth: complex) -> Any:
    """No answer beyond its bound: a refusal in words is right."""
    try:
        m = st.refine(make(), truth * 1.01)
    except st.InputError as error:
        yield "refused", "right", str(error)
        return
    off = abs(complex(m.sigma) - truth)
    good = not m.converged or off <= m.error + 1e-14
    yield "refine", "right" if good else "WRONG", f"{m.sigma} ± {m.error}, truth {truth}: {m.status}"


def gkdv_modes() -> Any:
    return collocated(3, stretched(kdv(1.0, 6), 20.0, 0.25), Far(-1.0, 2), Far(1.0, 1), [1.680634], N=130)


STRANGERS = [
    Stranger(
        "advection 0.3, sech² well",
        "a fault report",
        "exact",
        line(2, advected(0.3, 1.5, 0.5)),
        exactly(*advected_modes(0.3, 1.5, 0.5)),
        region=st.Rectangle(0.01 - 1j, 1 + 1j),
        spurious=(0.5 + 0.1j,),
        quick=True,
    ),
    Stranger(
        "advection 1e-3, sech² well",
        "the kind of A1",
        "exact",
        line(2, advected(1e-3, 6.0, 3.0)),
        exactly(*advected_modes(1e-3, 6.0, 3.0)),
        region=st.Rectangle(-2.5 - 1j, 2 + 1.1j),
    ),
    Stranger(
        "advection −2, sech² well, three modes",
        "the kind of A1",
        "exact",
        line(2, advected(-1.6, 20.0, 2.0)),
        exactly(*advected_modes(-1.6, 20.0, 2.0)),
        region=st.Rectangle(-1.8 - 1j, 16 + 1.1j),
    ),
    Stranger(
        "Nagumo front, a = 1/2",
        "Evans-function textbook",
        "exact",
        line(2, nagumo(0.5)),
        lambda: [(0j, 1e-17), (-0.375 + 0j, 1e-17)],
        region=st.Rectangle(-0.48 - 0.3j, 0.5 + 0.31j),
        spurious=(0.2 + 0.05j, -0.2),
        scale=0.375,
    ),
    Stranger(
        "Nagumo front, a = 0.45, advected",
        "Rosen–Morse, −3/8 + (3/2)(½ − a)²",
        "exact",
        line(2, nagumo(0.45)),
        lambda: [(0j, 1e-16), (-0.375 + 1.5 * 0.05**2 + 0j, 1e-16)],
        region=st.Rectangle(-0.43 - 0.3j, 0.5 + 0.31j),
        scale=0.375,
    ),
    Stranger(
        "Allen–Cahn kink",
        "a fault report",
        "exact",
        line(2, lambda x: second_order(-(1 - 3 * np.tanh(x / ROOT2) ** 2), 0)),
        lambda: [(0j, 1e-16), (-1.5 + 0j, 1e-16)],
        region=st.Rectangle(-1.9 - 0.5j, 0.5 + 0.6j),
        scale=1.5,
    ),
    Stranger(
        "sine-Gordon kink, second order",
        "textbook",
        "exact",
        line(2, lambda x: second_order(1 - 2 * sech(x) ** 2, 0)),
        lambda: [(0j, 1e-16)],
        region=st.Rectangle(-0.9 - 0.5j, 0.5 + 0.6j),
        scale=1.0,
    ),
    Stranger(
        "Burgers shock",
        "a fault report",
        "exact",
        line(2, burgers),
        list,
        region=st.Rectangle(0.01 - 1j, 2 + 1.1j),
        spurious=(0.5, 0.3 + 0.4j),
        on=(0j,),
    ),
    Stranger(
        "KdV soliton",
        "a fault report",
        "exact",
        line(3, kdv()),
        list,
        region=st.Rectangle(0.01 - 1j, 2 + 1.1j),
        spurious=(0.5, 0.3 + 0.4j),
        on=(0j, 1e-7j, 5e-6j, 1e-5j, 0.3j),
    ),
    Stranger(
        "gKdV soliton, p = 6",
        "Pego & Weinstein 1992",
        "collocation",
        line(3, kdv(1.0, 6)),
        gkdv_modes(),
        region=st.Rectangle(0.05 - 2j, 3 + 2.1j),
        spurious=(1.2,),
    ),
    Stranger(
        "NLS soliton, 4-fold zero",
        "a fault report",
        "exact",
        line(4, nls),
        lambda: [(0j, 1e-16)] * 4,
        region=st.Rectangle(-0.5 - 0.6j, 0.55 + 0.62j),
        scale=1.0,
        skip=("missing",),
    ),
    Stranger(
        "NLS soliton, power 7",
        "Grillakis, Shatah & Strauss",
        "collocation",
        line(4, quintic(3)),
        collocated(4, stretched(quintic(3), 30.0, 0.25), Far(-1.0, 2), Far(1.0, 2), [2.905], N=110),
        spurious=(0.5 + 0.5j,),
        region=st.Rectangle(0.3 - 0.6j, 5 + 0.62j),
    ),
    Stranger(
        "Pöschl–Teller ν = 0.2, next to its continuum",
        "CompoundMatrixMethod issue",
        "exact",
        line(2, lambda x: second_order(-0.24 * sech(x) ** 2, 0)),
        exactly(0.04),
        region=st.Rectangle(1e-3 - 0.05j, 0.3 + 0.06j),
        spurious=(0.0387, 0.09),
        on=(-0.04,),
    ),
    Stranger(
        "Pöschl–Teller ν = 3.5",
        "textbook",
        "exact",
        line(2, lambda x: second_order(-15.75 * sech(x) ** 2, 0)),
        exactly(12.25, 6.25, 2.25, 0.25),
        region=st.Rectangle(0.1 - 1j, 15 + 1.1j),
    ),
    *(
        Stranger(
            f"Pöschl–Teller ν = 2 about x = {at:g}",
            "a well that is not at the origin",
            "exact",
            line(2, lambda x, at=at: second_order(-6 * sech(x - at) ** 2, 0)),
            exactly(4, 1),
            region=st.Rectangle(0.5 - 1j, 5 + 1.1j),
        )
        for at in (10.0, 40.0, -200.0)
    ),
    Stranger(
        "half-line, well far from the wall",
        "a well that is not at the origin",
        "exact",
        lambda: st.problem(2, lambda x: second_order(-6 * sech(x - 40) ** 2, 0), st.Wall(0, [[1, 0]]), st.Infinity()),
        exactly(4, 1),
        region=st.Rectangle(0.5 - 1j, 5 + 1.1j),
    ),
    Stranger(
        "two wells, 20 apart",
        "tunnelling pairs on the line",
        "exact",
        line(2, lambda x: second_order(-6 * sech(x - 10) ** 2 - 6 * sech(x + 10) ** 2, 0)),
        lambda: [(4 + 0j, 1e-9), (4 + 0j, 1e-9), (1 + 0j, 1e-6), (1 + 0j, 1e-6)],
        region=st.Rectangle(0.5 - 1j, 5 + 1.1j),
        digits=5,
    ),
    Stranger(
        "Bessel, m = 2, in ln r",
        "a fault report",
        "exact",
        lambda: st.problem(2, bessel_in_logarithms(2), st.Infinity(), st.Wall(0.0, [[1, 0]])),
        lambda: bessel_zeros(2, 3),
        region=st.Rectangle(-140 - 5j, -20 + 5.1j),
    ),
    Stranger(
        "Bessel, m = 0, in ln r, a gap that is rounding",
        "a fault report",
        "exact",
        line(2, lambda x: second_order(-6 * sech(x) ** 2, 0)),
        list,
        also=lambda p, modes: refused_or_right(
            lambda: st.problem(2, mixed_axis, st.Infinity(), st.Wall(0.0, [[7, -2]])), -5.783185962946784521176
        ),
    ),
    Stranger(
        "Rosen–Morse step",
        "textbook",
        "exact",
        line(2, step_down),
        exactly(9 + 1 / 9, 4 + 1 / 4),
        region=st.Rectangle(2.5 - 1j, 12 + 1.1j),
    ),
    Stranger(
        "Scarf II, PT-symmetric",
        "Ahmed 2001",
        "exact",
        line(2, scarf(2.3, 0.9j)),
        exactly(2.3**2, 1.3**2, 0.3**2, (0.9 - 0.5) ** 2),
        region=st.Rectangle(0.03 - 1j, 7 + 1.1j),
    ),
    Stranger(
        "Morse, depth 30",
        "textbook",
        "exact",
        lambda: st.problem(2, morse(30.0), st.Infinity(start=4.0), st.Infinity()),
        exactly(*morse_modes(30.0)),
        region=st.Rectangle(0.1 - 1j, 30 + 1.1j),
    ),
    Stranger(
        "Davies, whole line, n = 0…4",
        "Davies 1999",
        "exact",
        lambda: st.problem(2, davies, st.Infinity(start=9.0), st.Infinity(start=9.0)),
        exactly(*davies_modes(0, 1, 2, 3, 4)),
        region=st.Rectangle(0.1 + 0.1j, 7 + 7.1j),
    ),
    Stranger(
        "complex Airy, half-line",
        "textbook",
        "exact",
        lambda: st.problem(2, lambda x: second_order(1j * x, 0, -1), st.Wall(0, [[1, 0]]), st.Infinity(start=40.0)),
        lambda: airy_zeros(4),
        region=st.Rectangle(0.5 + 1j, 3.6 + 6.2j),
    ),
    *(
        Stranger(
            f"Pöschl–Teller ν = 2 in units of {scale:g}",
            "tiny and huge scales",
            "exact",
            line(2, tiny(scale)),
            exactly(4 * scale, scale),
            region=st.Rectangle((0.2 - 1j) * scale, (6 + 1.1j) * scale),
            unstable=None,
        )
        for scale in (1e-12, 1e-6, 1e6, 1e12)
    ),
]
