"""The checker of granular chutes: its models and comparisons against the truth, its D against doubles, certificates and tampered ones."""

from __future__ import annotations

import copy
import json
import math
import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest

import shootstab as st
from shootstab.checkers import granular_chute as checker
from shootstab.checkers.granular_chute import Certified, Model, exact, grown, guessed, precision, verified
from shootstab.models.chute.certificate_settings import Asked, candidates
from shootstab.models.chute.chute_problem import ChuteProblem

TERMS, MANY = 12, 70
POWERS = (Fraction(-1), Fraction(1, 2), Fraction(-1, 2), Fraction(-31, 20), Fraction(5, 2))
# the mode of the flow with T_∞ = 7 at k_y = 0.01, within 1e-11
PROBLEM = "e=0.8 e_w=0.8 r=0.6 tan_theta=0.3 nu_max=0.62 kx=0.0 ky=0.01 far_temperature=7.0 radial=lun-savage wall=printed"
STEPS = "1.75 2.1 2.52 3.024 3.6288 4.35456 5.225472 4.702925 4.232632 3.809369 4.571243 4.114119 3.702707 3.332436 0.17625612906811847"
CERTIFICATE: dict[str, Any] = {
    "problem": dict(ENTRY.split("=") for ENTRY in PROBLEM.split()),
    "region": {"re": "0.00396464430899864", "im": "0.0", "radius": "1e-11"},
    "flow": {"far_temperature": ["7.0", "7.0"], "nu": ["0.04154489285980480919", "0.04154489285988789899"]},
    "lemmas": ["C2", "C3", "C5", "E5", "E6", "E7", "K1", "K2", "K3"],
    "steps": STEPS.split(),
    "format": 2,
    "count": 1,
    "bits": 109,
    "order": 51,
    "far_order": 51,
    "points": 6,
    "start": "6.103515625e-05",
    "slack": "1e-6",
    "outer": "2.4889268235145794e-08",
}
CERTIFICATE["problem"]["name"] = "granular chute"


def drawn(rng: np.random.Generator, real: bool, first: float) -> tuple[Model, list[Any]]:
    """A model, and the coefficients of a function of its set."""
    scale = first * 0.4 * rng.dirichlet(np.ones(TERMS)) * rng.choice([-1, 1], TERMS)
    numbers = [complex(x, 0.0 if real else 0.5 * y) for x, y in zip(scale, rng.permutation(scale), strict=True)]
    numbers[0] = complex(first, 0.0 if real else 0.3 * first)
    models = [exact(Fraction(x.real), Fraction(x.imag)) for x in numbers]
    radius = float(10.0 ** rng.uniform(-12, -2)) * first
    model = Model([x.re[0] for x in models], None if real else [x.im[0] if x.im else 0 for x in models], radius, TERMS)
    off = rng.standard_normal(3)
    off *= 0.999 * radius / np.abs(off).sum()
    truth = coefficients(model) + [mpmath.mpf(0)] * (MANY - TERMS)
    for place, x in zip(rng.choice(40, 3, replace=False), off, strict=True):
        truth[place] += mpmath.mpf(float(x))
    return model, truth


def coefficients(model: Model) -> list[Any]:
    unit = mpmath.mpf(2) ** -Model.P
    return [mpmath.mpc(x * unit, y * unit) for x, y in zip(model.re, model.im or [0] * len(model.re), strict=True)]


def times(a: list[Any], b: list[Any]) -> list[Any]:
    return [mpmath.fsum(a[j] * b[m - j] for j in range(m + 1)) for m in range(len(a))]


def powered(b: list[Any], s: Fraction) -> list[Any]:
    r = mpmath.mpf(s.numerator) / s.denominator
    c = [b[0] ** r]
    for m in range(1, len(b)):
        c.append(mpmath.fsum(((r + 1) * j / m - 1) * b[j] * c[m - j] for j in range(1, m + 1)) / b[0])
    return c


def misses(model: Model, truth: list[Any]) -> float:
    """‖truth − Σ c_m t^m‖ over the radius."""
    known = coefficients(model) + [0] * (len(truth) - len(model.re))
    return float(mpmath.fsum(abs(a - b) for a, b in zip(truth, known, strict=True)) / model.r)


