"""Cells of the σ-plane, and the σ of each for which its mesh is made.

At level ℓ a cell is an interval of ln|σ| of length ln 2/9^ℓ times a sector of 40°/9^ℓ; it falls into 81 of the next level. The mesh that
serves a σ follows from the cells that σ lies in and from nothing else, so that D(σ) does not depend on what was asked before.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

OCTAVE = 1.0371  # chosen: the cells of level 0 end at |σ| = OCTAVE·2^i, numbers that no mode is likely to be
SECTOR = math.radians(40.0)  # chosen: sector 0 holds the positive real axis in its middle, and no sector has ±i in its own
CELL_PARTS = 9  # chosen: parts of a cell along |σ| and along arg σ; odd, so that the middle of a cell is the middle of one of its parts
SMALLEST_POWER = -80  # chosen: |σ| below 2^−80 counts as so large: σ = 0 lies in a cell too
LARGEST_POWER = 1000  # chosen: |σ| above 2^1000 counts as so large, so that the σ of its cell is a double


@dataclass(frozen=True)
class Cell:
    """The σ with OCTAVE·2^(size/9^level) ≤ |σ| < OCTAVE·2^((size+1)/9^level), in the sector around the angle sector·40°/9^level."""

    level: int
    size: int
    sector: int

    @classmethod
    def of(cls, sigma: complex, level: int) -> Cell:
        """The cell of this level that σ lies in."""
        fine = CELL_PARTS**level
        octaves = math.log2(abs(sigma) / OCTAVE) if sigma != 0 else -math.inf
        octaves = min(max(octaves, SMALLEST_POWER), LARGEST_POWER)
        return cls(level, math.floor(octaves * fine), math.ceil(cmath.phase(sigma) * fine / SECTOR - 0.5))

    @property
    def larger(self) -> Cell:
        """The cell of the level above that it lies in."""
        return Cell(self.level - 1, self.size // CELL_PARTS, (self.sector + CELL_PARTS // 2) // CELL_PARTS)

    @property
    def anchor(self) -> complex:
        """The σ that the mesh is made for: the largest of the cell, in the middle of its sector. Large σ need short steps."""
        return self._in_the_middle(self.size + 1)

    @property
    def smallest(self) -> complex:
        """The smallest σ of the cell, in the middle of its sector. A far frame of small σ is good farther out only."""
        return self._in_the_middle(self.size)

    def _in_the_middle(self, size: int) -> complex:
        """The σ of modulus OCTAVE·2^(size/9^level) in the middle of the sector."""
        fine = CELL_PARTS**self.level
        modulus = OCTAVE * 2.0 ** (size / fine)
        return cmath.rect(modulus, self.sector * SECTOR / fine) if self.sector else complex(modulus)
