"""The balls of python-flint, an optional library: whatever needs them is refused in a line where it is not installed."""

from __future__ import annotations

from shootstab.core.errors import InputError

try:
    from flint import (
        Ordering,
        acb,
        acb_mat,
        acb_poly,
        acb_series,
        arb,
        arb_mat,
        arb_series,
        ctx,
        fmpq,
        fmpq_mat,
        fmpq_mpoly_ctx,
        fmpq_series,
        fmpz_poly,
    )
except ImportError:
    raise InputError("a proof needs python-flint: install it with `pip install 'shootstab[precise]'`") from None

__all__ = [
    "Ordering",
    "acb",
    "acb_mat",
    "acb_poly",
    "acb_series",
    "arb",
    "arb_mat",
    "arb_series",
    "ctx",
    "fmpq",
    "fmpq_mat",
    "fmpq_mpoly_ctx",
    "fmpq_series",
    "fmpz_poly",
]
