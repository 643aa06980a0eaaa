"""A profile given as data: a piecewise polynomial through them, with its knots, and its derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import BSpline, make_interp_spline

from shootstab.core.errors import InputError

PROFILE_ORDERS = (1, 3, 5, 7)  # chosen: degrees of the polynomials; of an even one the knots lie between the data


@dataclass(frozen=True, eq=False)
class Profile:
    """A function of real z between the ends of its data; made by `profile`.

    The sites (m,) are the z of the data. Its derivative of the highest order jumps at its knots, between which it is one polynomial each.
    """

    spline: BSpline
    sites: NDArray[np.float64]

    @property
    def knots(self) -> NDArray[np.float64]:
        """The points (k,) at which it is not smooth, rising: for `knots=` of a problem."""
        k = self.spline.k
        return np.unique(self.spline.t[k + 1 : -k - 1])

    @property
    def ends(self) -> tuple[float, float]:
        """The first and the last z of the data."""
        return float(self.spline.t[0]), float(self.spline.t[-1])

    def __call__(self, z: Any, derivative: int = 0) -> Any:
        """The value at z, or that of a derivative; arrays for arrays. Raises InputError outside the data, and for z that are not real."""
        at = np.asarray(z)
        if np.iscomplexobj(at):
            if at.imag.any():
                raise InputError("a profile from data has no values at complex z: allowed are paths of integration on the real axis")
            at = at.real
        low, high = self.ends
        outside = at[(at < low) | (at > high) | np.isnan(at)]
        if outside.size:
            raise InputError(f"a profile is asked for at z = {outside.flat[0]:g}: its data reach from {low:g} to {high:g}")
        value = self.spline(at, derivative)
        return float(value) if value.ndim == 0 else value

    def thinned(self) -> Profile:
        """The profile through every other datum and both ends: what a mode moves by tells what the data leave open, 2^(order + 1) times.

        Raises InputError where too few are left.
        """
        z = self.sites
        kept = z[::2] if len(z) % 2 else np.append(z[:-1:2], z[-1])
        return profile(kept, self(kept), self.spline.k)


def profile(z: ArrayLike, values: ArrayLike, order: int = 3) -> Profile:
    """The spline of this order through values (m,) at rising z (m,): polynomials of degree 1, 3, 5 or 7, smooth where they meet.

    A problem that uses it learns its knots by `knots=profile.knots`; `equations(given={name: profile})` finds them itself. Nothing is
    extrapolated. Raises InputError for data that are no such function, with the place.
    """
    if order not in PROFILE_ORDERS:
        raise InputError(f"order = {order!r} of a profile: allowed are {', '.join(map(str, PROFILE_ORDERS))}")
    try:
        at, given = (np.asarray(part, dtype=np.float64) for part in (z, values))
    except (ValueError, TypeError) as error:
        raise InputError(f"a profile's data are no real numbers ({error}): allowed are arrays z (m,) and values (m,)") from None
    if at.ndim != 1 or given.shape != at.shape:
        raise InputError(f"a profile's z and values have shapes {at.shape} and {given.shape}: allowed are arrays (m,) of one length")
    if len(at) <= order:
        raise InputError(f"a profile of order {order} has {len(at)} points: allowed are {order + 1} or more")
    bad = ~(np.isfinite(at) & np.isfinite(given))
    if bad.any():
        raise InputError(f"point {int(bad.argmax()) + 1} of a profile is not finite: allowed are finite numbers")
    if not (np.diff(at) > 0.0).all():
        place = int((np.diff(at) <= 0.0).argmax())
        raise InputError(f"z = {at[place + 1]:g} follows {at[place]:g} in a profile: allowed are rising z")
    return Profile(make_interp_spline(at, given, k=order), at)
