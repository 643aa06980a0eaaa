"""Formulas in the spelling of Dedalus' scripts, as text in this language: see dedalus_table.py.

A substitution with arguments is put in by its text, in parentheses; one without is a definition and keeps its name. d and the coordinate's
name in one is the derivative, lift(tau, n) is 0, and f(x=0), left(f), right(f) and interp(f, x=0) are values at an end.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from shootstab.core.errors import InputError
from shootstab.formulation.grammar import DEEPEST_NESTING, LONGEST_FORMULA, TOKEN

LIFTS = ("lift", "Lift", "LiftTau")  # chosen: the names that scripts give to the operator of tau terms
# chosen: operators of vectors and tensors, and means, that have no meaning for one component along one coordinate
NOT_READ = ("grad", "div", "lap", "curl", "trace", "trans", "transpose", "dot", "cross", "skew", "radial", "angular", "integ", "ave")
MOST_NESTED = 40  # chosen: substitutions within each other
END_NAMES = ("left", "right")
Substitution = tuple[tuple[str, ...] | None, str]  # the names of arguments, None without parentheses, and what it stands for


@dataclass(frozen=True)
class Translated:
    """A formula in this language, and the ends at which what it holds is taken."""

    text: str
    sides: frozenset[str]


@dataclass
class Script:
    """The names of a script; lifted are the variables found in tau terms so far."""

    variables: Sequence[str]
    coordinate: str
    bounds: Sequence[Any]
    substitutions: Mapping[str, Substitution]
    parameters: Mapping[str, Any]
    lifted: set[str] = field(default_factory=set)

    @cached_property
    def along(self) -> set[str]:
        """The names of what varies along the coordinate."""
        bodies = {name: set(_tokens(body, f"the substitution {name}")) for name, (_, body) in self.substitutions.items()}
        found = {*self.variables, self.coordinate}
        while more := {name for name, held in bodies.items() if held & found} - found:
            found |= more
        return found

    def translated(self, formula: str, where: str) -> Translated:
        """Raises InputError with the place."""
        if len(formula) > LONGEST_FORMULA:
            raise InputError(f"{where} has {len(formula)} characters: allowed are up to {LONGEST_FORMULA}")
        reader = ScriptReader(self, _tokens(formula, where), where, {}, 0, set())
        text = reader.rest()
        if not reader.sides:
            return Translated(text, frozenset())
        for name in reader.outside:
            raise InputError(f"{where}: {name} stands beside values at an end, but at none itself: allowed are values at the ends alone")
        if len(reader.sides) == 1:
            (side,) = reader.sides
            text = re.sub(rf"\b{side}\(", "(", text)
        return Translated(text, frozenset(reader.sides))


class ScriptReader:
    """One pass over the tokens of one formula, or of what a substitution stands for; arguments are texts by name."""

    def __init__(self, script: Script, tokens: list[str], where: str, arguments: Mapping[str, str], depth: int, sides: set[str]) -> None:
        self._script, self._tokens, self._where, self._arguments, self._depth = script, tokens, where, arguments, depth
        self._at, self.sides, self._nested = 0, sides, 0
        self.outside: list[str] = []  # what varies along the coordinate outside of values at an end
        if depth > MOST_NESTED:
            raise InputError(f"{where}: substitutions within each other, deeper than {MOST_NESTED}: allowed are ones that end")

    def rest(self, *ends: str) -> str:
        """The text up to one of these tokens outside of parentheses, or the end. Raises InputError where it is too long, or too deep."""
        out: list[str] = []
        self._nested += 1
        if self._nested > DEEPEST_NESTING:
            raise InputError(f"{self._where}: allowed are {DEEPEST_NESTING} parentheses within each other")
        while self._at < len(self._tokens) and self._tokens[self._at] not in ends:
            token = self._tokens[self._at]
            if token == ")":
                raise InputError(f"{self._where}: a parenthesis that was never opened")
            out.append(self._primary() if token == "(" or _is_name(token) else self._next())
            if sum(map(len, out)) > LONGEST_FORMULA:
                raise InputError(f"{self._where}: with its substitutions it has over {LONGEST_FORMULA} characters: allowed are fewer")
        self._nested -= 1
        return " ".join(out)

    def _primary(self) -> str:
        """A name, a call or a parenthesis, and the place in parentheses behind it."""
        begin = len(self.outside)
        token = self._next()
        text = f"({self._inside()})" if token == "(" else self._named(token)
        if self._place_follows():
            self._next()
            side = self._side()
            del self.outside[begin:]
            self.sides.add(side)
            return f"{side}({text})"
        return text

    def _named(self, name: str) -> str:
        script = self._script
        called = self._at < len(self._tokens) and self._tokens[self._at] == "(" and not self._place_follows()
        if called and name in NOT_READ and name not in script.substitutions:
            told = "an operator that is not read: allowed are components, with substitutions such as dx(A)"
            raise InputError(f"{self._where}: {name} is {told}")
        if not called:
            if name in self._arguments:
                return self._arguments[name]
            if name in script.along:
                self.outside.append(name)
            return name
        self._next()
        begin = len(self.outside)
        if name in LIFTS:
            words = [self._tokens[self._at]] if self._at < len(self._tokens) else []
            script.lifted.update(word for word in words if word in script.variables)
            self._arguments_here()
            return "0"
        if name in END_NAMES or name == "interp":
            text = self.rest(",", ")")
            side = name if name in END_NAMES else self._side_behind_comma()
            if name in END_NAMES:
                self._close()
            del self.outside[begin:]
            self.sides.add(side)
            return f"{side}({text})"
        given = self._arguments_here()
        if name == f"d{script.coordinate}":
            if len(given) != 1:
                raise InputError(f"{self._where}: {name} has {len(given)} arguments: allowed is one")
            return f"d({given[0]})"
        if name not in script.substitutions:
            return f"{name}({', '.join(given)})"
        names, body = script.substitutions[name]
        if names is None or len(names) != len(given):
            raise InputError(f"{self._where}: {name} has {len(given)} arguments: allowed are {len(names or ())}")
        inner = ScriptReader(
            script,
            _tokens(body, f"the substitution {name}"),
            f"{self._where}, in the substitution {name}",
            dict(zip(names, (f"({text})" for text in given), strict=True)),
            self._depth + 1,
            self.sides,
        )
        text = inner.rest()
        self.outside += inner.outside
        return f"({text})"

    def _arguments_here(self) -> list[str]:
        """The arguments up to the parenthesis that closes."""
        found = [self.rest(",", ")")]
        while self._at < len(self._tokens) and self._tokens[self._at] == ",":
            self._next()
            found.append(self.rest(",", ")"))
        self._close()
        return found

    def _inside(self) -> str:
        text = self.rest(")")
        self._close()
        return text

    def _close(self) -> None:
        if self._at >= len(self._tokens) or self._next() != ")":
            raise InputError(f"{self._where}: a parenthesis is not closed")

    def _place_follows(self) -> bool:
        """Whether (coordinate = …) stands here."""
        return self._tokens[self._at : self._at + 3] == ["(", self._script.coordinate, "="]

    def _side_behind_comma(self) -> str:
        if self._at >= len(self._tokens) or self._next() != ",":
            raise InputError(f"{self._where}: interp without a place: allowed is interp(f, {self._script.coordinate}=...)")
        return self._side()

    def _side(self) -> str:
        """The end that `coordinate = place)` names."""
        script = self._script
        words = []
        while self._at < len(self._tokens) and self._tokens[self._at] != ")":
            words.append(self._next())
        self._close()
        place = "".join(words).removeprefix(f"{script.coordinate}=")
        for side, bound in zip(END_NAMES, script.bounds, strict=True):
            if place == str(bound) or _value(place, script.parameters) == bound:
                return side
        raise InputError(f"{self._where}: {script.coordinate}={place} is no end: allowed are {script.bounds[0]} and {script.bounds[1]}")

    def _next(self) -> str:
        self._at += 1
        return self._tokens[self._at - 1]


def _tokens(text: str, where: str) -> list[str]:
    found, at = [], 0
    while text[at:].strip():
        match = TOKEN.match(text, at)
        if match is None:
            sign = text[at:].strip()[0]
            raise InputError(f"{where}: the character {sign!r} has no meaning here: allowed are names, numbers, + - * / ** ( ) , =")
        found.append(match.group().strip())
        at = match.end()
    return found


def _is_name(token: str) -> bool:
    return token[0].isalpha() or token[0] == "_"


def _value(place: str, parameters: Mapping[str, Any]) -> float | None:
    """The number that a place is, a sign and a number or the name of a parameter; None for anything else."""
    sign, word = (-1, place[1:]) if place.startswith("-") else (1, place.removeprefix("+"))
    if isinstance(parameters.get(word), int | float):
        return sign * float(parameters[word])
    try:
        return sign * float(word)
    except ValueError:
        return None
