"""`shootstab prove` writes a certificate, `shootstab check` accepts it, and neither accepts what is false."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from shootstab.analyses.proof import at_most
from shootstab.cli import main as cli

pytest.importorskip("flint")

IN_CODE = """
import numpy as np
import shootstab as st
string = st.problem(2, lambda z: (np.array([[0, 1], [0, 0]]), np.array([[0, 0], [1, 0]])), st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]]))
"""
SCENE = '[problem]\nname = "poiseuille"\nreynolds = 20.0\nalpha = 1.0\n'


@pytest.fixture
def in_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A string whose matrices are a function in Python, as nothing encloses it."""
    (tmp_path / "string_in_code.py").write_text(IN_CODE)
    monkeypatch.syspath_prepend(str(tmp_path))
    return "string_in_code:string"


def test_a_proof_its_certificate_and_a_tampered_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene, file = tmp_path / "slow.toml", tmp_path / "mode.json"
    scene.write_text(SCENE)
    assert cli.main(["prove", str(scene), "--guess=-0.5,-0.6", "--digits", "8", "--certificate", str(file)]) == 0
    said = capsys.readouterr().out
    assert "Proved: exactly one eigenvalue lies in |σ − (-0." in said
    assert cli.main(["check", str(file)]) == 0
    assert capsys.readouterr().out == "proved\n"
    certificate = json.loads(file.read_text())
    assert [part["problem"]["modes"] for part in certificate["parts"]] == ["even", "odd"]
    certificate["parts"][0]["count"] = 1 - certificate["parts"][0]["count"]
    file.write_text(json.dumps(certificate))
    assert cli.main(["check", str(file), "--json", "-"]) == 1
    assert "Pellet" in json.loads(capsys.readouterr().out)["reason"]


def test_what_is_no_certificate_is_bad_input(tmp_path: Path, in_code: str, capsys: pytest.CaptureFixture[str]) -> None:
    for text in ("", "[]", '{"problem": {"name": "chute"}}', "{"):
        file = tmp_path / "bad.json"
        file.write_text(text)
        assert cli.main(["check", str(file)]) == 2
        assert len(capsys.readouterr().err.strip().splitlines()) == 1
    assert cli.main(["check", str(tmp_path / "none.json")]) == 2
    assert cli.main(["prove", in_code, "--guess", "-9.87"]) == 2
    assert "closed form" in capsys.readouterr().err
    assert cli.main(["prove", "poiseuille", "--half-annulus=0,0,0.1,0.2", "--certificate", str(tmp_path / "a.json")]) == 2
    assert "allowed with --guess, --disc, --region and --growing" in capsys.readouterr().err
    assert cli.main(["prove", "high", "--region=0.001,-0.01,0.02,0.01", "--certificate", str(tmp_path / "a.json")]) == 2
    assert "along its boundary by hundreds of values" in capsys.readouterr().err
    exponential = '[problem]\nunknowns = ["y"]\nequations = ["d(y,2) = exp(z)*sigma*y"]\n'
    scene = tmp_path / "exponential.toml"
    scene.write_text(exponential + 'left = { at = 0, conditions = ["y"] }\nright = { at = 1, conditions = ["y"] }\n')
    # refused before a second is spent on a proof
    assert cli.main(["prove", str(scene), "--guess=-6", "--certificate", str(tmp_path / "b.json")]) == 2
    assert "rational function" in capsys.readouterr().err
    assert cli.main(["prove", "benard", "--guess", "2", "--over", "rayleigh=1,2"]) == 2
    assert cli.main(["prove", "benard", "--growing", "0", "--over", "rayleigh=1"]) == 2
    assert cli.main(["prove", "benard", "--growing", "0", "--over", "taylor=1,2"]) == 2
    capsys.readouterr()
    assert cli.main(["prove", "high", "--region=0.001,-1,0.05,1", "--over", "ky=0.01,0.02"]) == 2
    assert "conditions at two finite ends" in capsys.readouterr().err


