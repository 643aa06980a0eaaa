"""The built-in scenes, solved once."""

from __future__ import annotations

from functools import cache

from shootstab.io.scenes import load
from shootstab.models.chute import ChuteProblem

GUESS = {"high": 0.004, "mid": 0.001, "low": 0.0073 - 0.0119j, "fig2": 0.0017 - 0.0016j}


@cache
def problem(name: str) -> ChuteProblem:
    """The chute problem of a built-in scene."""
    found = load(name).problem
    assert isinstance(found, ChuteProblem)
    return found
