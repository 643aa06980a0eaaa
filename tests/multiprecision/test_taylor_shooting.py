"""Many digits: identities of the parts, an independent series, published digits, double precision, and one arithmetic against the other."""

from __future__ import annotations

import json
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from mpmath import mpc, mpf
from scipy.optimize import minimize_scalar

import shootstab as st
from shootstab.analyses.refine_digits import as_far_off, refine_digits
from shootstab.cli import main as cli
from shootstab.io.notation import held_complex
from shootstab.models.chute import ChuteProblem
from shootstab.models.chute.multiprecision_flow import descend
from shootstab.models.chute.multiprecision_problem import ChuteDigits
from shootstab.models.gallery.poiseuille import PlanePoiseuille
from shootstab.multiprecision.arithmetic import Arithmetic, exact
from shootstab.multiprecision.backends import choose
from shootstab.multiprecision.linear_step import carried, subsystems
from shootstab.multiprecision.regular_singular_end import decaying_series
from shootstab.multiprecision.secant import Secant
from shootstab.multiprecision.settings import Settings
from shootstab.multiprecision.taylor import Taylor
from shootstab.multiprecision.taylor_shooting import TaylorShooting

# published.md: plane Poiseuille flow, Re = 10000, α = 1
POISEUILLE = "0.23752648882047010745", "0.0037396706229794099322"
GUESS = 0.0037 - 0.2375j
DOUBLE = {"high": (0.004, 0.0039705046388893), "low": (0.0073 - 0.0119j, 0.00727558354705290 - 0.0118650473818745j)}
GRAINS = {"e": 0.8, "e_w": 0.8, "r": 0.6, "tan_theta": 0.3}
TERMS = 24
DIGITS = 40

both = pytest.mark.parametrize("arithmetic", [choose("flint"), choose("mpmath")], ids=["flint", "mpmath"])


def nothing() -> None:
    """The end of a step, of which nobody hears."""


# the parts


def series(arithmetic: Arithmetic, re: Sequence[int], im: Sequence[int] = ()) -> Taylor:
    """A polynomial as a series."""
    re_im = (arithmetic.series([arithmetic.number(x) for x in (*c, *[0] * (TERMS - len(c)))]) if any(c) else None for c in (re, im))
    return Taylor(arithmetic, TERMS, *re_im)


def polynomial_solution(arithmetic: Arithmetic) -> tuple[list[list[Taylor]], list[list[Taylor]], list[list[Taylor]]]:
    """M(t), its inverse, and a C(t) that has nothing to do with it."""
    M = [[series(arithmetic, (2, 1)), series(arithmetic, (0, 0, 1))], [series(arithmetic, (), (0, 1)), series(arithmetic, (2,))]]
    det = M[0][0] * M[1][1] - M[0][1] * M[1][0]
    inverse = [[M[1][1] / det, -M[0][1] / det], [-M[1][0] / det, M[0][0] / det]]
    C = [
        [series(arithmetic, (1, 1)), series(arithmetic, (0, 2))],
        [series(arithmetic, (), (0, 0, 3)), series(arithmetic, (3, 0, 1), (0, 1))],
    ]
    return M, inverse, C


def product(A: Any, B: Any) -> Any:
    return [[sum(A[i][j] * B[j][k] for j in range(1, 2)) + A[i][0] * B[0][k] for k in range(2)] for i in range(2)]


def entries(A: list[list[Taylor]], at: tuple[int, int] = (0, 1)) -> dict[tuple[int, int], Taylor]:
    return {(at[i], at[j]): A[i][j] for i in range(2) for j in range(2)}


