"""Recorded formulas: what a program computes is what the formula computes, each operation once, in real numbers where that is possible."""

from __future__ import annotations

import math

import numpy as np
import pytest

from shootstab.core.series import Series
from shootstab.core.straight_line import PRODUCT, Recorder, exp, program
from shootstab.kernels.recorded_programs import evaluate, evaluate_points


def formula(x, y, c, e, grow):
    """Every operation, with numbers on either side, powers with exponents of all kinds, and a derivative by series."""
    pair = Series((x, 1 + 0 * x))
    curved = (2 - pair) ** (-5 * c / 2) / (1 + y * pair) + 3 * pair**0.5
    inner = (x + y) * (x + y) - x / y + 1 / x - (-y) / 3 + x**3 - y**1 + x**2 / (x * y)
    return [curved[0], curved[1], inner * e, grow(x / 4) * c - x + x, 0 * x, 1 + 0 * y, x - 2 * y - x, (3 * x) ** e, c * e, (x / x) * y]


@pytest.mark.parametrize("points", [1, 63, 64, 65, 200])
@pytest.mark.parametrize("kind", [float, complex])
def test_program_computes_what_the_formula_does(points, kind):
    rng = np.random.default_rng(1)
    inputs = rng.uniform(0.3, 1.6, size=(2, points)).astype(kind)
    if kind is complex:
        inputs += 0.2j * rng.normal(size=inputs.shape)
    parameters = np.array([0.62, 1.7], dtype=kind)
    recorder = Recorder()
    recorded = program(recorder, formula(*recorder.inputs(2), *recorder.parameters(2), exp))
    got = evaluate(recorded, inputs, parameters)
    assert recorded.real and got.dtype == inputs.dtype
    for row, exact in zip(got, formula(*inputs, *parameters, np.exp), strict=True):
        assert np.all(np.abs(row - exact) <= 8e-15 * (1 + np.abs(exact)))


def test_compiled_and_not():
    recorder = Recorder()
    p = program(recorder, formula(*recorder.inputs(2), *recorder.parameters(2), exp))
    inputs, parameters = np.array([[0.4, 0.9], [1.1, 0.7]]), np.array([0.62, 1.7])
    out = np.empty((len(p.result), 2))
    evaluate_points.py_func(p.lists(real=True), inputs, parameters, out)
    assert np.allclose(out, evaluate(p, inputs, parameters), rtol=1e-14, atol=0.0)


def test_powers_of_i_stay_out_of_real_programs():
    """(ik)² x + k² x = 0, and i(ik x + ik y) is real; 1 + ik x is not."""
    recorder = Recorder()
    x, y, k = *recorder.inputs(2), *recorder.parameters(1)
    ik = 1j * k
    assert (ik * ik * x + k * k * x).coefficient == 0
    assert program(recorder, [1j * (ik * x + ik * y), (ik * x) * (ik * y)]).real
    assert not program(recorder, [1 + ik * x]).real
    value = evaluate(program(recorder, [1 + ik * x]), np.array([[2.0 + 0j], [0.0]]), np.array([3.0 + 0j]))
    assert value[0, 0] == 1 + 6j


def test_each_operation_is_recorded_once_and_the_unused_left_out():
    recorder = Recorder()
    x, y = recorder.inputs(2)
    a, b = recorder.parameters(2)
    unused = x / y
    recorded = program(recorder, [x * y + a * b, y * x - a * b])
    assert np.count_nonzero(recorded.operation == PRODUCT) == 2
    assert recorded.shared == 4  # 1, a, b, ab
    assert len(program(recorder, [unused]).operation) == 4


def test_formulas_do_not_branch_on_recorded_numbers():
    recorder = Recorder()
    (x,) = recorder.inputs(1)
    with pytest.raises(TypeError, match="has no value that a formula could branch on"):
        math.sqrt(1) if x else 0
