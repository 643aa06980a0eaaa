"""Files that anybody may have written: every reader against mutants of valid files and files built to be odd.

`python validation/fuzz_files.py --minutes 10` records; `--number N` of each kind; `--kind spectrum` one kind; `--keep DIR` stores what is
found. Kinds: spectrum (csv, text, json, npy, npz, MATLAB, HDF5, Legolas), scene, certificate, baseline, store. A file must be read, or
refused by an error that the program raises on purpose, in one line that speaks of the file and not of a library's types; within 2 s of
processor time and 256 MiB, without a warning, whatever its bytes. A certificate that is read may take longer to be checked: that is its
proof and not its reading. Mutants run in forked children, which a crash or a limit ends. Exit status 1 if a rule is broken.
"""

from __future__ import annotations

import argparse
import io
import json
import os
import random
import re
import resource
import select
import signal
import struct
import sys
import tempfile
import time
import warnings
import zipfile
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

SECONDS, MEMORY = 2.0, 256 * 2**20  # chosen
CHECKING = 60.0  # chosen: seconds of a certificate that is one
SOLVING = 20.0  # chosen: seconds of a scene whose base flow is the solution of equations: those are solved, not only read
BATCH = 200  # chosen: mutants a child
LOOKED_AT = 65536  # chosen: bytes of a file in which a base flow is looked for
LIBRARY = re.compile(
    r"unsupported operand|object is not|NoneType|has no attribute|positional argument|unexpected keyword|index out of|out of bounds"
    r"|buffer size|unhashable|not subscriptable|invalid literal|could not convert|Exceeds the limit|codec can't|must be str|Traceback"
    r"|maximum recursion|not supported|between instances|to unpack|cannot reshape|broadcast|allow_pickle|bad marshal",
    re.IGNORECASE,
)


@dataclass(frozen=True)
class Kind:
    """What is read: valid files, words that mean something in them, and the reader."""

    seeds: Callable[[], list[bytes]]
    words: list[str]
    suffix: str
    read: Callable[[Path], None]


# valid files

SCENES = Path(__file__).parent.parent / "shootstab" / "models" / "catalogue" / "scenes"
Z = np.array([0.0039705046 + 0j, -0.0035 - 0.0071j, 1.5 + 2e-7j, -1e-3 + 2j])


def spectra() -> list[bytes]:
    """One spectrum in every format."""
    texts = [
        "re,im\n0.004,0\n-1e-3,2\n",
        "# idx re im\n1 0.004 0\n2 -1e-3 2\n",
        " (4.0D-03,0.0D+00)\n (-1.0D-03,2.0d0)\n",
        "0,004;0\n-1,0e-3;2,0\n",
        "0.004\n-1e-3+2*I\n",
        '{"eigenvalues": [{"re": "0.004", "im": "0.0"}, [-1e-3, 2], 3]}',
        '{"omega_r": [0.004, -1e-3], "omega_i": [0, 2], "k": [1, 2]}',
        '[0.1, NaN, [2, Infinity], [1e20, 1], "1+2j"]',
    ]
    arrays = [Z, np.column_stack((Z.real, Z.imag)), np.diag(Z), Z.real, np.array([Z, Z]), np.asfortranarray(np.array([Z, Z]))]
    binary = [npy(a) for a in arrays] + [npz(re=Z.real, im=Z.imag, k=Z.real), npz(eigenvalues=Z), *matlab(), *legolas()]
    return [t.encode() for t in texts] + binary + hdf5()


def npy(array: Any) -> bytes:
    out = io.BytesIO()
    np.save(out, array)
    return out.getvalue()


def npz(**arrays: Any) -> bytes:
    out = io.BytesIO()
    np.savez_compressed(out, **arrays)
    return out.getvalue()


def matlab() -> list[bytes]:
    import scipy.io

    nested = {"s": {"lam": Z, "note": "text"}, "c": np.array([Z, "x", 1.0], dtype=object)}
    found = []
    for variables in ({"lam": Z}, {"re": Z.real, "im": Z.imag}, nested, {"A": np.eye(3), "flag": True}):
        for packed in (False, True):
            out = io.BytesIO()
            scipy.io.savemat(out, variables, do_compression=packed)
            found.append(out.getvalue())
    return found


