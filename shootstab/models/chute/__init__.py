"""Rapid granular chute flow (Woodhouse & Hogg 2010): steady flows and their perturbations."""

from __future__ import annotations

from shootstab.core.errors import InputError
from shootstab.models.chute.family import flows, steady_by_flux
from shootstab.models.chute.parameters import Chute
from shootstab.models.chute.problem import ChuteProblem
from shootstab.models.chute.steady import Flow, descend

__all__ = ["Chute", "ChuteProblem", "Flow", "flows", "problem", "steady"]


def steady(
    *,
    e: float,
    e_w: float,
    r: float,
    tan_theta: float,
    far_temperature: float | None = None,
    mass_flux: float | None = None,
    branch: str | None = None,
    nu_max: float = 0.62,
    radial: str = "lun-savage",
    wall: str = "printed",
) -> Flow:
    """The steady flow with this T_∞, or with this mass flux Q0; branch ('high', 'mid', 'low') picks one of several.

    Raises InputError for parameters outside physics and NoFlowError where there is no flow.
    """
    chute = Chute(e, e_w, r, tan_theta, nu_max, radial, wall)
    if (far_temperature is None) == (mass_flux is None):
        raise InputError("exactly one of far_temperature and mass_flux must be given")
    if far_temperature is not None:
        if branch is not None:
            raise InputError(f"branch = {branch!r}: allowed only with mass_flux")
        return descend(chute, far_temperature)
    assert mass_flux is not None
    return steady_by_flux(chute, mass_flux, branch)


def problem(flow: Flow, kx: float, ky: float) -> ChuteProblem:
    """Perturbations of the flow with wavenumbers kx, ky (in 1/d); both zero is refused."""
    return ChuteProblem(flow, float(kx), float(ky))