@pytest.mark.parametrize("real", [True, False])
def test_products_sums_and_powers_hold_the_truth(real: bool) -> None:
    rng, ratios = np.random.default_rng(11 + real), []
    with precision(70), mpmath.workdps(50):
        for _ in range(5):
            (a, f), (b, g) = (drawn(rng, real, float(rng.uniform(0.2, 3.0))) for _ in range(2))
            ratios += [
                misses(a * b, times(f, g)),
                misses(a + b, [x + y for x, y in zip(f, g, strict=True)]),
                misses(a * Fraction(-7, 3), [x * -7 / 3 for x in f]),
            ]
            ratios += [misses(a**s, powered(f, s)) for s in (POWERS if real else POWERS[:1])]
            t = Fraction(int(rng.integers(0, 2**20)), 2**20)
            value = mpmath.polyval(f[::-1], mpmath.mpf(t.numerator) / t.denominator)
            ratios.append(misses(a.at(t), [value]))
            ratios.append(misses(a.cut(4), f))
    assert max(ratios) <= 1.0
    assert max(ratios) > 0.3  # a bound that is far above the truth would hold whatever the rule


def test_a_power_across_zero_or_the_cut_is_refused() -> None:
    with precision(70):
        for model in (exact(1) + Model([0, 1 << 71], None, 0.0, TERMS), exact(-1), exact(0), exact(1).wide(1.5)):
            with pytest.raises(checker.RefusedError):
                model ** Fraction(1, 2)


def test_the_exponential_of_a_matrix_is_bounded_closely() -> None:
    rng = np.random.default_rng(3)
    for size in (0.1, 3.0, 40.0):
        L, x = size * rng.random((5, 5)), rng.random(5)
        bound = np.array(grown(L.tolist(), x.tolist()))
        with mpmath.workdps(40):
            truth = np.array([float(y) for y in mpmath.expm(mpmath.matrix(L.tolist())) * mpmath.matrix(x.tolist())])
        assert (bound >= truth).all() and (bound < 1.0001 * truth).all()


def test_flows_next_to_a_guess_lie_in_its_radius_and_no_tube_is_left_unseen() -> None:
    """x′ = h x y, y′ = −h x² from a box: x² + y² = c², so that x = c/cosh(…), y = −c tanh(…)."""
    rng = np.random.default_rng(5)
    with precision(110), mpmath.workdps(60):
        for _ in range(6):
            h, x, y, off = Fraction(float(rng.uniform(0.05, 0.2))), float(rng.uniform(0.5, 1.5)), float(rng.uniform(-1, 1)), 1e-12

            def rates(state: list[Any], h: Fraction = h) -> list[Any]:
                return [state[0] * state[1] * h, -(state[0] * state[0] * h)]

            first = [exact(Fraction(x)).re[0], exact(Fraction(y)).re[0]]
            found = verified(rates, guessed(rates, first, 24), [off, off])
            for signs in ((0, 0), (1, -1), (-1, 1)):
                a, b = (mpmath.mpf(v) + s * mpmath.mpf(off) * 0.999 for v, s in zip((x, y), signs, strict=True))
                c = mpmath.sqrt(a * a + b * b)
                phase = c * mpmath.mpf(h.numerator) / h.denominator - mpmath.atanh(b / c)
                assert misses(found[0].at(Fraction(1)), [c / mpmath.cosh(phase)]) <= 1.0
                assert misses(found[1].at(Fraction(1)), [-c * mpmath.tanh(phase)]) <= 1.0
            assert max(model.r for model in found) < 4 * off
            with pytest.raises(checker.RefusedError):
                verified(rates, guessed(rates, first, 24), [1e-3, 1e-3])


@pytest.mark.parametrize("off", [0.0, 1e-9])
def test_solutions_at_a_singular_end_lie_in_their_radii(off: float) -> None:
    """ψ = (1 + x S) x^Λ solves x ψ′ = B ψ, B = (x S + (1 + x S) Λ)(1 + x S)⁻¹; of its first four columns Λ is ρ + Z."""
    rng, terms, rate = np.random.default_rng(21), 40, 0.07
    S, Z = 0.02 * rng.standard_normal((8, 8)), 0.01 * rng.standard_normal((4, 4))
    np.fill_diagonal(Z, 0.0)  # the sums below are exact then
    Lambda = np.diag([rate] * 4 + [-rate] * 4) + np.pad(Z, (0, 4))
    with precision(110), mpmath.workdps(40):
        wide = [mpmath.matrix(x.tolist()) for x in (S, Lambda)]
        powers = [mpmath.eye(8)]  # of −S
        for _ in range(terms):
            powers.append(-wide[0] * powers[-1])
        parts = [wide[1]] + [wide[1] * powers[m] + wide[0] * (mpmath.eye(8) + wide[1]) * powers[m - 1] for m in range(1, terms)]
        unit = mpmath.mpf(2) ** Model.P
        spread = rng.uniform(-1, 1, (8, 8)) * off  # the equations of the models need not be those in their middles
        B = [
            {j: Model([int(x[i, j] * unit) for x in parts], None, 1e-28 + off, terms) + Fraction(float(spread[i, j])) for j in range(8)}
            for i in range(8)
        ]
        first = [[exact(int(i == q)) for q in range(4)] for i in range(8)]
        ends = [[exact(Fraction(float(x))) for x in row] for row in Z]
        found = checker.regular(B, ends, exact(Fraction(rate)), first, terms)
        truth = mpmath.eye(8) + wide[0]
        assert max(misses(found[i][q], [truth[i, q]]) for i in range(8) for q in range(4)) <= 1.0
        assert max(x.r for row in found for x in row) < max(1e-24, 20 * off)
        with pytest.raises(checker.RefusedError):
            checker.regular([{j: x * 20 for j, x in row.items()} for row in B], ends, exact(Fraction(rate)), first, terms)


