"""verify --html: one file that asks for nothing else, and works in a real browser where there is one."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

import shootstab as st
from shootstab.cli import page
from shootstab.cli.page import Page

pytest.importorskip("plotly", reason="plotly is not installed: the page needs the extra `report`")
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
CLAIMS = [0.0037396706 - 0.2375264888j, 0.1 + 0.1j, -0.0350 - 0.9646j, complex(-0.0509, -0.2772)]

# run in the page after its own script: what a person would do, and what is seen then
SCRIPT = """
<script>
const seen = { errors: window.faults, plots: document.querySelectorAll(".js-plotly-plot").length };
const rows = () => [...document.querySelectorAll("#verdicts tbody tr")].filter((r) => !r.hidden).map((r) => r.cells[0].textContent);
seen.all = rows();
const heading = document.querySelectorAll("#verdicts th")[1];
heading.click(); seen.rising = rows(); heading.click(); seen.falling = rows();
const box = document.querySelector("input[value=spurious]");
box.checked = false; box.dispatchEvent(new Event("input", { bubbles: true })); seen.without = rows();
const search = document.querySelector("input[type=search]");
search.value = "confirmed"; search.dispatchEvent(new Event("input", { bubbles: true })); seen.confirmed = rows();
seen.says = document.querySelector("output").textContent;
Plotly.relayout("plane", { "xaxis.range": [0, 1] });
seen.range = document.getElementById("plane").layout.xaxis.range;
const wide = () => [document.getElementById("plane").layout.width ?? null, document.getElementById("plane").layout.xaxis.range];
dispatchEvent(new Event("beforeprint")); seen.printed = wide(); dispatchEvent(new Event("afterprint")); seen.after = wide();
seen.resources = performance.getEntriesByType("resource").map((r) => r.name).filter((name) => !name.startsWith("data:"));
document.body.insertAdjacentHTML("beforeend", `<pre id=seen>${JSON.stringify(seen)}</pre>`);
</script></body></html>"""


LEFT_OUT = "No eigenfunction of the mode at 1: it < 2."


@pytest.fixture(scope="module")
def made() -> str:
    report = st.verify("poiseuille", CLAIMS, digits=4, missing="none")
    scene = st.scene("poiseuille")
    mode = st.refine("poiseuille", CLAIMS[0])
    shape = st.eigenfunction(scene, mode)
    return page.made(Page(report, scene, [mode], [shape], [LEFT_OUT], "shootstab verify poiseuille claims.csv --html <page>.html"))


def test_the_page_is_whole_and_asks_for_nothing(made: str) -> None:
    own = made.replace(re.search(r"<script>(.*?)</script>", made, re.DOTALL)[1], "")  # type: ignore[index]  # without plotly.js
    assert not re.search(r"""(src|href)\s*=\s*["']?(https?:)?//""", own)
    assert "@import" not in own
    for words in ("Verdicts", "Complex plane", "Error budgets", "Eigenfunctions", "shootstab verify poiseuille claims.csv", "&lt;page&gt;"):
        assert words in own
    assert LEFT_OUT.replace("<", "&lt;") in own
    assert own.count("data-verdict=") == len(CLAIMS)
    figures = [json.loads(text) for text in re.findall(r"data-figure=\w+>(.*?)</script>", own)]
    assert len(figures) == 2
    marked = [point for trace in figures[0]["data"] if trace["mode"] == "markers" for point in zip(trace["x"], trace["y"], strict=True)]
    assert (CLAIMS[1].real, CLAIMS[1].imag) in marked
    (left, right), (low, high) = (figures[0]["layout"][axis]["range"] for axis in ("xaxis", "yaxis"))
    assert all(left < x < right and low < y < high for x, y in marked)  # nothing is out of sight where all is near
    assert "<span class=unbroken>7.1e-03</span>" in own
    assert "updatemenus" not in figures[0]["layout"]


def test_what_the_magnified_part_leaves_out_is_said_and_a_button_shows_it() -> None:
    claims = [CLAIMS[0], CLAIMS[0] * 1.001, 0.1 - 40j]
    report = st.verify("poiseuille", claims, digits=4, missing="none")
    made = page.made(Page(report, st.scene("poiseuille"), [], [], [], "shootstab verify poiseuille"))
    assert "holds 2 of the 3 rows above; the button “all” shows the others." in made
    (figure,) = (json.loads(text) for text in re.findall(r"data-figure=plane>(.*?)</script>", made))
    magnified, everything = (button["args"][0] for button in figure["layout"]["updatemenus"][0]["buttons"])
    low, high = magnified["yaxis.range"]
    assert [low, high] == figure["layout"]["yaxis"]["range"]
    assert not low <= claims[2].imag <= high
    low, high = everything["yaxis.range"]
    assert all(low < claim.imag < high for claim in claims)


def test_words_of_a_user_are_words_and_no_markup(made: str) -> None:
    assert "<page>" not in made


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here: `apt install chromium` to run this")
def test_in_a_browser_it_opens_without_an_error_sorts_filters_and_zooms(made: str, tmp_path: Path) -> None:
    assert CHROMIUM is not None
    watched = made.replace("<head>", "<head><script>window.faults = []; window.onerror = (m) => faults.push(m);</script>", 1)
    (tmp_path / "page.html").write_text(watched.removesuffix("</body></html>") + SCRIPT, encoding="utf-8")
    flags = ["--headless", "--no-sandbox", "--disable-gpu", "--proxy-server=127.0.0.1:9", f"--user-data-dir={tmp_path / 'profile'}"]
    done = subprocess.run(
        [CHROMIUM, *flags, "--virtual-time-budget=20000", "--dump-dom", (tmp_path / "page.html").as_uri()],
        capture_output=True,
        text=True,
        timeout=120,
    )
    found = re.search(r'<pre id="seen">(.*?)</pre>', done.stdout, re.DOTALL)
    assert found, done.stderr[-2000:]
    seen = json.loads(found[1])
    assert seen["errors"] == []
    assert seen["plots"] == 2
    assert seen["all"] == ["1", "2", "3", "4"]
    assert seen["rising"] == ["4", "3", "1", "2"]
    assert seen["falling"] == ["2", "1", "3", "4"]
    assert "2" not in seen["without"]
    assert seen["confirmed"]
    assert seen["says"] == f"{len(seen['confirmed'])} of 4 rows"
    assert seen["range"] == [0, 1]
    assert seen["printed"] == [640, [0, 1]]  # fits on paper, and shows what was looked at
    assert seen["after"] == [None, [0, 1]]
    assert seen["resources"] == []
