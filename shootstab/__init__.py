"""shootstab: an independent second opinion on eigenvalues of linear stability problems.

    import shootstab as st

    flow = st.chute.steady(mass_flux=3.0, branch="high", e=0.8, e_w=0.8, r=0.6, tan_theta=0.3)
    problem = st.chute.problem(flow, kx=0.0, ky=0.01)
    mode = st.refine(problem, guess=0.004, rtol=1e-10)
    report = st.verify(problem, [0.0039705046, 0.002 + 0.003j])
    count = st.count(problem, st.Rectangle(1e-4 - 0.1j, 0.05 + 0.1j))

Scenes, files and methods may be given by name, as on the command line: st.verify("low", "modes.npy"), st.scene("low").problem.
Everything is imported when it is first used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from shootstab import testing
    from shootstab.analyses.count import count
    from shootstab.analyses.critical import critical
    from shootstab.analyses.eigenfunction import eigenfunction
    from shootstab.analyses.eigenspace import eigenspace
    from shootstab.analyses.find import find
    from shootstab.analyses.prove import prove
    from shootstab.analyses.refine import refine
    from shootstab.analyses.sensitivity import sensitivities
    from shootstab.analyses.sweep import sweep
    from shootstab.analyses.unstable import count_unstable
    from shootstab.analyses.verify import verify
    from shootstab.analyses.work_precision import trade
    from shootstab.by_name import discriminant
    from shootstab.core.errors import ConvergenceError, InputError, NoFlowError, ShootstabError
    from shootstab.core.half_annulus import HalfAnnulus
    from shootstab.core.regions import Disc, Polygon, Rectangle
    from shootstab.discriminants.compound import Compound
    from shootstab.discriminants.frame import Frame
    from shootstab.discriminants.riccati import Riccati
    from shootstab.formulation.conditions import Axis, Conditions, Periodic
    from shootstab.formulation.joints import InterfaceConditions
    from shootstab.formulation.problem import equations
    from shootstab.io.readers import read
    from shootstab.io.scenes import load as scene
    from shootstab.models import chute, gallery
    from shootstab.problems import Infinity, Interface, LinearProblem, Wall
    from shootstab.problems.closed_form import ClosedProblem
    from shootstab.problems.linear_problem import problem
    from shootstab.problems.profile import profile

__version__ = "0.2.1"

_HOMES = {
    "ClosedProblem": "shootstab.problems.closed_form",
    "Compound": "shootstab.discriminants.compound",
    "ConvergenceError": "shootstab.core.errors",
    "Disc": "shootstab.core.regions",
    "Frame": "shootstab.discriminants.frame",
    "HalfAnnulus": "shootstab.core.half_annulus",
    "InputError": "shootstab.core.errors",
    "problem": "shootstab.problems",
    "equations": "shootstab.formulation.problem",
    "discriminant": "shootstab.by_name",
    "read": "shootstab.io.readers",
    "scene": "shootstab.io.scenes",
    "Conditions": "shootstab.formulation.conditions",
    "Axis": "shootstab.formulation.conditions",
    "Periodic": "shootstab.formulation.conditions",
    "InterfaceConditions": "shootstab.formulation.joints",
    "Wall": "shootstab.problems",
    "LinearProblem": "shootstab.problems",
    "Interface": "shootstab.problems",
    "Infinity": "shootstab.problems",
    "Polygon": "shootstab.core.regions",
    "NoFlowError": "shootstab.core.errors",
    "Rectangle": "shootstab.core.regions",
    "Riccati": "shootstab.discriminants.riccati",
    "ShootstabError": "shootstab.core.errors",
    "chute": "shootstab.models",
    "count": "shootstab.analyses.count",
    "critical": "shootstab.analyses.critical",
    "count_unstable": "shootstab.analyses.unstable",
    "eigenfunction": "shootstab.analyses.eigenfunction",
    "eigenspace": "shootstab.analyses.eigenspace",
    "find": "shootstab.analyses.find",
    "gallery": "shootstab.models",
    "profile": "shootstab.problems.profile",
    "prove": "shootstab.analyses.prove",
    "refine": "shootstab.analyses.refine",
    "sensitivities": "shootstab.analyses.sensitivity",
    "sweep": "shootstab.analyses.sweep",
    "testing": "shootstab",
    "trade": "shootstab.analyses.work_precision",
    "verify": "shootstab.analyses.verify",
}

_MODULES = ("chute", "gallery", "testing")
_INSIDE = {"scene": "load"}  # called otherwise in its module
_ASKED = ("count", "count_unstable", "eigenfunction", "eigenspace", "find", "prove", "refine", "trade", "verify")

__all__ = [
    "Axis",
    "ClosedProblem",
    "Compound",
    "Conditions",
    "ConvergenceError",
    "Disc",
    "Frame",
    "HalfAnnulus",
    "Infinity",
    "InputError",
    "Interface",
    "InterfaceConditions",
    "LinearProblem",
    "NoFlowError",
    "Periodic",
    "Polygon",
    "Rectangle",
    "Riccati",
    "ShootstabError",
    "Wall",
    "chute",
    "count",
    "count_unstable",
    "critical",
    "discriminant",
    "eigenfunction",
    "eigenspace",
    "equations",
    "find",
    "gallery",
    "problem",
    "profile",
    "prove",
    "read",
    "refine",
    "scene",
    "sensitivities",
    "sweep",
    "testing",
    "trade",
    "verify",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'shootstab' has no attribute {name!r}")
    home = _HOMES[name]
    value = _found(home, name)
    if name in _ASKED:  # problems, files and methods by name
        from shootstab import by_name

        value = by_name.verifying(value) if name == "verify" else by_name.by_name(value)
    globals()[name] = value
    return value


def _found(home: str, name: str) -> Any:
    return import_module(f"{home}.{name}") if name in _MODULES else getattr(import_module(home), _INSIDE.get(name, name))


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])
