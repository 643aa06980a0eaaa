"""Every refusal of the room of roots that no other test reaches."""

from __future__ import annotations

import pytest

flint = pytest.importorskip("flint")

from flint import acb, acb_poly, arb  # noqa: E402

from shootstab.core.errors import ConvergenceError  # noqa: E402
from shootstab.roots.pellet import PolynomialModel  # noqa: E402


def test_a_contour_on_which_enclosures_are_too_wide_to_tell_the_turn_between_two_is_refused() -> None:
    """D = 1 + ε, |ε| ≤ 1/4: no side comes near a zero, but ratios of D may be negative. With 1/8 many wide ones do not add up."""
    corners = [(2 * acb(0, 1) * arb.pi() * k / 96).exp() / 2 for k in range(96)]
    narrow = PolynomialModel(acb(0), arb(1), acb_poly([1]), arb(0.001))
    assert narrow.count(corners)[0] == 0
    assert PolynomialModel(acb(0), arb(1), acb_poly([1]), arb(0.125)).count(corners)[0] == 0
    wide = PolynomialModel(acb(0), arb(1), acb_poly([1]), arb(0.25))
    with pytest.raises(ConvergenceError, match=r"the enclosures of D on the contour do not determine how its phase grows"):
        wide.count(corners)
