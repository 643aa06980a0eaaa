"""Regions proved along their boundary: zeros known exactly, mirror images, and what is too near."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import pytest

flint = pytest.importorskip("flint")

from flint import acb, arb  # noqa: E402

import shootstab as st  # noqa: E402
from shootstab.analyses import pieces_proof, prove  # noqa: E402
from shootstab.analyses.pieces_proof import by_pieces  # noqa: E402
from shootstab.analyses.prove import prove_region  # noqa: E402
from shootstab.core.errors import ConvergenceError  # noqa: E402

STRING = st.equations(["y"], ["d(y,2) = -sigma*y"], st.Conditions(0, ["y"]), st.Conditions(1, ["y"]))  # (nπ)²


@dataclass(frozen=True)
class KnownDiscriminant:
    """A D in closed form that is analytic off the negative axis and 0: see enclosable.Enclosable and BoundedDiscriminant."""

    D: Callable[[Any], Any]
    real: bool = True
    lemmas: tuple[str, ...] = ()
    premise: str = ""
    multiple: tuple[Any, ...] = ()
    outer: float = 0.0625
    most_points: int = 18

    def enclosure(self, bits: int, *regions: Any) -> KnownDiscriminant:
        return self

    def __call__(self, sigma: Any) -> Any:
        return self.D(sigma)

    def analytic(self, sigma: Any) -> bool:
        return not sigma.imag.contains(0) or sigma.real > 0

    def room(self, sigma: complex) -> float:
        return abs(sigma) if sigma.real > 0 else abs(sigma.imag)

    def growth(self, sigma: Any) -> Any:
        if sigma.imag.contains(0) and not sigma.real > 0:
            raise ConvergenceError("the continuous spectrum")
        return abs(self.D(sigma)).upper().log()


def root_and_two(sigma: Any) -> Any:
    """Zeros 0.3 and 0.3 ± 0.4i, and a branch point at 0."""
    return sigma.sqrt() * (sigma - arb("0.3")) * ((sigma - arb("0.3")) ** 2 + arb("0.16"))


def turned(sigma: Any) -> Any:
    """A zero at 0.5 + 0.2i."""
    return (sigma * acb(0, 1)).exp() * (sigma - acb(0.5, "0.2")) / (sigma + 1)


HALF, BOX = st.HalfAnnulus(0.0, 0.1, 0.45), st.Rectangle(0.05 - 0.5j, 0.9 + 0.5j)


@pytest.mark.parametrize(
    ("D", "region", "count"),
    [
        (KnownDiscriminant(root_and_two), HALF, 1),
        (KnownDiscriminant(root_and_two), BOX, 3),
        (KnownDiscriminant(root_and_two, real=False), BOX, 3),
        (KnownDiscriminant(root_and_two), st.Disc(0.3, 0.2), 1),
        (KnownDiscriminant(root_and_two), st.Disc(0.6, 0.58), 3),
        (KnownDiscriminant(root_and_two), st.Disc(0.3 + 0.3j, 0.25), 1),
        (KnownDiscriminant(turned, real=False), HALF, 0),
        (KnownDiscriminant(turned, real=False), st.HalfAnnulus(0.1j, 0.2, 1.0), 1),
    ],
)
def test_zeros_known_exactly_are_counted(D: KnownDiscriminant, region: Any, count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pieces_proof, "factors", lambda problem: (D,))
    proof = by_pieces(STRING, region, 10, None, 1)
    assert proof.count == count and proof.margin > 1.0
    assert "E13" in proof.lemmas


def with_a_pole(sigma: Any) -> Any:
    """A zero at 0.3 and a pole at 0.25 + 0.05i, beside each other: the phase along a contour about both does not grow."""
    return (sigma - arb("0.3")) / (sigma - acb("0.25", "0.05"))


@dataclass(frozen=True)
class MeromorphicDiscriminant(KnownDiscriminant):
    """D with a pole."""

    def analytic(self, sigma: Any) -> bool:
        return not acb(sigma).contains(acb(0.25, 0.05))

    def growth(self, sigma: Any) -> Any:
        return abs(self.D(sigma)).upper().log()


@pytest.mark.parametrize("region", [HALF, BOX, st.Disc(0.3, 0.2)])
def test_a_region_in_which_d_is_not_analytic_is_refused(region: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a look at the inside no eigenvalue would be proved to lie there, though 0.3 does."""
    D = MeromorphicDiscriminant(with_a_pole, real=False)
    monkeypatch.setattr(pieces_proof, "factors", lambda problem: (D,))
    with pytest.raises(ConvergenceError, match=r"not seen to be analytic inside the region at 0\.2"):
        by_pieces(STRING, region, 10, None, 1)
    monkeypatch.setattr(pieces_proof, "require_analytic", lambda analytic, region: None)
    assert by_pieces(STRING, region, 24, None, 1).count == 0


