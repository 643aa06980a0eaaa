"""The dominant mode over wavenumbers and flows: followed from point to point, counted often enough, in parallel, resumable."""

from __future__ import annotations

from shootstab.analyses.sweep.swept import Swept, sweep

__all__ = ["Swept", "sweep"]
