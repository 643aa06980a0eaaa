"""Results of analyses. Every result carries its evidence; a failed search is a result with a reason."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from shootstab.core.regions import Region

CONVERGED = "converged"
NOT_CONVERGED = "not converged"

CONFIRMED = "confirmed"
INACCURATE = "inaccurate"
SPURIOUS = "spurious"
CONTINUUM = "continuum"
UNRESOLVED = "unresolved"
VERDICTS = (CONFIRMED, INACCURATE, SPURIOUS, CONTINUUM, UNRESOLVED)
ALL_DIGITS = 99.0  # chosen: the digits on which two equal numbers agree, more than doubles have


@dataclass(frozen=True)
class Budget:
    """What an error bound is made of; each part is an absolute bound in σ."""

    integration: float
    far_field: float
    steady_flow: float
    root: float
    rounding: float

    @property
    def total(self) -> float:
        """The sum of the parts."""
        return self.integration + self.far_field + self.steady_flow + self.root + self.rounding

    def as_dict(self) -> dict[str, float]:
        """The parts of the bound by name, for JSON."""
        return asdict(self)


@dataclass(frozen=True)
class Mode:
    """One eigenvalue: sigma (complex, or an mpmath number) with |true − sigma| ≤ error (a float, or an mpf where a float underflows).

    status is 'converged' or says in a sentence what went wrong. continuum_distance is the distance of sigma to the continuous
    spectrum, infinite if the problem has none. path says along which path in z the system was integrated, system of which orders it
    was and in which numbers. A multiplicity m > 1 stands for m eigenvalues, equal or not told apart, all within error of sigma, their
    mean. scale is the distance |2D′/D″| over which D is linear at sigma, about that to the other modes (NaN where it was not measured);
    atol is the error in the units of sigma that counted as converged whatever |sigma| is. guess_distance is |sigma − guess|, and nearer
    says which modes are nearer to the guess where sigma lies outside its neighbourhood.
    """

    sigma: Any
    error: Any
    budget: Budget
    status: str
    method: str
    evaluations: int
    seconds: float
    continuum_distance: float = math.inf
    path: str = "real"
    multiplicity: int = 1
    system: str = ""
    scale: float = math.nan
    atol: float = 0.0
    guess_distance: float = math.nan
    nearer: str = ""

    def __repr__(self) -> str:
        sigma = self.sigma if hasattr(self.sigma, "ae") else complex(self.sigma)
        several = f", multiplicity {self.multiplicity}" if self.multiplicity > 1 else ""
        return f"Mode({sigma} ± {float(self.error):.1e}{several}, {self.status})"

    @property
    def digits(self) -> float:
        """How many digits of sigma hold: −log10(error/|σ|)."""
        return digits_between(self.error, abs(self.sigma))

    @property
    def converged(self) -> bool:
        """Whether the iteration reached what was asked."""
        return self.status == CONVERGED


def digits_between(difference: Any, size: Any) -> float:
    """−log10(difference/size) of doubles or mpmath reals, ALL_DIGITS when the two are the same; 0 when nothing agrees."""
    if not size > 0 or not difference < math.inf:
        return 0.0
    if difference == 0:
        return ALL_DIGITS
    if isinstance(difference, float) and isinstance(size, float):
        return max(0.0, math.log10(size) - math.log10(difference))
    from mpmath import log10, mpf

    return max(0.0, float(log10(mpf(size) / mpf(difference))))


@dataclass(frozen=True)
class Verdict:
    """What is to be said of one claimed eigenvalue, and why.

    sigma is the mode that the claim means (None if there is none), error its bound, multiplicity its multiplicity,
    digits_agreed = −log10(|claimed − σ|/|σ|), and growth_digits the same of the real parts alone. atol is the absolute accuracy within
    which the claim counts as right whatever |σ| is.
    """

    claimed: complex
    verdict: str
    why: str
    sigma: complex | None = None
    error: float | None = None
    digits_agreed: float | None = None
    continuum_distance: float = math.inf
    multiplicity: int = 1
    growth_digits: float | None = None
    atol: float = 0.0


@dataclass(frozen=True)
class Report:
    """Verdicts in the order of the claims, and the modes that the claimed spectrum lacks.

    region is where missing modes were looked for, None where they were not; claims_inside is how many of the claims lie in it. searched
    says both in words, and undecided names what could not be searched. dropped entries of the spectrum were no numbers that could be
    eigenvalues, and were left out when it was read. rests_on says by which method zeros were counted and bounds computed.
    """

    verdicts: tuple[Verdict, ...]
    missing: tuple[Mode, ...]
    digits: int
    searched: str = ""
    undecided: tuple[str, ...] = ()
    dropped: int = 0
    region: Region | None = None
    claims_inside: int = 0
    rests_on: str = ""

    @property
    def summary(self) -> Mapping[str, int]:
        """How many of each verdict, and how many modes are missing."""
        counts = {v: sum(x.verdict == v for x in self.verdicts) for v in VERDICTS}
        return {**counts, "missing": len(self.missing)}

    @property
    def bad_news(self) -> bool:
        """Whether anything is inaccurate, spurious, unresolved or missing."""
        return bool(self.missing) or any(v.verdict in (INACCURATE, SPURIOUS, UNRESOLVED) for v in self.verdicts)

    @property
    def strictly_bad_news(self) -> bool:
        """Whether anything is bad news, a `continuum` among it."""
        return self.bad_news or any(v.verdict == CONTINUUM for v in self.verdicts)

    def __repr__(self) -> str:
        counts = ", ".join(f"{n} {what}" for what, n in self.summary.items() if n)
        return f"Report({counts or 'no eigenvalues'}; {self.digits} digits)"
