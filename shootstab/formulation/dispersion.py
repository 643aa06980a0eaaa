"""The essential spectrum of an end at infinity as a formula: det (i q C − D) = 0 with the limits of C and D, for real wavenumbers q.

There a solution neither grows nor decays towards the end: e^{iqz} solves the equations with constant coefficients.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from shootstab.core.errors import InputError
from shootstab.formulation.atoms import Atom
from shootstab.formulation.exponentials import exponential_end
from shootstab.formulation.expression import VARIABLE, Expression, number, of_atom
from shootstab.formulation.gaussian import I
from shootstab.formulation.linear_algebra import SparseRow, determinant
from shootstab.formulation.state_pencil import StatePencil
from shootstab.formulation.substitution import substituted
from shootstab.formulation.system import SIGMA, coefficients

WAVENUMBERS = ("q", "m", "q_")  # chosen: names for the wavenumber, the first that the user has not used


FlowLimit = Callable[[str, int], float]  # the value of a derivative of a base flow at the end


def dispersion_relation(system: StatePencil, direction: int, wavenumber: str, limit: FlowLimit | None = None) -> Expression | None:
    """The polynomial in σ and the wavenumber; None where the coefficients are not rational in one exponential, or in a base flow."""
    try:
        end = exponential_end(system, direction)
    except InputError:
        return None  # what has no such limit is said where it matters: at the end itself, or where many digits are asked for
    n, iq = range(system.size), number(I) * of_atom(Atom("constant", wavenumber))
    rows: list[SparseRow] = [{} for _ in n]
    for powers, factor in ((end.C, iq), (end.D, number(-1))):
        for power, part in enumerate(powers):
            for (i, j), entry in part.items():
                entry = substituted(entry, VARIABLE, number(0))
                for atom in entry.atoms():
                    if atom.kind == "given" and limit is not None:
                        entry = substituted(entry, atom, number(limit(atom.name, atom.order)))
                term = factor * SIGMA**power * entry
                rows[i][str(j)] = rows[i].get(str(j), number(0)) + term
    return determinant(rows, [str(j) for j in n])


def zero_in_sigma(relation: Expression) -> Expression | None:
    """The σ that solves a relation of the first degree in it; None for any other."""
    powers = coefficients(relation)
    return -powers.get(0, number(0)) / powers[1] if set(powers) <= {0, 1} and 1 in powers else None


def free_name(used: Sequence[str]) -> str:
    """A name for the wavenumber that means nothing else."""
    return next(name for name in WAVENUMBERS if name not in used)