def legolas() -> list[bytes]:
    """A header of the old layout and one of 1.x, as Legolas' own reader walks them, and four frequencies."""
    values = Z.astype("<c16").tobytes()

    def integers(*x: int) -> bytes:
        return struct.pack(f"<{len(x)}i", *x)

    def reals(n: int) -> bytes:
        return struct.pack(f"<{n}d", *([1.0] * n))

    geometry = b"Cartesian".ljust(12)
    old = integers(12, 4) + geometry + reals(2) + integers(4, 8, len(Z), 8) + reals(1) + b"equilibrium " + integers(1, 0)
    old += integers(2) + b"k2  k3  " + reals(2) + integers(1) + b"rho0" + integers(0) + reals(11) + values
    new = b"legolas_version" + b"1.1.2".ljust(10) + integers(12, 4) + geometry + reals(2) + integers(4, 8, len(Z), 8) + reals(1)
    new += b"equilibrium " + integers(1, 0) + integers(1, 4) + b"k2  " + reals(1) + integers(1, 4) + b"rho0" + integers(0)
    new += integers(1, 4) + b"unit" + reals(1) + integers(len(Z)) + values
    return [old, new]


def hdf5() -> list[bytes]:
    """Plain ones, and one of everything that HDF5 has and a spectrum does not: links out, cycles, references, empties, giants."""
    try:
        import h5py
    except ImportError:
        return []

    def made(write: Callable[[Any], None], **how: Any) -> bytes:
        out = io.BytesIO()
        with h5py.File(out, "w", **how) as file:
            write(file)
        return out.getvalue()

    def fill(**items: Any) -> Callable[[Any], None]:
        def write(file: Any) -> None:
            for name, item in items.items():
                file[name] = item

        return write

    def odd(file: Any) -> None:
        file["null"] = h5py.Empty("f8")
        file["none"] = np.zeros((0, 2))
        file["scalar"] = 1.0
        file["text"] = "x"
        file["out"] = h5py.ExternalLink("/etc/passwd", "/x")
        file["device"] = h5py.ExternalLink("/dev/zero", "/x")
        file["soft"] = h5py.SoftLink("/soft")
        file["hard"] = file["/"]
        file.create_dataset("giant", shape=(2**40,), dtype="c16", chunks=(1024,))
        file.create_dataset("elsewhere", shape=(4,), dtype="f8", external=[("/etc/passwd", 0, 32)])
        file.create_dataset("refs", data=[file["scalar"].ref], dtype=h5py.ref_dtype)
        file.create_dataset("ragged", shape=(2,), dtype=h5py.vlen_dtype("f8"))
        file["enum"] = np.zeros(3, dtype=h5py.enum_dtype({"a": 0, "b": 1}))
        file["pairs"] = np.zeros(3, dtype=[("re", "f8"), ("im", "f8")])
        file["nested"] = np.zeros(2, dtype=[("re", "f8", (2,)), ("im", "f8", (2,))])
        file["mixed"] = np.zeros(2, dtype=[("re", "S3"), ("im", "f8")])

    def virtual(file: Any) -> None:
        layout = h5py.VirtualLayout(shape=(4,), dtype="f8")
        layout[:] = h5py.VirtualSource("/etc/passwd", "x", shape=(4,))
        file.create_virtual_dataset("eigenvalues", layout)

    def packed(file: Any) -> None:
        file.create_dataset("sigma", data=np.tile(Z, 100), compression="gzip", shuffle=True)

    halves = {"run/re": Z.real, "run/im": Z.imag}
    return [
        made(fill(grid=Z)),
        made(fill(**halves)),
        made(fill(a=np.eye(3), sigma=Z), userblock_size=512),
        made(odd),
        made(virtual),
        made(packed),
    ]


