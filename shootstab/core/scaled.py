"""Numbers that neither overflow nor underflow: a mantissa and the logarithm of a scale."""

from __future__ import annotations

import cmath
import math
import sys
from dataclasses import dataclass

EPSILON = sys.float_info.epsilon  # exact: the distance of 1 to the next double, 2^−52


@dataclass(frozen=True)
class Scaled:
    """mantissa · exp(log_scale), with log_scale real."""

    mantissa: complex
    log_scale: float

    @property
    def log_abs(self) -> float:
        """ln |x|; −∞ for zero."""
        size = abs(self.mantissa)
        return self.log_scale + math.log(size) if size > 0.0 else -math.inf

    @property
    def phase(self) -> float:
        """arg x in (−π, π]."""
        return cmath.phase(self.mantissa)

    def over(self, other: Scaled) -> complex:
        """x/other as a complex number; may overflow to infinity when the ratio does."""
        ratio = self.mantissa / other.mantissa
        exponent = self.log_scale - other.log_scale
        return ratio * math.exp(exponent) if exponent < 700.0 else complex(math.inf, 0.0)

    def at_scale(self, log_scale: float) -> complex:
        """The mantissa that x has at another scale."""
        return self.mantissa * math.exp(min(self.log_scale - log_scale, 700.0))
