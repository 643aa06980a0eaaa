"""Files that anybody may have written, the smallest that broke a rule or could: refused in a line that speaks of the file, and at once.

What a fuzzer found (validation/fuzz_files.py) is kept here. A refusal uses no word of a library, nothing is waited for, nothing unpickled,
and nothing outside the file is opened.
"""

from __future__ import annotations

import io
import os
import sqlite3
import struct
import time
import zipfile
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from shootstab.analyses import certificate
from shootstab.analyses.sweep.grid import ParameterAxis, SweepGrid
from shootstab.analyses.sweep.outcomes import PROVED, Outcome
from shootstab.analyses.sweep.store import Store
from shootstab.core.errors import InputError
from shootstab.io import readers, scenes
from shootstab.io.text import MOST_EIGENVALUES

Z = np.array([0.1 + 0.2j, -0.3 + 1j])
DIGITS = "9" * 5000
FLOW = "e = 0.8\ne_w = 0.8\nr = 0.6\ntan_theta = 0.3\nfar_temperature = 7.0\n"
PAGE = 4096  # bytes of a page of SQLite


class Trap:
    """Unpickled, it would leave a trace."""

    def __reduce__(self) -> Any:
        return os.mkdir, ("unpickled",)


def npy(array: Any, pickled: bool = False) -> bytes:
    out = io.BytesIO()
    np.save(out, array, allow_pickle=pickled)
    return out.getvalue()


def claims_more() -> bytes:
    out = io.BytesIO()
    np.lib.format.write_array_header_1_0(out, {"descr": "<c16", "fortran_order": False, "shape": (10**9,)})
    return out.getvalue() + Z.tobytes()


def many_members() -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for i in range(1001):
            archive.writestr(f"{i}.npy", b"")
    return out.getvalue()


def hdf5(write: Callable[[Any], None]) -> bytes:
    h5py = pytest.importorskip("h5py")
    out = io.BytesIO()
    with h5py.File(out, "w") as file:
        write(file)
    return out.getvalue()


def null_dataset() -> bytes:
    def write(file: Any) -> None:
        import h5py

        file["eigenvalues"] = h5py.Empty("f8")

    return hdf5(write)


def fields_of_texts() -> bytes:
    return hdf5(lambda file: file.create_dataset("x", data=np.zeros(2, dtype=[("re", "S3"), ("im", "f8")])))


SPECTRA: dict[str, tuple[Callable[[], bytes], str]] = {
    "an integer of 5000 digits in JSON": (lambda: f"[{DIGITS}]".encode(), "an integer of thousands of digits"),
    "JSON nested too deep": (lambda: b"[" * 100_000, "nested too deep"),
    "JSON of a million empty lists": (lambda: b"[" + b"[]," * 10**6 + b"[]]", "more than 1000000 lists"),
    "text that stops being UTF-8": (lambda: b"1,2\n" * 20_000 + b"\xff,1\n", "line 20001: not UTF-8"),
    "a line of a megabyte": (lambda: b"1 " * 500_000, "line 1: longer than 10000 characters"),
    "200,001 lines": (lambda: b"1\n" * 200_002, "more than 200000 lines"),
    "one more than may be": (lambda: b"1\n" * (MOST_EIGENVALUES + 1), f"more than {MOST_EIGENVALUES} eigenvalues"),
    "one more than may be, binary": (lambda: npy(np.ones(MOST_EIGENVALUES + 1)), f"more than {MOST_EIGENVALUES} eigenvalues"),
    "20 MB of text": (lambda: b"# remark\n" + b"#" * 20 * 2**20, "more than 16 MB of text"),
    "a pickle in npy": (lambda: npy(np.array([Trap()], dtype=object), pickled=True), "never unpickled"),
    "npy that says it holds more": (claims_more, "more numbers than it holds"),
    "npz of 1001 members": (many_members, "more than 1000 arrays"),
    "MATLAB of 2000 empty elements": (
        lambda: b"MATLAB 5.0 MAT-file".ljust(126) + b"\x01IM"[1:] + bytes(16_000),
        "more than 1000 variables",
    ),
    "an HDF5 dataset of nothing": (null_dataset, "arrays in it: none"),
    "HDF5 fields of texts": (fields_of_texts, "numbers both"),
    "a Legolas of 2³¹ − 1 values": (
        lambda: b"legolas_version" + b"1.1.2".ljust(10) + struct.pack("<2i", 12, 4) + b"Cartesian   " + b"\x7f\xff\xff\xff" * 40,
        "broken Legolas file",
    ),
}

