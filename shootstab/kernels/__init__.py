"""Floor 1: compiled loops over arrays and scalars. Nothing here knows what the numbers mean."""

from shootstab.kernels.cache import require_place

require_place()
