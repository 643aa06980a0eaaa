"""What the numbers of a spectrum mean: named by the user, never guessed, and never evaluated as code.

The problems here carry exp(σt + iαx). Somebody else's number v, in units of length L and velocity V of his own (both in those of the
problem), is

    growth        exp(± v t)                          σ = ± v V/L                       + by default
    frequency     exp(i(αx ± v t))                    σ = ± i v V/L                     − by default
    phase-speed   exp(iα(x ± v t))                    σ = ± i α v V/L, α in 1/L         − by default

and where his waves go as exp(−iαx), the complex conjugate of all that: the spectrum of a real problem for −α is the conjugate of that
for α.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from shootstab.core.errors import InputError
from shootstab.core.records import Report
from shootstab.core.regions import Polygon

KINDS = ("growth", "frequency", "phase-speed")
SYMBOLS = {"growth": "σ", "frequency": "ω", "phase-speed": "c"}
SIGNS = {"growth": "+", "frequency": "-", "phase-speed": "-"}
STREAMWISE = ("alpha", "kx", "k")  # chosen: parameters that are a streamwise wavenumber wherever they are the only ones of these
WAVE_EXPONENT = re.compile(r"i[ (]?(\w+?) ?[xz]\b")  # chosen: the NAME of exp(σt + iNAMEx), along x or the axis of a pipe


@dataclass(frozen=True)
class Convention:
    """kind, the sign of time in the exponent, α in the user's units (for a phase speed), his units, and whether his waves are exp(−iαx)."""

    kind: str = "growth"
    sign: str | None = None
    alpha: float | None = None
    length: float = 1.0
    velocity: float = 1.0
    conjugate: bool = False

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InputError(f"--as {self.kind}: allowed is {', '.join(KINDS)}")
        if self.sign not in (None, "+", "-"):
            raise InputError(f"--sign {self.sign}: allowed is + or -")
        for name, value in (("length", self.length), ("velocity", self.velocity)):
            if not 0.0 < value < math.inf:
                raise InputError(f"--{name} {value:g}: allowed is a finite number above 0")
        if self.kind == "phase-speed" and self.alpha is None:
            raise InputError("--as phase-speed: needs the wavenumber, --alpha")
        if self.alpha is not None and self.kind != "phase-speed":
            raise InputError(f"--alpha: allowed with --as phase-speed only, a {self.kind} does not depend on it")
        if self.alpha is not None and not (math.isfinite(self.alpha) and self.alpha != 0.0):
            raise InputError(f"--alpha {self.alpha:g}: allowed is a finite number other than 0")

    @property
    def unit(self) -> complex:
        """σ/v."""
        size = (1.0 if (self.sign or SIGNS[self.kind]) == "+" else -1.0) * self.velocity / self.length
        if self.kind == "growth":
            return complex(size)
        return 1j * size * (1.0 if self.alpha is None else self.alpha)

    @property
    def symbol(self) -> str:
        """What v is called."""
        return SYMBOLS[self.kind]

    @property
    def plain(self) -> bool:
        """Whether v is σ itself."""
        return self.unit == 1.0 and not self.conjugate

    @property
    def formula(self) -> str:
        """The mode that v stands for, in words for a heading."""
        sign = self.sign or SIGNS[self.kind]
        time = {"growth": f"exp({sign}σt)", "frequency": f"exp(i(αx {sign} ωt))", "phase-speed": f"exp(iα(x {sign} ct))"}[self.kind]
        return time + (", waves exp(-iαx)" if self.conjugate else "")

    def read(self, values: Iterable[complex]) -> list[complex]:
        """Numbers that a problem with eigenvalue v may be asked about: conjugates of them where waves are exp(−iαx)."""
        return [complex(v).conjugate() if self.conjugate else complex(v) for v in values]

    def written(self, sigmas: Any) -> Any:
        """Eigenvalues σ of the problem, an array (m,), as numbers of this convention."""
        values = sigmas / self.unit
        return values.conj() if self.conjugate else values

    def shown(self, report: Report) -> Report:
        """A report on such numbers, in the user's own."""
        if not self.conjugate:
            return report
        verdicts = (
            replace(v, claimed=v.claimed.conjugate(), sigma=None if v.sigma is None else complex(v.sigma).conjugate())
            for v in report.verdicts
        )
        missing = tuple(replace(m, sigma=m.sigma.conjugate()) for m in report.missing)
        region = None if report.region is None else Polygon(tuple(v.conjugate() for v in report.region.hull))
        return replace(report, verdicts=tuple(verdicts), missing=missing, region=region)


def wavenumber(problem: object, tables: Mapping[str, Any], eigenvalue: str) -> tuple[str, float] | None:
    """The streamwise wavenumber α of exp(σt + iαx): what it is called, and its value; None where no name, or more than one, may be it.

    It is the parameter that stands behind the i of the exponential, where the words on the eigenvalue have one; otherwise the one of
    STREAMWISE that the problem or its tables hold.
    """
    from shootstab.problems.capabilities import FAMILY  # numbers are loaded with a problem, and not by the program's help

    held = {name: getattr(problem, name) for name in STREAMWISE if hasattr(problem, name)}
    family_of = None if tables else FAMILY.of(problem)
    held |= {} if family_of is None else family_of(()).here
    for table in tables.values():
        held |= {**table, **table.get("parameters", {})}
    named = {name: float(value) for name, value in held.items() if isinstance(value, int | float) and value != 0}
    stated = next((words[1] for words in WAVE_EXPONENT.finditer(eigenvalue) if words[1] in named), None)
    names = [name for name in STREAMWISE if name in named] if stated is None else [stated]
    return (names[0], named[names[0]]) if len(names) == 1 else None
