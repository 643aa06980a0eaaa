"""Every refusal of the room of files that no other test reaches: what was wrong, where, and what is allowed."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

from shootstab.core.errors import InputError, OutputError
from shootstab.io import fields, files, hdf5_process
from shootstab.io.arrays import Wanted


def test_a_field_is_saved_in_one_of_the_formats_that_are_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"mode\.xls: allowed is a file name that ends in \.csv or \.npz"):
        fields.save(np.zeros(1), {"W": np.zeros(1)}, tmp_path / "mode.xls", {})


def test_a_folder_that_may_not_be_written_to_is_refused_before_the_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The answer of the operating system is put in its place, for an administrator may write everywhere."""
    files.require_writable(tmp_path / "out.csv")
    monkeypatch.setattr(os, "access", lambda path, mode: (path, mode) != (tmp_path, os.W_OK))
    with pytest.raises(InputError, match=r"out\.csv: cannot be written: allowed is a file in a folder that may be written to"):
        files.require_writable(tmp_path / "out.csv")


def test_a_device_that_fails_is_named_with_the_reason_of_the_system() -> None:
    def full(path: Path) -> None:
        raise OSError(28, "No space left on device")

    with pytest.raises(OutputError, match=f"{os.devnull}: cannot be written: No space left on device"):
        files.write_whole(Path(os.devnull), full)


def test_a_library_that_does_not_end_is_ended_by_its_processor_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever else the machine does: a limit of a second of the clock would refuse good files on a busy one."""
    (tmp_path / "h5py.py").write_text("while True:\n    pass\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(hdf5_process, "SECONDS", 1)
    with pytest.raises(ValueError, match="reading it takes more than 1 s of processor time: allowed is a file that h5dump can read"):
        hdf5_process.from_hdf5(b"\x89HDF\r\n\x1a\n", Wanted(None, None), 100)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such limits")
def test_a_limit_on_processor_time_that_the_user_has_set_makes_no_file_unreadable(tmp_path: Path) -> None:
    """A process may lower its hard limit and not raise it: `ulimit -t`, or a batch system's."""
    with h5py.File(tmp_path / "modes.h5", "w") as file:
        file["sigma"] = np.array([0.25 - 1j, 0.5])
    told = (
        "import pathlib, resource\n"
        "from shootstab.io.arrays import Wanted\nfrom shootstab.io.hdf5_process import from_hdf5\n"
        "resource.setrlimit(resource.RLIMIT_CPU, (600, 600))\n"
        f"print(from_hdf5(pathlib.Path({str(tmp_path / 'modes.h5')!r}).read_bytes(), Wanted(None, None), 100).tolist())"
    )
    done = subprocess.run([sys.executable, "-c", told], capture_output=True, text=True, check=False)
    assert done.stdout.strip() == "[(0.25-1j), (0.5+0j)]", done.stderr


def test_what_the_process_that_reads_a_file_raises_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hdf5_process, "SECONDS", "no number")
    with pytest.raises(ValueError, match="could not read: ValueError: invalid literal"):
        hdf5_process.from_hdf5(b"\x89HDF\r\n\x1a\n", Wanted(None, None), 100)
