"""What Python gets of `verify`: a report that shows itself, as text, in a notebook, as a table for a page, as a picture."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

from shootstab.core.records import Report

if TYPE_CHECKING:
    from shootstab.io.scenes import Scene


@dataclass(frozen=True, repr=False)
class PresentedReport(Report):
    """A report with the scene that it is about."""

    scene: Scene | None = None

    @classmethod
    def of(cls, report: Report, scene: Scene) -> PresentedReport:
        """The report with its scene."""
        return cls(**{field.name: getattr(report, field.name) for field in fields(Report)}, scene=scene)

    def __str__(self) -> str:
        """The table that the command line prints."""
        from shootstab.cli import tables, terminal

        assert self.scene is not None
        return terminal.plain(tables.report(self, self.scene))

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        return self.to_html()

    def to_html(self) -> str:
        """The table in HTML."""
        from shootstab.cli import exports

        return exports.html_table(self, self.scene)

    def to_markdown(self) -> str:
        """The table in Markdown."""
        from shootstab.cli import exports

        return exports.markdown(self, self.scene)

    def to_latex(self) -> str:
        """The table as a tabular; needs the package booktabs."""
        from shootstab.cli import exports

        return exports.latex(self, self.scene)

    def plot(self, ax: Any = None) -> Any:
        """The complex plane on a matplotlib Axes, which is returned; without one, a Figure that magnifies where modes are."""
        from shootstab.cli import plots

        assert self.scene is not None
        if ax is None:
            return plots.draw(self, self.scene)
        plots.draw_on(ax, self, self.scene)
        return ax
