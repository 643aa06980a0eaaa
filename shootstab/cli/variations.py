"""The parameters of a scene of which other values are tried where no claim is a mode of it, and what is said of one that is found."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

from shootstab.analyses.hypotheses import LEAST
from shootstab.analyses.other_parameters import OtherValue, Searched, Together, Variation
from shootstab.core.records import SPURIOUS, Report
from shootstab.io import scenes as scene_files
from shootstab.io.conventions import Convention
from shootstab.problems.capabilities import FAMILY
from shootstab.problems.rescaled import Rescaled

if TYPE_CHECKING:
    from shootstab.problems.protocol import Problem

OF_A_RUN = ("alpha", "beta", "omega", "wavenumber", "reynolds", "rayleigh")  # chosen: what differs from run to run and needs no other flow


def variations(scene: scene_files.Scene, convention: Convention, own_wavenumber: bool) -> Mapping[str, Variation]:
    """Those parameters by name, for the eigenvalue of a convention; own_wavenumber: α of a phase speed is that of the scene."""
    found: dict[str, Variation] = {}
    own = scene.wavenumber and scene.wavenumber[0]
    for name, (here, member) in _members(scene).items():
        turned = own_wavenumber and convention.kind == "phase-speed" and name == own
        found[name] = Variation(here, partial(_seen, member, convention, here if turned else None))
    return found


def together(scene: scene_files.Scene, convention: Convention, own_wavenumber: bool) -> Together:
    """The problem at values of several of those parameters, for the eigenvalue of a convention."""
    turned = own_wavenumber and convention.kind == "phase-speed"
    family_of = FAMILY.of(scene.problem)

    def member(values: Mapping[str, float]) -> Problem:
        if family_of is not None:
            problem: Problem = family_of(tuple(values)).problem(values)
        else:
            tables = {**scene.parameters, "problem": {**scene.parameters["problem"], **values}}
            problem = scene_files.from_tables(scene.name, scene.description, tables).problem
        unit = convention.unit
        if turned and scene.wavenumber and scene.wavenumber[0] in values:
            unit *= values[scene.wavenumber[0]] / scene.wavenumber[1]
        return problem if unit == 1.0 else Rescaled(problem, unit)

    return member


def _seen(member: Callable[[float], Problem], convention: Convention, here: float | None, value: float) -> Problem:
    """The problem at a value, with the eigenvalue of the convention, whose α goes with the value if it was that of the scene here."""
    problem = member(value)
    unit = convention.unit * (1.0 if here is None else value / here)
    return problem if unit == 1.0 else Rescaled(problem, unit)


def _members(scene: scene_files.Scene) -> dict[str, tuple[float, Callable[[float], Problem]]]:
    """Values and members by name: of a family along which the base flow is one, of equations all, of a table those of a run."""
    family_of = FAMILY.of(scene.problem)
    if family_of is not None:
        family = family_of(())
        names = [name for name in family.sharing or family.here if family.here[name] != 0.0]
        return {name: (float(family.here[name]), partial(_of_family, family_of, name)) for name in names}
    table = scene.parameters.get("problem", {})
    return {name: (float(table[name]), partial(_of_table, scene, name)) for name in OF_A_RUN if table.get(name)}


def _of_family(family_of: Any, name: str, value: float) -> Problem:
    problem: Problem = family_of((name,)).problem({name: value})
    return problem


def _of_table(scene: scene_files.Scene, name: str, value: float) -> Problem:
    tables = {**scene.parameters, "problem": {**scene.parameters["problem"], name: value}}
    return scene_files.from_tables(scene.name, scene.description, tables).problem


def sentence(found: OtherValue) -> str:
    """The proposal in words."""
    tried = f"All {found.tried}" if found.agreeing == found.tried else f"{found.agreeing} of {found.tried}"
    there, here = f"{found.parameter} = {found.value:g}", f"{found.parameter} = {found.here:g}"
    if found.second is not None:
        name, own, other = found.second
        there, here = f"{there} and {name} = {other:g}", f"{here} and {name} = {own:g}"
    return f"{tried} claims tried are modes to {found.digits:.1f} digits at {there}; this scene has {here}."


def without_success(searched: Searched, report: Report, seconds: float | None) -> list[str]:
    """What was tried in vain, in a sentence, and the seconds of processor time that ended it, if they did; nothing if nothing was tried."""
    every_one = len(report.verdicts) >= LEAST and all(v.verdict == SPURIOUS for v in report.verdicts)
    tried = ["conjugates, signs, frequencies and units of the claims"] if every_one else []
    tried += [f"{name} from {low:.3g} to {high:.3g}" for name, (low, high) in searched.ranges.items()]
    if searched.pairs:
        tried.append("two of these at once")
    limit = "" if seconds is None else f" The search for it ends after {seconds:g} s of processor time."
    return [f"What the claims may mean was not found; tried: {'; '.join(tried)}.{limit}"] if tried else []
