"""Kato's transport of a decaying space whose frame is known: y″ = σ y, where X = (σ/σ0)^(−1/4) (1, −√σ)."""

import cmath

import numpy as np
import pytest

from shootstab.core.errors import Undecidable
from shootstab.problems.kato_frame import KatoFrame
from shootstab.problems.kato_transport import slopes, transported
from shootstab.problems.protocol import Pencil
from shootstab.problems.splitting import AsymptoticPencil

EXACT = 1e-9  # chosen: what the factor of a frame is exact to


def limit() -> AsymptoticPencil:
    """ψ = (y, y′), C the identity, towards +∞."""
    zero = np.zeros((2, 2), dtype=np.complex128)
    fixed, moving = zero.copy(), zero.copy()
    fixed[0, 1] = moving[1, 0] = 1.0
    return AsymptoticPencil(Pencil(np.eye(2, dtype=np.complex128), zero, fixed, moving), 1)


def test_slope_is_that_of_the_exact_frame() -> None:
    """f = tr[(ℓR)⁻¹ ℓ P′ R] with R = (1, 0): ℓ = (1, −1/√σ)/2, and ln c of P R c = σ^(−1/4)(1, −√σ) is −∫f, with P R = (1, −√σ)/2."""
    sigmas = np.array([1.0, 2.0 + 1.0j, 0.3 - 2.0j])
    f, volumes = slopes(limit(), sigmas, np.array([[1.0], [0.0]], dtype=np.complex128))
    np.testing.assert_allclose(f, 0.25 / sigmas, rtol=1e-13)
    np.testing.assert_allclose(volumes, 0.5 * np.sqrt(1.0 + np.abs(sigmas)), rtol=1e-13)


@pytest.mark.parametrize("sigma", [4.0, 1e-9, 1e9, 3j, -1.0 + 1e-3j, -1.0 - 1e-3j, -1e-4 + 1e-7j, 0.5 - 2e3j])
def test_frame_is_the_exact_one_near_and_far(sigma: complex) -> None:
    """Thirty octaves from the reference, and beside the essential spectrum, which is the negative real axis."""
    kato = KatoFrame(limit(), 1, 1.0)
    first = kato.frame(1.0)[0][0, 0]
    frame, _, log_scale, _ = kato.frame(complex(sigma))
    found = frame[:, 0] * np.exp(log_scale) / first
    wanted = cmath.exp(-0.25 * cmath.log(sigma)) * np.array([1.0, -cmath.sqrt(sigma)])
    np.testing.assert_allclose(found, wanted, rtol=EXACT)


def test_frame_does_not_depend_on_what_was_asked_before() -> None:
    """A cell joined to a neighbour has the factor of one joined to the reference."""
    asked, fresh = KatoFrame(limit(), 1, 1.0), KatoFrame(limit(), 1, 1.0)
    for angle in np.linspace(0.0, 3.0, 20).tolist():
        asked.frame(0.01 * cmath.rect(1.0, angle))
    sigma = 0.01 * cmath.rect(1.0, 3.1)
    (one, _, log_one, _), (other, _, log_other, _) = asked.frame(sigma), fresh.frame(sigma)
    np.testing.assert_allclose(one * np.exp(log_one - log_other), other, rtol=EXACT)


def test_line_across_the_essential_spectrum_is_not_passable() -> None:
    """From one side of the negative real axis to the other; one that keeps to its side is."""
    begin = -1.0 + 0.1j
    R = limit().splitting(begin, 1).X
    assert transported(limit(), begin, -1.0 - 0.1j, R, 0.05) is None
    passed = transported(limit(), begin, -2.0 + 0.1j, R, 0.05)
    assert passed is not None and passed[0] == -2.0 + 0.1j


def test_line_ends_where_a_known_place_is_met() -> None:
    """At the end of the first panel that satisfies the condition, before its goal."""
    R = limit().splitting(1.0, 1).X
    passed = transported(limit(), 1.0, 100.0, R, 0.5, lambda place: abs(place) > 3.0)
    assert passed is not None and 3.0 < passed[0].real < 100.0


def test_no_path_leads_into_what_spectra_enclose() -> None:
    """Between the axis and i of rates ±√(σ² + 1) = 0 and an exchange of rates no line is passable on the cut itself."""
    with pytest.raises(Undecidable):
        KatoFrame(limit(), 1, 1.0).frame(-1.0)
