"""The methods by name, for the command line and for whoever has no tolerance in mind."""

from __future__ import annotations

from collections.abc import Callable

from shootstab.core.errors import InputError
from shootstab.discriminants.compound import Compound
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.method import Method
from shootstab.discriminants.riccati import Riccati

METHODS: dict[str, Callable[..., Method]] = {"frame": Frame, "compound": Compound, "riccati": Riccati}


def method_named(method: Method | str | None, rtol: float) -> Method | None:
    """The method itself, or the one of this name with local errors below rtol. Raises InputError for what is neither."""
    if isinstance(method, str):
        if method not in METHODS:
            raise InputError(f"method = {method!r}: allowed is {', '.join(METHODS)}, or a method such as st.Frame(rtol=1e-11)")
        return METHODS[method](rtol=rtol)
    if method is not None and not (callable(getattr(method, "on", None)) and hasattr(method, "rtol")):
        raise InputError(f"method = {method!r}: allowed is {', '.join(METHODS)}, or a method such as st.Frame(rtol=1e-11)")
    return method
