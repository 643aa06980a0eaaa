"""Every command, scene and program of the README does what it says."""

from __future__ import annotations

from pathlib import Path

import pages
import pytest

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text()
GUIDE = ROOT / "shootstab" / "guide"


def test_the_two_commands_are_what_ci_runs() -> None:
    ci = (ROOT / ".ci" / "run").read_text()
    setup, tests = next(b.text for b in pages.blocks(README) if b.kind == "sh").strip().splitlines()
    for part in setup.split(" && ")[:2]:
        assert part in ci.replace(" --quiet", "")
    assert tests in ci
    assert setup.split(" && ")[2] == ".venv/bin/shootstab verify high"


@pytest.mark.slow
def test_the_readme_does_what_it_shows_and_fits_a_page(tmp_path: Path) -> None:
    assert len(README.splitlines()) <= 150
    (tmp_path / "validation").symlink_to(ROOT / "validation")
    pages.run_page(README, tmp_path)
    assert (tmp_path / "fig2.png").stat().st_size > 10_000


@pytest.mark.parametrize(("block", "size"), [("chute.toml", 8), ("plate.toml", 8)])
def test_the_scenes_of_the_readme_load(block: str, size: int, tmp_path: Path) -> None:
    from shootstab.io.scenes import load

    (tmp_path / "scene.toml").write_text(next(b.text for b in pages.blocks(README) if b.name == block))
    assert load(str(tmp_path / "scene.toml")).problem.size == size


def test_every_link_of_the_readme_leads_somewhere_and_every_page_is_named() -> None:
    import re

    links = re.findall(r"\]\(([^)]+)\)", README)
    assert links
    assert all((ROOT / link).exists() for link in links), links
    table = README.split("## Where to read on")[1]
    for page in GUIDE.glob("*.md"):
        assert f"`{page.stem}`" in table, page


def test_sixty_digits_of_the_guides_rod(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The page itself is run by test_guide.py, on the command line too; here its number is proved: −x² with x tan x = 3/10."""
    import mpmath

    program = next(b.text for b in pages.blocks((GUIDE / "your-own-equations.md").read_text()) if b.name == "rod.py")
    exec(compile(program, "rod.py", "exec"), {})
    said = capsys.readouterr().out.strip()
    with mpmath.workdps(70):
        x = mpmath.findroot(lambda x: x * mpmath.tan(x) - mpmath.mpf(3) / 10, 0.5)
        assert abs(mpmath.mpf(said) + x * x) < mpmath.mpf(10) ** -59
