"""kernels/cache.py: where nothing may be written to, kernels are kept in a folder of the process's own."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import shootstab

SCRIPT = """
import os, sys
import numba
from numba.core import caching

def nowhere(*_, **__):
    raise OSError("read-only")

ensure = caching._CacheLocator.ensure_cache_path
def only_temporary(self):
    if "shootstab-kernels-" not in self.get_cache_path():
        nowhere()
    ensure(self)

caching._CacheLocator.ensure_cache_path = only_temporary
from shootstab.kernels import elimination
print(numba.config.CACHE_DIR)
"""


def started(folder: Path, script: str = SCRIPT) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(Path(shootstab.__file__).parents[1]), "TMPDIR": str(folder)}
    return subprocess.run([sys.executable, "-c", script], env=environment, cwd=folder, capture_output=True, text=True, check=False)


def test_a_folder_is_made_and_removed(tmp_path: Path) -> None:
    done = started(tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(str(tmp_path / "shootstab-kernels-"))
    assert list(tmp_path.iterdir()) == []


def test_where_no_folder_may_be_written_to_it_says_what_to_set(tmp_path: Path) -> None:
    nowhere = SCRIPT.replace("from shootstab.kernels", "import tempfile; tempfile.TemporaryDirectory = nowhere\nfrom shootstab.kernels")
    told = started(tmp_path, nowhere)
    assert told.returncode != 0
    assert "compiled kernels can be kept nowhere: set NUMBA_CACHE_DIR to a folder that may be written to (read-only)" in told.stderr
