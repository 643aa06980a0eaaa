"""The problem that belongs to values of swept parameters (see registry.py), all else taken from one chute problem."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, replace
from functools import lru_cache
from typing import Any

from shootstab.analyses.sweep.outcomes import NO_FLOW, NO_WAVE
from shootstab.core.errors import InputError
from shootstab.models.chute import registry
from shootstab.models.chute.branch import continued
from shootstab.models.chute.parameters import Chute
from shootstab.models.chute.perturbations import Perturbations
from shootstab.models.chute.registry import BY_NAME, SWEPT, names
from shootstab.models.chute.steady_flow import Flow, descend

WAVE_NAMES = names(registry.WAVE)
GRAINS = tuple(p.name for p in SWEPT if p.of == registry.CHUTE)
SWEPT_NAMES = tuple(p.name for p in SWEPT)


@dataclass(frozen=True)
class ChuteFamily:
    """A family of chute problems: its grains and its wave, and the flow by far temperature, or by mass flux and the flow that its members
    continue (see branch.py).
    """

    chute: Chute
    kx: float
    ky: float
    far_temperature: float | None
    mass_flux: float | None
    origin: Flow | None = field(compare=False, repr=False)
    member: Callable[[Flow, float, float], Perturbations] = field(compare=False, repr=False)

    @property
    def sharing(self) -> tuple[str, ...]:
        """k_x and k_y: all waves have one steady flow."""
        return WAVE_NAMES

    @classmethod
    def around(
        cls, flow: Flow, kx: float, ky: float, swept: tuple[str, ...], make: Callable[[Flow, float, float], Perturbations]
    ) -> ChuteFamily:
        """The family of the problem make(flow, kx, ky) in which these parameters vary.

        A flow that was chosen by its mass flux keeps it where grains or the slope vary, and all members lie on its branch. Raises
        InputError for a parameter that cannot be swept, for one that comes twice, and for far_temperature beside mass_flux.
        """
        for name in swept:
            if name not in SWEPT_NAMES:
                raise InputError(f"{name}: cannot be swept: allowed is one of {', '.join(SWEPT_NAMES)}")
            if swept.count(name) > 1:
                raise InputError(f"{name}: given {swept.count(name)} times: allowed is once")
        if "far_temperature" in swept and "mass_flux" in swept:
            raise InputError("far_temperature and mass_flux: allowed is one of them, for each determines the other")
        keeps_flux = flow.asked_flux is not None and bool(set(swept) & set(GRAINS)) and "far_temperature" not in swept
        if not keeps_flux and "mass_flux" not in swept:
            return cls(flow.chute, kx, ky, flow.far_temperature, None, None, make)
        flux = flow.asked_flux if flow.asked_flux is not None else flow.mass_flux
        return cls(flow.chute, kx, ky, None, flux, flow, make)

    @property
    def here(self) -> dict[str, float]:
        """The parameters of the problem that the family was made around."""
        temperature = self.far_temperature if self.origin is None else self.origin.far_temperature
        flow = {"far_temperature": temperature, "mass_flux": self.mass_flux}
        known = {"kx": self.kx, "ky": self.ky, **{name: getattr(self.chute, name) for name in GRAINS}, **flow}
        return {name: float(value) for name, value in known.items() if value is not None}

    def checked(self, values: Mapping[str, float]) -> None:
        """Raise InputError where a value can be no parameter of a chute."""
        for name, value in values.items():
            BY_NAME[name].check(value)

    def flow(self, values: Mapping[str, float]) -> Flow:
        """The steady flow at these values, kept for the next wave on it. Raises InputError (NoFlowError among them) if there is none."""
        chute = self._chute(values)
        if self.far_temperature is not None or "far_temperature" in values:
            return _by_temperature(chute, values.get("far_temperature", self.far_temperature or 0.0))
        assert self.origin is not None
        return _continued(self.origin, chute, values.get("mass_flux", self.mass_flux or 0.0))

    def wave(self, values: Mapping[str, float]) -> tuple[float, float]:
        """(k_x, k_y) at these values."""
        return values.get("kx", self.kx), values.get("ky", self.ky)

    def absent(self, values: Mapping[str, float]) -> str | None:
        """'no wave' for k_x = k_y = 0; 'no flow: …' with the reason where there is none, or none on the branch that was asked for."""
        if self.wave(values) == (0.0, 0.0):
            return NO_WAVE
        try:
            self.flow(values)
        except InputError as error:
            return f"{NO_FLOW}: {error}"
        return None

    def problem(self, values: Mapping[str, float]) -> Perturbations:
        """The problem at these values; raises as `flow` does, and for k_x = k_y = 0."""
        return self.member(self.flow(values), *self.wave(values))

    def as_dict(self) -> dict[str, Any]:
        """The parameters that the members have in common, for JSON."""
        common = {name: getattr(self, name) for name in (*WAVE_NAMES, "far_temperature", "mass_flux")}
        origin = None if self.origin is None else self.origin.far_temperature
        return {"chute": asdict(self.chute), **common, "continues_far_temperature": origin}

    def beside(self, values: Mapping[str, float]) -> dict[str, float]:
        """T_∞ of the member, where the mass flux determines it."""
        return {"far_temperature": self.flow(values).far_temperature} if self.origin is not None else {}

    def _chute(self, values: Mapping[str, float]) -> Chute:
        changed: dict[str, Any] = {name: values[name] for name in GRAINS if name in values}
        return replace(self.chute, **changed) if changed else self.chute


@lru_cache(maxsize=16)
def _by_temperature(chute: Chute, far_temperature: float) -> Flow:
    return descend(chute, far_temperature)


@lru_cache(maxsize=16)
def _continued(origin: Flow, chute: Chute, mass_flux: float) -> Flow:
    if chute == origin.chute and mass_flux == origin.asked_flux:
        return origin
    return continued(origin, chute, mass_flux)