@both
def test_a_step_reproduces_a_polynomial_solution(arithmetic: Arithmetic) -> None:
    """ψ = M(t) M(0)⁻¹ Y solves C ψ′ = (C M′ M⁻¹) ψ whatever C is; beside it, in a part of its own, (1 + t/4) χ′ = χ/2."""
    with arithmetic.working(DIGITS), mpmath.workdps(DIGITS):
        M, inverse, C = polynomial_solution(arithmetic)
        D = product(product(C, [[m.derivative(0) for m in row] for row in M]), inverse)
        one, zero = arithmetic.number(1), arithmetic.number(0)
        beside = {(2, 2): series(arithmetic, (4, 1))}, {(2, 2): series(arithmetic, (2,))}
        Y = [[one, zero, zero], [zero, one, zero], [zero, zero, one]]
        found = subsystems(3, {**entries(C), **beside[0]}, {**entries(D), **beside[1]})
        assert sorted(found) == [([0, 1], [0, 1]), ([2], [2])]
        at, last = carried(arithmetic, 3, {**entries(C), **beside[0]}, {**entries(D), **beside[1]}, Y, TERMS)
        end = at(1.0)
        expected = [[mpf(3) / 2, mpf(1) / 2], [mpc(0, 0.5), mpf(1)]]
        for i in range(2):
            for q in range(2):
                assert abs(arithmetic.to_mpmath(end[i][q]) - expected[i][q]) < mpf(10) ** -(DIGITS - 3)
        assert abs(arithmetic.to_mpmath(end[2][2]) - mpf(25) / 16) < mpf(10) ** -(DIGITS - 3)
        assert max(arithmetic.log2(x) for term in last for row in term[:2] for x in row) < -(DIGITS - 4) * 3.3


@both
def test_the_decaying_space_reproduces_a_polynomial_one_with_a_defective_exponent(arithmetic: Arithmetic) -> None:
    """ψ = M(x) x^Λ, Λ = λ + N with N² = 0, solves C x ψ′ = C (x M′ + M Λ) M⁻¹ ψ."""
    with arithmetic.working(DIGITS), mpmath.workdps(DIGITS):
        M, inverse, C = polynomial_solution(arithmetic)
        rate, zero, one = arithmetic.number(Fraction(3, 10)), arithmetic.number(0), arithmetic.number(1)
        N = [[zero, one], [zero, zero]]
        ML = [[rate * row[0], rate * row[1] + row[0]] for row in M]
        D = product(product(C, [[m.derivative(1) + n for m, n in zip(x, y, strict=True)] for x, y in zip(M, ML, strict=True)]), inverse)
        P0 = [[m.coefficients(1)[0] for m in row] for row in M]
        found = decaying_series(arithmetic, entries(C), entries(D), P0, rate, N, TERMS)
        for m, term in enumerate(found):
            for i in range(2):
                for q in range(2):
                    assert abs(arithmetic.to_mpmath(term[i][q]) - arithmetic.to_mpmath(M[i][q].coefficients(TERMS)[m])) < mpf(10) ** -(
                        DIGITS - 6
                    )


@pytest.mark.parametrize("digits", [(15,), (12, 25, 60), (20, 45, 100)])
def test_secants_climb_and_know_their_error(digits: tuple[int, ...]) -> None:
    calls = []
    with mpmath.workdps(200):
        secant = Secant(mpf(2) ** 0.5 * (1 + mpf(10) ** -10))
        for d in digits:

            def functions(x: Any, d: int = d) -> tuple[Any, ...]:
                calls.append(x)
                return x * x - 2 + mpf(10) ** -(d + 2), x**3

            secant.settle(functions, d)
            off = abs(secant.x - mpmath.sqrt(2 - mpf(10) ** -(d + 2)))
            assert off <= 2 * secant.error
            assert off <= mpf(10) ** -d
            assert abs(secant.others[0] - secant.x**3) <= mpf(10) ** -d * 10
    assert len(calls) <= 3 * len(digits)


def test_secants_do_not_settle_on_a_double_zero() -> None:
    with mpmath.workdps(60), pytest.raises(st.ConvergenceError, match="settle"):
        Secant(mpf("1.00001")).settle(lambda x: ((x - 1) ** 2,), 40)


