"""The random chutes: what is compiled is compiled before a question has its time."""

from __future__ import annotations

import gc

import pytest
import random_chutes
from numba.core.dispatcher import Dispatcher

import shootstab as st


def compiled() -> dict[str, int]:
    """The number of compiled forms of each kernel."""
    kernels = [found for found in gc.get_objects() if isinstance(found, Dispatcher)]
    return {f"{kernel.py_func.__module__}.{kernel.py_func.__name__}": len(kernel.signatures) for kernel in kernels}


@pytest.mark.slow  # warm compiles every kernel
def test_nothing_is_compiled_while_a_question_is_asked() -> None:
    """Real and complex waves, by every method, in doubles and in many digits, on another flow than the one that warm takes."""
    random_chutes.warm()
    before = compiled()
    assert len(before) > 10
    for kx, ky, guess in ((0.0, 0.02, -5.66), (0.011, 0.0, 0.0025 - 0.0296j), (0.003, 0.004, 0.0032 - 0.0069j)):
        problem = st.chute.problem(st.chute.steady(far_temperature=0.5, e=0.8, e_w=0.8, r=0.6, tan_theta=0.3), kx, ky)
        for make in random_chutes.METHODS:
            assert st.refine(problem, guess=guess, rtol=1e-8, method=make(rtol=1e-9)).converged
        assert random_chutes.many_digits(problem, guess).converged
    assert compiled() == before
