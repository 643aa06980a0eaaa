"""One D(σ): its floating-point operations, its time, and how far the kernel is from what the machine can do; subsystems against the whole.

`python validation/bench_kernel.py`, one thread. A complex multiplication with addition counts as 8 operations, a real one as 2. The
machine's speed is that of a product of 512×512 matrices in LAPACK's BLAS, the best that this machine does on one thread.
"""

from __future__ import annotations

import os

os.environ["OMP_NUM_THREADS"] = "1"

import time
from collections.abc import Callable

import numpy as np
from rich.console import Console
from rich.table import Table
from scenes import GUESS, problem

import shootstab as st
from shootstab.discriminants.meshing import made_for
from shootstab.discriminants.product import Product
from shootstab.discriminants.shooting import Shooting
from shootstab.kernels.reduced_system import ReducedSystem
from shootstab.kernels.tableau import STAGES, WEIGHTS, A
from shootstab.models.chute import ChuteProblem

ROUNDS, CALLS = 15, 20  # chosen
COMBINED = int(np.count_nonzero(A)) + int(np.count_nonzero(WEIGHTS))  # stages that are added to something in a step


def seconds(call: Callable[[complex], object], sigma: complex) -> float:
    """The least mean time of several rounds, at a σ that changes from call to call."""
    sigmas = [sigma * (1 + 1e-9 * i) for i in range(CALLS)]
    best = np.inf
    for _ in range(ROUNDS):
        began = time.perf_counter()
        for s in sigmas:
            call(s)
        best = min(best, (time.perf_counter() - began) / CALLS)
    return float(best)


def operations(system: ReducedSystem, k: int) -> float:
    """Operations of one transport without σ-derivative: system, stages, error estimates and orthonormalization."""
    steps, entries = len(system.P), len(system.column)
    m = system.G.shape[3]
    n = len(system.start) - 1 - m
    kind = 8 if np.iscomplexobj(system.P) else 2
    stage = kind * (entries * k + len(system.linear) + 2 * len(system.higher)) + kind * k * m * (m + len(system.carries))
    numbers = n * k * (2 if kind == 8 else 1)
    step = STAGES * stage + 2 * COMBINED * numbers + kind * n * k * (k + 1)
    return float(steps * step)


def gflops() -> float:
    """Gflop/s of a product of matrices."""
    a = np.random.default_rng(0).random((512, 512))
    best = np.inf
    for _ in range(10):
        began = time.perf_counter()
        a @ a
        best = min(best, time.perf_counter() - began)
    return float(2 * 512**3 / best / 1e9)


def members(discriminant: object) -> tuple[Shooting, ...]:
    """The shootings that a discriminant is made of."""
    return discriminant.members if isinstance(discriminant, Product) else (discriminant,)  # type: ignore[return-value]


class FromAbove(ChuteProblem):
    """Begun where the leading order of the far field would be good enough."""

    def start(self, sigma: complex, tolerance: float) -> float:
        return self.flow.height(1e-14)


def main() -> None:
    """Print the tables."""
    console, peak = Console(width=160), gflops()
    console.print("one D(σ), local errors 1e-10, orthonormalized shooting, one thread")
    console.print(f"in products of matrices the machine does {peak:.0f} Gflop/s")
    table = Table("scene", "orders", "numbers", "steps", "10⁶ flop", "ms", "with dD/dσ, ms", "Gflop/s", "of the machine", box=None)
    for name, sigma in GUESS.items():
        D = st.Frame(rtol=1e-10).on(problem(name)).at(sigma)
        subsystems = members(D)
        real = sigma.imag == 0.0 and all(p.sampled.real is not None for p in subsystems)
        systems = ((p.sampled.real if real else p.sampled.system, p.problem.decaying) for p in subsystems)
        flop = sum(operations(system, k) for system, k in systems if system is not None)
        plain, slope = seconds(D, sigma), seconds(D.with_derivative, sigma)
        orders = " + ".join(str(p.problem.size) for p in subsystems)
        row = (orders, "real" if real else "complex", str(D.steps), f"{flop / 1e6:.2f}", f"{1e3 * plain:.3f}", f"{1e3 * slope:.3f}")
        table.add_row(name, *row, f"{flop / plain / 1e9:.1f}", f"{100 * flop / plain / 1e9 / peak:.0f} %")
    console.print(table)
    console.print("\nsteps for local errors of 1e-10, from where the far-field series holds and from nu0 = 1e-14")
    table = Table("scene", "series", "nu0 = 1e-14", box=None)
    for name, sigma in GUESS.items():
        p, counts = problem(name), []
        for begun in (p, FromAbove(p.flow, p.kx, p.ky)):
            counts.append(str(st.Frame(rtol=1e-10).on(begun).at(sigma).steps))
        table.add_row(name, *counts)
    console.print(table)
    console.print("\nthe subsystems that a scene requires, against the whole of order 8 in complex numbers: time of D(σ) with dD/dσ")
    table = Table("scene", "method", "whole, ms", "subsystems, ms", "ratio", box=None)
    methods = st.Frame(rtol=1e-10), st.Compound(rtol=1e-10), st.Riccati(rtol=1e-10)
    for name in ("high", "low", "fig2"):
        for method in methods:
            # a whole whose σ has the least imaginary part is carried in complex numbers
            off_axis = GUESS[name] + (0j if GUESS[name].imag else 1e-12j)
            whole = seconds(made_for(problem(name), method, None, off_axis).with_derivative, off_axis)
            parts_time = seconds(method.on(problem(name)).at(GUESS[name]).with_derivative, GUESS[name])
            table.add_row(name, method.name, f"{1e3 * whole:.3f}", f"{1e3 * parts_time:.3f}", f"{whole / parts_time:.1f}")
    console.print(table)


if __name__ == "__main__":
    main()
