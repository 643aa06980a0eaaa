"""analyses/one_value_proof: no eigenvalue is nearer than one value of D says, and the largest such disc is no larger than the distance."""

from __future__ import annotations

import math

import numpy as np
import pytest

import shootstab as st
from shootstab.analyses import proved_verdicts as verdicts
from shootstab.analyses.enclosables import factors
from shootstab.analyses.one_value_proof import ONE_VALUE, clear_of_zeros
from shootstab.core.errors import ConvergenceError

STRING = st.equations(["y"], ["d(y,2) - sigma*y"], st.Conditions(0, ["y"]), st.Conditions(1, ["y"]))
MODES = [-((k * math.pi) ** 2) for k in range(1, 12)]


def test_no_mode_of_a_string_is_nearer_than_one_value_says() -> None:
    rng = np.random.default_rng(3)
    forms = factors(STRING)
    for _ in range(60):
        re, im = float(rng.uniform(-200.0, 40.0)), float(rng.uniform(-60.0, 60.0)) * 10.0 ** -int(rng.integers(0, 6))
        proof = clear_of_zeros(forms, (repr(re), repr(im)))
        radius, distance = float(proof.region["radius"]), min(abs(complex(re, im) - mode) for mode in MODES)
        assert 1e-7 * distance < radius < distance
        assert proof.count == 0 and ONE_VALUE in proof.lemmas and proof.margin > 1.0


def test_at_a_mode_to_sixteen_digits_the_disc_is_as_small_as_what_is_left() -> None:
    proof = clear_of_zeros(factors(STRING), ("-9.869604401089358", "0.0"))  # π² = 9.86960440108935861883…
    assert 0.0 < float(proof.region["radius"]) < 6.2e-16


def test_a_spurious_claim_whose_circle_is_not_enclosed_is_cleared_by_its_value(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuses(*_: object, **__: object) -> None:
        raise ConvergenceError("no term dominates")

    monkeypatch.setattr(verdicts, "prove_disc", refuses)
    report = st.verify(STRING, [-MODES[0], 5.0 + 1.0j])
    assert report.verdicts[1].verdict == "spurious"
    first, second = verdicts.proved_verdicts(STRING, report)
    for found in (first, second):
        assert found.upgraded is not None and found.upgraded.startswith("proved: none within")
        assert found.within is not None and found.within > 1.0
    monkeypatch.setattr(verdicts, "clear_of_zeros", refuses)
    assert verdicts.proved_verdicts(STRING, report)[1].reason == "no term dominates"
    confirmed = st.verify(STRING, [MODES[0]])
    assert verdicts.proved_verdicts(STRING, confirmed)[0].reason == "no term dominates"
