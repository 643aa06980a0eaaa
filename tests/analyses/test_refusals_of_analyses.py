"""Refusals of the analyses that no other test reaches: what was wrong, where, and what is allowed."""

from __future__ import annotations

import math
import sqlite3
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import shootstab as st
from shootstab.analyses import critical, critical_circle, eigenfunction_digits, find, refine_digits, verifier, workers
from shootstab.analyses.prove import prove_interval
from shootstab.analyses.refine_double import examine
from shootstab.analyses.sensitivity import sensitivities
from shootstab.analyses.sweep import dominance, grid
from shootstab.analyses.sweep.outcomes import NONE_GROWS, Outcome
from shootstab.analyses.sweep.store import Store
from shootstab.analyses.unstable import count_unstable
from shootstab.analyses.verdicts import radius_of
from shootstab.analyses.work_precision import trade
from shootstab.analyses.zeros import Crowded, zeros_in
from shootstab.core.discriminant import Value
from shootstab.core.errors import ConvergenceError, InputError, OutputError, Undecidable
from shootstab.core.progress import StageClock
from shootstab.core.records import CONVERGED, Budget, Mode
from shootstab.core.scaled import Scaled
from shootstab.discriminants.continuation import Continuation
from shootstab.multiprecision.backends import choose
from shootstab.problems.rescaled import Rescaled
from shootstab.roots.iterations import Root
from shootstab.roots.search import Zero

FIXED = [[1.0, 0.0]]
FIRST = -(math.pi**2)
WALLS = st.Conditions(0, ["y"]), st.Conditions(1, ["y"])


def string(q: float = 0.0) -> st.LinearProblem:
    """y″ + qy = σy with y = 0 at 0 and 1: σ = q − (kπ)²."""
    D0, D1 = np.array([[0.0, 1.0], [-q, 0.0]]), np.array([[0.0, 0.0], [1.0, 0.0]])
    return st.problem(2, lambda z: (D0, D1), st.Wall(0, FIXED), st.Wall(1, FIXED))


def stated(k: float = 0.0) -> Any:
    """y″ = (σ + k)y as equations."""
    return st.equations(["y"], ["d(y,2) = (sigma + k)*y"], *WALLS, parameters={"k": k})


def one_way() -> st.LinearProblem:
    """u′ = σu with u = 0 at the left, v′ = −σv with v = 0 at the right: D = e^{−σ} has no zero."""
    return st.problem(2, lambda z: (np.zeros((2, 2)), np.diag([1.0, -1.0])), st.Wall(0, FIXED), st.Wall(1, [[0.0, 1.0]]))


def stated_one_way() -> Any:
    return st.equations(["u", "v"], ["d(u) = sigma*u", "d(v) = -sigma*v"], st.Conditions(0, ["u"]), st.Conditions(1, ["v"]))


def mode(sigma: complex, error: float = 1e-12, status: str = CONVERGED) -> Mode:
    return Mode(sigma, error, Budget(error, 0.0, 0.0, 0.0, 0.0), status, "frame", 1, 0.0)


BAD_INPUT: dict[str, tuple[Callable[[], Any], str]] = {
    "digits of 0": (lambda: radius_of(0j, 6), r"^0 has no significant digits: allowed is a claim other than 0, or an absolute accuracy"),
    "reynolds 0": (
        lambda: st.critical(lambda R, a: string(), 0.0, 1.0, 0.1),
        r"reynolds = 0\.0, alpha = 1\.0: allowed are numbers above 0, near the critical point",
    ),
    "no digits of an eigenfunction": (lambda: st.eigenfunction(stated(), FIRST, digits=0), "digits = 0: allowed is 1 or more"),
    "a method of many digits": (
        lambda: st.refine(stated(), FIRST, digits=20, method="riccati"),
        r"method 'riccati': allowed up to 12 digits, more come from Taylor series",
    ),
    "no digits": (lambda: refine_digits.refine_digits(stated(), FIRST, 0), "digits = 0: allowed is 1 to 10000"),
    "units of a third": (
        lambda: st.refine(Rescaled(stated(), 1.0 / 3.0), FIRST, digits=20),
        r"many digits in units of 0\.3333333333333333.*: allowed are units that are decimals of at most 15 digits",
    ),
    "no eigenfunction where no mode is": (lambda: st.eigenfunction(one_way(), 0.3), r"no mode at sigma = .*: not converged: "),
    "an interval of neither": (
        lambda: prove_interval(stated(), "k", 0.0, 1.0),
        "an interval of a parameter: allowed is one of region and floor",
    ),
    "an interval backwards": (
        lambda: prove_interval(stated(), "k", 2.0, 1.0, floor=0.1),
        r"k from 2\.0 to 1\.0: allowed are two finite numbers, the smaller one first",
    ),
    "a parameter that is 0": (
        lambda: sensitivities(st.eigenfunction(stated(), FIRST), ["k"]),
        "k = 0: allowed is a parameter other than 0, as its change is relative",
    ),
    "floor 0": (lambda: count_unstable(string(), 0.0), r"floor = 0\.0: allowed is a number above 0 and below "),
}


