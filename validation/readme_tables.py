"""Tables in validation/README.md that scripts write: each stands between two marks, and nothing else of the page is touched."""

from __future__ import annotations

from pathlib import Path

README = Path(__file__).with_name("README.md")


def between(page: str, mark: str, text: str) -> str:
    """The page with this text between `<!-- mark -->` and `<!-- mark: end -->`; ValueError where it lacks one of them."""
    begin, end = f"<!-- {mark} -->", f"<!-- {mark}: end -->"
    before, found, rest = page.partition(begin)
    _, closed, after = rest.partition(end)
    if not (found and closed):
        raise ValueError(f"the page has no {begin} … {end}")
    return f"{before}{begin}\n{text.strip()}\n{end}{after}"


def write(mark: str, text: str, readme: Path = README) -> None:
    """Put the text between its marks."""
    readme.write_text(between(readme.read_text(encoding="utf-8"), mark, text), encoding="utf-8")