def scenes() -> list[bytes]:
    """One of every kind of scene file, and all that are built in: layers, interfaces, amplitudes, [about] and [published]."""
    chute = (
        '[flow]\ne = 0.8\ne_w = 0.8\nr = 0.6\ntan_theta = 0.3\nnu_max = 0.62\nmass_flux = 3.0\nbranch = "high"\n'
        "[wave]\nkx = 0.0\nky = 0.01\n"
    )
    plate = (
        '[problem]\nunknowns = ["u"]\nparameters = { R = 100, a = 1 }\nwhere = { U = "1 - z**2" }\n'
        'equations = ["sigma*u = d(u,2)/R - 1i*a*U*u - a**2*u"]\n'
        'left = { at = -1, conditions = ["u"] }\nright = { at = 1, conditions = ["d(u)"] }\n'
    )
    line = (
        '[problem]\nunknowns = ["u"]\nequations = ["sigma*u = d(u,2) + 2/cosh(z)**2*u"]\nleft = "infinity"\nright = "infinity"\n'
        "reference = [1, 0.1]\n"
    )
    axis = (
        '[problem]\nunknowns = ["u"]\nequations = ["sigma*u = d(u,2) + d(u)/r - 4*u/r**2"]\nvariable = "r"\nleft = { axis = 0 }\n'
        'right = { at = 1, conditions = ["u"] }\n'
    )
    own = [t.encode() for t in (chute, chute.replace('mass_flux = 3.0\nbranch = "high"', "far_temperature = 7.0"), plate, line, axis)]
    return own + [path.read_bytes() for path in sorted(SCENES.glob("*.toml"))]


def certificates() -> list[bytes]:
    """Certificates of a mode at R = 100, cheap to check."""
    steps = ["0.250000", "0.250000", "0.250000"]
    found = {"format": 2, "problem": {"name": "plane Poiseuille", "reynolds": "100.0", "alpha": "1.0", "modes": "even"}, "count": 1}
    found |= {"region": {"re": "-0.1627", "im": "-0.4629", "radius": "0.01"}, "outer": "0.2", "weight": "8.0"}
    whole = {**found, "points": 6, "bits": 60, "order": 40, "steps": steps}
    growing = {**whole, "region": {"floor": "0.1"}, "count": 0}
    return [json.dumps(c).encode() for c in (whole, growing, {"format": 2, "parts": [whole, growing]})]


def baselines() -> list[bytes]:
    """Two modes of a scene."""
    from shootstab.io.baselines import Baseline

    return [Baseline.of("poiseuille", [(complex(sigma), 1e-13) for sigma in Z[:2]], 8).text.encode()]


AXES, DEFINITION = {"kx": (0.0, 1.0), "ky": (0.5,)}, {"format": 2, "axes": {"kx": [0.0, 1.0], "ky": [0.5]}}


def stores() -> list[bytes]:
    """A file of results with one of two points done."""
    from shootstab.analyses.sweep.outcomes import PROVED, Outcome
    from shootstab.analyses.sweep.store import Store

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.sqlite"
        with Store(path, tuple(AXES), DEFINITION) as store:
            store.add([(0.0, 0.5)], [Outcome(PROVED, True, 0.1 + 0.2j, 1e-9, 1e-8, 5, {"far_temperature": 7.0})])
        return [path.read_bytes()]


# readers


def read_spectrum(path: Path) -> None:
    from shootstab.io import readers

    for dataset, row in ((None, None), ("sigma", None), (None, 1)):
        try:
            limit(SECONDS)
            found = readers.read(path, dataset, row)
        except ValueError:
            if dataset is row is None:
                first = sys.exc_info()[1]
            continue
        assert found.values.dtype == np.complex128 and np.isfinite(found.values).all() and len(found) > 0
    if "first" in locals():
        raise first


def read_scene(path: Path) -> None:
    from shootstab.io import scenes

    assert scenes.load(str(path)).problem.size > 0


def read_certificate(path: Path) -> None:
    from shootstab.analyses import certificate

    found = certificate.read(path)
    limit(CHECKING)
    reason = certificate.check(found)
    assert reason is None or "\n" not in reason
    if reason is not None and LIBRARY.search(reason):
        raise AssertionError(f"a library's words: {reason}")


def read_baseline(path: Path) -> None:
    from shootstab.io import baselines

    found = baselines.load(path)
    assert found.modes and all(difference.holds for difference in found.differences([sigma for sigma, _ in found.modes]))


