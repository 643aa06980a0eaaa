"""The command line and what it is made of: what is asked, answered, refused, and with which exit status."""

from __future__ import annotations

import json
import math
import os
import re
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from shootstab.analyses.cut_region import RegionCount
from shootstab.cli import main as cli
from shootstab.cli import tables, terminal
from shootstab.core.errors import ConvergenceError, InputError, OutputError
from shootstab.core.records import (
    CONFIRMED,
    CONTINUUM,
    CONVERGED,
    INACCURATE,
    SPURIOUS,
    UNRESOLVED,
    VERDICTS,
    Budget,
    Mode,
    Report,
    Verdict,
)
from shootstab.core.regions import Disc, Rectangle
from shootstab.io import documents, files
from shootstab.io.scenes import Scene, built_in, load

EXE = Path(sys.executable).with_name("shootstab")
HIGH = 0.003970504638889  # the unstable mode of `high`; 0.00397 in the paper
POISEUILLE = 0.0037396706229794 - 0.2375264888204701j  # σ = −iαc, Orszag 1971, with more digits
SCENE = "[flow]\ne = 0.8\ne_w = 0.8\nr = 0.6\ntan_theta = 0.3\nfar_temperature = 7.0\n[wave]\nkx = 0.0\nky = 0.01\n"

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    """Run a command in this process: exit status, standard output, standard error."""

    def command(*words: object) -> tuple[int, str, str]:
        try:
            status = cli.main([str(w) for w in words])
        except SystemExit as left:  # --help and --version
            status = int(left.code or 0)
        said = capsys.readouterr()
        return status, said.out, said.err

    return command


def refused(outcome: tuple[int, str, str], *words: str) -> None:
    """Exit status 2, one line on standard error that says these words, and nothing else anywhere."""
    status, out, err = outcome
    assert status == cli.BAD_INPUT
    assert out == ""
    assert re.fullmatch(r"shootstab: [^\n]+\n", err)
    for word in words:
        assert word in err


def number(pair: dict[str, str]) -> complex:
    assert set(pair) == {"re", "im"}
    assert all(isinstance(part, str) for part in pair.values())
    return complex(float(pair["re"]), float(pair["im"]))


# the answers


def test_refine(run: Run) -> None:
    status, out, err = run("refine", "high", "--guess", "0.004", "--json", "-")
    answer = json.loads(out)
    assert (status, err) == (0, "")
    keys = {"sigma", "error", "budget", "digits", "status", "method", "evaluations", "seconds"}
    assert keys <= answer.keys()
    assert answer["budget"].keys() == {"integration", "far_field", "steady_flow", "root", "rounding"}
    assert answer["status"] == CONVERGED
    assert answer["method"] == "frame"
    assert answer["error"] == pytest.approx(sum(answer["budget"].values()))
    assert abs(number(answer["sigma"]) - HIGH) <= answer["error"] + 1e-15


@pytest.mark.parametrize("guess", [["--guess=-0.0035,-0.0071"], ["--guess", "-0.0035,-0.0071"], ["--guess", "-0.0035 - 0.0071i"]])
def test_negative_guesses_in_every_form(run: Run, guess: list[str]) -> None:
    status, out, _ = run("refine", "fig2", *guess, "--rtol", "1e-8", "--json", "-")
    assert status == 0
    assert number(json.loads(out)["sigma"]) == pytest.approx(-0.003503295669 - 0.00708789982j, rel=1e-8)


def test_refine_shows_only_digits_that_hold(run: Run) -> None:
    status, out, _ = run("refine", "poiseuille", f"--guess={POISEUILLE.real:.4f},{POISEUILLE.imag:.4f}", "--method", "frame")
    assert status == 0
    shown = re.search(r"σ +(\d\.\d+) - (\d\.\d+)i\n", out)
    bound = re.search(r"error +(\S+) ", out)
    assert shown
    assert bound
    sigma = complex(float(shown[1]), -float(shown[2]))
    unit = 10.0 ** -len(shown[1].partition(".")[2])
    assert float(bound[1]) <= unit
    assert abs(sigma - POISEUILLE) <= 2 * unit
    assert len(shown[1]) == len(shown[2])
    assert not re.search(r" $", out, re.MULTILINE)


