"""Problems as their sources print them, in scene files: what the reduction finds, and the published digits; `--table` prints a table."""

from __future__ import annotations

import cmath
import math
import sys
import time
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from claims import Case, Claim, main

import shootstab as st
from shootstab.core.records import Mode
from shootstab.formulation.equation_scene import from_table
from shootstab.formulation.problem import EquationProblem

POISEUILLE = 0.0037396706229794099322 - 0.23752648882047010745j
MANY = 40  # digits


@dataclass(frozen=True)
class Written:
    """A scene as text, its order, an eigenvalue with the digits of it that hold, their source, and whether many digits are offered."""

    name: str
    text: str
    order: int
    value: complex
    digits: int
    source: str
    many: bool = True

    @property
    def lines(self) -> int:
        """That the user writes."""
        return len(self.text.strip().splitlines())

    def problem(self) -> EquationProblem:
        """Read and reduced."""
        return from_table(tomllib.loads(self.text)["problem"])


NAVIER_STOKES = """
[problem]
unknowns = ["u", "v", "w", "p"]
parameters = { R = 16666.666666666668, a = 0.6, b = 0.8 }
where = { U = "1 - z**2", k2 = "a**2 + b**2" }
equations = [
  "sigma*u + i*a*U*u + w*d(U) + i*a*p = (d(u,2) - k2*u)/R",
  "sigma*v + i*a*U*v + i*b*p = (d(v,2) - k2*v)/R",
  "sigma*w + i*a*U*w + d(p) = (d(w,2) - k2*w)/R",
  "i*a*u + i*b*v + d(w) = 0",
]
left = { at = -1, conditions = ["u", "v", "w"] }
right = { at = 1, conditions = ["u", "v", "w"] }
"""
PLANE = """
[problem]
unknowns = ["u", "v", "p"]
parameters = { R = 10000, a = 1 }
where = { U = "1 - z**2" }
equations = [
  "sigma*u + i*a*U*u + v*d(U) + i*a*p = (d(u,2) - a**2*u)/R",
  "sigma*v + i*a*U*v + d(p) = (d(v,2) - a**2*v)/R",
  "i*a*u + d(v) = 0",
]
left = { at = -1, conditions = ["u", "v"] }
right = { at = 1, conditions = ["u", "v"] }
"""
BENARD = """
[problem]
unknowns = ["u", "w", "p", "T"]
parameters = { a = 3.11632355 }
eigenvalue = "Ra"
equations = [
  "i*a*p = d(u,2) - a**2*u",
  "d(p) = d(w,2) - a**2*w + Ra*T",
  "i*a*u + d(w) = 0",
  "d(T,2) - a**2*T + w = 0",
]
left = { at = 0, conditions = ["u", "w", "T"] }
right = { at = 1, conditions = ["u", "w", "T"] }
"""
FREE = """
[problem]
unknowns = ["u", "w", "p", "T"]
parameters = { a = 2.5, Pr = 0.71, Ra = 1000 }
equations = [
  "sigma*u/Pr + i*a*p = d(u,2) - a**2*u",
  "sigma*w/Pr + d(p) = d(w,2) - a**2*w + Ra*T",
  "i*a*u + d(w) = 0",
  "sigma*T = d(T,2) - a**2*T + w",
]
left = { at = 0, conditions = ["d(u)", "w", "T"] }
right = { at = 1, conditions = ["d(u)", "w", "T"] }
"""
COUETTE = """
[problem]
unknowns = ["u", "v", "w", "p"]
parameters = { k = 3.1625, q = 0.5 }
where = { V = "Re*(-q*r/(1+q) + q/((1-q)*(1-q**2))/r)" }
eigenvalue = "Re"
variable = "r"
equations = [
  "-2*V*v/r + d(p) = d(u,2) + d(u)/r - u/r**2 - k**2*u",
  "(d(V) + V/r)*u = d(v,2) + d(v)/r - v/r**2 - k**2*v",
  "i*k*p = d(w,2) + d(w)/r - k**2*w",
  "d(u) + u/r + i*k*w = 0",
]
left = { at = 1, conditions = ["u", "v", "w"] }
right = { at = 2, conditions = ["u", "v", "w"] }
"""
PIPE = """
[problem]
unknowns = ["u", "v", "w", "p"]
parameters = { a = 1, n = 1, R = 3000 }
where = { W = "1 - r**2" }
variable = "r"
equations = [
  "(sigma + i*a*W)*u + d(p) = (d(u,2) + d(u)/r - (n**2+1)*u/r**2 - a**2*u - 2*i*n*v/r**2)/R",
  "(sigma + i*a*W)*v + i*n*p/r = (d(v,2) + d(v)/r - (n**2+1)*v/r**2 - a**2*v + 2*i*n*u/r**2)/R",
  "(sigma + i*a*W)*w + u*d(W) + i*a*p = (d(w,2) + d(w)/r - n**2*w/r**2 - a**2*w)/R",
  "d(u) + u/r + i*n*v/r + i*a*w = 0",
]
left = { axis = 0 }
right = { at = 1, conditions = ["u", "v", "w"] }
"""
EADY = """
[problem]
unknowns = ["psi"]
parameters = { k = 1.2 }
equations = ["(sigma + i*k*z)*(d(psi,2) - k**2*psi) = 0"]
left = { at = 0, conditions = ["sigma*d(psi) - i*k*psi"] }
right = { at = 1, conditions = ["(sigma + i*k)*d(psi) - i*k*psi"] }
"""
WAVES = """
[problem]
unknowns = ["u", "w", "p"]
parameters = { k = 1, g = 1 }
equations = ["sigma*u + i*k*p = 0", "sigma*w + d(p) = 0", "i*k*u + d(w) = 0"]
left = { at = -1, conditions = ["w"] }
right = { at = 0, conditions = ["sigma*p - g*w"] }
"""
LAYER = """
[problem]
unknowns = ["u", "v", "p"]
parameters = { a = 0.4446 }
where = { U = "tanh(z)" }
equations = ["(sigma + i*a*U)*u + v*d(U) + i*a*p = 0", "(sigma + i*a*U)*v + d(p) = 0", "i*a*u + d(v) = 0"]
left = "infinity"
right = "infinity"
"""
POTENTIAL = """
[problem]
unknowns = ["y"]
parameters = { nu = 0.2 }
eigenvalue = "s"
variable = "x"
equations = ["d(y,2) + nu*(nu+1)*sech(x)**2*y = s*y"]
left = "infinity"
right = "infinity"
"""
DAVIES = """
[problem]
unknowns = ["u"]
eigenvalue = "s"
variable = "x"
equations = ["-d(u,2) + i*x**2*u = s*u"]
left = { infinity = true, start = 10 }
right = { infinity = true, start = 10 }
"""
LEGENDRE = """
[problem]
unknowns = ["y"]
eigenvalue = "s"
variable = "x"
equations = ["d((1 - x**2)*d(y)) - 4*y/(1 - x**2) + s*y = 0"]
left = { axis = -1 }
right = { axis = 1 }
"""


