"""What is proved: modes of the gallery, all that grows, critical numbers between two decimals, and error bars held against proofs."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import mpmath
from claims import Case, Claim, main

import shootstab as st
from shootstab.analyses.certificate import certify, check, read, require_checker
from shootstab.analyses.contour_proof import CONTOUR_BITS
from shootstab.analyses.proof import Proof
from shootstab.analyses.prove import prove, prove_growing, prove_interval, prove_region
from shootstab.analyses.proved_verdicts import proved_verdicts
from shootstab.analyses.reference import claims
from shootstab.core.allowed import VERDICT_DIGITS
from shootstab.core.records import CONFIRMED, SPURIOUS
from shootstab.io import scenes
from shootstab.models.catalogue.published import PUBLISHED
from shootstab.problems.capabilities import CLOSED_FORM, ENCLOSABLE

ALPHA = 1.02054744928533  # derived: the critical point of plane Poiseuille flow to fifteen digits
NEAR = 64  # chosen: spare bits on a boundary that a mode passes at 1e-11
TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)  # chosen


def timed(ask: Callable[[], Any]) -> tuple[Any, str]:
    """The answer, and the processor time that it took."""
    began = time.process_time()
    return ask(), f"{time.process_time() - began:.1f} s"


def stated(name: str, expected: str, ask: Callable[[], Proof]) -> Case:
    """A theorem in words."""
    proof, seconds = timed(ask)
    return Case(name, expected, proof.statement, 0.0, f"{seconds}, {proof.evaluations} values of D, {proof.bits} bits")


def certified(name: str, problem: Any, proof: Proof, spare: int) -> Case:
    """Whether the checker accepts the certificate that was handed out, read from its decimals."""
    certificate, made = timed(lambda: certify(problem, proof, spare))
    reason, seconds = timed(lambda: check(certificate))
    return Case(f"{name}, certificate", "accepted", "accepted" if reason is None else reason, 0.0, f"made in {made}, checked in {seconds}")


PLATES = ("plate, Malik 3", "plate, Malik 6", "plate, Malik 6, Stokes")
# 17 s of processor time to minutes each
LONG = ("suction layer", "maxwell-couette", "oblique-wave", "oldroyd-couette", "pipe", "taylor-couette", "mack", *PLATES)

UNCERTIFIED = ("suction layer",)  # chosen: modes for which a certificate is not looked for: in 590 s there was none, with 2,000 bits
CHECKED = ("Pöschl–Teller, ν = 0.2", "legendre", "kink")  # chosen: modes with certificates that the quick form makes and checks


def stored() -> Iterator[Case]:
    """Certificates beside this script: modes of the built-in chutes within 1e-20, the channel on both sides of its critical R."""
    for path in sorted((Path(__file__).parent / "certificates").glob("*.json")):
        reason, seconds = timed(lambda p=path: check(read(p)))
        yield Case(f"{path.name}", "accepted", "accepted" if reason is None else reason, 0.0, f"checked in {seconds}")


def gallery(quick: bool) -> Iterator[Case]:
    """Every published mode of a problem that can be proved, to 12 digits."""
    for case in PUBLISHED:
        if quick and case.name in LONG:
            continue
        problem = case.problem()
        if CLOSED_FORM.of(problem) is None and ENCLOSABLE.of(problem) is None:
            yield Case(case.name, "–", "no enclosure", None)
            continue
        try:
            proof, seconds = timed(lambda p=problem, s=case.sigma: prove(p, s, 12))
        except st.ConvergenceError as error:
            yield Case(case.name, "a proof", "not proved", 0.0, str(error))
            continue
        centre = proof.region["centre"]
        found = complex(float(centre["re"]), float(centre["im"])) / case.unit
        size = max(abs(case.value.real), abs(case.value.imag))
        yield Case(
            case.name, case.value, found, case.tolerance / abs(case.unit) / size, f"{proof.count} in {proof.region['radius']}, {seconds}"
        )
        if case.name in CHECKED or not (quick or case.name in UNCERTIFIED):
            yield from checked(case.name, problem, proof)


def checked(name: str, problem: Any, proof: Proof) -> Iterator[Case]:
    """The certificate of a mode of the gallery, where a checker takes its problem."""
    try:
        require_checker(problem)
    except st.InputError as error:
        yield Case(f"{name}, certificate", "–", "none", None, str(error))
        return
    try:
        yield certified(name, problem, proof, 0)
    except st.ConvergenceError as error:
        yield Case(f"{name}, certificate", "–", "none", None, str(error))


CHUTES = (("high", 0.00397, 17), ("mid", 0.00102, 17), ("fig2", 0.00169 - 0.00157j, 17), ("low", 0.00727 - 0.0119j, 18))


def chutes() -> Iterator[Case]:
    """The mode of each built-in chute, for every flow with exactly its mass flux in a bracket, and its certificate."""
    for name, guess, digits in CHUTES:
        problem = scenes.load(name).problem
        proof, seconds = timed(lambda p=problem, s=guess, d=digits: prove(p, s, d))
        yield stated_of(name, proof, seconds)
        yield certified(f"chute, {name}", problem, proof, 0)


def stated_of(name: str, proof: Proof, seconds: str) -> Case:
    """One mode of a steady flow that exists."""
    found = f"{'exists' in proof.premise} and {proof.count} in {proof.region['radius']}"
    note = f"{seconds}, {proof.evaluations} values of D, {proof.bits} bits, alone in {proof.alone:.1e}"
    return Case(f"chute, {name}", f"True and 1 in {proof.region['radius']}", found, 0.0, note)


def regions() -> Iterator[Case]:
    """Half-annuli of the chute that hold a growing mode and no other."""
    for name, centre, inner, outer in (("high", 0.0, 0.001, 0.05), ("low", -0.0383j, 0.02, 0.04)):
        problem, region = scenes.load(name).problem, st.HalfAnnulus(centre, inner, outer)
        proof, seconds = timed(lambda p=problem, r=region: prove_region(p, r, workers=1))
        found = f"{'exists' in proof.premise} and {proof.count}"
        yield Case(
            f"chute, {name}: {inner} < |σ − ({centre})| < {outer}", "True and 1", found, 0.0, f"{seconds}, {proof.evaluations} enclosures"
        )


def verdicts() -> Iterator[Case]:
    """The verdicts on the bundled spectra of the built-in chutes, to six digits, against theorems."""
    for name, _, _ in CHUTES:
        problem = scenes.load(name).problem
        report = st.verify(problem, claims(problem, VERDICT_DIGITS, None).tolist(), missing="none")
        found, seconds = timed(lambda p=problem, r=report: proved_verdicts(p, r))
        asked = [
            verdict.verdict for verdict, theorem in zip(report.verdicts, found, strict=True) if verdict.verdict in (CONFIRMED, SPURIOUS)
        ]
        proved = sum(theorem.proved is not None for theorem in found)
        note = f"{proved} of {len(asked)} proved, {asked.count(CONFIRMED)} confirmed, {asked.count(SPURIOUS)} spurious, {seconds}"
        yield Case(f"chute, {name}: verdicts overturned", "0", str(sum(theorem.contradicts for theorem in found)), 0.0, note)


BARS = (
    ("plane Poiseuille", st.gallery.PlanePoiseuille(), 0.00374 - 0.2375j),
    ("plane Poiseuille, R = 100", st.gallery.PlanePoiseuille(100.0), -0.163 - 0.478j),
    ("Bénard", st.gallery.benard(2000.0, 3.117), 2.146),
)


def bars(quick: bool) -> Iterator[Case]:
    """The bounds of double precision, by method and tolerance, against discs in which exactly one eigenvalue is proved to lie."""
    scenes_too = () if quick else tuple((f"chute, {name}", scenes.load(name).problem, guess) for name, guess, _ in CHUTES)
    for name, problem, guess in (*BARS, *scenes_too):
        proof = prove(problem, guess, 17)
        with mpmath.workdps(30):
            truth = mpmath.mpc(proof.region["centre"]["re"], proof.region["centre"]["im"])
            broken, ratios = 0, []
            for method in (st.Frame, st.Compound, st.Riccati):
                for rtol in TOLERANCES:
                    mode = st.refine(problem, guess, rtol=rtol, method=method())
                    off = float(abs(mpmath.mpc(mode.sigma) - truth)) + float(proof.region["radius"])
                    broken += off > mode.error
                    ratios.append(mode.error / off)
        note = f"{len(ratios)} bars, the bound is {min(ratios):.1f} to {max(ratios):.0f} times the distance"
        yield Case(f"{name}: bars broken", "0", str(broken), 0.0, note)


def cases(quick: bool) -> Iterator[Case]:
    yield from gallery(quick)
    layer = st.gallery.benard(2000.0, 3.117)
    yield stated("Bénard, Ra = 2000", "exactly one eigenvalue has Re σ ≥ 0.0", lambda: prove_growing(layer, 0.0))
    for rayleigh, said in ((1707.7617, "no eigenvalue has"), (1707.7618, "exactly one eigenvalue has")):
        near = st.gallery.benard(rayleigh, 3.11632355)
        yield stated(f"Bénard, Ra = {rayleigh}", f"{said} Re σ ≥ 0.0", lambda p=near: prove_growing(p, 0.0, None, NEAR))  # type: ignore[misc]
    yield from bars(quick)
    if quick:
        return
    yield from stored()
    yield from chutes()
    yield from regions()
    yield from verdicts()
    yield stated(
        "Bénard, every Ra",
        "for every rayleigh from 1 to 1707 no eigenvalue has Re σ ≥ 0.0",
        lambda: prove_interval(layer, "rayleigh", 1.0, 1707.0, floor=0.0),
    )
    for reynolds, alpha, floor, said, spare in (
        (10000.0, 1.0, -0.001, "exactly one eigenvalue has", 24),
        (5772.2218, ALPHA, 0.0, "no eigenvalue has", NEAR),
        (5772.2219, ALPHA, 0.0, "exactly one eigenvalue has", NEAR),
    ):
        channel, name = st.gallery.PlanePoiseuille(reynolds, alpha, half=False), f"the channel, R = {reynolds:.10g}"
        proof, seconds = timed(lambda c=channel, f=floor, s=spare: prove_growing(c, f, None, s))  # type: ignore[misc]
        yield Case(name, f"{said} Re σ ≥ {floor!r}", proof.statement, 0.0, f"{seconds}, {proof.evaluations} values of D, {proof.bits} bits")
        yield certified(name, channel, proof, spare)
    channel, region = st.gallery.PlanePoiseuille(100.0, half=False), st.Rectangle(-0.4 - 1.0j, 0.1 + 0j)
    proof, seconds = timed(lambda: prove_region(channel, region))
    yield Case("the channel, R = 100, a rectangle", str(st.count(channel, region)), str(proof.count), 0.0, seconds)
    yield certified("the channel, R = 100, a rectangle", channel, proof, CONTOUR_BITS)


CLAIM = Claim(
    "What the program says of modes is proved in ball arithmetic, and certificates are accepted by a checker of their own.",
    "guide/proofs.md, lemmas E1 to E22, P1, P2, C1 to C6, K1 to K3, R1 and R2",
    cases,
)

if __name__ == "__main__":
    main(CLAIM)
