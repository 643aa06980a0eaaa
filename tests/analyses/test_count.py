"""Counts rest on D that is known well enough on the contour; where the continuous spectrum is cut, on two of them that agree."""

from __future__ import annotations

import cmath
import math

import mpmath
import numpy as np
import pytest

import shootstab as st
from shootstab.analyses import count as counting
from shootstab.analyses.accuracy import Inaccurate, Tightening, require_accurate
from shootstab.analyses.count import counted, counted_twice
from shootstab.analyses.cut_region import count_in_region
from shootstab.analyses.resonances import find_resonances
from shootstab.core.regions import Disc, Rectangle
from shootstab.discriminants.continuation import Continuation, Undecidable
from shootstab.discriminants.frame import Frame
from shootstab.models.chute import ChuteProblem

MASS = np.array([[0, 0], [1, 0]], dtype=complex)


def string(rows: list[list[float]]) -> object:
    """y″ = σ y on (0, 1) with the same condition at both ends."""
    return st.problem(2, lambda _: (np.eye(2, k=1, dtype=complex), MASS), st.Wall(0, rows), st.Wall(1, rows))


@pytest.mark.parametrize("k", [1, 3, 10])
@pytest.mark.parametrize("radius", [1e-2, 1e-6, 1e-8, 1e-9])
def test_small_regions_hold_the_exact_eigenvalue(k: int, radius: float) -> None:
    """−(kπ)² of a string: the zero of D on a mesh for 1e−7 lies far outside of the smaller ones."""
    sigma = -((k * math.pi) ** 2)
    assert st.count(string([[1, 0]]), Disc(sigma, radius)) == 1
    assert st.count(string([[1, 0]]), Rectangle(sigma - radius - 1j * radius, sigma + radius + 1.1j * radius)) == 1
    assert st.count(string([[1, 0]]), Disc(sigma + 2 * radius, radius)) == 0


def test_a_region_smaller_than_rounding_is_refused() -> None:
    with pytest.raises(Inaccurate, match=r"not known well enough for a count: at sigma = -986\.96.* change it by"):
        st.count(string([[1, 0]]), Disc(-((10 * math.pi) ** 2), 1e-12))


def test_accuracy_is_asked_of_the_mesh_and_the_method_is_tightened() -> None:
    problem, disc = string([[1, 0]]), Disc(-((10 * math.pi) ** 2), 1e-6)
    loose = Continuation(problem, Frame(rtol=1e-5))
    with pytest.raises(Inaccurate):
        count_in_region(loose, disc)
    tightened, found = counted_twice(Tightening(loose), disc)
    assert found.count == 1
    assert tightened.method.rtol < 1e-8


@pytest.mark.parametrize("radius", [1e-7, 1e-10])
def test_a_small_circle_over_which_meshes_change(radius: float) -> None:
    """y″ = (ix − σ)y on the half-line, at arg σ = 60°, where two cells of the σ-plane meet: from one mesh to the next D jumps."""
    slope = np.array([[0, 0], [-1.0, 0]])
    problem = st.problem(2, lambda x: (np.array([[0, 1], [1j * x, 0]]), slope), st.Wall(0, [[1, 0]]), st.Infinity(start=40.0))
    exact = -complex(mpmath.airyaizero(4)) * cmath.exp(1j * math.pi / 3)
    size = radius * abs(exact)
    assert st.count(problem, st.Disc(exact + 0.3 * size, size)) == 1
    assert st.count(problem, st.Disc(exact + 2.2j * size, size)) == 0


def test_a_mode_is_found_in_a_small_circle_around_itself() -> None:
    problem = st.problem(
        2, lambda x: (np.array([[0, 1], [50 * np.cos(3 * x), 0]], complex), MASS), st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]])
    )
    mode = st.refine(problem, -30.0, rtol=1e-12)
    (found,) = st.find(problem, Disc(mode.sigma, 1e-9)).modes
    assert abs(found.sigma - mode.sigma) <= found.error + mode.error < 1e-11


