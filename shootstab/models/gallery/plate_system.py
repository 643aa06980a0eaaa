"""Small disturbances of a parallel compressible boundary layer: Mack's first-order system of order 8, derived anew.

Normal modes (u, v, w, p, θ)(y) exp(iαx + iβz + σt) of velocities, pressure (in ρ_∞U_∞²) and temperature; viscosity μ(T), second
coefficient mμ, state (u, u′, v, p, θ, θ′, w, w′). With a = iα, b = iβ, k² = α² + β², Λ = σ + aU, r = R/μ, g = γM², c = 2 + m and
Δ = au + v′ + bw = (T′/T) v − Λ (g p − θ/T), the conservation of mass with ρ = 1/T and δρ/ρ = g p − θ/T:

    v′ = Δ − au − bw
    u″ = r(Λu + U′v)/T + r a p + k²u − a(1+m)Δ − (μ′/μ)(u′ + av) − [(μ_T U′)′θ + μ_T U′θ′]/μ
    w″ = rΛw/T + r b p + k²w − b(1+m)Δ − (μ′/μ)(w′ + bv)
    θ″ = r Pr[(Λθ + T′v)/T − hΛp] − Pr h[2U′(u′ + av) + (μ_T/μ)U′²θ] − 2(μ′/μ)θ′ − (μ″/μ)θ + k²θ,   h = (γ−1)M²
    (r + cgΛ) p′ = −rΛv/T − k²v − (au′ + bw′) + a(μ_T/μ)U′θ + (μ′/μ)(cΔ − 2au − 2bw)
                   + c[(T′/T)′v + (T′/T)v′ − aU′(g p − θ/T) + Λ(θ′/T − θT′/T²)]

Affine in σ for given α. In α for given σ it is quadratic, by the terms in α², aΔ and aΛ. Stokes: m = −2/3. Mack's ratio λ of viscosities
means m = ⅔(λ − 1); his 1.2 is m = 0.1333 (L. M. Mack, AGARD R-709 (1984), 8). Source of the cases: M. R. Malik, J. Comput. Phys. 86
(1990) 376.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from shootstab.models.gallery.plate_flow import Gas, PlateFlow

PLATE_SIZE = 8  # exact: states of the first-order system
Polynomial = dict[tuple[int, int], Any]  # coefficients of α^i σ^j
PolynomialEntries = dict[tuple[int, int], Polynomial]


def times(p: Polynomial, q: Polynomial) -> Polynomial:
    """The product of two polynomials in α and σ."""
    out: Polynomial = {}
    for (i, j), x in p.items():
        for (k, n), y in q.items():
            out[i + k, j + n] = out.get((i + k, j + n), 0) + x * y
    return out


def total(*terms: tuple[Any, Polynomial]) -> Polynomial:
    """Σ factor·polynomial."""
    out: Polynomial = {}
    for factor, p in terms:
        for key, x in p.items():
            out[key] = out.get(key, 0) + factor * x
    return out


def background(flow: PlateFlow, y: Any) -> dict[str, Any]:
    """U, U′, U″, T, T′, T″, μ, μ′, μ″, μ_T and (μ_T U′)′ at points, from the state of the flow without differentiation."""
    gas = flow.gas
    f, U, S, T, Q = flow.at(y)
    mu, mu_T, mu_TT = gas.viscosity(T)
    U_y, T_y = S / mu, gas.prandtl * Q / mu
    mu_y = mu_T * T_y
    S_y = -0.5 * f * S / mu
    Q_y = -0.5 * f * gas.prandtl * Q / mu - (gas.gamma - 1) * gas.mach**2 * S * S / mu
    U_yy, T_yy = (S_y - mu_y * U_y) / mu, (gas.prandtl * Q_y - mu_y * T_y) / mu
    named = {"U": U, "U_y": U_y, "U_yy": U_yy, "T": T, "T_y": T_y, "T_yy": T_yy, "mu": mu, "mu_T": mu_T, "mu_y": mu_y}
    return {**named, "mu_yy": mu_TT * T_y**2 + mu_T * T_yy, "turn": mu_TT * T_y * U_y + mu_T * U_yy}


def system(bg: Mapping[str, Any], gas: Gas, reynolds: Any, beta: Any, m: Any) -> tuple[PolynomialEntries, PolynomialEntries]:
    """C and D of C ψ′ = D ψ by their non-zero entries, each a polynomial in α and σ."""
    U, U_y, T, T_y, T_yy = (bg[name] for name in ("U", "U_y", "T", "T_y", "T_yy"))
    mu, mu_T, mu_y, mu_yy = (bg[name] for name in ("mu", "mu_T", "mu_y", "mu_yy"))
    r, g, h, c = reynolds / mu, gas.gamma * gas.mach**2, (gas.gamma - 1) * gas.mach**2, 2 + m
    Pr, ell = gas.prandtl, mu_y / mu
    one: Polynomial = {(0, 0): 1.0}
    a: Polynomial = {(1, 0): 1j}
    b: Polynomial = {(0, 0): 1j * beta}
    k2: Polynomial = {(2, 0): 1.0, (0, 0): beta * beta}
    L: Polynomial = {(0, 1): 1.0, (1, 0): 1j * U}  # Λ
    u, u_y, v, p, th, th_y, w, w_y = range(PLATE_SIZE)

    Delta: dict[int, Polynomial] = {v: total((T_y / T, one)), p: total((-g, L)), th: total((1 / T, L))}
    v_y = {**Delta, u: total((-1, a)), w: total((-1, b))}

    C: PolynomialEntries = {(i, i): one for i in range(PLATE_SIZE)}
    C[p, p] = total((1, one), (c * g / r, L))  # the row divided by r
    D: PolynomialEntries = {(u, u_y): one, (w, w_y): one, (th, th_y): one}
    D.update({(v, j): e for j, e in v_y.items()})

    for row, direction, here, slope in ((u_y, a, u, u_y), (w_y, b, w, w_y)):
        D[row, here] = total((r / T, L), (1, k2))
        D[row, slope] = total((-ell, one))
        D[row, p] = total((r, direction), (-(1 + m), times(direction, Delta[p])))
        D[row, v] = total((-(1 + m), times(direction, Delta[v])), (-ell, direction))
        D[row, th] = total((-(1 + m), times(direction, Delta[th])))
    D[u_y, v] = total((1, D[u_y, v]), (r * U_y / T, one))
    D[u_y, th] = total((1, D[u_y, th]), (-bg["turn"] / mu, one))
    D[u_y, th_y] = total((-mu_T * U_y / mu, one))

    D[th_y, u_y] = total((-2 * Pr * h * U_y, one))
    D[th_y, v] = total((r * Pr * T_y / T, one), (-2 * Pr * h * U_y, a))
    D[th_y, p] = total((-r * Pr * h, L))
    D[th_y, th] = total((r * Pr / T, L), (-Pr * h * mu_T / mu * U_y**2 - mu_yy / mu, one), (1, k2))
    D[th_y, th_y] = total((-2 * ell, one))

    log_T_yy = T_yy / T - (T_y / T) ** 2  # (T′/T)′
    s = 1 / r
    D[p, u] = total((-2 * ell * s, a), (c * s * T_y / T, v_y[u]))
    D[p, u_y] = total((-s, a))
    D[p, w] = total((-2 * ell * s, b), (c * s * T_y / T, v_y[w]))
    D[p, w_y] = total((-s, b))
    both = c * s * (ell + T_y / T)
    D[p, v] = total((-1 / T, L), (-s, k2), (both, Delta[v]), (c * s * log_T_yy, one))
    D[p, p] = total((both, Delta[p]), (-c * s * g * U_y, a))
    D[p, th] = total((s * mu_T / mu * U_y, a), (both, Delta[th]), (c * s * U_y / T, a), (-c * s * T_y / T**2, L))
    D[p, th_y] = total((c * s / T, L))
    return C, D
