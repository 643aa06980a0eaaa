"""The functions of a base flow in balls, from its states: numbers, or series with tails."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from shootstab.formulation.base_flow import BaseFlow
from shootstab.formulation.enclosed import NOWHERE, on_balls
from shootstab.formulation.evaluation import Evaluator
from shootstab.formulation.system import Jet


@dataclass(frozen=True, eq=False)
class FlowFields:
    """See enclosed.FlowInBalls: values are those of the states; derivatives that are none follow from the equations, which hold no
    coordinate.
    """

    flow: BaseFlow
    values: Mapping[Jet, Any]

    def on(self, z: Any) -> Callable[[str, int], Any]:
        """The functions by name and order, wherever z is."""
        known = dict(self.values)

        def given(name: str, order: int) -> Any:
            if (name, order) not in known:
                known[name, order] = at(self.flow.higher(name, order))
            return known[name, order]

        at = on_balls(NOWHERE, {}, _FieldsAlone(given))
        return given

    @property
    def evaluator(self) -> Evaluator:
        """Expressions of the flow."""
        return on_balls(NOWHERE, {}, self)


@dataclass(frozen=True, eq=False)
class _FieldsAlone:
    given: Callable[[str, int], Any]

    def on(self, z: Any) -> Callable[[str, int], Any]:
        return self.given
