"""io/matlab.py, hdf5.py, legolas.py: spectra of other programs, and hostile files; io/conventions.py: what numbers mean."""

from __future__ import annotations

import io
import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io

import shootstab as st
from shootstab.core.errors import InputError
from shootstab.io import readers
from shootstab.io.conventions import Convention
from shootstab.problems.rescaled import Rescaled

h5py = pytest.importorskip("h5py")

Z = np.array([0.0039705046 + 0j, -0.0035 - 0.0071j, 1.5 + 2e-7j])


def stored(folder: Path, content: bytes, name: str = "modes.bin") -> Path:
    path = folder / name
    path.write_bytes(content)
    return path


def mat(compress: bool = False, **variables: Any) -> bytes:
    out = io.BytesIO()
    scipy.io.savemat(out, variables, do_compression=compress)
    return out.getvalue()


def hdf5(write: Any, userblock: int = 0) -> bytes:
    out = io.BytesIO()
    with h5py.File(out, "w", userblock_size=userblock) as file:
        write(file)
    data = bytearray(out.getvalue())
    if userblock:
        data[: len(b"MATLAB 7.3 MAT-file")] = b"MATLAB 7.3 MAT-file"
    return bytes(data)


def matlab_73(file: Any) -> None:
    """As MATLAB writes complex numbers: a compound of real and imag, in a column; and its own bookkeeping."""
    table = np.zeros((1, 3), dtype=[("real", "f8"), ("imag", "f8")])
    table["real"], table["imag"] = Z.real, Z.imag
    file["lambda"] = table
    file["#refs#/a"] = np.zeros(3)


def eigentools(file: Any) -> None:
    """Complex numbers as h5py itself writes them, beside other things."""
    file["grid"] = Z
    file["xx"] = np.linspace(0, 1, 3)
    file["name"] = "somebody's spectrum"


def pair(file: Any) -> None:
    file["run/spectrum/re"], file["run/spectrum/im"] = Z.real, Z.imag


def omega(file: Any) -> None:
    file["tasks/omega_r"], file["tasks/omega_i"], file["tasks/k"], file["x"] = Z.real, Z.imag, np.arange(3.0), np.ones(5)


def columns(file: Any) -> None:
    file["sigma"] = np.column_stack((Z.real, Z.imag))
    file["other"] = np.arange(4.0)


FORMS: dict[str, tuple[bytes, str | None]] = {
    "MATLAB": (mat(lam=Z), None),
    "MATLAB, compressed": (mat(True, lam=Z), None),
    "MATLAB, by name": (mat(a=np.arange(3.0), lam=Z), "lam"),
    "MATLAB, beside cells and text": (mat(c=np.array([1, "x"], dtype=object), s="text", lam=Z), None),
    "MATLAB, two columns": (mat(lam=np.column_stack((Z.real, Z.imag))), None),
    "MATLAB 7.3": (hdf5(matlab_73, 512), None),
    "MATLAB, the diagonal of [V, D] = eig(A)": (mat(V=np.ones((3, 3)), D=np.diag(Z)), "D"),
    "MATLAB, a field of a structure": (mat(out={"n": 3, "lambda": Z, "x": np.arange(3.0)}), "out.lambda"),
    "MATLAB, the only complex vector": (mat(out={"n": 3, "lambda": Z}, x=np.arange(3.0), V=np.ones((3, 3)) * 1j), None),
    "MATLAB, an entry of a cell": (mat(c=np.array([np.arange(4.0), Z], dtype=object)), "c{2}"),
    "MATLAB, a cell of numbers": (mat(c=np.array(list(Z), dtype=object)), None),
    "MATLAB, re and im": (mat(re=Z.real, im=Z.imag, k=np.arange(3.0)), None),
    "HDF5": (hdf5(eigentools), "/grid"),
    "HDF5, the only complex vector": (hdf5(eigentools), None),
    "HDF5, omega_r and omega_i": (hdf5(omega), None),
    "HDF5, by their stem": (hdf5(omega), "tasks/omega"),
    "HDF5, re and im": (hdf5(pair), None),
    "HDF5, re and im by path": (hdf5(pair), "run/spectrum"),
    "HDF5, two columns": (hdf5(columns), None),
}


@pytest.mark.parametrize("form", FORMS)
def test_one_spectrum_in_many_forms(tmp_path: Path, form: str) -> None:
    data, dataset = FORMS[form]
    np.testing.assert_array_equal(readers.read(stored(tmp_path, data), dataset), Z)


