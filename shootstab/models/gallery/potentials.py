"""Two operators of quantum mechanics on the whole line whose eigenvalues are known exactly.

Pöschl & Teller, Z. Phys. 83 (1933) 143: −y″ − ν(ν+1) sech²x y = −λ y has λ = (ν − j)², j = 0, 1, … < ν. The continuous spectrum is λ ≤
0; for small ν the one mode lies next to it and decays as slowly as e^{−ν|x|}.

Davies, Proc. R. Soc. Lond. A 455 (1999) 585: −u″ + i x² u = λ u has λ = e^{iπ/4}(2n + 1). The condition of the n-th grows as e^{1.3 n},
so that matrices of any size lose the higher ones.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import numpy as np

from shootstab.formulation.problem import EquationProblem, equations
from shootstab.models.gallery.orr_sommerfeld import require_positive
from shootstab.problems import Infinity, LinearProblem
from shootstab.problems.linear_problem import problem
from shootstab.problems.protocol import ComplexArray


def poeschl_teller(nu: float = 0.2) -> LinearProblem:
    """The Pöschl–Teller well, with λ as eigenvalue."""
    require_positive(nu=nu)
    D1 = np.array([[0, 0], [1, 0]])

    def pencil(x: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        decay = np.exp(-2 * np.abs(x.real)) if np.isrealobj(x) else np.exp(-2 * np.where(x.real < 0, -x, x))
        sech2 = 4 * decay / (1 + decay) ** 2
        D0 = np.zeros((len(x), 2, 2), dtype=np.complex128)
        D0[:, 0, 1], D0[:, 1, 0] = 1, -nu * (nu + 1) * sech2
        return D0, D1

    equation = "d(y,2) + nu*(nu + 1)*sech(x)**2*y = lambda_*y"
    written = partial(_on_the_line, "y", equation, {"nu": nu})
    return problem(2, pencil, Infinity(), Infinity(), vectorized=True, written=written, unknowns=["y"], variable="x")


def davies(start: float = 10.0) -> LinearProblem:
    """The eigenvalue is λ. The potential has no limit: begun at |x| = start with the decaying space there."""
    D1 = np.array([[0, 0], [-1, 0]])

    def pencil(x: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        D0 = np.zeros((len(x), 2, 2), dtype=np.complex128)
        D0[:, 0, 1], D0[:, 1, 0] = 1, 1j * x * x
        return D0, D1

    end, written = Infinity(start=start), partial(_on_the_line, "u", "-d(u,2) + i*x**2*u = lambda_*u", {})
    return problem(2, pencil, end, end, vectorized=True, written=written, unknowns=["u"], variable="x")


def _on_the_line(unknown: str, equation: str, parameters: Mapping[str, float]) -> EquationProblem:
    """The problem in equations, for many digits, between the infinities themselves; every parameter is the decimal that was typed."""
    return equations([unknown], [equation], Infinity(), Infinity(), parameters=parameters, eigenvalue="lambda_", variable="x")
