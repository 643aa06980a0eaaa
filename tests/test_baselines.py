"""Baselines: what is written can be read, what drifts is named, and pytest's plugin does both."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment

import shootstab as st
from shootstab.cli import main as cli
from shootstab.core.errors import InputError
from shootstab.io import baselines
from shootstab.io.baselines import Baseline

SIGMA = 0.0037396706229794099 - 0.2375264888204701j
pytest_plugins = ["pytester"]


def test_what_is_written_is_read_and_a_diff_shows_what_moved(tmp_path: Path) -> None:
    first = Baseline.of("poiseuille", [(SIGMA, 1e-13), (0.1 + 0j, 1e-12)], 8)
    baselines.save(first, tmp_path / "a.toml")
    again = baselines.load(tmp_path / "a.toml")
    assert (again.scene, again.digits, len(again.modes)) == ("poiseuille", 8, 2)
    assert all(abs(a[0] - b[0]) < 1e-10 for a, b in zip(first.modes, again.modes, strict=True))
    moved = Baseline.of("poiseuille", [(0.1 + 0j, 1e-12), (SIGMA + 1e-8, 1e-13)], 8)
    changed = [(a, b) for a, b in zip(first.text.splitlines(), moved.text.splitlines(), strict=True) if a != b]
    assert [a.split(" = ")[0] for a, _ in changed] == ["re"]


def test_each_number_is_used_once_and_drift_is_named() -> None:
    baseline = Baseline.of("poiseuille", [(1.0 + 0j, 0.0), (1.0 + 1e-3j, 0.0)], 6)
    assert [d.holds for d in baseline.differences([1.0, 1.0 + 1e-3j])] == [True, True]
    lost = baseline.differences([1.0])
    assert [d.holds for d in lost] == [True, False]
    assert "nothing in its place" in lost[1].line
    (drifted,) = Baseline.of("x", [(1.0 + 0j, 0.0)], 6).differences([1.0 + 2e-6])
    assert not drifted.holds
    assert "moved by 2.0e-06, allowed is 1.0e-06" in drifted.line


def test_numbers_are_given_as_a_whole_and_not_to_the_first_that_asks() -> None:
    """The first mode has drifted beyond its neighbour: the neighbour, there to the last digit, is not said to have moved."""
    baseline = Baseline.of("x", [(1.0 + 0j, 0.0), (0.999 + 0j, 0.0)], 6)
    assert [d.holds for d in baseline.differences([1.002, 0.999])] == [False, True]
    assert [d.found for d in baseline.differences([1.0012, 1.0])] == [1.0, 1.0012]
    assert [d.found for d in baseline.differences([])] == [None, None]


def test_as_many_hold_as_can_however_often_a_number_is_there() -> None:
    """Against the assignment of all to all; numbers that are many times over, and fewer or more of them than modes."""
    twelve = Baseline.of("x", [(1.0 + 0j, 0.0)] * 12, 6)
    assert all(d.holds for d in twelve.differences([1.0] * 12))
    assert [d.found for d in twelve.differences([1.0] * 11)].count(None) == 1
    rng = np.random.default_rng(5)
    for _ in range(40):
        modes = 1.0 + rng.integers(0, 3, rng.integers(1, 16)) * 0.25j
        numbers = 1.0 + rng.integers(0, 3, rng.integers(1, 20)) * 0.25j
        numbers = numbers + rng.choice([0.0, 1e-9, 1e-3], len(numbers))
        found = Baseline.of("x", [(complex(mode), 0.0) for mode in modes], 6).differences(numbers.tolist())
        holds = np.abs(np.subtract.outer(modes, numbers)) <= 1e-6 * np.abs(modes)[:, None]
        rows, columns = linear_sum_assignment(holds, maximize=True)
        assert sum(d.holds for d in found) == holds[rows, columns].sum()
        used = Counter(d.found for d in found if d.found is not None)
        assert used.total() == min(len(modes), len(numbers))
        assert used <= Counter(numbers.tolist())


MODE = '[[mode]]\nre = "1"\nim = "0"\nerror = 0.0\n'
BROKEN = {
    "": r"digits = None: allowed is an integer from 1 to 12",
    "digits = 3": r"no \[\[mode\]\]: allowed are 1 to 1000",
    f'scene = "x"\ndigits = 99\n{MODE}': "digits = 99: allowed",
    f'scene = "x"\ndigits = true\n{MODE}': "digits = True: allowed",
    f"scene = 3\ndigits = 8\n{MODE}": "allowed are texts",
    f"digits = 8\n{MODE}": "scene is needed",
    f'scene = "x"\ndigits = 8\n{MODE.replace("0.0", "-1.0")}': r"mode 1: error = -1.0: allowed is a number from 0 to 1e15",
    f'scene = "x"\ndigits = 8\n{MODE.replace("1", "nan")}': r"mode 1: re = 'nan': allowed is a number below 1e15",
    f'scene = "x"\ndigits = 8\n{MODE.replace("0.0", "1" + "0" * 400)}': r"mode 1: error = ",
    'scene = "x"\ndigits = 8\nmode = [1]': r"mode 1: re = None: allowed is a number",
    "a = [": "broken TOML",
    "a = " + "[" * 5000: "nested too deep",
    "#" * 2**18: "larger than 0.125 MB",
}


@pytest.mark.parametrize("number", range(len(BROKEN)))
def test_what_is_no_baseline_is_refused(tmp_path: Path, number: int) -> None:
    text, says = list(BROKEN.items())[number]
    (tmp_path / "bad.toml").write_text(text)
    with pytest.raises(InputError, match=rf"bad\.toml: .*{says}") as refusal:
        baselines.load(tmp_path / "bad.toml")
    assert "\n" not in str(refusal.value)
    assert len(str(refusal.value)) < 400


def test_record_and_check_on_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, spectrum = tmp_path / "modes.toml", tmp_path / "spectrum.csv"
    assert cli.main(["baseline", "record", "poiseuille", str(file), "--guess", "0.0037,-0.2375"]) == 0
    assert cli.main(["baseline", "check", str(file)]) == 0
    spectrum.write_text("0.0037396706,-0.2375264888\n0.5,0.5\n")
    assert cli.main(["baseline", "check", str(file), str(spectrum)]) == 0
    spectrum.write_text("0.0037397,-0.2375264888\n")
    capsys.readouterr()
    assert cli.main(["baseline", "check", str(file), str(spectrum)]) == 1
    assert "drifted" in capsys.readouterr().out
    assert cli.main(["baseline", "record", "poiseuille", str(file)]) == cli.BAD_INPUT


def test_the_plugin_writes_compares_and_fails(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        test_it="""
import os

