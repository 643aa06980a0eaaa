"""The spectrum that comes with shootstab: a dozen numbers, with the verdicts that there are of them."""

from __future__ import annotations

import pytest

import shootstab as st
from shootstab.cli import main as cli
from shootstab.core.errors import InputError
from shootstab.core.records import CONFIRMED, CONTINUUM, INACCURATE, SPURIOUS
from shootstab.io import examples


def test_the_example_has_a_row_of_each_kind() -> None:
    report = st.verify("low", examples.path_for("low", None), missing="none")
    assert len(report.verdicts) == 12
    assert {CONFIRMED, INACCURATE, SPURIOUS, CONTINUUM} <= {v.verdict for v in report.verdicts}


def test_an_example_that_is_not_there_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(InputError, match="allowed is low"):
        examples.path_for("high", None)
    assert cli.main(["verify", "low", "file.csv", "--example"]) == cli.BAD_INPUT
    assert "without EIGENVALUES" in capsys.readouterr().err


def test_a_scene_that_is_nearly_named_is_proposed(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["refine", "poisseuille", "--guess", "1"]) == cli.BAD_INPUT
    assert "did you mean poiseuille?" in capsys.readouterr().err
