"""Base flows that are off by a known amount: what their error does to a mode is measured on them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def off_by(numbers: NDArray[np.float64], relative: float) -> NDArray[np.float64]:
    """The numbers (…, m), each changed by a random relative amount, always the same one, no larger than this."""
    return np.asarray(numbers * (1 + relative * (2 * np.random.default_rng(1).random(numbers.shape) - 1)))