def test_spectrum(shootstab_baseline):
    shootstab_baseline("poiseuille", [0.0037396706 - 0.2375264888j + float(os.environ.get("DRIFT", "0"))], digits=8)
"""
    )
    plugin = ("-p", "shootstab.pytest_plugin", "-p", "no:cacheprovider")
    absent = pytester.runpytest_inprocess(*plugin)
    absent.assert_outcomes(failed=1)
    absent.stdout.fnmatch_lines(["*--shootstab-regen*"])
    pytester.runpytest_inprocess(*plugin, "--shootstab-regen").assert_outcomes(passed=1)
    assert (pytester.path / "baselines" / "test_spectrum.toml").exists()
    pytester.runpytest_inprocess(*plugin).assert_outcomes(passed=1)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("DRIFT", "1e-5")
        drifted = pytester.runpytest_inprocess(*plugin)
        drifted.assert_outcomes(failed=1)
        drifted.stdout.fnmatch_lines(["*1 mode of * has drifted*", "*moved by 1.0e-05*"])


def test_a_spectrum_that_lacks_a_mode_among_its_own_and_one_of_phase_speeds() -> None:
    problem = st.scene("benard").problem
    modes = sorted((complex(m.sigma) for m in st.find(problem, st.Rectangle(-60 - 1j, 10 + 1j)).modes), key=lambda s: -s.real)
    assert len(modes) >= 3
    st.testing.assert_spectrum(problem, modes, missing="within")
    with pytest.raises(AssertionError, match="1 missing"):
        st.testing.assert_spectrum(problem, [modes[0], *modes[2:]], missing="within")
    st.testing.assert_spectrum("poiseuille", [1j * SIGMA], digits=8, as_="phase-speed")
