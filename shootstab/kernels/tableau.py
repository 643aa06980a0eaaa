"""The explicit Runge–Kutta pair 8(5,3) of Dormand & Prince, as data.

Taken from SciPy's public `DOP853` (Hairer, Nørsett & Wanner, Solving Ordinary Differential Equations I, 2nd ed., II.5); the tests prove
its order conditions. Twelve stages: stage i sits at z + C[i] h, and E5, E3 weigh the stages into two error estimates.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DOP853


def _frozen(a: NDArray[np.float64]) -> NDArray[np.float64]:
    copy = np.array(a, dtype=np.float64)
    copy.flags.writeable = False
    return copy


STAGES, ORDER = 12, 8  # published (Hairer, Nørsett & Wanner 1993): of the pair of orders 8(5, 3)
A = _frozen(DOP853.A)
B = _frozen(DOP853.B)
C = _frozen(DOP853.C)
E5 = _frozen(DOP853.E5[:STAGES])
E3 = _frozen(DOP853.E3[:STAGES])
WEIGHTS = _frozen(np.stack((B, E5, E3)))  # of the stages: in the step, and in its two error estimates