def eady(k: float) -> complex:
    """σ of the growing mode: c = 1/2 ± (1/4 − coth(k)/k + 1/k²)^{1/2}."""
    c = 0.5 + cmath.sqrt(0.25 - 1 / (k * math.tanh(k)) + 1 / k**2)
    return -1j * k * (c if c.imag > 0 else c.conjugate())


def free(Ra: float, a: float, Pr: float) -> float:
    """Of two free walls, exactly: (σ/Pr + k²)(σ + k²) k² = Ra a², k² = π² + a²."""
    k2 = math.pi**2 + a * a
    half = 0.5 * k2 * (1 + Pr)
    return -half + math.sqrt(half**2 - Pr * (k2 * k2 - Ra * a * a / k2))


WRITTEN = (
    Written("plane Poiseuille, u v p", PLANE, 4, POISEUILLE, 15, "Orszag 1971, re-computed"),
    Written("oblique wave, u v w p", NAVIER_STOKES, 6, 0.6 * POISEUILLE, 14, "the same by Squire's transformation"),
    Written("Bénard, u w p T, rigid; the eigenvalue is Ra", BENARD, 6, 1707.76177710, 12, "Chandrasekhar 1961, re-computed"),
    Written("Bénard, u w p T, free", FREE, 6, free(1000.0, 2.5, 0.71), 14, "exact"),
    Written("Taylor–Couette, η = 1/2; the eigenvalue is Re", COUETTE, 6, 68.19, 4, "DiPrima & Swinney 1981"),
    Written("pipe flow, Re = 3000, n = 1", PIPE, 6, -0.0412756446937 - 0.9114655676227j, 13, "Meseguer & Trefethen 2003"),
    Written("Eady", EADY, 2, eady(1.2), 14, "exact"),
    Written("waves on water of depth 1", WAVES, 2, 1j * math.sqrt(math.tanh(1)), 15, "exact"),
    Written("shear layer, u v p", LAYER, 2, 0.1897, 4, "Michalke 1964", many=False),
    Written("Pöschl–Teller, ν = 0.2", POTENTIAL, 2, 0.04, 15, "exact", many=False),
    Written("Davies, n = 2", DAVIES, 2, 5 * cmath.exp(0.25j * math.pi), 14, "exact", many=False),
    Written("Legendre, m = 2, l = 4", LEGENDRE, 2, 20.0, 14, "exact", many=False),
)


