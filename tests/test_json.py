"""The JSON of every command holds what `shootstab guide json` says, and nothing that it does not say."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

import shootstab
from shootstab.cli import main as cli

PAGE = (Path(shootstab.__file__).parent / "guide" / "json.md").read_text()
DOCUMENTED = set(re.findall(r"`([\w-]+)`", PAGE))
COMMANDS: dict[str, list[str]] = {
    "refine": ["benard", "--guess", "3.4"],
    "verify": ["benard", "FILE", "--missing", "none", "--prove"],
    "count": ["benard", "--region", "disc", "--centre=3.4,0", "--radius=1"],
    "find": ["benard", "--region", "disc", "--centre=3.4,0", "--radius=1"],
    "mode": ["benard", "--guess", "3.4", "--points", "3"],
    "steady": ["high"],
}
FREE = {"summary", "parameters", "fields", "profiles"}  # whose keys are words of the problem, or of the table of verdicts


def keys(value: Any) -> set[str]:
    if isinstance(value, list):
        return set().union(*map(keys, value)) if value else set()
    if not isinstance(value, dict):
        return set()
    return set(value).union(*(keys(inner) for name, inner in value.items() if name not in FREE))


@pytest.mark.parametrize("command", COMMANDS)
def test_every_key_is_documented(command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "claims.csv").write_text("3.4,0\n")
    words = [str(tmp_path / "claims.csv") if word == "FILE" else word for word in COMMANDS[command]]
    assert cli.main([command, *words, "--json", "-"]) in (0, 1)
    answer = json.loads(capsys.readouterr().out)
    assert keys(answer) <= DOCUMENTED, keys(answer) - DOCUMENTED
    assert answer["version"] == shootstab.__version__
    assert answer["seconds"] >= 0.0
    assert answer["scene"]["parameters"]
    if answer.get("region"):
        assert answer["region"]["bounds"] == pytest.approx([2.4, -1.0, 4.4, 1.0])
