"""The problem that belongs to values of k_x, k_y, T_∞, Q0, tanθ, e, e_w and r, all else taken from one chute problem."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from typing import Any

from shootstab.problems.chute import Chute, ChuteProblem, Flow, flows
from shootstab.problems.chute.family import member, steady_by_flux
from shootstab.problems.chute.steady import descend
from shootstab.vocabulary.errors import InputError

WAVE = ("kx", "ky")
GRAINS = ("tan_theta", "e", "e_w", "r")
NAMES = (*WAVE, "far_temperature", "mass_flux", *GRAINS)


@dataclass(frozen=True)
class Members:
    """A family of chute problems: its grains and its wave, and the flow by far temperature or by mass flux and branch."""

    chute: Chute
    kx: float
    ky: float
    far_temperature: float | None
    mass_flux: float | None
    branch: str | None

    @classmethod
    def around(cls, problem: ChuteProblem, names: tuple[str, ...]) -> Members:
        """The family of a problem in which these parameters vary.

        A flow that was chosen by its mass flux keeps it, and its branch, where grains or the slope vary. Raises InputError for a name
        that is none of NAMES, for one that comes twice, and for far_temperature beside mass_flux.
        """
        for name in names:
            if name not in NAMES:
                raise InputError(f"{name}: cannot be swept: allowed is one of {', '.join(NAMES)}")
            if names.count(name) > 1:
                raise InputError(f"{name}: given {names.count(name)} times: allowed is once")
        if "far_temperature" in names and "mass_flux" in names:
            raise InputError("far_temperature and mass_flux: allowed is one of them, for each determines the other")
        flow = problem.flow
        keeps_flux = flow.asked_flux is not None and bool(set(names) & set(GRAINS)) and "far_temperature" not in names
        if not keeps_flux and "mass_flux" not in names:
            return cls(flow.chute, problem.kx, problem.ky, flow.far_temperature, None, None)
        # the flux may be anything here, but the flow that was asked for says which branch is meant
        flux = flow.asked_flux if flow.asked_flux is not None else flow.mass_flux
        return cls(flow.chute, problem.kx, problem.ky, None, flux, member(flows(flow.chute, flux), flow))

    def checked(self, values: Mapping[str, float]) -> None:
        """Raise InputError where a value can be no parameter of a chute."""
        self._chute(values)
        if "far_temperature" in values:
            Chute.require_temperature(values["far_temperature"])
        if "mass_flux" in values and not values["mass_flux"] > 0.0:
            raise InputError(f"mass_flux = {values['mass_flux']!r}: allowed is a finite number above 0")

    def flow(self, values: Mapping[str, float]) -> Flow:
        """The steady flow at these values, kept for the next wave on it. Raises InputError (NoFlowError among them) if there is none."""
        chute = self._chute(values)
        if self.far_temperature is not None or "far_temperature" in values:
            return _by_temperature(chute, values.get("far_temperature", self.far_temperature or 0.0))
        return _by_flux(chute, values.get("mass_flux", self.mass_flux or 0.0), self.branch)

    def wave(self, values: Mapping[str, float]) -> tuple[float, float]:
        """(k_x, k_y) at these values."""
        return values.get("kx", self.kx), values.get("ky", self.ky)

    def problem(self, values: Mapping[str, float]) -> ChuteProblem:
        """The problem at these values; raises as `flow` does, and for k_x = k_y = 0."""
        return ChuteProblem(self.flow(values), *self.wave(values))

    def as_dict(self) -> dict[str, Any]:
        """For JSON, and back by Members(Chute(**chute), …)."""
        return asdict(self)

    def _chute(self, values: Mapping[str, float]) -> Chute:
        changed = {name: values[name] for name in GRAINS if name in values}
        return replace(self.chute, **changed) if changed else self.chute  # type: ignore[arg-type]


@lru_cache(maxsize=16)
def _by_temperature(chute: Chute, far_temperature: float) -> Flow:
    return descend(chute, far_temperature)


@lru_cache(maxsize=16)
def _by_flux(chute: Chute, mass_flux: float, branch: str | None) -> Flow:
    return steady_by_flux(chute, mass_flux, branch)
