"""`shootstab trade` for the four built-in scenes of the chute: tables, JSON and the pictures of the claims."""

from __future__ import annotations

import sys
from pathlib import Path

from shootstab.cli import main as cli

SCENES = ("high", "mid", "low", "fig2")
FIGURES = Path(__file__).parent / "figures"


def main() -> int:
    """One scene after the other, in this process: everything is compiled once."""
    return max(cli.main(["trade", name, "--plot", str(FIGURES / f"trade-{name}.png")]) for name in SCENES)


if __name__ == "__main__":
    sys.exit(main())
