"""What others have published of the gallery's problems: the numbers, how many of their digits hold, and where they stand."""

from __future__ import annotations

from shootstab.models.catalogue import entries
from shootstab.models.catalogue.entry import Published
from shootstab.models.catalogue.scene_files import scene_files

PUBLISHED: tuple[Published, ...] = (
    *(item for entry in entries().values() for item in entry.published),
    *(file.published for file in scene_files().values()),
)