@pytest.mark.parametrize(
    ("region", "count"),
    [
        (["rectangle", "--corners=1e-4,-0.1,0.05,0.1"], 1),
        (["disc", "--centre=0.004,0", "--radius=1e-3"], 1),
        (["disc", "--centre", "0.02,0", "--radius", "1e-3"], 0),
    ],
)
def test_count(run: Run, region: list[str], count: int) -> None:
    status, out, _ = run("count", "high", "--region", *region, "--json", "-")
    answer = json.loads(out)
    assert status == 0
    assert answer["count"] == count
    assert answer["region"]["shape"] == region[0]
    assert f"{count} mode" in run("count", "high", "--region", *region)[1]


@pytest.mark.parametrize(
    "region",
    [
        ["--corners=0.001,-0.003,0.003,0.001"],
        ["--region=disc", "--centre=0.0017,-0.0016", "--radius=3e-4"],
        ["--region=polygon", "--corners=0.0012,-0.002,0.0022,-0.002,0.0017,-0.001"],
    ],
)
def test_find(run: Run, region: list[str]) -> None:
    status, out, _ = run("find", "fig2", *region, "--json", "-")
    (mode,) = json.loads(out)["modes"]
    assert status == 0
    assert float(mode["sigma"]["re"]) == pytest.approx(0.0016924312039, abs=1e-10)
    assert mode["multiplicity"] == 1
    if "--region=disc" in region:
        shown = run("find", "fig2", *region)[1]
        assert any(line.split()[-2:] == ["times", "continuum"] for line in shown.splitlines())
        assert "1 mode inside the disc" in shown
        assert "closed to" in shown


def test_count_that_cannot_be_done_is_bad_news(run: Run) -> None:
    # an end of the continuous spectrum lies next to the boundary of the region
    status, out, err = run("count", "high", "--region", "disc", "--centre=9.99999e-4,0", "--radius=1e-3")
    assert (status, out) == (1, "")
    assert re.fullmatch(r"shootstab: [^\n]*continuous spectrum[^\n]*\n", err)


def test_steady(run: Run, tmp_path: Path) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(SCENE)
    status, out, err = run("steady", scene, "--json", "-")
    answer = json.loads(out)
    assert (status, err) == (0, "")
    assert answer["far_temperature"] == 7.0
    assert answer["base"].keys() == {"nu", "T", "u"}
    profiles = {name: np.array(values) for name, values in answer["profiles"].items()}
    assert profiles.keys() == {"z", "nu", "u", "T", "p", "q", "nu_z", "u_z", "T_z"}
    assert [profiles[name][0] for name in ("z", "nu", "T", "u")] == [0.0, *answer["base"].values()]
    # M0 = ∫ν dz, Q0 = ∫νu dz, h0 M0 = ∫νz dz, by Simpson's rule on the profiles
    z, nu, u = (profiles[name] for name in ("z", "nu", "u"))
    weights = np.ones(len(z))
    weights[1:-1:2], weights[2:-1:2] = 4, 2
    weights *= (z[1] - z[0]) / 3
    for name, integrand in (("hold_up", nu), ("mass_flux", nu * u)):
        assert answer[name] == pytest.approx(weights @ integrand, rel=2e-4)
    assert answer["centre_of_mass"] == pytest.approx(weights @ (nu * z) / answer["hold_up"], rel=1e-3)


def test_steady_needs_a_flow(run: Run) -> None:
    refused(run("steady", "poiseuille"), "poiseuille", "[flow]")


def test_steady_table(run: Run) -> None:
    status, out, _ = run("steady", "high")
    assert status == 0
    assert re.search(r"mass flux Q0 +3\.00000000000\n", out)
    assert len(re.findall(r"^ *\d\S* +\S+ +\S+ +\S+$", out, re.MULTILINE)) == 11


def test_scenes(run: Run) -> None:
    status, out, _ = run("scenes")
    assert status == 0
    assert [line.split()[0] for line in out.splitlines() if line[0] != " "] == list(built_in())
    assert "whole channel -1 < y < 1, both parities; order 4" in " ".join(out.split())
    assert max(map(len, out.splitlines())) <= tables.PAGE
    status, out, _ = run("scenes", "--json", "-")
    assert [scene["name"] for scene in json.loads(out)["scenes"]] == list(built_in())
    assert all(scene["order"] and scene["symmetry"] and scene["unknowns"] and scene["eigenvalue"] for scene in json.loads(out)["scenes"])


