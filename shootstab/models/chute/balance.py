"""The steady equations (guide/theory.md 1.2), solved for the derivatives: p′ = −ν, u′ = tanθ p/η, q′ = tanθ² p²/η − γ.

For floats, complex numbers, arrays and series alike.
"""

from __future__ import annotations

from typing import Any

from numba.extending import register_jitable

from shootstab.models.chute import constitutive as law


@register_jitable
def slopes(nu: Any, T: Any, Q: Any, ep: Any, tan_theta: Any, radial_law: Any, pi: Any) -> Any:
    """(ν′/ν, T′, u′, Q′) at a state, for numbers, arrays and series alike; Q = q/ν, radial_law as in `constitutive.radial`.

    T′ and ν′ follow from p = g1 T with p′ = −ν and from q = −K T′ + K* ν′.
    """
    f1, g2, g3, g4, f5, g1, dg1 = law.steady(nu, ep, radial_law, pi)
    root_T = T**0.5
    mixed = dg1 * g3 + g1 * g4  # (a K + b K*)/T^(3/2)
    log_nu_z = (g1 * Q - g3 * root_T) / (mixed * T * root_T)
    T_z = -nu * (dg1 * Q + g4 * root_T) / (mixed * root_T)
    u_z = tan_theta * g1 * root_T / g2
    Q_z = nu * T * root_T * (tan_theta * tan_theta * f1 * f1 / g2 - f5) - Q * log_nu_z
    return log_nu_z, T_z, u_z, Q_z


@register_jitable
def slip(nu: Any, T: Any, u_z: Any, g0: Any, r: Any, tan_theta: Any, pi: Any) -> Any:
    """The velocity that the base allows: tanθ = T^(−1/2) √(2/π) (κu − (κ − ½A r²)u′)."""
    kappa = law.slip_coefficient(r)
    return (tan_theta * (T * pi / 2) ** 0.5 + (kappa - law.wall_shear(nu, g0, pi) * r * r / 2) * u_z) / kappa
