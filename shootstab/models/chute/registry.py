"""The parameters of a chute, each written down once: name, symbol, unit, meaning, range, option, default.

`Chute` checks itself by this registry; scene files, the options of `sweep`, the axes of maps, the families of a sweep, the exact decimals
of many digits and the last bits that a base-flow error changes are read from it. It imports nothing heavy, so that the command line may
look.

A new parameter is an entry here, a field of `Chute` (parameters.py), and the formula that uses it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from shootstab.core.errors import InputError, shortened
from shootstab.core.given import require_real

RADIAL = ("lun-savage", "carnahan-starling")  # their order is the number by which compiled code knows them
WALL_FORMS = ("printed", "isotropic")
BRANCHES = ("high", "mid", "low")
REQUIRED = object()  # the default of a parameter that has none
CHUTE, WAVE, FLOW = "chute", "wave", "flow"


@dataclass(frozen=True)
class Parameter:
    """One parameter.

    of: CHUTE, what grains and base are; FLOW, which member of the family of flows; WAVE, the wavenumbers. choices, where not empty, are
    the words it may be; otherwise it is a number with `holds`, and `allowed` says so in words. swept: whether a sweep may vary it.
    symbol and label, what an axis of a map is called, are in TeX.
    """

    name: str
    of: str
    symbol: str
    unit: str
    meaning: str
    allowed: str = "a finite number"
    holds: Callable[[float], bool] = math.isfinite
    choices: tuple[str, ...] = ()
    default: Any = REQUIRED
    swept: bool = True

    @property
    def kind(self) -> type:
        """float or str, as a scene file has it."""
        return str if self.choices else float

    @property
    def option(self) -> str:
        """What the command line calls it."""
        return "--" + self.name.replace("_", "-")

    @property
    def label(self) -> str:
        """The label for the axis of a map: what it is, its symbol and its unit."""
        return f"{self.meaning} {self.symbol}{' / ' + self.unit if self.unit else ''}"

    def check(self, value: Any) -> None:
        """Raise InputError unless the value is allowed."""
        if self.choices:
            if value not in self.choices:
                raise InputError(f"{self.name} = {shortened(value)}: allowed is one of {', '.join(self.choices)}")
        else:
            require_real(self.name, value, self.holds, self.allowed)


def _positive(x: float) -> bool:
    return 0.0 < x < math.inf


PARAMETERS: tuple[Parameter, ...] = (
    Parameter("kx", WAVE, "$k_x$", "$d^{-1}$", "downslope wavenumber"),
    Parameter("ky", WAVE, "$k_y$", "$d^{-1}$", "cross-slope wavenumber"),
    Parameter(
        "far_temperature", FLOW, r"$T_\infty$", r"$(d\,g\cosθ)$", "far temperature", "a finite number above 0", _positive, default=None
    ),
    Parameter("mass_flux", FLOW, "$Q_0$", r"$\sqrt{d^3 g\,\cosθ}$", "mass flux", "a finite number above 0", _positive, default=None),
    Parameter(
        "branch", FLOW, "", "", "member of the flows with one mass flux, by far temperature", choices=BRANCHES, default=None, swept=False
    ),
    Parameter("e", CHUTE, "e", "", "restitution between grains", "a number with 0 < e <= 1", lambda x: 0.0 < x <= 1.0),
    Parameter("e_w", CHUTE, "$e_w$", "", "restitution with the base", "a number with 0 < e_w <= 1", lambda x: 0.0 < x <= 1.0),
    Parameter("r", CHUTE, "r", "", "roughness of the base", "a number with 0 <= r < 1", lambda x: 0.0 <= x < 1.0),
    Parameter("tan_theta", CHUTE, r"$\tan\theta$", "", "slope", "a finite number above 0", _positive),
    Parameter(
        *("nu_max", CHUTE, r"$\nu_m$", "", "volume fraction at which grains are packed", "a number with 0 < nu_max < 1"),
        *(lambda x: 0.0 < x < 1.0,),
        default=0.62,
    ),
    Parameter("radial", CHUTE, "$g_0$", "", "radial distribution at contact", choices=RADIAL, default="lun-savage", swept=False),
    Parameter("wall", CHUTE, "$S_z$", "", "normal stress of the base", choices=WALL_FORMS, default="printed", swept=False),
)
BY_NAME = {p.name: p for p in PARAMETERS}
SWEPT = tuple(p for p in PARAMETERS if p.swept)


def names(of: str, *, numbers: bool = False) -> tuple[str, ...]:
    """The names of the parameters of the chute, of the flow or of the wave, in order; with numbers=True only those that are numbers."""
    return tuple(p.name for p in PARAMETERS if p.of == of and not (numbers and p.choices))
