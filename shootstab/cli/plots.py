"""Pictures of the complex plane: a report's claims by verdict, a reference's spectrum, the modes of a region."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from shootstab.cli import figures, plane
from shootstab.cli.figures import PLAIN, Look, Size
from shootstab.cli.plane import Box, Group, Points
from shootstab.cli.verdict_looks import MISSING_LOOK, VERDICT_LOOKS
from shootstab.core.numerus import number_of
from shootstab.core.records import CONTINUUM, Report
from shootstab.core.regions import Region

if TYPE_CHECKING:
    from shootstab.analyses.find import Found
    from shootstab.io.scenes import Scene
    from shootstab.spectral.qz import Spectrum

RING = {"markerfacecolor": "none", "markeredgecolor": "black", "markersize": 11, "zorder": 4}
STAR = {"color": MISSING_LOOK.colour, "markeredgecolor": "black", "markersize": MISSING_LOOK.size, "zorder": 5}
OUTLINE = 400  # chosen: points of a region's rim

require = figures.require


def save(report: Report, scene: Scene, path: Path, look: Look = PLAIN) -> None:
    """Draw the report into a png, pdf or svg file, told by its suffix."""
    figures.save(lambda: draw(report, scene, look.size), path, look)


def draw(report: Report, scene: Scene, size: Size | None = None) -> Any:
    """The claims by verdict, the modes they mean and the missing ones, as a matplotlib Figure."""
    groups, near = of_report(report, scene)
    return plane.picture(scene, groups, near, f"{scene.name}: {_counts(report)}\n{scene.description}", rim(report.region), size)


def draw_on(axes: Any, report: Report, scene: Scene) -> None:
    """The picture on one matplotlib Axes, which shows all claims."""
    groups, _ = of_report(report, scene)
    plane.fill(axes, scene, groups, plane.continuum(scene))
    axes.legend(fontsize="small")


def of_report(report: Report, scene: Scene) -> tuple[list[Group], Box]:
    """What is drawn, and the part that is magnified."""
    groups = []
    for verdict, look in VERDICT_LOOKS.items():
        chosen = _claims(report, verdict)
        style = {"color": look.colour, "markersize": look.size, "markeredgewidth": 1.4, "linestyle": "none", "zorder": 3}
        groups.append(Group(f"{verdict} ({chosen.size})", chosen, look.marker, style))
    modes = _points([v.sigma for v in report.verdicts if v.sigma is not None])
    missing = _points([m.sigma for m in report.missing])
    groups += [Group("mode", modes, "o", RING), Group(f"missing mode ({missing.size})", missing, MISSING_LOOK.marker, STAR)]
    near = plane.magnified(scene, np.concatenate([modes, missing]), _claims(report), _claims(report, CONTINUUM))
    return groups, near


def draw_spectrum(found: Spectrum, scene: Scene, raw: bool, size: Size | None = None) -> Any:
    """The reference's eigenvalues: those that pass its filters, and with raw all others too."""
    passing = _points(found.eigenvalues)
    others = _points(found.raw) if raw else passing[:0]
    others = others[~np.isin(others, passing)] if raw else others
    groups = [
        Group(f"filtered out ({others.size})", others, "x", {"color": "0.55", "markersize": 5, "zorder": 2}),
        Group(f"pass both filters ({passing.size})", passing, "o", {"color": "#0072B2", "markersize": 6, "zorder": 3}),
    ]
    near = plane.magnified(scene, passing, passing if passing.size else others, others[:0])
    title = f"{scene.name}: pseudospectral reference at truncation {found.truncation}\n{scene.description}"
    return plane.picture(scene, groups, near, title, None, size)


def draw_found(answer: Found, region: Region, scene: Scene, size: Size | None = None) -> Any:
    """The modes of a region, and the resonances where they were asked for."""
    modes = _points([m.sigma for m in answer.modes])
    resonances = _points(answer.resonances or ())
    groups = [
        Group(f"mode ({modes.size})", modes, "o", {"color": "#009E73", "markersize": 7, "zorder": 3}),
        Group(f"resonance ({resonances.size})", resonances, "d", {"color": "#CC79A7", "markersize": 6, "zorder": 3}),
    ]
    outline = rim(region)
    assert outline is not None
    near = plane.around(np.concatenate([outline, modes]), 0.0)
    title = f"{scene.name}: {number_of(answer.counted.count, 'mode')} inside the region\n{scene.description}"
    return plane.picture(scene, groups, near, title, outline, size)


def rim(region: Region | None) -> Points | None:
    """The boundary of a region as a closed line (m,)."""
    if region is None:
        return None
    return _points([region.boundary(t) for t in sorted({*region.corners, *(k / OUTLINE for k in range(OUTLINE + 1))})])


def _claims(report: Report, *verdicts: str) -> Points:
    """The claimed eigenvalues with these verdicts; without any, all."""
    return _points([v.claimed for v in report.verdicts if v.verdict in (verdicts or VERDICT_LOOKS)])


def _points(values: Sequence[Any] | Any) -> Points:
    return np.array([complex(v) for v in values], dtype=np.complex128)


def _counts(report: Report) -> str:
    named = ", ".join(f"{n} {what}" for what, n in report.summary.items() if n)
    return named or "no eigenvalues"
