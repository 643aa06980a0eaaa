"""All solutions at a multiple mode as JSON, and as functions by number for files."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from shootstab.io import documents
from shootstab.io.eigenfunctions import columns, parts

if TYPE_CHECKING:
    from shootstab.analyses.eigenspace import Eigenspace


def functions(found: Eigenspace, z: NDArray[np.float64]) -> Mapping[str, Mapping[str, NDArray[np.complex128]]]:
    """The fields at heights z (m,) of the functions of the basis, 1, 2, …, and of the chain behind the first, chain_1, chain_2, …"""
    basis = {str(i): columns(f, z) for i, f in enumerate(found.basis, 1)}
    return {**basis, **{f"chain_{j}": f(z) for j, f in enumerate(found.chain, 1)}}


def document(found: Eigenspace, z: NDArray[np.float64]) -> dict[str, Any]:
    """What `mode` answers of a multiple mode: its multiplicities, and each function with its error and its values at heights z (m,)."""
    values = functions(found, z)
    return {
        "mode": documents.mode(found.mode),
        "geometric_multiplicity": found.geometric_multiplicity,
        "algebraic_multiplicity": found.algebraic_multiplicity,
        "z": z.tolist(),
        "basis": [
            {"normalization": f.normalization, "error": f.error, "budget": f.budget.as_dict(), "fields": parts(values[str(i)])}
            for i, f in enumerate(found.basis, 1)
        ],
        "chain": [{"error": f.error, "fields": parts(values[f"chain_{j}"])} for j, f in enumerate(found.chain, 1)],
    }