def test_spectrum(run: Run) -> None:
    status, out, _ = run("spectrum", "high", "-M", "60", "--json", "-")
    answer = json.loads(out)
    assert status == 0
    assert answer["truncation"] == 60
    sigmas = [number(pair) for pair in answer["eigenvalues"]]
    assert min(abs(s - HIGH) for s in sigmas) < 1e-6
    assert len(sigmas) == len(answer["drift"]) == len(answer["tail"])
    assert "raw" not in answer
    status, out, _ = run("spectrum", "high", "-M", "60", "--raw", "--json", "-")
    assert len(json.loads(out)["raw"]) > len(sigmas)


def test_a_spectrum_in_phase_speeds(run: Run, tmp_path: Path) -> None:
    words = ("spectrum", "poiseuille", "-M", "60", "--as", "phase-speed")
    status, out, _ = run(*words, "--json", "-")
    said = json.loads(out)
    assert status == 0
    first = complex(float(said["eigenvalues"][0]["re"]), float(said["eigenvalues"][0]["im"]))
    assert abs(first - (0.23752649 + 0.00373967j)) < 1e-8  # Orszag (1971)
    assert said["convention"]
    (tmp_path / "c.json").write_text(out)
    assert run("verify", "poiseuille", str(tmp_path / "c.json"), "--as", "phase-speed", "--digits", "5", "--missing", "none")[0] == 0
    assert float(said["drift"][0]) > 0.0
    _, out, _ = run(*words, "--conjugate", "--json", "-")
    assert json.loads(out)["eigenvalues"][0]["im"].startswith("-0.00373967")


def test_spectrum_table(run: Run) -> None:
    for raw in ([], ["--raw"]):
        status, out, _ = run("spectrum", "high", "-M", "40", *raw)
        assert status == 0
        assert "0.00397" in out
        assert "truncation 40" in out


def test_a_spectrum_written_is_a_spectrum_read(run: Run, tmp_path: Path) -> None:
    from shootstab.io import readers

    path = tmp_path / "spectrum.json"
    assert run("spectrum", "poiseuille", "-M", "60", "--json", path)[0] == 0
    sigmas = readers.read(path)
    assert np.abs(np.asarray(sigmas) - POISEUILLE).min() < 1e-8


# verify


@pytest.fixture
def modes(tmp_path: Path) -> Path:
    path = tmp_path / "modes.csv"
    path.write_text("re,im\n0.0039705046,0\n0.002,0.003\n")
    return path


def test_verify(run: Run, modes: Path) -> None:
    status, out, err = run("verify", "high", modes, "--json", "-")
    answer = json.loads(out)
    assert (status, err) == (1, "")
    assert {"verdicts", "missing", "summary"} <= answer.keys()
    right, wrong = answer["verdicts"]
    for verdict in (right, wrong):
        assert {"claimed", "verdict", "sigma", "error", "digits_agreed", "why"} <= verdict.keys()
    assert (right["verdict"], wrong["verdict"]) == (CONFIRMED, SPURIOUS)
    assert number(right["claimed"]) == 0.0039705046
    assert number(right["sigma"]) == pytest.approx(HIGH, rel=1e-9)
    assert right["digits_agreed"] == pytest.approx(8.0, abs=0.3)
    assert answer["summary"].keys() == {*VERDICTS, "missing"}
    assert answer["summary"]["confirmed"] == answer["summary"]["spurious"] == 1


def test_verify_table_and_plot(run: Run, tmp_path: Path, modes: Path) -> None:
    status, out, err = run("verify", "high", modes, "--plot", tmp_path / "plane.png", "--json", tmp_path / "answer.json")
    assert (status, err) == (1, "")
    assert re.search(r"1 +0\.0039705046 +confirmed +0\.00397050\d+ +\d\.\de-\d\d +[78]\.\d\n", out)
    assert re.search(r"\n +2 +spurious: [^\n]+\n", out)
    assert "1 of 2 eigenvalues confirmed to 6 digits, 1 spurious" in out
    assert (tmp_path / "plane.png").read_bytes().startswith(b"\x89PNG")
    assert json.loads((tmp_path / "answer.json").read_text())["summary"]["confirmed"] == 1