def found(case: Written, quick: bool = False) -> tuple[EquationProblem, Mode, float, Mode | None]:
    """The problem, its mode, the processor seconds of reading and reduction, and the mode in many digits."""
    case.problem()
    began = time.process_time()
    problem = case.problem()
    seconds = time.process_time() - began
    guess = case.value * (1 + 1e-4)
    st.refine(problem, guess)
    mode = st.refine(problem, guess)
    return problem, mode, seconds, st.refine(problem, mode.sigma, digits=MANY) if case.many and not quick else None


def inside(problem: EquationProblem) -> str:
    """The continuous spectrum of the inside in words."""
    told: dict[str, Any] = dict(problem.explanation)
    text = str(told["continuous spectrum inside"])
    return "none" if text.startswith("none") else text.split(",")[0]


def cases(quick: bool) -> Iterator[Case]:
    """Order and eigenvalue of each; quick: without many digits."""
    for case in WRITTEN:
        problem, mode, seconds, many = found(case, quick)
        size = max(abs(case.value.real), abs(case.value.imag))
        allowed = (10.0 ** (math.floor(math.log10(size)) + 1 - case.digits) + mode.error) / size
        note = f"{case.lines} lines, {1e3 * seconds:.0f} ms to reduce, {1e3 * mode.seconds:.0f} ms a mode; {case.source}"
        yield Case(case.name, case.value, complex(mode.sigma), allowed, note)
        yield Case(f"{case.name}, order", f"{case.order}", f"{problem.first_order.order}", 0.0, f"σ_c inside: {inside(problem)}")
        yield Case(f"{case.name}, reduced in a second", "yes", "yes" if seconds < 1.0 else "no", 0.0)
        if many is not None:
            yield Case(f"{case.name}, {MANY} digits", "converged", many.status, 0.0, f"{many.seconds:.1f} s")


def table() -> None:
    """For validation/README.md."""
    print(f"| problem | lines | order | σ_c inside | published | digits agreed | reduction | one mode | {MANY} digits |")
    print("|---|---|---|---|---|---|---|---|---|")
    for case in WRITTEN:
        problem, mode, seconds, many = found(case)
        difference = abs(complex(mode.sigma) - case.value) / abs(case.value)
        agreed = min(16.0, -math.log10(difference)) if difference else 16.0
        digits = f"{many.seconds:.1f} s" if many is not None else "refused"
        times = f"{1e3 * seconds:.0f} ms | {1e3 * mode.seconds:.0f} ms | {digits}"
        known = f"{inside(problem)} | {case.source}, {case.digits} | {agreed:.1f}"
        print(f"| {case.name} | {case.lines} | {problem.first_order.order} | {known} | {times} |")


CLAIM = Claim(
    "A problem as its source prints it is brought to first order by the machine, with the right order, and gives the published digits.",
    "as named with each",
    cases,
)

if __name__ == "__main__":
    if "--table" in sys.argv:
        table()
    else:
        main(CLAIM)
