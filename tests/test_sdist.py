"""MANIFEST.in: the sdist holds whatever the repository does, the claims and the tests among it."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
BY_ITSELF = {"README.md", "LICENSE", "pyproject.toml", "MANIFEST.in", "shootstab"}  # what setuptools takes without being told


def test_every_tracked_file_is_named() -> None:
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True)
    if listed.returncode:
        pytest.skip("no repository here")
    lines = [line.split() for line in (ROOT / "MANIFEST.in").read_text(encoding="utf-8").splitlines() if line[:1].isalpha()]
    named = {word for order, *words in lines if order in ("graft", "include") for word in words} | BY_ITSELF
    missed = {name for name in listed.stdout.splitlines() if name.partition("/")[0] not in named}
    assert missed == set()
    excluded = [pattern for order, *words in lines if order == "global-exclude" for pattern in words]
    assert not [name for name in listed.stdout.splitlines() for pattern in excluded if Path(name).match(pattern)]