def test_verify_the_bundled_reference(run: Run) -> None:
    status, out, _ = run("verify", "poiseuille", "-M", "60", "--json", "-")
    answer = json.loads(out)
    found = [number(v["sigma"]) for v in answer["verdicts"] if v["verdict"] == CONFIRMED]
    assert min(abs(s - POISEUILLE) for s in found) < 1e-9
    assert status == int(any(answer["summary"][bad] for bad in (INACCURATE, SPURIOUS, UNRESOLVED, "missing")))


def test_a_mode_that_a_region_holds_and_the_file_does_not(run: Run, tmp_path: Path) -> None:
    claims = tmp_path / "claims.txt"
    claims.write_text("0.02\n")
    status, out, _ = run("verify", "high", claims, "--region=1e-3,-1e-3,0.01,1e-3", "--json", "-")
    (missing,) = json.loads(out)["missing"]
    assert status == 1
    assert number(missing["sigma"]) == pytest.approx(HIGH, rel=1e-9)
    assert missing["error"] < 1e-8


# bad input


BAD_SCENES = {
    "unknown key": (SCENE.replace("r = 0.6", "r = 0.6\nrough = 1"), "rough"),
    "missing key": (SCENE.replace("r = 0.6\n", ""), "lacks the key r"),
    "e > 1": (SCENE.replace("e = 0.8", "e = 1.8", 1), "e = 1.8"),
    "r >= 1": (SCENE.replace("r = 0.6", "r = 1"), "r = 1"),
    "tan_theta <= 0": (SCENE.replace("0.3", "0"), "tan_theta = 0"),
    "kx = ky = 0": (SCENE.replace("0.01", "0"), "kx = 0"),
    "broken TOML": (SCENE + "ky =", "broken TOML"),
}
COMMANDS: dict[str, list[str]] = {
    "verify": [],
    "refine": ["--guess=0.004"],
    "count": ["--region=disc", "--centre=0,0", "--radius=1"],
    "steady": [],
    "spectrum": [],
}


@pytest.mark.parametrize("what", BAD_SCENES)
def test_bad_scenes(run: Run, tmp_path: Path, what: str) -> None:
    text, word = BAD_SCENES[what]
    path = tmp_path / "bad.toml"
    path.write_text(text)
    for command, options in COMMANDS.items():
        refused(run(command, path, *options, "--json", tmp_path / "answer.json"), str(path), word)
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("command", COMMANDS)
def test_no_such_scene(run: Run, command: str) -> None:
    refused(run(command, "nowhere", *COMMANDS[command]), "nowhere", "high, mid, low")


@pytest.mark.parametrize(
    ("content", "word"),
    [
        (None, "No such file"),
        ("", "empty"),
        ("re,im\n", "no eigenvalue"),
        ("re,im\n1,2\n1,x\n", "line 3"),
        ("0,inf\n", "all 1 entries"),
        ("1,2,3\n", "line 1"),
    ],
)
def test_bad_eigenvalue_files(run: Run, tmp_path: Path, content: str | None, word: str) -> None:
    path = tmp_path / "claims.csv"
    if content is not None:
        path.write_text(content)
    answer, plot = tmp_path / "answer.json", tmp_path / "plane.png"
    refused(run("verify", "high", path, "--json", answer, "--plot", plot), str(path), word)
    assert not answer.exists()
    assert not plot.exists()