def test_a_certificate_of_a_rectangle(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "some.json"
    scene = tmp_path / "string.toml"
    ends = 'left = { at = 0, conditions = ["y"] }\nright = { at = 1, conditions = ["y"] }\n'
    scene.write_text(f'[problem]\nunknowns = ["y"]\nequations = ["d(y,2) - sigma*y"]\n{ends}')
    assert cli.main(["prove", str(scene), "--region=-50,-1,0,1", "--certificate", str(file)]) == 0
    assert "exactly 2 eigenvalues lie in the rectangle from -50.0 − 1.0i to 0.0 + 1.0i" in " ".join(capsys.readouterr().out.split())
    assert cli.main(["check", str(file)]) == 0


def test_a_certificate_of_all_that_grows(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene, file = tmp_path / "slow.toml", tmp_path / "none.json"
    scene.write_text('[problem]\nname = "poiseuille"\nreynolds = 50.0\nalpha = 1.0\n')
    assert cli.main(["prove", str(scene), "--growing=-0.1", "--certificate", str(file)]) == 0
    assert "Proved: no eigenvalue has Re σ ≥ -0.1." in capsys.readouterr().out
    assert cli.main(["check", str(file)]) == 0


def test_a_radius_is_never_told_larger_than_proved() -> None:
    assert [at_most(x, 3) for x in (0.00123999, 2.5, 1.999e-11, 14.47)] == ["0.00123", "2.5", "1.99e-11", "14.4"]
    assert at_most(0.3, 1) == "0.2"  # the double lies below 3/10
    assert at_most(1.99e7, 2) == "1.9e+07"


def test_verdicts_become_theorems(tmp_path: Path, in_code: str, capsys: pytest.CaptureFixture[str]) -> None:
    """y″ = σ y between walls: σ = −π² and −4π², and nothing else above −80."""
    scene, claimed = tmp_path / "string.toml", tmp_path / "claimed.csv"
    ends = 'left = { at = 0, conditions = ["y"] }\nright = { at = 1, conditions = ["y"] }\n'
    scene.write_text(f'[problem]\nunknowns = ["y"]\nequations = ["d(y,2) - sigma*y"]\n{ends}')
    claimed.write_text("re,im\n-9.8696044,0\n-39.478417604,0\n-25.0,0\n-9.87,0\n")
    assert cli.main(["verify", str(scene), str(claimed), "--prove", "--json", "-"]) == 1
    first, second, spurious, other = json.loads(capsys.readouterr().out)["verdicts"]
    assert (first["verdict"], second["verdict"], spurious["verdict"]) == ("confirmed", "confirmed", "spurious")
    assert first["proved"].startswith("exactly one eigenvalue lies in |σ − (-9.8696044 + 0.0i)| < ")
    assert second["proved"].startswith("exactly one eigenvalue")
    assert 1.0 < spurious["within"] < 14.48  # −4π² is so far away
    assert spurious["proved"].startswith("no eigenvalue lies within")
    assert 1e-4 < other["within"] < 3.96e-4  # −π² is so far away, and the first claim's
    assert not any(v["contradicts"] for v in (first, second, spurious, other))
    assert [first["upgraded"], spurious["upgraded"]] == ["proved", f"proved: none within {at_most(spurious['within'], 3)}"]
    cli.main(["verify", str(scene), str(claimed), "--prove"])
    assert "3 proved: no eigenvalue lies within" in capsys.readouterr().out
    assert cli.main(["verify", in_code, str(claimed), "--prove"]) == 2
    assert "a proof asks for" in capsys.readouterr().err


@pytest.mark.slow
def test_verdicts_on_a_chute_become_theorems(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The growing mode of the high flow, the same a little off, and a place where there is none; of flows that exist."""
    claimed = tmp_path / "claimed.csv"
    claimed.write_text("re,im\n0.00397050,0\n0.00397200,0\n0.003,0.001\n")
    assert cli.main(["verify", "high", str(claimed), "--prove", "--missing", "none", "--json", "-"]) == 1
    confirmed, *others = json.loads(capsys.readouterr().out)["verdicts"]
    assert confirmed["verdict"] == "confirmed" and confirmed["upgraded"] == "proved"
    assert [v["verdict"] for v in others] == ["spurious", "spurious"]
    assert 1e-7 < others[0]["within"] < 1.5e-6 and others[0]["upgraded"].startswith("proved: none within")  # the mode is 1.5e-6 away
    assert 1e-6 < others[1]["within"] < 1.4e-3
    for verdict in (confirmed, *others):
        assert verdict["premise"].startswith("a steady flow with mass_flux = 3.0 exists") and not verdict["contradicts"]
