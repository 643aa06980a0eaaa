"""io/readers.py, io/arrays.py and io/notation.py: what is written is what is read, and nothing else is."""

from __future__ import annotations

import json
import math
import zipfile
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
import scipy.io
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from shootstab.core.errors import InputError
from shootstab.io import readers
from shootstab.io.notation import as_strings, claimed_digits, complex_from, floats_from, held, held_complex

Z = np.array([0.0039705046 + 0j, -0.0035 - 0.0071j, 1e-300 + 2e14j, 1.5])
finite = st.floats(allow_nan=False, allow_infinity=False)
kept = st.floats(-9e14, 9e14)
numbers = st.lists(st.builds(complex, kept, kept), min_size=1, max_size=20)
within = settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)


def stored(folder: Path, content: str | bytes, name: str = "modes") -> Path:
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def same(read: Any, expected: Any) -> None:
    assert np.asarray(read).dtype == np.complex128
    np.testing.assert_array_equal(read, np.asarray(expected, dtype=np.complex128))


# text

TEXTS = {
    "two columns, header": "re,im\n0.004,0\n-1e-3,2\n",
    "two columns": "0.004,0\n-1e-3,2\n",
    "blanks": "0.004 0\n   -1e-3    2  \n",
    "tabs": "0.004\t0\n-1e-3\t2\n",
    "semicolons": "0.004;0\n-1e-3 ; 2\n",
    "trailing comma": "0.004,0,\n-1e-3,2,\n",
    "header of words": "Re(sigma) Im(sigma)\n0.004 0\n-1e-3 2\n",
    "columns by name": "n,sigma_im,sigma_re,residual\n1,0,0.004,9\n2,2,-1e-3,9\n",
    "quoted": '"real","imag"\n"0.004","0"\n"-1e-3","2"\n',
    "comments": "# made by QZ\n\n0.004,0  # the mode\n% and a note\n-1e-3,2\n",
    "Python": "0.004\n-1e-3+2j\n",
    "i for j": "0.004+0i\n-1e-3+2i\n",
    "blanks around the sign": "0.004 + 0i\n-1e-3 + 2i\n",
    "NumPy's savetxt": " (4.0e-03+0.0e+00j)\n(-1.0e-03+2.0e+00j)\n",
    "NumPy's savetxt, old": " (4.0e-03+-0.0e+00j)\n(-1.0e-03+2.0e+00j)\n",
    "Fortran": " (4.0D-03,0.0D+00)\n (-1.0D-03,2.0d0)\n",
    "times": "0.004\n-1e-3+2*I\n",
    "byte order mark": "\ufeffre,im\n0.004,0\n-1e-3,2\n",
    "Windows": "re,im\r\n0.004,0\r\n-1e-3,2\r\n",
    "minus sign": "0.004,0\n−1e-3,2\n",
    "a header in a comment": "# from a code of mine\n# idx re im\n1 0.004 0\n2 -1e-3 2\n",
    "a comment of as many words": "# two numbers\n0.004 0\n-1e-3 2\n",
    "omega_r and omega_i": "k,omega_r,omega_i,r,i\n1,0.004,0,7,8\n2,-1e-3,2,7,8\n".replace(",r,i", ",x,y"),
    "decimal commas, semicolons": "0,004;0\n-1,0e-3;2,0\n",
    "decimal commas, tabs": "re\tim\n0,004\t0,0\n-0,001\t2\n",
    "decimal commas, blanks": "0,004 0,0\n-0,001 2,0\n",
    "json, another key": '{"M": 60, "modes": [0.004, [-1e-3, 2]]}',
    "json of two lists": '{"omega_r": [0.004, -1e-3], "omega_i": [0, 2], "k": [1, 2]}',
    "json of records of other names": '[{"n": 1, "sigma_r": 0.004, "sigma_i": 0}, {"n": 2, "sigma_r": -1e-3, "sigma_i": 2}]',
    "json of pairs": "[[0.004, 0], [-1e-3, 2]]",
    "json of records": '[{"re": 0.004, "im": 0}, {"re": "-1e-3", "im": "2"}]',
    "json of strings": '["0.004", "-1e-3+2j"]',
    "json, named": '{"truncation": 60, "eigenvalues": [{"re": "0.004", "im": "0.0"}, [-1e-3, 2]]}',
}