SCENES = {
    "not UTF-8": (b"[flow]\ne = 0.8\n\xff", "line 3: not UTF-8"),
    "an integer of 5000 digits": (f"[flow]\ne = {DIGITS}\n".encode(), "an integer of thousands of digits"),
    "an integer of 6000 hexadecimal digits": (
        f"[flow]\n{FLOW}nu_max = 0x{'f' * 6000}\n[wave]\nkx = 0.0\n".encode(),
        "an? int too large to be shown",
    ),
    "nested too deep": (b"a = " + b"[" * 5000, "nested too deep"),
    "a dotted key of thousands": (b"[flow]\n" + b".".join([b"a"] * 60_000) + b" = 1\n", "line 2: a key of more than 100 parts"),
    "a dotted key of digits": (b".".join([b"1"] * 60_000) + b" = 1\n", "line 1: a key of more than 100 parts"),
    "a header of thousands": (b"[" + b".".join([b'"a"'] * 30_000) + b"]\n", "line 1: a key of more than 100 parts"),
    "more than 128 kB": (b"#" * (2**17 + 1), "larger than 0.125 MB"),
    "a number of 5000 digits in a formula": (
        f'[problem]\nunknowns = ["u"]\nequations = ["sigma*u = d(u,2) + {DIGITS}*u"]\nleft = "infinity"\nright = "infinity"\n'.encode(),
        "a number of 5000 characters",
    ),
    "a reference that overflows": (
        b'[problem]\nunknowns = ["u"]\nequations = ["sigma*u = d(u,2) + 2/cosh(z)**2*u"]\nleft = "infinity"\nright = "infinity"\n'
        b"reference = [1e308, 0.1]\n",
        "reference = ",
    ),
    "a place that no double holds": (
        b'[problem]\nunknowns = ["u"]\nequations = ["sigma*u = d(u,2)"]\nright = "infinity"\nleft = { conditions = ["u"], at = 0x'
        + b"f" * 400
        + b" }",
        "at = ",
    ),
    "a fold that no double holds": (
        b'[problem]\nunknowns = ["u"]\nequations = ["sigma*u = d(u,2)"]\nleft = "infinity"\nright = "infinity"\nfold = 0x' + b"f" * 400,
        "fold = ",
    ),
    **{
        f"an axis and {what}": (
            f"""[problem]\nunknowns = ["u"]\nequations = ["sigma*u = d(u,2) + d(u)/r + {term}"]\nvariable = "r"\nleft = {{ axis = {at} }}
right = {{ at = 1, conditions = ["u"] }}""".encode(),
            says,
        )
        for what, term, at, says in (
            ("a power of a billion", "u*r**1e9", 0, "no power series with a pole"),
            ("a power of two to a billion", "u/r**2**1e9", 0, r"exp of a number beyond 2\*\*4096"),
            ("a number of 600 digits", "u*(1e200 + r)**3", 0, "a number beyond 1e308"),
            ("a logarithm", "u*log(r)", 0, "no power series with a pole"),
            ("an ordinary point there", "u", -1, "2 of 2 solutions are regular at r = -1"),
        )
    },
}

PLANE = {"name": "plane Poiseuille", "reynolds": "100.0", "alpha": "1.0", "modes": "even"}
DISC = {"re": "-0.1627", "im": "-0.4629", "radius": "0.01"}
CERTIFICATE: dict[str, Any] = {"format": 2, "problem": PLANE, "count": 1, "region": DISC, "outer": "0.2", "weight": "8.0", "bits": 60}
ENDLESS = {"points": 4096, "order": 5000, "steps": ["0.0001"] * 9000}


def refused(read: Callable[[], object], path: Path, says: str) -> None:
    began = time.process_time()
    with pytest.raises(InputError, match=says) as refusal:
        read()
    line = str(refusal.value)
    assert time.process_time() - began < 2.0
    assert str(path) in line
    assert "\n" not in line
    assert len(line) < 600
    assert not any(word in line for word in ("codec", "Exceeds", "object is", "NoneType", "operand", "dtype", "literal"))


def stored(folder: Path, data: bytes, name: str = "file") -> Path:
    path = folder / name
    path.write_bytes(data)
    return path


@pytest.mark.parametrize("what", SPECTRA)
def test_spectra(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, what: str) -> None:
    monkeypatch.chdir(tmp_path)
    make, says = SPECTRA[what]
    path = stored(tmp_path, make())
    refused(lambda: readers.read(path), path, says)
    assert not (tmp_path / "unpickled").exists()


@pytest.mark.parametrize("what", SCENES)
def test_scenes(tmp_path: Path, what: str) -> None:
    data, says = SCENES[what]
    path = stored(tmp_path, data, "scene.toml")
    refused(lambda: scenes.load(str(path)), path, says)


def test_certificates(tmp_path: Path) -> None:
    for data, says in ((b"\xff", "line 1: not UTF-8"), (b"[" * 100_000, "nested too deep"), (DIGITS.encode(), "thousands of digits")):
        path = stored(tmp_path, data)
        refused(lambda path=path: certificate.read(path), path, says)  # type: ignore[misc]
    endless = {**CERTIFICATE, **ENDLESS}
    for hostile, says in ((endless, "more work than any certificate needs"), ({"format": 2, "parts": [endless] * 1000}, "1000 parts")):
        began = time.process_time()
        reason = certificate.check(hostile)
        assert reason is not None and says in reason
        assert time.process_time() - began < 2.0


