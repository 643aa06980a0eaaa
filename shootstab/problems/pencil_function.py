"""The pencil of a user's problem: a function of z, called point by point, for many points at once, or compiled with numba."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from shootstab.core.errors import InputError
from shootstab.problems.protocol import ComplexArray, Pencil

ALLOWED = "two matrices, D0 and D1, or four, C0, C1, D0 and D1, or as many of C as of D for higher powers of sigma"


@dataclass(frozen=True, eq=False)
class PencilFunction:
    """A function of z that returns D0, D1, where C is the identity, or C0, C1, D0, D1, or C0, …, Cq, D0, …, Dq, each (n, n).

    Vectorized, it takes points (m,) and returns arrays (m, n, n) or, what does not depend on z, (n, n). It is given real z unless the
    path of integration leaves the real axis, as it does next to a continuous spectrum: then z is complex.
    """

    size: int
    function: Callable[[Any], Any]
    vectorized: bool = False

    def __call__(self, z: ComplexArray) -> Pencil:
        """The matrices at the points z (m,). Raises InputError for what is no pencil, with the point at which it is none."""
        points = z.real.copy() if not z.imag.any() else z
        if self.vectorized:
            return self._pencil([self._at_all_points(part, len(z)) for part in self._parts(points)], z)
        if len(points) > 1 and hasattr(self.function, "py_func"):
            self.at(points[0])  # what is wrong with it is told in words before anything is compiled
            return self._filled(points)
        gathered = [self._parts(p) for p in points.tolist()]
        try:
            stacked = [np.array([parts[i] for parts in gathered], dtype=np.complex128) for i in range(len(gathered[0]))]
        except (ValueError, TypeError, IndexError) as error:
            raise InputError(f"the pencil is not of one shape at all z ({error}): allowed is ({self.size}, {self.size})") from None
        return self._pencil(stacked, z)

    def at(self, z: complex) -> Pencil:
        """The matrices at one point, each (n, n); z may be ±∞."""
        return self(np.array([z], dtype=np.complex128)).each(lambda M: M[0])

    def _parts(self, z: Any) -> tuple[Any, ...]:
        with np.errstate(all="ignore"):  # what is not finite is found below, and named
            try:
                parts = self.function(z)
            except (ArithmeticError, ValueError) as error:
                raise _not_computed(f"z = {z:g}" if isinstance(z, float) else "some z", error) from error
        if not isinstance(parts, tuple | list) or len(parts) < 2 or len(parts) % 2:
            count = len(parts) if isinstance(parts, tuple | list) else type(parts).__name__
            raise InputError(f"the pencil gives {count}: allowed are {ALLOWED}")
        return tuple(parts)

    def _at_all_points(self, part: Any, m: int) -> Any:
        """What a vectorized function returned for one matrix at m points, as (m, n, n)."""
        try:
            return np.broadcast_to(np.asarray(part), (m, *np.shape(part)[-2:]))
        except ValueError:
            n, shape = self.size, np.shape(part)
            told = f"the vectorized pencil gives a matrix of shape {shape} at {m} points"
            raise InputError(f"{told}: allowed is ({m}, {n}, {n}) or ({n}, {n})") from None

    def _pencil(self, stacked: list[Any], z: ComplexArray) -> Pencil:
        n = self.size
        for name, M in zip(_names(len(stacked)), stacked, strict=True):
            if M.shape[1:] != (n, n):
                raise InputError(f"the pencil's {name} has shape {M.shape[1:]}: allowed is ({n}, {n})")
            with np.errstate(over="ignore", invalid="ignore"):
                total = M.sum()  # quicker than to look at each, and finite only if all are
            if not (np.isfinite(total) or np.isfinite(M).all()):
                where = complex(z[~np.isfinite(M).all(axis=(1, 2))][0])
                raise InputError(f"the pencil's {name} is not finite at z = {where.real if where.imag == 0.0 else where:g}")
        if len(stacked) == 2:
            identity = np.broadcast_to(np.eye(n, dtype=np.complex128), (len(z), n, n))
            stacked = [identity, np.broadcast_to(np.zeros((n, n), dtype=np.complex128), (len(z), n, n)), *stacked]
        matrices = [np.asarray(M, dtype=np.complex128) for M in stacked]
        half = len(matrices) // 2
        return Pencil.of(matrices[:half], matrices[half:])

    def _filled(self, points: Any) -> Pencil:
        """All points in one compiled loop."""
        n, count = self.size, len(self._parts(points[0]))
        out = np.empty((count, len(points), n, n), dtype=np.complex128)
        try:
            _loop()(self.function, points, out)
        except (ArithmeticError, ValueError) as error:
            for z in points.tolist():  # the one point that is singular is found, and named
                self._parts(z)
            raise _not_computed("some z", error) from error
        return self._pencil(list(out), points.astype(np.complex128))


def _not_computed(where: str, error: Exception) -> InputError:
    advice = "allowed is a pencil that is finite on the whole interval, ends included: at a singular point put the wall next to it"
    return InputError(f"the pencil cannot be computed at {where}: {type(error).__name__}: {error}: {advice}")


@cache
def _loop() -> Any:
    """The compiled loop over points, for a pencil of any number of matrices."""
    from numba import literal_unroll, njit

    @njit
    def loop(pencil, points, out):  # type: ignore[no-untyped-def]
        for i in range(len(points)):
            j = 0
            for matrix in literal_unroll(pencil(points[i])):  # enumerate is not unrolled
                out[j, i] = matrix
                j += 1  # noqa: SIM113

    return loop


def _names(count: int) -> list[str]:
    """The names of so many matrices; with fewer than four C is the identity and has none."""
    half = count // 2
    return ["D0", "D1"] if half == 1 else [f"{part}{k}" for part in "CD" for k in range(half)]
