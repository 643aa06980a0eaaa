"""The size of a step's error, and the length that the next one may have, for every integration by the pair of `tableau`."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from shootstab.kernels.tableau import ORDER

FLOOR = 1e-9  # chosen: part of the largest row; smaller rows count as so large
MARGIN = 0.9  # chosen: part of the step that would just meet the tolerance; without it every other step is rejected
SHARE_OF_THIRD = 0.01  # published: part of the estimate of order 3 in (10.18)


@njit(cache=True, error_model="numpy", inline="always")
def local_error(fifth, third):  # type: ignore[no-untyped-def]
    """e5/√(e5 + e3/100) of the squares of the estimates of order 5 and 3: Hairer, Nørsett & Wanner, II.10, (10.18). 0 if e5 is 0."""
    return 0.0 if fifth == 0.0 else fifth / np.sqrt(fifth + SHARE_OF_THIRD * third)


def factor(error: Any) -> Any:
    """The factor on the length of steps with these errors, in the tolerance: MARGIN · error^(−1/ORDER)."""
    return MARGIN * error ** (-1.0 / ORDER)


step_factor = njit(cache=True, error_model="numpy", inline="always")(factor)
