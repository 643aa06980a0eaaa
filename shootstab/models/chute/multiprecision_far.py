"""The decaying space of the chute at infinity in numbers of any precision, and the rotation v → iv that makes k_x = 0 real."""

from __future__ import annotations

from typing import Any

from shootstab.models.chute import constitutive as law
from shootstab.models.chute import first_order_system as system
from shootstab.models.chute.parameters import Chute
from shootstab.multiprecision.arithmetic import Arithmetic, Matrix, simplified

SPANWISE = (2, 6)  # exact: v̂ and v̂′, which k_x = 0 makes imaginary


def wavenumber(arithmetic: Arithmetic, kx: Any, ky: Any) -> Any:
    """K = √(k_x² + k_y²)."""
    return simplified(arithmetic, (kx * kx + ky * ky) ** 0.5)


def turned(entry: Any, i: int, j: int) -> Any:
    """An entry after v → iv."""
    return entry * (-1j if i in SPANWISE else 1j) if (i in SPANWISE) != (j in SPANWISE) else entry


def leading(arithmetic: Arithmetic, chute: Chute, waves: tuple[Any, Any], far: tuple[Any, Any], sigma: Any) -> tuple[Matrix, Matrix]:
    """P_0 (n, k), with columns û, v̂, ŵ, T̂ at infinity, and N = Λ − K T_∞ I (k, k), N² = 0; see models.chute.far_field.

    waves are k_x and k_y, complex, far is T_∞ and u_∞.
    """
    (kx, ky), (T, far_velocity), zero, one = waves, far, arithmetic.number(0), arithmetic.number(1)
    K = wavenumber(arithmetic, kx, ky)
    s = [1j * kx, 1j * ky, -arithmetic.complex(K)]
    B = [[-s[i] * s[j] / (7 * K) + (K if i == j else 0) for j in range(3)] for i in range(3)]
    omega = sigma + 1j * kx * far_velocity
    divergence = [-B[2][0] + 1j * kx, -B[2][1] + 1j * ky, -B[2][2] - 1 / T]
    P = [[zero] * 4 for _ in range(system.SIZE)]
    for q in range(3):
        P[0][q], P[5][q], P[6][q] = -divergence[q] / omega, -B[0][q], -B[1][q]
    for q in range(4):
        P[1 + q][q] = one
    P[7][3] = law.coefficients(zero, chute.ep, chute.radial_law, arithmetic.pi).g3[0] * T**0.5 * K
    N = [[(B[i][j] - (K if i == j else 0)) * T for j in range(3)] + [zero] for i in range(3)] + [[zero] * 4]
    if kx != 0:
        return P, N
    turn = (0, 2, 0, 0)  # column 1 of the frame belongs to v̂

    def real(x: Any) -> Any:
        return simplified(arithmetic, x)

    P = [[real(turned(arithmetic.complex(x), i, turn[q])) for q, x in enumerate(row)] for i, row in enumerate(P)]
    return P, [[real(turned(arithmetic.complex(x), turn[i], turn[q])) for q, x in enumerate(row)] for i, row in enumerate(N)]
