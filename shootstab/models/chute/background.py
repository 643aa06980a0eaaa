"""The steady flow at a set of points, with the derivatives that the linearized equations need.

Derivatives with respect to z are never typed: every quantity is a series of two terms in z, F + F′ε, built by evaluating the
steady equations on such series. The coefficients may be numbers, arrays over points, or series in another variable.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from shootstab.core.series import Series
from shootstab.models.chute import constitutive as law
from shootstab.models.chute.balance import slopes
from shootstab.models.chute.parameters import Chute


@dataclass(frozen=True)
class Background:
    """Steady fields and the functions of table 1, each F + F′ε in z.

    decay is ν0′/ν0, u_z is u0′ and so on. a … m are a0 … m0, e_star and h_star are e0*, h0*.
    """

    nu: Series
    T: Series
    u: Series
    decay: Series
    nu_z: Series
    T_z: Series
    u_z: Series
    p: Series
    eta: Series
    xi: Series
    K: Series
    K_star: Series
    a: Series
    b: Series
    c: Series
    d: Series
    e: Series
    h: Series
    e_star: Series
    h_star: Series
    l: Series  # noqa: E741 - the paper's symbol
    m: Series


def background(chute: Chute, nu: Any, T: Any, u: Any, Q: Any, pi: Any) -> Background:
    """All of them from the state (ν, T, u, Q = q/ν) at one point, at many, or as series."""
    decay, T_z, u_z, Q_z = slopes(nu, T, Q, chute.ep, chute.tan_theta, chute.radial_law, pi)
    nu, T, u, Q = Series((nu, nu * decay)), Series((T, T_z)), Series((u, u_z)), Series((Q, Q_z))
    return fields(chute, nu, T, u, Q, pi)


def fields(chute: Chute, nu: Any, T: Any, u: Any, Q: Any, pi: Any) -> Background:
    """All of them in the arithmetic of ν, T, u and Q: from pairs F + F′ε come pairs, from series in z come series."""
    decay, T_z, u_z, _ = slopes(nu, T, Q, chute.ep, chute.tan_theta, chute.radial_law, pi)
    g = law.coefficients(nu, chute.ep, chute.radial_law, pi)
    root, T32 = T**0.5, T * T**0.5
    return Background(
        nu=nu,
        T=T,
        u=u,
        decay=decay,
        nu_z=nu * decay,
        T_z=T_z,
        u_z=u_z,
        p=g.g1[0] * T,
        eta=g.g2[0] * root,
        xi=g.g6[0] * root,
        K=g.g3[0] * root,
        K_star=g.g4[0] * T32,
        a=g.g1[1] * T,
        b=g.g1[0],
        c=g.g2[1] * root,
        d=g.g2[0] / root / 2,
        e=g.g3[1] * root,
        h=g.g3[0] / root / 2,
        e_star=g.g4[1] * T32,
        h_star=3 * g.g4[0] * root / 2,
        l=g.g5[1] * T32,
        m=3 * g.g5[0] * root / 2,
    )
