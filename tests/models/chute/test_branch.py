"""models/chute/branch.py: a branch of flows is followed, and ends where it folds."""

from __future__ import annotations

import math
import re
from functools import cache

import pytest
from scipy.optimize import minimize_scalar

from shootstab.core.errors import NoFlowError
from shootstab.models.chute.branch import continued
from shootstab.models.chute.chute_problem import ChuteProblem
from shootstab.models.chute.family import steady_by_flux
from shootstab.models.chute.parameters import Chute
from shootstab.models.chute.steady_flow import Flow, descend

PAPER = Chute(e=0.8, e_w=0.8, r=0.6, tan_theta=0.3)


@cache
def member(branch: str) -> Flow:
    return steady_by_flux(PAPER, 3.0, branch)


def test_the_low_branch_goes_on_where_it_is_the_only_one() -> None:
    """Q0 = 2.5 has one flow, of T_∞ = 0.141: it continues the low flow of Q0 = 3, and neither of the others."""
    flow = continued(member("low"), PAPER, 2.5)
    assert flow.far_temperature == pytest.approx(steady_by_flux(PAPER, 2.5, None).far_temperature, rel=1e-10, abs=0.0)
    assert flow.mass_flux == pytest.approx(2.5, rel=1e-12, abs=0.0)


def test_high_and_mid_end_in_their_fold() -> None:
    """The least mass flux between the two flows, found here by minimizing Q0(T_∞), is where both say that they end."""
    between = (math.log(member("mid").far_temperature), math.log(member("high").far_temperature))
    fold = minimize_scalar(lambda x: descend(PAPER, math.exp(x), 1e-11).mass_flux, bounds=between, method="bounded").fun
    for branch in ("high", "mid"):
        with pytest.raises(NoFlowError, match="ends on the way") as refusal:
            continued(member(branch), PAPER, 2.5)
        said = re.search(r"mass_flux = ([\d.]+)", str(refusal.value))
        assert said is not None and float(said[1]) == pytest.approx(fold, rel=1e-5, abs=0.0)


def test_a_family_by_mass_flux_follows_its_flow_and_says_its_temperature() -> None:
    family = ChuteProblem(member("high"), 0.0, 0.01).family(("mass_flux",))
    assert family.absent({"mass_flux": 3.2}) is None
    assert family.beside({"mass_flux": 3.0}) == {"far_temperature": member("high").far_temperature}
    assert family.beside({"mass_flux": 3.2})["far_temperature"] > member("high").far_temperature
    why = family.absent({"mass_flux": 2.5})
    assert why is not None and why.startswith("no flow: the branch of the scene's flow ends")
    by_temperature = ChuteProblem(member("high"), 0.0, 0.01).family(("ky",))
    assert by_temperature.beside({"ky": 0.01}) == {}


def test_a_dilute_flow_has_a_place_where_the_far_field_ends() -> None:
    """ν at the base is 0.0038, less than where the series of the far field would hold: it is begun inside the flow."""
    chute = Chute(0.74062, 0.79416, 0.21837, 0.070054, 0.61735, wall="isotropic")
    flow = descend(chute, 13.924)
    assert flow.base["nu"] == pytest.approx(flow.rising, rel=1e-12, abs=0.0) and flow.rising < 0.004
    assert 0.0 < flow.height(flow.inside(1.0)) < flow.nodes[0]
    assert flow.inside(1e-9) == 1e-9