def text(words: str, length: int | None = None) -> bytes:
    return words.encode().ljust(length or len(words))


def counted(words: str) -> bytes:
    return struct.pack("<i", len(words)) + words.encode()


def legolas_1(version: str, order: str = "<") -> bytes:
    """As mod_output.f08 of Legolas 1.x writes it."""
    at = tuple(int(v) for v in version.split("."))

    def i(*values: int) -> bytes:
        return struct.pack(f"{order}{len(values)}i", *values)

    def d(*values: float) -> bytes:
        return struct.pack(f"{order}{len(values)}d", *values)

    out = text("legolas_version") + text(version, 10) + i(125, 16) + text("Cartesian", 125) + d(0, 1) + i(51, 200, 816, 101) + d(5 / 3)
    out += text("adiabatic_homo", 125) + i(0) + (i(0) if at >= (1, 1, 3) else b"") + i(0) + (i(0, 0) if at >= (1, 3, 0) else b"")
    out += i(0) + d(0, 0, 0) if at >= (1, 1, 4) else b""
    out += i(2, 16) + text("k2", 16) + text("k3", 16) + d(0, np.pi) + i(3, 16) + b"".join(text(n, 16) for n in ("rho0", "T0", "B0"))
    out += i(0) + i(2, 32) + text("unit_length", 32) + text("unit_time", 32) + d(1, 1)
    return out + i(3) + Z.astype(f"{order}c16").tobytes() + d(*np.linspace(0, 1, 51))


def legolas_2(version: str = "2.1.0") -> bytes:
    """As version 2 writes it."""

    def i(*values: int) -> bytes:
        return struct.pack(f"<{len(values)}i", *values)

    def d(*values: float) -> bytes:
        return struct.pack(f"<{len(values)}d", *values)

    out = text("legolas_version") + text(version, 10) + i(500, 16) + i(8) + counted("mhd") + i(16, 2) + text("rho", 16) + text("v1", 16)
    out += i(2, 16, 32, 816) + counted("cylindrical") + i(51, 200, 101) + i(4) + d(*range(8)) + d(0, 1)
    out += (
        i(0, 0, 0, 0, 0, 0) + d(1, 0, 0) + counted("QR-cholesky") + counted("general") + i(10) + counted("LM") + i(0, 100) + d(0, 0, 1e-9)
    )
    out += counted("adiabatic_homo") + counted("wall") + i(2, 1) + counted("unit_length") + d(1) + counted("unit_time") + d(1)
    out += d(5 / 3) + i(0, 0, 0) + counted("nocooling") + i(*range(14)) + i(2, 16) + text("k2", 16) + d(0) + text("k3", 16) + d(np.pi)
    return out + i(1, 16) + text("rho0", 16) + i(3) + Z.tobytes() + d(*np.linspace(0, 1, 51))


def legolas_0(named: bool, order: str = "<") -> bytes:
    """As it was before 1.0.2: no number of eigenvalues, but the rows of the matrix; eleven units without names."""

    def i(*values: int) -> bytes:
        return struct.pack(f"{order}{len(values)}i", *values)

    def d(*values: float) -> bytes:
        return struct.pack(f"{order}{len(values)}d", *values)

    out = (text("datfile_version") + i(1) if named else b"") + i(125, 16) + text("Cartesian", 125) + d(0, 1) + i(51, 200, 3, 101)
    out += d(5 / 3) + text("adiabatic_homo", 125) + i(0, 0) + i(2) + text("k2", 16) + text("k3", 16) + d(0, np.pi)
    out += i(3) + b"".join(text(n, 16) for n in ("rho0", "T0", "B0")) + i(1) + d(*range(1, 12))
    return out + Z.astype(f"{order}c16").tobytes() + d(*np.linspace(0, 1, 51))


@pytest.mark.parametrize(
    "data",
    [
        legolas_0(True),
        legolas_0(False),
        legolas_0(False, ">"),
        legolas_1("1.0.2"),
        legolas_1("1.1.3"),
        legolas_1("1.2.0"),
        legolas_1("1.3.1"),
        legolas_1("1.3.1", ">"),
        legolas_2(),
    ],
)
def test_legolas(tmp_path: Path, data: bytes) -> None:
    np.testing.assert_array_equal(readers.read(stored(tmp_path, data, "anything.dat")), Z)
    for end in range(30, len(data) - 51 * 8, 37):  # whatever is cut off is noticed
        with pytest.raises(InputError, match="Legolas"):
            readers.read(stored(tmp_path, data[:end]))


