"""Raw spectra as codes write them: a Chebyshev tau method with inf among its values (as Dedalus'), and Legolas' binary files with 1e20."""

from __future__ import annotations

import cmath
import json
import os
import struct
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import scipy.linalg
from numpy.polynomial import chebyshev
from stranger import Fixed, Stranger, collocated, walls
from strangers_flows import CLAMPED, poiseuille

R, ALPHA = 2000.0, 1.0  # chosen
AGREES, DIFFERS = 1e-9, 1e-2  # chosen: relative: a claim this near to a mode is the mode, and this far from all is none


def tau(M: int) -> Any:
    """σ of plane Poiseuille flow by Chebyshev's tau method, as a first-order system of φ, φ′, φ″, φ‴; inf and all."""
    n = M + 1
    D = np.zeros((n, n))
    for k in range(n):
        D[:, k] = np.pad(chebyshev.chebder(np.eye(n)[k]), (0, n))[:n] if k else 0
    one, Y2 = np.eye(n), np.zeros((n, n))
    for k in range(n):
        Y2[:, k] = np.pad(chebyshev.chebmul(np.eye(n)[k], [0.5, 0.0, 0.5]), (0, n))[:n]  # y² = (T₀ + T₂)/2
    U = one - Y2
    a2 = ALPHA**2
    L, B = np.zeros((4 * n, 4 * n), dtype=complex), np.zeros((4 * n, 4 * n), dtype=complex)
    for i in range(3):
        L[i * n : (i + 1) * n, i * n : (i + 1) * n] = D
        L[i * n : (i + 1) * n, (i + 1) * n : (i + 2) * n] = -one
    last = slice(3 * n, 4 * n)
    L[last, 3 * n :] = D
    L[last, :n] = a2 * a2 * one + 1j * ALPHA * R * (a2 * U - 2 * one)
    L[last, 2 * n : 3 * n] = -2 * a2 * one - 1j * ALPHA * R * U
    B[last, :n], B[last, 2 * n : 3 * n] = -R * a2 * one, R * one
    # the last row of each equation gives way to a condition: φ, φ′ at ±1
    for i, (component, sign) in enumerate(((0, 1), (0, -1), (1, 1), (1, -1))):
        row = (i + 1) * n - 1
        L[row], B[row] = 0, 0
        L[row, component * n : (component + 1) * n] = float(sign) ** np.arange(n)
    with np.errstate(all="ignore"):
        return scipy.linalg.eigvals(L, B)


def resolved() -> list[complex]:
    """What two resolutions of the collocation agree on, |σ| < 2.5."""
    from stranger import Discretization

    a, b = (Discretization(4, poiseuille(R, ALPHA), Fixed(-1, CLAMPED), Fixed(1, CLAMPED), N=N).spectrum() for N in (90, 120))
    return [complex(v) for v in b if abs(v) < 2.5 and np.abs(a - v).min() < 1e-8 * abs(v)]


PROBLEM = """
import sys
sys.path[:0] = [{here!r}]
from strangers_flows import poiseuille, CLAMPED
import shootstab as st
problem = st.problem(4, poiseuille({R}, {ALPHA}), st.Wall(-1, CLAMPED), st.Wall(1, CLAMPED))
"""


