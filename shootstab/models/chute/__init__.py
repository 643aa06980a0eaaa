"""Rapid granular chute flow (Woodhouse & Hogg 2010, Part 2; equation numbers in this package are that paper's): steady flows and their
perturbations.

Units throughout: grain diameter d, grain density ρ_p, normal gravity g cosθ; so that of time is √(d/(g cosθ)), of T d g cosθ, and of Q0
√(d³ g cosθ). z points away from the base and gravity is (tanθ, 0, −1). Everything is imported when it is first used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from shootstab.core.errors import InputError

if TYPE_CHECKING:
    from shootstab.models.chute.chute_problem import ChuteProblem
    from shootstab.models.chute.family import flows
    from shootstab.models.chute.parameters import Chute
    from shootstab.models.chute.steady_flow import Flow

__all__ = ["Chute", "ChuteProblem", "Flow", "flows", "problem", "steady"]
_HOMES = {"Chute": "parameters", "ChuteProblem": "chute_problem", "Flow": "steady_flow", "flows": "family"}


def steady(*, far_temperature: float | None = None, mass_flux: float | None = None, branch: str | None = None, **parameters: Any) -> Flow:
    """The steady flow with this T_∞, or with this mass flux Q0; branch ('high', 'mid', 'low') picks one of several.

    parameters are those of `Chute`: e, e_w, r, tan_theta, and if they are not to be the default nu_max, radial, wall.
    Raises InputError for parameters outside physics and NoFlowError where there is no flow.
    """
    from shootstab.models.chute.family import steady_by_flux
    from shootstab.models.chute.parameters import Chute
    from shootstab.models.chute.steady_flow import descend

    chute = Chute(**parameters)
    if (far_temperature is None) == (mass_flux is None):
        raise InputError("far_temperature and mass_flux: allowed is exactly one of them")
    if far_temperature is not None:
        if branch is not None:
            raise InputError(f"branch = {branch!r}: allowed only with mass_flux")
        return descend(chute, far_temperature)
    assert mass_flux is not None
    return steady_by_flux(chute, mass_flux, branch)


def problem(flow: Flow, kx: float, ky: float) -> ChuteProblem:
    """Perturbations of the flow with wavenumbers kx, ky (in 1/d). Raises InputError where both are zero."""
    from shootstab.models.chute.chute_problem import ChuteProblem

    return ChuteProblem(flow, float(kx), float(ky))


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
    globals()[name] = value
    return value
