"""The gallery: digits and time of every solved problem, a problem of one's own among them.

`--table` prints the table of README.md; `--record` writes what DIGITS digits give into tests/models/gallery/many_digits.json, of the cases
named after it or of all.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from claims import Case, Claim, main

import shootstab as st
from shootstab.core.records import Mode
from shootstab.models.catalogue.published import PUBLISHED, Published

REPEATS = 5  # chosen
DIGITS = 20  # chosen: a double has 16
RECORD = Path(__file__).parent.parent / "tests" / "models" / "gallery" / "many_digits.json"
GUESS = -1j * (0.2375 + 0.0037j)  # chosen
SLOW = ("suction", "Malik")
POISEUILLE = "0.23752648882047010745", "0.0037396706229794099322"


def timed(problem: Any, guess: complex, rtol: float) -> tuple[Mode, float]:
    """One mode, and the shortest of several times with everything compiled and the problem made."""
    modes = [st.refine(problem, guess, rtol=rtol) for _ in range(2)]
    while modes[-1].seconds < 1.0 and len(modes) < REPEATS:
        modes.append(st.refine(problem, guess, rtol=rtol))
    return modes[-1], min(m.seconds for m in modes)


def rows(quick: bool) -> Iterator[tuple[Published, Mode, float]]:
    """Every problem that has a published eigenvalue."""
    for case in PUBLISHED:
        if not (quick and any(word in case.name for word in SLOW)):
            yield case, *timed(case.problem(), case.sigma * (1 + 1e-4), 1e-10)


def plain(y: float) -> tuple[Any, Any]:
    """Plane Poiseuille flow as somebody would write it."""
    D0, D1 = np.zeros((4, 4), dtype=np.complex128), np.zeros((4, 4), dtype=np.complex128)
    D0[0, 1] = D0[1, 2] = D0[2, 3] = 1.0
    U, R = 1 - y * y, 10000.0
    D0[3, 0], D0[3, 2] = -1 - 1j * R * (U - 2), 2 + 1j * R * U
    D1[3, 0], D1[3, 2] = -R, R
    return D0, D1


def twenty(mode: Mode) -> int:
    """How many of the 20 digits of c agree, and are held by the bound."""
    from mpmath import floor, log10, mpc, workdps

    with workdps(40):
        known = mpc(*POISEUILLE)
        off = abs(1j * mode.sigma - known) / abs(known)
        return int(min(20, floor(0.5 - log10(off)), mode.digits))


def own(compiled: bool) -> tuple[Mode, float]:
    """A problem of order 4 to 1e-10: the even modes, in half the channel."""
    from numba import njit

    rows = np.eye(4)
    walls = st.Wall(0.0, rows[[1, 3]]), st.Wall(1.0, rows[:2])
    return timed(st.problem(4, njit(plain) if compiled else plain, *walls), GUESS, 1e-10)


def cases(quick: bool) -> Iterator[Case]:
    """Published values, critical points, twenty digits, and times."""
    for case, mode, seconds in rows(quick):
        size = max(abs(case.value.real), abs(case.value.imag))
        allowed = (case.tolerance / abs(case.unit) + mode.error / abs(case.unit)) / size
        note = f"error {mode.error:.0e}, {1e3 * seconds:.0f} ms; {case.source}"
        yield Case(case.name, case.value, mode.sigma / case.unit, allowed, note)
    began = time.perf_counter()
    found = st.critical(st.gallery.plane_poiseuille, 5772.0, 1.02, -1.02j * 0.264)
    note = f"{time.perf_counter() - began:.1f} s"
    yield Case("plane Poiseuille, Re_c", 5772.22181620970, found.reynolds, 1e-12, note)
    yield Case("plane Poiseuille, α_c", 1.02054744928533, found.alpha, 1e-12, note)
    found = st.critical(st.gallery.benard, 1707.0, 3.11, 0.01)
    yield Case("Bénard, Ra_c", 1707.76177710, found.reynolds, 3e-12)
    yield Case("Bénard, a_c", 3.11632355, found.alpha, 2e-9)
    if not quick:
        found = st.critical(st.gallery.suction, 54370.0, 0.1555, -0.1555j * 0.15, rtol=1e-7)
        yield Case("suction layer, R_c", 54370.0, found.reynolds, 10 / 54370, "Hocking 1975, to a unit of the fourth digit")
        yield Case("suction layer, α_c", 0.1555, found.alpha, 1e-4 / 0.1555)
    mode = st.refine(st.gallery.PlanePoiseuille(), GUESS, digits=20)
    yield Case("plane Poiseuille, digits", "20 digits", f"{twenty(mode):d} digits", 0.0, f"{mode.seconds:.1f} s")
    built_in = st.refine(st.gallery.PlanePoiseuille(), GUESS, rtol=1e-10)
    for compiled in (False, True):
        mode, seconds = own(compiled)
        name = f"order 4 of one's own, {'numba' if compiled else 'plain Python'}"
        note = f"error {mode.error:.0e}, {1e3 * seconds:.0f} ms; the built-in problem"
        yield Case(name, built_in.sigma, mode.sigma, (built_in.error + mode.error) / abs(built_in.sigma), note)


def table() -> None:
    """The table of validation/README.md."""
    print("| problem | eigenvalue | published | bound | time |\n|---|---|---|---|---|")
    for case, mode, seconds in rows(False):
        v, digits = mode.sigma / case.unit, case.digits
        value = f"{v.real:.12g}" + (f" {'-' if v.imag < 0 else '+'} {abs(v.imag):.12g}i" if abs(v.imag) > 10 * mode.error else "")
        print(f"| {case.name} | {value} | {case.source}, {digits} digits | {mode.error / abs(case.unit):.0e} | {1e3 * seconds:.0f} ms |")


def record(names: Sequence[str] = ()) -> None:
    """Eigenvalues by Taylor series, in decimals, of every published case."""
    from mpmath import nstr

    found = json.loads(RECORD.read_text(encoding="utf-8"))["modes"] if names else {}
    for case in PUBLISHED:
        if names and case.name not in names:
            continue
        problem = case.problem()
        try:
            mode = st.refine(problem, st.refine(problem, case.sigma * (1 + 1e-4)).sigma, digits=DIGITS)
        except st.InputError as error:
            print(f"{case.name}: {error}")
            continue
        found[case.name] = [nstr(part, DIGITS) for part in (mode.sigma.real, mode.sigma.imag)]
    made = f"validation/gallery.py --record, {DIGITS} digits, version {st.__version__}"
    RECORD.write_text(json.dumps({"made": made, "modes": found}, indent=1) + "\n", encoding="utf-8")


CLAIM = Claim(
    "Every problem of the gallery gives its published digits, and a problem of one's own those of the built-in one.",
    "as named in models/gallery and models/catalogue",
    cases,
)

if __name__ == "__main__":
    if "--table" in sys.argv:
        table()
    elif "--record" in sys.argv:
        record(sys.argv[sys.argv.index("--record") + 1 :])
    else:
        main(CLAIM)
