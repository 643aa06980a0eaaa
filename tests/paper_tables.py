"""The tables of the paper's A.2 and A.3, transcribed, each misprint of guide/theory.md 1.3 corrected or left in by its name."""

from __future__ import annotations

import sympy as sp
from linearization import KX, KY, SIGMA, TABLE_1, TAN, dz, jet

SIZE = 8
ERRATA = frozenset({"N21", "N35", "(A 7)", "C51", "C55", "C58", "C62", "C73", "D26, D27", "D44"})
NONE: frozenset[str] = frozenset()

n, n_z = jet("nu", 0), jet("nu", 1)


def to_psi(C: sp.Matrix, D: sp.Matrix) -> tuple[sp.Matrix, sp.Matrix]:
    """φ = Sψ, S = diag(ν0, 1, …): C S and D S − C S′, the first row divided by ν0."""
    S, S_z, row = sp.eye(SIZE), sp.zeros(SIZE, SIZE), sp.eye(SIZE)
    S[0, 0], S_z[0, 0], row[0, 0] = n, n_z, 1 / n
    return row * C * S, row * (D * S - C * S_z)


def paper_matrices(printed: frozenset[str] = NONE) -> tuple[sp.Matrix, sp.Matrix, sp.Matrix, sp.Matrix]:
    """L, M, N, Σ (5, 5) of A.2; of its misprints N21, with (c0 u0)′ for (c0 u0′)′, and N35, with the other sign, those named stay in."""
    I, R = sp.I, sp.Rational  # noqa: E741
    nu, u, p, eta, xi, K, Ks = (jet(name, 0) for name in ("nu", "u", "p", "eta", "xi", "K", "K_star"))
    a, b, c, d, e, h, es, hs, l, m = (jet(name, 0) for name in TABLE_1)  # noqa: E741
    u_z, T_z, nu_z, eta_z, xi_z = (jet(name, 1) for name in ("u", "T", "nu", "eta", "xi"))
    n21 = TAN - I * KX * a + dz(c * (u if "N21" in printed else u_z))
    n35 = I * KY * b if "N35" in printed else -I * KY * b
    L, M, N, S = (sp.zeros(5, 5) for _ in range(4))

    def put(A: sp.Matrix, entries: dict[int, object]) -> None:
        for place, value in entries.items():
            A[place // 10 - 1, place % 10 - 1] = value

    put(L, {22: eta, 33: eta, 44: xi + R(4, 3) * eta, 51: -Ks, 55: K})
    put(M, {14: nu, 21: c * u_z, 22: eta_z, 24: I * KX * (xi + eta / 3), 25: d * u_z})
    put(M, {33: eta_z, 34: I * KY * (xi + eta / 3), 41: -a, 42: I * KX * (xi + eta / 3)})
    put(M, {43: I * KY * (xi + eta / 3), 44: xi_z + R(4, 3) * eta_z, 45: -b})
    put(M, {51: -dz(Ks) + e * T_z - es * nu_z, 52: 2 * eta * u_z, 54: -p, 55: dz(K) + h * T_z - hs * nu_z})
    put(N, {11: I * KX * u, 12: I * KX * nu, 13: I * KY * nu, 14: nu_z})
    put(N, {21: n21, 22: -I * KX * nu * u - KX**2 * (xi + R(4, 3) * eta) - KY**2 * eta})
    put(N, {23: -KX * KY * (xi + eta / 3), 24: -nu * u_z + I * KX * eta_z, 25: -I * KX * b + dz(d * u_z)})
    put(N, {31: -I * KY * a, 32: -KX * KY * (xi + eta / 3), 33: -I * KX * nu * u - KX**2 * eta - KY**2 * (xi + R(4, 3) * eta)})
    put(N, {34: I * KY * eta_z, 35: n35, 41: -1 + I * KX * c * u_z - dz(a), 42: I * KX * (xi_z - R(2, 3) * eta_z)})
    put(N, {43: I * KY * (xi_z - R(2, 3) * eta_z), 44: -I * KX * nu * u - (KX**2 + KY**2) * eta, 45: I * KX * d * u_z - dz(b)})
    put(N, {51: c * u_z**2 + (KX**2 + KY**2) * Ks + dz(e * T_z) - dz(es * nu_z) - l})
    put(N, {52: -I * KX * p, 53: -I * KY * p, 54: -R(3, 2) * nu * T_z + 2 * I * KX * eta * u_z})
    put(N, {55: -R(3, 2) * I * KX * nu * u + d * u_z**2 - (KX**2 + KY**2) * K + dz(h * T_z) - dz(hs * nu_z) - m})
    put(S, {11: -1, 22: nu, 33: nu, 44: nu, 55: R(3, 2) * nu})
    return L, M, N, S


def paper_first_order(printed: frozenset[str] = NONE) -> tuple[sp.Matrix, sp.Matrix]:
    """C, D (8, 8) of A.3; of the misprints in ERRATA those named stay in.

    D26, D27: M22 multiplies û′, the sixth of φ. (A 7): the state β̂ is defined by −K0 ν̂′ + K0* T̂′ where A.3 means −K0 T̂′ + K0* ν̂′.
    """
    L, M, N, S = paper_matrices(printed)
    L11 = N[0, 0] - SIGMA * S[0, 0]  # N11 − σΣ11
    M14, N12, N13, N14, L44, M44 = M[0, 3], N[0, 1], N[0, 2], N[0, 3], L[3, 3], M[3, 3]
    C, D = sp.zeros(8, 8), sp.zeros(8, 8)

    def put(A: sp.Matrix, entries: dict[int, object]) -> None:
        for place, value in entries.items():
            A[place // 10 - 1, place % 10 - 1] = sp.expand(value)

    def bracket(Nij: sp.Expr) -> sp.Expr:
        return Nij * dz(M14) - dz(Nij) * M14 + Nij * N14

    put(C, {14: M14, 21: M[1, 0], 25: M[1, 4], 26: L[1, 1], 37: L[2, 2], 41: M[3, 0] - L44 * L11 / M14, 45: M[3, 4]})
    put(C, {51: M[4, 0] - L[4, 0], 55: M[4, 4] - L[4, 4], 81: -L[4, 0], 85: -L[4, 4]})
    put(D, {11: -L11, 12: -N12, 13: -N13, 14: -N14})
    put(D, {21: M[1, 3] * L11 / M14 - N[1, 0], 22: M[1, 3] * N12 / M14 - (N[1, 1] - SIGMA * S[1, 1])})
    put(D, {23: M[1, 3] * N13 / M14 - N[1, 2], 24: M[1, 3] * N14 / M14 - N[1, 3], 25: -N[1, 4], 27: -M[1, 1]})
    put(D, {31: M[2, 3] * L11 / M14 - N[2, 0], 32: M[2, 3] * N12 / M14 - N[2, 1]})
    put(D, {33: M[2, 3] * N13 / M14 - (N[2, 2] - SIGMA * S[2, 2]), 34: M[2, 3] * N14 / M14 - N[2, 3], 35: -N[2, 4], 37: -M[2, 2]})
    put(D, {41: (M44 / M14 - L44 * dz(M14) / M14**2 - L44 * N14 / M14**2) * L11 - N[3, 0] + L44 / M14 * dz(L11)})
    put(D, {42: M44 * N12 / M14 - N[3, 1] - L44 / M14**2 * bracket(N12), 43: M44 * N13 / M14 - N[3, 2] - L44 / M14**2 * bracket(N13)})
    put(D, {44: M44 * N14 / M14 - (N[3, 3] - SIGMA * S[3, 3]) - L44 / M14**2 * (N14 * dz(M14) - dz(N14) * M14)})
    put(D, {45: -N[3, 4], 46: L44 * N12 / M14 - M[3, 1], 47: L44 * N13 / M14 - M[3, 2]})
    put(D, {51: M[4, 3] * L11 / M14 - N[4, 0], 52: M[4, 3] * N12 / M14 - N[4, 1], 53: M[4, 3] * N13 / M14 - N[4, 2]})
    put(D, {54: M[4, 3] * N14 / M14 - N[4, 3], 55: SIGMA * S[4, 4] - N[4, 4], 56: -M[4, 1], 66: 1, 77: 1, 88: 1})
    put(C, {51: M[4, 0] - (L[4, 0] if "C51" in printed else dz(L[4, 0])), 55: M[4, 4] - (L[4, 4] if "C55" in printed else dz(L[4, 4]))})
    put(C, {place: sign for place, sign in ((58, -1), (62, 1), (73, 1)) if f"C{place}" not in printed})
    if "(A 7)" in printed:
        put(C, {81: -L[4, 4], 85: -L[4, 0]})
    if "D26, D27" not in printed:
        put(D, {26: -M[1, 1], 27: 0})
    if "D44" not in printed:  # N14² is missing
        put(D, {44: M44 * N14 / M14 - (N[3, 3] - SIGMA * S[3, 3]) - L44 / M14**2 * bracket(N14)})
    return C, D