def read_store(path: Path) -> None:
    from shootstab.analyses.sweep.grid import ParameterAxis, SweepGrid
    from shootstab.analyses.sweep.store import Store

    grid = SweepGrid(tuple(ParameterAxis(name, values) for name, values in AXES.items()))
    with Store(path, tuple(AXES), DEFINITION) as store:
        assert set(store.done(grid)) == set(store.results())


WORDS = {
    "spectrum": """re im eigenvalues nan inf 1e999 - + , ; j [ { } " : null true # ( )""",
    "scene": """= [ ] { } " ' [flow] [wave] [problem] d( ** * / ( ) sigma u z i exp( cosh( 9**9**9**9 inf nan true 1979-05-27 infinity at
        conditions axis periodic parameters where interfaces before( after( jump( amplitudes [about] [published] value digits order""",
    "certificate": """" [ ] { } , : null NaN - e . true 0 1""",
    "baseline": """[[mode]] re im error digits scene = " nan inf 1e999 true [ ] { } -1""",
    "store": "points sweep proved NULL CREATE TABLE kx",
}
KINDS = {
    "spectrum": Kind(spectra, WORDS["spectrum"].split(), ".dat", read_spectrum),
    "scene": Kind(scenes, WORDS["scene"].split(), ".toml", read_scene),
    "certificate": Kind(certificates, WORDS["certificate"].split(), ".json", read_certificate),
    "baseline": Kind(baselines, WORDS["baseline"].split(), ".toml", read_baseline),
    "store": Kind(stores, WORDS["store"].split(), ".sqlite", read_store),
}

NUMBERS = (
    "0",
    "-1",
    "1",
    "1e308",
    "-1e-320",
    "1e999",
    "nan",
    "inf",
    "9" * 5000,
    "0x" + "f" * 6000,
    "1_0",
    "0.1" * 40,
    "2147483648",
    "1e15",
    "",
    "−1",
    "½",
    "٣",
)
SIZES = (0, 1, 2, 0x7F, 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 2**40, 2**63 - 1, 2**64 - 1)  # chosen


def mutant(rng: random.Random, kind: Kind, seeds: list[bytes]) -> bytes:
    """A seed with some changes: of its tokens where it is text, of its fields where it is not, of its members where it is an archive."""
    data = rng.choice(seeds)
    if data[:2] == b"PK" and rng.random() < 0.7:
        return archive(rng, kind, data)
    for _ in range(rng.choice((1, 1, 1, 2, 3, 8))):
        text = b"\0" not in data[:200]
        change = rng.choice(TEXTUAL if text and rng.random() < 0.8 else BINARY)
        data = change(rng, kind, data, seeds)
    return data[: 2**20]


def archive(rng: random.Random, kind: Kind, data: bytes) -> bytes:
    """An npz file whose members are mutants, or are called or packed otherwise."""
    out = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as old, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        members = [(name, old.read(name)) for name in old.namelist()]
        with zipfile.ZipFile(out, "w", rng.choice((zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA))) as new:
            for name, content in members:
                if rng.random() < 0.7:
                    content = rng.choice(BINARY)(rng, kind, content, [content])
                if rng.random() < 0.1:
                    content = bytes(rng.choice((10**6, 7 * 10**7)))
                new.writestr(rng.choice((name, name, name, "a/../b.npy", "eigenvalues.npy", ".npy")), content)
    return out.getvalue()


Change = Callable[[random.Random, Kind, bytes, list[bytes]], bytes]


def _token(rng: random.Random, kind: Kind, data: bytes, _: list[bytes]) -> bytes:
    tokens = re.findall(rb"\s+|[\w.+-]+|.", data, re.DOTALL) or [b""]
    i, j = rng.randrange(len(tokens)), rng.randrange(len(tokens))
    how = rng.randrange(6)
    if how == 0:
        tokens[i] = rng.choice(kind.words).encode()
    elif how == 1:
        tokens.insert(i, rng.choice(kind.words).encode())
    elif how == 2:
        del tokens[i]
    elif how == 3:
        tokens[i], tokens[j] = tokens[j], tokens[i]
    elif how == 4:
        tokens[i : i + 1] = [tokens[i]] * rng.choice((2, 3, 200))
    else:
        tokens[i:i] = tokens[min(i, j) : max(i, j)]
    return b"".join(tokens)


