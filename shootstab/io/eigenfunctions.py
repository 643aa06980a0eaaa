"""Eigenfunctions as JSON, and as columns for files."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from shootstab import __version__
from shootstab.io import documents

if TYPE_CHECKING:
    from shootstab.analyses.eigenfunction_double import Eigenfunction


def columns(found: Eigenfunction, z: NDArray[np.float64]) -> Mapping[str, NDArray[np.complex128]]:
    """The unknowns at heights z (m,), and what the problem derives from them, by name."""
    return {**found(z), **found.fields(z)}


def document(found: Eigenfunction, z: NDArray[np.float64]) -> dict[str, Any]:
    """What `mode` answers: the mode, the error of its eigenfunction, and the values at heights z (m,)."""
    return {
        "version": __version__,
        "mode": documents.mode(found.mode),
        "normalization": found.normalization,
        "error": found.error,
        "budget": found.budget.as_dict(),
        "conditioning": found.conditioning.as_dict(),
        "kind": found.kind,
        "z": z.tolist(),
        "fields": parts(columns(found, z)),
    }


def parts(fields: Mapping[str, NDArray[np.complex128]]) -> dict[str, dict[str, list[float]]]:
    """The fields (m,) by name as lists of their real and imaginary parts."""
    return {name: {"re": f.real.tolist(), "im": f.imag.tolist()} for name, f in fields.items()}
