"""Spectra as JSON: a list of numbers, of pairs or of records, alone or under a key; or two lists, re and im."""

from __future__ import annotations

from typing import Any

from shootstab.core.errors import LISTED, shortened
from shootstab.core.reading import json_of
from shootstab.io.arrays import EIGENVALUE_NAMES, Wanted, pairs
from shootstab.io.text import MOST_EIGENVALUES, Placed, decoded, is_text, joined

MOST_JSON_PARTS = 10 * MOST_EIGENVALUES  # chosen: ten to an eigenvalue
ALLOWED_JSON = 'allowed is a list of numbers, of [re, im] or of {"re": …, "im": …}, or such a list named "eigenvalues"'


def from_json(data: bytes, wanted: Wanted) -> Placed:
    """Entry by entry. Raises ValueError."""
    text = decoded(data)
    if sum(text.count(mark) for mark in ",:[{") > MOST_JSON_PARTS:
        raise ValueError(f"more than {MOST_JSON_PARTS} lists, records and numbers in it: allowed are {MOST_EIGENVALUES} eigenvalues")
    document = json_of(text, ALLOWED_JSON)
    if wanted.row is not None:
        raise ValueError("--row: allowed for arrays in npy, npz, MATLAB and HDF5; this is json")
    if isinstance(document, dict):
        document = _list_in(document, wanted.dataset)
    elif wanted.dataset is not None:
        raise ValueError(f"--dataset {wanted.dataset}: allowed where lists have keys; this is one list")
    if not isinstance(document, list):
        raise ValueError(f"no list of eigenvalues in it: {ALLOWED_JSON}")
    for number, entry in enumerate(document, 1):
        place = f"entry {number}"
        if isinstance(entry, dict) and len(both := pairs([str(key) for key in entry])) == 1:
            yield place, joined([entry[both[0][1]], entry[both[0][2]]], place)
        elif isinstance(entry, list) and len(entry) == 2:
            yield place, joined(entry, place)
        elif isinstance(entry, list | dict):
            raise ValueError(f"{place}: {shortened(entry)}: {ALLOWED_JSON}")
        else:
            yield place, joined([entry], place)


def is_json(data: bytes) -> bool:
    """Whether it is text that begins a list or an object."""
    return data.removeprefix(b"\xef\xbb\xbf").lstrip()[:1] in (b"[", b"{") and is_text(data)


def _list_in(document: dict[str, Any], dataset: str | None) -> Any:
    """The list that is meant: the one asked for, eigenvalues or sigma, two that are re and im, or the only one."""
    lists = {key: value for key, value in document.items() if isinstance(value, list) and value}
    parts = [pair for pair in pairs(list(lists)) if len(lists[pair[1]]) == len(lists[pair[2]])]
    joined_lists = {stem or "re, im": [list(entry) for entry in zip(lists[re], lists[im], strict=True)] for stem, re, im in parts}
    lists.update(joined_lists)
    if dataset is not None:
        if dataset not in lists:
            raise ValueError(f"no list called {shortened(dataset)} in it: there are {', '.join(lists) or 'none'}")
        return lists[dataset]
    for name in EIGENVALUE_NAMES:
        if name in document:
            return document[name]
    if len(joined_lists) == 1:
        return next(iter(joined_lists.values()))
    if len(lists) > 1:
        raise ValueError(f"lists in it: {shortened(', '.join(lists), LISTED)}: {ALLOWED_JSON}, or --dataset NAME")
    return next(iter(lists.values()), None)
