"""What a problem may offer beside the protocol, and the sentence that refuses where it does not.

A capability is an attribute of the problem. One that is absent has the default given here, so that a problem writes down only what it has,
and no part of the engine asks of which class a problem is.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import InputError
from shootstab.problems.protocol import GENERIC_SIGMA, ComplexArray, Problem


@dataclass(frozen=True)
class Capability:
    """The attribute `name` of a problem, its value where there is none, and what is said where it is needed and not offered."""

    name: str
    default: Any
    refusal: str

    def of(self, problem: object) -> Any:
        """What the problem offers, or the default."""
        return getattr(problem, self.name, self.default)

    def required(self, problem: object) -> Any:
        """What the problem offers. Raises InputError where it offers nothing, with the problem's own reason if it has one in `why_not`."""
        offered = self.of(problem)
        if offered is None and self.name in getattr(problem, "why_not", {}):
            raise InputError(problem.why_not[self.name])  # type: ignore[attr-defined]
        if offered is None:
            raise InputError(f"{self.refusal} ({type(problem).__name__} has no `{self.name}`)")
        return offered


class Continuum(Protocol):
    """σ_c(z), analytic in z, with det(C0 + σ_c C1) = 0: real z give the continuous spectrum, and paths lead around a z with σ_c(z) = σ."""

    def heights(self, points: int) -> NDArray[np.float64]:
        """Real z (points,), rising from the wall, over which σ_c is the spectrum."""
        ...

    def __call__(self, z: ComplexArray) -> ComplexArray:
        """σ_c (m,) at points z (m,), real or complex."""
        ...


class Pseudospectral(Protocol):
    """A discretization of the same equations that shares nothing with the shooting path but constitutive functions and base flow."""

    def spectrum(self, M: int, filtered: bool = True) -> Any:
        """The spectral.qz.Spectrum at truncation M: filtered against a second truncation 20 % larger, or one raw QZ."""
        ...

    @property
    def ways(self) -> Mapping[str, Callable[[int, complex], tuple[complex, int]]]:
        """Ways to the one eigenvalue next to a guess at truncation M by name, each with the number of factorizations that it took."""
        ...


class Shape(Protocol):
    """What the eigenfunctions of a problem stand for beside their unknowns."""

    def fields(self, z: Any, unknowns: Mapping[str, Any]) -> Mapping[str, Any]:
        """Further fields (m,) by name, of unknowns (m,) at heights z (m,)."""
        ...

    @property
    def heights(self) -> Any:
        """The z (m,) at which `kind` is to be asked."""
        ...

    def kind(self, z: Any, unknowns: Mapping[str, Any]) -> str:
        """A word for what the mode is, by a rule that its docstring gives."""
        ...


class Family(Protocol):
    """Problems that differ in some parameters, named as in a scene file."""

    @property
    def sharing(self) -> tuple[str, ...]:
        """Parameters along which the base flow is the same: lines of a sweep run along one of them where they can."""
        ...

    @property
    def here(self) -> Mapping[str, float]:
        """The values of the member that the family was asked of."""
        ...

    def checked(self, values: Mapping[str, float]) -> None:
        """Raise InputError where a value can belong to no member."""
        ...

    def absent(self, values: Mapping[str, float]) -> str | None:
        """Why there is no member at these values; None if there is one."""
        ...

    def problem(self, values: Mapping[str, float]) -> Problem:
        """The member at these values. Raises InputError where there is none."""
        ...

    def beside(self, values: Mapping[str, float]) -> Mapping[str, float]:
        """What else is to be said of the member at these values, by name: what its parameters determine."""
        ...

    def as_dict(self) -> dict[str, Any]:
        """What the members have in common, for JSON."""
        ...


