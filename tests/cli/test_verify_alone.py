"""`shootstab verify SCENE` without a list: the collocation claims, shooting judges, and the answer is that there is no bad news."""

from __future__ import annotations

from pathlib import Path

import pytest

from shootstab.cli.main import main

WELL = """
equations = ["d(y,2) + 6*sech(x)**2*y = sigma*y"]
variable = "x"
left = "infinity"
right = "infinity"
"""
MATHIEU = """
equations = ["d(y,2) + (sigma - 2*cos(2*pi*z))*y = 0"]
left = { periodic = 0 }
right = { periodic = 1 }
"""
RADIAL = """
equations = ["d(y,2) + 2*d(y)/r + (2/r - 2/r**2)*y = sigma*y"]
variable = "r"
reference = 0.05
left = { axis = 0 }
right = "infinity"
"""

WAVES = """
parameters = { k = 1.3, g = 1, rho = [1, 0.8] }
equations = ["d(y,2) - k**2*y = 0"]
left = { at = -1, conditions = ["y"] }
right = "infinity"
interfaces = [{ at = 0, conditions = ["jump(y)", "sigma**2*jump(rho*d(y)) = g*k**2*jump(rho)*before(y)"] }]
"""
SINE_GORDON = """
equations = ["sigma**2*y = d(y,2) - (1 - 2*sech(x)**2)*y"]
variable = "x"
left = "infinity"
right = "infinity"
"""


@pytest.mark.parametrize(
    ("text", "truncation", "told"),
    [
        (WELL, "70", "2 of 2 eigenvalues confirmed"),
        (MATHIEU, "24", "confirmed to 6 digits"),
        (RADIAL, "24", "confirmed to 6 digits"),
        (WAVES, "50", "2 of 2 eigenvalues confirmed"),
        (SINE_GORDON, "60", "2 of 2 eigenvalues confirmed"),  # 0 twice, by the translation of the kink
    ],
)
def test_one_of_each_kind(text: str, truncation: str, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = tmp_path / "mine.toml"
    scene.write_text('[problem]\nunknowns = ["y"]\n' + text, encoding="utf-8")
    assert main(["spectrum", str(scene), "-M", truncation, "--quiet"]) == 0
    assert main(["verify", str(scene), "-M", truncation, "--missing", "none"]) == 0
    said = capsys.readouterr().out
    assert told in said
    assert "spurious" not in said


def test_a_kink_with_its_translation_and_its_internal_mode(capsys: pytest.CaptureFixture[str]) -> None:
    """0 twice and ±i(3/2)^(1/2) are claimed and confirmed, and no mode is missing."""
    assert main(["verify", "kink"]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "4 of 4 eigenvalues confirmed" in said
    assert "no mode is missing" in said