BAD_WORDS = {
    "no such command": (["prooove", "high"], "'prooove'"),
    "nearly a command": (["verfy", "high"], "did you mean verify?"),
    "nearly an option": (["verify", "high", "--digts", "5"], "did you mean --digits?"),
    "nearly a method": (["refine", "high", "--guess=1", "--method=ricati"], "did you mean riccati?"),
    "nearly a verdict": (["verify", "high", "--only=suprious"], "did you mean spurious?"),
    "no scene": (["verify"], "SCENE"),
    "no such option": (["verify", "high", "--digit", "5"], "--digit"),
    "no guess": (["refine", "high"], "--guess"),
    "guess is a word": (["refine", "high", "--guess", "big"], "'big'"),
    "guess is nan": (["refine", "high", "--guess", "nan"], "'nan'"),
    "guess of three": (["refine", "high", "--guess=1,2,3"], "'1,2,3'"),
    "guess is empty": (["refine", "high", "--guess="], "--guess"),
    "rtol = 0": (["refine", "high", "--guess=1", "--rtol=0"], "1e-14"),
    "rtol < 0": (["refine", "high", "--guess=1", "--rtol", "-1e-8"], "1e-14"),
    "two accuracies": (["refine", "high", "--guess=1", "--rtol=1e-8", "--digits=8"], "not allowed with"),
    "no such method": (["refine", "high", "--guess=1", "--method=magic"], "'magic'"),
    "no digits": (["verify", "high", "--digits=0"], "1 to 12"),
    "half a digit": (["verify", "high", "--digits=1.5"], "1 to 12"),
    "too many digits": (["verify", "high", "--digits=13"], "1 to 12"),
    "arabic digits": (["verify", "high", "--digits=٣"], "1 to 12"),
    "M = 0": (["spectrum", "poiseuille", "-M", "0"], "M = 0"),
    "no region": (["count", "high"], "--region"),
    "no disc to find in": (["find", "high", "--region=disc", "--centre=0,0"], "--radius"),
    "nothing to find in": (["find", "high"], "--corners"),
    "no such region": (["count", "high", "--region=star"], "'star'"),
    "no corners": (["count", "high", "--region=rectangle"], "--corners"),
    "no radius": (["count", "high", "--region=disc", "--centre=0,0"], "--radius"),
    "corners of a disc": (["count", "high", "--region=disc", "--corners=0,0,1,1", "--centre=0,0", "--radius=1"], "no other"),
    "corners the wrong way": (["count", "high", "--region=rectangle", "--corners=1,1,0,0"], "lower left first"),
    "three corners": (["count", "high", "--region=rectangle", "--corners=1,1,0"], "RE,IM pairs"),
    "infinite corners": (["count", "high", "--region=rectangle", "--corners=0,0,inf,1"], "finite numbers"),
    "radius < 0": (["count", "high", "--region=disc", "--centre=0,0", "--radius=-1"], "above 0"),
    "plot of unknown kind": (["verify", "high", "--plot=plane.gif"], ".png, .pdf or .svg"),
    "plot nowhere": (["verify", "high", "--plot=/nowhere/plane.png"], "/nowhere"),
    "json nowhere": (["steady", "high", "--json=/nowhere/answer.json"], "/nowhere"),
    "json is a folder": (["steady", "high", "--json=/"], "folder"),
    "M of another's spectrum": (["verify", "high", "claims.csv", "-M", "60"], "-M"),
    "region of verify": (["verify", "high", "--region=1,1,0,0"], "lower left first"),
}


@pytest.mark.parametrize("what", BAD_WORDS)
def test_bad_words(run: Run, what: str) -> None:
    words, said = BAD_WORDS[what]
    refused(run(*words), said)


def test_no_reference_for_a_problem_of_the_users_own(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "own_without_reference.py").write_text(
        "from shootstab.models.gallery.poiseuille import PlanePoiseuille\n"
        "class Mine:\n"
        "    def __getattr__(self, name):\n"
        "        return getattr(PlanePoiseuille(), name)\n"
        "problem = Mine()\n"
        "for name in ('size', 'decaying', 'pencil', 'start', 'far_frame', 'mesh', 'wall_rows', 'continuum'):\n"
        "    getattr(problem, name)\n"
    )
    monkeypatch.chdir(tmp_path)
    refused(run("spectrum", "own_without_reference:problem"), "reference")


