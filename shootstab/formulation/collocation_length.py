"""The length, and on the line the centre, of rational Chebyshev functions on an unbounded domain.

The centre is where the coefficients do half of their changing. The length is looked for among powers of two: that with which a coarse
truncation has most digits, Σ log₁₀(DRIFT_COUNTED |σ|/drift) over the eigenvalues that hardly move and whose coefficients fall, of those
with which no coefficient of the equations does more than a part of its changing from one point to the next.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from shootstab.core.scaled import TINY
from shootstab.formulation.expression import Expression
from shootstab.formulation.layers import Layer
from shootstab.formulation.scaled_values import scaled_values
from shootstab.formulation.system import coefficients
from shootstab.spectral.qz import Spectrum

PROBE = 32  # chosen: the truncation at which lengths are compared, an eighth of the work of the usual one
COARSE = 4.0 ** np.arange(-3, 5)  # chosen: lengths tried first; profiles of width 1 ask for 2 to 8
FINE = (0.5, 2.0)  # chosen: those around the best
DRIFT_COUNTED = 1e-2  # chosen: relative drift of an eigenvalue that counts
TAIL_COUNTED = 3e-2  # chosen: the tail of its coefficients
MOST_COUNTED = 12.0  # chosen: digits of one eigenvalue, no more than rounding leaves
LARGEST_STEP = 0.4  # chosen: the part of a coefficient's changing between neighbouring points, with which it is still resolved
STEP_ROOM = 1.5  # chosen: where none is resolved so far, what a length may have over the best one
CONSTANT = 1e-9  # chosen: a coefficient that changes by less, relative to its size, is constant
NEAR, GROWTH = 10.0, 100.0  # chosen: a coefficient that is larger than GROWTH times its largest value within NEAR grows
LINE_POINTS = 4001  # chosen: points of the line at which coefficients are looked at; a change within 0.2 at a distance of 50 is seen
FARTHEST_POINT = 1e3  # chosen: the largest of them


def digits_held(found: Spectrum) -> float:
    """Σ of the digits that two truncations share, of a spectrum filtered by the tolerances above; an eigenvalue 0 has none to count."""
    counted = found.eigenvalues != 0.0
    size = np.maximum(np.abs(found.eigenvalues[counted]), TINY)
    digits = -np.log10(np.maximum(found.drift[counted] / size / DRIFT_COUNTED, 10.0**-MOST_COUNTED))
    return float(digits.sum())


def best_length(held: Callable[[float], float], step: Callable[[float], float]) -> float:
    """The length with which held(length) is largest, among those that resolve the coefficients; of equal ones that nearest to 1."""
    coarse = {float(length): step(float(length)) for length in COARSE}
    most = max(LARGEST_STEP, STEP_ROOM * min(coarse.values()))
    scores = {length: held(length) for length, own in coarse.items() if own <= most}

    def rank(length: float) -> tuple[float, float]:
        return scores[length], -abs(float(np.log(length)))

    best = max(scores, key=rank)
    scores |= {best * factor: held(best * factor) for factor in FINE if step(best * factor) <= most}
    return max(scores, key=rank)


def largest_step(layer: Layer, z: NDArray[np.float64]) -> float:
    """The largest part of its changing that a coefficient of a layer does between neighbouring points z (m,), or beside them all.

    A coefficient that grows has no length.
    """
    largest, line = 0.0, _line(layer)
    for part in _parts(layer):
        whole = np.abs(np.diff(_values(layer, part, line))).sum()
        if whole > CONSTANT * np.abs(_values(layer, part, line)).max() and not _grows(layer, part):
            steps = np.abs(np.diff(_values(layer, part, np.sort(z)))) / whole
            largest = max(largest, float(steps.max()), 1.0 - float(steps.sum()))
    return largest


def centre(layer: Layer) -> float:
    """Where the coefficients of a layer without ends have done half of their changing; 0 where they are constant."""
    z = _line(layer)
    done = np.zeros(len(z) - 1)
    for part in _parts(layer):
        values = _values(layer, part, z)
        size = np.abs(values)
        # one that grows: no more than 1, whatever it does far away
        steps = np.abs(np.diff(values / (size + np.median(size) + TINY) if _grows(layer, part) else values / (size.max() + TINY)))
        done += np.where(steps.sum() > CONSTANT, steps, 0.0).cumsum()
    return float(z[np.searchsorted(done, 0.5 * done[-1])]) if done[-1] > 0.0 else 0.0


def _line(layer: Layer) -> NDArray[np.float64]:
    """Points (m,) of an unbounded layer, rising, the denser the nearer to its end, or to 0."""
    reach = np.arcsinh(FARTHEST_POINT)
    if np.isfinite(layer.domain.left):
        return np.asarray(layer.domain.left + np.sinh(np.linspace(0.0, reach, LINE_POINTS)))
    if np.isfinite(layer.domain.right):
        return np.asarray(layer.domain.right + np.sinh(np.linspace(-reach, 0.0, LINE_POINTS)))
    return np.sinh(np.linspace(-reach, reach, LINE_POINTS))


def _parts(layer: Layer) -> list[Expression]:
    return [part for row in layer.system.rows for coefficient in row.values() for part in coefficients(coefficient).values()]


def _values(layer: Layer, part: Expression, z: NDArray[np.float64]) -> NDArray[np.complex128]:
    """A coefficient at z (m,); what is not finite is taken to be zero, so that it does not count."""
    with np.errstate(all="ignore"):
        values, logs = scaled_values(part, z, layer.domain.given)
        return np.nan_to_num(np.asarray(values * np.exp(logs), dtype=np.complex128), posinf=0.0, neginf=0.0)


def _grows(layer: Layer, part: Expression) -> bool:
    """Whether a coefficient becomes much larger far out than it is near by."""
    z = _line(layer)
    origin = next((end for end in (layer.domain.left, layer.domain.right) if np.isfinite(end)), 0.0)
    size = np.abs(_values(layer, part, z))
    return bool(size.max() > GROWTH * size[np.abs(z - origin) <= NEAR].max())