def test_intervals_of_mpmath_keep_their_digits() -> None:
    """A number of mpmath is rounded to 53 bits where nobody says otherwise."""
    with precision(200), mpmath.workdps(80):
        third = checker.number(checker.within(Fraction(1, 3)))
        assert third.r < 2.0**-190
        assert misses(third, [mpmath.mpf(1) / 3]) <= 1.0


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"count": 6}, "not a certificate"),
        ({"lemmas": []}, "lemmas"),
        ({"bits": 10**6}, "bits"),
        ({"outer": "1e-12"}, "outer circle"),
        ({"slack": "__import__('os')"}, "no decimal"),
        ({"steps": CERTIFICATE["steps"][:3]}, "energy condition"),
        ({"steps": ["40.0"]}, "too long"),
        ({"flow": {**CERTIFICATE["flow"], "far_temperature": ["7.0", "7.1"]}}, "far temperature"),
        ({"flow": {**CERTIFICATE["flow"], "nu": ["0.0415448928599", "0.0415448928600"]}}, "base"),
        ({"start": "0.9"}, "too long"),
    ],
)
def test_what_does_not_hold_is_refused_before_long(change: dict[str, Any], why: str) -> None:
    assert why in str(checker.check({**CERTIFICATE, **change}))


def test_other_grains_have_another_base() -> None:
    false = {**CERTIFICATE, "problem": {**CERTIFICATE["problem"], "tan_theta": "0.3001"}}
    assert checker.check(false) is not None


@pytest.mark.slow
def test_a_certificate_is_accepted_by_the_file_alone_and_tampered_ones_are_not(tmp_path: Path) -> None:
    """The file runs where neither this package nor python-flint nor NumPy can be imported."""
    file = tmp_path / "mode.json"
    file.write_text(json.dumps(CERTIFICATE))
    alone = "import runpy, sys; sys.modules.update(shootstab=None, flint=None, numpy=None)\n"
    alone += "runpy.run_path(sys.argv.pop(1), run_name='__main__')"
    done = subprocess.run([sys.executable, "-c", alone, str(checker.__file__), str(file)], capture_output=True, text=True, timeout=300)
    assert (done.stdout, done.returncode) == ("proved\n", 0)
    rng, digits = np.random.default_rng(9), CERTIFICATE["region"]["re"]
    at = int(rng.integers(6, len(digits) - 4))  # a digit that the radius sees
    other = str((int(digits[at]) + int(rng.integers(1, 10))) % 10)
    false = copy.deepcopy(CERTIFICATE)
    false["region"]["re"] = digits[:at] + other + digits[at + 1 :]
    problem = CERTIFICATE["problem"]
    changes = [false, {**CERTIFICATE, "count": 0}]
    changes += [{**CERTIFICATE, "problem": {**problem, name: value}} for name, value in (("ky", "0.010001"), ("wall", "isotropic"))]
    for tampered in changes:
        assert "Pellet" in str(checker.check(tampered)), tampered


@pytest.mark.slow
def test_d_of_the_checker_is_a_multiple_of_that_of_the_frames() -> None:
    """Both wavenumbers, the isotropic wall and the other law: equations that no built-in scene has all of."""
    flow = st.chute.steady(far_temperature=3.0, e=0.8, e_w=0.7, r=0.6, tan_theta=0.3, radial="carnahan-starling", wall="isotropic")
    problem = ChuteProblem(flow, 0.01, 0.02)
    places = (0.004 - 0.03j, 0.0045 - 0.031j)
    region = {"re": repr(places[0].real), "im": repr(places[0].imag), "radius": "1e-10"}
    made = next(candidates(Asked(problem.certified, region, 0, flow.far_temperature)))
    with precision(made["bits"]):
        chute = Certified(made)
        chute.descend(exact(3))
        chute.linearize()
        D = [
            complex(*(x * checker.ulp() for x in (v.re[0], v.im[0])))
            for v in (chute.D(exact(Fraction(s.real), Fraction(s.imag))) for s in places)
            if v.im
        ]
    doubles = st.discriminant(problem)
    assert D[0] / D[1] == pytest.approx(doubles(places[0]).over(doubles(places[1])), rel=1e-7)
    assert math.isfinite(abs(D[0]))
