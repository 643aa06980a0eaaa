"""cli/plots.py: a picture is made, whole, and shows what the report says where it can be seen."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from shootstab.cli import figures, plots
from shootstab.cli.verdict_looks import VERDICT_LOOKS
from shootstab.core.errors import InputError
from shootstab.core.records import (
    CONFIRMED,
    CONTINUUM,
    CONVERGED,
    INACCURATE,
    SPURIOUS,
    UNRESOLVED,
    VERDICTS,
    Budget,
    Mode,
    Report,
    Verdict,
)
from shootstab.io.scenes import Scene, load

BUDGET = Budget(1e-13, 1e-14, 1e-14, 1e-15, 1e-16)
TIP = -0.00446j  # where the continuous spectrum of fig2 ends


def verdict(claimed: complex, said: str) -> Verdict:
    sigma = claimed if said in (CONFIRMED, INACCURATE) else None
    return Verdict(claimed, said, "because", sigma, None if sigma is None else 1e-12)


def missing(sigma: complex) -> Mode:
    return Mode(sigma, 1e-12, BUDGET, CONVERGED, "frame", 5, 0.1)


@pytest.fixture(scope="module")
def fig2() -> Scene:
    return load("fig2")


@pytest.fixture(scope="module")
def crowded() -> Report:
    """What QZ gives: modes, a balloon around the continuous spectrum, and rubbish over decades."""
    modes = [1.3e-4 - 0.0041j, -0.0035 - 0.0071j, -0.002 - 0.0018j, -0.3 + 1j]
    balloon = [TIP - 0.0012 + 0.0012 * np.cos(t) + 0.0008j * np.sin(t) for t in np.linspace(0, 6, 40)]
    rubbish = [complex(-(10.0**k), (-1) ** k * 10.0**k) for k in range(-2, 5)]
    said = [(modes, CONFIRMED), (balloon, CONTINUUM), (rubbish, SPURIOUS), ([-0.008 - 0.011j], INACCURATE), ([-0.005 - 0.02j], UNRESOLVED)]
    return Report(tuple(verdict(z, what) for claims, what in said for z in claims), (missing(-0.003 - 0.0095j),), 6)


MAGIC = {".png": b"\x89PNG", ".pdf": b"%PDF", ".svg": b"<?xml"}


@pytest.mark.parametrize("suffix", MAGIC)
def test_a_file_by_its_suffix(tmp_path: Path, fig2: Scene, crowded: Report, suffix: str) -> None:
    path = tmp_path / f"plane{suffix}"
    plots.save(crowded, fig2, path)
    assert path.read_bytes().startswith(MAGIC[suffix])
    assert path.stat().st_size > 5000
    assert list(tmp_path.iterdir()) == [path]


def legend(figure: Any) -> list[str]:
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_every_verdict_has_its_own_mark(fig2: Scene, crowded: Report) -> None:
    figure = plots.draw(crowded, fig2)
    named = legend(figure)
    for said in VERDICTS:
        assert f"{said} ({crowded.summary[said]})" in named
    assert {"continuous spectrum", "mode", "missing mode (1)"} <= set(named)
    looks = [VERDICT_LOOKS[said] for said in VERDICTS]
    for told in ("marker", "colour", "style", "by_day", "by_night"):
        assert len({getattr(look, told) for look in looks}) == len(VERDICTS)


def test_labels_and_title(fig2: Scene, crowded: Report) -> None:
    figure = plots.draw(crowded, fig2)
    for panel in figure.axes:
        assert panel.get_xlabel() == "Re σ / √(g cosθ/d)"
        assert panel.get_ylabel() == "Im σ / √(g cosθ/d)"
    title = figure.get_suptitle()
    assert title.startswith("fig2: 4 confirmed, 1 inaccurate, 7 spurious, 40 continuum, 1 unresolved, 1 missing")


def inside(panel: Any, z: complex) -> bool:
    (left, right), (low, high) = panel.get_xlim(), panel.get_ylim()
    return bool(left < z.real < right and low < z.imag < high)


def test_the_balloon_and_the_mode_beside_it_are_seen(fig2: Scene, crowded: Report) -> None:
    everything, magnified = plots.draw(crowded, fig2).axes
    claims = [v.claimed for v in crowded.verdicts]
    assert all(inside(everything, z) for z in claims)
    assert inside(magnified, TIP)
    balloon = [v.claimed for v in crowded.verdicts if v.verdict == CONTINUUM]
    assert all(inside(magnified, z) for z in balloon)
    # the mode stands apart from the end of the continuous spectrum, by 2 % of the panel at least, about a marker
    width, height = (np.ptp(limits) for limits in (magnified.get_xlim(), magnified.get_ylim()))
    apart = (1.3e-4 - 0.0041j) - TIP
    assert np.hypot(apart.real / width, apart.imag / height) > 0.02
    # and the balloon is no dot
    assert np.ptp(np.real(balloon)) > 0.1 * width
    assert np.ptp(np.imag(balloon)) > 0.1 * height


def test_a_few_claims_need_one_panel(fig2: Scene) -> None:
    claims = (verdict(1.3e-4 - 0.0041j, CONFIRMED), verdict(-3e-4 - 0.0043j, SPURIOUS))
    (panel,) = plots.draw(Report(claims, (), 6), fig2).axes
    assert all(inside(panel, v.claimed) for v in claims)
    assert inside(panel, TIP)


def test_no_claim_is_ever_out_of_sight(fig2: Scene) -> None:
    mode = 1.3e-4 - 0.0041j
    for distance in np.geomspace(1e-6, 1e6, 49):
        claims = (verdict(mode, CONFIRMED), verdict(mode - distance * (1 + 0.3j), SPURIOUS))
        first, *_ = plots.draw(Report(claims, (), 6), fig2).axes
        assert all(inside(first, v.claimed) for v in claims)


def test_a_problem_without_continuous_spectrum() -> None:
    scene = load("poiseuille")
    claims = tuple(verdict(-1j * c, CONFIRMED) for c in (0.2375 + 0.0037j, 0.9646 - 0.0352j))
    figure = plots.draw(Report(claims, (), 6), scene)
    assert legend(figure) == ["confirmed (2)", "mode"]
    assert figure.axes[0].get_xlabel() == "Re σ"


@pytest.mark.parametrize("claims", [[], [0j], [TIP], [1e-300j], [1e12 + 1e12j], [0.1, 0.1]])
@pytest.mark.parametrize("name", ["fig2", "poiseuille"])
def test_odd_reports_are_drawn_too(tmp_path: Path, name: str, claims: list[complex]) -> None:
    for said in (CONFIRMED, SPURIOUS):
        plots.save(Report(tuple(verdict(z, said) for z in claims), (), 6), load(name), tmp_path / "plane.png")
        assert (tmp_path / "plane.png").stat().st_size > 5000


def test_without_matplotlib_one_line_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(figures.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"needs matplotlib: install it with .*shootstab\[plot\]"):
        plots.require(Path("plane.png"))
