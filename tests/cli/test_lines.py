"""cli/lines.py and cli/reasons.py: sentences on a page of eighty columns, and reasons that are told once."""

from __future__ import annotations

import pytest

from shootstab.cli.lines import PAGE, filled, numbered, with_i
from shootstab.cli.reasons import grouped
from shootstab.core.records import SPURIOUS, Verdict


def test_lines_are_filled_between_words_and_not_inside_numbers() -> None:
    text = "a mode lies at -0.00947304 - 0.0504544i and another one lies at 0.12345678 + 0.87654321i, which is far"
    lines = filled(text, "   ").split("\n")
    assert max(map(len, lines)) <= PAGE
    assert lines[1].startswith("   ")
    assert "  ".join(lines).split() == text.split()
    assert any("-0.00947304 - 0.0504544i" in line for line in lines)
    assert any("0.12345678 + 0.87654321i" in line for line in lines)
    assert filled(text, width=200) == text


def test_a_number_that_no_line_holds_goes_on_at_its_sign() -> None:
    digits = "1" * 60
    assert filled(f"σ = 0.{digits} - 0.{digits}i").split("\n") == [f"σ = 0.{digits}", f"- 0.{digits}i"]


@pytest.mark.parametrize(
    ("python", "shown"),
    [
        ("at 0.00727558-0.011865j, far", "at 0.00727558 - 0.011865i, far"),
        ("-4.24502-0.0134009j", "-4.24502 - 0.0134009i"),
        ("the end -3.56814e-14-0.0383429j of", "the end -0.0383429i of"),
        ("1e-05+2.5e+00j", "1e-05 + 2.5e+00i"),
        ("2+0j", "2"),
        ("kx-1 and 3-4 stay", "kx-1 and 3-4 stay"),
    ],
)
def test_complex_numbers_are_written_as_in_the_tables(python: str, shown: str) -> None:
    assert with_i(python) == shown


def test_runs_of_numbers() -> None:
    assert numbered([1, 2, 3, 5, 8, 9]) == "1–3, 5, 8–9"


def test_reasons_that_differ_in_sizes_are_one_and_others_are_not() -> None:
    why = "no zero of D within {}; the nearest mode known here is {}, {} away"
    rows = [
        (1, Verdict(1.0, SPURIOUS, why.format("7.1e-04", "0.25-1j", "2.0e-02"))),
        (2, Verdict(1.0, SPURIOUS, why.format("7.1e-03", "0.25-1j", "3.5e+00"))),
        (3, Verdict(1.0, SPURIOUS, why.format("7.1e-03", "0.5-1j", "3.5e+00"))),
        (7, Verdict(1.0, SPURIOUS, why.format("7.1e-04", "0.25-1j", "9.0e-03"))),
    ]
    first = why.format("7.1e-04 to 7.1e-03", "0.25-1j", "9.0e-03 to 3.5e+00")
    assert grouped(rows) == [("1–2, 7", SPURIOUS, first), ("3", SPURIOUS, rows[2][1].why)]
