"""models/gallery: every solved problem against its published digits, and the guide's problem of one's own."""

from __future__ import annotations

import importlib
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pages
import pytest

import shootstab as st
from shootstab.core.errors import InputError
from shootstab.models.catalogue.published import PUBLISHED, Published
from shootstab.models.gallery.benard import free_growth_rate
from shootstab.models.gallery.blasius import flow

ROOT = Path(__file__).parents[3]
MANY_DIGITS: dict[str, list[str]] = json.loads((Path(__file__).parent / "many_digits.json").read_text())["modes"]


@pytest.mark.parametrize("case", [c for c in PUBLISHED if not c.slow], ids=lambda c: c.name)
def test_published_digits(case: Published) -> None:
    must_agree(case, case.problem())
    verdict = st.verify(case.problem(), [case.sigma], digits=min(case.digits - 1, 9), region=None).verdicts[0]
    assert verdict.verdict == "confirmed"


def mode_in_many_digits(case: Published) -> complex:
    """The eigenvalue by Taylor series of more digits than a double holds, as validation/gallery.py --record found it."""
    return complex(*map(float, MANY_DIGITS[case.name]))


def must_agree(case: Published, problem: Any) -> None:
    """A mode of the problem in doubles has the published digits; where they share the equations alone, those of Taylor series too."""
    mode = st.refine(problem, case.sigma * (1 + 1e-4), rtol=1e-9)
    assert mode.converged
    assert abs(mode.sigma - case.sigma) <= mode.error + case.tolerance
    if case.name in MANY_DIGITS:
        truth = mode_in_many_digits(case)
        assert abs(mode.sigma - truth) <= mode.error + 2.0**-52 * abs(truth)


def test_davies_holds_where_matrices_do_not() -> None:
    """λ_n = e^{iπ/4}(2n+1): the twelfth has a condition of 1e7, and its bound knows."""
    for n in (3, 8, 12):
        exact = np.exp(0.25j * np.pi) * (2 * n + 1)
        mode = st.refine(st.gallery.davies(), exact + 0.1, rtol=1e-8)
        assert mode.converged
        assert abs(mode.sigma - exact) <= mode.error < 1e-8 * abs(exact)


def test_free_walls_exactly() -> None:
    for rayleigh, a, prandtl, n in ((1000.0, 2.5, 0.71, 1), (27000.0, 4.0, 7.0, 2)):
        exact = free_growth_rate(rayleigh, a, prandtl, n)
        mode = st.refine(st.gallery.benard(rayleigh, a, prandtl, "free", "free"), exact * 1.01)
        assert abs(mode.sigma - exact) <= mode.error < 1e-8
    # Rayleigh 1916: Ra_c = 27π⁴/4 at a = π/√2
    assert free_growth_rate(27 * np.pi**4 / 4, np.pi / np.sqrt(2)) == pytest.approx(0.0, abs=1e-12)


def test_critical_points() -> None:
    """The tau method in many digits (reference): Re_c, α_c and c_r of plane Poiseuille flow to 12; Chandrasekhar's Bénard layer to 10."""
    found = st.critical(st.gallery.plane_poiseuille, 5772.0, 1.02, -1.02j * 0.264)
    assert found.reynolds == pytest.approx(5772.22181620970, rel=1e-12)
    assert found.alpha == pytest.approx(1.02054744928533, rel=1e-12)
    assert found.sigma / (-1j * found.alpha) == pytest.approx(0.264000260478798, rel=1e-12)
    assert abs(found.reynolds - 5772.22181620970) < found.reynolds_error
    assert abs(found.alpha - 1.02054744928533) < found.alpha_error
    found = st.critical(st.gallery.benard, 1707.0, 3.11, 0.01)
    assert found.reynolds == pytest.approx(1707.76177710, abs=5.1e-9)
    assert found.alpha == pytest.approx(3.11632355, abs=5.1e-9)


def test_blasius_flow() -> None:
    """Boyd 1999: f″(0) = 0.332057336215196; the displacement thickness is 1.7207876575."""
    U = flow()
    assert U.derivative()(np.array([0.0]))[0] == pytest.approx(0.332057336215196, abs=2e-15)
    y, w = np.polynomial.legendre.leggauss(200)
    assert np.sum(10 * w * (1 - U(10 * (y + 1)))) == pytest.approx(1.7207876575, abs=1e-10)
    y = np.linspace(0.0, 19.9, 300)
    f = np.array(
        [
            np.sum(0.5 * t * w[:, None] * U(0.5 * t * (x + 1))[:, None])
            for t, (x, w) in ((t, np.polynomial.legendre.leggauss(60)) for t in y)
        ]
    )
    residual = 2 * U.derivative().derivative()(y) + f * U.derivative()(y)
    assert np.abs(residual).max() < 1e-13


def test_a_cruder_flow_is_another_one_by_so_much() -> None:
    problem = st.gallery.blasius()
    crude = problem.with_base_flow_error(1e3)
    assert crude is problem.with_base_flow_error(1e3)
    z = np.linspace(0.1, 5.0, 50).astype(complex)
    difference = np.abs(crude.pencil(z).D0 - problem.pencil(z).D0).max() / np.abs(problem.pencil(z).D0).max()
    assert 0.0 < difference < 1e-11


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: st.gallery.blasius(reynolds=-1), "reynolds = -1"),
        (lambda: st.gallery.poeschl_teller(0.0), "nu = 0.0"),
        (lambda: st.gallery.benard(lower="stiff"), "lower = 'stiff'"),
        (lambda: st.gallery.suction(alpha=float("nan")), "alpha = nan"),
    ],
)
def test_parameters_outside_physics(make: Any, words: str) -> None:
    with pytest.raises(InputError, match=words):
        make()


def guide_problem() -> str:
    """The guide's block that writes down a problem."""
    return next(
        b.text for b in pages.blocks((ROOT / "shootstab" / "guide" / "your-own-equations.md").read_text()) if b.name == "channel.py"
    )


def test_the_guides_problem_in_python_and_as_module_and_object(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    code = guide_problem()
    assert len([line for line in code.splitlines() if line.strip()]) <= 15
    module = tmp_path / "channel_of_the_guide.py"
    module.write_text(code)
    done = subprocess.run([sys.executable, str(module)], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "confirmed"
    monkeypatch.syspath_prepend(str(tmp_path))
    importlib.invalidate_caches()
    from shootstab.cli.main import main

    claims = tmp_path / "modes.csv"
    claims.write_text("0.23752649,0.00373967\n0.3+0.1j,\n".replace("0.3+0.1j,", "0.3,0.1"))
    words = [
        "verify",
        "channel_of_the_guide:problem",
        str(claims),
        "--as",
        "phase-speed",
        "--alpha",
        "1",
        "--json",
        str(tmp_path / "out.json"),
    ]
    assert main(words) == 1
    import json

    answer = json.loads((tmp_path / "out.json").read_text())
    assert [v["verdict"] for v in answer["verdicts"]] == ["confirmed", "spurious"]
    assert answer["verdicts"][0]["claimed"] == {"re": "0.23752649", "im": "0.00373967"}
    assert float(answer["verdicts"][0]["sigma"]["re"]) == pytest.approx(0.23752648882047, abs=1e-11)
    assert answer["convention"] == "exp(iα(x - ct))"
