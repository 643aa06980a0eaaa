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
import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from shootstab import __version__
from shootstab.core.errors import InputError
from shootstab.io.files import write_text

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
        """From modes, each with the bound on its error, in an order that does not depend on theirs: by falling growth."""
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
        """Each mode of the baseline with the number nearest to it among those found, none of them used twice."""
        left = list(found)
        out = []
        for sigma, error in self.modes:
            nearest = min(left, key=lambda other, sigma=sigma: abs(other - sigma), default=None)  # type: ignore[misc]
            if nearest is not None:
                left.remove(nearest)
            out.append(Difference(sigma, nearest, 10.0**-self.digits * abs(sigma) + error))
        return out


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
        """In words."""
        if self.found is None:
            return f"{self.recorded:.12g}: nothing in its place"
        moved = abs(self.found - self.recorded)
        return f"{self.recorded:.12g}: {self.found:.12g}, moved by {moved:.1e}, allowed is {self.allowed:.1e}"


def save(baseline: Baseline, path: Path) -> None:
    """Write the file. Raises OutputError."""
    write_text(path, baseline.text)


def load(path: Path) -> Baseline:
    """Read a file. Raises InputError, which names what is wrong with it."""
    try:
        document = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}: allowed is a baseline") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: broken TOML: {error}") from error
    try:
        modes = tuple((_number(mode), float(mode["error"])) for mode in document["mode"])
        digits, scene = int(document["digits"]), str(document["scene"])
        symbol, version = str(document.get("eigenvalue", "σ")), str(document.get("version", ""))
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"{path}: is no baseline ({error}): allowed is what `shootstab baseline record` writes") from error
    if not 1 <= digits <= 12 or not modes:
        raise InputError(f"{path}: digits = {digits} with {len(modes)} modes: allowed are 1 to 12 digits, and a mode at least")
    return Baseline(scene, modes, digits, symbol, version)


def _number(mode: Any) -> complex:
    value = complex(float(mode["re"]), float(mode["im"]))
    if not (math.isfinite(value.real) and math.isfinite(value.imag)):
        raise ValueError("a mode is not finite")
    return value


def _places(size: float, digits: int) -> int:
    """Decimals behind the point that show so many digits of a number of this size."""
    return max(0, digits - 1 - math.floor(math.log10(size))) if size > 0.0 else digits


def _quoted(text: str) -> str:
    """As TOML has it, which for a line of text is as JSON has it."""
    return json.dumps(text, ensure_ascii=False)
