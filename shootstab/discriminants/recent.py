"""Continuations of the problems that were asked about last, so that a second question about one finds its meshes.

What is kept changes how long an answer takes, and no answer: the mesh that serves σ follows from σ. Kept is only what belongs to a problem
that is made of formulas and numbers. A function of the user's own may read what has changed since.
"""

from __future__ import annotations

import threading
from collections import OrderedDict

from shootstab.discriminants.continuation import Continuation
from shootstab.discriminants.method import Method
from shootstab.problems.capabilities import UNCHANGING
from shootstab.problems.protocol import Problem

RECENT = 2  # chosen: continuations that are kept: of one problem that to the tolerance asked for, and a tighter one
MOST_KEPT_BYTES = 2**24  # chosen: memory of the meshes of one that is kept; with halved meshes and two base flows it is eight times that

_kept = threading.local()  # every thread has its own: discriminants count and keep their values


def continuation_of(problem: Problem, method: Method) -> Continuation:
    """The continuation of a problem by a method, of late or a new one."""
    if not UNCHANGING.of(problem):
        return Continuation(problem, method)
    recent: OrderedDict[tuple[int, Method], Continuation] = _kept.__dict__.setdefault("recent", OrderedDict())
    key = id(problem), method
    for grown in [other for other, kept in recent.items() if kept.bytes_kept > MOST_KEPT_BYTES]:
        del recent[grown]
    # a continuation holds its problem, so that no other one has the same id
    recent[key] = recent.pop(key) if key in recent else Continuation(problem, method)
    if len(recent) > RECENT:
        recent.popitem(last=False)
    return recent[key]
