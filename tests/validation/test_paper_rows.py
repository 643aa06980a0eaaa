"""The reproduction of the paper: agreement is judged by numbers, results are stored and not computed twice, and the table is theirs."""

from __future__ import annotations

import ast
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import paper.rows
import paper.table
import pytest
import readme_tables
import run
import scenes
from claims import Case
from paper import SCRIPTS, figure3, two_methods
from paper.rows import (
    AGREES,
    CONTRADICTS,
    NOT_REPRODUCED,
    Item,
    Reproduction,
    Row,
    compared,
    digits,
    fingerprint,
    if_all_hold,
    load,
    without_docstrings,
)
from paper.table import MARK, reproductions, table

import shootstab as st


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
    assert "| only | | | | not yet run: nothing of its full form is stored; its short form runs with --quick | |" in table(
        [reproduction], tmp_path
    )
    reproduction.check(quick=False, results=tmp_path)
    assert "| a number | 3.2 | 2 | 2.5 | contradicts, 0.6 digits |" in table([reproduction], tmp_path)
    assert table([reproduction], tmp_path).endswith("Rows: 1 (1 contradicts). Seconds in all: 0.")


def test_the_page_holds_the_table_of_what_is_stored() -> None:
    text = readme_tables.README.read_text(encoding="utf-8")
    assert readme_tables.between(text, MARK, table()) == text


def test_a_text_is_put_between_its_marks_and_nowhere_else() -> None:
    text = "before\n<!-- a -->\nold\n<!-- a: end -->\nafter\n<!-- b -->\n<!-- b: end -->\n"
    assert readme_tables.between(text, "a", "new") == text.replace("old", "new")
    with pytest.raises(ValueError, match="no <!-- c -->"):
        readme_tables.between(text, "c", "new")


def test_a_sentence_that_a_case_refutes_is_not_printed() -> None:
    held, refuted = Case("held", "yes", "yes", 0.0), Case("counted", "0", "3", 0.0)
    shown = Case("shown", "0", "3", None)
    assert if_all_hold((held, shown), "none grows") == "none grows"
    assert if_all_hold((held, refuted, shown), "none grows") == "not so: counted: 3"


def test_a_row_that_is_not_whole_is_gone_on_with(tmp_path: Path) -> None:
    asked = []

    def compute(quick: bool) -> Row:
        asked.append(quick)
        return replace(row(1.0, 1.0), left="" if len(asked) > 1 else "1 of 2 so far")

    reproduction = Reproduction("errata", "Title", (Item("drawn", compute),))
    reproduction.check(quick=False, results=tmp_path)
    assert "| agrees, 16.0 digits; 1 of 2 so far |" in table([reproduction], tmp_path)
    for _ in range(2):
        reproduction.check(quick=False, results=tmp_path)
    assert asked == [False, False]
    assert "so far" not in table([reproduction], tmp_path)


def test_a_row_of_an_earlier_form_of_its_script_is_told_as_that(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    reproduction, _ = counted(lambda: 2.0)
    reproduction.check(quick=False, results=tmp_path)
    assert "earlier form" not in table([reproduction], tmp_path)
    monkeypatch.setattr(paper.table, "fingerprint", lambda name: "another")
    assert "1 of 1 rows by an earlier form of the script" in table([reproduction], tmp_path)


def test_the_fingerprint_holds_the_derivations_that_a_script_takes_from_the_tests(monkeypatch: pytest.MonkeyPatch) -> None:
    before = fingerprint("errata")
    monkeypatch.setattr(paper.rows, "DERIVATIONS", Path("nowhere"))
    assert fingerprint("errata") != before
    assert fingerprint("parameters") == fingerprint("parameters")


def test_words_about_a_script_are_not_in_its_fingerprint() -> None:
    bare = ast.dump(without_docstrings(ast.parse("def f(x):\n    return 2 * x\n\nclass A:\n    pass\n")))
    said = '"""A page."""\n\ndef f(x):\n    """Twice x."""\n    return 2 * x  # exact\n\nclass A:\n    """A noun."""\n'
    assert ast.dump(without_docstrings(ast.parse(said))) == bare
    assert ast.dump(without_docstrings(ast.parse(said.replace("2 * x", "3 * x")))) != bare


def test_the_short_form_leaves_out_rows_that_wait_for_their_full_form(tmp_path: Path) -> None:
    asked = []

    def compute(key: str, quick: bool) -> Row:
        asked.append((key, quick))
        return row(1.0, 1.0)

    items = [Item(key, partial(compute, key)) for key in ("first", "second")]
    Reproduction("errata", "Title", (items[0],)).check(quick=False, results=tmp_path)
    assert Reproduction("errata", "Title", tuple(items)).check(quick=True, results=tmp_path)
    assert asked == [("first", False), ("first", True)]
    assert set(run.to_compare()) == {name for name in SCRIPTS if load(name)}


def test_agreement_over_truncations_must_grow_until_it_is_what_was_asked() -> None:
    assert two_methods.grows(np.array([2.7, 5.3, 9.6, 11.5, 11.1]))
    assert not two_methods.grows(np.array([2.7, 5.3, 5.2, 11.5]))
    assert not two_methods.grows(np.array([2.7, 5.3, 9.6]))


def test_a_neutral_curve_runs_between_the_points_of_the_grid() -> None:
    """Of two points, the first growing, the second has the decay of the same mode, and Re σ = 0 lies between them."""
    flow = scenes.problem("low").flow
    kx, ky = np.array([0.0, 0.040, 0.050]), np.array([0.0, 0.01])
    sigma = np.full((3, 2), np.nan, dtype=complex)
    sigma[1, 0] = complex(st.refine(st.chute.problem(flow, 0.040, 0.0), guess=0.001 - 0.0484j, rtol=1e-8).sigma)
    assert sigma[1, 0].real > 0
    below = figure3.followed_below(flow, kx, ky, sigma)
    assert below[2, 0] == pytest.approx(complex(st.refine(st.chute.problem(flow, 0.050, 0.0), guess=-0.002 - 0.0605j).sigma).real, rel=1e-4)
    grid = figure3.GrownGrid(kx, ky, np.nan_to_num(sigma.real), sigma, figure3.FLOOR, len(below), 6, 6)
    assert (grid.side, grid.enclosed) == ("k_y = 0", True)
