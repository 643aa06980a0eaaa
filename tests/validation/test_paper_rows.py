"""The reproduction of the paper: agreement is judged by numbers, results are stored and not computed twice, and the table is theirs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import page
import paper.rows
import pytest
from claims import Case
from paper.rows import AGREES, CONTRADICTS, NOT_REPRODUCED, Item, Reproduction, Row, compared, digits, fingerprint, load
from paper.table import MARK, reproductions, table


def row(says: complex, obtained: complex) -> Row:
    return compared("a number", "3.2", says, obtained, allowed=1e-3)


def test_agreement_is_judged_by_the_allowance() -> None:
    assert row(2.0, 2.001).verdict == AGREES
    assert row(2.0, 2.003).verdict == CONTRADICTS
    assert row(2.0, 2.0002).agreement == "agrees, 4.0 digits"
    words = Row("words", "4.1", "so", "otherwise", (Case("words", "so", "otherwise", 0.0),))
    assert (words.agreement, replace(words, reason="no data").agreement) == (CONTRADICTS, f"{NOT_REPRODUCED}: no data")
    shown = Case("shown", 1.0, 2.0, None)
    with pytest.raises(ValueError, match="no case to be judged by"):
        _ = Row("nothing", "1", "", "", (shown,)).verdict
    assert replace(words, cases=(shown, Case("judged", 1.0, 1.0, 1e-9))).agreement == "agrees, 16.0 digits"
    assert digits(Case("far", 1.0, 3.0, 1.0)) == 0.0


def counted(obtained: Callable[[], complex]) -> tuple[Reproduction, list[bool]]:
    """A reproduction of one row, and the forms in which that was computed."""
    asked: list[bool] = []

    def compute(quick: bool) -> Row:
        asked.append(quick)
        return row(2.0, obtained())

    return Reproduction("errata", "Title", (Item("only", compute),)), asked


def test_what_is_stored_is_not_computed_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    reproduction, asked = counted(lambda: 2.0 + 1e-6j)
    assert reproduction.check(quick=False, results=tmp_path)
    assert reproduction.check(quick=False, results=tmp_path)
    assert asked == [False]
    stored = load("errata", tmp_path)["only"]
    assert stored.row.cases == row(2.0, 2.0 + 1e-6j).cases
    assert set(stored.provenance) == {"version", "commit", "date", "command", "script"}
    assert reproduction.check(quick=False, again=True, results=tmp_path)
    monkeypatch.setattr(paper.rows, "fingerprint", lambda name: "another")
    assert reproduction.check(quick=False, results=tmp_path)
    assert asked == [False] * 3


def test_the_quick_form_stores_nothing_and_must_agree_with_what_is_stored(tmp_path: Path) -> None:
    found = [2.0]
    reproduction, asked = counted(lambda: found[0])
    assert not reproduction.check(quick=True, results=tmp_path)  # nothing is stored to be held against
    assert load("errata", tmp_path) == {}
    assert reproduction.check(quick=False, results=tmp_path)
    assert reproduction.check(quick=True, results=tmp_path)
    found[0] = 3.0
    assert not reproduction.check(quick=True, results=tmp_path)
    assert not reproduction.check(quick=False, again=True, results=tmp_path)  # said once, and from then on stored
    assert reproduction.check(quick=False, again=True, results=tmp_path)
    assert asked == [True, False, True, True, False, False]


def test_a_figure_that_is_missing_is_drawn_again(tmp_path: Path) -> None:
    asked = []

    def compute(quick: bool) -> Row:
        asked.append(quick)
        return replace(row(1.0, 1.0), figures=("no such figure.png",))

    reproduction = Reproduction("errata", "Title", (Item("drawn", compute),))
    for _ in range(2):
        reproduction.check(quick=False, results=tmp_path)
    assert asked == [False, False]


def test_the_fingerprint_is_that_of_what_is_computed() -> None:
    names = [reproduction.name for reproduction in reproductions()]
    prints = {fingerprint(name) for name in names}
    assert len(prints) == len(names)
    assert fingerprint(names[0]) in prints


def test_the_table_is_made_of_what_is_stored(tmp_path: Path) -> None:
    reproduction, _ = counted(lambda: 2.5)
    assert "Not computed yet: only." in table([reproduction], tmp_path)
    reproduction.check(quick=False, results=tmp_path)
    assert "| a number | 3.2 | 2 | 2.5 | contradicts, 0.6 digits |" in table([reproduction], tmp_path)


def test_the_page_holds_the_table_of_what_is_stored() -> None:
    text = page.README.read_text(encoding="utf-8")
    assert page.between(text, MARK, table()) == text


def test_a_text_is_put_between_its_marks_and_nowhere_else() -> None:
    text = "before\n<!-- a -->\nold\n<!-- a: end -->\nafter\n<!-- b -->\n<!-- b: end -->\n"
    assert page.between(text, "a", "new") == text.replace("old", "new")
    with pytest.raises(ValueError, match="no <!-- c -->"):
        page.between(text, "c", "new")
