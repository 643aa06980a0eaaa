"""The JSON contract: what each command answers with, for programs to read."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

from shootstab.core.records import Mode, Report, Verdict
from shootstab.core.regions import Region
from shootstab.io.notation import as_strings

if TYPE_CHECKING:
    from shootstab.analyses.cut_region import RegionCount
    from shootstab.analyses.find import Found
    from shootstab.models.chute import Flow

PROFILE_POINTS = 101  # chosen: points of a profile in JSON
RIM_POINTS = 360  # chosen: points of a rim, with those at which a disc is widest among them
PROFILE_TOP = 1e-6  # chosen: profiles end where ν has fallen to this


def mode(found: Mode) -> dict[str, Any]:
    """What `refine` answers."""
    return {
        "sigma": as_strings(found.sigma, found.error),
        "error": found.error,
        "budget": found.budget.as_dict(),
        "digits": found.digits,
        "status": found.status,
        "method": found.method,
        "evaluations": found.evaluations,
        "seconds": found.seconds,
        "continuum_distance": found.continuum_distance,
        "path": found.path,
        "system": found.system,
        "multiplicity": found.multiplicity,
        "scale": found.scale,
        "atol": found.atol,
        "guess_distance": found.guess_distance,
        "nearer": found.nearer,
    }


def report(found: Report) -> dict[str, Any]:
    """What `verify` answers."""
    return {
        "verdicts": [_verdict(v) for v in found.verdicts],
        "missing": [{"sigma": as_strings(m.sigma, m.error), "error": m.error, "multiplicity": m.multiplicity} for m in found.missing],
        "summary": dict(found.summary),
        "digits": found.digits,
        "searched": found.searched,
        "region": None if found.region is None else {**found.region.as_dict(), "bounds": bounds(found.region)},
        "claims_inside": found.claims_inside,
        "undecided": list(found.undecided),
        "dropped": found.dropped,
        "rests_on": found.rests_on,
    }


def bounds(region: Region) -> list[float]:
    """[least Re, least Im, largest Re, largest Im] on the rim of a region, as numbers."""
    rim = [complex(region.boundary(t)) for t in (*region.corners, *(k / RIM_POINTS for k in range(RIM_POINTS)))]
    return [min(z.real for z in rim), min(z.imag for z in rim), max(z.real for z in rim), max(z.imag for z in rim)]


def _verdict(verdict: Verdict) -> dict[str, Any]:
    return {
        "claimed": as_strings(verdict.claimed),
        "verdict": verdict.verdict,
        "sigma": None if verdict.sigma is None else as_strings(verdict.sigma, verdict.error),
        "error": verdict.error,
        "digits_agreed": verdict.digits_agreed,
        "why": verdict.why,
        "continuum_distance": verdict.continuum_distance,
        "multiplicity": verdict.multiplicity,
        "growth_digits": verdict.growth_digits,
        "atol": verdict.atol,
    }


def count(region: Region, found: RegionCount, lemma: str = "") -> dict[str, Any]:
    """What `count` answers: beside the count how nearly the phase closed, and what was left out around ends of the continuous spectrum.

    lemma is the theorem by which the region holds all growing modes.
    """
    left_out = [disc.as_dict() for disc in found.left_out]
    return {
        "region": {**region.as_dict(), "bounds": bounds(region)},
        "count": found.count,
        "closure": found.closure,
        "left_out": left_out,
        "evaluations": found.evaluations,
        **({"lemma": lemma} if lemma else {}),
    }


def found(answer: Found, region: Region) -> dict[str, Any]:
    """What `find` answers: modes, resonances if they were asked for, and the count that says that these are all."""
    return {
        **count(region, answer.counted),
        "modes": [
            {"sigma": as_strings(m.sigma, m.error), "error": m.error, "multiplicity": m.multiplicity, "status": m.status}
            for m in answer.modes
        ],
        "resonances": None if answer.resonances is None else [{"sigma": as_strings(r)} for r in answer.resonances],
    }


def steady(flow: Flow) -> dict[str, Any]:
    """What `steady` answers: the flow, and profiles from the base to where ν has fallen to 1e−6."""
    z, fields = profiles(flow)
    return {
        "far_temperature": flow.far_temperature,
        "base": dict(flow.base),
        "mass_flux": flow.mass_flux,
        "hold_up": flow.hold_up,
        "centre_of_mass": flow.centre_of_mass,
        "profiles": {"z": z.tolist(), **{name: field.tolist() for name, field in fields.items()}},
    }


def profiles(flow: Flow, points: int = PROFILE_POINTS) -> tuple[Any, dict[str, Any]]:
    """z (points,) from the base to where ν has fallen to 1e−6, and the fields there by name."""
    import numpy as np

    z = np.linspace(0.0, flow.height(PROFILE_TOP), points)
    return z, vars(flow.at(z))


def spectrum(found: Any, raw: bool) -> dict[str, Any]:
    """What `spectrum` answers: the filtered eigenvalues with their evidence, and with raw all that QZ gave."""
    document: dict[str, Any] = {
        "truncation": found.truncation,
        "eigenvalues": [as_strings(s) for s in found.eigenvalues],
        "drift": [float(x) for x in found.drift],
        "tail": [float(x) for x in found.tail],
    }
    if raw:
        document["raw"] = [as_strings(s) for s in found.raw]
    return document


def text(document: Any) -> str:
    """The document as JSON; NaN and infinities, which JSON does not know, as null."""
    return json.dumps(_plain(document), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, str | int | None):  # bool is an int
        return value
    number = float(value)  # NumPy's and mpmath's too
    return number if math.isfinite(number) else None
