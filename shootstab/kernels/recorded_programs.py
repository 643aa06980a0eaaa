"""Straight-line programs carried out: on arrays over many points, and on truncated power series (see core/straight_line.py)."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from shootstab.core.straight_line import EXP, INPUT, PARAMETER, POWER, PRODUCT, QUOTIENT, SUM, UNIT, Program

WIDTH = 64  # chosen: points at a time; the nodes of a program with some hundred operations then stay in the second cache


def evaluate(formula: Program, inputs: NDArray[np.inexact], parameters: NDArray[np.inexact]) -> NDArray[np.inexact]:
    """The results (s, p) at p points: inputs (i, p) and parameters (j,), all real or all complex."""
    out = np.empty((len(formula.result), inputs.shape[1]), dtype=inputs.dtype)
    evaluate_points(formula.lists(inputs.dtype.kind == "f"), inputs, parameters, out)
    return out


@njit(cache=True, error_model="numpy")
def evaluate_points(lists, inputs, parameters, out):  # type: ignore[no-untyped-def]
    operation, x, y, a, b, shared, result = lists
    values = np.empty((len(operation), WIDTH), dtype=out.dtype)
    points = inputs.shape[1]
    for start in range(0, points, WIDTH):
        width = min(WIDTH, points - start)
        for k in range(shared if start > 0 else 0, len(operation)):
            # nodes that are the same at all points are computed once for a whole block
            _at_points(operation[k], x[k], y[k], a[k], b[k], inputs, parameters, start, width if k >= shared else WIDTH, values, k)
        for s in range(len(result)):
            for p in range(width):
                out[s, start + p] = values[result[s], p]


@njit(cache=True, error_model="numpy", inline="always")
def _at_points(operation, x, y, a, b, inputs, parameters, start, width, values, k):  # type: ignore[no-untyped-def]
    if operation == SUM:
        for p in range(width):
            values[k, p] = a * values[x, p] + b * values[y, p]
    elif operation == PRODUCT:
        for p in range(width):
            values[k, p] = values[x, p] * values[y, p]
    elif operation == QUOTIENT:
        for p in range(width):
            values[k, p] = values[x, p] / values[y, p]
    elif operation == POWER:
        if values[y, 0] == 0.5:
            for p in range(width):
                values[k, p] = np.sqrt(values[x, p])
        else:
            for p in range(width):
                values[k, p] = values[x, p] ** values[y, p]
    elif operation == EXP:
        for p in range(width):
            values[k, p] = np.exp(values[x, p])
    elif operation == INPUT:
        for p in range(width):
            values[k, p] = inputs[x, start + p]
    elif operation == PARAMETER:
        for p in range(width):
            values[k, p] = parameters[x]
    elif operation == UNIT:
        for p in range(width):
            values[k, p] = 1.0


def series(formula: Program, inputs: NDArray[np.inexact], parameters: NDArray[np.inexact]) -> NDArray[np.complex128]:
    """The results (s, N) as power series, from inputs (i, N) that are power series and parameters (j,) that are numbers."""
    out = np.empty((len(formula.result), inputs.shape[1]), dtype=np.complex128)
    series_terms_of(formula.lists(real=False), inputs.astype(np.complex128), parameters.astype(np.complex128), out)
    return out


@njit(cache=True, error_model="numpy")
def series_terms_of(program, inputs, parameters, out):  # type: ignore[no-untyped-def]
    values = np.empty((len(program[0]), inputs.shape[1]), dtype=out.dtype)
    for m in range(inputs.shape[1]):
        carry_out(program, parameters, inputs, m, values)
        for s in range(len(out)):
            out[s, m] = values[program[6][s], m]


@njit(cache=True, error_model="numpy", inline="always")
def carry_out(program, parameters, inputs, m, values):  # type: ignore[no-untyped-def]
    """values[:, m], the coefficients of order m of all nodes, from those of lower order and inputs (i, N) up to order m."""
    operation, left, right, a, b, shared, _ = program
    if m > 0:
        for k in range(shared):
            values[k, m] = 0.0
    for k in range(0 if m == 0 else shared, len(operation)):
        op, i, j = operation[k], left[k], right[k]
        if op == SUM:
            values[k, m] = a[k] * values[i, m] + b[k] * values[j, m]
        elif op == PRODUCT:
            if i < shared:
                values[k, m] = values[i, 0] * values[j, m]
            elif j < shared:
                values[k, m] = values[j, 0] * values[i, m]
            else:
                total = values[i, 0] * values[j, m]
                for q in range(1, m + 1):
                    total += values[i, q] * values[j, m - q]
                values[k, m] = total
        elif op == QUOTIENT:
            total = values[i, m]
            if j >= shared:
                for q in range(1, m + 1):
                    total -= values[j, q] * values[k, m - q]
            values[k, m] = total / values[j, 0]
        elif op == POWER:
            exponent = values[j, 0]
            if m == 0:
                values[k, 0] = np.sqrt(values[i, 0]) if exponent == 0.5 else values[i, 0] ** exponent
            else:
                # c = x^r from x c′ = r x′ c
                total = 0 * exponent
                for q in range(1, m + 1):
                    total += (exponent * q - (m - q)) * (values[i, q] * values[k, m - q])
                values[k, m] = total / (m * values[i, 0])
        elif op == EXP:
            if m == 0:
                values[k, 0] = np.exp(values[i, 0])
            else:
                total = 0 * values[i, 0]
                for q in range(1, m + 1):
                    total += q * values[i, q] * values[k, m - q]
                values[k, m] = total / m
        elif op == INPUT:
            values[k, m] = inputs[i, m]
        elif op == PARAMETER:
            values[k, m] = parameters[i]
        elif op == UNIT:
            values[k, m] = 1.0
