"""Error bounds on a zero of D, each part measured: how far does the zero move when one thing is done otherwise?"""

from __future__ import annotations

import math
import sys

from shootstab.discriminants.protocol import Discriminant, Examinable, Value
from shootstab.problems.protocol import Problem
from shootstab.vocabulary.records import Budget

HALVING = 12.0  # of the 2^8 that halving the steps gains, what is counted on
FLOW_FACTOR = 1e3  # by which the base flow is computed less accurately
FLOW_GAIN = 100.0  # of that factor, what is counted on
PROBE = 1e-7  # relative change of the far frame by which its influence is measured
SAFETY = 3.0  # on what a random sample of the far frame shows
NOISE = 12.0  # on what three random samples of rounding show: calibrated (validation/calibration.py)
EPSILON = sys.float_info.epsilon


def displacement(variant: Discriminant, value: Value) -> float:
    """How far the zero of a variant lies from that of D, whose value at a σ next to its zero is given: |ΔD/D′|."""
    other = variant(value.sigma)
    scale = max(other.log_scale, value.D.log_scale)
    derivative = value.dD * math.exp(value.D.log_scale - scale)
    return abs((other.at_scale(scale) - value.D.at_scale(scale)) / derivative) if derivative != 0.0 else math.inf


def budget(problem: Problem, coarse: Examinable, coarse_value: Value, fine: Examinable, fine_value: Value, root: float) -> Budget:
    """The parts of the bound on the zero of the finer discriminant, whose last Newton step had length root; both values are taken there."""
    sigma = fine_value.sigma
    integration = abs(coarse_value.newton_step - fine_value.newton_step) / HALVING
    far = SAFETY * displacement(coarse.jiggled(1, PROBE), coarse_value) / PROBE * coarse.far_error
    crude = problem.cruder(FLOW_FACTOR)
    flow = 0.0 if crude is problem else displacement(coarse.of(crude), coarse_value) / FLOW_GAIN
    others = fine.turned(1), fine.turned(2), coarse.refined(seed=1)
    rounding = NOISE * max(displacement(other, fine_value) for other in others) + 8 * EPSILON * abs(sigma)
    return Budget(integration, far, flow, root, rounding)