def by_command(values: Any, write: Callable[[Path, Any], None], name: str, *options: str) -> dict[str, Any]:
    """`shootstab verify problem:problem FILE --json -` on a file with these values; raises ValueError with what it said if it refuses."""
    with tempfile.TemporaryDirectory() as folder:
        here = Path(folder)
        (here / "stranger_problem.py").write_text(PROBLEM.format(here=str(Path(__file__).parent), R=R, ALPHA=ALPHA))
        write(here / name, values)
        path = os.pathsep.join([str(here), str(Path(__file__).parent.parent), os.environ.get("PYTHONPATH", "")])
        command = [sys.executable, "-m", "shootstab", "verify", "stranger_problem:problem", name, "--json", "-", *options]
        done = subprocess.run(command, cwd=here, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": path}, check=False)
        if done.returncode not in (0, 1) or not done.stdout.strip():
            raise ValueError(f"exit status {done.returncode}: {done.stderr.strip()[-300:]}")
        return {**json.loads(done.stdout), "said": done.stderr}


def judge(values: Any, answer: dict[str, Any], unit: complex, truth: Sequence[complex]) -> Iterator[tuple[str, str, str]]:
    """Every claim that is clearly a mode or clearly none, against its verdict."""
    wrong: list[str] = []
    lost: list[str] = []
    judged = 0
    for v in answer["verdicts"]:
        claim = complex(float(v["claimed"]["re"]), float(v["claimed"]["im"])) * unit
        near = min(abs(claim - t) for t in truth) / abs(claim)
        if near < AGREES:
            judged += 1
            if v["verdict"] != "confirmed":
                (lost if v["verdict"] == "unresolved" else wrong).append(f"{claim:.9g} is a mode, and {v['verdict']}: {v['why']}")
        elif near > DIFFERS and abs(claim) < 1.0 and claim.real > -0.3:
            judged += 1
            if v["verdict"] != "spurious":
                (lost if v["verdict"] == "unresolved" else wrong).append(f"{claim:.9g} is no mode, and {v['verdict']}: {v['why']}")
    for m in answer["missing"]:
        s = complex(float(m["sigma"]["re"]), float(m["sigma"]["im"])) * unit
        finite = [complex(x) * unit for x in values if cmath.isfinite(complex(x)) and abs(x) < 1e15]
        if min(abs(s - x) for x in finite) < AGREES * abs(s):
            wrong.append(f"{s:.9g} is claimed, and missing")
    yield (
        "raw spectrum",
        "WRONG" if wrong else "lost" if lost else "right",
        f"{judged} judged; {len(wrong)} wrong, {len(lost)} lost: {(wrong + lost)[:2]}",
    )


def dedalus(kind: str) -> Callable[[Any, Any], Iterator[tuple[str, str, str]]]:
    """A tau spectrum, inf included, in one kind of file."""

    def write(path: Path, values: Any) -> None:
        if kind == "npy":
            np.save(path, values)
        elif kind == "csv":
            path.write_text("\n".join(f"{v.real},{v.imag}" for v in values))
        elif kind == "text":
            path.write_text("# idx re im\n" + "\n".join(f"{i} {v.real} {v.imag}" for i, v in enumerate(values)))
        else:
            import h5py

            with h5py.File(path, "w") as file:
                file["eigenvalues"] = values

    def ask(problem: Any, modes: Any) -> Iterator[tuple[str, str, str]]:
        values = tau(48)
        infinite = int(np.sum(~np.isfinite(values)))
        try:
            answer = by_command(values, write, f"spectrum.{kind}")
        except ValueError as error:
            yield "raw spectrum", "lost", f"{len(values)} values, {infinite} not finite: {error}"
            return
        yield from judge(values, answer, 1.0, resolved())

    return ask


def legolas_file(path: Path, omega: Any) -> None:
    """A file as Legolas 1.2 writes it: see the layout in src/dataIO of its repository. Padding 1e20 where LAPACK's β is 0."""
    out = bytearray(b"legolas_version" + b"1.2.0".ljust(10))

    def ints(*v: int) -> None:
        out.extend(struct.pack(f"<{len(v)}i", *v))

    def reals(*v: float) -> None:
        out.extend(struct.pack(f"<{len(v)}d", *v))

    ints(15, 20)  # lengths of texts: of a name, and of an array's name
    out.extend(b"Cartesian".ljust(15))
    reals(0.0, 1.0)
    ints(10, 19, 40, 160)
    reals(5 / 3)
    out.extend(b"resistive".ljust(15))
    ints(0, 0, 0)
    ints(0)
    reals(1.0, 1.0, 1.0)
    names = ["k2", "k3"]
    ints(len(names), 5)
    for n in names:
        out.extend(n.encode().ljust(5))
    reals(0.0, 1.0)
    ints(1, 5)
    out.extend(b"rho0 ")
    ints(0)
    units = ["unit_length"]
    ints(len(units), 12)
    out.extend(b"unit_length ")
    reals(1.0)
    ints(len(omega))
    for w in omega:
        reals(float(w.real), float(w.imag))
    path.write_bytes(bytes(out))


def legolas(problem: Any, modes: Any) -> Iterator[tuple[str, str, str]]:
    """The same spectrum as frequencies ω = iσ, with 1e20 for what is infinite, in Legolas' file."""
    sigma = tau(48)
    omega = np.where(np.isfinite(sigma), 1j * sigma, 1e20)
    try:
        answer = by_command(omega, legolas_file, "spectrum.dat", "--as", "frequency")
    except ValueError as error:
        yield "raw spectrum", "lost", str(error)
        return
    yield from judge(omega, answer, -1j, resolved())


def raw(name: str, also: Any, quick: bool = False) -> Stranger:
    return Stranger(
        name,
        "a fault report",
        "collocation",
        walls(4, poiseuille(R, ALPHA), -1, CLAMPED, 1, CLAMPED),
        collocated(4, poiseuille(R, ALPHA), Fixed(-1, CLAMPED), Fixed(1, CLAMPED), [-0.01979865 - 0.3121003j], N=60),
        also=also,
        quick=quick,
        seconds=60.0,
        skip=("small",),
    )


STRANGERS = [
    *(raw(f"tau spectrum of Poiseuille flow, {kind}", dedalus(kind)) for kind in ("npy", "csv", "text", "h5")),
    raw("spectrum in Legolas' file", legolas),
]
