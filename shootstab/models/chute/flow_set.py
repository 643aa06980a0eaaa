"""Sets of steady flows on their way down, carried by the derivative of the flow map: a box is not wrapped into a wider one at every step.

A set is y ∈ ȳ + S r, ȳ one state, S a matrix, r a box. The flow from any of its states differs from that of ȳ by V(t) (y − ȳ): V holds the
derivative by the initial state of every flow that begins in the hull (theory, lemma C6), in a few digits, while ȳ is known in all.
After a step S is made orthogonal anew, the widest direction first (R. J. Lohner, Computing Supplementum 6 (1988) 25).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from shootstab.core.balls import acb, arb, arb_mat
from shootstab.core.series import Series
from shootstab.models.chute.balance import slopes
from shootstab.models.chute.multiprecision_flow import FLUX
from shootstab.models.chute.parameters import Chute
from shootstab.multiprecision.tailed_pencil import TailedPencil
from shootstab.multiprecision.tailed_series import TailedSeries

TailedFields = tuple[TailedSeries, ...]  # ν, T, u, Q and Φ, u without u_∞
STATES = 5  # exact: their number
NU, T, U, Q, _ = range(STATES)  # exact: their places


@dataclass(frozen=True, eq=False)
class FlowSet:
    """ȳ (5,) exact, S (5, 5) exact, r (5,) balls."""

    middle: list[Any]
    frame: Any
    box: list[Any]

    @staticmethod
    def about(state: Sequence[Any]) -> FlowSet:
        """The box of these balls."""
        middle = [x.mid() for x in state]
        identity = arb_mat([[int(i == j) for j in range(STATES)] for i in range(STATES)])
        return FlowSet(middle, identity, [x - m for x, m in zip(state, middle, strict=True)])

    @property
    def hull(self) -> list[Any]:
        """Balls (5,) that hold it."""
        return [m + x for m, x in zip(self.middle, _applied(self.frame, self.box), strict=True)]

    def spread(self, thin: TailedFields, derivative: FlowDerivative) -> TailedFields:
        """The fields of all flows that begin here from those of the one at ȳ."""
        moved = [_applied(V * self.frame, self.box) for V in derivative.terms]
        far = sum((abs(x) for x in _applied(self.frame, self.box)), arb(0))
        out = []
        for i, y in enumerate(thin):
            rest = derivative.tail[i] * far  # no coefficient behind those of V differs by more, nor all of them together
            c = [*y.c, *([acb(0)] * (y.terms - len(y.c)))]
            moves = [*(x[i] for x in moved), *([arb(0, rest.upper())] * (y.terms - len(moved)))]
            out.append(TailedSeries([acb(a + b) for a, b in zip(c, moves, strict=True)], y.terms, y.tail + rest, True))
        return tuple(out)

    def carried(self, thin: TailedFields, derivative: FlowDerivative) -> FlowSet:
        """The set at the end of a step."""
        end = [y.at(1).real for y in thin]
        middle = [x.mid() for x in end]
        rest = [x - m for x, m in zip(end, middle, strict=True)]
        moved = derivative.at_end * self.frame
        frame = _frame(moved, self.box, rest)
        back = frame.inv()
        box = [a + b for a, b in zip(_applied(back * moved, self.box), _applied(back, rest), strict=True)]
        return FlowSet(middle, frame, box)


@dataclass(frozen=True, eq=False)
class FlowDerivative:
    """V(t) = ∂y(t)/∂y(0) on a step, of all flows that lie in some fields: terms V_m (5, 5) and the bounds (5,) of the rows of the rest."""

    terms: list[Any]
    tail: list[Any]

    @staticmethod
    def along(chute: Chute, fields: TailedFields, h: Any) -> FlowDerivative | None:
        """V from fields that hold all these flows on a step of length h; None where it is not bounded."""
        nu, temperature, u, q, _ = fields
        nothing, one = nu * 0, nu * 0 + acb(1)
        rows: dict[tuple[int, int], Any] = {(FLUX, NU): -u, (FLUX, U): -nu}
        for column in (NU, T, Q):
            x, y, w = (Series((y, one if place == column else nothing)) for place, y in ((NU, nu), (T, temperature), (Q, q)))
            decay, T_z, u_z, Q_z = slopes(x, y, w, chute.ep, chute.tan_theta, chute.radial_law, arb.pi())
            for row, f in ((NU, x * decay), (T, T_z), (U, u_z), (Q, Q_z)):
                rows[row, column] = f[1]
        identity = {(i, i): one for i in range(STATES)}
        found = TailedPencil(STATES, [identity], [{at: y * h for at, y in rows.items()}], nu.terms).expansion(acb(0))
        if found is None:
            return None
        terms = [arb_mat([[acb(x).real for x in row] for row in term]) for term in found[0]]
        return FlowDerivative(terms, found[1])

    @property
    def at_end(self) -> Any:
        """V(1)."""
        total = sum(self.terms[1:], self.terms[0])
        return arb_mat([[x + arb(0, tail) for x in row] for row, tail in zip(total.tolist(), self.tail, strict=True)])


def _frame(moved: Any, box: Sequence[Any], rest: Sequence[Any]) -> Any:
    """An orthogonal matrix up to a scale for each row, from doubles: any invertible one would do."""
    widths = np.array([float(x.rad()) + abs(float(x.mid())) for x in box])
    columns = np.array([[float(x.mid()) for x in row] for row in moved.tolist()]) * widths
    scale = np.abs(columns).sum(axis=1) + np.array([float(abs(x).upper()) for x in rest])
    if not (np.isfinite(scale).all() and (scale > 0.0).all()):
        return arb_mat([[int(i == j) for j in range(STATES)] for i in range(STATES)])
    scaled = columns / scale[:, None]
    order = np.argsort(-np.linalg.norm(scaled, axis=0))
    orthogonal = np.linalg.qr(scaled[:, order])[0] * (scale / scale.max())[:, None]
    return arb_mat([[arb(x) for x in row] for row in orthogonal.tolist()])


def _applied(A: Any, x: Sequence[Any]) -> list[Any]:
    return [row[0] for row in (A * arb_mat([[value] for value in x])).tolist()]
