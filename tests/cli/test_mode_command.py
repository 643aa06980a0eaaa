"""`mode`, and the pictures and files of fields: what is written holds what was computed."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

import shootstab as st
from shootstab.cli import figures, mode_plot, plane, plots, steady_command
from shootstab.cli import main as cli
from shootstab.core.records import CONFIRMED, Report, Verdict
from shootstab.core.regions import Disc
from shootstab.io.conventions import Convention

ORSZAG = "0.0037,-0.2375"


def test_mode_says_and_writes_the_same(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    files = [tmp_path / name for name in ("mode.csv", "mode.json", "mode.png")]
    words = ["mode", "poiseuille", "--guess", ORSZAG, "--points", "9", "--export", files[0], "--json", files[1], "--plot", files[2]]
    assert cli.main([str(word) for word in words]) == 0
    said = capsys.readouterr().out
    assert "normalization" in said
    assert "nonnormality" in said
    assert all(len(line) <= 80 for line in said.splitlines())
    document = json.loads(files[1].read_text())
    assert document["error"] < 1e-8
    assert document["scene"]["name"] == "poiseuille"
    rows = list(csv.DictReader(files[0].read_text().splitlines()))
    assert [row["z"] for row in rows] == [repr(z) for z in document["z"]]
    assert [float(row["phi_im"]) for row in rows] == document["fields"]["phi"]["im"]
    found = st.eigenfunction("poiseuille", complex(0.0037, -0.2375))
    u, v = found(np.array(document["z"]))["u"], np.array(document["fields"]["u"]["re"]) + 1j * np.array(document["fields"]["u"]["im"])
    assert np.abs(u - v).max() < 1e-12
    assert files[2].read_bytes().startswith(b"\x89PNG")


BLOCK = """[problem]
equations = ["d(u,2) = sigma*u + w", "d(w,2) = sigma*w"]
unknowns = ["u", "w"]
left = { at = 0, conditions = ["u", "w"] }
right = { at = 1, conditions = ["u", "w"] }
"""


def test_a_multiple_mode_says_its_multiplicities_and_writes_all_its_functions(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene, *files = [tmp_path / name for name in ("block.toml", "mode.csv", "mode.json", "mode.svg")]
    scene.write_text(BLOCK)
    asked = ["mode", str(scene), "--guess", "-9.8", "--rtol", "1e-6", "--points", "5"]
    words = [*asked, "--export", str(files[0]), "--json", str(files[1]), "--plot", str(files[2])]
    assert cli.main(words) == 0
    said = capsys.readouterr().out
    assert "1 independent solution, fewer than 2: defective" in said
    assert all(len(line) <= 80 for line in said.splitlines() if str(tmp_path) not in line)
    document = json.loads(files[1].read_text())
    assert (document["geometric_multiplicity"], document["algebraic_multiplicity"]) == (1, 2)
    rows = list(csv.DictReader(files[0].read_text().splitlines()))
    assert [float(row["w_chain_1_re"]) for row in rows] == document["chain"][0]["fields"]["w"]["re"]
    assert document["chain"][0]["fields"]["w"]["re"] == pytest.approx((-np.sin(np.pi * np.linspace(0, 1, 5))).tolist(), abs=1e-6)
    assert "geometric multiplicity 1, algebraic 2" in files[2].read_text()
    assert cli.main([*asked, "--sensitivity", "x"]) == cli.BAD_INPUT
    assert "allowed for a simple mode" in capsys.readouterr().err


def test_npz_holds_complex_arrays_and_says_what_they_are(tmp_path: Path) -> None:
    path = tmp_path / "mode.npz"
    assert cli.main(["mode", "benard", "--guess", "3.4", "--export", str(path), "--quiet"]) == 0
    with np.load(path) as held:
        assert set(held.files) == {"z", "W", "theta", "about"}
        assert held["W"].shape == held["z"].shape == (401,)
        about = json.loads(str(held["about"]))
    assert about["mode"]["status"] == "converged"
    assert about["scene"] == "benard"


def test_a_guess_without_a_mode_is_bad_news_and_a_wrong_file_name_bad_input(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["mode", "benard", "--guess", "3.4", "--export", "mode.txt"]) == cli.BAD_INPUT
    assert ".csv or .npz" in capsys.readouterr().err
    assert cli.main(["mode", "benard", "--guess", "3.4", "--z", "0,2"]) == cli.BAD_INPUT
    assert "allowed is z from 0 to 1" in capsys.readouterr().err


def test_the_steady_flow_as_named_fields_a_file_and_a_picture(tmp_path: Path) -> None:
    flow = st.scene("mid").flow
    assert flow is not None
    fields = flow.at(np.array([0.0, 1.0]))
    assert fields.nu[0] == pytest.approx(flow.base["nu"], rel=1e-12)
    assert fields.u[0] == pytest.approx(flow.base["u"], rel=1e-12)
    assert float(flow.at(0.0).p) == pytest.approx(flow.hold_up, rel=1e-12)  # p′ = −ν
    slope = (flow.at(1.001).T - flow.at(0.999).T) / 0.002
    assert flow.at(1.0).T_z == pytest.approx(slope, rel=1e-5)
    assert cli.main(["steady", "mid", "--export", str(tmp_path / "flow.csv"), "--points", "5", "--quiet"]) == 0
    rows = list(csv.DictReader((tmp_path / "flow.csv").read_text().splitlines()))
    assert len(rows) == 5
    assert float(rows[0]["nu"]) == pytest.approx(flow.base["nu"], rel=1e-12)
    panels = steady_command.draw(flow, st.scene("mid")).axes
    assert panels[0].lines[0].get_xdata()[0] == pytest.approx(flow.base["nu"], rel=1e-12)


def test_pictures_in_another_style_and_size_with_real_fonts(tmp_path: Path) -> None:
    found, scene = st.eigenfunction("benard", 3.4), st.scene("benard")
    figure = figures.drawn(lambda: mode_plot.draw(found, scene), figures.Look("ggplot", (5.0, 3.0)))
    assert tuple(figure.get_size_inches()) == (5.0, 3.0)
    figures.save(lambda: mode_plot.draw(found, scene), tmp_path / "mode.pdf")
    assert b"/FontFile2" in (tmp_path / "mode.pdf").read_bytes()  # TrueType, and no outlines
    with pytest.raises(st.InputError, match="no such style"):
        figures.require(tmp_path / "mode.pdf", figures.Look("nowhere"))
    with pytest.raises(st.InputError, match="inches"):
        figures.require(tmp_path / "mode.pdf", figures.Look(size=(0.1, 3.0)))


def test_a_layer_that_is_too_thin_to_be_seen_is_magnified() -> None:
    z = np.linspace(0.0, 100.0, 401)
    wide = np.exp(-z / 30.0) + 0j
    low, high = mode_plot.layer(z, {"a": wide, "b": np.exp(-z) + 0j})  # type: ignore[misc]
    assert low == 0.0
    assert 3.0 <= high <= 6.0  # e^{-z} has done 95 % at z = 3
    assert mode_plot.layer(z, {"a": wide, "c": 0.0 * wide}) is None


def test_axes_are_those_of_the_convention_and_growing_modes_are_seen() -> None:
    """A phase speed grows upwards: the line of no growth is Im c = 0, and what is magnified is found by Im c."""
    scene = st.scene("poiseuille").seen(Convention("phase-speed", alpha=1.0))
    growing, decaying = 0.2375 + 0.0037j, 0.9646 - 0.0352j
    report = Report(tuple(Verdict(c, CONFIRMED, "", c, 1e-12) for c in (growing, decaying)), (), 6)
    figure = plots.draw(report, scene)
    assert figure.axes[0].get_xlabel() == "Re c"
    assert plane.growth(scene, np.array([growing, decaying])).tolist() == pytest.approx([0.0037, -0.0352])
    (left, right), (low, high) = figure.axes[-1].get_xlim(), figure.axes[-1].get_ylim()
    assert left < growing.real < right
    assert low < growing.imag < high


def test_a_report_shows_itself(tmp_path: Path) -> None:
    from matplotlib.figure import Figure

    report = st.verify("poiseuille", [complex(0.0037396706, -0.2375264888), 0.1 + 0.1j], missing="none", digits=8)
    assert repr(report) == "Report(1 confirmed, 1 spurious; 8 digits)"
    assert report.bad_news
    assert not st.verify("poiseuille", [complex(0.0037396706, -0.2375264888)], missing="none", digits=8).bad_news
    assert "confirmed" in str(report)
    lines = report.to_markdown().splitlines()
    assert [line.count(" | ") for line in lines if line.startswith("|")] == [6] * 4
    tex = report.to_latex()
    assert tex.count("\\\\") == 3
    assert r"\mathrm{i}$" in tex
    html = report.to_html()
    assert html.count("<tr>") == 3
    axes = Figure().subplots()
    assert report.plot(ax=axes) is axes
    assert len(axes.lines) >= 2
    assert report.plot().axes


def test_a_region_is_drawn_with_its_modes() -> None:
    region = Disc(0.0037 - 0.2375j, 0.01)
    figure = plots.draw_found(st.find("poiseuille", region), region, st.scene("poiseuille"))
    assert "mode (1)" in [text.get_text() for text in figure.legends[0].get_texts()]
    assert len(plots.rim(region)) > 100
