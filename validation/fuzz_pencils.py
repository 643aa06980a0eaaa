"""Random pencils against Chebyshev collocation: walls, half and whole lines, advection, jumps, doubles, orders 2 to 8.

`nice python validation/fuzz_pencils.py --number 2000 --out fuzz.jsonl` goes on where it was stopped; `--summary` reads what is there;
`--seed K` shows one pencil in full. The truth is that of collocation.py at two resolutions, and a region is asked about only if all that
the collocation has in and around it agrees between them. Exit status 1 if an answer is wrong, an error bound broken, or a limit passed.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from claims import Case, Claim
from collocation import Discretization, ElementJoint, Far, Fixed, stretched
from numpy.typing import NDArray
from stranger import ROUNDING, Stranger
from strangers import RIGHT, Answer, apart, asked, warm

import shootstab as st

Array = NDArray[Any]
MEMORY = 2**30  # chosen
SECONDS = 12.0  # chosen: seconds of CPU for one question
REACH = 24.0  # chosen: where an end at infinity is taken by the collocation: sech² is 1e-20 there
LARGEST = 3e3  # chosen: |σ| of modes that are asked about, at most
AGREE = 1e-5  # chosen: relative: what two spectra must agree to, to be asked about
KINDS = ("walls", "first order", "beam", "jumps", "double", "half line", "whole line", "advection", "moving rows", "C")
TURNS = (*KINDS, "walls", "first order", "jumps", "double")  # what is drawn in turn: the quick ones twice


@dataclass(frozen=True)
class DrawnPencil:
    """What was drawn: how shootstab is told, how the collocation is, and what of the plane lies right of the essential spectrum."""

    kind: str
    size: int
    problem: Callable[[], Any]
    form: Discretization
    fine: tuple[int, int, int, int]  # degrees: two for spectra, two for the truth
    right_of: float = -math.inf
    back: Callable[[complex], complex] = field(default=lambda v: v)


def smooth(rng: np.random.Generator, shape: tuple[int, ...], size: float, dtype: str) -> Callable[[Any], Array]:
    """A(z) = A₀ + A₁ cos(ωz + φ) + A₂ z."""

    def draw() -> Array:
        M = rng.standard_normal(shape)
        return size * (M + 1j * rng.standard_normal(shape) if dtype == "complex" else M)

    A0, A1, A2 = draw(), draw(), 0.5 * draw()
    omega, phase = rng.uniform(0.5, 4), rng.uniform(0, 6)
    return lambda z: A0 + A1 * np.cos(omega * z + phase) + A2 * z


def second_order(M: Array, K: Array, W: Array) -> tuple[Array, Array]:
    """y″ = (M + σW)y + Ky′ as a first-order system (y, y′)."""
    m = len(M)
    D0 = np.zeros((2 * m, 2 * m), dtype=np.result_type(M, K))
    D1 = np.zeros((2 * m, 2 * m), dtype=W.dtype)
    D0[:m, m:] = np.eye(m)
    D0[m:, :m], D0[m:, m:] = M, K
    D1[m:, :m] = W
    return D0, D1


def robin(rng: np.random.Generator, m: int) -> Array:
    """m conditions on (y, y′): values, slopes or a mixture."""
    rows = np.zeros((m, 2 * m))
    for i in range(m):
        how = rng.integers(3)
        rows[i, i] = (1.0, 0.0, rng.uniform(-2, 2))[how]
        rows[i, m + i] = (0.0, 1.0, 1.0)[how]
    return rows


def mixed(rng: np.random.Generator, n: int, pencil: Callable[[Any], Any]) -> tuple[Callable[[Any], Any], Array]:
    """The same system for χ = T⁻¹ψ: D → T⁻¹DT; rows become W T."""
    T = np.eye(n) + 0.4 * rng.standard_normal((n, n))
    inverse = np.linalg.inv(T)
    return lambda z: tuple(inverse @ D @ T for D in pencil(z)), T


def draw(seed: int) -> DrawnPencil:
    """Pencil number `seed`."""
    rng = np.random.default_rng(seed)
    kind = TURNS[seed % len(TURNS)]
    dtype = "complex" if rng.random() < 0.4 else "real"
    makers = {
        "walls": _walls,
        "first order": _first_order,
        "beam": _beam,
        "jumps": _jumps,
        "double": _double,
        "half line": _line,
        "whole line": _line,
        "advection": _line,
        "moving rows": _moving,
        "C": _left_factor,
    }
    return makers[kind](kind, rng, dtype)


def _between(
    kind: str, n: int, pencil: Any, a: float, left: Any, b: float, right: Any, N: tuple[int, int, int, int], moving: Any = None
) -> DrawnPencil:
    return DrawnPencil(
        kind,
        n,
        lambda: st.problem(n, pencil, st.Wall(a, left), st.Wall(b, right, moving=moving)),
        Discretization(n, pencil, Fixed(a, left), Fixed(b, right, moving)),
        N,
    )


def _parabolic(rng: np.random.Generator, dtype: str, m: int) -> Callable[[Any], Any]:
    size = 10 ** rng.uniform(-1, 1.3)
    M, K, W = smooth(rng, (m, m), size, dtype), smooth(rng, (m, m), rng.uniform(0, 3), dtype), np.diag(rng.uniform(0.5, 2, m))
    return lambda z: second_order(M(z), K(z), W)


def _walls(kind: str, rng: np.random.Generator, dtype: str) -> DrawnPencil:
    m = int(rng.integers(1, 5))
    pencil, T = mixed(rng, 2 * m, _parabolic(rng, dtype, m))
    length = rng.uniform(0.5, 2)
    return _between(kind, 2 * m, pencil, 0.0, robin(rng, m) @ T, length, robin(rng, m) @ T, (18, 23, 27, 34))


def _moving(kind: str, rng: np.random.Generator, dtype: str) -> DrawnPencil:
    m = int(rng.integers(1, 4))
    pencil = _parabolic(rng, dtype, m)
    rows, moving = robin(rng, m), np.zeros((m, 2 * m))
    rows[:, m:] = np.eye(m)
    moving[0, 0] = rng.uniform(0.1, 2)
    return _between(kind, 2 * m, pencil, 0.0, robin(rng, m), 1.0, rows, (18, 23, 27, 34), moving)


def _left_factor(kind: str, rng: np.random.Generator, dtype: str) -> DrawnPencil:
    """C0, C1 by a factor S(z)(1 + σN), N nilpotent: the determinant of C does not hold σ."""
    m = int(rng.integers(1, 4))
    n = 2 * m
    base, S, slope = _parabolic(rng, dtype, m), np.zeros((n, n)), np.zeros((n, n))
    while np.ptp(np.linalg.slogdet(S + slope * np.sin(np.linspace(0.0, 1.0, 101))[:, None, None])[0]) or not S.any():  # regular inside
        S, slope = np.eye(n) + 0.3 * rng.standard_normal((n, n)), 0.2 * rng.standard_normal((n, n))
    N = np.zeros((n, n))
    N[m:, :m] = rng.standard_normal((m, m))  # rows of slopes gain σ N y′, which must be taken back: y = (y, y′), y′ = second half

    def pencil(z: Any) -> Any:
        D0, D1 = base(z)
        L = S + slope * np.sin(z)
        extra = N @ np.eye(n, k=m)  # N applied to (y)′ = y′
        return L, L @ N, L @ D0, L @ (D1 + extra)

    return _between(kind, n, pencil, 0.0, robin(rng, m), 1.0, robin(rng, m), (18, 23, 27, 34))


def _first_order(kind: str, rng: np.random.Generator, dtype: str) -> DrawnPencil:
    """ψ′ = (D0(z) + σΛ)ψ, Λ real: characteristics in both directions, modes along vertical lines."""
    n = int(rng.integers(2, 7))
    k = int(rng.integers(1, n))
    speeds = np.concatenate((-rng.uniform(0.5, 1.5, k), rng.uniform(0.5, 1.5, n - k)))
    D0 = smooth(rng, (n, n), rng.uniform(0.3, 2.5), dtype)
    left, right = rng.standard_normal((k, n)), rng.standard_normal((n - k, n))
    return _between(kind, n, lambda z: (D0(z), np.diag(speeds)), -0.5, left, 0.7, right, (18, 23, 27, 34))


def _beam(kind: str, rng: np.random.Generator, dtype: str) -> DrawnPencil:
    """y⁗ = p y″ + q y′ + r y − σ y, one or two of them coupled."""
    m = int(rng.integers(1, 3))
    p, q, r = (smooth(rng, (m, m), s, dtype) for s in (3.0, 8.0, 40.0))

    def pencil(z: Any) -> Any:
        D0 = np.zeros((4 * m, 4 * m), dtype=np.result_type(p(z)))
        D1 = np.zeros((4 * m, 4 * m))
        for i in range(3):
            D0[i * m : (i + 1) * m, (i + 1) * m : (i + 2) * m] = np.eye(m)
        D0[3 * m :, :m], D0[3 * m :, m : 2 * m], D0[3 * m :, 2 * m : 3 * m] = r(z), q(z), p(z)
        D1[3 * m :, :m] = -np.eye(m)
        return D0, D1

    ends = [np.eye(4 * m)[[i + m * j for j in ((0, 1), (0, 2), (2, 3))[rng.integers(3)] for i in range(m)]] for _ in range(2)]
    return _between(kind, 4 * m, pencil, 0.0, ends[0], 1.0, ends[1], (18, 23, 27, 34))


def _jumps(kind: str, rng: np.random.Generator, dtype: str) -> DrawnPencil:
    m = int(rng.integers(1, 4))
    n = 2 * m
    places = np.sort(rng.uniform(0.15, 0.85, int(rng.integers(1, 3))))
    parts = [_parabolic(rng, dtype, m) for _ in range(len(places) + 1)]
    W = np.diag(rng.uniform(0.5, 2, m))

    def pencil(z: Any) -> Any:
        D0, _ = parts[int(np.searchsorted(places, float(np.real(z))))](z)
        return D0, second_order(np.zeros((m, m)), np.zeros((m, m)), W)[1]

    couplings = []
    for z in places:
        J = np.eye(n)
        if rng.random() < 0.6:
            J = J + 0.3 * rng.standard_normal((n, n))
        moving = np.zeros((n, n))
        if rng.random() < 0.4:
            moving[m, 0] = 0.1 * rng.uniform(0.1, 1)
        couplings.append((float(z), J, moving))
    left, right = robin(rng, m), robin(rng, m)
    return DrawnPencil(
        kind,
        n,
        lambda: st.problem(
            n,
            pencil,
            st.Wall(0, left),
            st.Wall(1, right),
            interfaces=[st.Interface.jump(z, J, moving=mov if mov.any() else None) for z, J, mov in couplings],
        ),
        Discretization(
            n,
            pencil,
            Fixed(0, left),
            Fixed(1, right),
            tuple(ElementJoint(z, J, -np.eye(n), mov) for z, J, mov in couplings),
        ),
        (12, 16, 18, 24),
    )


def _double(kind: str, rng: np.random.Generator, dtype: str) -> DrawnPencil:
    """Two copies of one system, mixed: double modes; or gaps of 1e-2 to 1e-9 between them; or a coupling that makes Jordan blocks."""
    m = 1 if rng.random() < 0.6 else 2
    base = _parabolic(rng, dtype, m)
    how = rng.choice(["double", "gap", "Jordan"])
    gap = 10 ** -rng.uniform(2, 9) if how == "gap" else 0.0
    n = 4 * m

    def twin(z: Any) -> Any:
        D0, D1 = base(z)
        zero = np.zeros_like(D0)
        corner = zero.copy()
        if how == "Jordan":
            corner[m:, :m] = np.eye(m)
        return np.block([[D0, corner], [zero, D0]]), np.block([[D1, 0 * D1], [0 * D1, D1 / (1 + gap)]])

    pencil, T = mixed(rng, n, twin)
    rows = [robin(rng, m) for _ in range(2)]
    full = [np.block([[r, 0 * r], [0 * r, r]]) @ T for r in rows]
    out = _between(f"{kind} ({how})", n, pencil, 0.0, full[0], 1.0, full[1], (18, 23, 27, 34))
    # the truth comes from one copy: collocation splits a double mode by the root of its rounding
    single = Discretization(2 * m, base, Fixed(0.0, rows[0]), Fixed(1.0, rows[1]))
    return replace(out, form=single, back=lambda v: v * (1 + gap)) if how != "gap" or gap else out


def _line(kind: str, rng: np.random.Generator, dtype: str) -> DrawnPencil:
    """y″ = (M∞ + M sech²(z − s) + M₂ tanh(z − s) + σ)y + K y′, wells deep enough to hold modes; K is advection."""
    m = 1 if rng.random() < 0.7 else 2
    n = 2 * m
    limit = np.diag(rng.uniform(0.3, 3, m)) + (0.2 * rng.standard_normal((m, m)) if m > 1 else 0)
    phase = 1j if dtype == "complex" else 0
    coupling = rng.standard_normal((m, m)) * (1 + phase) if m > 1 else np.full((1, 1), 2 * phase)
    well = coupling - np.diag(rng.uniform(1, 14, m))
    step = 0.3 * np.diag(rng.uniform(-1, 1, m)) if rng.random() < 0.5 else np.zeros((m, m))
    c = float(rng.choice([1e-6, 1e-3, 0.05, 0.3, 1.0, 2.0]) * rng.choice([-1, 1])) if kind == "advection" else float(rng.choice([0.0, 0.4]))
    K = c * np.eye(m) + (np.diag(rng.uniform(-0.2, 0.2, m)) if kind == "advection" and rng.random() < 0.5 else 0)
    shift = rng.uniform(-0.5, 0.5)

    def pencil(z: Any) -> Any:
        x = z - shift
        y = -x if np.real(x) < 0 else x
        e = np.exp(-y)
        s = (2 * e / (1 + e * e)) ** 2
        return second_order(limit + well * s + step * np.tanh(x), K + 0 * well, np.eye(m))

    far = [np.linalg.eigvals(limit + side * step) for side in (-1, 1)]
    right_of = max(-float(np.real(v).min()) for v in far)
    left: Any
    at: Any
    if kind == "half line":
        rows = robin(rng, m)
        left, at = st.Wall(0, rows), Fixed(0.0, rows)
    else:
        left, at = st.Infinity(), Far(-REACH, m)
    at = at if kind == "half line" else Far(-1.0, m)
    form = Discretization(n, stretched(pencil, REACH), at, Far(1.0, m))  # the problem in t, z = sinh(κt)
    degrees = (26, 32, 48, 60) if kind == "half line" else (38, 46, 76, 96)
    return DrawnPencil(kind, n, lambda: st.problem(n, pencil, left, st.Infinity()), form, degrees, right_of)


# the region


def region(p: DrawnPencil, seed: int) -> tuple[Any, list[complex], list[complex]] | None:
    """A rectangle in which, and well around which, two spectra agree; the modes in it, and points in it that are far from all."""
    rng = np.random.default_rng(seed + 10**6)
    reference = 0.5 + p.right_of if math.isfinite(p.right_of) else 1.0
    first, second = (replace(p.form, N=N).around(0.37, LARGEST, reference) for N in p.fine[:2])
    agreed = np.array([v for v in second if np.abs(first - v).min() <= AGREE * (abs(v) + 1e-3)])
    doubtful = np.array([v for v in [*first, *second] if np.abs(agreed - v).min(initial=math.inf) > 10 * AGREE * (abs(v) + 1e-3)])
    if math.isfinite(p.right_of):
        agreed = agreed[agreed.real > p.right_of + 0.05]
    if not len(agreed):
        return None
    order = np.argsort(np.abs(agreed))
    for _ in range(200):
        centre = agreed[order[min(int(rng.exponential(3)), len(order) - 1)]]
        size = abs(centre) * rng.uniform(0.05, 1.2) + 1e-3
        a = centre - size * complex(rng.uniform(0.1, 1), rng.uniform(0.1, 1))
        b = centre + size * complex(rng.uniform(0.1, 1), rng.uniform(0.1, 1))
        if a.real <= p.right_of + 0.05 or max(map(abs, st.Rectangle(a, b).hull)) >= LARGEST:  # modes beyond are not in the two spectra
            continue

        def depth(v: Array, lower: complex = a, upper: complex = b) -> Array:
            """How deep in the rectangle, in that of its sides; below 0 outside."""
            w, h = upper.real - lower.real, upper.imag - lower.imag
            return np.minimum(
                np.minimum(v.real - lower.real, upper.real - v.real) / w, np.minimum(v.imag - lower.imag, upper.imag - v.imag) / h
            )

        inside = depth(agreed)
        if np.abs(inside).min() < 0.02 or (len(doubtful) and depth(doubtful).max() > -0.3):
            continue
        modes = [complex(v) for v in agreed[inside > 0]]
        if not 1 <= len(modes) <= (2 if math.isfinite(p.right_of) else 4):
            continue
        apart_ = [complex(rng.uniform(a.real, b.real), rng.uniform(a.imag, b.imag)) for _ in range(20)]
        none = [v for v in apart_ if np.abs(agreed - v).min() > 0.15 * size][:2]
        return st.Rectangle(a, b), modes, none
    return None


def stranger(p: DrawnPencil, seed: int) -> Stranger | None:
    """The pencil as a problem with its truth, or None where no region is agreed on."""
    found = region(p, seed)
    if found is None:
        return None
    rectangle, rough, none = found
    modes: list[tuple[complex, float]] = []
    forms = [replace(p.form, N=N) for N in p.fine[2:]]
    given = [None if math.isfinite(p.right_of) else form.matrices() for form in forms]
    for v in rough:
        coarse = forms[0].near(v, given[0])
        fine = forms[1].near(coarse, given[1])
        sure = 3 * abs(fine - coarse) + 20 * ROUNDING * abs(fine)
        if abs(fine - v) > 1e-3 * (abs(v) + 1e-3) or sure > 1e-7 * (abs(v) + 1e-3):
            return None
        modes.append((fine, sure))
    if p.kind.startswith("double"):
        other = [(p.back(v), sure) for v, sure in modes]
        modes = modes + other
    distinct = [v for v, _ in modes]
    near = min((abs(a - b) for i, a in enumerate(distinct) for b in distinct[:i]), default=math.inf)
    twofold = p.kind.startswith("double")
    if not twofold and near < 1e-6 * max(abs(v) for v in distinct):
        return None  # inverse iteration led two guesses to one mode
    size = max(abs(v) for v in distinct)
    return Stranger(
        f"{seed}: {p.kind}, order {p.size}",
        "drawn",
        "collocation",
        p.problem,
        lambda: modes,
        region=rectangle,
        spurious=() if twofold else tuple(none),
        scale=0.1 * size,
        seconds=SECONDS,
        refined=0 if twofold else 2,
        skip=("missing", "small") if seed % 3 else (("missing", "find") if twofold else ("find",)),
    )


def one(seed: int) -> dict[str, Any]:
    """Everything about one pencil, in a process of its own."""
    began = time.perf_counter()
    told: dict[str, Any] = {"seed": seed}

    def ask(tell: Callable[[dict[str, Any]], None]) -> None:
        p = draw(seed)
        tell({"kind": p.kind, "size": p.size})
        s = stranger(p, seed)
        tell({"asked": s is not None})
        if s is not None:
            for answer in asked(s, s.modes()):
                tell(answer.__dict__)

    lines, megabytes, ended = apart(ask, MEMORY, 8 * SECONDS)
    answers = []
    for line in lines:
        if "outcome" in line:
            answers.append(line)
        else:
            told.update(line)
    if ended and "asked" in told:
        answers.append(Answer("all", "HEAVY" if "9" in ended else "SLOW", ended).__dict__)
    elif ended:
        told["asked"], told["why"] = False, ended
    bad = [a for a in answers if a["outcome"] != RIGHT]
    ratios = [a["ratio"] for a in answers if math.isfinite(a["ratio"])]
    return {
        **told,
        "answers": len(answers),
        "bad": bad,
        "ratio": min(ratios, default=None),
        "MB": round(megabytes),
        "seconds": round(sum(a["seconds"] for a in answers), 2),
        "wall": round(time.perf_counter() - began, 2),
    }


def told(out: Path) -> list[dict[str, Any]]:
    """What is in the file."""
    return [json.loads(line) for line in out.read_text().splitlines()] if out.exists() else []


def summary(records: list[dict[str, Any]]) -> str:
    """Counts by outcome and kind."""
    used = [r for r in records if r.get("asked")]
    outcomes = Counter(a["outcome"] for r in used for a in r["bad"])
    answers = sum(r["answers"] for r in used)
    lines = [
        f"{len(records)} pencils drawn, {len(used)} asked about, {answers} answers, {answers - sum(outcomes.values())} right; "
        + ", ".join(f"{n} {k}" for k, n in sorted(outcomes.items())),
        f"pencils with a wrong answer: {sum(any(a['outcome'] == 'WRONG' for a in r['bad']) for r in used)}, "
        f"bounds broken: {sum(a['outcome'] == 'WRONG' and 'bounds' in a['words'] for r in used for a in r['bad'])}, "
        f"smallest bound over error {min((r['ratio'] for r in used if r['ratio'] is not None), default=math.nan):.2f}, "
        f"most memory {max((r['MB'] for r in used), default=0)} MB, longest {max((r['seconds'] for r in used), default=0):.0f} s",
    ]
    for kind in KINDS:
        of = [r for r in used if r["kind"].startswith(kind)]
        bad = Counter(a["outcome"] for r in of for a in r["bad"])
        lines.append(
            f"  {kind:12s} {len(of):5d} pencils, {sum(not r['bad'] for r in of)} all right; "
            + ", ".join(f"{n} {k}" for k, n in sorted(bad.items()))
        )
    return "\n".join(lines)


def cases(quick: bool) -> Any:
    """Ten seeds, or two hundred."""
    warm()
    for seed in range(len(KINDS) if quick else 200):
        r = one(seed)
        if r.get("asked"):
            bad = "; ".join(f"{a['question']}: {a['outcome']}: {a['words'][:120]}" for a in r["bad"][:2])
            yield Case(
                f"{seed}: {r['kind']}, order {r['size']}", f"{r['answers']} right", f"{r['answers'] - len(r['bad'])} right", 0.0, bad
            )


CLAIM = Claim("Random pencils of order 2 to 8: no answer is wrong, no bound broken.", "collocation.py, at two resolutions", cases)


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--number", type=int, default=2000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("fuzz.jsonl"))
    parser.add_argument("--summary", action="store_true")
    parser.add_argument("--seed", type=int)
    args = parser.parse_args()
    if args.seed is not None:
        warm()
        print(json.dumps(one(args.seed), indent=1))
        return 0
    if not args.summary:
        done = {r["seed"] for r in told(args.out)}
        warm()
        with args.out.open("a") as file:
            for seed in range(args.first, args.first + args.number):
                if seed not in done:
                    file.write(json.dumps(one(seed)) + "\n")
                    file.flush()
    records = told(args.out)
    print(summary(records))
    return any(a["outcome"] != "lost" for r in records for a in r.get("bad", ()))


if __name__ == "__main__":
    sys.exit(main())
