"""by_name.py: Python asks as the command line does."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import shootstab as st
from shootstab.discriminants.continuation import Continuation

SIGMA = 0.0037396706229794 - 0.2375264888204701j  # plane Poiseuille flow, R = 10000, alpha = 1


def test_scenes_files_and_methods_by_name(tmp_path: Path) -> None:
    (tmp_path / "modes.csv").write_text("0.0037396706,-0.2375264888\ninf,nan\n")
    report = st.verify("poiseuille", tmp_path / "modes.csv", region=st.Rectangle(1e-4 - 1j, 0.1 + 0j))
    assert ([v.verdict for v in report.verdicts], report.dropped) == (["confirmed"], 1)
    assert st.verify(st.scene("poiseuille"), SIGMA).verdicts[0].verdict == "confirmed"
    for method in ("frame", "compound", "riccati"):
        mode = st.refine("poiseuille", SIGMA, method=method)
        assert (mode.method, abs(mode.sigma - SIGMA) <= mode.error + 1e-15) == (method, True)
    assert st.count("poiseuille", st.Rectangle(1e-4 - 1j, 0.1 + 0j)) == 1


def test_wrong_names_are_refused_in_words() -> None:
    with pytest.raises(st.InputError, match="did you mean riccati"):
        st.refine("poiseuille", SIGMA, method="ricatti")
    with pytest.raises(st.InputError, match="no such scene"):
        st.refine("nowhere", SIGMA)


def test_a_discriminant_of_ones_own_to_play_with() -> None:
    d = st.discriminant("poiseuille", "frame")
    away, near = d(SIGMA + 1e-2), d(SIGMA + 1e-6)
    ratio = abs(near.mantissa / away.mantissa) * 2.718281828459045 ** (near.log_scale - away.log_scale)
    assert 1e-5 < ratio < 1e-3  # a simple zero: about 1e-4
    assert abs(d.with_derivative(SIGMA + 1e-6).newton_step + 1e-6) < 1e-8


def test_dir_shows_the_names_and_each_is_there() -> None:
    assert set(dir(st)) == {*st.__all__, "__version__"}
    for name in dir(st):
        assert getattr(st, name) is not None


def test_the_methods_have_the_names_by_which_they_are_made() -> None:
    from shootstab.discriminants.named import METHODS, make

    assert [make(name, rtol=1e-7).name for name in METHODS] == list(METHODS)


def test_the_command_line_knows_their_names_and_loads_no_kernels() -> None:
    code = "import sys\nimport shootstab.cli.main\nassert 'shootstab.discriminants.named' in sys.modules\nassert 'numba' not in sys.modules"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60).stderr == ""


def test_what_is_printed_of_an_object_is_short() -> None:
    low, front = st.scene("low"), st.scene("bistable-front").problem
    continuation = Continuation(front, st.Frame())
    assert continuation.barrier is not None
    read = st.read(Path(st.__file__).parent / "examples" / "low.csv")
    objects = [low, low.problem, low.problem.flow, front, continuation, continuation.barrier, st.discriminant(low), read]
    for thing in objects:
        assert 10 < len(repr(thing)) < 250
        assert " at 0x" not in repr(thing)
    assert repr(read) == "ClaimedSpectrum(12 eigenvalues)"
    assert str(low) == low.heading
    assert repr(low.problem.flow.at(1.0)).startswith("Fields(nu=0.375677")
