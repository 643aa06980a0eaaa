"""cli/proposals.py: what a list may have meant is said in words, and with the options that mean it."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest

from shootstab.analyses.hypotheses import Hypothesis
from shootstab.analyses.other_parameters import OtherValue, Searched
from shootstab.cli import main as cli
from shootstab.cli import variations
from shootstab.cli.proposals import factors_tried, options, sentence
from shootstab.cli.variations import without_success
from shootstab.core.records import SPURIOUS, Report, Verdict
from shootstab.io.conventions import Convention


@pytest.mark.parametrize(
    ("factor", "conjugate", "said"),
    [
        (1.0, True, "--conjugate"),
        (-1.0, False, "--as growth --sign -"),
        (-1j, False, "--as frequency"),
        (0.5, False, "--as growth --length 2"),
        (2j, True, "--as frequency --sign + --length 0.5 --conjugate"),
        (0.3 + 0.4j, False, ""),
    ],
)
def test_the_options_proposed_mean_the_factor(factor: complex, conjugate: bool, said: str) -> None:
    one = Hypothesis(factor, conjugate, 3, 8.0, 3)
    assert options(one) == said
    if said:
        words = said.split()
        given = dict(itertools.pairwise(words))
        convention = Convention(
            given.get("--as", "growth"), given.get("--sign"), length=float(given.get("--length", 1)), conjugate="--conjugate" in words
        )
        assert (convention.unit, convention.conjugate) == (factor, conjugate)
    assert (": try" in sentence(one)) == bool(said)


def test_what_was_tried_in_vain_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "wrong.csv").write_text("7.3,0\n2.9,0\n0.77,0\n")
    assert cli.main(["verify", "poeschl-teller", str(tmp_path / "wrong.csv"), "--missing", "none"]) == 1
    said = " ".join(capsys.readouterr().out.split())
    assert said.endswith("What the claims may mean was not found; tried: conjugates, signs, frequencies and units of the claims.")
    report = Report(tuple(Verdict(c, SPURIOUS, "") for c in (1.0, 2.0)), (), 6)
    searched = Searched((), {"alpha": (0.5, 2.0)}, (("alpha", "reynolds"),))
    (said,) = without_success(searched, report, 10.0)
    assert "tried: conjugates, signs, frequencies and units of the claims; alpha from 0.5 to 2; two of these at once." in said
    assert said.endswith("The search for it ends after 10 s of processor time.")
    assert without_success(Searched((), {}), Report((), (), 6), None) == []


def test_two_parameters_are_proposed_together() -> None:
    said = variations.sentence(OtherValue("alpha", 1.0, 0.95, 4, 4, 11.2, ("reynolds", 10000.0, 9000.0)))
    assert said == (
        "All 4 claims tried are modes to 11.2 digits at alpha = 0.95 and reynolds = 9000; this scene has alpha = 1 and reynolds = 10000."
    )


@pytest.mark.parametrize(("factor", "said"), [(-1j, "× -i,"), (1j, "× i,"), (2.0, "× 2,"), (0.5 - 2j, "× (0.5 - 2i),"), (-3j, "× -3i,")])
def test_a_factor_is_written_as_people_do(factor: complex, said: str) -> None:
    assert said in sentence(Hypothesis(factor, False, 3, 8.0, 3))


def test_real_parts_are_told_to_lack_the_others() -> None:
    said = sentence(Hypothesis(1.0, False, 3, 8.0, 3, "real parts"))
    assert said.startswith("All 3 claims tried are real parts of eigenvalues of the bundled reference, to 8.0 digits: both parts")


def test_a_conjugate_list_is_told_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "modes.csv").write_text("0.0037396706,0.2375264888\n-0.0351865838,0.9646425100\n")
    assert cli.main(["verify", "poiseuille", str(tmp_path / "modes.csv")]) == 1
    assert "All 2 claims tried, conjugated, are modes to" in (out := capsys.readouterr().out)
    assert "try --conjugate." in out


@pytest.mark.parametrize(
    ("given", "factor", "conjugate", "said"),
    [
        (Convention(conjugate=True), 1.0, True, "as the problem has them: leave out --conjugate."),
        (Convention("frequency"), 1j, False, "as the problem has them: leave out --as frequency."),
        (Convention("frequency"), 0.011, False, "try --as phase-speed in place of --as frequency."),
        (Convention("phase-speed", alpha=0.011), 1.0, True, "try --as phase-speed --conjugate in place of --as phase-speed."),
        (Convention(), -0.011j, False, "try --as phase-speed."),
        (Convention(), 0.011j, True, "try --as phase-speed --sign + --conjugate."),
    ],
)
def test_what_is_proposed_counts_with_what_was_given(given: Convention, factor: complex, conjugate: bool, said: str) -> None:
    assert sentence(Hypothesis(factor, conjugate, 3, 8.0, 3), given, 0.011).endswith(said)
    assert any(abs(factor - tried) <= 1e-15 for tried in factors_tried(given, 0.011))


def test_a_claim_that_is_wrong_in_itself_is_counted() -> None:
    assert sentence(Hypothesis(1.0, True, 4, 8.0, 3)).startswith("3 of 4 claims tried, conjugated, are modes")


@pytest.mark.parametrize(("arguments", "factor"), [((), 1.0), (("--as", "phase-speed"), 1j / 1.1)])
def test_a_list_of_another_run_is_told_so(
    arguments: tuple[str, ...], factor: complex, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Modes of plane Poiseuille flow at R = 10000 and α = 1.1, as the reference has them, for the scene with α = 1."""
    modes = [-0.000329918028 - 0.271658614052j, -0.055645168296 - 0.296535885686j]
    (tmp_path / "modes.csv").write_text("".join(f"{v.real:.9g},{v.imag:.9g}\n" for v in (factor * m for m in modes)))
    assert cli.main(["verify", "poiseuille", str(tmp_path / "modes.csv"), "--digits", "4", "--missing", "none", *arguments]) == 1
    assert "All 2 claims tried are modes to" in (out := " ".join(capsys.readouterr().out.split()))
    assert "at alpha = 1.1; this scene has alpha = 1." in out
