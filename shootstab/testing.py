"""Assertions for CI jobs, which fail when a stability code drifts."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shootstab.core.errors import InputError
from shootstab.core.records import CONFIRMED, CONTINUUM, Mode, Report, Verdict, digits_between
from shootstab.io.conventions import Convention
from shootstab.io.notation import claimed_digits, held_complex

if TYPE_CHECKING:
    from shootstab.core.regions import Region
    from shootstab.io.scenes import Scene
    from shootstab.problems.protocol import Problem


def assert_eigenvalue(problem: Any, claimed: complex, digits: int = 8) -> None:
    """Raise AssertionError unless `claimed` is an eigenvalue of the problem, or of the scene of that name, to so many digits (1 to 12).

    The verdict is that of `verify`: exactly one zero of D inside the circle that these digits mean. The error says the verdict and
    why, the true value, its own error, and how many digits agree. Raises InputError for digits out of range.
    """
    __tracebackhide__ = True
    from shootstab.analyses.verify import verify
    from shootstab.by_name import problem_of

    problem = problem_of(problem)
    verdict = verify(problem, [complex(claimed)], digits=digits).verdicts[0]
    if verdict.verdict != CONFIRMED:
        raise AssertionError(_failure(problem, verdict, digits))


MISSING_IN_TESTS = ("none", "within", "region")


def assert_spectrum(
    problem: Any,
    claimed: str | Path | Iterable[complex],
    digits: int = 6,
    convention: Convention | None = None,
    missing: str = "none",
    region: Region | None = None,
    as_: str | None = None,
) -> Report:
    """The report, if every claim is an eigenvalue to so many digits; AssertionError with the table of verdicts otherwise.

    problem is a problem or the name of a scene, claimed a list or the name of a file. convention is what the numbers are (σ of exp(σt) by
    default), or as_ is their kind: "growth", "frequency", or "phase-speed", with the scene's own wavenumber. missing="none" leaves open
    whether modes are missing; "within" fails for each that is missing among the claims, "region" for each from the region given.
    A `continuum` is no failure. Raises InputError.
    """
    __tracebackhide__ = True
    from shootstab.analyses.verify import verify
    from shootstab.by_name import scene_of
    from shootstab.io.readers import read

    if missing not in MISSING_IN_TESTS or (missing == "region") != (region is not None):
        raise InputError(f"missing = {missing!r}: allowed is none, within, or region together with a region")
    if convention is not None and as_ is not None:
        raise InputError("convention and as_: allowed is one of them")
    spectrum = read(claimed) if isinstance(claimed, str | Path) else list(claimed)
    scene = scene_of(problem)
    seen = convention or _kind(as_, scene)
    own = scene.seen(seen).problem
    report = seen.shown(verify(own, seen.read(spectrum), digits=digits, region=region, missing=missing))
    bad = [v for v in report.verdicts if v.verdict not in (CONFIRMED, CONTINUUM)]
    lost = report.missing
    if bad or lost:
        raise AssertionError(_table(report, digits, len(bad), lost))
    return report


def _kind(kind: str | None, scene: Scene) -> Convention:
    """Numbers of this kind, a phase speed with the wavenumber of the scene. Raises InputError where it has none."""
    if kind == "phase-speed":
        return Convention(kind, alpha=scene.wavenumber and scene.wavenumber[1])
    return Convention(kind or "growth")


def _table(report: Report, digits: int, bad: int, lost: tuple[Mode, ...]) -> str:
    """One line a claim and a missing mode, under a sentence that counts them."""
    from shootstab.cli.lines import with_i

    lines = [f"{bad} of {len(report.verdicts)} eigenvalues are not what they should be to {digits} digits, {len(lost)} missing:"]
    for number, v in enumerate(report.verdicts, 1):
        mode = "" if v.sigma is None else f"  mode {held_complex(v.sigma, v.error)}"
        why = f": {with_i(v.why)}" if v.verdict != CONFIRMED else ""
        lines.append(f"{number:>4}  {claimed_digits(v.claimed, digits)}  {v.verdict}{why}{mode}")
    return "\n".join([*lines, *(f"      missing  {held_complex(m.sigma, m.error)} (error {m.error:.1e})" for m in lost)])


def _failure(problem: Problem, verdict: Verdict, digits: int) -> str:
    said = f"{claimed_digits(verdict.claimed, digits)} is not an eigenvalue to {digits} digits, it is {verdict.verdict}: {verdict.why}"
    return f"{said}\n{_truth(problem, verdict)}"


def _truth(problem: Problem, verdict: Verdict) -> str:
    """The mode that the claim means; if it means none, where an iteration from there ends."""
    sigma, error, name = verdict.sigma, verdict.error, "true value"
    if sigma is None:
        from shootstab.analyses.refine import refine

        mode = refine(problem, verdict.claimed)
        if not mode.converged:
            return f"no true value is known: an iteration that starts there finds no mode ({mode.status})"
        sigma, error, name = mode.sigma, mode.error, "mode that an iteration from there finds"
    agree = digits_between(abs(verdict.claimed - sigma), abs(sigma))
    bound = "unknown" if error is None else f"{error:.1e}"
    return f"{name}: {held_complex(sigma, error)} (error {bound}); {agree:.1f} digits agree"