def test_a_disc_too_large_for_one_series_is_followed_along_its_circle(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (pieces_proof, prove):
        monkeypatch.setattr(module, "factors", lambda problem: (KnownDiscriminant(root_and_two),))
    found = prove.prove_disc(STRING, 0.6, 0.58)
    assert found.statement == "exactly 3 eigenvalues lie in |σ − (0.6 + 0.0i)| < 0.58"
    assert "E13" in found.lemmas
    near = prove.prove_disc(STRING, 0.3, 1e-3)
    assert near.count == 1 and "E13" not in near.lemmas


def test_points_are_added_where_the_bound_came_to_more_than_was_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pieces_proof, "factors", lambda problem: (KnownDiscriminant(root_and_two),))
    monkeypatch.setattr(pieces_proof, "SQUARE_ROOM", -6.0)
    assert by_pieces(STRING, HALF, 10, None, 1).count == 1


def test_spare_bits_are_added_where_a_zero_is_near(monkeypatch: pytest.MonkeyPatch) -> None:
    """0.3 lies 2e-4 beside an arc: pieces that do not tell with few spare bits are cut and asked again with more, the others are not."""
    monkeypatch.setattr(pieces_proof, "factors", lambda problem: (KnownDiscriminant(root_and_two),))
    asked = [by_pieces(STRING, st.HalfAnnulus(0.0, 0.1, outer), most, None, 1) for outer, most in ((0.3002, 24), (0.2998, 24), (0.2, 3))]
    assert [proof.count for proof in asked] == [1, 0, 0]
    assert asked[0].evaluations > asked[2].evaluations
    with pytest.raises(ConvergenceError, match="on the boundary or too near to it, from"):
        by_pieces(STRING, st.HalfAnnulus(0.0, 0.1, 0.3002), 3, None, 1)


def test_zeros_of_all_factors_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pieces_proof, "factors", lambda problem: (KnownDiscriminant(root_and_two), KnownDiscriminant(turned, real=False)))
    assert by_pieces(STRING, BOX, 10, None, 1).counts == (3, 1)


@pytest.mark.parametrize("region", [st.HalfAnnulus(0.0, 0.1, 0.3), st.Rectangle(0.3 - 0.1j, 0.9 + 0.2j)])
def test_a_boundary_through_a_zero_is_refused(region: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pieces_proof, "factors", lambda problem: (KnownDiscriminant(root_and_two),))
    with pytest.raises(ConvergenceError, match="an eigenvalue"):
        by_pieces(STRING, region, 10, None, 1)


def test_a_region_that_holds_the_continuous_spectrum_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pieces_proof, "factors", lambda problem: (KnownDiscriminant(root_and_two),))
    region = st.Rectangle(-0.1 - 0.5j, 0.9 + 0.5j)
    with pytest.raises(ConvergenceError, match="inside the region at"):
        by_pieces(STRING, region, 10, None, 1)
    monkeypatch.setattr(pieces_proof, "require_analytic", lambda analytic, region: None)
    with pytest.raises(ConvergenceError, match="the continuous spectrum meets the boundary of the region, or is too near to it, from"):
        by_pieces(STRING, region, 10, None, 1)


@pytest.mark.slow
def test_processes_find_what_one_does_and_it_is_told_in_words() -> None:
    told: list[tuple[int, int]] = []
    region = st.HalfAnnulus(0.0, 20.0, 60.0)
    alone, shared = (prove_region(STRING, region, lambda i, n: told.append((i, n)), 10, workers) for workers in (1, 2))
    assert (alone.count, alone.margin, alone.evaluations) == (shared.count, shared.margin, shared.evaluations)
    assert all(0 < done <= of for done, of in told)  # round by round: a piece that gives no answer is cut
    assert told[-1][0] == told[-1][1]
    assert alone.statement == "exactly one eigenvalue lies in the half-annulus 20.0 < |σ − (0.0 + 0.0i)| < 60.0, Re σ > 0.0"
