"""How a problem is laid out on one line: subdomains between ends and interfaces, all integrated at once from t = T down to t = 0.

Subdomain j holds ψ on z = offset + scale·t. A subdomain that begins with a space (at a wall, at infinity) runs towards the interface, or
the wall, where t = 0, and contributes n components. A subdomain whose solutions are free at its beginning is augmented: beside ψ it
carries a, ψ's value at t = T, and begins with [I; I]. So conditions at both its ends are conditions at t = 0, and those of all subdomains
together are the wall rows of one problem, of the degree in σ that they have:

    whole line            (ψ_left, ψ_right), ψ_left = ψ_right at the fold
    interface at z_i      the same with M_− ψ_− + M_+ ψ_+ = 0
    more interfaces       (ψ_left, a_1, ψ_1, …, ψ_right)
    rows with σ at both walls   (a, ψ)

The system is C ψ_t = scale·D ψ subdomain by subdomain: the engine sees one of larger size, and smooth coefficients on all of it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from shootstab.problems.crossed import Crossed
from shootstab.problems.decaying_space import StartingSpace
from shootstab.problems.pencil_function import PencilFunction
from shootstab.problems.protocol import ComplexArray, FarFrame, Pencil
from shootstab.problems.unknowns import InnerSpace

# chosen: how far inside a subdomain its coefficients at an interface are taken, some roundings of z
INSIDE_INTERFACE = 4 * np.finfo(float).eps


@dataclass(frozen=True, eq=False)
class Subdomain:
    """One subdomain; ends are the z at which its coefficients belong to it, taken from inside; crossed are interfaces inside."""

    offset: float
    scale: float
    far: StartingSpace
    augmented: bool = False
    ends: tuple[float, ...] = ()
    crossed: Crossed | None = None

    @property
    def inner(self) -> InnerSpace | None:
        """The space with which it begins, where that is known all the way to its end."""
        space: InnerSpace | None = getattr(self.far, "inner", None)
        return space

    def on(self, shift: float, stretch: float) -> Subdomain:
        """The same subdomain over a new variable, with t = shift + stretch·(new t)."""
        return replace(self, offset=self.offset + self.scale * shift, scale=self.scale * stretch)

    def points(self, t: ComplexArray) -> ComplexArray:
        """z (m,) of t (m,); at an interface a hair inside."""
        z = self.offset + self.scale * t
        for end in self.ends:
            hair = INSIDE_INTERFACE * max(1.0, abs(end))
            inwards = 1.0 if (end == self.offset) == (self.scale > 0.0) else -1.0
            z = np.where(np.abs(z - end) < hair, end + inwards * hair, z)
        return z

    def pencil(self, function: PencilFunction, t: ComplexArray) -> Pencil:
        """The matrices (m, N, N) of ψ at t (m,), with those of a before them if the subdomain is augmented."""
        z = self.points(t)
        p = function(z) if self.crossed is None else self.crossed.changed(function(z), z)
        own = p if self.scale == 1.0 else p.stretched(self.scale)
        if not self.augmented:
            return own
        n = function.size
        still = np.zeros((len(t), n, n), dtype=np.complex128)
        return blocks([Pencil.of([still + np.eye(n), *[still for _ in own.C[1:]]], [still for _ in own.D]), own])

    def arriving(self, rows: ComplexArray) -> ComplexArray:
        """Rows (m, n) for ψ at the end of the subdomain, made rows for what is integrated there."""
        return rows if self.crossed is None else rows @ self.crossed.arrival

    def frame(self, sigma: complex) -> FarFrame:
        """The frame where the subdomain begins; [I; I] times it where it is augmented."""
        far = self.far.frame(sigma)
        if not self.augmented:
            return far
        return FarFrame(np.concatenate((far.frame, far.frame)), np.concatenate((far.tangent, far.tangent)), far.log_scale, far.error)


def blocks(pencils: list[Pencil]) -> Pencil:
    """The pencil of a system in blocks."""
    if len(pencils) == 1:
        return pencils[0]
    C, D = ([_diagonal(list(power)) for power in zip(*parts, strict=True)] for parts in ([p.C for p in pencils], [p.D for p in pencils]))
    return Pencil.of(C, D)


def frames(parts: list[FarFrame]) -> FarFrame:
    """The frame of a system in blocks; its error is the largest."""
    if len(parts) == 1:
        return parts[0]
    frame, tangent = (_diagonal([getattr(p, name)[None] for p in parts])[0] for name in ("frame", "tangent"))
    return FarFrame(frame, tangent, sum(p.log_scale for p in parts), max(p.error for p in parts))


def _diagonal(parts: list[ComplexArray]) -> ComplexArray:
    """Block-diagonal arrays (m, Σ rows, Σ columns)."""
    rows, columns = (np.cumsum([0] + [p.shape[axis] for p in parts]) for axis in (1, 2))
    out = np.zeros((len(parts[0]), rows[-1], columns[-1]), dtype=np.complex128)
    for j, part in enumerate(parts):
        out[:, rows[j] : rows[j + 1], columns[j] : columns[j + 1]] = part
    return out