@pytest.mark.parametrize("form", TEXTS)
def test_one_spectrum_in_many_forms(tmp_path: Path, form: str) -> None:
    same(readers.read(stored(tmp_path, TEXTS[form])), [0.004, -1e-3 + 2j])


def test_what_is_infinite_is_left_out_counted_and_said(tmp_path: Path) -> None:
    """Dedalus' solve_dense writes inf and NaN, Legolas 1e20; 1e15 is the first that is left out, whichever part it is."""
    contents = (
        "re,im\n0.1,0\nnan,0\n2,inf\n1e20,1\n0.5,-1e15\n3,9e14\n",
        "[0.1, NaN, [2, Infinity], [1e20, 1], [0.5, -1e15], [3, 9e14]]",
        npy(np.array([0.1, np.nan, complex(2, np.inf), 1e20 + 1j, 0.5 - 1e15j, 3 + 9e14j])),
    )
    for content in contents:
        spectrum = readers.read(stored(tmp_path, content))
        same(spectrum, [0.1, 3 + 9e14j])
        assert (len(spectrum), spectrum.dropped, list(spectrum)) == (2, 4, [0.1 + 0j, 3 + 9e14j])
        assert spectrum.sentence == "Left out of modes: 4 entries that are infinite, not a number, or 1e15 and more."
    assert readers.read(stored(tmp_path, "1")).sentence == ""
    assert "1 entry that is infinite" in readers.read(stored(tmp_path, "1\nnan\n")).sentence


def test_one_spectrum_of_several_and_the_diagonal_of_a_matrix(tmp_path: Path) -> None:
    several = np.array([Z, 2 * Z, 3 * Z])
    same(readers.read(stored(tmp_path, npy(several)), row=2), 2 * Z)
    same(readers.read(stored(tmp_path, npy(np.stack([several.real, several.imag], axis=-1))), row=3), 3 * Z)
    same(readers.read(stored(tmp_path, zipped(tmp_path, many=npy(several), k=npy(np.arange(3.0)))), "many", 1), Z)
    same(readers.read(stored(tmp_path, npy(np.diag(Z)))), Z)
    for row, content in ((0, npy(several)), (4, npy(several)), (1, npy(Z)), (1, "1,2"), (1, "[1]")):
        with pytest.raises(InputError, match=f"--row {row}|--row: allowed"):
            readers.read(stored(tmp_path, content), row=row)


def test_the_array_that_is_meant_among_several(tmp_path: Path) -> None:
    forms = (
        {"re": npy(Z.real), "im": npy(Z.imag), "k": npy(np.arange(3.0))},
        {"omega_r": npy(Z.real), "omega_i": npy(Z.imag), "grid": npy(np.arange(9.0))},
        {"lam": npy(Z), "vectors": npy(np.ones((4, 4), complex)), "grid": npy(np.arange(9.0)), "note": b"text"},
    )
    for number, members in enumerate(forms):
        if number < 2:
            with pytest.raises(InputError, match="no array of numbers called 'x'"):
                readers.read(stored(tmp_path, zipped(tmp_path, **members)), "x")
        same(readers.read(stored(tmp_path, zipped(tmp_path, **members))), Z)
    same(readers.read(stored(tmp_path, zipped(tmp_path, **forms[1])), "omega"), Z)


def test_json_of_numbers(tmp_path: Path) -> None:
    same(readers.read(stored(tmp_path, " [0.1, 2, -3e-5]")), [0.1, 2, -3e-5])


def test_one_column_is_real(tmp_path: Path) -> None:
    same(readers.read(stored(tmp_path, "growth\n0.1\n2\n")), [0.1, 2])


