"""How a layer comes to its limit: all of the flow beyond a place, from its state there (theory, lemma E19).

With |p_i| ≤ P there, W a ball of radius r about w, λ = min Re(f a_i + c_i) − max |q_i|/P on W and |p_i| ≤ P, Re φ a_i ≥ 0 on W, λ > 0 and
P/λ < r: |p_i| ≤ P e^{−λx} at a distance x and |w_i − w_i(0)| ≤ P/λ from then on.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from shootstab.core.balls import acb, arb
from shootstab.core.errors import ConvergenceError
from shootstab.formulation.atoms import Atom
from shootstab.formulation.boundary_layer_form import BoundaryLayerForm
from shootstab.formulation.enclosed import NOWHERE
from shootstab.formulation.expression import Expression, Monomial
from shootstab.formulation.flow_fields import FlowFields
from shootstab.formulation.system import Jet
from shootstab.multiprecision.enclosable import ball
from shootstab.multiprecision.tailed_series import widened
from shootstab.multiprecision.tails import largest

ARRIVAL_ROOM, ARRIVAL_ATTEMPTS = 2, 3  # chosen: r over P/λ, and radii that are tried
LEAST_FALLING = 2.0**-1000  # chosen: a P that is not zero, whatever the state


@dataclass(frozen=True, eq=False)
class FlowArrival:
    """state holds, for all of the flow beyond the place, f(0), w and p; rate is λ, moved P/λ, flown the w_i(∞), all balls."""

    form: BoundaryLayerForm
    state: Sequence[Any]
    rate: Any
    moved: Any
    flown: list[Any]

    @property
    def defects(self) -> list[Any]:
        """w_i(∞) − W_i."""
        return [w - ball(W) for w, W in zip(self.flown, self.form.limits, strict=True)]

    def on(self, z: Any) -> Callable[[str, int], Any]:
        """See enclosed.FlowInBalls: functions by name and order, everywhere beyond; f itself grows, and is no number."""
        return self._jet

    def _jet(self, name: str, order: int) -> Any:
        form, at = self.form, (name, order)
        if at in form.flow.states:
            return NOWHERE if form.flow.states.index(at) == form.carrier else self._values[at]
        if (name, order - 1) == form.flow.states[form.carrier]:
            return self._fields.evaluator(form.drift)
        expression, at_place = form.flow.higher(name, order), self._fields.evaluator
        quiet = Expression({m: c for m, c in expression.terms.items() if not self._carried(m)})
        carried = expression - quiet
        value, speed = acb(at_place(carried)), abs(at_place(form.drift)).upper()
        slow = self._steepness(carried) * speed <= self.rate * abs(self.state[form.carrier]).lower()
        if slow and value.mid() == 0:  # every term has a factor that is a ball about 0, so that none cancels another
            return value + acb(at_place(quiet))
        raise ConvergenceError(f"d({name},{order}) of the base flow is not enclosed beyond its last step: take more bits")

    @property
    def _values(self) -> dict[Jet, Any]:
        return dict(zip(self.form.flow.states, self.state, strict=True))

    @cached_property
    def _fields(self) -> FlowFields:
        """Values with f(0) in place of f."""
        return FlowFields(self.form.flow, self._values)

    def _carried(self, monomial: Monomial) -> bool:
        """Whether it holds f, or what is made of f."""
        states, f = self.form.flow.states, self.form.flow.states[self.form.carrier]
        jets = [(atom.name, atom.order) for atom, _ in monomial if atom.kind == "given"]
        return any(jet == f or (jet not in states and jet != (f[0], f[1] + 1)) for jet in jets)

    def _steepness(self, expression: Expression) -> int:
        """The largest m of terms f^m times something that falls with e^{−λx}. Raises ConvergenceError for other terms."""
        form, steepest = self.form, 0
        f = Atom("given", *form.flow.states[form.carrier])
        w = {Atom("given", *form.flow.states[i]) for i in form.settling}
        slope = Atom("given", f.name, f.order + 1)
        for monomial in expression.terms:
            m, falls = 0, False
            for atom, e in monomial:
                if atom == f:
                    m += int(e)
                elif atom.kind == "given" and atom not in w and atom != slope:
                    falls = True
                    if (atom.name, atom.order) not in form.flow.states:
                        m += int(e) * self._steepness(form.flow.higher(atom.name, atom.order))
            if not falls:
                raise ConvergenceError("a derivative of the base flow does not die away")
            steepest = max(steepest, m)
        return steepest


def arrival(form: BoundaryLayerForm, state: Sequence[Any]) -> FlowArrival | None:
    """What is known of the flow beyond a state, balls; None where it is not seen to come to a limit from there."""
    most = largest([abs(state[j]) for j in form.falling])
    if not most.is_finite():
        return None
    P = most.max(arb(LEAST_FALLING))
    moved = arb(0)
    for _ in range(ARRIVAL_ATTEMPTS):
        r = ARRIVAL_ROOM * moved
        known = [widened(acb(x), r) if i in form.settling else acb(x) for i, x in enumerate(state)]
        known = [widened(acb(0), P) if i in form.falling else x for i, x in enumerate(known)]
        at = FlowFields(form.flow, dict(zip(form.flow.states, known, strict=True))).evaluator
        drift, f = acb(at(form.drift)), acb(state[form.carrier])
        rates = [acb(at(a)) for a, _ in form.damping]
        falls = [(f * a + acb(at(c))).real.lower() for a, (_, c) in zip(rates, form.damping, strict=True)]
        if not all((drift * a).real >= 0 and fall.is_finite() for a, fall in zip(rates, falls, strict=True)):
            return None
        rate = min(falls) - largest([abs(acb(at(q))) for q in form.products]) / P
        if not rate > 0:
            return None
        moved = (P / rate).upper()
        if moved < r:
            flown = [widened(acb(state[i]), moved) for i in form.settling]
            real = all(acb(x).imag.is_zero() for x in state)
            held = [acb(x.real) for x in known] if real else known
            return FlowArrival(form, held, rate.lower(), moved, [acb(x.real) for x in flown] if real else flown)
    return None


def pulled_arrival(form: BoundaryLayerForm, state: Sequence[Any]) -> FlowArrival | None:
    """The same for real flows that are pulled to their limit and come to it (theory, lemma E23); None where that is not shown."""
    assert form.pull is not None
    ((place,), (falling,), (limit,)) = form.settling, form.falling, form.limits
    V, P = abs(state[place] - ball(limit)).upper(), abs(state[falling]).upper()
    known = [arb(0, P) if i == falling else ball(limit) + arb(0, V) if i == place else x for i, x in enumerate(state)]
    at = FlowFields(form.flow, {y: acb(x) for y, x in zip(form.flow.states, known, strict=True)}).evaluator
    ((a, c),) = form.damping
    rate = (acb(state[form.carrier]) * at(a) + acb(at(c))).real.lower()
    if not (rate > 0 and (acb(at(form.drift)) * at(a)).real >= 0 and acb(at(form.pull)).real > 0):
        return None
    return FlowArrival(form, [acb(x) for x in known], rate, V, [acb(ball(limit))])
