"""Whether equations and conditions are the same seen in a mirror: modes are then even or odd, each unknown in its own way.

With z ↦ 2m − z and u_j(z) ↦ s_j u_j(2m − z), s_j = ±1, a coefficient c_jk(z) of u_j^{(k)} becomes s_j (−1)^k c_jk(2m − z). Where that is
the same row again, up to a factor for each row, and conditions at one end become those at the other, the mirror commutes with the problem;
a simple mode is then one or the other, and a multiple one has a basis of eigenfunctions that are.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from fractions import Fraction

from shootstab.formulation.conditions import Axis, CoupledEnd
from shootstab.formulation.expression import VARIABLE, Expression, Z, number
from shootstab.formulation.statement import Statement
from shootstab.formulation.substitution import substituted
from shootstab.formulation.system import EquationRow, degree
from shootstab.formulation.vanishing import Vanishing

MOST_SIGNS = 12  # chosen: unknowns of which all combinations of signs are tried


def mirror_signs(statement: Statement) -> tuple[Fraction, dict[str, int]] | None:
    """m and the sign of every unknown, the first one's being 1; None where the problem has no such mirror.

    It is looked for in the middle of the domain, and on the whole line at 0; not in layers, and not where a function is no formula.
    """
    rows, names = statement.system.rows, statement.names.unknowns
    held = [c for row in (*rows, *(row for _, row in (*statement.left_rows, *statement.right_rows))) for c in row.values()]
    plain = all(atom.kind not in ("given", "parameter") for c in held for atom in c.atoms())
    if statement.joints or statement.base is not None or not plain or len(names) > MOST_SIGNS:
        return None
    middle = _middle(statement)
    if middle is None:
        return None
    mirrored = number(2 * middle) - Z
    vanishing = statement.domain.vanishing
    images = [_image(row, mirrored) for row in rows]
    ends = [row for _, row in statement.left_rows], [row for _, row in statement.right_rows]
    turned = [_image(row, mirrored) for row in ends[0]]
    for others in itertools.product((1, -1), repeat=len(names) - 1):
        signs = dict(zip(names, (1, *others), strict=True))
        same = all(_same(image, row, signs, vanishing) for image, row in zip(images, rows, strict=True))
        if same and len(turned) == len(ends[1]) and _each_among(turned, ends[1], signs, vanishing):
            return middle, signs
    return None


def _middle(statement: Statement) -> Fraction | None:
    left, right = statement.domain.left, statement.domain.right
    if isinstance(statement.left, Axis | CoupledEnd) or isinstance(statement.right, Axis):
        return None
    if math.isinf(left) and math.isinf(right):
        return Fraction(0)
    return None if math.isinf(left) or math.isinf(right) else (Fraction(repr(left)) + Fraction(repr(right))) / 2


def _image(row: EquationRow, mirrored: Expression) -> EquationRow:
    """The row with (−1)^k c(2m − z) in place of c."""
    return {(name, k): number((-1) ** k) * substituted(c, VARIABLE, mirrored) for (name, k), c in row.items()}


def _same(image: EquationRow, row: EquationRow, signs: dict[str, int], vanishing: Vanishing) -> bool:
    """Whether s_j times the image is the row times a factor: a function of z, or where each coefficient holds the eigenvalue 1 or −1."""
    if image.keys() != row.keys():
        return False
    signed = {at: number(signs[at[0]]) * c for at, c in image.items()}
    at_hand = next((at for at in sorted(row) if not degree(row[at]) and not degree(signed[at])), None)
    factors = [(number(1), number(sign)) for sign in (1, -1)] if at_hand is None else [(row[at_hand], signed[at_hand])]
    return any(all(vanishing(below * signed[at] - above * c) for at, c in row.items()) for below, above in factors)


def _each_among(images: Sequence[EquationRow], rows: Sequence[EquationRow], signs: dict[str, int], vanishing: Vanishing) -> bool:
    """Whether every condition at one end becomes one at the other."""
    return all(any(_same(image, row, signs, vanishing) for row in rows) for image in images)
