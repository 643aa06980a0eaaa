"""Formulas as text: names, numbers, arithmetic and a list of functions, read by a grammar and never evaluated.

    sum      = product {("+" | "-") product}
    product  = sign {("*" | "/") sign}
    sign     = ("+" | "-") sign | power
    power    = item [("**" | "^") sign]
    item     = number ["j"] | name | name "(" sum {"," sum} ")" | "(" sum ")"

An equation may hold one "=", and stands for left minus right. d(f) and d(f, n) are derivatives along the coordinate, i, I and 1j the
imaginary unit, pi is π; decimals are taken exactly. What is wrong is told with the place.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from fractions import Fraction

from shootstab.core.errors import InputError, shortened
from shootstab.formulation.expression import FUNCTIONS, Expression, function, held_kinds, number
from shootstab.formulation.gaussian import ONE, I

TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(?P<unit>[jJ](?!\w))?|(?P<name>[^\W\d]\w*)|(?P<sign>\*\*|[-+*/^(),=]))"
)
LONGEST_FORMULA = 20_000  # chosen: characters of one formula
LONGEST_NUMBER = 1000  # chosen: characters of a number, more than any precision takes
LARGEST_EXPONENT = 400  # chosen: largest exponent of a number in decimal notation: what doubles hold, and more
DEEPEST_NESTING = 60  # chosen: parentheses and signs within each other
MOST_POWER = 64  # chosen: the size of an exponent up to which powers are multiplied out
MOST_DERIVATIVES = 16  # chosen: the order of d(f, n); no equation of physics has a higher one

Scope = Callable[[str], Expression]  # a name's expression; raises KeyError for one that is not known


def read(text: str, where: str, scope: Scope, known: Callable[[], str]) -> Expression:
    """The expression that a formula means; `where` names it in errors, and known() lists the names that are allowed.

    Raises InputError with the place.
    """
    return FormulaReader(text, where, scope, known).equation()


class FormulaReader:
    """One pass over one formula."""

    def __init__(
        self,
        text: str,
        where: str,
        scope: Scope,
        known: Callable[[], str],
        sides: Mapping[str, Scope] | None = None,
        placed: Mapping[str, Callable[[Expression], Expression]] | None = None,
    ) -> None:
        """sides: the scopes of before(f) and behind(f) at an interface, of left(f) and right(f) at coupled ends, where placed takes f
        to its end.
        """
        if not isinstance(text, str):
            raise InputError(f"{where} = {shortened(text)}: allowed is a formula, that is text, a number or an expression of SymPy")
        if len(text) > LONGEST_FORMULA:
            raise InputError(f"{where} has {len(text)} characters: allowed are up to {LONGEST_FORMULA}")
        self._text, self._where, self._scope, self._known = text, where, scope, known
        self._sides, self._placed = sides or {}, placed or {}
        self._sided = False  # whether what is read stands in the parenthesis of a side
        self._tokens = self._split()
        self._at = 0
        self._depth = 0

    def equation(self) -> Expression:
        """The whole text."""
        left = self._sum()
        if self._is("="):
            self._at += 1
            left = left - self._sum()
        if self._kind() != "end":
            raise self._error("allowed is an operator or the end" if self._token() != ")" else "a parenthesis that was never opened")
        return left

    def _sum(self) -> Expression:
        total = self._product()
        while self._is("+", "-"):
            minus = self._next() == "-"
            term = self._product()
            total = total - term if minus else total + term
        return total

    def _product(self) -> Expression:
        total = self._signed()
        while self._is("*", "/"):
            at = self._at
            if self._next() == "*":
                total = total * self._signed()
                continue
            divisor = self._signed()
            if not divisor:
                raise self._error("a division by zero", at)
            if any(atom.kind == "jet" for atom in divisor.atoms()):
                raise self._error("a division by an unknown: the equation is not linear", at)
            total = total / divisor
        return total

    def _signed(self) -> Expression:
        if not self._is("+", "-"):
            return self._power()
        minus = self._next() == "-"
        self._deeper()
        value = self._signed()
        self._depth -= 1
        return -value if minus else value

    def _power(self) -> Expression:
        base = self._item()
        if not self._is("**", "^"):
            return base
        at = self._at
        self._next()
        self._deeper()
        exponent = self._signed()
        self._depth -= 1
        value = exponent.constant
        self._require_power(base, exponent, at)
        try:
            if value is not None and not value.im and -MOST_POWER <= value.re <= MOST_POWER:  # longer ones by the exponential
                return base ** (value.re if Fraction(value.re).denominator > 1 else int(value.re))
            return function("exp", exponent * function("log", base))
        except ZeroDivisionError:
            raise self._error("zero to a negative power", at) from None
        except InputError as error:
            raise self._error(str(error), at) from None

    def _require_power(self, base: Expression, exponent: Expression, at: int) -> None:
        """Raise InputError for a power by which a problem is not linear, or not rational in its eigenvalue."""
        held, value = held_kinds(base, exponent), exponent.constant
        whole = value is not None and not value.im and value.re in range(-MOST_POWER, MOST_POWER + 1)
        if "jet" in held and not (whole and value is not None and value.re >= 0):
            raise self._error(f"a power of an unknown: allowed are natural ones up to {MOST_POWER}", at)
        if "eigenvalue" in held and not whole:
            raise self._error(f"a power of the eigenvalue: allowed are whole ones up to {MOST_POWER}", at)

    def _item(self) -> Expression:
        kind, at = self._kind(), self._at
        if kind == "number":
            return self._number(self._next())
        if kind == "name":
            name = self._next()
            return self._call(name, at) if self._is("(") else self._named(name, at)
        if self._is("("):
            self._next()
            self._deeper()
            value = self._sum()
            self._depth -= 1
            if not self._is(")"):
                raise self._error(f"the parenthesis opened at column {self._column(at)} is not closed here")
            self._next()
            return value
        raise self._error("allowed is a number, a name or a parenthesis")

    def _number(self, token: str) -> Expression:
        imaginary = token[-1] in "jJ"
        digits = token[:-1] if imaginary else token
        if len(digits) > LONGEST_NUMBER:
            raise self._error(f"a number of {len(digits)} characters: allowed are {LONGEST_NUMBER}", self._at - 1)
        exponent = re.search(r"[eE]([+-]?\d+)", digits)
        if exponent and abs(int(exponent[1])) > LARGEST_EXPONENT:
            raise self._error(f"a number out of range: allowed are exponents up to {LARGEST_EXPONENT}", self._at - 1)
        value = number(Fraction(digits))
        return value * number(I) if imaginary else value

    def _named(self, name: str, at: int) -> Expression:
        if name in ("i", "I"):
            return number(I)
        if name in FUNCTIONS or name == "d":
            raise self._error(f"{name} is a function: allowed is {name}(...)", at)
        try:
            return self._scope(name)
        except KeyError:
            raise self._error(f"unknown name {name!r}: allowed are {self._known()}", at) from None

    def _one_sided(self, side: str) -> Expression:
        """What stands in the parenthesis, on one side of an interface or at one of two coupled ends."""
        if self._sided:
            raise self._error(f"{side} of what has a side: allowed is one side")
        outside, self._scope, self._sided = self._scope, self._sides[side], True
        value = self._item()
        self._scope, self._sided = outside, False
        return self._placed[side](value) if self._placed else value

    def _call(self, name: str, at: int) -> Expression:
        if name in self._sides:
            return self._one_sided(name)
        if name == "jump" and "before" in self._sides:
            begin = self._at
            before = self._one_sided("before")
            self._at = begin
            return self._one_sided("behind") - before
        opened = self._at
        self._next()
        self._deeper()
        arguments = [self._sum()]
        while self._is(","):
            self._next()
            arguments.append(self._sum())
        self._depth -= 1
        if not self._is(")"):
            raise self._error(f"the parenthesis opened at column {self._column(opened)} is not closed here")
        self._next()
        if name == "d":
            return self._derivative(arguments, at)
        if name not in FUNCTIONS:
            raise self._error(f"{name!r} is no function: allowed are d, {', '.join(FUNCTIONS)}, and * for products", at)
        if len(arguments) != 1:
            raise self._error(f"{name} has {len(arguments)} arguments: allowed is one", at)
        (argument,) = arguments
        if any(atom.kind in ("jet", "eigenvalue") for atom in argument.atoms()):
            raise self._error(f"{name} of an unknown or of the eigenvalue: the problem is not linear, or not rational in it", at)
        if name == "sqrt":
            return argument ** Fraction(1, 2)
        if name == "log" and not argument:
            raise self._error("log of zero", at)
        return function(name, argument)

    def _derivative(self, arguments: list[Expression], at: int) -> Expression:
        order = arguments[1].constant if len(arguments) == 2 else ONE
        if len(arguments) > 2 or order is None or order.im or not 0 <= order.re <= MOST_DERIVATIVES or order.re != int(order.re):
            raise self._error(f"allowed is d(f) or d(f, n) with n from 0 to {MOST_DERIVATIVES}", at)
        value = arguments[0]
        if self._placed and not self._sided and any(atom.kind == "jet" for atom in value.atoms()):
            raise self._error("a derivative of what is taken at one end: allowed is left(d(f)) or right(d(f))", at)
        for _ in range(int(order.re)):
            value = value.derivative()
        return value

    # tokens

    def _split(self) -> list[tuple[str, str, int]]:
        tokens, at = [], 0
        while self._text[at:].strip():
            found = TOKEN.match(self._text, at)
            if found is None:
                place = at + len(self._text[at:]) - len(self._text[at:].lstrip())
                told = f"the character {self._text[place]!r} has no meaning here: allowed are names, numbers, + - * / ** ( ) , ="
                raise InputError(f"{self._where}, column {place + 1}: {told}")
            kind = str(found.lastgroup if found.lastgroup != "unit" else "number")
            tokens.append((kind, found.group().strip(), found.end() - len(found.group().strip())))
            at = found.end()
        return [*tokens, ("end", "the end", len(self._text))]

    def _kind(self) -> str:
        return self._tokens[self._at][0]

    def _token(self) -> str:
        return self._tokens[self._at][1]

    def _column(self, at: int) -> int:
        return self._tokens[at][2] + 1

    def _is(self, *signs: str) -> bool:
        return self._kind() == "sign" and self._token() in signs

    def _next(self) -> str:
        self._at += 1
        return self._tokens[self._at - 1][1]

    def _deeper(self) -> None:
        self._depth += 1
        if self._depth > DEEPEST_NESTING:
            raise self._error(f"allowed are {DEEPEST_NESTING} parentheses within each other")

    def _error(self, why: str, at: int | None = None) -> InputError:
        place = self._at if at is None else at
        return InputError(f"{self._where}, column {self._column(place)}, at {self._token_at(place)}: {why}")

    def _token_at(self, at: int) -> str:
        kind, token, _ = self._tokens[at]
        return token if kind == "end" else shortened(token)