def test_a_base_flow_is_off_by_the_sum_of_what_was_found() -> None:
    base = mpf(2), mpf(10)
    moved = as_far_off(base, [(mpf(2), mpf("10.01")), (mpf("2.004"), mpf("10.01")), (mpf(2), mpf("10.04"))])
    assert [float(x) for x in moved] == pytest.approx([2.0, 10.0 + 0.03 * 0.006 / 0.003])
    assert as_far_off(base, [base, base]) == base
    assert as_far_off((), [(), ()]) == ()


def test_parameters_mean_the_decimals_that_were_typed() -> None:
    assert exact(0.8) == Fraction(8, 10)
    assert exact(5e-4) == Fraction(5, 10000)


def test_the_steady_flow_carries_the_exact_mass_flux(scenes: dict[str, ChuteProblem]) -> None:
    """With another order, step and far field than those it was found with; and it is the flow that doubles know."""
    flow, arithmetic = scenes["mid"].flow, choose()
    problem_in_digits, settings = ChuteDigits(scenes["mid"]), Settings.of(25)
    better = settings.finer().farther()
    with arithmetic.working(better.digits), mpmath.workdps(better.digits):
        T, u = problem_in_digits.base(arithmetic, settings, nothing)
        base = descend(arithmetic, problem_in_digits.chute(arithmetic), arithmetic.number(T), better, flow, nothing)
        assert abs(arithmetic.to_mpmath(base.mass_flux) - 3) < mpf(10) ** -23
        assert abs(arithmetic.to_mpmath(base.far_velocity) / u - 1) < mpf(10) ** -23
        nu, temperature = (float(arithmetic.to_mpmath(x)) for x in base.state[:2])
    assert float(T) == pytest.approx(flow.far_temperature, rel=1e-12)
    assert float(u) == pytest.approx(flow.far_velocity, rel=1e-12)
    assert (nu, temperature) == pytest.approx((flow.base["nu"], flow.base["T"]), rel=1e-11)


def test_the_two_arithmetics_form_the_same_discriminant(scenes: dict[str, ChuteProblem]) -> None:
    settings = Settings.of(14)
    values = []
    for name in ("flint", "mpmath"):
        arithmetic, problem_in_digits = choose(name), ChuteDigits(scenes["high"])
        with arithmetic.working(settings.digits), mpmath.workdps(settings.digits):
            integration = problem_in_digits.integration(arithmetic, settings, problem_in_digits.base(arithmetic, settings, nothing))
            D = TaylorShooting(arithmetic, problem_in_digits.size, settings, integration, nothing)
            values.append([arithmetic.to_mpmath(D(arithmetic.number(Fraction(k, 1000)))) for k in (3, 5)])
    for one, other in zip(*values, strict=True):
        assert abs(one / other - 1) < 1e-13


# modes


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


@pytest.fixture(scope="module")
def poiseuille() -> mpc:
    """σ to more than a hundred digits by that series, whose sums cancel to some thirty digits fewer than it is computed with."""
    with mpmath.workdps(150):
        near = mpc(POISEUILLE[1], "-" + POISEUILLE[0])
        return mpmath.findroot(orr_sommerfeld_even, (near, near * (1 + mpf(10) ** -21)), tol=1e-250, verify=False)


@pytest.mark.parametrize("digits", [40, 90])
def test_poiseuille(poiseuille: mpc, digits: int) -> None:
    mode = st.refine(PlanePoiseuille(), guess=GUESS, digits=digits)
    assert mode.converged
    with mpmath.workdps(130):
        assert mode.error <= mpf(10) ** -digits * abs(mode.sigma)
        assert abs(poiseuille - mode.sigma) <= mode.error
        assert abs(mpc(POISEUILLE[1], "-" + POISEUILLE[0]) - mode.sigma) < mpf(10) ** -20