@within
@given(numbers)
def test_text_and_json_lose_no_bit(tmp_path: Path, values: list[complex]) -> None:
    pairs = "\n".join(f"{z.real!r},{z.imag!r}" for z in values)
    same(readers.read(stored(tmp_path, pairs)), values)
    same(readers.read(stored(tmp_path, json.dumps([as_strings(z) for z in values]))), values)
    same(readers.read(stored(tmp_path, "\n".join(map(repr, values)))), values)


# arrays


@within
@given(numbers)
def test_arrays_lose_no_bit(tmp_path: Path, values: list[complex]) -> None:
    z = np.array(values)
    for form in (z, z[:, None], z[None, :], np.column_stack([z.real, z.imag])):
        np.save(tmp_path / "modes.npy", form)
        same(readers.read(tmp_path / "modes.npy"), z)


def test_npz(tmp_path: Path) -> None:
    for number, arrays in enumerate(({"anything": Z}, {"eigenvalues": Z, "vectors": np.eye(3)}, {"sigma": Z, "k": np.ones(2)})):
        path = tmp_path / f"{number}.npz"
        (np.savez if number else np.savez_compressed)(path, **arrays)
        same(readers.read(path), Z)


def test_a_file_is_told_by_its_content_not_by_its_name(tmp_path: Path) -> None:
    np.save(tmp_path / "a.npy", Z)
    (tmp_path / "a.npy").rename(tmp_path / "a.csv")
    same(readers.read(tmp_path / "a.csv"), Z)
    same(readers.read(stored(tmp_path, "1,2", "b.npy")), [1 + 2j])


def npy(array: Any, **options: Any) -> bytes:
    import io

    buffer = io.BytesIO()
    np.save(buffer, array, **options)
    return buffer.getvalue()


