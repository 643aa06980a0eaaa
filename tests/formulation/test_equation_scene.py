"""Equations in a scene file: read, explained, verified; what is wrong in them is told in one line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from shootstab.cli.main import main

POISEUILLE = """
[problem]
unknowns = ["u", "v", "p"]
parameters = { R = 10000, a = 1 }
where = { U = "1 - z**2" }
equations = ["sigma*u + i*a*U*u + v*d(U) + i*a*p - (d(u,2) - a**2*u)/R", "sigma*v + i*a*U*v + d(p) - (d(v,2) - a**2*v)/R", "i*a*u + d(v)"]
left = { at = -1, conditions = ["u", "v"] }
right = { at = 1, conditions = ["u", "v"] }
"""
LAYER = """
[problem]
unknowns = ["u", "v", "p"]
parameters = { a = 0.4446 }
where = { U = "tanh(y)" }
eigenvalue = "s"
variable = "y"
equations = ["(s + i*a*U)*u + v*d(U) + i*a*p", "(s + i*a*U)*v + d(p)", "i*a*u + d(v)"]
left = "infinity"
right = { infinity = true }
"""


def written(tmp_path: Path, text: str) -> str:
    path = tmp_path / "mine.toml"
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_a_mode_of_ones_own_equations(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["refine", written(tmp_path, POISEUILLE), "--guess=0.0037,-0.2375", "--digits", "18", "--json", "-"]) == 0
    sigma = json.loads(capsys.readouterr().out)["sigma"]
    assert sigma["re"].startswith("0.00373967062297940993")
    assert sigma["im"].startswith("-0.237526488820470107")


def test_explain_says_what_was_found(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["explain", written(tmp_path, LAYER), "--json", "-"]) == 0
    told = {line["heading"]: line["text"] for line in json.loads(capsys.readouterr().out)["explanation"]}
    assert told["order"].startswith("2:")
    assert told["states"] == "v, p"
    assert told["continuous spectrum inside"] == "s = -0.4446*i*tanh(y), y along the domain"
    assert told["at +infinity"].startswith("1 of 2 solutions decay at s = ")


def test_explain_is_refused_where_nothing_was_written(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["explain", "high"]) == 2
    assert "was not written in equations" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("left =", "let =", "[problem] has the unknown key 'let': allowed are unknowns, equations, left, right"),
        ('left = { at = -1, conditions = ["u", "v"] }', "", "[problem] lacks the key left"),
        ("R = 10000", 'R = "1e4"', "[problem] parameters: R = '1e4': allowed is a finite number"),
        ("a = 1 }", "a = inf }", "a = inf: allowed is a finite number"),
        ("v*d(U)", "v*d(W)", "equation 1, column 25, at 'W': unknown name 'W'"),
        ('["u", "v"] }', '["u"] }', "1 conditions at the left end and 1 at the right: allowed are 4 in all"),
        ("at = -1,", "at = -1, start = 2,", "[problem] left has the keys at, start, conditions: allowed is"),
        ('["u", "v", "p"]', '"u v p"', "[problem] unknowns = 'u v p': allowed is a list of strings"),
        ("sigma", "lambda_", "unknown name 'lambda_'"),
        ("sigma*", "", "neither the equations nor the conditions hold the eigenvalue sigma"),
    ],
)
def test_what_is_wrong_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str], old: str, new: str, told: str) -> None:
    assert main(["explain", written(tmp_path, POISEUILLE.replace(old, new))]) == 2
    error = capsys.readouterr().err
    assert told in error
    assert error.count("\n") == 1