def _number(rng: random.Random, _: Kind, data: bytes, __: list[bytes]) -> bytes:
    places = list(re.finditer(rb"[\d.]+(?:e[+-]?\d+)?", data))
    if not places:
        return data
    at = rng.choice(places)
    return data[: at.start()] + rng.choice(NUMBERS).encode() + data[at.end() :]


def _nested(rng: random.Random, _: Kind, data: bytes, __: list[bytes]) -> bytes:
    at, (left, right) = rng.randrange(len(data) + 1), rng.choice((b"[]", b"{}", b"()", b'""', b"(-"))
    left, right = bytes([left]), bytes([right])
    return data[:at] + left * rng.choice((1, 50, 5000, 200000)) + right * rng.choice((0, 1, 50, 5000)) + data[at:]


def _bytes(rng: random.Random, _: Kind, data: bytes, __: list[bytes]) -> bytes:
    changed = bytearray(data)
    for _i in range(rng.choice((1, 1, 4, 32))):
        if changed:
            changed[rng.randrange(len(changed))] = rng.choice((0, 0xFF, 0x80, 0x7F, rng.randrange(256)))
    return bytes(changed)


def _field(rng: random.Random, _: Kind, data: bytes, __: list[bytes]) -> bytes:
    size = rng.choice((1, 2, 4, 8))
    if len(data) < 8:
        return data
    at = rng.randrange(0, len(data) - size + 1)
    at -= at % rng.choice((1, size))
    value = rng.choice(SIZES) & (256**size - 1)
    return data[:at] + value.to_bytes(size, rng.choice(("little", "big"))) + data[at + size :]


def _cut(rng: random.Random, _: Kind, data: bytes, __: list[bytes]) -> bytes:
    i, j = sorted(rng.randrange(len(data) + 1) for _i in range(2))
    return rng.choice((data[:i], data[i:], data[:i] + data[j:], data[:j] + data[i:], data + bytes(rng.choice((1, 512, 10**5)))))


def _spliced(rng: random.Random, _: Kind, data: bytes, seeds: list[bytes]) -> bytes:
    other = rng.choice(seeds)
    return data[: rng.randrange(len(data) + 1)] + other[rng.randrange(len(other) + 1) :]


TEXTUAL: tuple[Change, ...] = (_token, _token, _token, _number, _number, _nested, _cut, _spliced)
BINARY: tuple[Change, ...] = (_bytes, _field, _field, _cut, _spliced)


# giants


