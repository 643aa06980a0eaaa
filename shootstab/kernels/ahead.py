"""Kernels compiled in a second process while the first one compiles others: which are needed first differs, and the cache is one.

Numba looks into its cache before it compiles a kernel, so that whoever is first saves the other the work. What is compiled here is what the
first answer about a flow needs last, in the order in which it is needed: the transports of frames, what moves a zero, the continuation of a
flow off the real axis; at the end what moves a zero of a real system, which few answers ask for.
"""

from __future__ import annotations

import atexit
import os
import subprocess
import sys
from typing import Any

import numba
import numpy as np

from shootstab.core.straight_line import Recorder, program
from shootstab.kernels.frame_gradient import back_substitute, ends_of_steps, entries_at_random
from shootstab.kernels.frame_transport import transport
from shootstab.kernels.recorded_programs import evaluate
from shootstab.kernels.reduced_system import ReducedSystem
from shootstab.kernels.tableau import STAGES
from shootstab.kernels.taylor_pieces import along_path

Scalar = type[np.float64] | type[np.complex128]

helpers: list[subprocess.Popen[bytes]] = []  # the second process, once it was started


def begin() -> None:
    """Start the second process, once, where there is a second core and processes are allowed; it is ended where this one ends before it."""
    if helpers or (os.cpu_count() or 1) < 2:
        return
    words = [sys.executable, "-m", "shootstab.kernels.ahead"]
    try:
        helpers.append(subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))
    except (OSError, ValueError):  # no more processes, no interpreter by that name: everything is compiled here
        return
    atexit.register(end)


def end() -> None:
    """Stop the second process: kernels that it has not finished are compiled when they are needed."""
    for process in helpers:
        process.kill()
        process.wait()


def compile_all() -> None:
    """Compile the kernels by calling them with little."""
    _transport(np.float64)
    _transport(np.complex128)
    _gradient(np.complex128)
    _path()
    _changes(np.complex128)
    _gradient(np.float64)
    _changes(np.float64)


def _one_step(kind: Scalar) -> tuple[list[Any], Any, Any]:
    """ψ₁′ = ψ₂, ψ₂′ = ψ₁, along one column: the lists of the reduced system, no V, and no γ."""
    lists = [np.array(a, dtype=np.uint64) for a in ([0, 1, 2], [1, 0], [], [], [], [])]
    return lists, np.zeros((2, STAGES, 0, 0), kind), np.zeros((2, STAGES, 2, 0, 0), kind)


def _transport(kind: Scalar) -> None:
    lists, V, G = _one_step(kind)
    Y = np.eye(2, 1, dtype=kind)
    transport(ReducedSystem(*lists, np.ones((2, STAGES, 2), kind), V, G), kind(0.0), Y, Y.copy(), True, np.empty(2))  # type: ignore[call-arg]


def _gradient(kind: Scalar) -> None:
    """Back along the mesh."""
    lists, V, gG = _one_step(kind)
    one, two, table = np.ones(2, kind), np.ones((2, 2), kind), np.ones((2, STAGES, 2), kind)
    of_step = *lists, table, V, V.copy(), kind(0.0)
    x, K, entries = np.ones((STAGES + 2, 2), kind), np.ones((STAGES, 2), kind), np.ones((STAGES, 2), kind)
    Q = np.stack((np.eye(2, 1, dtype=kind),) * 3)
    work = Q, one[:1], one.copy(), x, K, entries, two[:1, :1].copy(), np.ones((2, STAGES, 2), kind)
    back_substitute(*of_step, *work, *np.ones((2, 3, 2), kind), table, V, gG, np.zeros(2))  # type: ignore[call-arg]


def _changes(kind: Scalar) -> None:
    """What a step changes, and what numbers changed at random do."""
    lists, V, _ = _one_step(kind)
    two, table = np.ones((2, 2), kind), np.ones((2, STAGES, 2), kind)
    work = np.ones((STAGES + 2, 2), kind), np.ones((STAGES, 2), kind), np.ones((STAGES, 2), kind)
    ends_of_steps(*lists, table, V, V.copy(), kind(0.0), np.zeros(2, np.int64), two, two.copy(), *work)  # type: ignore[call-arg]
    entries_at_random(table, table, np.ones(2), np.ones(2), two)


def _path() -> None:
    """A flow at complex points, and what is computed from it there."""
    recorder = Recorder()
    (at,) = recorder.inputs(1)
    (factor,) = recorder.parameters(1)
    formula = program(recorder, [factor * at])
    unit, points = np.ones(1, np.complex128), np.ones(1)
    path = (formula.lists(False), unit, points, 1.0, 2, 1j, unit, unit, np.ones(1, np.bool_), np.ones((1, 1), np.complex128))
    along_path.compile(tuple(map(numba.typeof, path)))
    evaluate(formula, np.ones((1, 1), np.complex128), unit)


if __name__ == "__main__":
    compile_all()
