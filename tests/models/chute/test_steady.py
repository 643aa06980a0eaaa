"""The steady flow against its equations, against an independent collocation, and against a 30-digit Taylor integration."""

from __future__ import annotations

import math
from functools import cache
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from linearization import evaluator

from shootstab.core.errors import ConvergenceError, InputError, NoFlowError
from shootstab.core.series import Series
from shootstab.kernels import taylor_pieces
from shootstab.models.chute import descent
from shootstab.models.chute.balance import slopes
from shootstab.models.chute.constitutive import radial, slip_coefficient
from shootstab.models.chute.family import BRANCHES, flows, steady_by_flux, with_base_flow_error
from shootstab.models.chute.parameters import Chute
from shootstab.models.chute.steady_flow import NU_TOP, Flow, descend

PAPER = Chute(e=0.8, e_w=0.8, r=0.6, tan_theta=0.3)
NEARLY_ELASTIC = Chute(e=0.95, e_w=0.8, r=0.6, tan_theta=0.2)
SMOOTHER = Chute(e=0.8, e_w=0.5, r=0.3, tan_theta=0.2)
CARNAHAN_STARLING = Chute(e=0.8, e_w=0.8, r=0.6, tan_theta=0.3, radial="carnahan-starling")
LOOSER = Chute(e=0.8, e_w=0.8, r=0.6, tan_theta=0.3, nu_max=0.5)
CASES = [
    (PAPER, 7.338568375902416), (PAPER, 2.54), (PAPER, 0.2), (PAPER, 0.03), (PAPER, 20.0), (PAPER, 60.0), (PAPER, 1000.0),
    (NEARLY_ELASTIC, 0.2), (NEARLY_ELASTIC, 2.0), (NEARLY_ELASTIC, 60.0), (SMOOTHER, 3.0), (CARNAHAN_STARLING, 0.2),
    (CARNAHAN_STARLING, 20.0), (LOOSER, 1.0),
]  # fmt: skip


def name_of(value):
    return f"{value:g}" if isinstance(value, float) else f"e{value.e}-r{value.r}-{value.radial}-{value.nu_max}"


@cache
def flow_of(chute: Chute, far_temperature: float) -> Flow:
    return descend(chute, far_temperature)


cases = pytest.mark.parametrize(("chute", "far_temperature"), CASES, ids=name_of)


class SteadyFields:
    """ν, T, u, q and p, η, γ at real heights, from the flow's states and the table of guide/theory.md 1.1."""

    def __init__(self, flow: Flow, z):
        states = flow.states_at(z)
        assert not states.imag.any()
        states = states.real
        self.nu, self.T, self.u = np.exp(states[..., 0]), states[..., 1], states[..., 2]
        self.Q = states[..., 3]
        self.q = self.nu * self.Q
        names = ("g1", "g2", "g3", "g4", "g5", "A")
        g1, g2, g3, g4, g5, self.A = evaluator(flow.chute.radial, names, 0, "numpy")(self.nu, flow.chute.ep, flow.chute.nu_max)
        self.p, self.eta, self.gamma = g1 * self.T, g2 * self.T**0.5, g5 * self.T**1.5
        self.K, self.K_star = g3 * self.T**0.5, g4 * self.T**1.5


def panels(flow: Flow, steps: int) -> np.ndarray:
    """Ascending heights from the base to the top, so many pieces of the flow apart: close where the flow is steep."""
    ends = np.append(flow.nodes[::-1][:-1:steps], flow.nodes[0])
    return ends[np.append(True, np.diff(ends) > 0)]


# ------------------------------------------------------------------------------------------------ Chebyshev
def chebyshev(n: int, a: float, b: float) -> tuple[np.ndarray, np.ndarray]:
    """n + 1 points in [a, b], ascending, and the differentiation matrix there."""
    k = np.arange(n + 1)
    x = -np.cos(np.pi * k / n)
    c = np.where((k == 0) | (k == n), 2.0, 1.0) * (-1.0) ** k
    # differences by sines: exact to rounding next to the ends
    gaps = 2 * np.sin(np.add.outer(k, k) * np.pi / (2 * n)) * np.sin(np.subtract.outer(k, k) * np.pi / (2 * n))
    D = np.outer(c, 1 / c) / (gaps + np.eye(n + 1))
    D -= np.diag(D.sum(axis=1))
    return a + (b - a) * (x + 1) / 2, 2 / (b - a) * D


@cases
def test_residual_of_the_steady_equations(chute, far_temperature):
    """p′ = −ν, u′ = tanθ p/η, q′ = tanθ² p²/η − γ, q = −K T′ + K* ν′, by differentiating the flow itself on panels."""
    flow = flow_of(chute, far_temperature)
    for a, b in pairwise(panels(flow, 6)):
        z, D = chebyshev(20, a, b)
        f = SteadyFields(flow, z)
        # what errors of one unit in the last place of ln ν and of z do to D f
        rounding = 2.3e-16 * (2 + np.abs(np.log(f.nu)).max() + b / far_temperature) * np.abs(D).sum(axis=1)
        shear = chute.tan_theta * f.p / f.eta
        source = chute.tan_theta**2 * f.p**2 / f.eta - f.gamma
        for derivative, right, size in (
            (D @ f.p, -f.nu, f.p.max()),
            (D @ f.u, shear, f.u.max()),
            (D @ f.q, source, np.abs(f.q).max() + f.p.max() * f.T.max() ** 0.5),
            (-f.K * (D @ f.T) + f.K_star * (D @ f.nu), f.q, np.abs(f.K * f.T).max()),
        ):
            assert np.all(np.abs(derivative - right) <= 1e-13 * np.abs(right).max() + 2 * rounding * size)


