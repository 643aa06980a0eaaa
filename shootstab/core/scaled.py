"""Numbers that neither overflow nor underflow: a mantissa and the logarithm of a scale."""

from __future__ import annotations

import cmath
import math
import sys
from dataclasses import dataclass

EPSILON = sys.float_info.epsilon  # exact: the distance of 1 to the next double, 2^−52
LARGEST_LOG = 700.0  # derived: exp of it is a double with room for a mantissa, the largest of which is exp(709.78)
TINY = 1e-300  # chosen: what stands for 0 where a double divides, below every size that occurs


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
        return ratio * math.exp(exponent) if exponent < LARGEST_LOG else complex(math.inf, 0.0)

    def at_scale(self, log_scale: float) -> complex:
        """The mantissa that x has at another scale."""
        return self.mantissa * math.exp(min(self.log_scale - log_scale, LARGEST_LOG))
