"""The time of one D and its derivative in two states of the program, taken in turns: what a change of structure costs.

    python validation/kept_speed.py OTHER    # OTHER: the directory of another state, any version since 0.2.1

Each round asks either state, in a process of its own, for D and dD/dsigma of `high` and `low` by three methods on a mesh in memory, with
local errors of 1e-10. Printed are the least times of all rounds, of this state and the other, their ratio, and the steps of both: longer
meshes cost more without any formula being slower. One thread, processor time; nothing else should run beside it.
"""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
import time
from pathlib import Path

ROUNDS = 9  # chosen: processes of either state, in turns
REPEATS, CALLS = 9, 40  # chosen: the least of REPEATS means over CALLS evaluations counts
GRAINS = {"e": 0.8, "e_w": 0.8, "r": 0.6, "tan_theta": 0.3}
SCENES = {"high": ("high", 0.0, 0.01, 0.00397 + 0j), "low": ("low", 0.011, 0.0, 0.00727 - 0.0119j)}
NUDGE = 1e-7  # chosen: sigma moves by this part of itself from call to call, so that no value is remembered


def milliseconds() -> dict[str, tuple[float, int]]:
    """Time [ms] of D and dD/dsigma and steps of its mesh, by scene and method, in the state that this process has imported."""
    import shootstab as st

    answers = {}
    for scene, (branch, kx, ky, sigma) in SCENES.items():
        problem = st.chute.problem(st.chute.steady(mass_flux=3.0, branch=branch, **GRAINS), kx, ky)
        for method in ("Frame", "Compound", "Riccati"):
            D = getattr(st, method)(rtol=1e-10).on(problem)
            value = getattr(D, "with_derivative", None) or D.with_slope  # the name of 0.2.1
            value(sigma)
            means = []
            for repeat in range(REPEATS):
                start = time.process_time()
                for call in range(CALLS):
                    value(sigma * (1 + NUDGE * (1 + call + CALLS * repeat)))
                means.append(1e3 * (time.process_time() - start) / CALLS)
            steps = D.at(sigma).steps if hasattr(D, "at") else D.steps
            answers[f"{scene}, {method.lower()}"] = min(means), steps
    return answers


def asked(tree: Path) -> dict[str, tuple[float, int]]:
    """The times and steps of the state in a directory, by a process of its own."""
    once = {"PYTHONPATH": str(tree), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    answer = subprocess.run(
        [sys.executable, __file__, "--of-this-state"], env={**os.environ, **once}, cwd=tree, capture_output=True, text=True, check=True
    )
    return dict(json.loads(answer.stdout))


def main(arguments: list[str]) -> int:
    """The table; or the times of one state, for the process that makes it."""
    if arguments == ["--of-this-state"]:
        print(json.dumps(milliseconds()))
        return 0
    if len(arguments) != 1 or not Path(arguments[0], "shootstab").is_dir():
        print(__doc__, file=sys.stderr)
        return 2
    here, other = Path(__file__).parent.parent, Path(arguments[0]).resolve()
    least: dict[str, list[float]] = {}
    steps: dict[str, list[int]] = {}
    for _ in range(ROUNDS):
        for state, answers in enumerate((asked(here), asked(other))):
            for question, (time_taken, length) in answers.items():
                pair = least.setdefault(question, [math.inf, math.inf])
                pair[state] = min(pair[state], time_taken)
                steps.setdefault(question, [0, 0])[state] = length
    print(f"{'D and dD/dsigma':16} {'this':>9} {'other':>9} {'this/other':>11} {'steps':>6} {'other':>6} {'a step':>7}")
    for question, (this, that) in least.items():
        n, m = steps[question]
        print(f"{question:16} {this:6.3f} ms {that:6.3f} ms {this / that:11.2f} {n:6} {m:6} {this * m / (that * n):7.2f}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
