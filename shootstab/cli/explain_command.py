"""`shootstab explain SCENE`: what the reduction of a scene's equations found."""

from __future__ import annotations

from argparse import Namespace
from typing import TYPE_CHECKING

from shootstab.cli.commands import DONE, answer, loaded

if TYPE_CHECKING:
    from rich.console import RenderableType


def explain(options: Namespace) -> int:
    """Order, states, the continuous spectrum inside, conditions on the states."""
    from shootstab.problems.capabilities import EXPLANATION

    scene = loaded(options.scene)
    lines = EXPLANATION.required(scene.problem)

    def tables() -> list[RenderableType]:
        from shootstab.cli.tables import heading, pairs

        return [heading(scene), pairs(lines)]

    answer(options, {"explanation": [{"heading": heading, "text": text} for heading, text in lines]}, tables, scene)
    return DONE
