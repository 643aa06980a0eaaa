"""Eighty columns hold every answer and every help: all commands, on problems that are quick."""

from __future__ import annotations

from pathlib import Path

import pytest

import shootstab as st
from shootstab.analyses.work_precision import Measurement, WorkPrecision
from shootstab.cli import main as cli
from shootstab.cli import terminal, trade_command
from shootstab.cli.lines import PAGE

STRING = """[problem]
unknowns = ["y"]
equations = ["d(y,2) + k*y = sigma*y"]
left = { at = 0, conditions = ["y"] }
right = { at = 1, conditions = ["y"] }
parameters = { k = 12 }
"""
# Orszag's mode, one that is a little off, two that are none for one reason and a missing one among them
CLAIMS = ["0.0037396706-0.2375264888i", "-0.050898-0.277204i", "0.1-0.1i", "0.11-0.1i", "-0.3-0.6i", "0.5-0.9i"]
WAVES = """[problem]
parameters = { R = 10, a = 1.1 }
unknowns = ["y"]
equations = ["d(y,2) + (R - 1j*a - (a - 1)**2)*y = sigma*y"]
left = { at = 0, conditions = ["y"] }
right = { at = 1, conditions = ["y"] }
"""
COMMANDS = [
    "",
    "scenes",
    "guide",
    "verify poiseuille claims.csv",
    "verify poiseuille claims.csv --only continuum",
    "verify poiseuille claims.csv --sort size --missing none",
    "refine poiseuille --guess 0.0037,-0.2375",
    "refine poiseuille --guess 0.3,-0.9",
    "refine poiseuille --guess 0.0037,-0.2375 --digits 60",
    "mode poiseuille --guess 0.0037,-0.2375",
    "mode high --guess 0.004",
    "count high --region half-plane",
    "find string.toml --corners=-80,-1,5,1",
    "critical waves.toml --parameter R=10 --over a=1.1 --guess 0,-1.1",
    "explain waves.toml",
    "steady low",
    "spectrum poiseuille",
    "spectrum low --raw -M 20",
    "sweep high --kx 0 --ky 0.01 --mass-flux 2:3:2 --e 0.79:0.8:2 --workers 1",
    "prove string.toml --guess 2.1304",
    "prove string.toml --disc=2.1,0,0.1",
    "baseline record poiseuille modes.toml --guess 0.0037,-0.2375",
    "baseline check modes.toml",
    "baseline check modes.toml claims.csv",
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the files lie, and those that one command leaves for the next."""
    path = tmp_path_factory.mktemp("page")
    (path / "string.toml").write_text(STRING)
    (path / "waves.toml").write_text(WAVES)
    (path / "claims.csv").write_text("\n".join(CLAIMS))
    return path


@pytest.mark.parametrize("command", COMMANDS)
def test_eighty_columns_hold_every_answer(
    command: str, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(folder)
    status = cli.main(command.split())
    said = capsys.readouterr().out
    assert status in (0, 1), said
    assert said.strip()
    assert [line for line in said.splitlines() if len(line) > PAGE] == []


def test_eighty_columns_hold_the_table_of_work_and_accuracy(capsys: pytest.CaptureFixture[str]) -> None:
    """`trade` takes minutes: its table from measurements that are as wide as any."""
    measurements = tuple(
        Measurement(method, parameter, resolution, 0.1 - 0.2j, 1e-14, 12.345, 123456789, 12345, by_bound=True)
        for method in trade_command.STYLES
        for parameter, resolution in (("M", 240.0), ("rtol", 1e-10), ("digits", 25.0))
    )
    terminal.show(trade_command.tables(WorkPrecision(measurements, 0.1 - 0.2j, 1e-25, 0.1 - 0.2j), st.scene("high")))
    said = capsys.readouterr().out
    assert "inverse iteration, paper's grid" in said
    assert [line for line in said.splitlines() if len(line) > PAGE] == []


WORK = ["verify", "refine", "mode", "count", "find", "critical", "explain", "steady", "spectrum", "sweep", "trade", "prove", "check"]
ALL = ["", *WORK, "baseline", "baseline record", "baseline check", "scenes", "guide"]


@pytest.mark.parametrize("command", ALL)
def test_eighty_columns_hold_every_help(command: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setenv("COLUMNS", str(PAGE))
    with pytest.raises(SystemExit) as ended:
        cli.main([*command.split(), "--help"])
    said = capsys.readouterr().out
    assert ended.value.code == 0
    assert "exit status:" in said
    assert [line for line in said.splitlines() if len(line) > PAGE] == []