@pytest.mark.parametrize("what", BAD_INPUT)
def test_what_was_wrong_is_named(what: str) -> None:
    ask, words = BAD_INPUT[what]
    with pytest.raises(InputError, match=words):
        ask()


def test_a_grid_of_too_many_points_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(grid, "MOST_GRID_POINTS", 5)
    family: Any = SimpleNamespace(sharing=())
    with pytest.raises(InputError, match="6 points: allowed are up to 5"):
        grid.SweepGrid.of({"a": [1.0, 2.0], "b": [1.0, 2.0, 3.0]}, family)


def test_an_address_without_a_scheduler_is_named() -> None:
    pytest.importorskip("distributed")
    with pytest.raises(InputError, match=r"foo://x: no Dask scheduler answers: allowed is an address such as tcp://127\.0\.0\.1:8786"):
        list(workers.on_cluster(lambda job: job, [1], "foo://x"))


def test_results_that_cannot_be_written_are_an_error_of_the_output(tmp_path: Path) -> None:
    path = tmp_path / "sweep.sqlite"
    with Store(path, ["k"], {"digits": 8}) as store:
        with sqlite3.connect(path) as other:
            other.execute("DROP TABLE points")
        other.close()
        with pytest.raises(OutputError, match=r"results cannot be written: no such table: points: what is there already is kept"):
            store.add([(1.0,)], [Outcome(status=NONE_GROWS)])


def test_a_critical_point_that_is_not_reached_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """σ = R − π² − (α − 2)² in one step of Newton, where two are needed to know it."""

    def hill(reynolds: float, alpha: complex) -> st.LinearProblem:
        D0, D1 = np.array([[0, 1], [(alpha - 2) ** 2 - reynolds, 0]]), np.array([[0, 0], [1.0, 0]])
        return st.problem(2, lambda z: (D0, D1), st.Wall(0, FIXED), st.Wall(1, FIXED))

    monkeypatch.setattr(critical, "CRITICAL_STEPS", 1)
    monkeypatch.setattr(critical_circle, "COARSE_POINTS", 4)
    monkeypatch.setattr(critical_circle, "ROUGH_POINTS", 4)
    with pytest.raises(ConvergenceError, match=r"no critical point found near 9\.8596, 2: the last step was"):
        st.critical(hill, 10.0, 2.1, 0.1)


def test_a_family_without_a_mode_has_no_critical_point() -> None:
    with pytest.raises(ConvergenceError, match=r"the mode is lost at reynolds = 10, alpha = 2: not converged"):
        st.critical(lambda reynolds, alpha: one_way(), 10.0, 2.0, 0.1)


