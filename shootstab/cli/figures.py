"""What all pictures have in common: the size and the style that were asked for, letters that stay letters, a file written whole."""

from __future__ import annotations

import importlib.util
import math
from argparse import ArgumentParser, Namespace
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from shootstab.cli import values
from shootstab.core.errors import InputError
from shootstab.io.files import write_whole

DOTS = 160  # chosen: dots per inch of a png
# a pdf holds TrueType fonts, in which text can be found and edited, an svg text in place of outlines
LETTERS: dict[Any, Any] = {"pdf.fonttype": 42, "ps.fonttype": 42, "svg.fonttype": "none"}

NARROWEST = 1.6  # chosen: inches of a panel whose numbers and name stay apart from those of its neighbours
LEGEND_ENTRY = 1.8  # chosen: inches of a mark with its name
LARGEST_INCHES = 50.0  # chosen: width and height of a picture
Size = tuple[float, float]  # width and height in inches


@dataclass(frozen=True)
class Look:
    """style: a style of matplotlib's, or a file of one; size: width and height in inches, None for that of the picture."""

    style: str | None = None
    size: Size | None = None

    @classmethod
    def of(cls, options: Namespace) -> Look:
        """The look that the options of a command ask for."""
        return cls(options.style, options.size)


PLAIN = Look()


def options(command: ArgumentParser, says: str) -> None:
    """--plot, --style and --size."""
    command.add_argument("--plot", type=values.plot_path, metavar="FILE", help=f"{says} into a png, pdf or svg file")
    command.add_argument("--style", metavar="NAME", help="of the picture: a style of matplotlib, or a file of one")
    command.add_argument("--size", type=values.numbers(2), metavar="W,H", help="of the picture, in inches")


def columns(panels: int, width: float, narrowest: float = NARROWEST) -> int:
    """How many panels stand side by side in a picture of so many inches, in rows that are as equal as they can be."""
    fitting = max(1, min(panels, int(width / narrowest)))
    return math.ceil(panels / math.ceil(panels / fitting))


def entries(width: float, most: int) -> int:
    """How many entries of a legend stand side by side."""
    return max(1, min(most, int(width / LEGEND_ENTRY)))


def require(path: Path, look: Look = PLAIN) -> None:
    """Raise InputError, before any work is done, if no such picture can be drawn here."""
    if importlib.util.find_spec("matplotlib") is None:
        raise InputError(f"{path}: a plot needs matplotlib: install it with `pip install 'shootstab[plot]'`")
    if look.size is not None and not all(1.0 <= x <= LARGEST_INCHES for x in look.size):
        raise InputError(f"--size {look.size[0]:g},{look.size[1]:g}: allowed are 1 to {LARGEST_INCHES:g} inches")
    if look.style is not None:
        import matplotlib.style

        try:
            with matplotlib.style.context(look.style):
                pass  # it is read when it is entered
        except (OSError, ValueError) as error:
            raise InputError(f"--style {look.style}: no such style: allowed is a name or a file of matplotlib's") from error


def drawn(draw: Callable[[], Any], look: Look = PLAIN) -> Any:
    """The matplotlib Figure that `draw` makes, in this style and size."""
    import matplotlib.style

    with matplotlib.style.context([LETTERS, *([look.style] if look.style else [])]):
        figure = draw()
    if look.size is not None:
        figure.set_size_inches(*look.size)
    return figure


def save(draw: Callable[[], Any], path: Path, look: Look = PLAIN) -> None:
    """The picture as a file, of the kind that its suffix tells. Raises OutputError.

    The first one on a machine takes long: matplotlib lists the fonts that there are.
    """
    from shootstab.cli.terminal import progress

    with progress(f"drawing {path.name}"):
        import matplotlib

        figure = drawn(draw, look)
        with matplotlib.rc_context(LETTERS):
            write_whole(path, lambda file: figure.savefig(file, dpi=DOTS))
