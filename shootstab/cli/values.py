"""The values of options, refused in words: each parser raises argparse.ArgumentTypeError that says what is allowed."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable
from pathlib import Path

from shootstab.core.allowed import LARGEST_TOLERANCE, LEAST_MODE_RTOL, MOST_WORKERS, RTOL
from shootstab.io.notation import complex_from, floats_from

LARGEST_INTEGER = 999_999_999  # chosen: nine digits, more than anything is counted in
RTOL_HELP = f"relative accuracy asked for (default {RTOL:g})"


def refused(text: str, allowed: str) -> argparse.ArgumentTypeError:
    """The refusal of a text, with what is allowed."""
    return argparse.ArgumentTypeError(f"{text!r}: allowed is {allowed}")


def integer(least: int, most: int = LARGEST_INTEGER) -> Callable[[str], int]:
    """A parser of integers in this range."""

    def parse(text: str) -> int:
        if not re.fullmatch(rf"\d{{1,{len(str(LARGEST_INTEGER))}}}", text, re.ASCII) or not least <= int(text) <= most:
            raise refused(text, f"an integer from {least} to {most}")
        return int(text)

    return parse


def counted(parser: argparse.ArgumentParser, option: str, least: int, most: int, default: int, meaning: str) -> None:
    """Add an option that is an integer in this range, with its default told behind its meaning."""
    parser.add_argument(option, type=integer(least, most), default=default, metavar="N", help=f"{meaning} (default {default})")


def numbers(count: int | None = None) -> Callable[[str], tuple[float, ...]]:
    """A parser of so many finite numbers with commas between them, of any number of them for None."""

    def parse(text: str) -> tuple[float, ...]:
        try:
            return floats_from(text, count)
        except ValueError:
            wanted = "finite numbers" if count is None else f"{count} finite numbers"
            raise refused(text, "a finite number" if count == 1 else f"{wanted} with commas between them") from None

    return parse


def guess(text: str) -> complex:
    """A complex number as RE, RE,IM or RE+IMi."""
    try:
        if "," in text:
            return complex(*floats_from(text, 2))
        guess = complex_from(text)
    except ValueError:
        guess = complex("nan")
    if guess - guess != 0:
        raise refused(text, "RE, RE,IM or RE+IMi, finite")
    return guess


def tolerance(text: str) -> float:
    """A relative accuracy."""
    value = numbers(1)(text)[0]
    if not LEAST_MODE_RTOL <= value <= LARGEST_TOLERANCE:
        raise refused(text, f"a number from {LEAST_MODE_RTOL:g} to {LARGEST_TOLERANCE:g}")
    return value


def absolute(text: str) -> float:
    """An absolute accuracy."""
    value = numbers(1)(text)[0]
    if not value >= 0.0:
        raise refused(text, "a finite number from 0 on")
    return value


def table_path(text: str) -> Path:
    """The name of a table of fields."""
    path = Path(text)
    if path.suffix.lower() not in (".csv", ".npz"):
        raise refused(text, "a file name that ends in .csv or .npz")
    return path


def plot_path(text: str) -> Path:
    """The name of a picture."""
    path = Path(text)
    if path.suffix.lower() not in (".png", ".pdf", ".svg"):
        raise refused(text, "a file name that ends in .png, .pdf or .svg")
    return path


def shared_out(parser: argparse.ArgumentParser, by_default: str) -> None:
    """Add --workers and --dask: who does the work."""
    who = parser.add_mutually_exclusive_group()
    who.add_argument("--workers", type=integer(1, MOST_WORKERS), metavar="N", help=f"processes (default: {by_default})")
    who.add_argument("--dask", metavar="ADDRESS", help="the scheduler of a Dask cluster that does the work")