@cases
def test_base_conditions(chute, far_temperature):
    f = SteadyFields(flow_of(chute, far_temperature), 0.0)
    s = math.sqrt(1 - chute.r**2)
    kappa, delta = 2 / 3 * (2 / (1 + s) - s), math.sqrt(2 / math.pi) * 2 * (1 - chute.e_w) / (1 + s)
    u_z = chute.tan_theta * f.p / f.eta
    slip = math.sqrt(2 / (math.pi * f.T)) * (kappa * f.u - (kappa - f.A * chute.r**2 / 2) * u_z)
    assert slip == pytest.approx(chute.tan_theta, rel=1e-12, abs=0.0)
    gain, loss = chute.tan_theta * f.p * f.u, delta * f.p * f.T**0.5
    assert abs(f.q - gain + loss) <= 1e-12 * (gain + loss)


@cases
def test_decay_at_infinity(chute, far_temperature):
    """T → T_∞ (1 + (g4/g3) ν), q = −(tanθ²/g2 − g5/ν²) T_∞^{5/2} ν²/2, ν → e^{−z/T_∞}; the same below and above the top node."""
    flow = flow_of(chute, far_temperature)
    top = flow.nodes[0]
    assert math.exp(flow.states[0, 0].real) == pytest.approx(NU_TOP, rel=1e-13, abs=0.0)
    g2, g3, g4, g5 = evaluator(chute.radial, ("g2", "g3", "g4", "g5"), 0, "mpmath")(
        mpmath.mpf("1e-60"), mpmath.mpf(chute.ep), mpmath.mpf(chute.nu_max)
    )
    g2, g3, g4, f5 = float(g2), float(g3), float(g4), float(g5 * mpmath.mpf("1e120"))
    for z in top - far_temperature * np.array([10.0, 3.0, 0.0, -1e-9, -2.0, -300.0]):
        y = flow.states_at(z).real
        nu = math.exp(y[0])
        assert y[0] == pytest.approx(math.log(NU_TOP) - (z - top) / far_temperature, abs=1e-11)
        assert y[1] == pytest.approx(far_temperature * (1 + g4 / g3 * nu), rel=1e-13, abs=0.0)
        assert y[2] == pytest.approx(flow.far_velocity - chute.tan_theta / g2 * far_temperature**1.5 * nu, rel=1e-13, abs=0.0)
        if z < top:
            assert y[3] == pytest.approx(
                -(chute.tan_theta**2 / g2 - f5) * far_temperature**2.5 * nu / 2, rel=1e-6 + 1e3 * nu * far_temperature**2, abs=0.0
            )
        assert y[4] == pytest.approx(nu * far_temperature**2, rel=1e-11, abs=0.0)
        mean = flow.far_velocity - chute.tan_theta / g2 * far_temperature**1.5 * nu / 2
        assert y[5] == pytest.approx(nu * far_temperature * mean, rel=1e-11, abs=0.0)


# ------------------------------------------------------------------------------------------------ the integrals of (2.8)
@cases
def test_integrals_by_quadrature(chute, far_temperature):
    """M0, Q0 and h0 of (2.8) by Gauss quadrature; M0 = p(0) because p′ = −ν."""
    flow = flow_of(chute, far_temperature)
    x, w = np.polynomial.legendre.leggauss(20)
    edges = panels(flow, 10)
    z = (edges[:-1, None] + edges[1:, None]) / 2 + np.diff(edges)[:, None] / 2 * x
    weights = np.diff(edges)[:, None] / 2 * w
    f = SteadyFields(flow, z)
    M0, Q0, moment = (float((weights * g).sum()) for g in (f.nu, f.nu * f.u, f.nu * z))
    assert flow.hold_up == pytest.approx(M0, rel=2e-12, abs=0.0)
    assert flow.mass_flux == pytest.approx(Q0, rel=2e-12, abs=0.0)
    assert flow.centre_of_mass == pytest.approx(moment / M0, rel=2e-12, abs=0.0)
    base = SteadyFields(flow, 0.0)
    assert flow.hold_up == pytest.approx(float(base.p), rel=1e-14, abs=0.0)
    assert flow.base == {"nu": pytest.approx(base.nu, rel=1e-14, abs=0.0), "T": base.T, "u": base.u}


