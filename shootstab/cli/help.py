"""What `--help` says besides the options, what `shootstab` alone says, and the nearest word to one that is not allowed."""

from __future__ import annotations

import re
from collections.abc import Iterable

from shootstab.io.notation import nearest

STATUSES = """exit status: 0 no bad news; 1 bad news (an eigenvalue is inaccurate, spurious
or unresolved, a mode is missing, nothing converged); 2 bad input; 3 an error
of the program; 4 an answer that could not be written"""

EXAMPLES = {
    "verify": "shootstab verify low modes.csv --digits 6",
    "refine": "shootstab refine low --guess 0.0073,-0.0119 --digits 30",
    "mode": "shootstab mode low --guess 0.0073,-0.0119 --plot mode.pdf",
    "count": "shootstab count high --region rectangle --corners=1e-4,-0.1,0.05,0.1",
    "find": "shootstab find high --corners=1e-4,-0.1,0.05,0.1",
    "steady": "shootstab steady mid",
    "spectrum": "shootstab spectrum low -M 80",
    "sweep": "shootstab sweep high --kx 5e-4 --ky 0:0.03:31 --plot curve.png",
    "trade": "shootstab trade high --plot trade.png",
    "prove": "shootstab prove poiseuille --guess 0.0037,-0.2375 --certificate c.json",
    "check": "shootstab check c.json",
    "baseline": "shootstab baseline record low low.toml --guess 0.0073,-0.0119",
    "scenes": "shootstab scenes",
    "guide": "shootstab guide verdicts",
    "explain": "shootstab explain scene.toml",
    "critical": "shootstab critical scene.toml --parameter Ra=640 --over a=2.3 --guess 0",
}

DOORS = """shootstab: an independent second opinion on eigenvalues of linear stability
problems

a spectrum to check            shootstab verify low modes.csv
one mode, with its error bar   shootstab refine low --guess 0.0073,-0.0119
how many modes, and where      shootstab count high --region half-plane

`shootstab scenes` lists what is built in, `shootstab guide` is the manual;
`shootstab --help` and `shootstab COMMAND --help` name all there is."""


def epilog(command: str) -> str:
    """An example of the command, and the exit statuses."""
    example = f"example: {EXAMPLES[command]}\n\n" if command in EXAMPLES else ""
    return example + STATUSES


def with_nearest(message: str, options: Iterable[str]) -> str:
    """argparse's message about a word that is not allowed, with the nearest that is."""
    if found := re.search(r"invalid choice: '([^']*)' \(choose from (.*)\)", message):
        return message + nearest(found[1], re.findall(r"[\w-]+", found[2]))
    if found := re.search(r"unrecognized arguments: (--[\w-]+)", message):
        return message + nearest(found[1], (option for option in options if option != found[1]))
    return message