def test_without_matplotlib(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    from shootstab.cli import figures

    monkeypatch.setattr(figures.importlib.util, "find_spec", lambda name: None)
    refused(run("verify", "high", "--plot", "plane.png"), "matplotlib", "shootstab[plot]")


# bad ends


def failing(error: BaseException) -> Callable[..., Any]:
    def fail(*_: object, **__: object) -> None:
        raise error

    return fail


@pytest.mark.parametrize(
    ("error", "status", "said"),
    [
        (ConvergenceError("nothing\nfound"), 1, "shootstab: nothing found\n"),
        (InputError("never"), 2, "shootstab: never\n"),
        (OutputError("full"), 4, "shootstab: full\n"),
        (KeyboardInterrupt(), 130, "shootstab: interrupted\n"),
    ],
)
def test_a_question_that_fails(
    run: Run, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, error: BaseException, status: int, said: str
) -> None:
    monkeypatch.setattr("shootstab.analyses.refine.refine", failing(error))
    assert run("refine", "poiseuille", "--guess=1", "--json", tmp_path / "answer.json") == (status, "", said)
    assert not (tmp_path / "answer.json").exists()


def test_an_error_of_the_program_is_one_line_and_a_file(run: Run, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("shootstab.analyses.refine.refine", failing(TypeError("a bug\nof ours")))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    status, out, err = run("refine", "poiseuille", "--guess=1")
    assert (status, out) == (3, "")
    place = re.fullmatch(r"shootstab: internal error: TypeError: a bug of ours \(the traceback is in (\S+)\)\n", err)
    assert place is not None
    assert "Traceback" in Path(place[1]).read_text()


def test_a_full_disk_is_no_bad_news_of_the_spectrum() -> None:
    for words in (["scenes"], ["scenes", "--json", "/dev/full"]):
        with Path("/dev/full").open("w") as full:
            done = subprocess.run([str(EXE), *words], stdout=full, stderr=subprocess.PIPE, text=True, timeout=60, check=False)
        assert (done.returncode, done.stderr.count("\n")) == (4, 1), done.stderr


def test_nothing_at_all_shows_three_doors_and_every_help_an_example(run: Run) -> None:
    status, out, err = run()
    assert (status, err) == (0, "")
    assert len(re.findall(r" shootstab (verify|refine|count) ", out)) == 3
    for command in ("verify", "refine", "count", "find", "steady", "spectrum", "sweep", "trade", "scenes", "guide"):
        status, out, _ = run(command, "--help")
        assert status == 0
        assert f"example: shootstab {command}" in out
        assert "exit status: 0 no bad news; 1 bad news" in out


def test_quiet_says_nothing_and_writes_what_was_asked(run: Run, modes: Path, tmp_path: Path) -> None:
    assert run("verify", "high", modes, "--quiet", "--json", tmp_path / "a.json") == (1, "", "")
    assert json.loads((tmp_path / "a.json").read_text())["summary"]["spurious"] == 1


def test_rows_are_chosen_and_sorted_and_keep_their_numbers(fake: Scene, capsys: pytest.CaptureFixture[str]) -> None:
    found = report_of(CONFIRMED, SPURIOUS, CONTINUUM, INACCURATE, CONFIRMED, UNRESOLVED)
    for only, sort, numbers in (
        (None, None, [1, 2, 3, 4, 5, 6]),
        ("bad", None, [2, 4, 6]),
        (CONFIRMED, None, [1, 5]),
        (None, "verdict", [1, 5, 4, 2, 3, 6]),
        ("bad", "digits", [2, 6, 4]),
    ):
        table: Any = tables.report(found, fake, only, sort)[1]
        assert [int(cell) for cell in table.columns[0].cells] == numbers


def test_wide_tables_fit_a_page_and_cut_no_digit(capsys: pytest.CaptureFixture[str]) -> None:
    sigma = -0.117583166744123 + 0.030124815001456j
    verdict = Verdict(sigma, CONFIRMED, "", sigma, 1e-14, 12.0)
    terminal.show(tables.report(Report((verdict,), (), 12), load("low")))
    out = capsys.readouterr().out
    assert "-0.11758316674412 + 0.03012481500146i" in out
    assert max(map(len, out.splitlines())) <= tables.PAGE


def test_a_log_hears_a_heartbeat(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(terminal, "HEARTBEAT", 0.05)
    monkeypatch.setattr(sys, "stderr", sys.__stderr__)
    with terminal.progress("work") as told:
        assert told is not None
        told(3, 7)
        time.sleep(0.3)
    assert "shootstab: work, 42 %, 0 s\n" in capfd.readouterr().err


def test_a_mode_that_did_not_converge_is_bad_news(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    unknown = Budget(*(5 * [float("inf")]))
    lost = Mode(0.5 + 0j, float("inf"), unknown, "not converged: it wanders", "frame", 7, 0.1)
    monkeypatch.setattr("shootstab.analyses.refine.refine", lambda *_, **__: lost)
    status, out, _ = run("refine", "poiseuille", "--guess=1", "--json", "-")
    answer = json.loads(out)
    assert status == 1
    assert answer["status"] == "not converged: it wanders"
    assert answer["error"] is None
    assert set(answer["budget"].values()) == {None}
    assert "it wanders" in run("refine", "poiseuille", "--guess=1")[1]


def report_of(*said: str, missing: int = 0) -> Report:
    mode = Mode(0.5 + 1e-3j, 1e-9, Budget(1e-9, 0, 0, 0, 0), CONVERGED, "frame", 5, 0.1)
    known = (CONFIRMED, INACCURATE)
    verdicts = [
        Verdict(0.25j, s, f"[why] {s}", 0.25j if s in known else None, 1e-9 if s in known else None, 6.5 if s in known else None)
        for s in said
    ]
    return Report(tuple(verdicts), missing * (mode,), 6, "in a box", ("a corner",), region=Rectangle(0, 1 + 1j))


@pytest.mark.parametrize(
    ("report", "strict", "status"),
    [
        (report_of(), False, 0),
        (report_of(CONFIRMED, CONTINUUM), False, 0),
        (report_of(CONFIRMED, CONTINUUM), True, 1),
        (report_of(CONFIRMED), True, 0),
        (report_of(CONFIRMED, INACCURATE), False, 1),
        (report_of(SPURIOUS), False, 1),
        (report_of(UNRESOLVED), False, 1),
        (report_of(CONFIRMED, missing=1), False, 1),
    ],
)
def test_exit_status_of_verify(run: Run, monkeypatch: pytest.MonkeyPatch, modes: Path, report: Report, strict: bool, status: int) -> None:
    monkeypatch.setattr("shootstab.analyses.verify.verify", lambda *_, **__: report)
    found, out, _ = run("verify", "poiseuille", modes, *(["--strict"] if strict else []))
    assert found == status
    for verdict in report.verdicts:
        assert verdict.verdict in out
        assert (f"[why] {verdict.verdict}" in out) == (verdict.verdict != CONFIRMED)
    assert ("missing  0.500000000 + 0.001000000i  1.0e-09" in re.sub(" +", "  ", out).replace("  +  ", " + ")) == bool(report.missing)
    assert f"In a box: {'1 mode is' if report.missing else 'no mode is'} missing." in " ".join(out.split())
    assert "not searched: a corner" in out


def test_agreement_says_no_more_than_the_error_of_the_mode_lets_it(fake: Scene) -> None:
    verdicts = [Verdict(0.5, CONFIRMED, "", 0.5, 1e-9, agreed) for agreed in (99.0, -math.log10(2e-9), 8.5)]
    table: Any = tables.report(Report(tuple(verdicts), (), 6), fake)[1]
    assert list(table.columns[-1].cells) == ["≥8.7", "≥8.7", "8.5"]


@pytest.fixture(scope="module")
def fake() -> Scene:
    return load("poiseuille")


# documents and files


def test_documents_hold_no_number_that_json_does_not_know() -> None:
    text = documents.text({"a": np.float64("nan"), "b": [np.float64("inf"), 1, True, None, "x"], "c": (np.float64(0.1),)})
    assert json.loads(text) == {"a": None, "b": [None, 1, True, None, "x"], "c": [0.1]}


def test_regions_in_json() -> None:
    end = Disc(0j, 1e-5)
    assert documents.count(Disc(1j, 2.0), RegionCount(3, 1e-9, (end,), 99)) == {
        "region": {"shape": "disc", "centre": {"re": "0.0", "im": "1.0"}, "radius": 2.0, "bounds": pytest.approx([-2, -1, 2, 3])},
        "count": 3,
        "closure": 1e-9,
        "left_out": [{"shape": "disc", "centre": {"re": "0.0", "im": "0.0"}, "radius": 1e-5}],
        "evaluations": 99,
    }
    assert documents.count(Rectangle(0j, 1 + 1j), RegionCount(0, 0.0, (), 9))["region"]["shape"] == "rectangle"


def test_a_file_is_written_whole_or_not_at_all(tmp_path: Path) -> None:
    path = tmp_path / "answer.json"
    path.write_text("old")

    def half(target: Path) -> None:
        target.write_text("ha")
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        files.write_whole(path, half)
    assert path.read_text() == "old"

    def full(target: Path) -> None:
        target.write_text("ha")
        raise OSError(28, "No space left on device")

    with pytest.raises(OutputError, match="No space left"):
        files.write_whole(path, full)
    assert path.read_text() == "old"
    files.write_whole(path, lambda target: target.write_text("new"))
    assert path.read_text() == "new"
    assert list(tmp_path.iterdir()) == [path]


def test_a_link_stays_a_link(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(tmp_path / "target")
    files.write_whole(tmp_path / "link", lambda target: target.write_text("new"))
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "target").read_text() == "new"


def test_a_device_is_written_to_and_not_replaced(run: Run) -> None:
    status, _, _ = run("scenes", "--json", os.devnull)
    assert status == 0
    assert not Path(os.devnull).is_file()


def test_json_beside_the_table(run: Run, tmp_path: Path) -> None:
    status, out, _ = run("steady", "high", "--json", tmp_path / "answer.json")
    assert status == 0
    assert "mass flux" in out
    assert json.loads((tmp_path / "answer.json").read_text())["mass_flux"] == pytest.approx(3.0)


# the terminal


def test_progress_is_for_terminals_only(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    with terminal.progress("work") as told:
        assert told is None
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    with terminal.progress("work") as told:
        assert told is not None
        told(1, 2)
        told(2, 2)
    assert capsys.readouterr().out == ""


def test_a_terminal_gets_colours_and_whole_lines(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], fake: Scene) -> None:
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.setenv("COLUMNS", "40")
    monkeypatch.delenv("NO_COLOR", raising=False)
    terminal.show(tables.report(report_of(CONFIRMED, SPURIOUS, missing=1), fake))
    out = capsys.readouterr().out
    assert "\x1b[32mconfirmed\x1b[0m" in out
    plain = re.sub(r"\x1b\[[\d;]*m", "", out)
    assert re.search(r"1 +0 \+ 0\.25000000i +confirmed +0 \+ 0\.250000000i +1\.0e-09 +6\.5", plain)


# as a program


def program(*words: object, **options: Any) -> subprocess.CompletedProcess[str]:
    return subprocess.run([str(EXE), *map(str, words)], capture_output=True, text=True, timeout=120, check=False, **options)


@pytest.mark.parametrize("words", [["--help"], ["scenes"], ["verify", "--help"], ["--version"]])
def test_what_needs_no_numbers_loads_none(words: list[str]) -> None:
    """It starts at once because nothing heavy is imported; how long that takes, validation/bench_startup.py measures."""
    done = program(*words)
    assert (done.returncode, done.stderr) == (0, "")
    code = (
        "import sys; from shootstab.cli.main import main\n"
        "try:\n"
        f"    main({words!r})\n"
        "except SystemExit: pass\n"
        "print([m for m in ('numpy', 'scipy', 'numba', 'rich', 'mpmath', 'matplotlib', 'sympy') if m in sys.modules], file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    assert done.stderr == "[]\n"


def test_the_program_refuses_in_one_line(tmp_path: Path) -> None:
    done = program("verify", "nowhere", cwd=tmp_path)
    refused((done.returncode, done.stdout, done.stderr), "nowhere")


def test_a_reader_that_goes_away(tmp_path: Path) -> None:
    done = subprocess.run(
        ["bash", "-c", f"'{EXE}' scenes | true; echo ${{PIPESTATUS[0]}}"], capture_output=True, text=True, timeout=60, check=True
    )
    assert done.stderr == ""
    assert done.stdout.strip() in ("0", "141")  # as quick as `true`, or not


def test_a_terminal_without_greek() -> None:
    done = program("steady", "high", env={**os.environ, "PYTHONIOENCODING": "ascii"})
    assert (done.returncode, done.stderr) == (0, "")
    assert "mass flux Q0" in done.stdout


def test_many_digits_are_printed_as_they_are() -> None:
    """A minus sign costs no digit, whatever precision mpmath is set to."""
    import mpmath

    from shootstab.io.notation import held_complex

    text = "0.2375264888204701074465793134634397576781279780924"
    with mpmath.workdps(60):
        sigma = mpmath.mpc("0.00373967062297940993222076606301675", "-" + text)
    assert held_complex(sigma, 1e-40) == "0.0037396706229794099322207660630167500000 - 0.2375264888204701074465793134634397576781i"
    mode = Mode(sigma, 1e-40, Budget(0, 0, 0, 0, 1e-40), "converged", "taylor", 1, 0.1)
    assert documents.mode(mode)["sigma"]["im"].startswith("-" + text[:40])


def test_that_kernels_are_compiled_is_said_once_and_on_a_terminal_only(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from shootstab.cli.terminal import Announcement

    quiet, loud = Announcement(), Announcement()
    quiet("transport")
    assert capsys.readouterr().err == ""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    loud("transport")
    loud("orthonormalize")
    assert capsys.readouterr().err == "shootstab: compiling kernels, once: later runs find them in a cache\n"
