"""The claim of validation/planted_faults.py in its quick form: every planted fault gets the verdict that it deserves."""

from __future__ import annotations

import pytest
from claims import Case
from planted_faults import cases


@pytest.mark.slow
def test_planted_faults() -> None:
    checked: list[Case] = list(cases(quick=True))
    assert len(checked) > 20
    wrong = [f"{case.name}: expected {case.expected}, obtained {case.obtained}" for case in checked if not case.holds]
    if wrong:
        pytest.fail("\n".join(wrong))