# ------------------------------------------------------------------------------------------------ independent collocation
def collocate(flow: Flow, heights: np.ndarray, orders: list[int], top_order: int) -> list[dict[str, np.ndarray]]:
    """The steady flow by Newton on collocated equations, on panels in z between heights, and above in ζ = exp(−(z − z1)/T_∞) ∈ [0, 1].

    Unknowns at each node: w, T, u, Q with ν = w below and ν = ζw above, q = νQ. With c = 1, ω = 1 below and c = −T_∞, ω = ζ above:
    (ω w f1 T)′ + c w = 0,  u′ − c tanθ p/(ωη) = 0,  (ω w Q)′ − c (tanθ² p²/η − γ)/ω = 0,  c w Q + K T′ − K* (ω w)′ = 0.
    ζ = 0 is infinity itself; there the first and the third equation are T = T_∞ and Q = 0. The start is the flow, spoilt by a few
    per cent, so that what converges is this system's own solution.
    """
    chute, T_inf = flow.chute, flow.far_temperature
    panels = [(*chebyshev(n, a, b), 1.0, False) for n, a, b in zip(orders, heights[:-1], heights[1:], strict=True)]
    s, D = chebyshev(top_order, 0.0, 1.0)
    panels.append((s[::-1], D[::-1, ::-1], -T_inf, True))  # node 0 of every panel is its lower end

    def laws(nu):
        names = ("g1", "g2", "g3", "g4", "g5", "A")
        safe = np.where(nu == 0, 1e-100, nu)
        g1, g2, g3, g4, g5, A = evaluator(chute.radial, names, 0, "numpy")(safe, chute.ep, chute.nu_max)
        return g1 / safe, g2, g3, g4, g5 / safe**2, A

    def pointwise(y, omega):
        """For y (4, n): what is differentiated, (4, 3, n) → F1, F3, ωw with T and u, and what is not."""
        w, T, _, Q = y
        f1, g2, g3, g4, f5, _ = laws(omega * w)
        shear = chute.tan_theta * w * f1 * T**0.5 / g2
        heat = omega * w**2 * T**1.5 * (chute.tan_theta**2 * f1**2 / g2 - f5)
        return np.array([omega * w * f1 * T, omega * w * Q, omega * w]), np.array([w, shear, heat, w * Q, g3 * T**0.5, g4 * T**1.5])

    def residual_and_jacobian(y, panel):
        s, D, c, above = panel
        omega, n = (s if above else np.ones_like(s)), len(s)

        def assemble(F, G, DF, DT, Du):
            return [DF[0] + c * G[0], Du - c * G[1], DF[1] - c * G[2], c * G[3] + G[4] * DT - G[5] * DF[2]]

        F, G = pointwise(y, omega)
        R = assemble(F, G, F @ D.T, D @ y[1], D @ y[2])
        J = np.zeros((4, n, 4, n))
        DT, DF2 = D @ y[1], D @ F[2]
        for v in range(4):
            moved = y.astype(complex)
            moved[v] += 1e-40j
            dF, dG = (a.imag / 1e-40 for a in pointwise(moved, omega))
            J[0, :, v] = D * dF[0] + np.diag(c * dG[0])
            J[1, :, v] = D * (v == 2) - np.diag(c * dG[1])
            J[2, :, v] = D * dF[1] - np.diag(c * dG[2])
            J[3, :, v] = np.diag(c * dG[3] + dG[4] * DT - dG[5] * DF2) + G[4][:, None] * D * (v == 1) - G[5][:, None] * D * dF[2]
        return np.array(R), J

    def base(y0):
        """Slip and energy at the base; A 14, A 18."""
        w, T, u, Q = y0
        f1, g2, _, _, _, A = laws(w)
        r, s = chute.r, math.sqrt(1 - chute.r**2)
        kappa = 2 / 3 * (2 / (1 + s) - s)
        delta = math.sqrt(2 / math.pi) * 2 * (1 - chute.e_w) / (1 + s)
        u_z = chute.tan_theta * w * f1 * T**0.5 / g2
        slip = math.sqrt(2 / math.pi) * (kappa * u - (kappa - A * r * r / 2) * u_z) - chute.tan_theta * T**0.5
        return np.array([slip, Q - f1 * T * (chute.tan_theta * u - delta * T**0.5)])

    ys = []
    for s, _, _, above in panels:
        zeta = np.maximum(s, 1e-12) if above else np.ones_like(s)
        z = heights[-1] - T_inf * np.log(zeta) if above else s
        f = SteadyFields(flow, z)
        wave = np.sin(3 * z / (T_inf + z))
        ys.append(np.array([f.nu / zeta * (1 + 0.03 * wave), f.T * (1 - 0.03 * wave), f.u * (1 + 0.05 * wave), f.Q + 0.02 * wave * f.T]))

    sizes = [4 * len(panel[0]) for panel in panels]
    starts = np.concatenate(([0], np.cumsum(sizes)))
    for _ in range(25):
        rows, values = [], []
        for k, (panel, y) in enumerate(zip(panels, ys, strict=True)):
            R, J = residual_and_jacobian(y, panel)
            n = y.shape[1]
            J = J.reshape(4, n, 4 * n)
            for equation in range(4):
                # one row of each gives way to a condition, but for the two that are singular at infinity
                kept = slice(None) if panel[3] and equation in (0, 2) else slice(1, None)
                block = np.zeros((len(R[equation][kept]), starts[-1]))
                block[:, starts[k] : starts[k + 1]] = J[equation][kept]
                rows.append(block)
                values.append(R[equation][kept])
            if k > 0:
                block = np.zeros((4, starts[-1]))
                last = ys[k - 1].shape[1]
                for v in range(4):
                    block[v, starts[k] + v * n] = 1.0
                    block[v, starts[k - 1] + v * last + last - 1] = -1.0
                rows.append(block)
                values.append(y[:, 0] - ys[k - 1][:, -1])
        block = np.zeros((2, starts[-1]))
        for v in range(4):
            moved = ys[0][:, 0].astype(complex)
            moved[v] += 1e-40j
            block[:, v * ys[0].shape[1]] = base(moved).imag / 1e-40
        rows.append(block)
        values.append(base(ys[0][:, 0]))
        A, b = np.concatenate(rows), np.concatenate(values)
        assert A.shape == (starts[-1], starts[-1])
        row_scale = 1 / np.abs(A).max(axis=1)
        step = np.linalg.solve(A * row_scale[:, None], -b * row_scale)
        for k, y in enumerate(ys):
            y += step[starts[k] : starts[k + 1]].reshape(y.shape)
        # Q at infinity is known to rounding over ζ only: it follows the others
        moves = [np.abs(step[a:b].reshape(y.shape)[:3] / y[:3]).max() for a, b, y in zip(starts[:-1], starts[1:], ys, strict=True)]
        if max(moves) < 1e-8:  # quadratic: what is left is rounding
            break
    else:
        raise AssertionError(f"Newton did not converge: last step {max(moves):.1e}")

    solution = []
    for (s, _, _, above), y in zip(panels, ys, strict=True):
        omega = s if above else np.ones_like(s)
        with np.errstate(divide="ignore"):
            z = heights[-1] - T_inf * np.log(s) if above else s
        solution.append({"z": z, "nu": omega * y[0], "T": y[1], "u": y[2], "Q": y[3]})
    return solution