def test_a_mode_without_its_digits_has_no_eigenfunction_in_digits(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(refine_digits, "GUESS_RADIUS", -1.0)
    with pytest.raises(ConvergenceError, match=r"no mode to \d+ digits next to -9\.869604.*: no mode is near the guess"):
        st.eigenfunction(stated(), FIRST, digits=20)


def test_an_eigenfunction_of_too_few_digits_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """The mode to five digits only, and no second attempt."""
    monkeypatch.setattr(eigenfunction_digits, "SHAPE_DIGITS", -25)
    monkeypatch.setattr(eigenfunction_digits, "DIGIT_ATTEMPTS", 1)
    with pytest.raises(ConvergenceError, match=r"the eigenfunction is known to .*e-\d+ of its largest values, and 1e-30 was asked for"):
        st.eigenfunction(stated(), FIRST, digits=30)


def test_digits_of_another_mode_than_the_one_that_was_found_are_refused() -> None:
    """A seed that claims an error bound which does not hold."""
    search = refine_digits.DigitSearch(refine_digits.in_digits(stated()), choose(None), mode(-9.8 + 0j), StageClock(None))
    with pytest.raises(ConvergenceError, match=r"leaves the mode that double precision found, by 7\.0e-02 with a bound of 1\.0e-12"):
        search.mode(20, 1e-20)


@dataclass
class CoarseOnly:
    """D = σ − 1, known on one mesh, and no number on any finer one."""

    evaluations: int = 0

    def with_derivative(self, sigma: complex) -> Value:
        return Value(sigma, Scaled(sigma - 1.0, 0.0), 1.0)

    def __call__(self, sigma: complex) -> Scaled:
        return self.with_derivative(sigma).D

    def vanishing_at(self, sigma: complex) -> CoarseOnly:
        return self

    def refined(self) -> Any:
        return SimpleNamespace(with_derivative=lambda sigma: Value(sigma, Scaled(complex("nan"), 0.0), 1.0))


def test_a_zero_without_a_value_on_the_finer_mesh_is_refused() -> None:
    branch = SimpleNamespace(discriminant=CoarseOnly(), path="real line")
    continuation: Any = SimpleNamespace(at=lambda sigma: branch, method=SimpleNamespace(name="riccati", rtol=1e-8), problem=None)
    words = r"riccati has no value of D on the mesh with every step halved, at sigma = 1\+0j: nothing tells how exactly the zero is known"
    with pytest.raises(ConvergenceError, match=words):
        examine(continuation, Root(1 + 0j, 0.0, 0, True), 1e-10)


def test_more_zeros_in_a_disc_than_were_to_be_told_apart_are_named() -> None:
    with pytest.raises(Crowded, match=r"2 zeros lie within 1\.7e\+01") as crowded:
        zeros_in(Continuation(string(), st.Frame(rtol=1e-6)), st.Disc(-25 + 0j, 17.0), most=1)
    assert crowded.value.count == 2


def test_zeros_that_are_nowhere_near_are_refused() -> None:
    continuation = Continuation(string(), st.Frame(rtol=1e-6))
    with pytest.raises(ConvergenceError, match=r"2 zeros were counted at -20\+0j, but no circle is found in which they stay"):
        find.modes_of(continuation, Zero(-20 + 0j, 2, 0.01), 1e-8)


def test_no_circle_across_the_continuous_spectrum_tells_zeros_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rayleigh's equation of a shear layer: the spectrum lies on the imaginary axis, and so does the centre. Each circle is refused."""

    def pencil(y: complex) -> tuple[Any, ...]:
        U = np.tanh(y)
        D0 = np.array([[0, 1], [0.5j * U * (0.25 + 2.0 * (1.0 - U * U)), 0]])
        return np.diag([1, 0.5j * U]), np.diag([0, 1]), D0, np.array([[0, 0], [0.25, 0]])

    said: list[str] = []

    def recorded(words: str) -> Undecidable:
        said.append(words)
        return Undecidable(words)

    monkeypatch.setattr(find, "Undecidable", recorded)
    layer = st.problem(2, pencil, st.Wall(-3, FIXED), st.Wall(3, FIXED), continuum=lambda y: -0.5j * np.tanh(y))
    with pytest.raises(ConvergenceError, match=r"2 zeros were counted at 0\+0\.1j, but no circle is found in which they stay"):
        find.modes_of(Continuation(layer, st.Frame(rtol=1e-6)), Zero(0.1j, 2, 0.02), 1e-6)
    assert said[0] == "the continuous spectrum crosses the circle of 2.0e-02"


def test_no_work_precision_without_a_value_of_many_digits() -> None:
    with pytest.raises(ConvergenceError, match=r"no value of 25 digits next to 0\.3\+0j: not converged"):
        trade(stated_one_way(), 0.3)


def test_modes_without_an_error_bound_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    judged = verifier.Verifier(string(), st.Frame(rtol=1e-8), 6)
    seen = verifier.Sighting(FIRST + 0j, 1e-5, 0.0, math.inf)

    def without_memory(*given: Any) -> Any:
        raise MemoryError("a mesh of 1 GB")

    monkeypatch.setattr(verifier, "examine", without_memory)
    with pytest.raises(ConvergenceError, match="the meshes of its error bound do not fit into the memory that is left: a mesh of 1 GB"):
        judged.modes(Zero(FIRST + 0j), seen)
    lost = replace(mode(FIRST), error=math.inf, status="not converged: the iteration does not settle")
    monkeypatch.setattr(verifier, "examine", lambda *given: (lost, 1))
    monkeypatch.setattr(verifier, "refine", lambda *given, **options: lost)
    with pytest.raises(ConvergenceError, match=r"^not converged: the iteration does not settle$"):
        judged.modes(Zero(FIRST + 0j), seen)


def test_growing_modes_that_are_counted_and_not_found_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """y″ + 20y = σy has one growing mode, 20 − π², and no pseudospectral reference that would suggest it."""
    monkeypatch.setattr(dominance, "find_modes", lambda *given: (None, [], 0))
    with pytest.raises(ConvergenceError, match=r"1 mode is counted with Re sigma > 0\.001, but only 0 found"):
        dominance.count_dominant(string(20.0), [], 1e-3)