# hostile


def bomb() -> bytes:
    """A v5 variable that unpacks to 100 MB."""
    packed = zlib.compress(bytes(100 * 2**20))
    return mat(lam=Z)[:128] + struct.pack("<2I", 15, len(packed)) + packed


def far_away(file: Any) -> None:
    file["eigenvalues"] = h5py.ExternalLink("/etc/hostname", "/x")


def elsewhere(file: Any) -> None:
    layout = h5py.VirtualLayout(shape=(3,), dtype="f8")
    layout[:] = h5py.VirtualSource("/tmp/other.h5", "x", shape=(3,))
    file.create_virtual_dataset("eigenvalues", layout)


def huge(file: Any) -> None:
    file.create_dataset("eigenvalues", shape=(2**40,), dtype="f8", chunks=(2**16,))


HOSTILE: dict[str, tuple[bytes, str | None, tuple[str, ...]]] = {
    "bomb": (bomb(), None, ("32 MB when unpacked",)),
    "cells": (mat(lam=np.array([1, "x"], dtype=object)), None, ("arrays in it: lam",)),
    "two arrays": (mat(a=Z, b=Z), None, ("a, b", "--dataset")),
    "no such array": (mat(a=Z, b=Z), "c", ("'c'", "a, b")),
    "a matrix": (mat(a=np.ones((3, 3))), None, ("shape (3, 3)", "--row")),
    "cut off": (mat(lam=Z)[:200], None, ("MATLAB",)),
    "noise after the header": (mat(lam=Z)[:128] + b"\xff" * 200, None, ("MATLAB",)),
    "a link out of the file": (hdf5(far_away), None, ("HDF5", "none")),
    "numbers in another file": (hdf5(elsewhere), None, ("another file",)),
    "a dataset of 8 TB": (hdf5(huge), None, ("32 MB",)),
    "HDF5 without numbers": (hdf5(lambda file: file.create_group("x")), None, ("none",)),
    "HDF5 cut off": (hdf5(eigentools)[:900], None, ("broken HDF5",)),
    "fields of other names": (hdf5(lambda f: f.create_dataset("x", data=np.zeros(3, [("a", "f8"), ("b", "f8")]))), None, ("fields a, b",)),
    "re and im of two lengths": (
        hdf5(lambda f: (f.create_dataset("re", data=np.zeros(3)), f.create_dataset("im", data=np.zeros(2)))),
        None,
        ("real and an imaginary part",),
    ),
    "an old Legolas": (b"legolas_version" + text("0.9.0", 10) + bytes(400), None, ("0.9.0", "version 1 or 2")),
    "a Legolas of sizes": (b"legolas_version" + text("1.3.0", 10) + struct.pack("<2i", 100, 16) + b"\xff" * 900, None, ("Legolas",)),
    "--dataset for a text": (b"1,2\n", "x", ("--dataset", "npz", "csv")),
}


@pytest.mark.parametrize("what", HOSTILE)
def test_hostile_files_are_refused_in_one_line(tmp_path: Path, what: str) -> None:
    data, dataset, words = HOSTILE[what]
    path = stored(tmp_path, data)
    with pytest.raises(InputError) as refusal:
        readers.read(path, dataset)
    message = str(refusal.value)
    assert message.startswith(str(path))
    assert "\n" not in message
    for word in words:
        assert word in message


# conventions


def wave(kind: str, sign: str, v: complex, alpha: float, x: float, t: float) -> complex:
    """The mode that the user means, in his own units."""
    s = 1.0 if sign == "+" else -1.0
    exponent = {
        "growth": s * v * t + 1j * alpha * x,
        "frequency": 1j * (alpha * x + s * v * t),
        "phase-speed": 1j * alpha * (x + s * v * t),
    }
    return complex(np.exp(exponent[kind]))


@pytest.mark.parametrize("sign", ["+", "-"])
@pytest.mark.parametrize("kind", ["growth", "frequency", "phase-speed"])
def test_a_convention_is_the_wave_that_it_says(kind: str, sign: str) -> None:
    """exp(σt + iαx) in the problem's units is the user's wave in his: x = L x_u, t = (L/V) t_u, α = α_u/L."""
    v, alpha_u, L, V, x, t = 0.3 - 0.2j, 1.3, 2.5, 0.7, 0.4, 0.9
    convention = Convention(kind, sign, alpha_u if kind == "phase-speed" else None, L, V)
    sigma = convention.unit * v
    assert np.exp(sigma * (L / V) * t + 1j * (alpha_u / L) * (L * x)) == pytest.approx(wave(kind, sign, v, alpha_u, x, t))


