"""How accurately to compute: everything that the error bound raises once, in one place."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

STEP_SHRINK = 1.5  # derived: a step is about e^−1.5 of the radius of convergence: cheapest per length when a product costs order²
GUARD_DIGITS = 8  # chosen: digits that recurrences and eliminations may eat
LIMIT_SLACK = 0.02  # chosen: log2 of how far below its limit a step stays, so that rounding does not take it over
DIGITS_OF_LIMB = 17  # derived: LIMB_BITS of kernels.limbs, so that series in limbs have one more
FARTHER_PART = 12  # chosen: one more term of the far field for so many, and a few
FINER_PART = 6  # chosen: one more term for so many; half of these left one of 1,435 problems two thirds of its error, these none of 1,332
FINER_DIGITS = 6  # chosen: more digits of truncation, which keep the longer series from longer steps: with 3 they did not


@dataclass(frozen=True)
class Settings:
    """digits: the working precision. tolerance: decimal digits that truncation leaves; order: terms of a Taylor step; far_tolerance
    and far_terms likewise for the far field, and far_shift, by how many powers of two its start lies farther out than need be.
    """

    digits: int
    tolerance: float
    order: int
    far_tolerance: float
    far_terms: int
    far_shift: float = 0.0

    @staticmethod
    def of(digits: float) -> Settings:
        """The settings for so many digits of D."""
        order = math.ceil(digits * math.log(10) / STEP_SHRINK) + 6
        return Settings(math.ceil(digits) + GUARD_DIGITS, digits, order, digits, 5 * order // 4)

    def more_precise(self) -> Settings:
        """The settings with a higher working precision and nothing else."""
        return replace(self, digits=self.digits + DIGITS_OF_LIMB)

    def finer(self) -> Settings:
        """The settings with a higher order and shorter steps."""
        return replace(self, tolerance=self.tolerance + FINER_DIGITS, order=self.order + max(8, self.order // FINER_PART))

    def with_loss(self, lost: float) -> Settings:
        """The settings in which as much is left after so many digits have been lost on the way."""
        more = max(0, math.ceil(lost))
        order = self.order + math.ceil(more * math.log(10) / STEP_SHRINK)
        return replace(self, digits=self.digits + more, tolerance=self.tolerance + more, order=order)

    def farther(self) -> Settings:
        """The settings with more terms in the far field and a start farther out."""
        terms = self.far_terms + max(8, self.far_terms // FARTHER_PART)
        return replace(self, far_tolerance=self.far_tolerance + 3, far_terms=terms, far_shift=1.0)


def step_limit(last: list[float], terms: int, scale: float, tolerance: float) -> float:
    """log2 of the x at which the last of so many terms c_m x^m have shrunk to 10^−tolerance of the scale.

    last are log2 |c_m| of the last TAIL_TERMS terms, scale the log2 of what they are compared with. The very last terms of a series
    may vanish by parity, therefore several are asked.
    """
    aim = scale - tolerance * math.log2(10)
    orders = range(max(1, terms - len(last)), terms)
    return min(((aim - log) / m for m, log in zip(orders, last[-len(orders) :], strict=True) if log > -math.inf), default=math.inf)
