"""`shootstab mode` of a multiple mode: a basis of all its solutions, and the chain of a defective one."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from shootstab.cli import commands, field_table, figures
from shootstab.core.allowed import MODE_HEIGHTS
from shootstab.core.errors import InputError
from shootstab.core.numerus import number_of

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from rich.console import RenderableType

    from shootstab.analyses.eigenspace import Eigenspace
    from shootstab.io.scenes import Scene

Columns = Mapping[str, "NDArray[Any]"]


def answer(options: Namespace, found: Eigenspace, scene: Scene, look: figures.Look) -> int:
    """Tables, files and picture of all functions, each by its number: NAME_1 of the first one of the basis, NAME_chain_1 of φ_1."""
    import numpy as np

    from shootstab.io import eigenspaces, fields

    if options.sensitivity:
        raise InputError("--sensitivity: allowed for a simple mode, whose eigenvalue moves as one")
    starts, ends = zip(*(f.extent for f in found.basis), strict=True)
    low, high = options.z or (min(starts), max(ends))
    z = np.linspace(low, high, options.points or MODE_HEIGHTS)
    document = eigenspaces.document(found, z)
    if options.export is not None:
        about = {"structure": found.structure, "normalizations": [f.normalization for f in found.basis], "scene": scene.name}
        columns = {f"{name}_{label}": f for label, values in eigenspaces.functions(found, z).items() for name, f in values.items()}
        fields.save(z, columns, options.export, about)
    if options.plot is not None:
        from shootstab.cli import mode_plot

        figures.save(lambda: mode_plot.draw_several(found, scene, z, look.size), options.plot, look)
    commands.answer(options, document, lambda: _tables(found, scene, z, eigenspaces.functions), scene)
    return commands.DONE


def _tables(
    found: Eigenspace, scene: Scene, z: NDArray[Any], functions: Callable[[Eigenspace, NDArray[Any]], Mapping[str, Columns]]
) -> list[RenderableType]:
    """What the mode is, then for each function its factor, its error and what `mode` shows of a single one."""
    from shootstab.cli import tables
    from shootstab.io.notation import held_complex

    m, g = found.algebraic_multiplicity, found.geometric_multiplicity
    zeros = f"{number_of(m, 'eigenvalue')}, equal or not told apart, {'lies' if m == 1 else 'lie'} within {found.mode.error:.1e}"
    solutions = f"{number_of(g, 'independent solution')}{'' if g == m else f', fewer than {m}: defective'}"
    relative = found.basis[0].conditioning.relative
    rows = {
        tables.in_symbol("σ", scene): held_complex(found.mode.sigma, found.mode.error),
        "multiplicity": zeros,
        "solutions": solutions,
        "condition": f"infinite: a change ε of the entries may move {scene.symbol} by a root of ε"
        if g < m
        else f"{relative:.2g}: relative changes ε of the entries make {relative:.2g} ε of {scene.symbol} at most",
    }
    shown: list[RenderableType] = [tables.heading(scene), tables.pairs(rows.items())]
    peak = found.basis[0].peak[0]
    said = {str(i): (f.normalization, f.error) for i, f in enumerate(found.basis, 1)}
    for j, f in enumerate(found.chain, 1):
        said[f"chain_{j}"] = (f"number {j} behind 1, with {peak} = 0 where that is 1", f.error)
    for label, values in functions(found, z).items():
        normalization, error = said[label]
        shown += [
            tables.pairs([(label, normalization), ("error", f"{error:.1e} of the largest value of all unknowns")]),
            field_table.table_of(values, z, found.basis[0].variable, dict.fromkeys(values, error)),
        ]
    return [*shown, tables.paragraph(f"Values at {len(z)} heights.")]
