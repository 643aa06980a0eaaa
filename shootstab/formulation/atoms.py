"""The factors that monomials are made of."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

Exponent = int | Fraction


class Atom:
    """A factor: kind is variable, eigenvalue, constant, parameter, jet, function, given or base; order counts derivatives of a jet or a
    given one.

    argument is the expression that a function or a base is taken of, and the number that a parameter stands for where none is given.
    """

    __slots__ = ("argument", "hash", "key", "kind", "name", "order")

    def __init__(self, kind: str, name: str, order: int = 0, argument: Any = None) -> None:
        self.kind, self.name, self.order, self.argument = kind, name, order, argument
        self.key = f"{kind}:{name}:{order:03d}:{argument.key if argument is not None else ''}"
        self.hash = hash(self.key)

    def __hash__(self) -> int:
        return self.hash

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Atom) and self.hash == other.hash and self.key == other.key

    def __lt__(self, other: Atom) -> bool:
        return self.key < other.key

    def __str__(self) -> str:
        if self.kind in ("function", "base"):
            return f"{self.name}({self.argument})"
        if not self.order:
            return self.name
        return f"d({self.name})" if self.order == 1 else f"d({self.name},{self.order})"
