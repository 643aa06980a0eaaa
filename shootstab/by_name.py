"""Scenes, files and methods by name in Python, as on the command line.

st.verify("low", "modes.npy")
st.refine("low", 0.0073 - 0.0119j, method="riccati")
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shootstab.core.errors import InputError
from shootstab.discriminants.named import METHODS, make
from shootstab.presented import PresentedReport

if TYPE_CHECKING:
    from shootstab.core.discriminant import Discriminant
    from shootstab.io.scenes import Scene


def problem_of(named: Any) -> Any:
    """A problem: as it is, of a Scene, or of the scene of that name (a built-in name, a TOML file, module:object). Raises InputError."""
    from shootstab.io.scenes import Scene, load

    if isinstance(named, str | Path):
        return load(str(named)).problem
    return named.problem if isinstance(named, Scene) else named


def scene_of(named: Any) -> Scene:
    """The scene of that name, or a problem as a scene without a name of its own. Raises InputError."""
    from shootstab.core.scene_keys import Description
    from shootstab.io.scenes import Scene, load

    if isinstance(named, str | Path):
        return load(str(named))
    if isinstance(named, Scene):
        return named
    return Scene("problem", type(named).__name__, named, Description(named.size), getattr(named, "flow", None))


def method_of(named: Any) -> Any:
    """A method: as it is, None for the program's choice, or the one of that name with its own tolerance. Raises InputError."""
    if not isinstance(named, str):
        return named
    if named not in METHODS:
        from shootstab.io.notation import nearest

        raise InputError(f"method = {named!r}{nearest(named, METHODS)}: allowed is {', '.join(METHODS)} or st.Frame(...)")
    return make(named)


def by_name(analysis: Callable[..., Any]) -> Callable[..., Any]:
    """The analysis, whose problem and method may be given by name."""

    @wraps(analysis)
    def asked(problem: Any, *arguments: Any, **options: Any) -> Any:
        if "method" in options:
            options["method"] = method_of(options["method"])
        return analysis(problem_of(problem), *arguments, **options)

    return asked


def verifying(analysis: Callable[..., Any]) -> Callable[..., Any]:
    """`verify`, whose eigenvalues may be a number, a list, an array, or the name of a file, and whose report shows itself."""
    asked = by_name(analysis)

    @wraps(analysis)
    def verify(problem: Any, eigenvalues: Any, *arguments: Any, **options: Any) -> Any:
        from shootstab.io.readers import ClaimedSpectrum, read

        if isinstance(eigenvalues, str | Path):
            eigenvalues = read(eigenvalues)
        elif isinstance(eigenvalues, int | float | complex):
            eigenvalues = [eigenvalues]
        scene = scene_of(problem)
        report = PresentedReport.of(asked(scene.problem, eigenvalues, *arguments, **options), scene)
        return replace(report, dropped=eigenvalues.dropped) if isinstance(eigenvalues, ClaimedSpectrum) else report

    return verify


def discriminant(problem: Any, method: Any = "frame") -> Discriminant:
    """D(σ) of a problem (or scene) by a method (or its name), along the real axis: d(sigma) and d.with_derivative(sigma).

    Its mesh grows with the σ that it is asked about; near a continuous spectrum the path that `refine` would take is another one.
    """
    found: Discriminant = method_of(method).on(problem_of(problem))
    return found
