"""The balloon of figure 2: what a raw QZ spectrum says at three truncations, and which of it is true."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

import numpy as np
from claims import Case, Claim, main
from numpy.typing import NDArray
from scenes import problem

import shootstab as st
from shootstab.models.chute import chute_collocation as chute

LARGEST = 3.0  # chosen: |σ| of the eigenvalues that are judged: the balloon, and all that a figure of it shows
DIGITS = 5  # chosen
HOLDS = st.Rectangle(-2.0 - 0.9j, 0.05 + 0.9j)  # chosen: the continuous spectrum and the balloon lie in it
RESOLUTIONS = (100, 160)  # chosen: two filtered pseudospectral runs that must agree on a mode
AGREE = 1e-6  # chosen


def true_modes() -> tuple[list[complex], list[complex]]:
    """The modes in the region by counting, without a guess, and those of them on which two filtered resolutions agree."""
    p = problem("fig2")
    found = [complex(m.sigma) for m in st.find(p, HOLDS).modes]
    one, other = (chute.spectrum(p.flow, p.kx, p.ky, M).eigenvalues for M in RESOLUTIONS)
    agreed = [complex(z) for z in one if HOLDS.contains(complex(z)) and np.abs(other - z).min(initial=np.inf) < AGREE * abs(z)]
    return found, agreed


def cases(quick: bool) -> Iterator[Case]:
    """Modes by two ways first; then every raw eigenvalue gets the verdict that they imply."""
    found, agreed = true_modes()
    lost = [z for z in agreed if min(abs(z - f) for f in found) > AGREE * abs(z)]
    note = f"{len(agreed)} by filter, {len(found)} by counting"
    yield Case(
        "modes that two filtered resolutions share", "all counted", "all counted" if not lost else f"{len(lost)} not counted", 0.0, note
    )
    for M in (60,) if quick else (60, 100, 200):
        yield from judged(M, np.array(found))


def judged(M: int, modes: NDArray[np.complex128]) -> Iterator[Case]:
    """The raw spectrum at one truncation."""
    p = problem("fig2")
    raw = chute.spectrum(p.flow, p.kx, p.ky, M, filtered=False).raw
    raw = raw[np.isfinite(raw) & (np.abs(raw) < LARGEST)]
    inside = np.array([HOLDS.contains(complex(z)) for z in raw])
    report = st.verify(p, raw, digits=DIGITS, region=st.Rectangle(1 + 1j, 2 + 2j))
    off = np.abs(raw[:, None] - modes).min(axis=1) / np.abs(raw)
    counts = dict(Counter(v.verdict for v in report.verdicts))
    yield Case(f"M = {M}: verdicts", "", f"{len(raw)} eigenvalues", None, str(counts))
    for name, wanted, chosen in (
        ("next to a mode, to a tenth of the last digit", {"confirmed"}, inside & (off < 10.0**-DIGITS / 10)),
        ("within two digits of a mode, but not to all", {"inaccurate", "spurious"}, inside & (off > 2 * 10.0**-DIGITS) & (off < 3e-3)),
        ("the balloon: far from every mode", {"spurious", "continuum"}, inside & (off > 0.1)),
    ):
        said = Counter(v.verdict for v, c in zip(report.verdicts, chosen, strict=True) if c)
        repeats = sum("repeats" in v.why for v, c in zip(report.verdicts, chosen, strict=True) if c)
        bad = sum(n for verdict, n in said.items() if verdict not in wanted) - (repeats if "spurious" not in wanted else 0)
        total = sum(said.values())
        yield Case(f"M = {M}: {name}", f"{total} of {total}", f"{total - bad} of {total}", 0.0, str(dict(said)))
    wrong = [
        v
        for v in report.verdicts
        if v.verdict == "confirmed" and HOLDS.contains(v.claimed) and np.abs(modes - v.claimed).min() > 1e-4 * abs(v.claimed)
    ]
    yield Case(f"M = {M}: confirmed wrongly", "none", "none" if not wrong else str(len(wrong)), 0.0)
    # `continuum` is said at the ends of the curve only
    ends = p.continuum(np.array([0.0 + 0j, p.flow.height(1e-14) + 0j]))
    away = [v for v in report.verdicts if v.verdict == "continuum" and np.abs(ends - v.claimed).min() > 10.0**-DIGITS * abs(v.claimed) * 10]
    yield Case(f"M = {M}: continuum, but not at an end", "none", "none" if not away else str(len(away)), 0.0)


CLAIM = Claim(
    f"Of the raw QZ eigenvalues of fig2 with |sigma| < {LARGEST:g} the modes are confirmed, and of the balloon none is.",
    "Woodhouse & Hogg 2010, figure 2; the modes are those that `find` counts, and on which two filtered resolutions agree",
    cases,
)

if __name__ == "__main__":
    main(CLAIM)
