"""python -m shootstab: the command line."""

from __future__ import annotations

import sys

from shootstab.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
