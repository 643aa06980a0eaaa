"""What a release rests on: one version, files that name it, bounds that a script can pin, a program that runs as a module."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import versions

import shootstab

ROOT = Path(__file__).parent.parent


def test_the_version_stands_once_and_the_files_beside_the_licence_name_it() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    assert "version" in project["project"]["dynamic"]
    assert project["tool"]["setuptools"]["dynamic"]["version"] == {"attr": "shootstab.__version__"}
    assert f"\nversion: {shootstab.__version__}\n" in (ROOT / "CITATION.cff").read_text()
    assert re.search(r"^## (\S+)", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)[1] in (shootstab.__version__, "Unreleased")  # type: ignore[index]


@pytest.mark.parametrize("arguments", [["-m", "shootstab"], ["-m", "shootstab.cli.main"]])
def test_the_package_runs_as_a_module(arguments: list[str]) -> None:
    done = subprocess.run([sys.executable, *arguments, "--version"], cwd=ROOT, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout) == (0, f"shootstab {shootstab.__version__}\n")


def test_every_dependency_has_a_lower_bound_that_can_be_pinned() -> None:
    pins = [versions.oldest(r) for r in versions.requirements()]
    assert len(pins) > 10
    assert all(re.fullmatch(r"[A-Za-z0-9_-]+==\d+(\.\d+)*", pin) for pin in pins), pins
    assert "python-flint==0.9" in pins  # below, Arb's series of order zero end the process