@pytest.mark.parametrize(
    ("chute", "far_temperature", "heights"),
    [
        (PAPER, 7.338568375902416, [0.0, 0.5, 1.5]),
        (PAPER, 0.2, [0.0, 0.1, 0.3, 0.8, 1.6, 2.4, 3.2, 4.0, 4.6]),
        (NEARLY_ELASTIC, 2.0, [0.0, 2.0, 4.0, 7.0, 11.0, 15.0, 19.0, 23.0, 27.0]),
    ],
    ids=["high", "dense", "nearly elastic"],
)
def test_independent_collocation(chute, far_temperature, heights):
    flow = flow_of(chute, far_temperature)
    solution = collocate(flow, np.array(heights), [24] * (len(heights) - 1), 30)
    for panel in solution:
        finite = np.isfinite(panel["z"])
        f = SteadyFields(flow, panel["z"][finite])
        for name in ("nu", "T", "u"):
            assert np.all(np.abs(getattr(f, name) / panel[name][finite] - 1) <= 1e-11), name
        q = panel["nu"][finite] * panel["Q"][finite]
        assert np.all(np.abs(f.q - q) <= 1e-11 * np.abs(f.q).max())
    infinity = solution[-1]
    assert infinity["T"][-1] == pytest.approx(far_temperature, rel=1e-12, abs=0.0)
    assert infinity["u"][-1] == pytest.approx(flow.far_velocity, rel=1e-11, abs=0.0)
    assert infinity["nu"][-1] == 0.0


# ------------------------------------------------------------------------------------------------ 30 digits
def precise_slopes(chute, y):
    """(ν′, T′, u′, q′) for series of mpmath numbers, from the table: ν′, T′ solve p_ν ν′ + p_T T′ = −ν, K* ν′ − K T′ = q."""
    nu, T, _, q = y
    law = evaluator(chute.radial, ("g1", "g2", "g3", "g4", "g5"), 0, "mpmath")
    dual = Series((nu, 1 + 0 * nu))
    ep, nu_max, tan = (mpmath.mpf(x) for x in (chute.ep, chute.nu_max, chute.tan_theta))
    g1, g2, g3, g4, g5 = law(nu, ep, nu_max)
    dg1 = evaluator(chute.radial, ("g1",), 0, "mpmath")(dual, ep, nu_max)[0][1]
    root = T ** mpmath.mpf("0.5")
    det = -(dg1 * g3 + g1 * g4) * T * root
    nu_z, T_z = (nu * g3 * root - g1 * q) / det, (dg1 * T * q + nu * g4 * T * root) / det
    p = g1 * T
    return nu_z, T_z, tan * p / (g2 * root), tan**2 * p**2 / (g2 * root) - g5 * T * root


def taylor_step(chute, y, terms):
    """The Taylor coefficients in z of the solution through y."""
    series = [Series((value,)) for value in y]
    for m in range(1, terms):
        slopes_ = precise_slopes(chute, series)
        series = [Series((*s.coefficients, d[m - 1] / m)) for s, d in zip(series, slopes_, strict=True)]
    return series


def horner(series, h):
    total = mpmath.mpf(0)
    for c in reversed(series.coefficients):
        total = total * h + c
    return total