def test_defaults_are_those_of_the_books() -> None:
    assert Convention().plain
    assert Convention("frequency").unit == -1j
    assert Convention("phase-speed", alpha=2.0).unit == -2j
    assert not Convention("growth", "-").plain


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"kind": "exp(x)"}, "allowed is growth, frequency, phase-speed"),
        ({"kind": "phase-speed"}, "--alpha"),
        ({"kind": "phase-speed", "alpha": 0.0}, "other than 0"),
        ({"kind": "growth", "alpha": 1.0}, "phase-speed only"),
        ({"kind": "growth", "length": -1.0}, "--length -1"),
        ({"kind": "growth", "velocity": float("inf")}, "--velocity inf"),
        ({"kind": "growth", "sign": "x"}, r"\+ or -"),
    ],
)
def test_wrong_conventions(given: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        Convention(**given)


def test_a_problem_in_another_eigenvalue_gives_the_same_verdicts() -> None:
    unit = 0.5j
    seen = Rescaled(st.gallery.poeschl_teller(1.5), unit)
    mode = st.refine(seen, 2.3 / unit)
    assert abs(mode.sigma - 2.25 / unit) <= mode.error
    report = st.verify(seen, [-0.5 / unit, 2.25001 / unit, 1 / unit], region=st.Rectangle(-1 - 6j, 1 - 0.1j))
    assert [v.verdict for v in report.verdicts] == ["continuum", "inaccurate", "spurious"]
    assert [round((complex(m.sigma) * unit).real, 9) for m in report.missing] == [0.25]
    crude = Rescaled(st.gallery.blasius(), 2.0).with_base_flow_error(1e3)
    assert isinstance(crude, Rescaled)


def test_conjugate_waves_answer_in_their_own_numbers() -> None:
    convention = Convention("phase-speed", alpha=1.0, conjugate=True)
    c = 0.23752648882 - 0.00373967062j  # of exp(−iα(x − ct))
    (claim,) = convention.read([c])
    report = st.verify(Rescaled(st.gallery.PlanePoiseuille(), convention.unit), [claim])
    shown = convention.shown(report)
    assert shown.verdicts[0].verdict == "confirmed"
    assert shown.verdicts[0].claimed == c
    assert abs(complex(shown.verdicts[0].sigma) - c) < 1e-10


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["verify", "poiseuille", "FILE", "--alpha", "1"], "--as"),
        (["verify", "davies", "FILE", "--as", "phase-speed"], "--alpha"),
        (["verify", "poiseuille", "FILE", "--as", "frequency", "--unstable"], "growth rates only"),
        (["verify", "poiseuille", "--dataset", "x"], "EIGENVALUES"),
        (["verify", "poiseuille", "FILE", "--as", "lambda x: x"], "invalid choice"),
        (["refine", "poiseuille", "--guess", "1", "--as", "growth", "--conjugate"], "conjugate guess"),
        (["refine", "poiseuille", "--guess", "1", "--as", "growth", "--length", "0"], "--length 0"),
        (["verify", "poeschl-teller"], "no bundled"),
        (["refine", "module_that_is_not:problem", "--guess", "1"], "cannot be loaded"),
    ],
)
def test_the_command_line_refuses_in_one_line(words: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from shootstab.cli.main import main

    path = stored(tmp_path, b"0.2375,0.0037\n", "c.csv")
    assert main([str(path) if word == "FILE" else word for word in words]) == 2
    refusal = capsys.readouterr().err
    assert said in refusal
    assert refusal.count("\n") == 1


def test_the_command_line_answers_in_the_convention_of_the_question(capsys: pytest.CaptureFixture[str]) -> None:
    """Length in whole channels and velocity in the mean one (2/3): c = 0.2375…/(2/3); a minus sign may stand alone."""
    import json

    from shootstab.cli.main import main

    words = ["refine", "poiseuille", "--as", "phase-speed", "--alpha", "2", "--length", "2", "--velocity", "0.6666666666666666"]
    assert main([*words, "--sign", "-", "--guess", "0.3563,0.0056", "--json", "-"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert float(answer["sigma"]["re"]) == pytest.approx(1.5 * 0.23752648882047, rel=1e-11)
    assert answer["convention"] == "exp(iα(x - ct))"
