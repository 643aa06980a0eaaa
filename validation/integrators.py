"""Ways to carry a frame along a mesh, compared at equal true error: what stands in the package against what else is known.

The same decaying space is carried from the same place to the wall, at one σ next to a mode, by

- the package's kernel: Runge–Kutta of order 8, compiled;
- Taylor series about the middle of each step, compiled, the coefficients of A from samples on a circle (Cauchy's formula by FFT);
- Gauss–Legendre collocation with s nodes, order 2s: one linear system of order sn a step, all of them at once by LAPACK;
- Magnus series of order 6 with three Gauss points (Blanes, Casas & Ros, BIT 40 (2000) 434), exponentials of all steps at once by BLAS-3.

Nodes are spread as those of the package's own mesh. Each takes the fewest steps, on a ladder of ratio LADDER, at which the zero of D moves
by less than WANTED of |σ|; the truth is the package's at local errors of TRUTH. Times are of one thread, with A at all points in memory,
and without σ-derivative. Besides: 4 to 64 σ through one table, σ the fastest index, against the same kernel one by one, with and without
the derivative (batched_transport.py). With --write the tables go into README.md.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import batched_transport
import numpy as np
import readme_tables
from bench import best, duration
from numba import njit
from scenes import GUESS, problem

import shootstab as st
from shootstab.core.errors import ShootstabError
from shootstab.discriminants.product import Product
from shootstab.discriminants.sampled_system import sample_system
from shootstab.discriminants.shooting import Shooting
from shootstab.kernels.frame_transport import transport
from shootstab.models.gallery.poiseuille import PlanePoiseuille

WANTED, TRUTH, RTOL = 1e-9, 1e-13, 1e-10  # chosen
LADDER, LONGEST, MOST = 1.2, 1 / 96, 3.0  # chosen: ratio of numbers of steps; fewest and most, in those of the package's mesh at RTOL
TAYLOR, GAUSS = (16, 24, 30), (4, 8, 12, 16)  # chosen: orders; nodes
ROUND = 1.25  # chosen: the circle of samples, in half a step: wider ones meet singularities, narrower ones lose digits
BATCHES = (4, 8, 16, 32, 64)  # chosen: numbers of σ
GRAINS = {"e": 0.8, "e_w": 0.8, "r": 0.6, "tan_theta": 0.3}
STEEP = -0.0139832663 - 0.0665925234j  # measured (validation/bench_user.py): the wall mode of plane Poiseuille flow at R = 1e6, alpha = 1

Array = np.ndarray[Any, np.dtype[Any]]


@dataclass(frozen=True)
class Question:
    """One subsystem at one σ: its own mesh and frame, ln D of the truth without the scale of the far frame, and d ln D/dσ."""

    name: str
    shooting: Shooting
    sigma: complex
    log_true: complex
    slope: complex

    @property
    def frame(self) -> Array:
        return np.asarray(self.shooting.far(self.sigma).frame)

    @property
    def wall(self) -> Array:
        rows = self.shooting.problem.wall_rows()
        return np.asarray(sum(W * self.sigma**p for p, W in enumerate(rows)))

    def A(self, z: Array) -> Array:
        """C⁻¹D (…, n, n) at points z."""
        at = self.shooting.problem.pencil(z.ravel().astype(np.complex128))
        C, D = (sum(M * self.sigma**p for p, M in enumerate(parts)) for parts in (at.C, at.D))
        return np.linalg.solve(C, D).reshape(*z.shape, *C.shape[1:])

    def nodes(self, steps: int) -> Array:
        """The nodes of so many steps, spread as those of the package's mesh."""
        own = self.shooting.sampled.nodes.real
        return np.interp(np.linspace(0.0, len(own) - 1.0, steps + 1), np.arange(len(own)), own)

    def error(self, Y: Array, log_det: float) -> float:
        """How far the zero moves, in |σ|."""
        change = np.exp(np.log(complex(np.linalg.det(self.wall @ Y))) + log_det - self.log_true) - 1.0
        return float(abs(change / self.slope / self.sigma))


