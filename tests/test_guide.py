"""The guide: every command and program in it does what it shows, it is whole, and the command line shows it."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pages
import pytest

import shootstab as st
from shootstab.cli import main as cli

GUIDE = Path(__file__).parent.parent / "shootstab" / "guide"
TOPICS = sorted(path.stem for path in GUIDE.glob("*.md"))
RUN = [t for t in TOPICS if any(b.kind in ("python", "console") for b in pages.blocks((GUIDE / f"{t}.md").read_text()))]


@pytest.mark.parametrize("topic", RUN)
def test_a_page_of_the_guide_does_what_it_shows(topic: str, tmp_path: Path) -> None:
    pages.run_page((GUIDE / f"{topic}.md").read_text(), tmp_path)


def test_the_guide_is_shown_whole_and_a_topic_that_is_not_there_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["guide"]) == 0
    listed = capsys.readouterr().out
    for topic in TOPICS:
        assert f"\n  {topic} " in listed
        assert cli.main(["guide", topic]) == 0
        assert capsys.readouterr().out == (GUIDE / f"{topic}.md").read_text()
    assert cli.main(["guide", "verdict"]) == 2
    assert "did you mean verdicts?" in capsys.readouterr().err


def test_the_glossary_is_in_order_and_its_terms_are_those_of_the_code() -> None:
    """The first word of each stands in a docstring, a name or a comment of the package; symbols come first."""
    rows = [row.split("|")[1].strip() for row in (GUIDE / "glossary.md").read_text().splitlines() if row.startswith("| ")]
    terms = rows[2:]
    assert len(terms) > 60
    assert terms == sorted(set(terms), key=str.casefold)
    said = "\n".join(path.read_text().casefold() for path in GUIDE.parent.rglob("*.py"))
    names = [re.split(r"[ -]", term.casefold())[0] for term in terms]
    assert [name for name in names if name not in said] == []


def test_the_reference_has_every_public_name_with_its_docstring(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["guide", "reference"]) == 0
    page = capsys.readouterr().out
    for name in (n for n in dir(st) if not n.startswith("_")):
        assert f"## st.{name}" in page
    assert "## st.chute.steady\n" in page
    assert "### st.LinearProblem.ends\n" in page
    assert (st.verify.__doc__ or "?").splitlines()[0] in page
    assert "\n\n\n## " not in page  # each has something to say


def test_a_site_is_made_by_one_command_without_a_warning(tmp_path: Path) -> None:
    pytest.importorskip("mkdocs", reason="mkdocs is not installed: a site needs the extra `docs`")
    made = subprocess.run(
        [sys.executable, "-m", "shootstab", "guide", "--site", str(tmp_path / "site")], capture_output=True, text=True, timeout=100
    )
    assert made.returncode == 0, made.stderr
    assert "WARNING" not in made.stderr
    for topic in [*TOPICS, "reference", "index"]:
        html = (tmp_path / "site" / f"{topic}.html").read_text()
        assert "```" not in html, topic
        assert f'href="{topic}.html"' in (tmp_path / "site" / "index.html").read_text() or topic == "index"
    assert cli.main(["guide", "--site", str(tmp_path / "site")]) == 2  # what is there is not written over


def test_no_file_cites_a_page_that_is_not_shipped() -> None:
    root = GUIDE.parent.parent
    for path in [*root.glob("shootstab/**/*.py"), *root.glob("tests/**/*.py"), *root.glob("validation/*.py"), *GUIDE.glob("*.md")]:
        assert path == Path(__file__) or not re.search(r"DESIGN(\.md)?\b", path.read_text()), path


def test_a_page_that_shows_what_is_not_said_is_found(tmp_path: Path) -> None:
    assert pages.matches("a...d\n...\nlast\n", "abcd\n1\n2\nlast\n")
    assert not pages.matches("a...d\n", "abc\n")
    assert not pages.matches("abcd\n", "abcd\nmore\n")
    with pytest.raises(AssertionError, match="exit status 3"):
        pages.run_page("```console\n$ exit 3\n```\n", tmp_path)
    with pytest.raises(AssertionError, match="printed"):
        pages.run_page("```python\nprint(1)\n```\n\n```output\n2\n```\n", tmp_path)
