"""HDF5 files are read in a process of their own: libhdf5 crashes on some broken files, and ends no more than that process."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
from typing import TYPE_CHECKING

from shootstab.io import hdf5
from shootstab.io.arrays import Wanted

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

SECONDS = 20.0  # chosen: seconds to wait; 64 MB of sound file take one
REFUSED = 3  # chosen: the exit status with a sentence on standard output


def from_hdf5(data: bytes, wanted: Wanted, largest: int) -> NDArray[np.complex128]:
    """The eigenvalues (m,) as in hdf5.from_hdf5. Raises ValueError, for a file on which the library crashes or does not end as well."""
    import numpy as np

    question = json.dumps([wanted.dataset, wanted.row, largest])
    places = {**os.environ, "PYTHONPATH": os.pathsep.join(place for place in sys.path if place)}
    command = [sys.executable, "-P", "-m", __name__, question]
    try:
        done = subprocess.run(command, input=data, capture_output=True, env=places, timeout=SECONDS, check=False)
    except subprocess.TimeoutExpired:
        raise ValueError(f"HDF5 file: its reading did not end within {SECONDS:g} s: allowed is a file that h5dump can read") from None
    if done.returncode == REFUSED:
        raise ValueError(done.stdout.decode())
    if done.returncode != 0:
        raise ValueError("broken HDF5 file, on which the library that reads it crashes: allowed is a file that h5dump can read")
    return np.load(io.BytesIO(done.stdout), allow_pickle=False)  # type: ignore[no-any-return]


def _answer() -> int:
    import numpy as np

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
