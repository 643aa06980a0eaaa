"""Planted faults: shifted, invented, doubled and foreign eigenvalues, and a mode left out; each gets the verdict that it deserves."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from augmented import Augmented
from claims import Case, Claim, main
from scenes import problem

import shootstab as st
from shootstab.analyses.reference import claims
from shootstab.analyses.verdicts import radius_of
from shootstab.core.records import Report
from shootstab.models.chute import ChuteProblem
from shootstab.models.gallery.poiseuille import PlanePoiseuille
from shootstab.problems.protocol import Problem

DIGITS = 7  # chosen
DOUBLE_DIGITS = 5  # chosen
TRUNCATION = 100  # chosen
SHIFTS = (1e-3, 1e-6, 1e-9)  # chosen


def random_scenes(count: int) -> Iterator[tuple[str, ChuteProblem]]:
    """Scenes drawn at random: all grains for which a flow exists, and waves with K T_∞ from 0.01 to 0.1."""
    rng = np.random.default_rng(2010)
    made = 0
    while made < count:
        e, e_w, r, slope = rng.uniform(0.7, 0.95), rng.uniform(0.6, 0.95), rng.uniform(0.4, 0.8), rng.uniform(0.2, 0.35)
        temperature, angle = math.exp(rng.uniform(math.log(0.3), math.log(20.0))), rng.uniform(0.0, math.pi / 2)
        K = math.exp(rng.uniform(math.log(0.01), math.log(0.1))) / temperature
        try:
            flow = st.chute.steady(
                e=round(e, 3), e_w=round(e_w, 3), r=round(r, 3), tan_theta=round(slope, 3), far_temperature=round(temperature, 3)
            )
        except st.NoFlowError:
            continue
        p = st.chute.problem(flow, K * math.cos(angle), K * math.sin(angle))
        if len(claims(p, 9, TRUNCATION)) > 0:  # else the reference offers no mode to plant faults on
            made += 1
            yield f"random {made}", p


def plant(name: str, p: ChuteProblem, foreign: list[complex]) -> Iterator[Case]:
    """The faults of one scene."""
    modes = [complex(st.refine(p, guess=z, rtol=1e-11).sigma) for z in claims(p, 9, TRUNCATION)[:3]]
    nothing = st.Rectangle(10 + 10j, 11 + 11j)
    for shift in SHIFTS:
        shifted = [m * (1 + shift) for m in modes]
        want = ["confirmed" if abs(m) * shift < radius_of(s, DIGITS) else "inaccurate" for m, s in zip(modes, shifted, strict=True)]
        yield _case(f"{name}: shifted by {shift:.0e}", want, st.verify(p, shifted, digits=DIGITS, region=nothing))
    # invented: far from every mode, in a place that holds none within two digits
    invented = [z for z in (modes[0] * (1.5 + 0.4j), modes[0] * (0.5 - 0.6j)) if st.count(p, st.Disc(z, radius_of(z, 2))) == 0]
    yield _case(f"{name}: invented", ["spurious"] * len(invented), st.verify(p, invented, digits=DIGITS, region=nothing))
    twice = st.verify(p, [modes[0], modes[0] * (1 + 1e-10)], digits=DIGITS, region=nothing)
    yield _case(f"{name}: claimed twice", ["confirmed", "spurious"], twice)
    strangers = [z for z in foreign if all(abs(z - m) > 0.1 * abs(z) for m in modes) and st.count(p, st.Disc(z, radius_of(z, 2))) == 0]
    if strangers:
        yield _case(f"{name}: of another scene", ["spurious"] * len(strangers), st.verify(p, strangers, digits=DIGITS, region=nothing))
    lost, kept = modes[0], modes[1:]
    box = st.Rectangle(lost - 0.05 * abs(lost) * (1 + 1j), lost + 0.05 * abs(lost) * (1.1 + 1.2j))
    report = st.verify(p, kept, digits=DIGITS, region=box)
    found = any(abs(m.sigma - lost) < 1e-9 * abs(lost) for m in report.missing)
    yield Case(f"{name}: left out", "missing", "missing" if found else "not noticed", 0.0)


def plant_double(name: str, p: Problem, sigma: complex) -> Iterator[Case]:
    """A double eigenvalue is one mode that answers two claims and no third; shifted it is inaccurate; claimed once it is missing."""
    nothing = st.Rectangle(10 + 10j, 11 + 11j)
    claimed = [sigma, sigma * (1 + 1e-8), sigma * (1 + 2e-8), sigma * (1 + 1e-3)]
    report = st.verify(p, claimed, digits=DOUBLE_DIGITS, region=nothing)
    yield _case(f"{name}: claimed three times, and shifted", ["confirmed", "confirmed", "spurious", "spurious"], report)
    yield Case(f"{name}: multiplicity", "2", str(report.verdicts[0].multiplicity), 0.0)
    yield _case(f"{name}: shifted alone", ["inaccurate"], st.verify(p, claimed[3:], digits=DOUBLE_DIGITS, region=nothing))
    around = st.Disc(sigma * (1 + 0.01j), 0.1 * abs(sigma))
    missing = st.verify(p, claimed[:1], digits=DOUBLE_DIGITS, region=around).missing
    yield Case(f"{name}: claimed once", "1 missing", f"{len(missing)} missing", 0.0)


def _case(name: str, want: list[str], report: Report) -> Case:
    return Case(name, " ".join(want), " ".join(v.verdict for v in report.verdicts), 0.0)


def cases(quick: bool) -> Iterator[Case]:
    """The four built-in scenes, and scenes drawn at random."""
    foreign = [0.0039705046389 + 0j, 0.0072755835 - 0.0118650474j]
    for name in ("high", "low") if quick else ("high", "mid", "low", "fig2"):
        yield from plant(
            name, problem(name), [z for z in foreign if name not in ("high", "low") or z.imag == (0.0 if name == "low" else -0.0118650474)]
        )
    for name, p in random_scenes(1 if quick else 8):
        yield from plant(name, p, foreign)
    channel = PlanePoiseuille(reynolds=500.0)
    sigma = complex(st.refine(channel, -0.0705 - 0.3806j, rtol=1e-12).sigma)
    yield from plant_double("two channels", Augmented(channel), sigma)
    yield from plant_double("a channel driven by another", Augmented(channel, drive=1.0), sigma)
    if not quick:
        for name, sigma in zip(("high", "low"), foreign, strict=True):
            yield from plant_double(f"{name}, two flows", Augmented(problem(name)), sigma)


CLAIM = Claim(
    f"Planted faults get the verdict that they deserve, to {DIGITS} digits: a shift within the circle is confirmed, beyond it inaccurate.",
    "eigenvalues of this program, changed on purpose",
    cases,
)

if __name__ == "__main__":
    main(CLAIM)
