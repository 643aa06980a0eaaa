"""testing.py: the assertion for CI jobs passes on what is right, and says what is true when it fails."""

from __future__ import annotations

import re

import pytest

from shootstab.core.errors import InputError
from shootstab.models.gallery.poiseuille import PlanePoiseuille
from shootstab.testing import assert_eigenvalue

# σ = −iαc, c = 0.23752648882047010745 + 0.0037396706229794099322i: Orszag 1971, re-computed (reference/published.md)
SIGMA = 0.0037396706229794099 - 0.2375264888204701j
FLOW = PlanePoiseuille(10000.0, 1.0)


def test_a_right_eigenvalue_passes() -> None:
    assert_eigenvalue(FLOW, SIGMA)
    assert_eigenvalue(FLOW, SIGMA, digits=10)


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
