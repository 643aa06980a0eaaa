"""Certificates: a proof as a JSON file of exact decimals that a checker of its own, on integers and mpmath's intervals, verifies anew.

{"format": 2, "problem": {…}, "count": n, "region": {"re", "im", "radius"}, {"left", "low", "right", "high"} or
{"floor"}, "outer", "weight", "points", "bits", "order",
"steps"}: what is claimed, and the settings with which the checker finds that it holds; or {"format": 2, "parts": [… of these]}. One that
has a base flow says besides between which values it lies, and which lemmas are relied on. Problems in equations are written with
polynomial coefficients (formulation/polynomial_form.py), which stand in the certificate. The checker trusts none of the settings; poor
ones make it refuse.
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any

from shootstab.analyses.contour_proof import CONTOUR_BITS
from shootstab.analyses.enclosables import factors, one_polynomial
from shootstab.analyses.polynomial_certificate import candidates
from shootstab.analyses.proof import Proof
from shootstab.analyses.rectangle_certificate import rectangles
from shootstab.checkers import CHECKERS
from shootstab.core.errors import ConvergenceError, InputError, shortened
from shootstab.core.reading import bytes_of, json_of, text_of
from shootstab.problems.capabilities import CERTIFICATES, FACTORS, POLYNOMIAL_PENCIL
from shootstab.problems.protocol import Problem

LARGEST_CERTIFICATE = 2**20  # chosen: bytes of a certificate
MOST_FACTORS = 16  # chosen: parts of a certificate


def certify(problem: Problem, proof: Proof, spare_bits: int = CONTOUR_BITS) -> dict[str, Any]:
    """The certificate of a proof on a disc, a rectangle or all that grows; it is handed out only after its checker has accepted it.

    Where D has factors it has one part for each. spare_bits as in `prove_growing`. Raises InputError for a problem without a
    checker and a proof on another region or for an interval of a parameter, ConvergenceError where the checker does not accept.
    """
    if proof.interval is not None:
        raise InputError(
            "a proof for every {name} from {low} to {high}: allowed is one for one value of the parameters".format(**proof.interval)
        )
    parts = FACTORS.of(problem)
    if parts:
        made = [_certified(part, proof, count, spare_bits) for part, count in zip(parts, proof.counts, strict=True)]
        return {"format": 2, "parts": made}
    return _certified(problem, proof, proof.count, spare_bits)


def require_checker(problem: Problem, rectangle: bool = False) -> None:
    """Raises InputError for a problem that no checker takes, or of which none takes a rectangle, with the reason."""
    if rectangle and not one_polynomial(factors(problem)):
        raise InputError(
            "a rectangle of this problem is proved along its boundary by hundreds of values and bounds of D, each of which would take "
            "a checker a second: allowed is a certificate of a disc about a mode"
        )
    for part in FACTORS.of(problem) or (problem,):
        if CERTIFICATES.of(part) is None:
            POLYNOMIAL_PENCIL.required(part)()


def _certified(problem: Any, proof: Proof, count: int, spare_bits: int) -> dict[str, Any]:
    reason = None
    own = CERTIFICATES.of(problem)
    if own is not None:
        made = own(proof, count, spare_bits)
    elif proof.region["shape"] == "rectangle" and proof.floor is None:
        made = rectangles(POLYNOMIAL_PENCIL.required(problem)(), sides_of(proof), count)
    else:
        made = candidates(POLYNOMIAL_PENCIL.required(problem)(), proof, count)
    for found in made:
        reason = _checker(found["problem"]["name"]).check(found)
        if reason is None:
            return dict(found)
    raise ConvergenceError(f"the checker does not accept the certificate: {reason}")


def _checker(name: str) -> Any:
    return import_module(f"shootstab.checkers.{CHECKERS[name]}")


def disc_of(proof: Proof, allowed: str) -> tuple[dict[str, str], str]:
    """Centre and radius of the disc that a proof is about. Raises InputError, which says what is allowed, for another region."""
    if proof.region["shape"] != "disc":
        raise InputError(f"a proof on a {proof.region['shape']}: allowed is {allowed}")
    return proof.region["centre"], proof.region["radius"]


def sides_of(proof: Proof) -> dict[str, str]:
    """The sides of the rectangle that a proof is about."""
    low, high = proof.region["corners"]
    return {"left": low["re"], "low": low["im"], "right": high["re"], "high": high["im"]}


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
        reason: str | None = _checker(name).check(part)
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
