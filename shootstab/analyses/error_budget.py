"""Error bounds on a zero of D, each part measured: how far does the zero move when one thing is done otherwise?"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from shootstab.core.discriminant import Discriminant, Value
from shootstab.core.records import Budget
from shootstab.core.scaled import EPSILON
from shootstab.discriminants.method import MeshedDiscriminant
from shootstab.discriminants.zero_gradient import ZeroGradient
from shootstab.kernels.tableau import ORDER
from shootstab.problems.capabilities import FARTHER_WALLS
from shootstab.problems.protocol import ComplexArray, Problem

HALVING: float = 2.0 ** (ORDER / 2) - 1.0  # derived: Richardson's 2^q − 1, for steps that have reached half the order of the pair only
STEP_HALVING: float = 2.0**ORDER - 1.0  # derived: the same for steps of the whole order; what is left need not cancel as what went did
COUNTING_STEP = 0.01  # chosen: local error of a step, in the largest, from which on it counts
SLOWLY_FALLING = 0.25  # chosen: share of steps that may fall less; a factor of all errors together is that of a few
FLOWS = (4.0, 2.0)  # chosen: factors by which the base flow is computed less accurately, for another one that errs about as much
FAR_PROBE = 1e-7  # chosen: relative change of the far frame by which its influence is measured
SAFETY = 3.0  # chosen: factor on what a random sample of far frame or steps shows, and on a separation that is known to some 10 %
# A sample of rounding is the difference of two draws, the zero's own error and another one. With σ real the own error exceeds 5 times the
# root mean square of four samples, and 6 times the larger of two, in less than 1 of 100 cases, with σ complex much less often.
NOISE = 5.0  # chosen: factor on samples of the transport's rounding; validation/calibration.py measures that no error passes its bound
# The factor on two flows computed anew, with every rounding on the way from the inputs over the flow to the system: with 6 one bound of
# 3,000 on chutes drawn at random was broken, by a fortieth.
FLOW_NOISE = 10.0  # measured (validation/random_chutes.py): draw 697
SYSTEM_PROBE = 1e-11  # chosen: relative change of the system's entries by which their rounding is measured: far above it, and small
# the factor on two samples of what one rounding of every entry does: the step rounds its sums too; validation/calibration.py tries it
SYSTEM_NOISE = 4.0  # chosen
LUCKY_SIGNS = 100.0  # chosen: factor by which a sum of real changes is smaller than usual in about 1 of 100 cases
ALIKE = 0.1  # chosen: the part of a shift by which its gradient may differ from it; a sensitivity needs few digits
NEGLIGIBLE_SHARE = 0.1  # chosen: part of the integration error that another part may have without being measured further


def shift(variant: Discriminant, value: Value) -> complex:
    """ΔD/D′, by which the zero of D, whose value at a σ next to it is given, lies beyond that of a variant."""
    other = variant(value.sigma)
    scale = max(other.log_scale, value.D.log_scale)
    derivative = value.dD * math.exp(value.D.log_scale - scale)
    return (other.at_scale(scale) - value.D.at_scale(scale)) / derivative if derivative != 0.0 else complex(math.inf)


def displacement(variant: Discriminant, value: Value) -> float:
    """How far the zero of a variant lies from that of D, whose value at a σ next to its zero is given: |ΔD/D′|."""
    return abs(shift(variant, value))


def gradient_by_steps(
    coarse: MeshedDiscriminant, coarse_value: Value, fine: MeshedDiscriminant, fine_value: Value
) -> tuple[ZeroGradient, ComplexArray] | None:
    """The gradient of the zero on a mesh of N steps, and by how much (N,) each of them, halved, moves it; None where there is none.

    Nor is there one where the steps do not come to what the values of D on both meshes say: what moves the zero is seen by D alone then.
    """
    gradient = coarse.gradient(coarse_value.sigma)
    if gradient is None:
        return None
    shares = gradient.by_step(fine.ingredients(fine_value.sigma).sampled)
    whole = fine_value.newton_step - coarse_value.newton_step
    noise = EPSILON * (NOISE * math.hypot(gradient.components, gradient.products) + 8 * abs(fine_value.sigma))
    return (gradient, shares) if abs(shares.sum() - whole) <= ALIKE * abs(whole) + noise else None


def integration_error(
    coarse: MeshedDiscriminant, coarse_value: Value, fine: MeshedDiscriminant, fine_value: Value, shares: ComplexArray | None
) -> float:
    """The error that integration leaves in the zero on the halved mesh, from the values on both at one σ.

    The zeros of the two differ by Σ c_j over the steps. Where these cancel by chance, the sum tells nothing of the halved mesh, whose own
    sum need not: the root of Σ |c_j|² is what it is for signs at random. How much of c_j is left on the halved mesh is told by the local
    errors on both. shares (N,) are the c_j, None where they are not known; where they are, |Σ| and root
    of what each keeps are taken, the former no larger than Richardson says.
    """
    whole = coarse_value.newton_step - fine_value.newton_step
    before, left = coarse.local_errors(coarse_value.sigma), fine.local_errors(fine_value.sigma)
    if shares is not None:
        kept = shares / np.where(_counting(before), _fallen(before, left), _fallen_of_most(before, left))
        return float(max(min(SAFETY * abs(kept.sum()), abs(whole) / HALVING), SAFETY * float(np.linalg.norm(kept))))
    sample = _halves(coarse, coarse_value, whole) / _fallen_of_most(before, left)
    return float(max(abs(whole) / HALVING, SAFETY * sample))


def _halves(coarse: MeshedDiscriminant, value: Value, whole: complex) -> float:
    """|Σ ± c_j| where no c_j is known, by meshes with half of the steps halved: Σ over these, and twice that less the whole is Σ ± c_j.

    Where two halves part the four steps of the largest local errors from each other, no two of these cancel in all three sums.
    """
    parts = [coarse.partly_refined(digit, value.sigma) for digit in (0, 1)]
    drawn = [2 * shift(part, value) - whole for part in parts]
    return max(abs(d) if cmath.isfinite(d) else math.inf for d in drawn)


def _fallen(before: NDArray[np.float64], left: NDArray[np.float64]) -> NDArray[np.float64]:
    """The factors (m,) by which the errors (m,) of steps fell when each was halved, (2m,): HALVING at least, STEP_HALVING at most."""
    if len(left) != 2 * len(before):  # a step between neighbouring numbers has no middle
        return np.full(len(before), HALVING)
    parts = left.reshape(-1, 2).sum(axis=1)
    known = np.isfinite(before) & np.isfinite(parts) & (parts > 0.0)
    return np.asarray(np.clip(np.divide(before, parts, out=np.full(len(before), HALVING), where=known), HALVING, STEP_HALVING))


def _counting(before: NDArray[np.float64]) -> NDArray[np.bool_]:
    """The steps (m,) whose errors are not small against the largest: those of others are noise where the largest is small."""
    return np.asarray(before > COUNTING_STEP * before.max(initial=0.0))


def _fallen_of_most(before: NDArray[np.float64], left: NDArray[np.float64]) -> float:
    """The factor of which that of a quarter of the steps that count is smaller; HALVING where the errors are no numbers, or none."""
    counts = _counting(before)
    return float(np.quantile(_fallen(before, left)[counts], SLOWLY_FALLING)) if counts.any() else HALVING


def budget(
    problem: Problem, coarse: MeshedDiscriminant, coarse_value: Value, fine: MeshedDiscriminant, fine_value: Value, scale: float
) -> Budget:
    """The parts of the bound on the zero σ − D/D′ of the finer discriminant, with the values of both at one σ next to their zeros.

    scale is the separation |2D′/D″|, over which D is linear: Newton's step δ leaves δ²/scale. What far field and steady flow do to the
    zero is measured on the coarse mesh: a sensitivity needs few digits. Where the method knows the gradient of the zero, everything follows
    from it; elsewhere D is computed anew for each part, changed as it may be wrong.
    """
    gradient, shares = gradient_by_steps(coarse, coarse_value, fine, fine_value) or (None, None)
    integration = integration_error(coarse, coarse_value, fine, fine_value, shares)
    far = _far(coarse, coarse_value, gradient, integration) + _approximate_walls(problem, coarse, coarse_value)
    step = abs(fine_value.newton_step)
    root = SAFETY * step * (step / scale) if scale > 0.0 else math.inf  # the square of a step beyond 1e154 would be an OverflowError
    flow = _flow(problem, coarse, coarse_value, gradient, integration)
    rounding = _rounding(problem, coarse, coarse_value, fine, fine_value, gradient, integration)
    return Budget(integration, far, flow, root, rounding)


def _moved(variant: MeshedDiscriminant, value: Value, gradient: ZeroGradient | None) -> float:
    """How far the zero of a variant on the same mesh lies from that of D: by the gradient where there is one and the systems are alike."""
    by_gradient = None if gradient is None else gradient.shift(variant.ingredients(value.sigma))
    return displacement(variant, value) if by_gradient is None else abs(by_gradient)


def _far(coarse: MeshedDiscriminant, value: Value, gradient: ZeroGradient | None, integration: float) -> float:
    """The share of the far frame, seen on a changed one; the signs of real changes cancel by chance more easily than phases do."""
    if gradient is not None:
        return SAFETY * coarse.far_error(value.sigma) * gradient.by_far_frame
    error = SAFETY / FAR_PROBE * coarse.far_error(value.sigma)
    if coarse.real_at(value.sigma):
        seen = error * displacement(coarse.with_perturbed_start(1, FAR_PROBE, real=True), value)
        if LUCKY_SIGNS * seen < NEGLIGIBLE_SHARE * integration:
            return seen
    return error * displacement(coarse.with_perturbed_start(1, FAR_PROBE), value)


def _approximate_walls(problem: Problem, coarse: MeshedDiscriminant, value: Value) -> float:
    """How far the zero moves when walls stand twice as far from the singular points that they approximate.

    An error c δ^p moves by (2^p − 1) times itself. The D of other walls has another factor, and so its own derivative is used.
    """
    farther = FARTHER_WALLS.of(problem)
    if farther is None:
        return 0.0
    return abs(coarse.on_same_mesh(farther).with_derivative(value.sigma).newton_step - value.newton_step)


def change_by_walls(problem: Problem, samples: Sequence[tuple[MeshedDiscriminant, Value]]) -> float:
    """max |D̃D′/(D̃′D) − 1| over samples of a contour, D̃ with approximate walls twice as far from their points; 0 without such walls.

    At a distance r from a zero that other walls move by d it is d/r. Other walls give D another factor too, which hardly depends on σ and
    cancels; the ratio D̃/D would tell nothing on a contour that is small against d.
    """
    farther = FARTHER_WALLS.of(problem)
    if farther is None:
        return 0.0
    changes = []
    for discriminant, value in samples:
        here, there = (v.logarithmic_derivative for v in (value, discriminant.on_same_mesh(farther).with_derivative(value.sigma)))
        changes.append(0.0 if here == there else abs(here - there) / abs(there) if there != 0.0 else math.inf)
    return max(changes)


def _flow(problem: Problem, coarse: MeshedDiscriminant, value: Value, gradient: ZeroGradient | None, integration: float) -> float:
    """The share of the flow, its truncation, its rounding and that of the system made of it, seen on flows that err about as much."""
    seen = 0.0
    for factor in FLOWS:
        other = problem.with_base_flow_error(factor)
        if other is not problem:
            seen = max(seen, _moved(coarse.on_same_mesh(other), value, gradient))
        if FLOW_NOISE * seen < NEGLIGIBLE_SHARE * integration:
            break
    return FLOW_NOISE * seen


def _rounding(
    problem: Problem,
    coarse: MeshedDiscriminant,
    value: Value,
    fine: MeshedDiscriminant,
    fine_value: Value,
    gradient: ZeroGradient | None,
    integration: float,
) -> float:
    """The share of rounding in the transport, in the coefficients and in the system made of them.

    A problem without a flow of its own has its system computed anew at other points: its coefficients may round by more than a last bit.
    Beside them what a rounding of every entry does all along the path: ε Σ |ψ†| |P| |ψ| h over |⟨ψ†, ∂P/∂σ ψ⟩|, were it added up, is that
    of the worst signs; taken is the root of the sum of squares, or two draws.
    """
    points = [0.0]
    if problem.with_base_flow_error(FLOWS[0]) is problem:
        points = [_moved(coarse.at_other_points(seed), value, gradient) for seed in (1, 2)]
    if gradient is None:
        transport = _bases(coarse, value, fine, fine_value, integration)
    else:
        transport = EPSILON * math.hypot(gradient.components, gradient.products)
    entries = None if gradient is None else gradient.by_entries
    if entries is None:
        moved = [_moved(coarse.with_perturbed_system(seed, SYSTEM_PROBE), value, gradient) for seed in (1, 2)]
        entries = _rms(moved) / SYSTEM_PROBE
    return NOISE * max(transport, _rms(points)) + SYSTEM_NOISE * EPSILON * entries + 8 * EPSILON * abs(fine_value.sigma)


def _bases(coarse: MeshedDiscriminant, value: Value, fine: MeshedDiscriminant, fine_value: Value, integration: float) -> float:
    """The rounding of a transport, seen on other bases of the far frame on the coarse mesh and, where that matters, on the fine one."""
    bases = [displacement(coarse.with_rotated_basis(seed), value) for seed in (1, 2)]
    if NOISE * _rms(bases) > NEGLIGIBLE_SHARE * integration:
        bases += [displacement(fine.with_rotated_basis(seed), fine_value) for seed in (1, 2)]
    return _rms(bases)


def _rms(samples: list[float]) -> float:
    return math.sqrt(sum(x * x for x in samples) / len(samples))
