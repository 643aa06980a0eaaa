"""How time grows: with the steps of a mesh, with claims, with points of a sweep, with digits. The picture is validation/figures/growth.png.

Each line is time against a number, both logarithmic, with the slope of the straight line through it: 1 is proportional. Times are seconds
of a processor on one thread.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np
from bench import BenchLine, best, duration, once, show
from scenes import GUESS, problem

import shootstab as st
from shootstab.analyses import reference

PICTURE = Path(__file__).with_name("figures") / "growth.png"
STEPS_BY = [10.0**-k for k in range(5, 13)]  # chosen: local errors: each makes a mesh of its own
CLAIMS, POINTS, DIGITS = (5, 10, 20, 40), (25, 50, 100, 200), (20, 30, 40, 50)  # chosen
STEEPEST = {"steps": 1.1, "claims": 1.1, "points": 1.1}  # slopes that are asked for; digits are shown only

Growth = tuple[list[float], list[float]]


def steps() -> Growth:
    """One D(σ) with its derivative against the steps of its mesh, `low`."""
    p, guess = problem("low"), GUESS["low"]
    meshed = [st.Frame(rtol=rtol).on(p).at(guess) for rtol in STEPS_BY]
    turns = iter(range(1, 10**9))
    return [D.steps for D in meshed], [best(lambda D=D: D.with_derivative(guess * (1 + 1e-9 * next(turns)))) for D in meshed]


def against(numbers: Sequence[int], run: Callable[[int], object]) -> Growth:
    """One run for each number, after one that does not count."""
    run(numbers[0])
    return list(map(float, numbers)), [once(lambda n=n: run(n)) for n in numbers]


def claims() -> Growth:
    """Verdicts against the number of claims, `high`: every so many-th of the bundled reference, so that they lie alike."""
    flow, given = problem("high").flow, reference.claims(problem("high"), 6).tolist()[: max(CLAIMS)]
    return against(CLAIMS, lambda n: st.verify(st.chute.problem(flow, 0.0, 0.01), given[:: len(given) // n], missing="none"))


def points() -> Growth:
    """A sweep against its points, along k_y."""
    high = problem("high")
    return against(POINTS, lambda n: st.sweep(high, {"kx": 5e-4, "ky": np.linspace(0.001, 0.021, n)}, digits=8, workers=1))


def digits() -> Growth:
    """One mode against the digits asked for, `high`."""
    return against(DIGITS, lambda n: st.refine(problem("high"), GUESS["high"], digits=n))


def slope(growth: Growth) -> float:
    """The exponent of the power of the number with which time goes, by least squares."""
    return float(np.polyfit(*np.log(growth), 1)[0])


def lines(measured: dict[str, Growth]) -> Iterator[BenchLine]:
    """A line for each of the four, with its slope."""
    for name, growth in measured.items():
        said = ", ".join(f"{duration(t)} ({n:.0f})" for n, t in zip(*growth, strict=True))
        most = STEEPEST.get(name)
        asked = "" if most is None else f"slope at most {most:g}"
        yield BenchLine(
            f"time against {name}", f"slope {slope(growth):.2f}: {said}", asked, None if most is None else slope(growth) <= most
        )


def drawn(measured: dict[str, Growth]) -> None:
    """All four in one picture, each against its number over the first one."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6, 4), layout="constrained")
    axes = figure.subplots()
    for name, (numbers, times) in measured.items():
        axes.loglog(
            [n / numbers[0] for n in numbers], [t / times[0] for t in times], "o-", label=f"{name}: slope {slope((numbers, times)):.2f}"
        )
    axes.set(xlabel="number, over the first", ylabel="time, over the first")
    axes.legend()
    figure.savefig(PICTURE, dpi=150)


def main() -> int:
    """Measure, show, draw."""
    measured = {"steps": steps(), "claims": claims(), "points": points(), "digits": digits()}
    drawn(measured)
    return 0 if show("How time grows", "python validation/bench_growth.py", lines(measured)) else 1


if __name__ == "__main__":
    sys.exit(main())
