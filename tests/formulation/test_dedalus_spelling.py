"""Scenes in the spelling of Dedalus' scripts: published values by both ways, what is told of them, and what is refused."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import shootstab as st
from shootstab.cli.main import main
from shootstab.core.errors import InputError
from shootstab.core.scene_notes import known
from shootstab.formulation.dedalus_table import problem_table
from shootstab.io.scenes import load

SCENES = Path(__file__).parent.parent.parent / "validation" / "dedalus"
FILES = sorted(SCENES.glob("*.toml"))
TRUNCATION = 80  # Orr and Sommerfeld's equation at R = 10000 has eight digits with it


@pytest.mark.parametrize("file", FILES, ids=[file.stem for file in FILES])
def test_published_values_by_both_ways(file: Path) -> None:
    scene, published = load(str(file)), known(tomllib.loads(file.read_text(encoding="utf-8")))
    assert published is not None
    value = published.double
    mode = st.refine(scene.problem, value * (1 + 1e-4))
    assert mode.converged
    allowed = 10.0 ** (1 - min(published.digits, 15)) * abs(value)
    assert abs(mode.sigma - value) <= mode.error + allowed
    claims = scene.problem.pseudospectral.spectrum(TRUNCATION, filtered=False).eigenvalues
    assert np.abs(claims - value).min() < 1e-5 * abs(value)


def test_there_are_ten_and_more() -> None:
    assert len(FILES) >= 10


def test_a_scene_is_explained_and_judged(capsys: pytest.CaptureFixture[str]) -> None:
    """The heading says whose spelling it is and which terms are left out."""
    scene = str(SCENES / "waves-on-a-string.toml")
    assert main(["explain", scene]) == 0
    assert main(["verify", scene, "-M", "24", "--missing", "none"]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "confirmed to 6 digits" in said
    text = tomllib.loads((SCENES / "waves-on-a-string.toml").read_text(encoding="utf-8"))
    assert problem_table(text["dedalus"])[1] == ("tau1", "tau2")


STRING: dict[str, Any] = {
    "coordinate": "x",
    "bounds": [0, 1],
    "variables": ["u", "tau1", "tau2"],
    "eigenvalue": "s",
    "parameters": {"Lx": 1},
    "substitutions": {"ux": "dx(u) + lift(tau1, -1)", "dy(A)": "1j*A"},
    "equations": ["s*u + dx(ux) + lift(tau2, -1) = 0", "u(x=0) = 0", "u(x=Lx) = 0"],
}


def test_what_a_script_means() -> None:
    """Terms of lift are 0, definitions stay by name, substitutions with arguments are put in."""
    table, taus = problem_table({**STRING, "equations": ["s*u + dy(dy(ux)) + dx(ux) + lift(tau2, -1) = 0", *STRING["equations"][1:]]})
    assert taus == ("tau1", "tau2")
    assert table["unknowns"] == ["u"]
    assert "lift" not in str(table)
    assert table["left"] == {"at": 0, "conditions": ["(u) = 0"]}
    assert table["right"] == {"at": 1, "conditions": ["(u) = 0"]}


def test_the_four_ways_to_write_a_value_at_an_end() -> None:
    for left, right in (
        ("left(u)", "right(u)"),
        ("interp(u, x=0)", "interp(u, x=1)"),
        ("u(x=0)", "u(x=+1)"),
        ("(2*u)(x=0)", "dx(u)(x=1) + u(x=1)"),
    ):
        table, _ = problem_table({**STRING, "equations": [STRING["equations"][0], f"{left} = 0", f"{right} = 0"]})
        assert len(table["left"]["conditions"]) == len(table["right"]["conditions"]) == 1


def test_values_at_both_ends_couple_them() -> None:
    """u(0) = 2 u(1) and the same of u′, through the definition of u′: s = −(−ln 2 + 2πi)²."""
    from shootstab.formulation.equation_scene import from_table

    rows = ["u(x=0) = 2*u(x=1)", "ux(x=0) = 2*ux(x=Lx)"]
    table, _ = problem_table({**STRING, "equations": [STRING["equations"][0], *rows]})
    exact = -((-np.log(2) + 2j * np.pi) ** 2)
    assert abs(st.refine(from_table(table), exact * 1.001).sigma - exact) < 1e-10


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"equations": ["s*u + lap(u) = 0"]}, r"equation 1: lap is an operator that is not read: allowed are components"),
        ({"equations": ["integ(u) = 0"]}, r"equation 1: integ is an operator that is not read"),
        ({"equations": ["s*u + u@u = 0"]}, r"the character '@' has no meaning here"),
        ({"equations": ["s*u + u(x=0) = 0"]}, r"equation 1: u stands beside values at an end"),
        ({"equations": ["x*u(x=0) = 0"]}, r"equation 1: x stands beside values at an end"),
        ({"equations": ["u(x=0.5) = 0"]}, r"x=0\.5 is no end: allowed are 0 and 1"),
        ({"equations": ["dx(u, 2) = 0"]}, r"dx has 2 arguments: allowed is one"),
        ({"equations": ["dy(u, u) = 0"]}, r"dy has 2 arguments: allowed are 1"),
        ({"equations": ["dx(u = 0"]}, r"a parenthesis is not closed"),
        ({"equations": ["u) = 0"]}, r"a parenthesis that was never opened"),
        ({"equations": ["interp(u) = 0"]}, r"interp without a place"),
        ({"substitutions": {"f(A)": "f(A)", "ux": "dx(u)"}, "equations": ["f(u) = 0"]}, r"substitutions within each other, deeper than 40"),
        ({"substitutions": {"f(": "u"}}, r"allowed are name or name\(A, B\), and a text"),
        ({"basis": "SphericalShell"}, r"basis = 'SphericalShell': allowed is one of Chebyshev"),
        ({"basis": "Fourier"}, r"at the left end: a period has no ends"),
        ({"bounds": [0, "infinity"]}, r"solutions decay at infinity by themselves|x=Lx is no end"),
        ({"bounds": 1}, r"bounds = 1: allowed are two numbers"),
        ({"axis": "top"}, r'axis = \'top\': allowed is "left" or "right"'),
        ({"variables": "u"}, r"variables = 'u': allowed is a list of strings"),
        ({"parameters": [1]}, r"parameters = \[1\]: allowed is a table of numbers"),
        ({"equations": ["(" * 100 + "u" + ")" * 100]}, r"allowed are 60 parentheses within each other"),
        (
            {"substitutions": {f"f{i}(A)": f"f{i + 1}(A) + f{i + 1}(A)" for i in range(30)}, "equations": ["f0(u) = 0"]},
            r"over 20000 characters",
        ),
        ({"grid": 4}, r"\[dedalus\] has the unknown key 'grid'"),
    ],
)
def test_what_users_are_told(changed: dict[str, Any], told: str) -> None:
    with pytest.raises(InputError, match=told):
        problem_table({**STRING, **changed})
