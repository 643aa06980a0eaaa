"""Every command, scene and program of the README does what it says."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text()


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README, flags=re.DOTALL)


COMMANDS = [line for block in blocks("console") for line in block.splitlines() if line.startswith(".venv/bin/shootstab")]


def test_the_two_commands_are_what_ci_runs() -> None:
    ci = (ROOT / ".ci" / "run").read_text()
    setup, tests = (blocks("console")[i].strip() for i in (0, 1))
    for part in setup.split(" && ")[:2]:
        assert part in ci.replace(" --quiet", "")
    assert tests in ci
    assert setup.split(" && ")[2] == ".venv/bin/shootstab verify high"


def run(tmp_path: Path, words: list[str], cwd: Path = ROOT) -> subprocess.CompletedProcess[str]:
    """A command of the README; pictures go elsewhere."""
    exe = Path(sys.executable).with_name("shootstab")
    placed = [str(tmp_path / w) if w.endswith(".png") else w for w in words]
    return subprocess.run([str(exe), *placed], cwd=cwd, capture_output=True, text=True, timeout=300)


@pytest.mark.parametrize("command", COMMANDS)
def test_commands_of_the_readme(command: str, tmp_path: Path) -> None:
    words = command.split()
    done = run(tmp_path, words[1:])
    bad_news = "fig2-qz-60.csv" in command  # the balloon
    assert done.returncode == int(bad_news), done.stderr
    assert done.stdout.strip()
    for picture in (w for w in words if w.endswith(".png")):
        assert (tmp_path / picture).stat().st_size > 10_000
    if bad_news:
        assert "14 of 75 eigenvalues confirmed to 5 digits, 50 spurious, 11 continuum" in done.stdout


@pytest.mark.parametrize(("block", "size"), [(0, 8), (1, 8)])
def test_the_scenes_of_the_readme_load(block: int, size: int, tmp_path: Path) -> None:
    from shootstab.io.scenes import load

    (tmp_path / "scene.toml").write_text(blocks("toml")[block])
    assert load(str(tmp_path / "scene.toml")).problem.size == size


def program(block: int) -> dict[str, Any]:
    names: dict[str, Any] = {}
    exec(compile(blocks("python")[block], "README.md", "exec"), names)
    return names


def test_the_program_of_the_readme_runs() -> None:
    names = program(0)
    assert names["n"] == 1
    assert len(names["modes"]) == 1
    assert [v.verdict for v in names["report"].verdicts] == ["confirmed", "spurious"]


def test_sixty_digits_of_a_rod_in_python_and_on_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    import mpmath

    program(2)
    said = capsys.readouterr().out.strip()
    with mpmath.workdps(70):
        x = mpmath.findroot(lambda x: x * mpmath.tan(x) - mpmath.mpf(3) / 10, 0.5)
        assert abs(mpmath.mpf(said) + x * x) < mpmath.mpf(10) ** -59
    (tmp_path / "rod.py").write_text(blocks("python")[2])
    done = run(tmp_path, ["refine", "rod:rod", "--guess=-0.28", "--digits", "60"], cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert said[:58] in done.stdout.replace(" ", "")
