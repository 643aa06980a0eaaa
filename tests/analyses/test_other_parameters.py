"""analyses/other_parameters.py: a list that another run made is told from one that is wrong."""

from __future__ import annotations

from functools import partial
from itertools import count
from typing import Any

import numpy as np
import pytest

import shootstab as st
from shootstab.analyses.other_parameters import OtherValue, Variation, other_values
from shootstab.core.allowance import Allowance
from shootstab.core.records import CONFIRMED, SPURIOUS, Report, Verdict
from shootstab.models.gallery.poiseuille import PlanePoiseuille

# the first four even modes of plane Poiseuille flow at R = 10000 and α, as the bundled reference has them, to ten figures
MODES = {
    1.02: [0.0032832088 - 0.2443879038j, -0.1864844643 - 0.1934095218j],
    1.2: [-0.0090283053 - 0.3042566032j, -0.2171652692 - 0.2233920149j],
}


def asked(claims: list[complex], verdict: str = SPURIOUS) -> tuple[OtherValue, ...]:
    report = Report(tuple(Verdict(c, verdict, "") for c in claims), (), 6)
    return other_values({"alpha": Variation(1.0, lambda alpha: PlanePoiseuille(10000.0, alpha, half=False))}, report, 6).found


@pytest.mark.parametrize("other", MODES)
def test_a_value_at_which_the_claims_are_modes_is_found(other: float) -> None:
    (found,) = asked(MODES[other])
    assert (found.parameter, found.here, found.value, found.tried, found.agreeing) == ("alpha", 1.0, other, 2, 2)
    assert found.digits > 6


def test_lists_that_are_wrong_or_right_or_short_get_no_proposal() -> None:
    assert asked([MODES[1.2][0], 1.07 * MODES[1.2][1]]) == ()
    assert asked(MODES[1.2], CONFIRMED) == ()
    assert asked(MODES[1.2][:1]) == ()


def test_a_parameter_of_equations() -> None:
    """u″ + k² (1 + i) u = σ u, u = 0 at both walls: σ = (1 + i) k² − (jπ)²."""
    wall = [st.Conditions(at, ["u"]) for at in (0, 1)]
    problem = st.equations(["u"], ["d(u,2) + k**2*(1 + i)*u = sigma*u"], *wall, parameters={"k": 2.0})
    claims = [(1 + 1j) * 2.3**2 - (j * np.pi) ** 2 for j in (1, 2)]
    report = Report(tuple(Verdict(c, SPURIOUS, "") for c in claims), (), 6)
    family = problem.family
    assert family is not None
    (found,) = other_values({"k": Variation(2.0, lambda k: family(("k",)).problem({"k": k}))}, report, 6).found
    assert found.value == 2.3


def between_walls(k: float, b: float) -> tuple[Any, Report]:
    """u″ + (k² (1 + i) − b y) u = σ u at k = 2, b = 1, and a report on three of its modes at k and b."""
    wall = [st.Conditions(at, ["u"]) for at in (0, 1)]
    made = partial(st.equations, ["u"], ["d(u,2) + (k**2*(1 + i) - b*x)*u = sigma*u"], *wall, variable="x")
    modes = st.find(made(parameters={"k": k, "b": b}), st.Disc(complex(k * k - 60.0, k * k), 50.0)).modes
    report = Report(tuple(Verdict(complex(m.sigma), SPURIOUS, "") for m in modes[:3]), (), 6)
    assert len(report.verdicts) == 3
    return made(parameters={"k": 2.0, "b": 1.0}).family, report


def test_two_parameters_that_differ_at_once() -> None:
    family_of, report = between_walls(2.1, 1.5)
    members = {name: partial(lambda name, value: family_of((name,)).problem({name: value}), name) for name in ("k", "b")}
    varied = {"k": Variation(2.0, members["k"]), "b": Variation(1.0, members["b"])}
    searched = other_values(varied, report, 6, together=lambda values: family_of(tuple(values)).problem(values))
    (found,) = searched.found
    assert found.second is not None
    assert (found.parameter, found.value, *found.second[::2]) == ("k", pytest.approx(2.1, rel=1e-4), "b", pytest.approx(1.5, rel=1e-4))
    assert searched.pairs == (("k", "b"),)


def test_a_search_ends_with_its_allowance_and_says_between_which_values_it_looked(monkeypatch: pytest.MonkeyPatch) -> None:
    ticks = count()
    monkeypatch.setattr("shootstab.core.allowance.process_time", lambda: float(next(ticks)))  # every look at the clock is a second
    report = Report(tuple(Verdict(c, SPURIOUS, "") for c in (0.5 + 0.5j, 0.7 + 0.1j)), (), 6)
    allowance = Allowance(20.0)
    searched = other_values({"alpha": Variation(1.0, lambda alpha: PlanePoiseuille(10000.0, alpha, half=False))}, report, 6, allowance)
    assert searched.found == ()
    assert allowance.stopped
    low, high = searched.ranges["alpha"]
    assert 0.8 < low < 1.0 < high < 1.25
