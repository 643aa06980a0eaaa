"""Whether the equations with their conditions pose an eigenvalue problem: as many conditions as the order, and an eigenvalue in them."""

from __future__ import annotations

from shootstab.core.errors import InputError
from shootstab.formulation.first_order import FirstOrder
from shootstab.formulation.state_pencil import Condition
from shootstab.formulation.statement import Statement
from shootstab.formulation.system import degree, shown


def require_count(first: FirstOrder, statement: Statement, conditions: list[list[Condition]]) -> None:
    """Refuse any number of conditions but the order, where both ends are finite; consistent_splitting counts what decays at infinity."""
    left, right = len(statement.left_rows), len(statement.right_rows)
    names = statement.names
    at_joints = [c for joint in statement.joints for _, row in joint.rows for c in row.values()]
    at_joints += [c for _, row in statement.coupled for c in row.values()]
    held = [*first.C.values(), *first.D.values(), *(c for rows in conditions for row in rows for c in row.values()), *at_joints]
    if not any(degree(c) for c in held):
        raise InputError(
            f"neither the equations nor the conditions hold the eigenvalue {names.eigenvalue}: they pose no eigenvalue problem"
        )
    for side, count, other in (("left", left, right), ("right", right, left)):
        if all(statement.holding) and count == 0 and other == first.order:
            raise InputError(
                f"all {other} conditions stand at one end: an initial-value problem, whose only solution is zero whatever "
                f"{names.eigenvalue} is; it has no eigenvalues"
            )
        if statement.holding[side == "right"] and count == 0:
            raise InputError(f"{side} has no conditions: allowed is at least one (the order of the equations is {first.order})")
        if count > first.order:
            raise InputError(f"{side} has {count} conditions: allowed are at most {first.order}, the order of the equations")
    if all(statement.holding) and left + right != first.order:
        listed = ", ".join(shown(state) for state in first.states)
        told = f"{left} conditions at the left end and {right} at the right"
        raise InputError(f"{told}: allowed are {first.order} in all, the order of the equations, whose states are {listed}")
