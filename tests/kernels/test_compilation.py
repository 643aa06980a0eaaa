"""Whoever asks is told that a kernel is compiled, and not that it is used again."""

from __future__ import annotations

from numba import njit

import shootstab.kernels  # noqa: F401 - it listens to numba
from shootstab.core import compilation


def test_compilation_is_told_once_for_every_signature() -> None:
    names: list[str] = []
    compilation.tell(names.append)

    @njit
    def doubled(x):  # type: ignore[no-untyped-def]
        return x + x

    assert names == []
    assert [doubled(1.0), doubled(2.0), doubled(2)] == [2.0, 4.0, 4]
    assert [name for name in names if name == "doubled"] == ["doubled"] * 2
