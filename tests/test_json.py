"""The JSON of every command holds what `shootstab guide json` says, and nothing that it does not say."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
from equations import FREE

import shootstab
from shootstab.cli import main as cli

PAGE = (Path(shootstab.__file__).parent / "guide" / "json.md").read_text()
EVERYWHERE = {"version", "seconds", "compilation_seconds", "convention"}
OF_SCENES = {"name", "description", "order", "unknowns", "symmetry", "scales", "eigenvalue", "parameters", "scene"}
OF_REGIONS = {"shape", "corners", "centre", "radius", "bounds", "floor"}
NUMBERS = {"re", "im"}
CERTIFICATE = Path(__file__).parent.parent / "validation" / "certificates" / "channel-5772.2218.json"
CRITICAL = ["--parameter", "Ra=640", "--over", "a=2.3", "--guess=0"]
COMMANDS: dict[str, list[str]] = {
    "refine": ["benard", "--guess", "3.4"],
    "verify": ["benard", "FILE", "--missing", "none", "--prove"],
    "count": ["benard", "--region", "disc", "--centre=3.4,0", "--radius=1"],
    "find": ["benard", "--region", "disc", "--centre=3.4,0", "--radius=1"],
    "mode": ["benard", "--guess", "3.4", "--points", "3"],
    "steady": ["high"],
    "spectrum": ["poiseuille", "--raw", "-M", "40"],
    "sweep": ["high", "--kx", "0", "--ky", "0.02:0.022:2", "--workers", "1"],
    "critical": ["FREE", *CRITICAL],
    "explain": ["legendre"],
    "prove": ["benard", "--guess", "3.4"],
    "check": [str(CERTIFICATE)],
    "scenes": [],
    "baseline": ["record", "benard", "OUT", "--guess", "3.4"],
}
FREE_KEYS = {"summary", "parameters", "fields", "profiles", "axes", "critical"}  # whose keys are words of the problem, or of statuses


def documented(command: str) -> set[str]:
    """The keys in the command's own row of the page, and those of the commands to which it refers."""
    rows = [line for line in PAGE.splitlines() if line.startswith("|") and f"`{command}`" in line.split("|")[1]]
    assert len(rows) == 1
    found = set(re.findall(r"`(\w+)`", rows[0].split("|", 2)[2]))
    return found.union(*(documented(other) for other in COMMANDS if f"`{other}` has it" in rows[0]))


def keys(value: Any) -> set[str]:
    if isinstance(value, list):
        return set().union(*map(keys, value)) if value else set()
    if not isinstance(value, dict):
        return set()
    return set(value).union(*(keys(inner) for name, inner in value.items() if name not in FREE_KEYS))


@pytest.mark.parametrize("command", COMMANDS)
def test_every_key_is_documented(command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "claims.csv").write_text("3.4,0\n")
    (tmp_path / "free.toml").write_text(FREE)
    places = {"FILE": "claims.csv", "OUT": "baseline.json", "FREE": "free.toml"}
    words = [str(tmp_path / places[word]) if word in places else word for word in COMMANDS[command]]
    assert cli.main([command, *words, "--json", "-"]) in (0, 1)
    answer = json.loads(capsys.readouterr().out)
    own = documented(command) | EVERYWHERE | OF_SCENES | OF_REGIONS | NUMBERS
    swept = set(answer.get("axes", ()))
    assert keys(answer) - swept <= own, keys(answer) - swept - own
    assert set(answer) - {"scene", *EVERYWHERE} <= documented(command)
    assert answer["version"] == shootstab.__version__
    assert answer["seconds"] >= 0.0
    if command not in ("check", "scenes"):
        assert answer["scene"]["parameters"]
    if answer.get("region") and command in ("count", "find"):
        assert answer["region"]["bounds"] == pytest.approx([2.4, -1.0, 4.4, 1.0])


def test_every_command_has_a_row() -> None:
    """All but the manual answer in JSON; work against accuracy takes too long to be asked for here."""
    commands = set(re.findall(r"^    ([a-z]+) ", cli.parser().format_help(), re.MULTILINE))
    assert commands == {*COMMANDS, "trade", "guide"}
    assert documented("trade") >= {"truth", "bound", "measurements", "recommendation"}
