"""shootstab: an independent second opinion on eigenvalues of linear stability problems.

    import shootstab as st

    flow = st.chute.steady(mass_flux=3.0, branch="high", e=0.8, e_w=0.8, r=0.6, tan_theta=0.3)
    problem = st.chute.problem(flow, kx=0.0, ky=0.01)
    mode = st.refine(problem, guess=0.004, rtol=1e-10)
    report = st.verify(problem, [0.0039705046, 0.002 + 0.003j])
    count = st.count(problem, st.Rectangle(1e-4 - 0.1j, 0.05 + 0.1j))

Everything is imported when it is first used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from shootstab import testing
    from shootstab.discriminants.compound import Compound
    from shootstab.discriminants.frame import Frame
    from shootstab.discriminants.riccati import Riccati
    from shootstab.problems import chute, gallery
    from shootstab.problems.closed import ClosedProblem
    from shootstab.problems.linear import Infinity, Interface, LinearProblem, Wall, problem
    from shootstab.questions.count import count
    from shootstab.questions.critical import critical
    from shootstab.questions.find import find
    from shootstab.questions.refine import refine
    from shootstab.questions.sweep import sweep
    from shootstab.questions.trade import trade
    from shootstab.questions.unstable import count_unstable
    from shootstab.questions.verify import verify
    from shootstab.vocabulary.errors import ConvergenceError, InputError, NoFlowError, ShootstabError
    from shootstab.vocabulary.regions import Disc, Polygon, Rectangle

__version__ = "0.2.1"

_HOMES = {
    "ClosedProblem": "shootstab.problems.closed",
    "Compound": "shootstab.discriminants.compound",
    "ConvergenceError": "shootstab.vocabulary.errors",
    "Disc": "shootstab.vocabulary.regions",
    "Frame": "shootstab.discriminants.frame",
    "InputError": "shootstab.vocabulary.errors",
    "problem": "shootstab.problems.linear",
    "Wall": "shootstab.problems.linear",
    "LinearProblem": "shootstab.problems.linear",
    "Interface": "shootstab.problems.linear",
    "Infinity": "shootstab.problems.linear",
    "Polygon": "shootstab.vocabulary.regions",
    "NoFlowError": "shootstab.vocabulary.errors",
    "Rectangle": "shootstab.vocabulary.regions",
    "Riccati": "shootstab.discriminants.riccati",
    "ShootstabError": "shootstab.vocabulary.errors",
    "chute": "shootstab.problems",
    "count": "shootstab.questions.count",
    "critical": "shootstab.questions.critical",
    "count_unstable": "shootstab.questions.unstable",
    "find": "shootstab.questions.find",
    "gallery": "shootstab.problems",
    "refine": "shootstab.questions.refine",
    "sweep": "shootstab.questions.sweep",
    "testing": "shootstab",
    "trade": "shootstab.questions.trade",
    "verify": "shootstab.questions.verify",
}

__all__ = [
    "ClosedProblem",
    "Compound",
    "ConvergenceError",
    "Disc",
    "Frame",
    "Infinity",
    "InputError",
    "Interface",
    "LinearProblem",
    "NoFlowError",
    "Polygon",
    "Rectangle",
    "Riccati",
    "ShootstabError",
    "Wall",
    "chute",
    "count",
    "count_unstable",
    "critical",
    "find",
    "gallery",
    "problem",
    "refine",
    "sweep",
    "testing",
    "trade",
    "verify",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'shootstab' has no attribute {name!r}")
    home = _HOMES[name]
    value = import_module(f"{home}.{name}") if name in ("chute", "gallery", "testing") else getattr(import_module(home), name)
    globals()[name] = value
    return value
