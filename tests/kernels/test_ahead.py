"""kernels/ahead: what a second process compiles is what an answer needs, and where there is none nothing changes."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from shootstab.kernels import ahead

ASKED = """
import shootstab as st
from shootstab.core import compilation
compilation.tell(print)
p = st.scene("high").problem
D = st.Frame(rtol=1e-8).on(p)
D.with_derivative(0.004), D.with_derivative(0.004 - 0.001j)
st.refine(p, -0.1558 - 0.3748j), st.refine(p, 0.004)
p.flow.states_at([0.5 + 3.0j, 0.4 + 3.1j], order="path")
p.pencil([0.5 + 0.1j])
"""


@pytest.mark.slow
def test_what_was_compiled_ahead_is_not_compiled_again(tmp_path: Path) -> None:
    places = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    subprocess.run([sys.executable, "-m", "shootstab.kernels.ahead"], check=True, env=places, timeout=300)
    told = subprocess.run([sys.executable, "-c", ASKED], check=True, env=places, timeout=300, capture_output=True, text=True).stdout.split()
    assert "integrate" in told
    assert {"carry", "back_substitute", "ends_of_steps", "entries_at_random", "along_path"}.isdisjoint(told)
    assert told.count("evaluate_points") == 1  # in real numbers; that in complex ones was there


def test_a_second_process_is_started_once_and_only_where_it_can_be(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []

    class NoProcess:
        def __init__(self, words: list[str], **_: Any) -> None:
            asked.append(words)
            raise OSError("no more processes")

    class OneProcess(NoProcess):
        def __init__(self, words: list[str], **_: Any) -> None:
            asked.append(words)

        def kill(self) -> None:
            asked.append("killed")

        def wait(self) -> None: ...

    monkeypatch.setattr(ahead, "helpers", [])
    monkeypatch.setattr(ahead.atexit, "register", lambda end: None)
    monkeypatch.setattr(ahead.os, "cpu_count", lambda: 1)
    ahead.begin()
    assert asked == []
    monkeypatch.setattr(ahead.os, "cpu_count", lambda: 2)
    monkeypatch.setattr(ahead.subprocess, "Popen", NoProcess)
    ahead.begin()
    assert len(asked) == 1
    monkeypatch.setattr(ahead.subprocess, "Popen", OneProcess)
    ahead.begin()
    ahead.begin()
    assert asked[1:] == [[sys.executable, "-m", "shootstab.kernels.ahead"]]
    ahead.end()
    assert asked[-1] == "killed"
