"""D by frames and the difference of a Möbius map against D by compound matrices: the same number, in balls that share nothing."""

from __future__ import annotations

from typing import Any

import pytest

flint = pytest.importorskip("flint")

from flint import acb, arb, ctx  # noqa: E402

import shootstab as st  # noqa: E402
from shootstab.multiprecision import enclosure  # noqa: E402
from shootstab.multiprecision.arithmetic import exact  # noqa: E402
from shootstab.multiprecision.closed_form_enclosure import ClosedFormEnclosable  # noqa: E402
from shootstab.multiprecision.enclosable import ball  # noqa: E402
from shootstab.multiprecision.enclosure import Enclosure  # noqa: E402
from shootstab.multiprecision.frame_enclosure import FrameEnclosure  # noqa: E402
from shootstab.multiprecision.small_matrices import polynomial  # noqa: E402
from shootstab.multiprecision.tailed_pencil import TailedPencil  # noqa: E402
from shootstab.multiprecision.tailed_series import TailedSeries, variable  # noqa: E402

TERMS, STEPS = 40, 24


class ClosedPath:
    """A closed form in equal steps; see frame_enclosure.EnclosedPath."""

    def __init__(self, form: Any) -> None:
        self._form, self.size, self.decaying = form, form.size, form.decaying
        far, wall = form.exact_ends(number)
        h = acb(wall - far) / STEPS
        nothing = TailedSeries([acb(0)], TERMS)
        self.steps = []
        for i in range(STEPS):
            z = variable(far + h * i, h, TERMS)
            parts = [{at: nothing + y for at, y in part.items()} for part in form.exact_pencil(z, number)]
            half = len(parts) // 2
            D = [{at: y * h for at, y in part.items()} for part in parts[half:]]
            self.steps.append(TailedPencil(self.size, parts[:half], D, TERMS))

    def far(self, sigma: Any) -> Any:
        return [[acb(x) for x in row] for row in self._form.exact_far(sigma, number)]

    def wall(self, sigma: Any) -> Any:
        return polynomial([[[acb(x) for x in row] for row in W] for W in self._form.exact_wall(number)], sigma)


def number(x: float) -> Any:
    return acb(ball(exact(x)))


def test_frames_and_compound_matrices_enclose_the_same_number() -> None:
    form = st.gallery.PlanePoiseuille(200.0, 1.1, half=True)
    with ctx.workprec(200):
        frames, compound = FrameEnclosure(ClosedPath(form), False), Enclosure(ClosedFormEnclosable(form), 200)
        for sigma in (acb(-0.1, -0.4), acb(0.3, 0.2), acb("-0.05", "-0.31")):
            a, b = frames(sigma), compound(sigma)
            assert a.overlaps(b)
            assert a.rel_accuracy_bits() > 60 and b.rel_accuracy_bits() > 60
        thick = acb(arb(-0.1, 0.01), arb(-0.4, 0.01))
        bound = frames.growth(thick)
        for sigma in (acb(-0.1, -0.4), acb(-0.091, -0.391), acb(-0.109, -0.4)):
            assert abs(frames(sigma)).log() < bound


class Growth:
    """y′ = (1 + b) y from 0 to 1, b known by the moduli of its coefficients alone, 1e−3 together; see EnclosableSystem."""

    lemmas: tuple[str, ...] = ()
    size = decaying = 1

    def ends(self) -> Any:
        return arb(0), arb(1)

    def pencil(self, z: Any) -> Any:
        return [{(0, 0): 1}], [{(0, 0): TailedSeries([acb(1)], z.terms, arb(0, 1e-3)) if isinstance(z, TailedSeries) else acb(1)}]

    def start(self, sigma: Any) -> Any:
        return [acb(1)]

    def wall(self, sigma: Any) -> Any:
        return [acb(1)]


def test_a_tail_whose_ball_holds_zero_is_no_zero(monkeypatch: pytest.MonkeyPatch) -> None:
    """A tail of the coefficients themselves, which no shorter step takes away, is let pass."""
    monkeypatch.setattr(enclosure, "SEEN_PART", 1.0)
    with ctx.workprec(100):
        compound = Enclosure(Growth(), 100)
        found, terms = compound(acb(0)), compound.terms
        assert found.contains((1 + arb("1e-3") / (terms + 1)).exp())
        assert found.rad() < 1e-2


def test_a_wide_frame_is_carried_by_its_contraction() -> None:
    """What is uncertain at the far end falls on the way to the wall as the decaying space is approached."""
    form = st.gallery.PlanePoiseuille(200.0, 1.1, half=True)
    with ctx.workprec(200):
        path = ClosedPath(form)
        exact_far = path.far
        path.far = lambda sigma: [[x + acb(arb(0, 1e-20), 0) for x in row] for row in exact_far(sigma)]  # type: ignore[method-assign]
        assert FrameEnclosure(path, False)(acb(0.3, 0.2)).rel_accuracy_bits() > 45


def test_fewer_bits_enclose_the_same_multiple_of_d() -> None:
    """Where a path begins may depend on the working precision: here its basis is scaled by the bits."""
    form = st.gallery.PlanePoiseuille(200.0, 1.1, half=True)
    with ctx.workprec(200):
        path, sigma = ClosedPath(form), acb(-0.1, -0.4)
        exact_far = path.far
        path.far = lambda sigma: [[x * ctx.prec for x in row] for row in exact_far(sigma)]  # type: ignore[method-assign]
        D = FrameEnclosure(path, False)
        rough = D.rougher(100)
        assert max(step.terms for step in rough.path.steps) < TERMS
        found = D(sigma)
    with ctx.workprec(100):
        fewer = rough(sigma)
    assert fewer.overlaps(found) and 20 < fewer.rel_accuracy_bits() < found.rel_accuracy_bits()
