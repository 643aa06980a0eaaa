"""What a list of eigenvalues lacks: modes among them, never beyond them, and in words where was looked."""

from __future__ import annotations

import math

import numpy as np
import pytest

import shootstab as st
from shootstab.analyses import verifier
from shootstab.analyses.missing import require_missing, told_missing
from shootstab.analyses.zeros import zeros_in
from shootstab.core.division import distance_outside
from shootstab.core.records import Budget, Mode, Verdict
from shootstab.core.regions import Rectangle, convex_hull

WALLS = st.Wall(0, np.eye(4)[[0, 2]]), st.Wall(1, np.eye(4)[[0, 2]])


def strings(first: complex = 1.0, second: complex = 1.0 + 0.7j) -> object:
    """Two strings that know nothing of each other: σ = −(kπ)² times one number or the other."""
    D0, D1 = np.zeros((4, 4), complex), np.zeros((4, 4), complex)
    D0[0, 1] = D0[2, 3] = 1.0
    D1[1, 0], D1[3, 2] = 1 / first, 1 / second
    return st.problem(4, lambda _: (D0, D1), *WALLS)


# by falling growth rate
MODES = sorted((-((k * math.pi) ** 2) * factor for k in range(1, 9) for factor in (1.0, 1.0 + 0.7j)), key=lambda s: (-s.real, s.imag))


@pytest.mark.parametrize("count", [2, 3, 5, 6, 9])
def test_the_first_modes_of_a_right_spectrum_lack_none(count: int) -> None:
    report = st.verify(strings(), MODES[:count])
    assert [v.verdict for v in report.verdicts] == ["confirmed"] * count
    assert report.missing == ()
    assert report.undecided == ()
    assert report.claims_inside == count
    assert report.searched.startswith("among the claims, from ")
    assert report.searched.endswith("where both claims lie" if count == 2 else f"where all {count} claims lie")
    assert report.region is not None
    assert all(report.region.contains(s) for s in MODES[:count])


def test_the_modes_nearest_to_a_target_lack_none() -> None:
    nearest = sorted(MODES, key=lambda s: abs(s + 100 + 30j))[:6]
    assert st.verify(strings(), nearest).missing == ()


@pytest.mark.parametrize("lost", [2, 4])
def test_a_mode_among_the_claims_is_missing(lost: int) -> None:
    claims = [s for i, s in enumerate(MODES[:8]) if i != lost]
    report = st.verify(strings(), claims)
    assert [complex(m.sigma) for m in report.missing] == pytest.approx([MODES[lost]])
    assert st.verify(strings(), claims, missing="none").missing == ()


def test_a_mode_between_claims_on_a_line_is_missing() -> None:
    real = [-((k * math.pi) ** 2) for k in (1, 3)]
    assert [m.sigma.real for m in st.verify(strings(), real).missing] == pytest.approx([-((2 * math.pi) ** 2)])


def test_the_wish_and_the_region_go_together() -> None:
    report = st.verify(strings(), MODES[:1], missing="none")
    assert report.searched == "missing modes were not looked for"
    assert report.region is None
    box = Rectangle(-12 - 9j, 1 + 1j)
    report = st.verify(strings(), MODES[:1], region=box)
    assert report.region is box
    assert report.searched == "in the region, from -12-9j to 1+1j, where the claim lies"
    assert len(report.missing) == 1
    assert require_missing(None, None) == "within"
    for wish, region, why in (
        ("region", None, "needed is a region"),
        ("none", box, "needed is no region"),
        ("all", None, "allowed is none"),
    ):
        with pytest.raises(st.InputError, match=why):
            st.verify(strings(), [1.0], missing=wish, region=region)


def test_a_region_that_cannot_be_searched_as_a_whole_is_divided_and_its_unstable_side_kept() -> None:
    """Pöschl–Teller: the negative real axis is the essential spectrum, and the mode right of it is found nevertheless."""

    def pencil(x: float) -> tuple[np.ndarray, np.ndarray]:
        return np.array([[0, 1], [-2 / np.cosh(x) ** 2, 0]], complex), np.array([[0, 0], [1, 0]], complex)

    problem = st.problem(2, pencil, st.Infinity(), st.Infinity())
    report = st.verify(problem, [3.0], region=Rectangle(-2 - 1j, 2 + 1.1j))
    assert [complex(m.sigma) for m in report.missing] == pytest.approx([1.0])
    assert report.undecided
    assert all("the continuous spectrum of an end at infinity" in why for why in report.undecided)


def test_distance_outside_a_hull() -> None:
    square = convex_hull((0j, 1 + 0j, 1 + 1j, 1j, 0.5 + 0.5j))
    assert len(square) == 4
    assert distance_outside(square, 0.3 + 0.9j) == 0.0
    assert distance_outside(square, 1.5 + 0.5j) == pytest.approx(0.5)
    assert distance_outside(square, 2 + 2j) == pytest.approx(math.sqrt(2))
    assert distance_outside(convex_hull((0j, 2 + 0j)), 1 + 0.25j) == pytest.approx(0.25)
    assert distance_outside(convex_hull((1j,)), 0j) == pytest.approx(1.0)


def mode(sigma: complex, multiplicity: int = 1) -> Mode:
    budget = Budget(1e-12, 0.0, 0.0, 0.0, 0.0)
    return Mode(sigma, 1e-12, budget, "converged", "frame", 1, 0.0, multiplicity=multiplicity)


@pytest.mark.parametrize(("verdict", "told"), [("unresolved", 1), ("continuum", 1), ("spurious", 2)])
def test_a_mode_that_an_unsettled_claim_may_mean_is_not_called_missing(verdict: str, told: int) -> None:
    absent, unsure = told_missing([mode(-9.87), mode(-39.5)], [Verdict(-9.8696, verdict, "")])
    assert len(absent) == told
    assert len(unsure) == 2 - told
    assert all("claim 1" in sentence and "-9.87" in sentence for sentence in unsure)


def test_one_unsettled_claim_means_one_mode_of_several() -> None:
    absent, unsure = told_missing([mode(-9.87, multiplicity=2)], [Verdict(-9.8696, "unresolved", "")])
    assert [m.multiplicity for m in absent] == [1]
    assert len(unsure) == 1


def test_a_claim_whose_mesh_needs_too_much_memory_loses_no_other(monkeypatch: pytest.MonkeyPatch) -> None:
    def zeros(continuation: object, disc: st.Disc, most: int | None = None) -> object:
        if abs(disc.centre) > 20.0:
            raise MemoryError("Unable to allocate 1 GiB")
        return zeros_in(continuation, disc, most)  # type: ignore[arg-type]

    monkeypatch.setattr(verifier, "zeros_in", zeros)
    report = st.verify(strings(), [-(math.pi**2), -4 * math.pi**2], missing="none")
    assert [v.verdict for v in report.verdicts] == ["confirmed", "unresolved"]
    assert "memory" in report.verdicts[1].why


def test_claims_that_lie_where_was_searched_are_not_called_outside() -> None:
    """A claim that is no mode, among those that are, adds no part of the plane; one beyond them does."""
    inside = st.verify(strings(), [*MODES[:5], 0.9 * MODES[2]])
    assert inside.claims_inside == 6 and inside.undecided == ()
    beyond = st.verify(strings(), [*MODES[:5], 30.0])
    assert beyond.claims_inside == 5
    assert beyond.undecided == ("the part of the plane that 1 more of the claims adds: name a region to search there",)