def questions() -> Iterator[Question]:
    """The largest subsystem of each, next to its mode."""
    cold = st.chute.problem(st.chute.steady(far_temperature=0.03, **GRAINS), 0.01, 0.0)
    asked = {
        "`high`": (problem("high"), GUESS["high"]),
        "`low`": (problem("low"), GUESS["low"]),
        "T_∞ = 0.03": (cold, complex(st.refine(cold, 0.0075 + 0.0056j, rtol=1e-9).sigma) * 1.001),
        "Poiseuille, R = 1e6": (PlanePoiseuille(reynolds=1e6), STEEP * 1.001),
    }
    for name, (p, sigma) in asked.items():
        D, tight = (st.Frame(rtol=rtol).on(p).at(sigma) for rtol in (RTOL, TRUTH))
        own, true = (max(members(d), key=lambda member: member.problem.size) for d in (D, tight))
        value = true.with_derivative(sigma)
        # the frame begins where the mesh does: the truth is carried from there
        fine = Shooting(true.problem, true.propagator, sample_system(true.problem, begun_at(own, true)))
        value = fine.with_derivative(sigma)
        log = complex(np.log(value.D.mantissa)) + value.D.log_scale - own.far(sigma).log_scale
        yield Question(name, own, sigma, log, value.logarithmic_derivative)


def begun_at(own: Shooting, true: Shooting) -> Array:
    """The nodes of the truth's mesh below the beginning of the other, with that in front."""
    start, nodes = own.sampled.nodes[0], true.sampled.nodes
    inward = np.sign((nodes[-1] - nodes[0]).real)
    return np.concatenate(([start], nodes[(nodes - start).real * inward > 0.0]))


def members(discriminant: object) -> tuple[Shooting, ...]:
    """The shootings that a discriminant is made of."""
    return discriminant.members if isinstance(discriminant, Product) else (discriminant,)  # type: ignore[return-value]


def steps_at_once(Phi: Array, Y: Array) -> tuple[Array, float]:
    """The frame carried by the propagators Phi (N, n, n), orthonormalized after each, and ln of the determinants of R."""
    log_det = 0j
    for P in Phi:
        Y, R = np.linalg.qr(P @ Y)
        log_det += np.log(np.diag(R).astype(complex)).sum()
    return Y, log_det  # type: ignore[return-value]


Run = Callable[[], tuple[Array, float]]


def runge_kutta(q: Question, steps: int) -> Run:
    """The package's."""
    sampled = sample_system(q.shooting.problem, q.nodes(steps))
    errors, frame = np.empty(steps), q.frame

    def run() -> tuple[Array, float]:
        system, sigma, Y, dY = sampled.numbers(q.sigma, frame, np.zeros_like(frame))
        log_det, _ = transport(system, sigma, Y, dY, False, errors)
        return Y, log_det

    return run


