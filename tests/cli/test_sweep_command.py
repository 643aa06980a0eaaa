"""cli/sweep_command.py and cli/maps.py: what `shootstab sweep` takes, says and writes."""

from __future__ import annotations

import csv
import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from shootstab.analyses.sweep import Swept
from shootstab.analyses.sweep.grid import ParameterAxis
from shootstab.analyses.sweep.outcomes import FOLLOWED, NO_FLOW, NO_WAVE, NONE_GROWS, PROVED, Outcome
from shootstab.analyses.sweep.walk import WalkSettings
from shootstab.cli import main as cli
from shootstab.cli import maps
from shootstab.cli import sweep_command as sweeping
from shootstab.core.records import UNRESOLVED
from shootstab.io.scenes import load
from shootstab.models.chute.chute_problem import ChuteProblem
from shootstab.models.chute.parameter_family import ChuteFamily

KX, KY = (0.0, 5e-4, 1e-3), (0.0, 0.01, 0.02, 0.03)


def outcome(kx: float, ky: float) -> Outcome:
    """Something of everything."""
    if kx == ky == 0.0:
        return Outcome(NO_WAVE)
    if ky == 0.03 and kx == 5e-4:
        return Outcome(NONE_GROWS, below=complex(-1e-3, 2e-4))
    if ky == 0.03:
        return Outcome(NONE_GROWS, kx == 0.0, floor=1e-8, evaluations=100)
    if kx == 1e-3 and ky == 0.0:
        return Outcome(f"{UNRESOLVED}: a mode lies on the boundary")
    sigma = complex(0.004 - (ky - 0.01) ** 2 * 20, -4 * kx)
    return Outcome(PROVED if ky == 0.02 else FOLLOWED, ky == 0.02, sigma, 1e-13, 1e-3 if ky == 0.02 else None, 5)


def swept(kx: tuple[float, ...] = KX, ky: tuple[float, ...] = KY) -> Swept:
    problem: Any = load("poiseuille").problem  # only its place is taken
    family = ChuteFamily(problem, 0.0, 0.01, 7.0, None, None, ChuteProblem)
    return Swept(
        (ParameterAxis("kx", kx), ParameterAxis("ky", ky)), {(a, b): outcome(a, b) for a in kx for b in ky}, WalkSettings(), family
    )


