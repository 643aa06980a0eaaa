"""`shootstab prove` writes a certificate, `shootstab check` accepts it, and neither accepts what is false."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from shootstab.cli import main as cli

pytest.importorskip("flint")

SCENE = '[problem]\nname = "poiseuille"\nreynolds = 20.0\nalpha = 1.0\n'


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


def test_what_is_no_certificate_is_bad_input(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for text in ("", "[]", '{"problem": {"name": "chute"}}', "{"):
        file = tmp_path / "bad.json"
        file.write_text(text)
        assert cli.main(["check", str(file)]) == 2
        assert len(capsys.readouterr().err.strip().splitlines()) == 1
    assert cli.main(["check", str(tmp_path / "none.json")]) == 2
    assert cli.main(["prove", "high", "--guess", "0.004"]) == 2
    assert "closed form" in capsys.readouterr().err
    assert cli.main(["prove", "poiseuille", "--growing", "-0.001", "--certificate", str(tmp_path / "a.json")]) == 2
