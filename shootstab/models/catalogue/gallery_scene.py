"""The gallery as scene files see it: [problem] with a name and the keys of the problem of that name; and scene files of its own."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any

from shootstab.core.errors import InputError, shortened
from shootstab.core.scene_keys import BuiltIn, Description, Made, NamedScene, Tables
from shootstab.core.scene_notes import about, described
from shootstab.models.catalogue import entries
from shootstab.models.catalogue.entry import Entry
from shootstab.models.catalogue.scene_files import scene_files


class GalleryScenes:
    """See core.scene_keys.SceneModel."""

    tables = ("problem",)

    @cached_property
    def built_in(self) -> Mapping[str, NamedScene]:
        """The scenes of all entries, and the scene files."""
        made = {
            name: BuiltIn(description, {"problem": {"name": entry.name, **values}})
            for entry in entries().values()
            for name, (description, values) in entry.scenes.items()
        }
        return {**made, **scene_files()}

    def details(self, tables: Tables) -> Description:
        if "equations" in tables["problem"]:
            notes = about(tables)
            return described(tables["problem"], notes, notes["order"])
        entry, values = self._entry(tables)
        return entry.describe(values)

    def made(self, tables: Tables) -> Made:
        entry, values = self._entry(tables)
        return Made(entry.make(**values), entry.describe(values))

    def _entry(self, tables: Tables) -> tuple[Entry, dict[str, Any]]:
        table = tables["problem"]
        wanted = table.get("name") if isinstance(table, dict) else None
        known = entries()
        if not isinstance(wanted, str) or wanted not in known:
            raise InputError(f"[problem] name = {shortened(wanted)}: allowed is one of {', '.join(known)}")
        values = known[wanted].keys.checked(tables)
        del values["name"]
        return known[wanted], values


MODEL = GalleryScenes()
