"""Problems of the user's own: a pencil and what holds at its ends, written down as plain functions and arrays."""

from __future__ import annotations

from shootstab.problems.ends import Infinity, Interface, Wall
from shootstab.problems.linear_problem import LinearProblem, problem

__all__ = ["Infinity", "Interface", "LinearProblem", "Wall", "problem"]
