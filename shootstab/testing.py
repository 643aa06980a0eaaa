"""For CI jobs: an assertion that fails when a stability code drifts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from shootstab.core.records import CONFIRMED, Verdict, digits_between
from shootstab.io.notation import claimed_digits, held_complex

if TYPE_CHECKING:
    from shootstab.problems.protocol import Problem


def assert_eigenvalue(problem: Problem, claimed: complex, digits: int = 8) -> None:
    """Raise AssertionError unless `claimed` is an eigenvalue of the problem to so many digits (1 to 12).

    The verdict is that of `verify`: exactly one zero of D inside the circle that these digits mean. The error says the verdict and
    why, the true value, its own error, and how many digits agree. Raises InputError for digits out of range.
    """
    __tracebackhide__ = True
    from shootstab.analyses.verify import verify

    verdict = verify(problem, [complex(claimed)], digits=digits).verdicts[0]
    if verdict.verdict != CONFIRMED:
        raise AssertionError(_failure(problem, verdict, digits))


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
