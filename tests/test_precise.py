"""Many digits: against an independent series, against published digits, against double precision, and one arithmetic against the other."""

from __future__ import annotations

import mpmath
import pytest
from mpmath import mpc, mpf

import shootstab as st
from shootstab.problems.chute import ChuteProblem
from shootstab.problems.gallery.poiseuille import PlanePoiseuille
from shootstab.questions.precise import refine_digits

# published.md: plane Poiseuille flow, Re = 10000, α = 1
POISEUILLE = "0.23752648882047010745", "0.0037396706229794099322"
GUESS = 0.0037 - 0.2375j
DOUBLE = {"high": (0.004, 0.0039705046388893), "low": (0.0073 - 0.0119j, 0.00727558354705290 - 0.0118650473818745j)}


def orr_sommerfeld_even(sigma: mpc) -> mpc:
    """The determinant of the two even solutions at the wall, each one power series about the centre; an entire function of y."""
    R, terms = mpf(10000), 900
    constant, square = 2 + R * sigma + 1j * R, -1 - R * sigma - 1j * R + 2j * R

    def at_wall(c0: int, c2: int) -> tuple[mpc, mpc]:
        c = [mpc(0)] * (terms + 5)
        c[0], c[2] = mpc(c0), mpc(c2)
        for n in range(0, terms, 2):
            right = constant * (n + 2) * (n + 1) * c[n + 2] + square * c[n] - 1j * R * n * (n - 1) * c[n]
            if n >= 2:
                right += 1j * R * c[n - 2]
            c[n + 4] = right / ((n + 4) * (n + 3) * (n + 2) * (n + 1))
        return mpmath.fsum(c), mpmath.fsum(n * c[n] for n in range(len(c)))

    f, g = at_wall(1, 0), at_wall(0, 1)
    return f[0] * g[1] - f[1] * g[0]


def test_poiseuille_to_forty_digits() -> None:
    mode = st.refine(PlanePoiseuille(), guess=GUESS, digits=40)
    assert mode.converged
    assert mode.error <= 1e-40 * abs(mode.sigma)
    with mpmath.workdps(130):
        truth = mpmath.findroot(orr_sommerfeld_even, (mpc(mode.sigma), mpc(mode.sigma) * (1 + mpf(10) ** -30)), tol=1e-150, verify=False)
        assert abs(truth - mode.sigma) <= mode.error
        published = mpc(POISEUILLE[1], "-" + POISEUILLE[0])
        assert abs(published - mode.sigma) < mpf(10) ** -20


@pytest.mark.parametrize("name", list(DOUBLE))
def test_the_first_digits_are_those_of_double_precision(scenes: dict[str, ChuteProblem], name: str) -> None:
    guess, known = DOUBLE[name]
    mode = st.refine(scenes[name], guess=guess, digits=20)
    rough = st.refine(scenes[name], guess=guess, rtol=1e-11)
    assert mode.converged
    assert mode.digits >= 20
    assert abs(complex(mode.sigma) - rough.sigma) <= rough.error
    assert abs(complex(mode.sigma) - known) < 1e-15
    assert set(mode.budget.as_dict()) == {"integration", "far_field", "steady_flow", "root", "rounding"}


def test_two_runs_agree_on_every_digit_that_the_bound_promises(scenes: dict[str, ChuteProblem]) -> None:
    """Different digits asked for means another precision, order, step and start."""
    fewer, more = (refine_digits(scenes["high"], 0.004, digits) for digits in (14, 24))
    with mpmath.workdps(40):
        assert abs(fewer.sigma - more.sigma) <= fewer.error + more.error


def test_the_two_arithmetics_agree() -> None:
    flint, plain = (refine_digits(PlanePoiseuille(), GUESS, 25, arithmetic=name) for name in ("flint", "mpmath"))
    with mpmath.workdps(40):
        assert abs(flint.sigma - plain.sigma) <= flint.error + plain.error
    assert min(flint.digits, plain.digits) >= 25


def test_progress_rises_to_the_end() -> None:
    told: list[tuple[int, int, float]] = []
    refine_digits(PlanePoiseuille(), GUESS, 20, progress=lambda *what: told.append(what))
    shares = [done / total for done, total, _ in told]
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1.0)


def test_reasons_in_place_of_digits(scenes: dict[str, ChuteProblem]) -> None:
    lost = st.refine(scenes["high"], guess=3.0 + 5.0j, digits=20)
    assert lost.converged or lost.status.startswith("not converged: ")
    with pytest.raises(st.InputError, match="Taylor"):
        st.refine(scenes["high"], guess=0.004, digits=20, method=st.Frame())