# σ without any property, at which the decaying space exists: structure is sampled there
GENERIC = Capability("generic_sigma", GENERIC_SIGMA, "this problem names no generic sigma")
# pairs of the limiting pencil of an end at infinity and the number of solutions that decay there
ASYMPTOTICS = Capability("asymptotics", (), "this problem has no end at infinity with a limit")
# the curve of continuous spectrum that paths lead around, a Continuum
INTERIOR = Capability("continuum", None, "this problem has no continuous spectrum that a path could lead around")
# pairs (z, σ_c(z)) of continuous spectra inside that no deformed path leads around
CROSSINGS = Capability("crossings", (), "this problem has no continuous spectrum between interfaces")
# points at which coefficients are not smooth; None where they are smooth by construction
KNOTS = Capability("knots", None, "this problem's coefficients are smooth by construction")
# the same problem, on the same line, with every wall that approximates a singular point twice as far from it
FARTHER_WALLS = Capability("farther_walls", None, "this problem has no wall that approximates a singular point")
PSEUDOSPECTRAL = Capability("pseudospectral", None, "this problem has no bundled pseudospectral reference: give a file of eigenvalues")
MULTIPRECISION = Capability("multiprecision", None, "this problem has no formulation of its own for many digits")
UNSCALED = Capability("unscaled", None, "this problem is stated in its own eigenvalue")
CLOSED_FORM = Capability(
    "closed_form", None, "more than 12 digits ask for a problem in closed form: exact_ends, exact_pencil, exact_far and exact_wall"
)
# exact_unknowns(exact), of a closed form: its unknowns by name, each by its factors of components {j: number}
EXACT_UNKNOWNS = Capability("exact_unknowns", None, "this closed form does not name its unknowns")
# a multiprecision.enclosable.Enclosable, where a problem is one otherwise than by its closed form
ENCLOSABLE = Capability(
    "enclosable",
    None,
    "a proof asks for a problem in closed form or in equations, between ends that are finite or at which coefficients "
    "are series in an exponential or go as powers; "
    "a base flow of its own is to be d(f,3) = -c*f*d(f,2) from a wall on, and no other function is given",
)
# varied(name)(p): the enclosable problem with another value p, an acb, of the parameter of that name
VARIED = Capability(
    "varied",
    None,
    "an interval of a parameter asks for a problem in equations, with conditions at two finite ends: at infinity limits vary too",
)
# closed forms whose discriminants multiply to that of the problem, up to a constant
FACTORS = Capability("factors", (), "this problem is not made of others")
FAMILY = Capability("family", None, "this problem belongs to no family of problems with parameters: a sweep is over parameters of a family")
# with_parameters({name: number}): the same problem with other parameters, which may be complex
WITH_PARAMETERS = Capability(
    "with_parameters", None, "this problem has no parameters by name: allowed is a scene with equations in [problem]"
)
EXPLANATION = Capability("explanation", None, "this problem was not written in equations: allowed is a scene with equations in [problem]")
# unknowns.Unknowns: what the state of the problem stands for, by name
UNKNOWNS = Capability("unknowns", None, "this problem does not name its unknowns")
# unknowns.Placement of every subdomain, where the line of integration is not z itself
PLACEMENTS = Capability("placements", (), "this problem is integrated over z itself")
# a Shape: what eigenfunctions stand for
MODE_SHAPE = Capability("mode_shape", None, "this problem says nothing of its eigenfunctions beside their unknowns")
BASE_FLOW = Capability("flow", None, "this problem has no steady flow of grains: allowed is a scene with a [flow]")
# growing_region(floor): a rectangle that holds every eigenvalue with Re σ ≥ floor, and the name of the lemma by which it does; with the
# largest value of a parameter by its name, for every value from 0 up to that
GROWING_REGION = Capability("growing_region", None, "this problem has no theorem that bounds its growing modes")
# the problem's pencil as a formula, a problems.recorded_pencil.RecordedPencil: what is sampled on a mesh is then computed by a program
RECORDED = Capability("recorded", None, "this problem has no recorded pencil")
# anything hashable: problems of one structure have entries that are 0, real or imaginary at the same places
STRUCTURE = Capability("structure", None, "this problem names no structure that it shares with others")
# whether the problem stays what it is: no function of the user's is called, which may read what changes
UNCHANGING = Capability("unchanging", False, "this problem calls functions that may read what changes")
# certificates(proof, count, spare_bits): what to try as a certificate of a proof, each with more bits, for the checker of this problem
CERTIFICATES = Capability("certificates", None, "this problem has no checker of certificates")
# polynomial_pencil(): the problem with polynomial coefficients, for the checker of such; it raises InputError where it has no such form
POLYNOMIAL_PENCIL = Capability("polynomial_pencil", None, "a certificate asks for a problem in equations, plane Poiseuille flow or a chute")
