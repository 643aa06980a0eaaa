"""Refusals of the command line that no other test reaches: exit status 2 or 1, and one line that says what is allowed."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

import pytest

from shootstab.cli import main as cli
from shootstab.cli import site
from shootstab.core.errors import OutputError

STRING = """[problem]
unknowns = ["y"]
equations = ["d(y,2) = sigma*y"]
left = { at = 0, conditions = ["y"] }
right = { at = 1, conditions = ["y"] }
"""
ONE_WAY = """[problem]
unknowns = ["u", "v"]
equations = ["d(u) = sigma*u", "d(v) = -sigma*v"]
left = { at = 0, conditions = ["u"] }
right = { at = 1, conditions = ["v"] }
"""

REFUSED: dict[str, tuple[tuple[str, ...], str]] = {
    "baseline of nothing": (("baseline", "record", "STRING", "modes-of-nothing.toml"), "no modes: needed is --guess or --from"),
    "name with a NUL": (("verify", "STRING", "modes\0.txt"), "not the name of a file"),
    "floor of a rectangle": (("count", "STRING", "--region", "disc", "--floor", "1e-6"), "--floor: allowed only with --region half-plane"),
    "site of one topic": (("guide", "scenes", "--site", "DIR"), "guide --site: allowed without a topic, for all of them"),
    "conjugate of a mode": (
        ("mode", "STRING", "--guess=-9.8", "--conjugate"),
        "--conjugate: allowed with verify; here give the conjugate guess",
    ),
    "slopes in digits": (
        ("mode", "STRING", "--guess=-9.8", "--digits", "20", "--sensitivity", "k"),
        "--digits: allowed without --sensitivity, for eigenvalues in the problem's own terms",
    ),
    "an axis twice": (("sweep", "high", "--ky", "0.01:0.02:2", "--over", "ky=0.01:0.02:2"), "ky: given twice: allowed is once"),
    "a wavenumber of nothing": (
        ("verify", "STRING", "CLAIMS", "--alpha", "1"),
        "--alpha, --sign, --length and --velocity: allowed with --as growth, frequency or phase-speed",
    ),
    "an interval about a mode": (
        ("prove", "STRING", "--guess=-9.8", "--over", "k=1,2"),
        "--over: allowed with --region and --growing",
    ),
    "an interval of one end": (
        ("prove", "STRING", "--region=-10,-1,-9,1", "--over", "k=1"),
        "--over k=1: allowed is NAME=LOW,HIGH",
    ),
    "proof of frequencies": (
        ("verify", "STRING", "CLAIMS", "--prove", "--as", "frequency"),
        "--prove: allowed with eigenvalues in the problem's own terms",
    ),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_is_not_allowed_is_said_in_a_line(what: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words, said = REFUSED[what]
    scene, claims = tmp_path / "string.toml", tmp_path / "claims.csv"
    scene.write_text(STRING)
    claims.write_text("-9.8696\n")
    places = {"STRING": scene, "CLAIMS": claims, "DIR": tmp_path / "site"}
    assert cli.main([str(places.get(word, word)) for word in words]) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    assert shown.err.count("\n") == 1
    assert said in shown.err


def test_a_baseline_of_what_is_no_mode_is_not_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene, file = tmp_path / "one_way.toml", tmp_path / "baseline.toml"
    scene.write_text(ONE_WAY)
    assert cli.main(["baseline", "record", str(scene), str(file), "--guess", "0.3"]) == 1
    assert "no mode to 8 digits at " in capsys.readouterr().err
    assert not file.exists()


@pytest.mark.parametrize(
    ("words", "library", "extra"),
    [(("verify", "STRING", "CLAIMS", "--html", "FILE"), "plotly", "report"), (("guide", "--site", "FILE"), "mkdocs", "docs")],
)
def test_a_library_that_is_not_installed_is_named(
    words: tuple[str, ...],
    library: str,
    extra: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    find = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name, *given: None if name == library else find(name, *given))
    scene, claims, file = tmp_path / "string.toml", tmp_path / "claims.csv", tmp_path / "page.html"
    scene.write_text(STRING)
    claims.write_text("-9.8696\n")
    places: dict[str, Any] = {"STRING": scene, "CLAIMS": claims, "FILE": file}
    assert cli.main([str(places.get(word, word)) for word in words]) == 2
    assert f"needs {library}: install it with `pip install 'shootstab[{extra}]'`" in capsys.readouterr().err
    assert not file.exists()


@pytest.mark.filterwarnings("ignore")  # mkdocs' own
def test_a_link_that_leads_nowhere_is_an_error_of_the_site(tmp_path: Path) -> None:
    pytest.importorskip("mkdocs")
    with pytest.raises(OutputError, match=r"site: .*strict mode"):
        site.make({"one": ("One", "# One\n\n[there](nowhere.md)\n")}, tmp_path / "site")
