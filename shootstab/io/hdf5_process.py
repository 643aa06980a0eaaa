"""HDF5 files are read in a process of their own: libhdf5 crashes on some broken files, and ends no more than that process."""

from __future__ import annotations

import io
import json
import os
import signal
import subprocess
import sys
from contextlib import suppress
from typing import TYPE_CHECKING

from shootstab.io import hdf5
from shootstab.io.arrays import Wanted

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

SECONDS = 20  # chosen: seconds of processor time; 64 MB of sound file take one
REFUSED = 3  # chosen: the exit status with a sentence on standard output


def from_hdf5(data: bytes, wanted: Wanted, largest: int) -> NDArray[np.complex128]:
    """The eigenvalues (m,) as in hdf5.from_hdf5. Raises ValueError, for a file on which the library crashes or does not end as well."""
    import numpy as np

    question = json.dumps([wanted.dataset, wanted.row, largest])
    places = {**os.environ, "PYTHONPATH": os.pathsep.join(place for place in sys.path if place)}
    command = [sys.executable, "-P", "-m", __name__, question, str(SECONDS)]
    done = subprocess.run(command, input=data, capture_output=True, env=places, check=False)
    if done.returncode == -getattr(signal, "SIGXCPU", 0) != 0:
        raise ValueError(f"HDF5 file: reading it takes more than {SECONDS} s of processor time: allowed is a file that h5dump can read")
    if done.returncode == REFUSED:
        raise ValueError(done.stdout.decode())
    if done.returncode > 0:  # an exception of Python: no memory for the libraries, say
        *_, why = done.stderr.decode(errors="replace").strip().splitlines() or ["no reason is told"]
        raise ValueError(f"HDF5 file, which the process that reads it could not read: {why}")
    if done.returncode != 0:
        raise ValueError("broken HDF5 file, on which the library that reads it crashes: allowed is a file that h5dump can read")
    return np.load(io.BytesIO(done.stdout), allow_pickle=False)  # type: ignore[no-any-return]


def _answer() -> int:
    import numpy as np

    with suppress(ModuleNotFoundError):  # Windows has no such limits
        import resource

        # a machine that does other things too makes no file unreadable: what is limited is the processor time, beyond which comes SIGXCPU
        allowed, (_, most) = int(sys.argv[2]), resource.getrlimit(resource.RLIMIT_CPU)
        resource.setrlimit(resource.RLIMIT_CPU, (allowed if most == resource.RLIM_INFINITY else min(allowed, most), most))
    dataset, row, largest = json.loads(sys.argv[1])
    try:
        values = hdf5.from_hdf5(sys.stdin.buffer.read(), Wanted(dataset, row), largest)
    except ValueError as error:
        sys.stdout.buffer.write(str(error).encode())
        return REFUSED
    np.save(sys.stdout.buffer, values)
    return 0


if __name__ == "__main__":
    raise SystemExit(_answer())
