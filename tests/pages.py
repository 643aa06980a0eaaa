"""Pages of the manual, run from top to bottom: one mechanism for README.md and shootstab/guide.

A fenced block is run by what stands behind its fence:

    ```console       each line after "$ " is a command of the shell; what follows is all that it says, on both streams.
    ```python        a program; all programs of a page share their names
    ```output        what the program above has printed
    ```csv FILE      any block with a name is saved under it first (a program is run besides)

In what is shown "..." stands for anything, on a line of its own for any number of lines, and "[exit status N]" ends a command that
does not end with 0. Blocks of another kind without a name are not run.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

FENCE = re.compile(r"^```(\w*)[ ]?(\S*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
HEARTBEAT = re.compile(r"shootstab: .*, \d+ s$")  # on a slow machine
STATUS = re.compile(r"\[exit status (\d+)\]")
ROOT = Path(__file__).parent.parent


@dataclass(frozen=True)
class PageBlock:
    """A fenced block: its kind, its name if it has one, its text."""

    kind: str
    name: str
    text: str


def blocks(page: str) -> list[PageBlock]:
    """The fenced blocks of a page, in order."""
    return [PageBlock(*found) for found in FENCE.findall(page)]


def matches(shown: str, said: str) -> bool:
    """Whether what is shown, with "..." for anything, is what was said; runs of blanks count as one, empty lines at the ends as none."""
    wanted = [" ".join(line.split()) for line in shown.strip("\n").splitlines()]
    parts = [r"(?:.*\n)*?" if line == "..." else re.escape(line).replace(r"\.\.\.", ".*?") + r"\n" for line in wanted]
    return re.fullmatch("".join(parts), "".join(f"{' '.join(line.split())}\n" for line in said.strip("\n").splitlines())) is not None


def commands(text: str) -> list[tuple[str, str, int]]:
    """(command, what is shown, exit status) of a console block."""
    found: list[tuple[str, str, int]] = []
    for part in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]:
        command, _, shown = part.partition("\n")
        status = STATUS.search(shown)
        found.append((command, STATUS.sub("", shown), int(status[1]) if status else 0))
    return found


def run_page(page: str, folder: Path) -> None:
    """Run every block of the page in this folder; AssertionError that names what differs."""
    names: dict[str, Any] = {"__name__": "__page__"}
    printed = ""
    sys.path.insert(0, str(folder))
    before = Path.cwd()
    os.chdir(folder)
    try:
        for block in blocks(page):
            if block.name:
                (folder / block.name).write_text(block.text)
            if block.kind == "python":
                with contextlib.redirect_stdout(io.StringIO()) as out:
                    exec(compile(block.text, block.name or "page", "exec"), names)
                printed = out.getvalue()
            elif block.kind == "output":
                assert matches(block.text, printed), f"shown:\n{block.text}\nprinted:\n{printed}"
            elif block.kind == "console":
                _console(block.text, folder)
    finally:
        os.chdir(before)
        sys.path.remove(str(folder))


def _console(text: str, folder: Path) -> None:
    here = Path(sys.executable).parent
    environment = {
        **os.environ,
        "PATH": f"{here}{os.pathsep}{os.environ['PATH']}",
        "PYTHONPATH": f"{ROOT}{os.pathsep}{os.environ.get('PYTHONPATH', '')}",
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    for command, shown, status in commands(text):
        program = f'shootstab() {{ "{sys.executable}" -m shootstab "$@"; }}\n{command}'
        done = subprocess.run(
            ["bash", "-c", program], cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300
        )
        said = "".join(line for line in done.stdout.splitlines(True) if not HEARTBEAT.match(line))
        assert done.returncode == status, f"$ {command}\nexit status {done.returncode}, shown is {status}:\n{done.stdout}"
        assert matches(shown, said), f"$ {command}\nshown:\n{shown}\nsaid:\n{done.stdout}"