def zipped(folder: Path, **members: bytes) -> bytes:
    with zipfile.ZipFile(folder / "made.zip", "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return (folder / "made.zip").read_bytes()


# what is refused

WRONG = {
    # what is wrong: (content, words that the line must hold)
    "empty": ("", "empty"),
    "blank": ("\n  \n", "empty"),
    "comments only": ("# nothing\n", "no eigenvalue"),
    "header only": ("re,im\n", "no eigenvalue"),
    "empty list": ("[]", "no eigenvalue"),
    "empty array": (npy(np.array([])), "no eigenvalue"),
    "nan only": ("nan,nan\n", "all 1 entries"),
    "infinity only": ("0.1,-inf\n1e15\n".replace("1e15", "1e15,0"), "all 2 entries"),
    "overflow": ("1e999", "all 1 entries"),
    "word": ("re,im\n0.1,0\n0.2,abc\n", "line 3: 'abc' is not a number"),
    "short row": ("re,im\n0.1,0\n0.2\n", "line 3: 1 columns .* 2"),
    "three columns": ("1,2,3\n", "line 1: 3 columns"),
    "index and complex": ("1,0.1+2j\n", "line 1: .*real and an imaginary part"),
    "dots": ("1.2.3\n", "line 1|no eigenvalue"),
    "underscore": ("0.1\n1_000\n", "line 2"),
    "hexadecimal": ("0.1\n0x10\n", "line 2"),
    "sum": ("0.1\n1 2j\n", "line 2"),
    "broken json": ("[0.1,\n 0.2", "line 2: broken JSON"),
    "json without list": ('{"modes": 1}', '"eigenvalues"'),
    "json of triples": ("[[1, 2, 3]]", "entry 1"),
    "json of truths": ("[true]", "entry 1"),
    "json of nothing": ("[0.1, null]", "entry 2"),
    "json of lists of words": ('[["a", 2]]', "entry 1"),
    "json, nested": ("[[[1], 2]]", "entry 1"),
    "json, very deep": (100_000 * "[", "nested too deep"),
    "json, very large integer": ("[1" + 400 * "0" + "]", "larger than a double"),
    "json, larger integer": ("[1" + 5000 * "0" + "]", "modes"),
    "pickle": (npy(np.array([object()]), allow_pickle=True), "npy"),
    "array of words": (npy(np.array(["a"])), "array of type"),
    "array of truths": (npy(np.array([True])), "array of type"),
    "matrix": (npy(np.ones((3, 3))), "shape.*--row"),
    "row of a list": ('{"a": [1], "b": [2]}', "a, b.*--dataset"),
    "cut npy": (npy(Z)[:-8], "npy"),
    "npy header only": (npy(Z)[:9], "npy"),
    "npy of another size": (npy(Z).replace(b"(4,)", b"(9999999999999,)"), "npy"),
    "picture": (b"\x89PNG\r\n\x1a\n\0\0\0", "not an eigenvalue file"),
    "UTF-16": ("1,2\n".encode("utf-16"), "not an eigenvalue file"),
    "cut zip": (b"PK\x03\x04" + 40 * b"\0", "npz"),
}


@pytest.mark.parametrize("what", WRONG)
def test_wrong_files_are_refused_in_one_line(tmp_path: Path, what: str) -> None:
    content, words = WRONG[what]
    path = stored(tmp_path, content)
    with pytest.raises(InputError, match=words) as refusal:
        readers.read(path)
    assert str(refusal.value).startswith(str(path))
    assert "\n" not in str(refusal.value)


def test_wrong_zips(tmp_path: Path) -> None:
    for content, words in (
        (zipped(tmp_path), "none"),
        (zipped(tmp_path, a=npy(Z), b=npy(Z)), "a, b"),
        (zipped(tmp_path, a=b"text"), "not npy"),
        (zipped(tmp_path, a=zipped(tmp_path, a=npy(Z))), "not npy"),
        (zipped(tmp_path, a=npy(np.array([np.nan]))), "all 1 entries"),
    ):
        with pytest.raises(InputError, match=words):
            readers.read(stored(tmp_path, content))


def test_a_pickle_is_never_loaded(tmp_path: Path) -> None:
    class Bomb:
        def __reduce__(self) -> Any:
            return (Path.touch, (tmp_path / "exploded",))

    for content in (npy(np.array([Bomb()]), allow_pickle=True), zipped(tmp_path, a=npy(np.array([Bomb()]), allow_pickle=True))):
        with pytest.raises(InputError):
            readers.read(stored(tmp_path, content))
    assert not (tmp_path / "exploded").exists()


def test_no_file_and_no_name(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="No such file"):
        readers.read(tmp_path / "none.csv")
    with pytest.raises(InputError, match="directory"):
        readers.read(tmp_path)
    with pytest.raises(InputError, match="name"):
        readers.read("a\0b")


def test_too_large(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(readers, "LARGEST_FILE", 1000)
    monkeypatch.setattr(readers, "UNPACKED", 1000)
    with pytest.raises(InputError, match=r"larger than 0\.000954 MB: allowed is a smaller file"):
        readers.read(stored(tmp_path, 500 * "1\n" + "1\n"))
    assert len(readers.read(stored(tmp_path, 500 * "1\n"))) == 500
    # 100 kB that pack into less than a kilobyte
    with zipfile.ZipFile(tmp_path / "bomb.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a.npy", npy(np.zeros(12500)))
    assert (tmp_path / "bomb.npz").stat().st_size < 1000
    with pytest.raises(InputError, match="unpacked"):
        readers.read(tmp_path / "bomb.npz")


@within
@given(st.binary(max_size=200) | st.text(max_size=100).map(str.encode) | st.binary(max_size=100).map(lambda b: npy(Z)[:40] + b))
@example(b"\xef\xbb\xbf")
@example(b"PK\x05\x06" + 18 * b"\0")
def test_whatever_the_bytes_they_are_read_or_refused(tmp_path: Path, content: bytes) -> None:
    try:
        values = readers.read(stored(tmp_path, content))
    except InputError as error:
        assert str(error)
    else:
        assert len(values) > 0
        assert (np.abs(np.asarray(values)) < 2e15).all()


# notation


@pytest.mark.parametrize("text", ["", "+", "e5", "1e", "--1", "1+2", "1j2", "1+j+2", "(1", "1,2", "one", "0x1", "1_0", "1e1.5", "٣"])
def test_what_is_no_number(text: str) -> None:
    with pytest.raises(ValueError, match="not a number"):
        complex_from(text)


def test_numbers_as_people_write_them() -> None:
    assert complex_from("i") == 1j
    assert complex_from("-J") == -1j
    assert complex_from(" 1. ") == 1
    assert complex_from(".5-.25i") == 0.5 - 0.25j
    assert math.isnan(complex_from("nan").real)
    assert complex_from("-inf").real == -math.inf


def test_a_long_line_of_digits_takes_no_time() -> None:
    with pytest.raises(ValueError, match="not a number"):
        complex_from(1_000_000 * "1" + "x")


@given(finite, finite)
def test_pairs(a: float, b: float) -> None:
    assert floats_from(f"{a!r}, {b!r}", 2) == (a, b)


@pytest.mark.parametrize("text", ["1", "1,2,3", "1,nan", "1,2j", "1,", ""])
def test_what_is_no_pair(text: str) -> None:
    with pytest.raises(ValueError, match="2 finite numbers"):
        floats_from(text, 2)


@given(st.floats(1e-12, 1e12), st.floats(1e-15, 1e-1))
def test_held_digits_are_right_and_none_is_wasted(x: float, relative: float) -> None:
    error = x * relative
    text = held(x, error)
    unit = 10.0 ** math.floor(-math.log10(error) + 1e-6)
    # rounded at the last place whose unit is not below the error
    assert abs(float(text) - x) <= 0.5000001 / unit + 1e-16 * x
    assert error <= 1.00001 / unit < 10.001 * error


def test_held() -> None:
    assert held(0.00397050461234, 3e-13) == "0.003970504612"
    assert held(0.00397050461234, 1e-12) == "0.003970504612"
    assert held(-1.23456789e-9, 1e-14) == "-1.23457e-09"
    assert held(123456789.0, 10.0) == "1.2345679e+08"
    assert held(3e-9, 1e-8) == "0"
    assert held(0.0, 1e-8) == "0"
    assert held(0.1, None) == "0.10000000000000001"
    assert held(0.125, math.inf) == "0.125000"


def test_held_complex() -> None:
    assert held_complex(0.00727560123 - 0.01186501234j, 1e-9) == "0.007275601 - 0.011865012i"
    assert held_complex(0.5 + 1e-12j, 1e-9) == "0.500000000"
    assert held_complex(1e-12 + 0.5j, 1e-9) == "0 + 0.500000000i"
    assert claimed_digits(0.0039705046 + 0j, 3) == "0.0039705"
    assert claimed_digits(0j, 3) == "0"


@given(st.builds(complex, finite, finite))
def test_json_strings_lose_no_bit(z: complex) -> None:
    strings = as_strings(z)
    assert complex(float(strings["re"]), float(strings["im"])) == z
    assert as_strings(np.complex128(z)) == strings


def test_json_strings_of_many_digits() -> None:
    with mpmath.workdps(60):
        sigma = mpmath.mpc(mpmath.mpf(1) / 3, -mpmath.sqrt(2) / 1000)
        strings = as_strings(sigma, 1e-50)
        assert abs(mpmath.mpf(strings["re"]) - sigma.real) < 1e-50
        assert abs(mpmath.mpf(strings["im"]) - sigma.imag) < 1e-50
        assert len(strings["re"]) < 60
        assert held(sigma.real, 1e-50) == "0." + 50 * "3"
    assert as_strings(mpmath.mpc(2), None)["im"] == "0.0"


def test_eigenvectors_beside_a_diagonal_matrix_are_told_from_it(tmp_path: Path) -> None:
    values = np.array([0.1 - 0.2j, -0.3 + 0.4j, 0.5 + 0j])
    vectors = np.arange(9.0).reshape(3, 3) + 1j
    scipy.io.savemat(tmp_path / "eig.mat", {"V": vectors, "D": np.diag(values)})
    assert readers.read(tmp_path / "eig.mat").values.tolist() == values.tolist()
    scipy.io.savemat(tmp_path / "two.mat", {"A": np.diag(values), "D": np.diag(values)})
    with pytest.raises(InputError, match="--dataset NAME"):
        readers.read(tmp_path / "two.mat")
