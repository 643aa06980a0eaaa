"""Every command, scene and program of the README does what it says."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

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


@pytest.mark.parametrize("command", COMMANDS)
def test_commands_of_the_readme(command: str, tmp_path: Path) -> None:
    words = command.split()
    exe = Path(sys.executable).with_name("shootstab")
    words = [str(exe), *(str(tmp_path / w) if w == "fig2.png" else w for w in words[1:])]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, timeout=300)
    bad_news = "fig2-qz-60.csv" in command  # the balloon
    assert done.returncode == int(bad_news), done.stderr
    assert done.stdout.strip()
    if bad_news:
        assert "14 of 75 eigenvalues confirmed to 5 digits, 50 spurious, 11 continuum" in done.stdout
        assert (tmp_path / "fig2.png").stat().st_size > 10_000


def test_the_scene_of_the_readme_loads(tmp_path: Path) -> None:
    from shootstab.faces.scenes import load

    (text,) = blocks("toml")
    (tmp_path / "scene.toml").write_text(text)
    assert load(str(tmp_path / "scene.toml")).problem.size == 8


def test_the_program_of_the_readme_runs() -> None:
    (text,) = blocks("python")
    names: dict[str, object] = {}
    exec(compile(text, "README.md", "exec"), names)
    assert names["n"] == 1
    assert [v.verdict for v in names["report"].verdicts] == ["confirmed", "spurious"]  # type: ignore[attr-defined]