# what is no regular file

READS: dict[str, Callable[[Path], object]] = {
    "a spectrum": readers.read,
    "a scene": lambda path: scenes.load(str(path)),
    "a certificate": certificate.read,
    "a store": lambda path: Store(path, ("kx",), {}),
}


@pytest.mark.parametrize("kind", READS)
@pytest.mark.parametrize("target", ["/dev/zero", "/dev/urandom", "/dev/null", "/dev/full"])
def test_a_link_to_a_device(tmp_path: Path, kind: str, target: str) -> None:
    path = tmp_path / "link.toml"
    path.symlink_to(target)
    refused(lambda: READS[kind](path), path, "is a device|is no regular file")


@pytest.mark.parametrize("kind", READS)
def test_a_pipe_that_nobody_writes_to(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "pipe.toml"
    os.mkfifo(path)
    refused(lambda: READS[kind](path), path, "is empty|lacks|no regular file|broken JSON")


def test_a_pipe_that_somebody_writes_to(tmp_path: Path) -> None:
    """As `<(…)` of a shell gives it."""
    ours, theirs = os.pipe()
    os.write(theirs, b"1+2j\n")
    os.close(theirs)
    assert readers.read(f"/dev/fd/{ours}").values.tolist() == [1 + 2j]
    os.close(ours)


# stores

AXES = {"kx": (0.0, 1.0), "ky": (0.5,)}
GRID = SweepGrid(tuple(ParameterAxis(name, values) for name, values in AXES.items()))
DEFINITION = {"format": 2, "axes": {name: list(values) for name, values in AXES.items()}}
OUTCOME = Outcome(PROVED, True, 0.1 + 0.2j, 1e-9, 1e-8, 5, {"far_temperature": 7.0})


def kept(folder: Path, *commands: str) -> Path:
    """A file of results with one point of two, then changed by these commands."""
    path = folder / "a.sqlite"
    with Store(path, tuple(AXES), DEFINITION) as store:
        store.add([(0.0, 0.5)], [OUTCOME])
    with closing(sqlite3.connect(path)) as base:
        for command in commands:
            base.execute(command)
        base.commit()
    return path


def everything(path: Path) -> Any:
    with Store(path, tuple(AXES), DEFINITION) as store:
        assert set(store.done(GRID)) == set(store.results())
        return store.results()


def test_a_store_as_it_was_left(tmp_path: Path) -> None:
    path = kept(tmp_path)
    assert everything(path) == {(0.0, 0.5): OUTCOME}
    with Store(path, tuple(AXES), DEFINITION) as store:  # another run has done the same meanwhile
        store.add([(0.0, 0.5), (1.0, 0.5)], [OUTCOME, OUTCOME])
    assert everything(path) == {(0.0, 0.5): OUTCOME, (1.0, 0.5): OUTCOME}


@pytest.mark.parametrize(
    ("command", "says"),
    [
        ("UPDATE points SET kx = 0.25", "no point of its grid"),
        ("UPDATE points SET status = 'so so'", "is no result"),
        ("UPDATE points SET status = NULL", "is no result"),
        ("UPDATE points SET re = 'much'", "is no result"),
        ("UPDATE points SET im = NULL", "is no result"),
        ("UPDATE points SET proved = 7", "is no result"),
        ("UPDATE points SET beside = '[1]'", "is no result"),
        ("UPDATE points SET beside = '{'", "is no result"),
        ("UPDATE points SET status = CAST(x'ff' AS TEXT)", "not UTF-8|cannot be used"),
        ("UPDATE sweep SET definition = '[]'", "does not say which sweep"),
        ("UPDATE sweep SET definition = ''", "does not say which sweep"),
        ("DELETE FROM sweep", "does not say which sweep"),
        ("ALTER TABLE points ADD COLUMN more", "other columns"),
        ("CREATE TABLE third (x)", "holds other tables"),
        ("CREATE TRIGGER t AFTER INSERT ON points BEGIN DELETE FROM points; END", "holds other tables"),
        ("CREATE VIEW v AS SELECT 1", "holds other tables"),
    ],
)
def test_a_store_that_no_sweep_has_left(tmp_path: Path, command: str, says: str) -> None:
    path = kept(tmp_path, command)
    refused(lambda: everything(path), path, says)


def test_a_store_that_is_cut_off_anywhere(tmp_path: Path) -> None:
    """Of less than a page nothing is left to be lost: SQLite may take it for a new file. What is read of more is all that was there."""
    path = kept(tmp_path)
    data, whole = path.read_bytes(), everything(path)
    for length in range(1, len(data), 997):
        path.write_bytes(data[:length])
        try:
            assert everything(path) == ({} if length < PAGE else whole)
        except InputError as refusal:
            assert str(refusal).startswith(f"{path}: ")