@pytest.mark.parametrize("rtol", [1e-9, 1e-12])
def test_the_triple_of_coffey_and_evans(rtol: float) -> None:
    """β = 30 (Pryce 1993, problem 7 of the standard set): three modes within 2e−7, whatever the tolerance.

    Truth: the problem in the basis sin k(x + π/2), k ≤ 64, a symmetric matrix, with 30 digits.
    """
    truth = [231.664929237127109, 231.664929312961013, 231.664929388794917]
    beta = 30.0

    def pencil(x: float) -> tuple[np.ndarray, np.ndarray]:
        """y″ = (−2β cos 2x + β² sin² 2x − σ) y."""
        return np.array([[0, 1], [-2 * beta * np.cos(2 * x) + (beta * np.sin(2 * x)) ** 2, 0]], complex), -MASS

    problem = st.problem(2, pencil, st.Wall(-math.pi / 2, [[1, 0]]), st.Wall(math.pi / 2, [[1, 0]]))
    found = st.find(problem, Rectangle(200 - 5j, 300 + 5.1j), method=Frame(rtol=rtol))
    assert sorted(m.sigma.real for m in found.modes) == pytest.approx(truth, abs=3e-9)
    assert [m.multiplicity for m in found.modes] == [1, 1, 1]
    assert st.count(problem, Disc(231.66492931, 1e-6)) == 3
    assert st.count(problem, Disc(231.66492931, 3e-8)) == 1


GROWING, BEYOND = 0.00021990660491 + 3.4018169e-7j, -0.0019283715831 + 8.8394329e-6j


@pytest.mark.parametrize(("radius", "truth"), [(1e-3, 1), (1e-2, 1), (0.3, 3)])
def test_a_region_entered_by_a_continuous_spectrum_that_hugs_the_real_axis(slow_wave: ChuteProblem, radius: float, truth: int) -> None:
    found = counted(slow_wave, Disc(0, radius))
    assert found.count == truth
    assert found.cut
    assert found.closure < 1e-4


def test_what_lies_beyond_that_spectrum_is_a_resonance(slow_wave: ChuteProblem) -> None:
    """D itself, integrated along the real axis on a fine mesh, has no zero there: the count that leaves it out is right."""
    D = Frame(rtol=1e-10).on(slow_wave)
    step = D.with_derivative(BEYOND).newton_step
    assert abs(step) > 1e-5
    assert abs(D.with_derivative(GROWING).newton_step) < 1e-12
    (found,) = st.find(slow_wave, Disc(0, 1e-2)).modes
    assert abs(found.sigma - GROWING) < 1e-13
    continuation = Continuation(slow_wave, Frame(rtol=1e-9))
    assert min(abs(r - BEYOND) for r in find_resonances(continuation, Rectangle(-0.0025 - 1e-4j, -0.0015 + 1e-4j))) < 1e-11


def test_two_counts_that_differ_are_refused(slow_wave: ChuteProblem, monkeypatch: pytest.MonkeyPatch) -> None:
    """The second count, of the parts of a region, is one that can fail."""
    calls = []

    def once_wrong(continuation: Continuation, region: object) -> object:
        calls.append(region)
        return count_in_region(continuation, Disc(0, 1e-2) if len(calls) == 1 else Disc(1.0, 0.1))  # type: ignore[arg-type]

    monkeypatch.setattr(counting, "count_in_region", once_wrong)
    with pytest.raises(Undecidable, match=r"1 mode is counted in the region, and 0 \+ 0 in the parts"):
        counted(slow_wave, Disc(0, 1e-2))


def test_nothing_is_asked_of_a_contour_on_which_d_does_not_change(slow_wave: ChuteProblem) -> None:
    discriminant = Frame(rtol=1e-8).on(slow_wave).at(1.0)
    require_accurate(slow_wave, [(discriminant, discriminant.with_derivative(1.0))])


@pytest.mark.parametrize("region", [Disc(0, 5e-6), Rectangle(-1e-3 - 1e-3j, 1e-3 + 1e-3j)])
def test_a_dispersive_spectrum_through_the_region_is_refused(region: Disc | Rectangle) -> None:
    """σ v = −v‴ + (4 − 12 sech² x) v′ + 24 sech² x tanh x v, KdV about its soliton, has iR as its essential spectrum."""

    def pencil(x: float) -> tuple[np.ndarray, np.ndarray]:
        sech2, tanh = 1 / np.cosh(x) ** 2, np.tanh(x)
        D0 = np.array([[0, 1, 0], [0, 0, 1], [24 * sech2 * tanh, 4 - 12 * sech2, 0]], complex)
        return D0, np.array([[0, 0, 0], [0, 0, 0], [-1, 0, 0]], complex)

    problem = st.problem(3, pencil, st.Infinity(), st.Infinity(), reference=1.0)
    for ask in (st.count, st.find):
        with pytest.raises(Undecidable, match="enters the region"):
            ask(problem, region)
