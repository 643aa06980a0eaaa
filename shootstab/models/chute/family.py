"""Steady flows by mass flux. T_∞ is the natural parameter of the family; a mass flux may belong to several members."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np

from shootstab.core.errors import InputError, NoFlowError
from shootstab.models.chute.parameters import Chute
from shootstab.models.chute.registry import BRANCHES, BY_NAME
from shootstab.models.chute.steady_flow import TOLERANCE, Flow, descend
from shootstab.roots.bracket import zero_between

SCAN = (1e-2, 1e3, 121)  # chosen: T_∞ from, to, points: 24 a decade
SCOUTING = 1e-9  # chosen: the tolerance of flows that only tell where to look
OVERSHOOT = 4.0  # chosen: an extremum between points of the scan surely exceeds them by fewer of the differences next to it
DOUBT = 1e-5  # chosen: where a scouting flow comes nearer to the mass flux than this part, its error could decide whether a flow is there
END_BISECTIONS = 40  # chosen: halvings of the way to the end of the family, to twelve digits of a step of the scan
FOLD_KNOWN = 1e-9  # chosen: how well ln T_∞ of an extremum of Q0 is sought
FLUX_STEP = 1e-5  # chosen: relative step of T_∞ for dQ0/d ln T_∞, in which one step of Newton is taken


def flows(chute: Chute, mass_flux: float) -> list[Flow]:
    """Every flow with this mass flux and 0.01 ≤ T_∞ ≤ 1000, in the order of rising T_∞.

    Two flows next to a fold of the family, closer in T_∞ than two points of the scan, are seen because the extrema of Q0(T_∞) are
    located too. Raises InputError unless the mass flux is a positive, finite number.
    """
    return [solve_between(chute, mass_flux, *b) for b in _separated(chute, mass_flux)]


def _separated(chute: Chute, mass_flux: float) -> list[tuple[float, float]]:
    """Intervals of ln T_∞ with one flow each, rising."""
    BY_NAME["mass_flux"].check(mass_flux)
    found, nearest = _brackets(chute, mass_flux, SCOUTING)
    if nearest > DOUBT * mass_flux and all(_changes_sign(chute, mass_flux, *b) for b in found):
        return found
    return _brackets(chute, mass_flux, TOLERANCE)[0]


def _brackets(chute: Chute, mass_flux: float, tolerance: float) -> tuple[list[tuple[float, float]], float]:
    """Intervals of ln T_∞ with one flow each, and how near to zero the misfit came at their ends, by flows integrated to this tolerance."""

    def misfit(x: float) -> float:
        return _flux(chute, x, tolerance) - mass_flux

    logs = np.linspace(np.log(SCAN[0]), np.log(SCAN[1]), SCAN[2])
    at = np.array([misfit(x) for x in logs])
    brackets, inner_values = [], []
    for i in range(len(logs) - 1):
        exists = np.isfinite(at[i : i + 2])
        if not exists.all():
            if exists.any():  # the family ends between these points
                inside, outside = (i, i + 1) if exists[0] else (i + 1, i)
                end = _last_member(misfit, logs[inside], logs[outside])
                if (misfit(end) < 0.0) != (at[inside] < 0.0):
                    brackets.append((min(end, logs[inside]), max(end, logs[inside])))
                inner_values.append(misfit(end))
            continue
        inner = _fold_between(misfit, logs, at, i)
        points = [logs[i], *inner, logs[i + 1]]
        inner_values += [misfit(x) for x in inner]
        below = [misfit(x) < 0.0 for x in points]
        # a misfit of exactly zero counts as positive, so that a flow that sits on a point of the scan is found once
        brackets += [(points[j], points[j + 1]) for j in range(len(points) - 1) if below[j] != below[j + 1]]
    return brackets, float(np.nanmin(np.abs([*at, *inner_values, np.inf])))


def _changes_sign(chute: Chute, mass_flux: float, low: float, high: float) -> bool:
    return (_flux(chute, low, TOLERANCE) - mass_flux) * (_flux(chute, high, TOLERANCE) - mass_flux) < 0.0


def steady_by_flux(chute: Chute, mass_flux: float, branch: str | None) -> Flow:
    """The flow with this mass flux; branch picks one of several by T_∞: high, mid, low."""
    found = _separated(chute, mass_flux)
    if not found:
        raise NoFlowError(f"mass_flux = {mass_flux:g}: no steady flow with 0.01 <= far_temperature <= 1000 and these parameters carries it")
    names = _names(len(found))
    if branch in names:
        return solve_between(chute, mass_flux, *found[names[::-1].index(branch)])
    if branch is None and len(found) == 1:
        return solve_between(chute, mass_flux, *found[0])
    temperatures = ", ".join(f"{f.far_temperature:.6g}" for f in flows(chute, mass_flux))
    if branch is None:
        raise InputError(
            f"mass_flux = {mass_flux:g} has {len(found)} flows, far_temperature {temperatures}: branch is needed, one of {', '.join(names)}"
        )
    raise InputError(
        f"branch = {branch!r}: mass_flux = {mass_flux:g} has {len(found)} flows, far_temperature {temperatures}: "
        f"allowed is {', '.join(names)}"
    )


def _names(count: int) -> tuple[str, ...]:
    """What the members are called, hottest first."""
    named = {1: ("high",), 2: ("high", "low"), 3: BRANCHES}
    return named.get(count) or tuple(str(i) for i in range(count, 0, -1))


@lru_cache(maxsize=8192)
def _flux(chute: Chute, log_temperature: float, tolerance: float) -> float:
    """Q0 of the flow with this ln T_∞, NaN where there is none; the scan is the same for every mass flux that is asked for."""
    try:
        return descend(chute, float(np.exp(log_temperature)), tolerance).mass_flux
    except NoFlowError:
        return float("nan")


def _last_member(misfit: Callable[[float], float], inside: float, outside: float) -> float:
    """The ln T_∞ next to the end of the family between inside, where a flow exists, and outside, where none does."""
    for _ in range(END_BISECTIONS):
        middle = (inside + outside) / 2
        if np.isfinite(misfit(middle)):
            inside = middle
        else:
            outside = middle
    return inside


def _fold_between(misfit: Callable[[float], float], logs: np.ndarray, at: np.ndarray, i: int) -> list[float]:
    """The extremum of Q0 in [x_i, x_{i+1}] if Q0 − mass_flux comes near zero there without changing sign between the points."""
    if i == 0 or i + 2 >= len(logs) or at[i] * at[i + 1] < 0.0:
        return []
    before, here, after = np.diff(at[i - 1 : i + 3])
    if not np.isfinite([before, here, after]).all() or before * after > 0.0:
        return []
    nearest = np.abs(at[i : i + 2]).min()
    if nearest > OVERSHOOT * np.abs([before, here, after]).max():
        return []
    sign = np.sign(at[i])
    from scipy.optimize import minimize_scalar

    best = minimize_scalar(lambda x: sign * misfit(x), bounds=(logs[i], logs[i + 1]), method="bounded", options={"xatol": FOLD_KNOWN})
    return [float(best.x)]


def solve_between(chute: Chute, mass_flux: float, low: float, high: float) -> Flow:
    """The flow of this mass flux with ln T_∞ between low and high; the one has a larger Q0, the other a smaller one."""
    x = zero_between(lambda x: _flux(chute, x, TOLERANCE) - mass_flux, low, high)
    return replace(descend(chute, float(np.exp(x))), asked_flux=mass_flux)


@lru_cache(maxsize=64)
def with_base_flow_error(flow: Flow, factor: float) -> Flow:
    """The same flow, of the same T_∞ or the same mass flux, integrated with a tolerance larger by this factor.

    The inputs are as good as the given ones: each is one unit larger or smaller in its last bit, by chance, for a decimal is rounded when
    it becomes a double, and what is made of it is rounded again.
    """
    tolerance = factor * flow.tolerance
    rng = np.random.default_rng(round(8 * factor))
    chute = flow.chute.with_numbers(lambda x: _last_bit(x, rng))
    other = descend(chute, _last_bit(flow.far_temperature, rng), tolerance)
    if flow.asked_flux is None:
        return other
    # one Newton step in ln T_∞ brings the flux back
    shift = (flow.asked_flux - other.mass_flux) / _flux_rate(flow)
    return replace(descend(chute, other.far_temperature * (1 + shift), tolerance), asked_flux=flow.asked_flux)


def _last_bit(x: float, rng: np.random.Generator) -> float:
    """x one unit larger or smaller; a restitution of 1 is the largest that there is."""
    return float(np.nextafter(x, 0.0 if rng.random() < 0.5 or x == 1.0 else math.inf))


@lru_cache(maxsize=8)
def _flux_rate(flow: Flow) -> float:
    """dQ0/d ln T_∞."""
    step = FLUX_STEP
    ahead = descend(flow.chute, flow.far_temperature * (1 + step))
    return (ahead.mass_flux - flow.mass_flux) / step