def precise_flow(chute, far_temperature, terms=16):
    """Pieces (z, length, Taylor series of ν, T, u, q), z = 0 at the base, and far velocity; from ν = 1e−9 down."""
    mpf = mpmath.mpf
    T_inf, ep, nu_max, tan = (mpf(x) for x in (far_temperature, chute.ep, chute.nu_max, chute.tan_theta))
    g2, g3, g4, g5 = evaluator(chute.radial, ("g2", "g3", "g4", "g5"), 0, "mpmath")(mpf("1e-60"), ep, nu_max)
    nu = mpf("1e-9")
    y = [nu, T_inf * (1 + g4 / g3 * nu), mpf(0), -(tan**2 / g2 - g5 * mpf("1e120")) * T_inf ** mpf("2.5") * nu**2 / 2]
    # u counts from the start: u(start) − u_∞ to second order is beyond 1e−17
    y[2] = -tan / g2 * T_inf ** mpf("1.5") * nu
    r = mpf(chute.r)
    s = mpmath.sqrt(1 - r**2)
    kappa, delta = mpf(2) / 3 * (2 / (1 + s) - s), mpmath.sqrt(2 / mpmath.pi) * 2 * (1 - mpf(chute.e_w)) / (1 + s)

    def base(y):
        """Energy defect over p and the slip velocity."""
        nu, T, _, q = y
        g1, g2, A = evaluator(chute.radial, ("g1", "g2", "A"), 0, "mpmath")(nu, ep, nu_max)
        p, root = g1 * T, mpmath.sqrt(T)
        slip = (tan * mpmath.sqrt(mpmath.pi / 2) * root + (kappa - A * r**2 / 2) * tan * p / (g2 * root)) / kappa
        return q / p - tan * slip + delta * root, slip

    pieces, z, side = [], mpf(0), mpmath.sign(base(y)[0])
    while True:
        series = taylor_step(chute, y, terms)
        # the last two terms below 1e−19 of the value
        h = min(
            (mpf("1e-19") * abs(c[0]) / max(abs(c[k]), mpf("1e-60"))) ** (mpf(1) / k)
            for c in (series[0], series[1])
            for k in (terms - 1, terms - 2)
        )
        end = [horner(c, -h) for c in series]
        pieces.append((z, h, series))
        if mpmath.sign(base(end)[0]) != side:
            depth = mpmath.findroot(lambda t, last=series: base([horner(c, -t) for c in last])[0], (0, h), solver="anderson", tol=1e-40)
            slip = base([horner(c, -depth) for c in series])[1]
            far_velocity = slip - horner(series[2], -depth)
            bottom = z - depth
            return [(z - bottom, min(h, depth if z - h < bottom else h), c) for z, h, c in pieces], far_velocity
        z, y = z - h, end


def test_taylor_integration_in_thirty_digits():
    """At any z the flow agrees with a Taylor integration in 30 digits: relative 1e−12 in ν, T, u and their derivatives."""
    flow = flow_of(PAPER, 7.338568375902416)
    with mpmath.workdps(30):
        pieces, far_velocity = precise_flow(PAPER, flow.far_temperature)
        assert flow.far_velocity == pytest.approx(float(far_velocity), rel=1e-12, abs=0.0)
        for z0, h, (nu, T, u, q) in pieces:
            for fraction in (mpmath.mpf("0.31"), mpmath.mpf("0.83")):
                z = z0 - fraction * h
                y = flow.states_at(float(z)).real
                t = mpmath.mpf(float(z)) - z0
                exact = [horner(c, t) for c in (nu, T, u, q)]
                exact_z = [horner(c.derivative(), t) for c in (nu, T, u)]
                exact[2] += far_velocity
                decay, T_z, u_z, _ = slopes(np.exp(y[0]), y[1], y[3], PAPER.ep, PAPER.tan_theta, PAPER.radial_law, math.pi)
                got = (np.exp(y[0]), y[1], y[2], np.exp(y[0]) * y[3])
                for a, b in zip(got[:3], exact[:3], strict=True):
                    assert a == pytest.approx(float(b), rel=1e-12, abs=0.0)
                assert got[3] == pytest.approx(float(exact[3]), rel=1e-12, abs=1e-12 * float(exact[0] * exact[1] ** mpmath.mpf(1.5)))
                assert got[0] * decay == pytest.approx(float(exact_z[0]), rel=1e-12, abs=0.0)
                assert u_z == pytest.approx(float(exact_z[2]), rel=1e-12, abs=0.0)
                # T′ changes sign: it is held against νT/T_∞
                assert T_z == pytest.approx(float(exact_z[1]), rel=1e-12, abs=1e-12 * float(exact[0]))


def test_tolerance_is_converged():
    """Tightening the tolerance a thousandfold from 1e−11 moves the base by the first tolerance, not by the second."""
    flows_of = [descend(PAPER, 2.54, tolerance) for tolerance in (1e-8, 1e-11, 1e-16)]
    bases = [flow.states[-1, [0, 1, 3]] for flow in flows_of]
    errors = [np.abs(base - bases[-1]).max() for base in bases[:2]]
    assert errors[0] <= 1e-6 and errors[1] <= 1e-9 and errors[1] < errors[0] / 50
    assert flows_of[0].pieces.shape[2] < flows_of[1].pieces.shape[2] < flows_of[2].pieces.shape[2]


