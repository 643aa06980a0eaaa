"""analyses/work_precision.py and cli/trade_command.py: curves are followed as far as they pay, and errors are true ones."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

from shootstab.analyses import work_precision as trade
from shootstab.analyses.work_precision import Measurement, MethodCurve, WorkPrecision
from shootstab.cli import main as cli
from shootstab.cli import trade_command as trading
from shootstab.core.errors import ConvergenceError, InputError
from shootstab.io.scenes import load
from shootstab.models.chute import ChuteProblem
from shootstab.models.gallery.poiseuille import PlanePoiseuille


@pytest.fixture(scope="module")
def few() -> WorkPrecision:
    """Plane Poiseuille flow on short curves, which all methods follow in a few seconds."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(trade, "TRUNCATIONS", (24, 48, 64))
        patch.setattr(trade, "TOLERANCES", (1e-4, 1e-8, 1e-11))
        patch.setattr(trade, "ENOUGH", 0.0)
        return trade.trade(PlanePoiseuille())


def test_errors_are_true_ones(few: WorkPrecision) -> None:
    truth = -1j * (0.23752648882047010745 + 0.0037396706229794099322j)  # Orszag 1971, with more digits: σ = −iαc
    assert abs(complex(few.truth) - truth) < 1e-16
    assert few.guess == complex(0.004, -0.238)
    for r in few.measurements:
        assert abs(abs(complex(r.sigma) - truth) - r.error) < 1e-16 + 1e-3 * r.error
    assert {r.method for r in few.measurements} == {"qz", "frame", "compound", "riccati", "taylor series"}


def test_a_finer_resolution_gains(few: WorkPrecision) -> None:
    for method in ("qz", "frame", "compound", "riccati"):
        errors = [r.relative for r in few.measurements if r.method == method]
        assert min(errors) < 1e-8 < 1e-6 < max(errors)
    exact = [r for r in few.measurements if r.method == "taylor series"]
    assert [r.by_bound for r in exact] == [False, False, True]
    for r in exact:
        assert r.relative < 10.0**-r.resolution


def test_the_recommendation_is_what_was_measured(few: WorkPrecision) -> None:
    best = few.cheapest(8)
    assert best is not None
    assert best.seconds == min(r.seconds for r in few.measurements if r.relative <= 1e-8)
    assert f"8 digits by {best.method} in " in few.recommendation
    assert few.recommendation.endswith(".")


def measurement(method: str, error: float, seconds: float, resolution: float = 1.0) -> Measurement:
    return Measurement(method, "M", resolution, 1 + 0j, error, seconds, 1000, 1)


def test_the_recommendation_names_the_quickest_and_compares() -> None:
    measurements = (
        measurement("qz", 1e-5, 0.1),
        measurement("qz", 1e-9, 0.8),
        measurement("frame", 1e-6, 0.02),
        measurement("frame", 1e-12, 0.04),
    )
    said = WorkPrecision(measurements, 1 + 0j, 0.0, 1 + 0j).recommendation
    assert "4 digits by frame in 20 ms (5 times faster than QZ)" in said
    assert "8 digits by frame in 40 ms (20 times faster than QZ)" in said
    assert "11 digits by frame in 40 ms (which QZ does not reach)" in said


def test_a_curve_ends_where_nothing_is_gained(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trade, "ENOUGH", 0.0)
    tried: list[float] = []

    def at(resolution: float) -> Any:
        def run(fresh: Any, guess: complex) -> tuple[complex, int]:
            tried.append(resolution)
            if resolution == 2.0:
                raise ConvergenceError("no mesh")
            return 1 + max(10.0**-resolution, 1e-6), 1

        return run

    curve = MethodCurve("frame", "M", tuple(float(k) for k in range(1, 20)), at)
    found = trade.measured(curve, PlanePoiseuille(), 1 + 0j, 1 + 0j)
    assert [r.resolution for r in found] == [3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]  # at 1 it is another number, at 2 there is none
    assert max(tried) == 9.0


def test_without_a_reference_a_guess_is_needed() -> None:
    problem: Any = object()
    with pytest.raises(InputError, match="no bundled pseudospectral reference"):
        trade.trade(problem)
    for guess in (0.0, math.nan):
        with pytest.raises(InputError, match="allowed is a finite number other than 0"):
            trade.trade(PlanePoiseuille(), guess)


def test_all_spectral_curves_of_the_chute(scenes: dict[str, ChuteProblem]) -> None:
    problem = scenes["high"]
    for curve in trade.spectral_curves(problem):
        sigma, work = curve.at(48)(problem, 0.00397)
        assert abs(sigma - 0.003970504638889) < 1e-10
        assert work >= 1


def test_table_json_and_picture(
    few: WorkPrecision, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(trade, "trade", lambda problem, guess, told: few)
    file = tmp_path / "a.png"
    assert cli.main(["trade", "poiseuille", "--json", "-", "--plot", str(file)]) == 0
    said = json.loads(capsys.readouterr().out)
    own = {"truth", "bound", "guess", "measurements", "recommendation"}
    assert set(said) == own | {"scene", "version", "seconds", "compilation_seconds"}
    keys = {"method", "parameter", "resolution", "sigma", "error", "relative_error", "by_bound", "seconds", "memory", "work"}
    assert all(set(r) == keys for r in said["measurements"])
    assert said["truth"]["re"].startswith("0.00373967062297940993")
    assert file.stat().st_size > 20_000
    assert cli.main(["trade", "poiseuille"]) == 0
    out = capsys.readouterr().out
    assert "rtol 1e-08" in out
    assert " ".join(few.recommendation.split()) in " ".join(out.split())
    left, right = trading.draw(few, load("poiseuille")).axes
    assert left.get_ylabel() == "time / s"
    assert right.get_ylabel() == "peak memory / MB"
