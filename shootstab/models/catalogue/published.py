"""What others have published of the gallery's problems: the numbers, how many of their digits hold, and where they stand."""

from __future__ import annotations

from shootstab.models.catalogue import entries
from shootstab.models.catalogue.entry import Published

PUBLISHED: tuple[Published, ...] = tuple(published for entry in entries().values() for published in entry.published)