def giants() -> Iterator[tuple[str, bytes]]:
    """Files of up to 100 MB, of every kind, that make a careless reader take gigabytes or minutes."""
    big = 60 * 2**20
    for unit in (b"1,2\n", b"1 ", b"(", b"#", b"\n", "1,2\n½\n".encode(), b"\0", b"\xff", b"9"):
        yield "spectrum", unit * (big // len(unit))
    yield "spectrum", b"1\n" * (50 * 2**20)
    for unit in (b"[],", b'{"re":1,"im":2},', b"[1,2],", b"[", b'"x",', b"1,", b'{"a":'):
        yield "spectrum", b"[" + unit * (big // len(unit)) + b"0]"
        yield "spectrum", b"[" + unit * (15 * 2**20 // len(unit)) + b"0]"
    yield "spectrum", npy(np.zeros(big // 16, complex))
    yield "spectrum", npy(np.zeros((2000, 1000), complex))
    yield "spectrum", npz(a=np.zeros(31 * 2**20 // 16, complex))
    yield "spectrum", npz(re=np.zeros(31 * 2**20 // 8), im=np.zeros(31 * 2**20 // 8))
    yield "spectrum", npz(re=np.zeros(10**9 // 8), im=np.zeros(10))
    yield "spectrum", npz(**{f"a{i}": np.zeros(1) for i in range(1000)})
    yield "spectrum", b"PK\x03\x04" + b"PK\x01\x02".ljust(46, b"\0") * (big // 46)
    yield "spectrum", b"MATLAB 5.0 MAT-file".ljust(126) + b"IM" + bytes(big)
    yield "spectrum", b"legolas_version" + b"1.1.2".ljust(10) + bytes(big)
    try:
        import h5py
    except ImportError:
        return
    for write in (
        lambda f: f.create_dataset("x", data=np.zeros(big // 16, complex)),
        lambda f: f.create_dataset("x", data=np.zeros(31 * 2**20 // 16, dtype=[("re", "f8"), ("im", "f8")])),
        lambda f: [f.create_dataset(n, data=np.zeros(31 * 2**20 // 8), compression="gzip") for n in ("re", "im")],
        lambda f: [f.create_group(f"g{i}") for i in range(40_000)],
        lambda f: f.create_dataset("x", data=np.zeros((1400, 1400), complex), compression="gzip"),
    ):
        out = io.BytesIO()
        with h5py.File(out, "w") as file:
            write(file)
        yield "spectrum", out.getvalue()
    for unit in (b"a = 1\n", b"[[x]]\n", b"a.", b"[", b"#", b'"', b"\n"):
        yield "scene", unit * (2**17 // len(unit) - 1)
        yield "scene", unit * (100 * 2**20 // len(unit))
    for unit in (b"[", b"[],", b'{"a":', b"1"):
        yield "certificate", unit * (2**20 // len(unit) - 1)
        yield "certificate", unit * (100 * 2**20 // len(unit))
    whole = stores()[0]
    yield "store", whole + bytes(100 * 2**20 - len(whole))
    yield "store", bytes(100 * 2**20)


# children


def limit(seconds: float) -> None:
    """Allow so much processor time from here on."""
    signal.setitimer(signal.ITIMER_PROF, seconds)


class TooSlowError(BaseException):
    """The signal that time is up, which no reader may catch."""


def outcome(kind: Kind, path: Path) -> tuple[str, str]:
    """('read' or 'refused' or 'WRONG', a sentence)."""
    from shootstab.core.errors import InputError, ShootstabError

    try:
        with path.open("rb") as file:
            limit(SOLVING if b"base" in file.read(LOOKED_AT) else SECONDS)
        kind.read(path)
    except InputError as error:
        words = str(error)
        if LIBRARY.search(words.replace(str(path), "")):
            return "WRONG", f"a library's words: {words[:300]}"
        return ("WRONG", f"a line of {len(words)} characters") if len(words) > 1000 else ("refused", words)
    except ShootstabError as error:
        return "no answer", str(error)
    except TooSlowError:
        return "WRONG", "too slow"
    except BaseException as error:
        import traceback

        where = "; ".join(f"{Path(f.filename).name}:{f.lineno}" for f in traceback.extract_tb(error.__traceback__)[-3:])
        return "WRONG", f"{type(error).__name__}: {str(error)[:200]} at {where}"
    finally:
        limit(0.0)
    return "read", ""


def child(kind: Kind, path: Path, mutants: list[bytes], out: int) -> None:
    """Read each, and say how it went in a line of JSON."""

    def stop(*_: object) -> None:
        raise TooSlowError

    signal.signal(signal.SIGPROF, stop)
    warnings.simplefilter("error")
    for number, data in enumerate(mutants):
        path.write_bytes(data)
        os.write(out, f"{number}\n".encode())
        before = memory(reset=True)
        said, words = outcome(kind, path)
        grown = memory() - before
        if grown > MEMORY and said != "WRONG":
            said, words = "WRONG", f"{grown >> 20} MiB"
        os.write(out, (json.dumps([said, words, grown]) + "\n").encode())
    os._exit(0)


def memory(reset: bool = False) -> int:
    """Bytes: the peak since the last reset, or what there is at one. Linux tells; elsewhere the peak of all time."""
    try:
        if reset:
            Path("/proc/self/clear_refs").write_text("5")
        found = re.search(r"VmHWM:\s+(\d+)", Path("/proc/self/status").read_text())
        return int(found[1]) * 1024 if found else 0
    except OSError:
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def batch(kind: Kind, path: Path, mutants: list[bytes]) -> list[tuple[str, str, int]]:
    """What became of each, in as many children as die at one."""
    found: list[tuple[str, str, int]] = []
    while len(found) < len(mutants):
        ours, theirs = os.pipe()
        sys.stdout.flush()
        pid = os.fork()
        if pid == 0:
            os.close(ours)
            child(kind, path, mutants[len(found) :], theirs)
        os.close(theirs)
        with os.fdopen(ours) as lines:
            while True:
                ready, _, _ = select.select([lines], [], [], CHECKING + 30)
                line = lines.readline() if ready else None
                if not line:
                    break
                if line.startswith("["):
                    found.append(tuple(json.loads(line)))
            if line is None:
                os.kill(pid, signal.SIGKILL)
        _, status = os.waitpid(pid, 0)
        if len(found) < len(mutants):
            found.append(("WRONG", "waits for ever" if line is None else f"the process died with {os.waitstatus_to_exitcode(status)}", 0))
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=10.0, metavar="X", help="in all")
    parser.add_argument("--number", type=int, metavar="N", help="so many mutants of each kind, in place of minutes")
    parser.add_argument("--kind", choices=KINDS, action="append", help="this kind (default: all)")
    parser.add_argument("--giants", action="store_true", help="files of up to 100 MB first")
    parser.add_argument("--seed", type=int, default=1, metavar="N")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="where what broke a rule is stored")
    options = parser.parse_args()
    import shootstab.analyses.certificate
    import shootstab.analyses.sweep.store
    import shootstab.formulation.equation_scene
    import shootstab.io.readers
    import shootstab.io.scenes  # noqa: F401

    rng, kinds = random.Random(options.seed), options.kind or list(KINDS)
    counts: dict[str, Counter[str]] = {name: Counter() for name in kinds}
    wrong: dict[str, list[bytes]] = {}
    peak, began = 0, time.monotonic()

    def judged(name: str, files: list[bytes]) -> None:
        nonlocal peak
        for data, (said, words, grown) in zip(files, batch(KINDS[name], path, files), strict=True):
            counts[name][said] += 1
            peak = max(peak, grown)
            if said == "WRONG":
                key = f"{name}: {re.sub(r'[0-9]+', 'N', words)}"
                if key not in wrong:
                    print(f"  WRONG {name}, {len(data)} bytes: {words}", flush=True)
                wrong.setdefault(key, []).append(data[: 2**20])

    with tempfile.TemporaryDirectory(prefix="shootstab-fuzz-") as folder:
        path = Path(folder) / "file"
        for name, data in giants() if options.giants else ():
            if name not in kinds:
                continue
            path = Path(folder) / f"file{KINDS[name].suffix}"
            judged(name, [data])
        begun = False
        while True:
            for name in kinds:
                kind = KINDS[name]
                seeds = kind.seeds()
                path = Path(folder) / f"file{kind.suffix}"
                untouched = seeds[:BATCH] if not begun else []
                size = BATCH if options.number is None else max(0, min(BATCH, options.number - counts[name].total()))
                mutants = [*untouched, *(mutant(rng, kind, seeds) for _ in range(max(0, size - len(untouched))))]
                judged(name, mutants)
            begun = True
            enough = options.number is not None and all(c.total() >= options.number for c in counts.values())
            if enough or (options.number is None and time.monotonic() - began > 60 * options.minutes):
                break
    for name, c in counts.items():
        print(f"{name:12} {c.total():7d} files: " + ", ".join(f"{n} {said}" for said, n in c.most_common()))
    if options.keep is not None:
        options.keep.mkdir(parents=True, exist_ok=True)
        for number, (key, found) in enumerate(sorted(wrong.items())):
            smallest = min(found, key=len)
            name = key.partition(":")[0]
            (options.keep / f"{number:03d}{KINDS[name].suffix}").write_bytes(smallest)
            print(f"{number:03d} {len(found)} times, {len(smallest)} bytes: {key}")
    total, took = sum(c.total() for c in counts.values()), time.monotonic() - began
    print(f"{total} files, {len(wrong)} kinds of fault, peak {peak >> 20} MiB, {took:.0f} s")
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main())
