"""Certificates: a proof as a JSON file of exact decimals that a checker of its own, on integers and mpmath's intervals, verifies anew.

{"format": 2, "problem": {…}, "count": n, "region": {"re", "im", "radius"} or {"floor"}, "outer", "weight", "points", "bits", "order",
"steps"}: what is claimed, and the settings with which the checker finds that it holds; or {"format": 2, "parts": [… of these]}. That of a
granular chute says besides between which T_∞ its flow lies and at which ν its base, and which lemmas it relies on. The checker trusts none
of the settings; poor ones make it refuse.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from shootstab.analyses import checker_settings, chute_settings
from shootstab.analyses.contour_proof import CONTOUR_BITS, RIM
from shootstab.analyses.disc_proof import disc
from shootstab.analyses.proof import Proof
from shootstab.analyses.prove import whole
from shootstab.core.balls import acb, arb
from shootstab.core.errors import ConvergenceError, InputError, shortened
from shootstab.core.reading import bytes_of, json_of, text_of
from shootstab.multiprecision.enclosure import at_bits, decimal
from shootstab.problems.capabilities import BASE_FLOW, CERTIFIED, FACTORS
from shootstab.problems.protocol import Problem
from shootstab.roots.pellet import TAIL_NATS

Candidates = Callable[[Any, dict[str, Any], Proof, int, int], Iterator[dict[str, Any]]]


@dataclass(frozen=True)
class CheckerModule:
    """The module of a checker, and certificates to be tried for a problem, its name and parameters, a proof, a count and spare bits."""

    module: str
    candidates: Candidates


LARGEST_CERTIFICATE = 2**20  # chosen: bytes of a certificate
# chosen: values of D and bits that the checker has beyond what was needed here; where they are too few there are more attempts
CHECKER_POINTS, CHECKER_BITS = 2, 24
MOST_FACTORS = 16  # chosen: parts of a certificate
CERTIFICATE_ATTEMPTS = 3  # chosen: attempts, each with more points and bits, before a proof is said to have no certificate
MORE_EACH_ATTEMPT = 1.3  # chosen: factor of points and bits from one attempt to the next


def certify(problem: Problem, proof: Proof, spare_bits: int = CONTOUR_BITS) -> dict[str, Any]:
    """The certificate of a proof on a disc or on all that grows; it is handed out only after its checker has accepted it.

    Where D has factors it has one part for each. spare_bits as in `prove_growing`. Raises InputError for a problem without a
    checker and a proof on another region, ConvergenceError where the checker does not accept.
    """
    parts = FACTORS.of(problem)
    if parts:
        made = [_certified(part, proof, count, spare_bits) for part, count in zip(parts, proof.counts, strict=True)]
        return {"format": 2, "parts": made}
    return _certified(problem, proof, proof.count, spare_bits)


def require_checker(problem: Problem) -> None:
    """Raises InputError for a problem that no checker knows."""
    for part in FACTORS.of(problem) or (problem,):
        if CERTIFIED.of(part) is None:
            raise InputError(f"a certificate of this problem: allowed is one for {', '.join(CHECKERS)}")


def _certified(problem: Any, proof: Proof, count: int, spare_bits: int) -> dict[str, Any]:
    named: dict[str, Any] = CERTIFIED.required(problem)
    checker = CHECKERS[named["name"]]
    verdict, reason = import_module(checker.module).check, None
    for found in checker.candidates(problem, named, proof, count, spare_bits):
        reason = verdict(found)
        if reason is None:
            return found
    raise ConvergenceError(f"the checker does not accept the certificate: {reason}")


def _of_channel(problem: Any, named: dict[str, Any], proof: Proof, count: int, spare_bits: int) -> Iterator[dict[str, Any]]:
    """Certificates of discs and of all that grows in a channel."""
    if proof.floor is not None:
        region: dict[str, str] = {"floor": repr(proof.floor)}
        low, high = (complex(float(at["re"]), float(at["im"])) for at in proof.region["corners"])
        corners = [low, complex(high.real, low.imag), high, complex(low.real, high.imag)]
        sides = zip(corners, [*corners[1:], corners[0]], strict=True)
        sampled = [a + (b - a) * x / RIM for a, b in sides for x in range(RIM)]
        centre, radius, nats = (low + high) / 2, abs(high - low) / 2, spare_bits * math.log(2)
    else:
        at, size = _disc_of(proof, "one on a disc, or on all eigenvalues that grow")
        region = {**at, "radius": size}
        centre, radius, nats = complex(float(at["re"]), float(at["im"])), float(size), TAIL_NATS
        with at_bits(proof.bits):
            sampled = [acb(decimal(at["re"]), decimal(at["im"])) + decimal(size)]
    with at_bits(proof.bits):
        enclosure = whole(problem).enclosure(proof.bits, disc(acb(centre), arb(radius)))
        least = min(float(abs(enclosure(acb(sigma))).log().mid()) for sigma in sampled)
    settings = checker_settings.plane_poiseuille(named, centre, radius, least, nats)
    for attempt in range(CERTIFICATE_ATTEMPTS):
        points = math.ceil(settings["points"] * MORE_EACH_ATTEMPT**attempt) + CHECKER_POINTS
        bits = math.ceil(settings["bits"] * MORE_EACH_ATTEMPT**attempt) + CHECKER_BITS
        yield {"format": 2, "problem": named, "count": count, "region": region, **settings, "points": points, "bits": bits}


def _of_chute(problem: Any, named: dict[str, Any], proof: Proof, count: int, spare_bits: int) -> Iterator[dict[str, Any]]:
    """Certificates of discs about modes of a granular chute."""
    at, size = _disc_of(proof, "one on a disc")
    return chute_settings.candidates(
        chute_settings.Asked(named, {**at, "radius": size}, count, BASE_FLOW.required(problem).far_temperature)
    )


def _disc_of(proof: Proof, allowed: str) -> tuple[dict[str, str], str]:
    if proof.region["shape"] != "disc":
        raise InputError(f"a proof on a rectangle: allowed is {allowed}")
    return proof.region["centre"], proof.region["radius"]


CHECKERS: Mapping[str, CheckerModule] = {
    "plane Poiseuille": CheckerModule("shootstab.checkers.plane_poiseuille", _of_channel),
    "granular chute": CheckerModule("shootstab.checkers.granular_chute", _of_chute),
}


def check(certificate: Any) -> str | None:
    """None where the certificate, or every one of its parts, proves what it says, else why not.

    Raises InputError for a problem that no checker knows.
    """
    split = isinstance(certificate, dict) and set(certificate) == {"format", "parts"} and isinstance(certificate["parts"], list)
    parts = certificate["parts"] if split and certificate["parts"] else [certificate]
    if len(parts) > MOST_FACTORS:
        return f"it has {len(parts)} parts: no problem has as many factors"
    for part in parts:
        named = part.get("problem") if isinstance(part, dict) else None
        name = named.get("name") if isinstance(named, dict) else None
        if not isinstance(name, str) or name not in CHECKERS:
            raise InputError(f"a certificate for {shortened(name)}: allowed is one for {', '.join(CHECKERS)}")
        verdict: Callable[[Any], str | None] = import_module(CHECKERS[name].module).check
        reason = verdict(part)
        if reason is not None:
            return reason
    return None


def read(path: Path) -> Any:
    """The JSON of a certificate. Raises InputError for a file that cannot be read, is larger than LARGEST_CERTIFICATE or is no JSON."""
    try:
        return json_of(text_of(bytes_of(path, LARGEST_CERTIFICATE, "a certificate")), "allowed is a certificate in JSON")
    except InputError:
        raise
    except ValueError as error:
        raise InputError(f"{path}: {error}") from error
