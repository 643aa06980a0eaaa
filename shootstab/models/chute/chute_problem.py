"""The chute problem with all that it offers: its pseudospectral twin, many digits, and the family that it belongs to."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from shootstab.models.chute.mode_shape import ModeShape
from shootstab.models.chute.perturbations import Perturbations
from shootstab.models.chute.registry import CHUTE, names

if TYPE_CHECKING:  # what most questions do not need is imported when it is asked for
    from shootstab.models.chute.chute_collocation import ChuteCollocation
    from shootstab.models.chute.enclosed_problem import ChuteEnclosable
    from shootstab.models.chute.multiprecision_problem import ChuteDigits
    from shootstab.models.chute.parameter_family import ChuteFamily


class ChuteProblem(Perturbations):
    """See `Perturbations` for the equations and problems.capabilities for what is offered beside them."""

    def __repr__(self) -> str:
        return f"ChuteProblem(far_temperature={self.flow.far_temperature:.6g}, kx={self.kx:g}, ky={self.ky:g})"

    @property
    def pseudospectral(self) -> ChuteCollocation:
        """Chebyshev collocation of the conservative form."""
        from shootstab.models.chute.chute_collocation import ChuteCollocation

        return ChuteCollocation(self.flow, self.kx, self.ky)

    @property
    def mode_shape(self) -> ModeShape:
        """The local mass flux, and whether it forms vortices."""
        return ModeShape(self.flow, self.kx, self.ky)

    def multiprecision(self) -> ChuteDigits:
        """The parameters as exact decimals, everything by series."""
        from shootstab.models.chute.multiprecision_problem import ChuteDigits

        return ChuteDigits(self)

    @property
    def enclosable(self) -> ChuteEnclosable:
        """The problem in balls, on a flow that is enclosed too."""
        from shootstab.models.chute.enclosed_problem import ChuteEnclosable

        return ChuteEnclosable(self)

    @property
    def certified(self) -> dict[str, str]:
        """What shootstab/checkers/granular_chute.py knows the problem by."""
        flow = self.flow
        numbers = {name: getattr(flow.chute, name) for name in names(CHUTE, numbers=True)} | {"kx": self.kx, "ky": self.ky}
        asked = {"far_temperature": flow.far_temperature} if flow.asked_flux is None else {"mass_flux": flow.asked_flux}
        decimals = {name: repr(float(x)) for name, x in (numbers | asked).items()}
        return {"name": "granular chute", **decimals, "radial": flow.chute.radial, "wall": flow.chute.wall}

    def certificates(self, proof: Any, count: int, spare_bits: int) -> Iterator[dict[str, Any]]:
        """What to try as a certificate of a proof on a disc, each with more bits; spare_bits, which contours need, say nothing here."""
        from shootstab.analyses.certificate import disc_of
        from shootstab.models.chute.certificate_settings import Asked, candidates

        at, size = disc_of(proof, "one on a disc")
        return candidates(Asked(self.certified, {**at, "radius": size}, count, self.flow.far_temperature))

    def family(self, names: tuple[str, ...]) -> ChuteFamily:
        """The chutes that differ from this one in these parameters. Raises InputError for names that cannot vary, or not together."""
        from shootstab.models.chute.parameter_family import ChuteFamily

        return ChuteFamily.around(self.flow, self.kx, self.ky, names, type(self))
