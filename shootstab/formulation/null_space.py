"""The solutions that conditions leave, in any arithmetic."""

from __future__ import annotations

from shootstab.multiprecision import small_matrices as matrices
from shootstab.multiprecision.arithmetic import Arithmetic, Matrix


def null_space(arithmetic: Arithmetic, rows: Matrix, n: int) -> Matrix:
    """A basis (n, n − m) of the solutions of independent rows (m, n), by elimination with the largest pivots."""
    work, pivots = [list(row) for row in rows], []
    for r in range(len(work)):
        i, j = max(
            ((i, j) for i in range(r, len(work)) for j in range(n) if j not in pivots), key=lambda at: arithmetic.log2(work[at[0]][at[1]])
        )
        work[r], work[i] = work[i], work[r]
        work[r] = [x / work[r][j] for x in work[r]]
        pivots.append(j)
        for other in range(len(work)):
            if other != r and not matrices.vanishes(work[other][j]):
                factor = work[other][j]
                work[other] = [x - factor * y for x, y in zip(work[other], work[r], strict=True)]
    free = [j for j in range(n) if j not in pivots]
    basis = [[arithmetic.number(int(i == j)) for j in free] for i in range(n)]
    for r, pivot in enumerate(pivots):
        basis[pivot] = [arithmetic.rounded(-work[r][j]) for j in free]
    return basis
