"""core/numerus.py: one thing and several in a sentence."""

from __future__ import annotations

from shootstab.core.numerus import number_of


def test_one_is_singular_and_every_other_number_plural() -> None:
    assert [number_of(n, "mode") for n in (0, 1, 2)] == ["0 modes", "1 mode", "2 modes"]
    assert [number_of(n, "mode is", "modes are") for n in (0, 1, 11)] == ["0 modes are", "1 mode is", "11 modes are"]