# ------------------------------------------------------------------------------------------------ complex z
@pytest.mark.parametrize(("far_temperature", "centre", "radius"), [(7.338568375902416, 9.0, 6.0), (2.54, 2.0, 1.5), (0.2, 1.0, 0.15)])
def test_flow_is_analytic(far_temperature, centre, radius):
    """Cauchy: once round a circle the flow returns to itself; its mean is the value at the centre, its first moment the derivative."""
    flow = flow_of(PAPER, far_temperature)
    n = 96
    phase = np.exp(2j * np.pi * np.arange(n + 1) / n)
    loop = flow.states_at(centre + radius * phase, order="path")
    at_centre = flow.states_at(centre)
    scale = np.maximum(np.abs(at_centre), 1e-2 * np.abs(loop).max(axis=0))
    assert np.all(np.abs(loop[-1] - loop[0]) <= 2e-12 * scale)
    assert np.all(np.abs(loop[:-1].mean(axis=0) - at_centre) <= 2e-12 * scale)
    y = at_centre.real
    nu, T, Q = math.exp(y[0]), y[1], y[3]
    rates = slopes(nu, T, Q, PAPER.ep, PAPER.tan_theta, PAPER.radial_law, math.pi)
    moment = (loop[:-1] / phase[:-1, None]).mean(axis=0) / radius
    for c in range(4):
        assert abs(moment[c] - rates[c]) <= 5e-12 * scale[c] / radius + 1e-12 * abs(rates[c])
    # real on the real axis, conjugate on both sides of it
    assert np.all(np.abs(loop[1 : n // 2] - loop[n - 1 : n // 2 : -1].conj()) <= 4e-12 * scale)


def test_cauchy_riemann():
    """∂y/∂Re z = −i ∂y/∂Im z = F(y), by central differences of order 6 in both directions."""
    flow = flow_of(PAPER, 2.54)
    weights = ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))
    for z in (1.3 + 0.4j, 0.3 - 0.2j, 8.0 + 2.0j):
        y = flow.states_at(z)
        rates = np.array(slopes(np.exp(y[0]), y[1], y[3], PAPER.ep, PAPER.tan_theta, PAPER.radial_law, math.pi))
        h = 0.02
        along, across = (sum(c * (flow.states_at(z + k * d) - flow.states_at(z - k * d)) for k, c in weights)[:4] / d for d in (h, 1j * h))
        assert np.all(np.abs(along - across) <= 1e-9 * (1 + np.abs(rates)))
        assert np.all(np.abs(along - rates) <= 1e-9 * (1 + np.abs(rates)))


def test_order_any_and_order_path_agree_in_a_simply_connected_region():
    flow = flow_of(PAPER, 7.338568375902416)
    path = np.concatenate((np.linspace(40, 40 + 8j, 5), np.linspace(40 + 8j, 3 + 2j, 40), np.linspace(3 + 2j, 3, 5)))
    a, b = flow.states_at(path), flow.states_at(path, order="path")
    assert np.all(np.abs(a - b) <= 3e-12 * (np.abs(a) + 1))
    assert np.abs(b[-1].imag).max() <= 3e-12 * np.abs(b[-1]).max()
    # any order of the points, any shape
    rng = np.random.default_rng(1)
    shuffled = rng.permutation(len(path))
    assert np.array_equal(flow.states_at(path[shuffled]), a[shuffled])
    assert np.array_equal(flow.states_at(path.reshape(5, 10)), a.reshape(5, 10, 6))
    assert flow.states_at(1.0).shape == (6,)


def test_singularity_of_the_flow_is_reported():
    """The high flow ends near z = 18i, the dense one near z = 5.3i: no state is made up there, and none is NaN on the way."""
    for far_temperature, height in ((7.338568375902416, 18.35j), (0.2, 5.3j)):
        flow = flow_of(PAPER, far_temperature)
        with pytest.raises(
            ConvergenceError, match=r"^the steady flow cannot be continued to z = .*: a singularity of the flow lies there, or a root"
        ):
            flow.states_at(np.array([0.0, height]), order="path")
        with pytest.raises(ConvergenceError, match=r"^the steady flow cannot be continued to z = "):
            flow.states_at(height)
        before = flow.states_at(np.array([0.0, 0.8 * height]), order="path")
        assert np.isfinite(before).all()


def test_points_far_apart_are_reached_as_those_between_are():
    """From high up to far below the base, in one go and by 36 steps."""
    flow = flow_of(PAPER, 2.54)
    z = np.linspace(10.0, -25.0, 36) * 2.54
    far, near = flow.states_at(z[[0, -1]], order="path")[-1], flow.states_at(z, order="path")[-1]
    assert np.isfinite(far).all()
    assert np.all(np.abs(far - near) <= 1e-10 * np.abs(near))


def test_pieces_meet():
    """Every polynomial agrees with the next one where that begins, and half-way between on both sides of the real axis."""
    for far_temperature in (7.338568375902416, 0.2):
        flow = flow_of(PAPER, far_temperature)
        scale = np.abs(flow.pieces[:, :, 0]) + 1e-2 * np.abs(flow.pieces[:, [1], 0]) ** 0.5
        for i, h in enumerate(np.diff(flow.nodes)):
            for t in (h, h * (0.5 + 0.5j), h * (0.5 - 0.5j)):
                if max(abs(t) / flow.radii[i], abs(t - h) / flow.radii[i + 1]) <= 1.0:
                    here, there = (np.polynomial.polynomial.polyval(s, p.T) for s, p in ((t, flow.pieces[i]), (t - h, flow.pieces[i + 1])))
                    # Q is nothing yet next to the top
                    assert np.all(np.abs(here - there)[[0, 1, 2, 4, 5, 6]] <= 4e-15 * scale[i + 1][[0, 1, 2, 4, 5, 6]])


# ------------------------------------------------------------------------------------------------ compiled and not
def test_equations_are_those_of_the_balance():
    """The recorded program gives the slopes of `balance.slopes` and the energy defect of (A 18), compiled and not, at complex states."""
    lists, rng = descent.equations(PAPER.radial_law[0], real=False), np.random.default_rng(5)
    flow = flow_of(PAPER, 0.2)
    for z in (0.0, 0.7, 5.0):
        y = np.append(flow.states_at(z), 0.3) * (1 + 1e-3j * rng.normal(size=7))
        outs = []
        for kernel in (taylor_pieces.expand, taylor_pieces.expand.py_func):
            out, sizes = np.zeros((7, 6), complex), np.empty(7)
            out[:, 0] = y
            stop = kernel(lists, PAPER.numbers.astype(complex), np.empty((len(lists[0]), 6), complex), out, sizes, 6)
            outs.append((out, sizes, stop))
        assert np.all(np.abs(outs[0][0] - outs[1][0]) <= 1e-13 * np.abs(outs[0][0]))
        assert np.allclose(outs[0][1], outs[1][1], rtol=1e-14, atol=0.0)
        assert outs[0][2] == pytest.approx(outs[1][2], rel=1e-12, abs=1e-14)
        nu, T, u, Q = np.exp(y[0]), *y[1:4]
        rates = slopes(nu, T, Q, PAPER.ep, PAPER.tan_theta, PAPER.radial_law, math.pi)
        g1, A = evaluator(PAPER.radial, ("g1", "A"), 0, "numpy")(nu, PAPER.ep, PAPER.nu_max)
        expected = [*rates, -g1 * T, -nu * u, -nu]
        assert np.all(np.abs(outs[0][0][:, 1] - expected) <= 1e-13 * np.abs(expected))
        s = math.sqrt(1 - PAPER.r**2)
        kappa, delta = 2 / 3 * (2 / (1 + s) - s), math.sqrt(2 / math.pi) * 2 * (1 - PAPER.e_w) / (1 + s)
        slip_velocity = (PAPER.tan_theta * (T * math.pi / 2) ** 0.5 + (kappa - A * PAPER.r**2 / 2) * rates[2]) / kappa
        p, q = g1 * T, nu * Q
        assert outs[0][2] == pytest.approx(((q - PAPER.tan_theta * p * slip_velocity + delta * p * T**0.5) / p).real, rel=1e-12, abs=1e-14)


# ------------------------------------------------------------------------------------------------ the family
@cache
def family_at_three() -> tuple[Flow, ...]:
    return tuple(flows(PAPER, 3.0))


def test_three_flows_carry_the_mass_flux_of_the_paper():
    """Q0 = 3, e = e_w = 0.8, r = 0.6, tanθ = 0.3: the paper's high, mid and low temperature flows."""
    found = family_at_three()
    temperatures = [f.far_temperature for f in found]
    assert len(found) == 3 and temperatures == sorted(temperatures)
    for f in found:
        assert f.mass_flux == pytest.approx(3.0, rel=1e-13, abs=0.0)
    # hotter is more dilute, thicker, faster
    for quantity in ("centre_of_mass", "far_velocity"):
        values = [getattr(f, quantity) for f in found[1:]]
        assert values == sorted(values)
    assert [f.base["nu"] for f in found] == sorted((f.base["nu"] for f in found), reverse=True)
    # a scan by hand sees as many sign changes
    scan = [flow_of(PAPER, T).mass_flux > 3.0 for T in np.geomspace(0.02, 500.0, 60)]
    assert sum(a != b for a, b in pairwise(scan)) == 3


def test_branches_are_named_by_temperature():
    found = family_at_three()
    assert BRANCHES == ("high", "mid", "low")
    for branch, flow in zip(("low", "mid", "high"), found, strict=True):
        assert steady_by_flux(PAPER, 3.0, branch).far_temperature == flow.far_temperature


def test_mass_flux_with_one_flow_needs_no_branch():
    flow = steady_by_flux(PAPER, 15.0, None)
    assert flow.mass_flux == pytest.approx(15.0, rel=1e-13, abs=0.0)
    assert steady_by_flux(PAPER, 15.0, "high").far_temperature == flow.far_temperature


@pytest.mark.parametrize("index", [40, 60])
def test_a_flow_on_a_point_of_the_scan_is_found(index):
    """A misfit of exactly zero at a point of the scan is a flow like any other."""
    from shootstab.models.chute.family import SCAN

    T = float(np.exp(np.linspace(np.log(SCAN[0]), np.log(SCAN[1]), SCAN[2])[index]))
    found = [f.far_temperature for f in flows(PAPER, flow_of(PAPER, T).mass_flux)]
    assert sum(abs(t / T - 1) < 1e-9 for t in found) == 1 and len(found) == 3


def test_a_flow_next_to_the_end_of_the_family_is_found():
    """With Carnahan & Starling's g0 the family ends between two points of the scan, at T_∞ = 0.0359: the flow at 0.0361 counts."""
    from shootstab.models.chute.family import SCAN

    with pytest.raises(NoFlowError):
        descend(CARNAHAN_STARLING, 0.0357)
    scan = np.geomspace(*SCAN)
    assert not np.any((scan > 0.0357) & (scan < 0.0361))
    found = [f.far_temperature for f in flows(CARNAHAN_STARLING, descend(CARNAHAN_STARLING, 0.0361).mass_flux)]
    assert min(found) == pytest.approx(0.0361, rel=1e-9, abs=0.0)


def test_errors_of_the_family():
    with pytest.raises(InputError, match=r"mass_flux = 3 has 3 flows, far_temperature .*: branch is needed, one of high, mid, low"):
        steady_by_flux(PAPER, 3.0, None)
    with pytest.raises(InputError, match=r"branch = 'warm': mass_flux = 3 has 3 flows, .*: allowed is high, mid, low"):
        steady_by_flux(PAPER, 3.0, "warm")
    with pytest.raises(NoFlowError, match=r"mass_flux = 1e\+06: no steady flow"):
        steady_by_flux(PAPER, 1e6, "high")
    for bad in (0.0, -1.0, math.inf, math.nan):
        with pytest.raises(InputError, match=r"^mass_flux = .*: allowed is a finite number above 0$"):
            flows(PAPER, bad)


@pytest.mark.parametrize(
    ("chute", "far_temperature"),
    [
        (Chute(e=1.0, e_w=0.8, r=0.6, tan_theta=0.3), 2.0),  # elastic grains: the shear heats without end
        (Chute(e=0.8, e_w=0.8, r=0.6, tan_theta=0.05), 2.0),  # too gentle
        (Chute(e=0.8, e_w=0.8, r=0.6, tan_theta=0.9), 2.0),  # too steep
        (Chute(e=0.95, e_w=0.8, r=0.6, tan_theta=0.3), 20.0),
    ],
)
def test_no_flow_is_an_error_of_the_input(chute, far_temperature):
    with pytest.raises(NoFlowError, match=rf"^no steady flow with far_temperature = {far_temperature:g} and these parameters: .* no base"):
        descend(chute, far_temperature)
    assert issubclass(NoFlowError, InputError)


def test_a_hot_and_thin_base_takes_no_more_pieces_than_the_solution_asks_for():
    """The flow is 10⁴ times as hot at its base as far away. Its mass flux is that of pieces of 3 T_∞ at most, 857 of them."""
    flow = descend(Chute(e=0.954, e_w=0.881, r=0.371, tan_theta=0.16), 0.02165580108668601)
    assert flow.mass_flux == pytest.approx(1691.445822085532, rel=1e-13)
    assert flow.base["T"] > 1e4 * flow.far_temperature
    assert len(flow.nodes) < 100


def test_a_flow_that_heats_without_end_is_not_followed_for_ever():
    with pytest.raises(NoFlowError, match=r"meets no base \(followed down to nu = \S+e-05\)"):
        descend(Chute(e=0.817, e_w=0.0526, r=0.8645, tan_theta=0.0819), 1.0)


def test_smooth_base_bears_no_shear():
    """r = 0: κ = 0, and tanθ = T^{−1/2} √(2/π)(κu − …) has no solution."""
    smooth = Chute(e=0.8, e_w=0.8, r=0.0, tan_theta=0.3)
    assert slip_coefficient(0.0) == 0.0
    with pytest.raises(NoFlowError, match=r"^r = 0: no steady flow, for a smooth base bears no shear"):
        descend(smooth, 2.0)
    with pytest.raises(NoFlowError):
        steady_by_flux(smooth, 3.0, "high")


@pytest.mark.parametrize("bad", [0.0, -2.0, math.inf, math.nan])
def test_unphysical_far_temperature(bad):
    with pytest.raises(InputError, match=r"^far_temperature = "):
        descend(PAPER, bad)


@cases
def test_height_is_where_nu_is(chute, far_temperature):
    flow = flow_of(chute, far_temperature)
    for nu in (1e-25, 1e-12, 1e-4 * flow.base["nu"]):
        assert math.exp(flow.states_at(flow.height(nu))[0].real) == pytest.approx(nu, rel=1e-10, abs=0.0)
    assert float(radial(flow.base["nu"], chute.radial_law)[0]) > 1.0


def test_scouting_with_cruder_flows_finds_the_same_members(monkeypatch: pytest.MonkeyPatch) -> None:
    from shootstab.models.chute import family

    for mass_flux in (0.3, 3.0, 15.0):
        quick = [f.far_temperature for f in flows(PAPER, mass_flux)]
        with monkeypatch.context() as patch:
            patch.setattr(family, "DOUBT", np.inf)
            assert [f.far_temperature for f in flows(PAPER, mass_flux)] == quick


def test_a_height_that_is_no_number_is_refused() -> None:
    with pytest.raises(InputError, match="z holds what is no finite number"):
        flow_of(PAPER, 7.0).states_at(np.array([1.0, math.nan]))


def test_the_inputs_of_a_flow_that_errs_as_much_all_differ_in_their_last_bit() -> None:
    """Of a flow whose modes hang on 1 − e, two samples had the same e, and told a tenth of the error."""
    flow = descend(Chute(e=0.94534, e_w=0.75038, r=0.35397, tan_theta=0.17995), 13.467)
    others = [with_base_flow_error(flow, factor).chute for factor in (4.0, 2.0)]
    for name in ("e", "e_w", "r", "tan_theta", "nu_max"):
        given = getattr(flow.chute, name)
        changes = [abs(getattr(other, name) - given) / np.spacing(given) for other in others]
        assert all(0.5 <= change <= 1.0 for change in changes)