def taylor(order: int) -> Callable[[Question, int], Run]:
    """Taylor's series of this order."""

    def prepared(q: Question, steps: int) -> Run:
        nodes = q.nodes(steps)
        half, points = np.diff(nodes) / 2, 2 * order
        circle = ROUND * np.exp(2j * np.pi * np.arange(points) / points)
        samples = q.A(nodes[:-1, None] + half[:, None] * (1 + circle)) * half[:, None, None, None]
        coefficients = np.fft.fft(samples, axis=1)[:, :order] / points / ROUND ** np.arange(order)[:, None, None]
        A = np.ascontiguousarray(coefficients)
        Y0, n = q.frame.astype(complex), q.frame.shape[0]
        series = np.empty((order + 1, n, n), complex)

        def run() -> tuple[Array, float]:
            return carried(A, Y0.copy(), series)

        return run

    return prepared


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def carried(A, Y, series):  # type: ignore[no-untyped-def]
    """Each step from its middle: Φ(1) Φ(−1)⁻¹ Y with Φ_m+1 = Σ_j A_j Φ_m−j/(m + 1), Φ_0 = 1; A (N, order, n, n), Y (n, k)."""
    steps, order, n, k = A.shape[0], A.shape[1], A.shape[2], Y.shape[1]
    log_det = 0j
    ahead, behind = np.empty((n, n), A.dtype), np.empty((n, n), A.dtype)
    for s in range(steps):
        for a in range(n):
            for b in range(n):
                series[0, a, b] = 1.0 if a == b else 0.0
                ahead[a, b], behind[a, b] = series[0, a, b], series[0, a, b]
        for m in range(order):
            for a in range(n):
                for b in range(n):
                    series[m + 1, a, b] = 0.0
            for j in range(m + 1):
                for a in range(n):
                    for c in range(n):
                        x = A[s, j, a, c]
                        if x != 0.0:
                            for b in range(n):
                                series[m + 1, a, b] += x * series[m - j, c, b]
            sign = 1.0 if m % 2 == 1 else -1.0
            for a in range(n):
                for b in range(n):
                    series[m + 1, a, b] /= m + 1
                    ahead[a, b] += series[m + 1, a, b]
                    behind[a, b] += sign * series[m + 1, a, b]
        Q, R = np.linalg.qr(ahead @ np.linalg.solve(behind, Y))
        for a in range(k):
            log_det += np.log(R[a, a])
        Y = Q
    return Y, log_det


def collocation(s: int) -> Callable[[Question, int], Run]:
    """Gauss–Legendre collocation with s nodes: K_i = A_i (y + Σ_j a_ij K_j), y + Σ b_i K_i."""
    x, w = np.polynomial.legendre.leggauss(s)
    c = (1 + x) / 2
    powers = np.arange(1, s + 1)
    V = np.polynomial.legendre.legvander(x, s - 1)
    integrals = np.array([np.polynomial.legendre.legint(row, lbnd=-1) for row in np.eye(s)])
    a = np.array([[np.polynomial.legendre.legval(t, row) for row in integrals] for t in x]) @ np.linalg.inv(V) / 2
    assert np.allclose(a @ c[:, None] ** (powers - 1), c[:, None] ** powers / powers)

    def prepared(q: Question, steps: int) -> Run:
        nodes, n = q.nodes(steps), q.frame.shape[0]
        h = np.diff(nodes)
        A = q.A(nodes[:-1, None] + h[:, None] * c) * h[:, None, None, None]
        Y0 = q.frame.astype(complex)

        def run() -> tuple[Array, float]:
            M = np.eye(s * n) - np.einsum("ij,niab->niajb", a, A).reshape(steps, s * n, s * n)
            K = np.linalg.solve(M, A.reshape(steps, s * n, n)).reshape(steps, s, n, n)
            return steps_at_once(np.eye(n) + np.tensordot(w / 2, K, (0, 1)), Y0)

        return run

    return prepared


def magnus(q: Question, steps: int) -> Run:
    """Order 6: α1 = hA2, α2 = √15/3 h(A3 − A1), α3 = 10/3 h(A3 − 2A2 + A1); C1 = [α1, α2], C2 = −[α1, 2α3 + C1]/60 and
    Ω = α1 + α3/12 + [−20α1 − α3 + C1, α2 + C2]/240."""
    nodes, n = q.nodes(steps), q.frame.shape[0]
    h = np.diff(nodes)
    shift = np.sqrt(15.0) / 10
    A1, A2, A3 = (q.A(nodes[:-1] + h * t) * h[:, None, None] for t in (0.5 - shift, 0.5, 0.5 + shift))
    Y0 = q.frame.astype(complex)

    def run() -> tuple[Array, float]:
        a1, a2, a3 = A2, np.sqrt(15.0) / 3 * (A3 - A1), 10 / 3 * (A3 - 2 * A2 + A1)
        C1 = a1 @ a2 - a2 @ a1
        right = 2 * a3 + C1
        C2 = -(a1 @ right - right @ a1) / 60
        left, right = -20 * a1 - a3 + C1, a2 + C2
        return steps_at_once(exponentials(a1 + a3 / 12 + (left @ right - right @ left) / 240, n), Y0)

    return run


