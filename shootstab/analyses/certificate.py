"""Certificates: a proof as a JSON file of exact decimals that a checker of its own, on mpmath's intervals alone, verifies anew.

{"format": 1, "problem": {…}, "count": n, "disc": {"re", "im", "radius"}, "outer", "weight", "points", "bits", "order", "steps"}: what is
claimed, and the settings with which the checker finds that it holds. The checker trusts none of them; poor ones make it refuse.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

from flint import acb

from shootstab.analyses.prove import OUTER, Proof, enclosable
from shootstab.core.errors import ConvergenceError, InputError, shortened
from shootstab.core.reading import bytes_of, json_of, text_of
from shootstab.multiprecision.enclosure import Enclosure, at_bits, decimal
from shootstab.problems.capabilities import CERTIFIED
from shootstab.problems.protocol import Problem

CHECKERS: Mapping[str, str] = {"plane Poiseuille": "shootstab.checkers.plane_poiseuille"}
LARGEST_CERTIFICATE = 2**20  # chosen: bytes of a certificate
# chosen: values of D and bits that the checker has beyond what was needed here; where they are too few there are more attempts
CHECKER_POINTS, CHECKER_BITS = 2, 24
CERTIFICATE_ATTEMPTS = 3  # chosen: with more points and bits each, before a proof is said to have no certificate


def certify(problem: Problem, proof: Proof) -> dict[str, Any]:
    """The certificate of a proof on a disc; it is handed out only after its checker has accepted it.

    Raises InputError for a problem without a checker and a proof on another region, ConvergenceError where the checker does not accept.
    """
    named: dict[str, Any] = CERTIFIED.required(problem)
    if proof.region["shape"] != "disc":
        raise InputError(f"a proof on a {proof.region['shape']}: allowed is one on a disc")
    checker = import_module(CHECKERS[named["name"]])
    centre, radius = proof.region["centre"], proof.region["radius"]
    size = max(math.hypot(float(centre["re"]), float(centre["im"])), 8.0 * float(radius))
    settings = checker.settings(named, {**centre, "radius": radius}, repr(OUTER * size), _log_size(problem, proof))
    for attempt in range(CERTIFICATE_ATTEMPTS):
        points = math.ceil(settings["points"] * 1.3**attempt) + CHECKER_POINTS
        bits = math.ceil(settings["bits"] * 1.3**attempt) + CHECKER_BITS
        found = {"format": 1, "problem": named, "count": proof.count, "disc": {**centre, "radius": radius}, **settings}
        found |= {"points": points, "bits": bits}
        reason = checker.check(found)
        if reason is None:
            return found
    raise ConvergenceError(f"the checker does not accept the certificate: {reason}")


def check(certificate: Any) -> str | None:
    """None where the certificate proves what it says, else why not. Raises InputError for a problem that no checker knows."""
    named = certificate.get("problem") if isinstance(certificate, dict) else None
    name = named.get("name") if isinstance(named, dict) else None
    if not isinstance(name, str) or name not in CHECKERS:
        raise InputError(f"a certificate for {shortened(name)}: allowed is one for {', '.join(CHECKERS)}")
    verdict: Callable[[Any], str | None] = import_module(CHECKERS[name]).check
    return verdict(certificate)


def read(path: Path) -> Any:
    """The JSON of a certificate. Raises InputError for a file that cannot be read, is larger than 1 MB or is no JSON."""
    try:
        return json_of(text_of(bytes_of(path, LARGEST_CERTIFICATE, "a certificate")), "allowed is a certificate in JSON")
    except InputError:
        raise
    except ValueError as error:
        raise InputError(f"{path}: {error}") from error


def _log_size(problem: Problem, proof: Proof) -> float:
    """ln |D| on the circle of the proof."""
    with at_bits(proof.bits):
        centre, radius = proof.region["centre"], proof.region["radius"]
        D = Enclosure(enclosable(problem), proof.bits)(acb(decimal(centre["re"]), decimal(centre["im"])) + decimal(radius))
        return float(abs(D).log().mid())
