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

def nowhere(*_):
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


def started(folder: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(Path(shootstab.__file__).parents[1]), **variables}
    return subprocess.run([sys.executable, "-c", SCRIPT], env=environment, cwd=folder, capture_output=True, text=True, check=False)


def test_a_folder_is_made_and_removed(tmp_path: Path) -> None:
    done = started(tmp_path, TMPDIR=str(tmp_path))
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(str(tmp_path / "shootstab-kernels-"))
    assert list(tmp_path.iterdir()) == []
