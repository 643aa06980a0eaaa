"""Baselines: the modes that were proved once, in a text file that a diff can show and a later job can compare with.

    # shootstab baseline: the digits of these modes are proved; `shootstab baseline check` compares
    version = "0.2.1"
    scene = "poiseuille"
    eigenvalue = "σ"
    digits = 8

    [[mode]]
    re = "0.0037396706"
    im = "-0.2375264888"
    error = 8.1e-14

Every mode is written with so many digits of |σ|, and two more. The file is TOML; nothing in it is executed.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from shootstab import __version__
from shootstab.core.allowed import DOUBLE_DIGITS
from shootstab.core.errors import InputError, shortened
from shootstab.core.reading import toml_of
from shootstab.io.files import write_text
from shootstab.io.readers import INFINITE

WHAT = "a baseline as `shootstab baseline record` writes it"
LARGEST_BASELINE = 2**17  # chosen: bytes of a file
MOST_MODES = 1000  # chosen: the most modes in a file
GUARD = 2  # chosen: digits written beyond those that are compared, so that rounding of the text decides nothing
HEAD = "# shootstab baseline: the digits of these modes are proved; `shootstab baseline check` compares\n"


@dataclass(frozen=True)
class Baseline:
    """modes of a scene, each with the bound on its error, and to how many digits they are to be compared."""

    scene: str
    modes: tuple[tuple[complex, float], ...]
    digits: int
    symbol: str = "σ"
    version: str = __version__

    @classmethod
    def of(cls, scene: str, modes: Iterable[tuple[complex, float]], digits: int, symbol: str = "σ") -> Baseline:
        """The baseline of these modes, each with the bound on its error, in an order that does not depend on theirs: by falling growth."""
        return cls(scene, tuple(sorted(modes, key=lambda mode: (-mode[0].real, mode[0].imag))), digits, symbol)

    @property
    def text(self) -> str:
        """What the file holds."""
        head = [f"version = {_quoted(self.version)}", f"scene = {_quoted(self.scene)}", f"eigenvalue = {_quoted(self.symbol)}"]
        lines = [HEAD.rstrip(), *head, f"digits = {self.digits}"]
        for sigma, error in self.modes:
            places = _places(abs(sigma), self.digits + GUARD)
            lines += ["", "[[mode]]", f're = "{sigma.real:.{places}f}"', f'im = "{sigma.imag:.{places}f}"', f"error = {error:.1e}"]
        return "\n".join(lines) + "\n"

    def differences(self, found: Sequence[complex]) -> list[Difference]:
        """Each mode of the baseline with a number of those found, none of them used twice: as many hold as can, then the nearest.

        Of n modes each needs the n numbers that are nearest to it and no others: at most n − 1 of them are given to other modes, so a
        number farther away can be changed for one that is free and no farther, and every mode can be given one.
        """
        import numpy as np
        from scipy.sparse import csr_array
        from scipy.sparse.csgraph import min_weight_full_bipartite_matching
        from scipy.spatial import KDTree

        allowed = np.array([10.0**-self.digits * abs(sigma) + error for sigma, error in self.modes])
        recorded = np.array([sigma for sigma, _ in self.modes])
        given: list[complex | None] = [None] * len(recorded)
        numbers = np.array(found, dtype=np.complex128)
        rivals = min(len(recorded), len(numbers))
        if rivals:
            plane = KDTree(np.column_stack((numbers.real, numbers.imag)))
            off, nearest = plane.query(np.column_stack((recorded.real, recorded.imag)), k=np.arange(1, rivals + 1))
            # one that does not hold costs more than nearness can in all of them; and 1 more, for a cost of 0 is no edge of a sparse graph
            cost = 1.0 + (off > allowed[:, None]) * (len(recorded) + 1.0) + off / (off + off.max() + np.finfo(float).tiny)
            rows = np.arange(0, cost.size + 1, rivals, dtype=np.int32)
            # the least SciPy that is allowed, 1.13, matches by indices of 32 bits only
            graph = csr_array((cost.ravel(), nearest.ravel().astype(np.int32), rows), shape=(len(recorded), len(numbers)))
            for i, j in zip(*min_weight_full_bipartite_matching(graph), strict=True):
                given[i] = complex(numbers[j])
        return [Difference(sigma, given[i], float(allowed[i])) for i, (sigma, _) in enumerate(self.modes)]


@dataclass(frozen=True)
class Difference:
    """A mode of a baseline, what is found in its place (None if nothing is left), and how far that may be from it."""

    recorded: complex
    found: complex | None
    allowed: float

    @property
    def holds(self) -> bool:
        """Whether it is within what is allowed."""
        return self.found is not None and abs(self.found - self.recorded) <= self.allowed

    @property
    def line(self) -> str:
        """The comparison in words."""
        if self.found is None:
            return f"{self.recorded:.12g}: nothing in its place"
        moved = abs(self.found - self.recorded)
        return f"{self.recorded:.12g}: {self.found:.12g}, moved by {moved:.1e}, allowed is {self.allowed:.1e}"


def save(baseline: Baseline, path: Path) -> None:
    """Write the file. Raises OutputError."""
    write_text(path, baseline.text)


def load(path: Path) -> Baseline:
    """Read a file. Raises InputError, which names what is wrong with it."""
    document = toml_of(path, LARGEST_BASELINE, WHAT)
    digits, modes = document.get("digits"), document.get("mode")
    if type(digits) is not int or not 1 <= digits <= DOUBLE_DIGITS:
        raise InputError(f"{path}: digits = {shortened(digits)}: allowed is an integer from 1 to {DOUBLE_DIGITS}")
    if not isinstance(modes, list) or not 1 <= len(modes) <= MOST_MODES:
        raise InputError(f"{path}: no [[mode]]: allowed are 1 to {MOST_MODES}, each with re, im and error, as {WHAT} has them")
    words = {key: document.get(key, "") for key in ("scene", "eigenvalue", "version")}
    if not all(isinstance(word, str) for word in words.values()) or not words["scene"]:
        raise InputError(f"{path}: scene, eigenvalue and version: allowed are texts, and scene is needed, as {WHAT} has them")
    read = tuple(_mode(path, number, mode) for number, mode in enumerate(modes, 1))
    return Baseline(words["scene"], read, digits, words["eigenvalue"] or "σ", words["version"])


def _mode(path: Path, number: int, table: Any) -> tuple[complex, float]:
    found = []
    for key in ("re", "im", "error"):
        value = table.get(key) if isinstance(table, dict) else None
        try:
            x = float(value) if isinstance(value, str | int | float) and not isinstance(value, bool) else math.nan
        except (ValueError, OverflowError):
            x = math.nan
        if not abs(x) < INFINITE or (key == "error" and x < 0.0):
            allowed = f"a number {'from 0 to' if key == 'error' else 'below'} 1e15"
            raise InputError(f"{path}: mode {number}: {key} = {shortened(value)}: allowed is {allowed}")
        found.append(x)
    return complex(found[0], found[1]), found[2]


def _places(size: float, digits: int) -> int:
    """Decimals behind the point that show so many digits of a number of this size."""
    return max(0, digits - 1 - math.floor(math.log10(size))) if size > 0.0 else digits


def _quoted(text: str) -> str:
    """The text quoted as TOML has it, which for a line of text is as JSON has it."""
    return json.dumps(text, ensure_ascii=False)
