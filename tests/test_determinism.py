"""The same question has the same answer, bit for bit, whatever the number of workers or threads and the order of the claims; and on another
processor, played by this one without its vector instructions and fused products, an answer within both error bars.
"""

from __future__ import annotations

import itertools
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import layer
import pytest

import shootstab as st

ROOT = Path(__file__).parent.parent
AXES = {"kx": [0.0, 3.0], "far_temperature": [50.0, 55.0, 60.0]}
CLAIMS = [layer.exact(60.0, 0.0), layer.exact(60.0, 0.0, 2) * (1 + 1e-4), layer.exact(60.0, 0.0, 3) * (1 + 1e-9), 30.0 + 2.0j]


def test_a_sweep_by_any_number_of_workers() -> None:
    swept = [st.sweep(layer.layer(), AXES, workers=n) for n in (1, 3)]
    assert swept[0].outcomes == swept[1].outcomes
    for (kx, a), outcome in swept[0].rows():
        assert abs(outcome.sigma - layer.exact(a, kx)) <= outcome.error  # type: ignore[operator]


def test_claims_in_any_order() -> None:
    """A verdict belongs to its claim: what was asked before it moves no bit of it."""
    problem = layer.layer()
    said: list[dict[complex, Any]] = []
    for order in list(itertools.permutations(CLAIMS))[::5]:
        report = st.verify(problem, list(order), missing="none")
        said.append({v.claimed: (v.verdict, v.sigma, v.error, v.digits_agreed, v.why) for v in report.verdicts})
    assert all(one == said[0] for one in said)
    assert [said[0][complex(c)][0] for c in CLAIMS] == ["confirmed", "inaccurate", "confirmed", "spurious"]


def test_claims_split_and_one_at_a_time() -> None:
    """Whoever asks in parts is told the same of each claim, and of the same mode to its bound."""

    def told(*lists: list[complex]) -> list[Any]:
        problem = layer.layer()
        return [v for claims in lists for v in st.verify(problem, claims, missing="none").verdicts]

    together = told(CLAIMS)
    for parts in ([CLAIMS[:2], CLAIMS[2:]], [[claim] for claim in CLAIMS]):
        apart = told(*parts)
        assert [(v.claimed, v.verdict) for v in apart] == [(v.claimed, v.verdict) for v in together]
        for one, other in zip(together, apart, strict=True):
            assert (one.sigma is None) == (other.sigma is None)
            assert one.sigma is None or abs(one.sigma - other.sigma) <= one.error + other.error


@pytest.mark.parametrize("words", [["spectrum", "poiseuille", "-M", "90"], ["refine", "high", "--guess", "0.004"]])
def test_any_number_of_threads(words: list[str]) -> None:
    answers = []
    for threads in ("1", "3"):
        several = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), threads)
        command = [sys.executable, "-m", "shootstab", *words, "--json", "-"]
        done = subprocess.run(command, cwd=ROOT, env={**os.environ, **several}, capture_output=True, text=True, check=True)
        answers.append({key: value for key, value in json.loads(done.stdout).items() if key != "seconds"})
    assert answers[0] == answers[1]


def test_another_processor_answers_within_the_bars(tmp_path: Path) -> None:
    """The kernels are compiled for a processor of 2003, BLAS and NumPy take its code: last digits differ."""
    other = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": "", "NUMBA_CACHE_DIR": str(tmp_path), "OPENBLAS_CORETYPE": "Prescott"}
    other |= {"NPY_DISABLE_CPU_FEATURES": "AVX2,FMA3,AVX512F"}
    command = [sys.executable, "-m", "shootstab", "refine", "poiseuille", "--guess", "0.0037,-0.2375", "--json", "-"]
    done = subprocess.run(command, cwd=ROOT, env={**os.environ, **other}, capture_output=True, text=True, check=True)
    there = json.loads(done.stdout)
    here = st.refine(st.scene("poiseuille").problem, 0.0037 - 0.2375j)
    assert abs(complex(float(there["sigma"]["re"]), float(there["sigma"]["im"])) - here.sigma) <= there["error"] + here.error
    assert any(path.suffix == ".nbc" for path in tmp_path.rglob("*"))  # compiled anew, and not what this processor's cache holds