def exponentials(Omega: Array, n: int) -> Array:
    """exp of each (N, n, n): Taylor's series of order 12 by products, of 2^−p Ω, and p squarings."""
    p = max(0, int(np.ceil(np.log2(max(np.abs(Omega).sum(axis=-1).max(), 1e-300)))) + 1)
    X = Omega / 2**p
    out = np.eye(n) + X / 12
    for m in range(11, 0, -1):
        out = np.eye(n) + X @ out / m
    for _ in range(p):
        out = out @ out
    return np.asarray(out)


WAYS: dict[str, Callable[[Question, int], Run]] = {
    "Runge–Kutta, order 8": runge_kutta,
    **{f"Taylor, order {order}": taylor(order) for order in TAYLOR},
    **{f"Gauss collocation, {s} nodes": collocation(s) for s in GAUSS},
    "Magnus, order 6": magnus,
}


def fewest(q: Question, way: Callable[[Question, int], Run]) -> tuple[int, float] | None:
    """The fewest steps with which a way is accurate enough, and its time; None where none on the ladder is."""
    most = q.shooting.steps
    steps = max(2, int(most * LONGEST))
    while steps <= MOST * most:
        try:
            with np.errstate(all="ignore"):
                run = way(q, steps)
                error = q.error(*run())
        except (np.linalg.LinAlgError, ShootstabError):
            error = np.inf  # a circle beyond the flow's own radius, or overflow: shorter steps
        if error < WANTED:
            return steps, best(run)
        steps = max(steps + 1, int(steps * LADDER))
    return None


def compared() -> str:
    """The table by integrator and problem: steps, time, ratio to the first."""
    asked = list(questions())
    lines = ["| to 1e−9 of σ: steps, time, over the first | " + " | ".join(q.name for q in asked) + " |", "|---" * (len(asked) + 1) + "|"]
    first: dict[str, float] = {}
    for name, way in WAYS.items():
        cells = []
        for q in asked:
            found = fewest(q, way)
            if found is not None:
                first.setdefault(q.name, found[1])
            cells.append("not reached" if found is None else f"{found[0]}, {duration(found[1])}, {found[1] / first[q.name]:.3g}")
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
        print(lines[-1], file=sys.stderr, flush=True)
    return "\n".join(lines)


def batches() -> str:
    """The table of many σ through one table."""
    lines = [
        "| one of so many σ together, over one alone | one alone | " + " | ".join(map(str, BATCHES)) + " |",
        "|---" * (len(BATCHES) + 2) + "|",
    ]
    for name in ("low", "high"):
        D = st.Frame(rtol=RTOL).on(problem(name)).at(GUESS[name])
        for tangent in (False, True):
            alone, together = batched_transport.times(members(D), GUESS[name] * (1 + 1e-3j), tangent, BATCHES)
            what = f"`{name}`, {'D and dD/dσ' if tangent else 'D'}, complex numbers"
            cells = " | ".join(f"{duration(t)}, {t / alone:.2f}" for t in together)
            lines.append(f"| {what} | {duration(alone)} | {cells} |")
            print(lines[-1], file=sys.stderr, flush=True)
    return "\n".join(lines)


def main() -> int:
    """Both tables."""
    tables = {"integrators": compared(), "batches": batches()}
    print("\n\n".join(tables.values()))
    if "--write" in sys.argv[1:]:
        for name, table in tables.items():
            readme_tables.write(name, table)
    return 0


if __name__ == "__main__":
    sys.exit(main())
