"""analyses/hypotheses.py: a list that is off by one thing is told from one that is wrong."""

from __future__ import annotations

import numpy as np
import pytest

import shootstab as st
from shootstab.analyses.hypotheses import Hypothesis, hypotheses
from shootstab.core.records import SPURIOUS, Report, Verdict
from shootstab.models.gallery.potentials import poeschl_teller

# plane Poiseuille flow, R = 10000, alpha = 1: the first three modes (the bundled reference's, and shooting's)
MODES = np.array([0.0037396706229794 - 0.2375264888204701j, -0.03518658379244 - 0.96464251003928j, -0.06325156907426 - 0.93635178116473j])


def found(claims: np.ndarray) -> tuple[Hypothesis, ...]:
    report = Report(tuple(Verdict(complex(c), SPURIOUS, "no zero near") for c in claims), (), 6)
    return hypotheses(st.gallery.PlanePoiseuille(), report, 6)


@pytest.mark.parametrize(
    ("claims", "factor", "conjugate"),
    [(MODES.conj(), 1.0, True), (MODES / 1j, 1j, False), (MODES / -1j, -1j, False), (-MODES, -1.0, False), (1j * MODES.conj(), 1j, True)],
)
def test_signs_conjugates_and_frequencies(claims: np.ndarray, factor: complex, conjugate: bool) -> None:
    (one,) = found(claims)
    assert (one.factor, one.conjugate, one.tried) == (factor, conjugate, 3)
    assert one.digits > 8
    np.testing.assert_allclose([one.applied(complex(c)) for c in claims], MODES, rtol=1e-12)


@pytest.mark.parametrize("factor", [0.5, -2.5j])
def test_units_and_phase_speeds(factor: complex) -> None:
    (one,) = found(MODES / factor)
    assert (abs(one.factor - factor) < 1e-6, one.conjugate) == (True, False)


def test_a_list_that_is_only_wrong_or_not_wholly_wrong_gets_no_proposal() -> None:
    assert found(np.array([0.3 + 0.1j, 0.2 - 0.37j, 0.17 - 0.21j])) == ()
    assert found(MODES.conj()[:1]) == ()
    report = Report((Verdict(complex(MODES[0]), "confirmed", ""), Verdict(0.5, SPURIOUS, "")), (), 6)
    assert hypotheses(st.gallery.PlanePoiseuille(), report, 6) == ()


def test_real_parts_alone_are_told_as_such() -> None:
    (one,) = found(MODES.real.astype(complex))
    assert (one.parts, one.tried, one.agreeing) == ("real parts", 3, 3)
    assert one.digits > 8
    assert found(MODES.real * 1.01 + 0j) == ()


@pytest.mark.parametrize(("claims", "parts"), [(MODES.imag, "imaginary parts"), (-MODES.imag, "imaginary parts with the other sign")])
def test_imaginary_parts_alone_are_told_as_such(claims: np.ndarray, parts: str) -> None:
    (one,) = found(claims.astype(complex))
    assert one.parts == parts


def test_one_claim_in_four_may_be_wrong_in_itself() -> None:
    more = np.array([-0.0911228 - 0.907983j, -0.05089872725702 - 0.27720434380895j])  # the first of them is no mode to three digits
    for factor in (1j, 0.37 - 0.2j):
        (one,) = found(np.concatenate([MODES, more])[[0, 1, 2, 4, 3]] / factor * np.array([1.0, 1.0, 1.3, 1.0, 1.0]))
        assert (abs(one.factor - factor) < 1e-6, one.tried, one.agreeing) == (True, 4, 3)


def test_claims_in_other_units_of_a_problem_without_a_reference() -> None:
    """Bound states of ν (ν + 1) sech² x are λ = (ν − n)²; no list of modes is there to be held against."""
    claims = [1.7 * (3.5 - n) ** 2 for n in range(3)]
    report = Report(tuple(Verdict(claim, SPURIOUS, "") for claim in claims), (), 6)
    (found,) = hypotheses(poeschl_teller(3.5), report, 6)
    assert found.factor == pytest.approx(1 / 1.7, rel=1e-6)
    assert (found.conjugate, found.tried, found.agreeing) == (False, 3, 3)
