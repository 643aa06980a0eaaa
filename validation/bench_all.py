"""Every row of what a user waits for, in one run: modes, verdicts, command line, digits, a map, growth, one σ of many, and figure 8.

    python validation/bench_all.py              # some twelve minutes alone on two cores
    python validation/bench_all.py --figure8    # figure 8 besides, seven minutes more

Each part is a process of its own and runs alone, so that none finds what another has kept. With --write the tables of those that write
one go into README.md. Exit status 1 if a row falls short.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from time import perf_counter

from bench import duration

HERE = Path(__file__).parent
WRITES = {"bench_user.py", "integrators.py"}
PARTS = (["bench_user.py"], ["bench_sweeps.py", "--map"], ["bench_growth.py"], ["integrators.py"])


def main() -> int:
    """The parts in order, each with the seconds that it took."""
    wanted, write = sys.argv[1:], "--write" in sys.argv[1:]
    short = 0
    for part in (*PARTS, *([["figure8.py"]] if "--figure8" in wanted else [])):
        words = [sys.executable, str(HERE / part[0]), *part[1:], *(["--write"] if write and part[0] in WRITES else [])]
        began = perf_counter()
        status = subprocess.run(words, check=False).returncode
        print(
            f"{' '.join(part)}: {duration(perf_counter() - began)}{'' if status == 0 else ', a row falls short'}",
            file=sys.stderr,
            flush=True,
        )
        short |= status != 0
    return int(short)


if __name__ == "__main__":
    sys.exit(main())
