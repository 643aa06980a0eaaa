"""The methods by name, for the command line and for whoever has no tolerance in mind. A method loads its kernels when it is made."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from shootstab.core.errors import InputError

if TYPE_CHECKING:
    from shootstab.discriminants.method import Method

METHODS = {"frame": "Frame", "compound": "Compound", "riccati": "Riccati"}  # the class of each in the module of its name


def make(name: str, **settings: Any) -> Method:
    """The method of a name in METHODS, with these settings."""
    method: Method = getattr(import_module(f"shootstab.discriminants.{name}"), METHODS[name])(**settings)
    return method


def method_named(method: Method | str | None, rtol: float) -> Method | None:
    """The method itself, or the one of this name with local errors below rtol. Raises InputError for what is neither."""
    if isinstance(method, str):
        if method not in METHODS:
            raise InputError(f"method = {method!r}: allowed is {', '.join(METHODS)}, or a method such as st.Frame(rtol=1e-11)")
        return make(method, rtol=rtol)
    if method is not None and not (callable(getattr(method, "on", None)) and hasattr(method, "rtol")):
        raise InputError(f"method = {method!r}: allowed is {', '.join(METHODS)}, or a method such as st.Frame(rtol=1e-11)")
    return method
