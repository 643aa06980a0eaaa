"""What equations say of the derivatives below the highest that occur in them: no condition can prescribe these otherwise.

Where the equations hold u_j up to order m_j and are of order n < Σ m_j, so many derivatives of lower order follow from the states, by an
equation or its derivatives. Continuity makes d(v) one of these in incompressible flow; a condition on it is one on what it is equal to.
"""

from __future__ import annotations

from shootstab.formulation.expression import Expression, number
from shootstab.formulation.first_order import FirstOrder
from shootstab.formulation.system import EquationRow, Jet, System, orders

ASKED: Jet = ("the derivative itself", 0)  # a name that no unknown can have


def constraints(system: System, first: FirstOrder) -> list[tuple[Jet, EquationRow, Expression]]:
    """The derivatives that are no states, of unknowns that are: each is the row over the states, divided by the factor."""
    kept = {name for name, _ in first.states}
    found = []
    for name, highest in orders(system.rows).items():
        for order in range(highest if name in kept else 0):
            if (name, order) not in first.states:
                row = dict(first.in_states({(name, order): number(1), ASKED: number(-1)}, beside=(ASKED,)))
                factor = -row.pop(ASKED)
                found.append(((name, order), row, factor))
    return found