@pytest.mark.parametrize("name", list(DOUBLE))
def test_the_first_digits_are_those_of_double_precision(scenes: dict[str, ChuteProblem], name: str) -> None:
    guess, known = DOUBLE[name]
    mode = st.refine(scenes[name], guess=guess, digits=20)
    rough = st.refine(scenes[name], guess=guess, rtol=1e-11)
    assert mode.converged
    assert mode.digits >= 20
    assert abs(complex(mode.sigma) - rough.sigma) <= rough.error
    assert abs(complex(mode.sigma) - known) < 1e-15
    assert all(part > 0 for part in mode.budget.as_dict().values())


def test_a_flow_given_by_its_far_temperature_has_an_exact_one() -> None:
    flow = st.chute.steady(far_temperature=0.7, **GRAINS)
    problem = st.chute.problem(flow, 0.01, 0.0)
    rough = st.refine(problem, guess=4.09e-5 - 0.03244j, rtol=1e-11)
    mode = st.refine(problem, guess=rough.sigma, digits=14)
    assert rough.converged
    assert mode.converged
    assert abs(complex(mode.sigma) - rough.sigma) <= rough.error


def test_two_runs_agree_on_every_digit_that_the_bound_promises(scenes: dict[str, ChuteProblem]) -> None:
    """Different digits asked for means another precision, order, step and start."""
    fewer, more = (refine_digits(scenes["high"], 0.004, digits) for digits in (14, 24))
    with mpmath.workdps(40):
        assert abs(fewer.sigma - more.sigma) <= fewer.error + more.error
        assert abs(mpf(held_complex(fewer.sigma, fewer.error)) - more.sigma) < mpf(10) ** -16


def test_the_two_arithmetics_agree() -> None:
    flint, plain = (refine_digits(PlanePoiseuille(), GUESS, 25, arithmetic=name) for name in ("flint", "mpmath"))
    with mpmath.workdps(40):
        assert abs(flint.sigma - plain.sigma) <= flint.error + plain.error
    assert min(flint.digits, plain.digits) >= 25


class Rod:
    """T″ = σ T, insulated at z = 0 and cooled at z = 1, T′ + 0.3 T = 0: σ = −x² with x tan x = 3/10."""

    size, decaying = 2, 1

    def exact_ends(self, exact: Any) -> tuple[Any, Any]:
        return 0, 1

    def exact_pencil(self, z: Any, exact: Any) -> tuple[dict[tuple[int, int], Any], ...]:
        return {(0, 0): 1, (1, 1): 1}, {}, {(0, 1): 1}, {(1, 0): 1}

    def exact_far(self, sigma: Any, exact: Any) -> list[list[Any]]:
        return [[1], [0]]

    def exact_wall(self, exact: Any) -> tuple[list[list[Any]], list[list[Any]]]:
        return [[exact(0.3), 1]], [[0, 0]]


@pytest.mark.parametrize("arithmetic", ["flint", "mpmath"])
def test_a_problem_of_the_users_own_has_any_number_of_digits(arithmetic: str) -> None:
    mode = refine_digits(st.ClosedProblem(Rod()), -0.28, 60, arithmetic=arithmetic)
    assert mode.converged
    with mpmath.workdps(90):
        x = mpmath.findroot(lambda x: x * mpmath.tan(x) - mpf(3) / 10, 0.53)
        assert abs(mode.sigma + x * x) <= mode.error <= mpf(10) ** -60


def test_a_closed_form_is_the_problem_it_stands_for() -> None:
    """PlanePoiseuille writes both down by hand."""
    by_hand, closed = PlanePoiseuille(), st.ClosedProblem(PlanePoiseuille())
    z = np.linspace(0.0, 1.0, 5) + 0.1j
    for one, other in zip(vars(by_hand.pencil(z)).values(), vars(closed.pencil(z)).values(), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-15)
    one, other = (st.refine(p, guess=GUESS, rtol=1e-10) for p in (by_hand, closed))
    assert abs(one.sigma - other.sigma) <= one.error + other.error


