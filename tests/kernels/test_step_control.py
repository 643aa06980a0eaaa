"""The estimate of local errors and the step that they allow."""

from __future__ import annotations

import numpy as np
import pytest

from shootstab.analyses.error_budget import HALVING
from shootstab.discriminants.mesh import redistribute
from shootstab.kernels.step_control import MARGIN, factor, local_error, step_factor
from shootstab.kernels.tableau import ORDER


def test_the_step_that_the_factor_gives_has_the_error_of_the_margin() -> None:
    """An error c h^ORDER of 30 tolerances: at h · factor it is MARGIN^ORDER tolerances; compiled and uncompiled."""
    for kernel in (step_factor, factor):
        assert 30.0 * kernel(30.0) ** ORDER == pytest.approx(MARGIN**ORDER, rel=1e-12)


def test_the_estimate_is_that_of_scipys_DOP853() -> None:
    """|h| e5²/√((e5² + 0.01 e3²) n) over n components, here the largest of one."""
    rng = np.random.default_rng(2)
    for e5, e3 in rng.random((20, 2)):
        assert local_error(e5**2, e3**2) == pytest.approx(e5**2 / np.sqrt(e5**2 + 0.01 * e3**2), rel=1e-14)
    assert local_error(0.0, 0.0) == 0.0
    assert np.isnan(local_error(np.nan, 1.0))


def test_a_redistributed_mesh_of_equal_errors_meets_the_tolerance() -> None:
    """16 steps that err by 256 tolerances: steps half as long err by one, and by MARGIN^ORDER as the margin has it."""
    nodes = redistribute(np.linspace(0, 1, 17).astype(complex), np.full(16, 256.0), 1.0)
    assert len(nodes) - 1 == np.ceil(16 * 2 / MARGIN)


def test_what_halving_the_steps_is_counted_to_gain_follows_from_the_order() -> None:
    assert HALVING == 2 ** (ORDER // 2) - 1