def test_the_command_and_its_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["sweep", "high", "--kx", "0", "--ky=-0.01:0.01:3", "--workers", "1", "--out", str(tmp_path / "a.sqlite")]
    pictures = ["--plot", str(tmp_path / "a.png"), "--export", str(tmp_path / "a.csv")]
    assert cli.main([*words, *pictures, "--json", "-"]) == 0
    said = json.loads(capsys.readouterr().out)
    own = {"axes", "digits", "every", "floor", "summary", "fastest", "points"}
    assert set(said) == own | {"scene", "version", "seconds", "compilation_seconds"}
    assert said["axes"] == {"kx": [0.0], "ky": [-0.01, 0.0, 0.01]}
    assert [p["status"] for p in said["points"]] == ["proved", "no wave", "proved"]
    assert set(said["points"][0]) == {"kx", "ky", "sigma", "error", "status", "proved", "floor", "evaluations", "below"}
    assert abs(float(said["fastest"]["sigma"]["re"]) - 0.003970504639) < 1e-11
    assert (tmp_path / "a.png").stat().st_size > 10_000
    assert cli.main([*words]) == 0  # nothing is done again
    out = capsys.readouterr().out
    assert "3 points: 2 proved, 1 no wave; modes were counted at 2." in out
    assert re.search(r"Fastest growth: σ = 0\.0039705046\d* at kx = 0, ky = (-)?0\.01\.", out)
    assert cli.main([*words, "--digits", "7"]) == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    assert "another sweep, of other digits" in err


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--ky", "0:1"], "A:B:N"),
        (["--ky", "0:1:1"], "N from 2"),
        (["--ky", "1:1:5"], "A other than B"),
        (["--ky", "a:b:5"], "A:B:N"),
        (["--ky", "0.01", "--floor", "1"], "below 0.01"),
        (["--ky", "0.01", "--export", "a.txt"], "ends in .csv or .npz"),
        (["--ky", "0.01", "--plot", "a.png"], "0 parameters vary"),
        (["--ky", "0.01", "--out", "nowhere/a.sqlite"], "no folder"),
        (["--ky", "0.01", "--workers", "0"], "1 to 1024"),
        (["--ky", "0.01", "--workers", "1", "--dask", "x"], "not allowed with"),
        ([], "nothing to sweep over"),
    ],
)
def test_refusals_in_one_line(words: list[str], says: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["sweep", "high", *words]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    assert says in said.err


def test_bad_news_where_a_point_is_unresolved() -> None:
    assert swept().bad_news
    assert swept().summary == {
        PROVED: 3, FOLLOWED: 4, NONE_GROWS: 3, NO_WAVE: 1, NO_FLOW: 0, UNRESOLVED: 1, "counted": 4,
    }  # fmt: skip


def test_csv_and_npz_hold_every_digit(tmp_path: Path) -> None:
    found = swept()
    sweeping.write_csv(found, tmp_path / "a.csv")
    with (tmp_path / "a.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 12
    for row in rows:
        expected = found.outcomes[float(row["kx"]), float(row["ky"])]
        assert row["status"] == expected.status
        for re_, im, number in (("re", "im", expected.sigma), ("below_re", "below_im", expected.below)):
            assert (None if row[re_] == "" else complex(float(row[re_]), float(row[im]))) == number
    sweeping.write_npz(found, tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz") as arrays:
        assert arrays["kx"].tolist() == list(KX)
        assert arrays["re"].shape == arrays["status"].shape == (3, 4)
        assert arrays["re"][1, 1] == outcome(5e-4, 0.01).sigma.real  # type: ignore[union-attr]
        assert np.isnan(arrays["im"][:, 3]).all()
        assert arrays["below_re"][1, 3] == -1e-3
        assert arrays["proved"][0].tolist() == [False, False, True, True]
        assert arrays["status"][2, 0].startswith(UNRESOLVED)


def test_curves_and_maps_show_what_was_proved() -> None:
    scene = load("high")
    curves = maps.draw(swept(kx=(5e-4,)), scene)
    above, below = curves.axes
    assert above.get_ylabel() == "growth rate Re σ / √(g cosθ/d)"
    assert below.get_xlabel() == "cross-slope wavenumber $k_y$ / $d^{-1}$"
    assert "the same, one step below zero" in [t.get_text() for t in above.get_legend().get_texts()]
    assert "dominance proved by a count" in [t.get_text() for t in above.get_legend().get_texts()]
    assert curves.get_suptitle().startswith("high: kx = 0.0005\nfastest growth: σ = 0.004 - 0.002i at kx = 0.0005, ky = 0.01")
    panel, bar = maps.draw(swept(), scene).axes
    assert panel.get_xlabel() == "downslope wavenumber $k_x$ / $d^{-1}$"
    assert bar.get_ylabel() == "growth rate Re σ / √(g cosθ/d)"
    assert [t.get_text() for t in panel.get_legend().get_texts()] == ["no flow, or unresolved", "modes counted"]


def test_parameters_of_equations_are_called_what_they_are_called_there() -> None:
    """r and e are names of the chute's own parameters, which are not meant."""
    found = swept()
    renamed = tuple(replace(axis, name=name) for axis, name in zip(found.axes, ("r", "e"), strict=True))
    panel = maps.draw(Swept(renamed, found.outcomes, found.settings, found.family), load("eady")).axes[0]
    assert (panel.get_xlabel(), panel.get_ylabel()) == ("r", "e")


def test_a_map_of_nothing_is_drawn_too(tmp_path: Path) -> None:
    quiet = swept(ky=(0.03, 0.031))
    still = Swept(quiet.axes, dict.fromkeys(quiet.outcomes, Outcome(NONE_GROWS, True)), quiet.settings, quiet.family)
    maps.save(still, load("high"), tmp_path / "a.svg")
    assert b"nothing grows" in (tmp_path / "a.svg").read_bytes() or (tmp_path / "a.svg").stat().st_size > 3000


def test_the_edge_of_growth_lies_where_growth_rates_lead() -> None:
    """1 − x² − y² on a grid of h = 0.1: a line on is 2h² off, the edge by that over the slope; what is not known is not continued.

    Where modes were followed below zero the edge is off by an eighth of that.
    """
    x = np.linspace(-1.45, 1.45, 30)
    growth = 1.0 - x[:, None] ** 2 - x[None, :] ** 2
    nothing = np.zeros(growth.shape, dtype=bool)
    grows, unknown = np.where(growth > 0.0, growth, np.nan), np.full(growth.shape, np.nan)
    seen = maps.continued(grows, unknown, nothing)
    better = maps.continued(grows, np.where(growth > -0.3, growth, np.nan), nothing)
    assert (seen[growth > 0.0] == growth[growth > 0.0]).all()
    for i in range(8, 22):  # lines that cross the circle steeply
        j = int(np.flatnonzero(seen[i] > 0.0)[-1])
        exact = np.sqrt(1.0 - x[i] ** 2)
        for values, off in ((seen, 2.0 * 0.1**2), (better, 0.25 * 0.1**2)):
            edge = x[j] + 0.1 * values[i, j] / (values[i, j] - values[i, j + 1])
            assert abs(edge - exact) < off / (2.0 * exact)
    assert (maps.continued(grows, unknown, ~nothing)[growth <= 0.0] == 0.0).all()