def test_progress_rises_to_the_end_and_says_how_long_it_takes() -> None:
    told: list[tuple[int, int, float]] = []
    refine_digits(PlanePoiseuille(), GUESS, 20, progress=lambda *what: told.append(what))
    shares = [done / total for done, total, _ in told]
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1.0)
    assert all(left >= 0.0 for _, _, left in told)
    assert told[-1][2] == pytest.approx(0.0, abs=1e-6)


# the command line


def test_the_command_line_prints_the_digits_that_hold(poiseuille: mpc, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["refine", "poiseuille", "--guess=0.0037,-0.2375", "--digits", "50"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    lines = iter(out.splitlines())
    re = next(line for line in lines if line.startswith("σ")).split()[1]
    sign, im = next(lines).split()  # eighty columns hold no more than one of them
    assert sign == "-"
    with mpmath.workdps(80):
        printed = mpc(re, "-" + im.removesuffix("i"))
        assert abs(printed - poiseuille) < mpf(10) ** -50
        assert min(len(re), len(im)) >= 50
    assert cli.main(["refine", "poiseuille", "--guess=0.0037,-0.2375", "--digits", "50", "--json", "-"]) == 0
    answer = json.loads(capsys.readouterr().out)
    with mpmath.workdps(80):
        assert abs(mpc(answer["sigma"]["re"], answer["sigma"]["im"]) - poiseuille) <= answer["error"]


# reasons in place of digits


@pytest.mark.parametrize("guess", [3.0 + 5.0j, 0.5])
def test_no_mode_near_the_guess(scenes: dict[str, ChuteProblem], guess: complex) -> None:
    lost = st.refine(scenes["high"], guess=guess, digits=20)
    assert lost.status.startswith("not converged: ")
    assert "mode" in lost.status
    assert lost.digits == 0


def test_a_base_flow_at_a_fold() -> None:
    """Next to the least mass flux between the branches T_∞ hangs on it by a square root: d ln Q0/d ln T_∞ vanishes."""

    def flux(log_T: float) -> float:
        return st.chute.steady(far_temperature=float(np.exp(log_T)), **GRAINS).mass_flux

    least = minimize_scalar(flux, bounds=(1.3, 1.5), method="bounded", options={"xatol": 1e-7})
    flow = st.chute.steady(mass_flux=float(least.fun) * (1 + 1e-13), branch="mid", **GRAINS)
    mode = st.refine(st.chute.problem(flow, 0.0, 0.0125), guess=0.0032279, digits=20)
    assert "fold" in mode.status
    assert "d ln Q0/d ln T" in mode.status
    assert mode.digits == 0


def test_without_python_flint_mpmath_does_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert choose().name == "mpmath"
    with pytest.raises(st.InputError, match="pip install"):
        choose("flint")


def test_a_problem_without_formulas_is_refused(scenes: dict[str, ChuteProblem]) -> None:
    class Plain:
        """Everything of a problem but what offers many digits."""

        def __getattr__(self, name: str) -> Any:
            if name in ("multiprecision", "closed_form"):
                raise AttributeError(name)
            return getattr(scenes["high"], name)

    with pytest.raises(
        st.InputError, match=r"more than 12 digits ask for a problem in closed form: exact_ends.*Plain has no `closed_form`"
    ):
        refine_digits(Plain(), 0.004, 20)  # type: ignore[arg-type]


def test_what_cannot_be_done_is_refused(scenes: dict[str, ChuteProblem]) -> None:
    with pytest.raises(st.InputError, match="Taylor"):
        st.refine(scenes["high"], guess=0.004, digits=20, method=st.Frame())
    with pytest.raises(st.InputError, match="allowed is flint or mpmath"):
        refine_digits(scenes["high"], 0.004, 20, arithmetic="quad")
