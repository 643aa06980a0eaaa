"""testing.py: the assertion for CI jobs passes on what is right, and says what is true when it fails."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import shootstab as st
from shootstab.core.errors import InputError
from shootstab.io.conventions import Convention
from shootstab.models.gallery.poiseuille import PlanePoiseuille
from shootstab.testing import assert_eigenvalue, assert_spectrum

# σ = −iαc, c = 0.23752648882047010745 + 0.0037396706229794099322i: Orszag 1971, re-computed
SIGMA = 0.0037396706229794099 - 0.2375264888204701j
FLOW = PlanePoiseuille(10000.0, 1.0)


def test_a_right_eigenvalue_passes() -> None:
    assert_eigenvalue(FLOW, SIGMA)
    assert_eigenvalue(FLOW, SIGMA, digits=10)
    assert_eigenvalue("poiseuille", SIGMA, digits=8)


def test_orszags_eight_digits() -> None:
    assert_eigenvalue(FLOW, -1j * (0.23752649 + 0.00373967j), digits=7)


def failure(claimed: complex, digits: int) -> str:
    with pytest.raises(AssertionError) as failed:
        assert_eigenvalue(FLOW, claimed, digits=digits)
    return str(failed.value)


def stated(text: str) -> complex:
    """The number that the message calls true."""
    found = re.search(r": (-?\S+) ([+-]) (\S+)i \(error", text)
    assert found
    return complex(float(found[1]), float(found[2] + found[3]))


@pytest.mark.parametrize("agree", [5, 6, 7])
def test_a_drifted_eigenvalue_fails_and_the_true_one_is_named(agree: int) -> None:
    message = failure(SIGMA + abs(SIGMA) * 10.0**-agree, 9)
    assert "is not an eigenvalue to 9 digits, it is inaccurate: " in message
    assert message.splitlines()[1].startswith("true value: ")
    assert abs(stated(message) - SIGMA) < 1e-10
    said = re.search(r"(\d+\.\d) digits agree$", message)
    assert said
    assert float(said[1]) == pytest.approx(agree, abs=0.05)


def test_a_spurious_eigenvalue_fails_and_the_next_mode_is_named() -> None:
    message = failure(SIGMA * (1 + 0.03j), 8)
    assert "it is spurious: " in message
    assert "digits agree" in message or "no true value is known" in message
    if "digits agree" in message:
        assert abs(stated(message) - SIGMA) < 1e-10


@pytest.mark.parametrize("digits", [0, 13, -3])
def test_digits_out_of_range(digits: int) -> None:
    with pytest.raises(InputError, match="1 to 12"):
        assert_eigenvalue(FLOW, SIGMA, digits=digits)


# whole spectra

SECOND = -0.03518658379244 - 0.96464251003928j  # the bundled reference's, and shooting's, to 14 digits


def test_a_right_spectrum_passes_whatever_its_convention(tmp_path: Path) -> None:
    (tmp_path / "c.csv").write_text(f"{(1j * SIGMA).real!r},{(1j * SIGMA).imag!r}\n")
    report = assert_spectrum("poiseuille", [SIGMA, SECOND], digits=8)
    assert [v.verdict for v in report.verdicts] == ["confirmed", "confirmed"]
    assert_spectrum("poiseuille", tmp_path / "c.csv", digits=8, convention=Convention("phase-speed", alpha=1.0))
    assert_spectrum("poiseuille", [1j * SIGMA], digits=8, as_="phase-speed")
    assert_spectrum(FLOW, [SIGMA], digits=8, missing="region", region=st.Rectangle(1e-4 - 1j, 0.1 + 0j))


def test_a_wrong_spectrum_fails_with_its_table() -> None:
    with pytest.raises(AssertionError) as failed:
        assert_spectrum(FLOW, [SIGMA, 0.01 - 0.3j], digits=8)
    said = str(failed.value)
    assert said.startswith("1 of 2 eigenvalues are not what they should be to 8 digits, 0 missing:")
    assert re.search(r"\n   1  0.0037396706\d* - 0.2375264888\d*i  confirmed  mode ", said)
    assert re.search(r"\n   2  \S+ - \S+i  spurious: ", said)
    with pytest.raises(AssertionError, match=r"missing  0\.0037396706"):
        assert_spectrum(FLOW, [SECOND], missing="region", region=st.Rectangle(1e-4 - 1j, 0.1 + 0j))
    with pytest.raises(InputError, match="allowed is none"):
        assert_spectrum(FLOW, [SIGMA], missing="all")


def test_numbers_are_of_one_convention() -> None:
    with pytest.raises(InputError, match="convention and as_: allowed is one of them"):
        assert_spectrum(FLOW, [SIGMA], convention=Convention("growth"), as_="frequency")
