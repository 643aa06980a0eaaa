"""The checker of polynomial pencils: balls, steps and ends against the truth, certificates, and such tampered with at random."""

from __future__ import annotations

import copy
import json
import random
import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest

pytest.importorskip("flint")

import shootstab as st
from shootstab.analyses import rectangle_certificate
from shootstab.analyses.certificate import certify, check
from shootstab.analyses.prove import prove, prove_region
from shootstab.checkers import polynomial_pencil as checker
from shootstab.checkers.polynomial_pencil import CertifiedEnd, IntegerBall, PencilChecker, RefusedPencilError

BITS, TERMS, MANY = 70, 24, 90
SECH = st.equations(
    ["y"], ["d(y,2) + nu*(nu + 1)*sech(x)**2*y - sigma*y"], st.Infinity(), st.Infinity(), parameters={"nu": 0.5}, variable="x"
)
LEGENDRE = st.equations(["y"], ["d((1 - z**2)*d(y)) + sigma*y"], st.Axis(-1), st.Axis(1))
STRING = st.equations(["y"], ["d(y,2) - sigma*y"], st.Conditions(0, ["y"]), st.Conditions(1, ["y"]))
SUCTION = st.equations(["y"], ["d(y,2) + d(y) + (12*exp(-z) - sigma)*y"], st.Conditions(0, ["y"]), st.Infinity())


def bare(order: int = TERMS, weights: tuple[int, ...] = (0, 0)) -> PencilChecker:
    """A checker without a certificate, for its arithmetic."""
    out = PencilChecker.__new__(PencilChecker)
    out.P, out.N, out.n, out.k, out.weights, out.subsets = BITS, order, len(weights), 1, list(weights), [(i,) for i in range(len(weights))]
    return out


def number(a: IntegerBall) -> Any:
    return mpmath.mpc(a.x, a.y) * mpmath.mpf(2) ** -BITS


def misses(a: IntegerBall, truth: Any) -> float:
    """The distance of the truth over the radius."""
    off = float(abs(number(a) - truth) * mpmath.mpf(2) ** BITS)
    return off / a.r if a.r else (0.0 if off == 0.0 else np.inf)


def drawn(rng: np.random.Generator, scale: float, radius: float) -> tuple[IntegerBall, Any]:
    """A ball and a number in it, at its edge."""
    z = complex(*(scale * rng.standard_normal(2)))
    ball = IntegerBall(round(z.real * 2**40) << BITS - 40, round(z.imag * 2**40) << BITS - 40, int(radius * 2**BITS))
    return ball, number(ball) + mpmath.mpf(ball.r) * mpmath.expj(rng.uniform(0, 6.3)) * mpmath.mpf(2) ** -BITS * 0.99999


def test_sums_products_inverses_and_determinants_hold_the_truth() -> None:
    rng, own, ratios = np.random.default_rng(1), bare(), []
    with mpmath.workdps(60):
        for _ in range(400):
            (a, x), (b, y) = (drawn(rng, float(10 ** rng.uniform(-2, 2)), float(10 ** rng.uniform(-12, -4))) for _ in range(2))
            ratios += [misses(own.times(a, b), x * y), misses(own.plus(a, b), x + y), misses(own.inverse(a), 1 / x)]
        for n in (1, 2, 3, 4):
            for _ in range(60):
                pairs = [[drawn(rng, 1.0, 1e-12) for _ in range(n)] for _ in range(n)]
                A, truth = [[p[0] for p in row] for row in pairs], mpmath.matrix([[p[1] for p in row] for row in pairs])
                ratios.append(misses(own.determinant(A), mpmath.det(truth)))
                found, inverse = own.solved(A, [[IntegerBall(int(i == j) << BITS, 0, 0) for j in range(n)] for i in range(n)]), truth**-1
                ratios += [misses(found[i][j], inverse[i, j]) for i in range(n) for j in range(n)]
    assert len(ratios) > 3000
    assert max(ratios) <= 1.0 and max(ratios) > 0.5


@pytest.mark.parametrize("weights", [(0, 0), (0, 6)])
def test_a_step_holds_the_truth(weights: tuple[int, ...]) -> None:
    """R1: c y′ = B y with random polynomials; the truth is the series of so many terms that the rest is no more seen."""
    rng, own, ratios, refused = np.random.default_rng(2), bare(18, weights), [], 0
    for _ in range(300):
        f = [0.03 * complex(*rng.standard_normal(2)) for _ in range(2)]
        G = {
            (i, j): [0.5 * 2.0 ** (weights[i] - weights[j]) * complex(*rng.standard_normal(2)) / 3**p for p in range(3)]
            for i in (0, 1)
            for j in (0, 1)
        }
        y = [complex(*rng.standard_normal(2)) * 2.0 ** weights[i] for i in (0, 1)]
        exact = lambda z: own.exact(Fraction(z.real), Fraction(z.imag))  # noqa: E731
        try:
            found = own.step([exact(z) for z in y], ([exact(z) for z in f], {at: [exact(z) for z in e] for at, e in G.items()}))
        except RefusedPencilError:
            refused += 1
            continue
        with mpmath.workdps(40):
            terms = [[mpmath.mpmathify(z) for z in y]]
            for m in range(1, MANY):
                row = []
                for i in (0, 1):
                    new = mpmath.fsum(G[i, j][p] * terms[m - 1 - p][j] for j in (0, 1) for p in range(min(3, m)))
                    row.append((new - mpmath.fsum((m - p) * f[p - 1] * terms[m - p][i] for p in (1, 2) if p < m)) / m)
                terms.append(row)
            ratios += [misses(found[i], mpmath.fsum(t[i] for t in terms)) for i in (0, 1)]
    assert len(ratios) > 400 and refused < 150
    assert max(ratios) <= 1.0 and max(ratios) > 1e-3


def test_solutions_at_infinity_hold_the_truth() -> None:
    """R2: t ĉ ψ′ = B ψ; the truth by its eigenvalues and series in many digits, over the same component of the eigenvector."""
    rng, own, ratios = np.random.default_rng(3), bare(20), []
    for _ in range(160):
        f = [0.05 * complex(*rng.standard_normal(2))]
        base = (
            np.diag([rng.uniform(0.2, 1.5), -rng.uniform(0.2, 1.5)])
            + 0.3 * rng.standard_normal((2, 2))
            + 0.2j * rng.standard_normal((2, 2))
        )
        values = np.linalg.eigvals(base)
        if not (values.real.min() < -0.05 and values.real.max() > 0.05):
            continue
        G = [base, 0.2 * (rng.standard_normal((2, 2)) + 1j * rng.standard_normal((2, 2)))]
        end = CertifiedEnd.__new__(CertifiedEnd)
        end.kind, end.admitted, end.pivots = "infinity", 1, (0,)
        exact = lambda z: own.exact(Fraction(float(z.real)), Fraction(float(z.imag)))  # noqa: E731
        start = ([[exact(1 + 0j), exact(f[0])]], {(i, j): [[exact(g[i, j]) for g in G]] for i in (0, 1) for j in (0, 1)})
        with mpmath.workdps(40):
            try:
                found = own.singular(end, start, own.exact(Fraction(0)))
            except RefusedPencilError:
                continue
            matrices = [mpmath.matrix(g.tolist()) for g in G]
            mus, vectors = mpmath.eig(matrices[0])
            q = max(range(2), key=lambda i: mpmath.re(mus[i]))
            P, mu = [vectors[:, q] / vectors[0, q]], mus[q]
            for m in range(1, MANY):
                right = (matrices[1] - (m - 1 + mu) * f[0] * mpmath.eye(2)) * P[m - 1]
                P.append(((m + mu) * mpmath.eye(2) - matrices[0]) ** -1 * right)
            ratios += [misses(found[i], mpmath.fsum(p[i] for p in P)) for i in (0, 1)]
    assert len(ratios) > 150
    assert max(ratios) <= 1.0 and max(ratios) > 1e-3


@pytest.mark.parametrize(
    ("problem", "sigma"),
    [(SECH, 0.25), (LEGENDRE, 6.0), (STRING, -9.8696044), (SUCTION, 2.6)],
    ids=["sech", "legendre", "string", "suction"],
)
def test_certificates_are_accepted_and_those_tampered_with_at_random_are_refused(problem: Any, sigma: float) -> None:
    certificate = certify(problem, prove(problem, sigma, 10))
    assert check(certificate) is None
    assert len(json.dumps(certificate)) < 4000
    rng = random.Random(5)
    radius = float(Fraction(certificate["region"]["radius"]))
    for _ in range(20):
        false = copy.deepcopy(certificate)
        kind = rng.choice(["count", "place", "entry", "c"])
        if kind == "count":
            false["count"] = rng.choice([n for n in range(4) if n != certificate["count"]])
        elif kind == "place":
            part, off = rng.choice(["re", "im"]), Fraction(rng.choice([-1, 1]) * rng.uniform(1.5, 50) * radius)
            false["region"][part] = str(Fraction(false["region"][part]) + off)
        else:
            layer = false["problem"]["layers"][0]
            entry = layer["c"] if kind == "c" else rng.choice(layer["B"])[2]
            places = [(part, i) for part in entry for i, a in enumerate(part) if a != "0" and isinstance(a, str)]
            part, i = rng.choice(places)
            part[i] = str(Fraction(part[i]) * Fraction(rng.randint(101, 150), 100))
        assert check(false) is not None, (kind, false)


@pytest.mark.parametrize(
    ("problem", "region", "count"),
    [
        (STRING, st.Rectangle(-200 - 20j, -1 + 20j), 4),
        (STRING, st.Rectangle(-38 - 1j, -11 + 1j), 0),
    ],
    ids=["string", "none"],
)
def test_rectangles_are_accepted_and_those_tampered_with_at_random_are_refused(problem: Any, region: st.Rectangle, count: int) -> None:
    proof = prove_region(problem, region)
    certificate = certify(problem, proof)
    assert (proof.count, certificate["count"], check(certificate)) == (count, count, None)
    assert len(json.dumps(certificate)) < 4000
    truth = [-((n * np.pi) ** 2) for n in range(1, 9)]
    rng, refused = random.Random(6), 0
    for _ in range(30):
        false = copy.deepcopy(certificate)
        kind = rng.choice(["count", "side", "entry", "outer", "points", "cells"])
        if kind == "count":
            false["count"] = rng.choice([n for n in range(7) if n != count])
        elif kind == "side":
            side = rng.choice(sorted(false["region"]))
            false["region"][side] = str(Fraction(false["region"][side]) + Fraction(rng.uniform(-60, 60)))
        elif kind == "entry":
            entry = rng.choice(false["problem"]["layers"][0]["B"])[2]
            places = [(part, i) for part in entry for i, a in enumerate(part) if a != "0" and isinstance(a, str)]
            part, i = rng.choice(places)
            part[i] = str(Fraction(part[i]) * -rng.randint(2, 5))
        else:
            false[kind] = {"outer": str(Fraction(certificate["outer"]) * 40), "points": count + 2, "cells": 0}[kind]
        reason = check(false)
        refused += reason is not None
        if reason is None and kind != "entry":  # what is accepted after a change of a side is true
            left, low, right, high = (float(Fraction(false["region"][side])) for side in ("left", "low", "right", "high"))
            assert false["count"] == sum(left < x < right and low < 0 < high for x in truth), (kind, false["region"])
        assert kind not in ("count", "cells") or reason is not None
    assert refused > 15


def test_a_rectangle_without_an_inside_or_next_to_an_eigenvalue_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    certificate = certify(STRING, prove_region(STRING, st.Rectangle(-20 - 1j, -1 + 1j)))
    region = certificate["region"]
    assert "inside" in str(check({**certificate, "region": {**region, "left": "0"}}))
    near = {**region, "left": "-9.8696044010893586188344909998761511353"}
    assert "too near to the boundary" in str(check({**certificate, "region": near}))
    assert "claimed" in str(check({**certificate, "region": {**region, "left": "-9.5"}}))
    monkeypatch.setattr(rectangle_certificate, "LONGEST_CHECK", 0.0)
    with pytest.raises(st.ConvergenceError, match="would take its checker about"):
        certify(STRING, prove_region(STRING, st.Rectangle(-20 - 1j, -1 + 1j)))


def test_settings_tampered_with_prove_nothing_else() -> None:
    """What is accepted after a change of settings is true; whatever is put in any place, the answer is words."""
    certificate = certify(LEGENDRE, prove(LEGENDRE, 6.0, 8))
    rng = random.Random(9)
    junk = [None, -1, 0, 3, 1e9, "x", "", "1/0", "9" * 3000, [], {}, True, "-1", "2", "1e-400"]
    accepted = 0
    for _ in range(300):
        false = copy.deepcopy(certificate)
        at: Any = false
        while True:
            key = rng.choice(list(at)) if isinstance(at, dict) else rng.randrange(len(at))
            if isinstance(at[key], dict | list) and at[key] and rng.random() < 0.8:
                at = at[key]
                continue
            break
        before = at[key]
        at[key] = rng.choice([x for x in junk if x != before or type(x) is not type(before)])
        reason = checker.check(false)
        assert reason is None or isinstance(reason, str)
        if reason is None:
            accepted += 1
            re, im, radius = (float(Fraction(false["region"][part])) for part in ("re", "im", "radius"))
            assert false["count"] == sum(abs(complex(re, im) - n * (n + 1)) < radius for n in range(20))
            assert {**false["problem"], "layers": 0, "left": 0, "right": 0} == {
                **certificate["problem"],
                "layers": 0,
                "left": 0,
                "right": 0,
            }
            for a, b in zip(false["problem"]["layers"], certificate["problem"]["layers"], strict=True):
                assert (a["c"], a["B"], a["from"], a["to"]) == (b["c"], b["B"], b["from"], b["to"])
    assert accepted < 60


def test_the_checker_runs_by_itself(tmp_path: Path) -> None:
    file = tmp_path / "mode.json"
    file.write_text(json.dumps(certify(STRING, prove(STRING, -9.87, 8))))
    ran = subprocess.run([sys.executable, checker.__file__, str(file)], capture_output=True, text=True, check=False)
    assert (ran.returncode, ran.stdout) == (0, "proved\n")
    file.write_text(file.read_text().replace('"count": 1', '"count": 0'))
    ran = subprocess.run([sys.executable, checker.__file__, str(file)], capture_output=True, text=True, check=False)
    assert ran.returncode == 1 and "Pellet" in ran.stdout


def test_what_is_no_polynomial_pencil_has_no_certificate() -> None:
    layers = st.equations(
        ["y"], ["d(y,2) - sigma*y"], st.Conditions(0, ["y"]), st.Conditions(2, ["y"]),
        interfaces=[{"at": 1, "conditions": ["jump(y)", "jump(d(y))"]}],
    )  # fmt: skip
    for problem, why in (
        (layers, "layers"),
        (st.equations(["y"], ["d(y,2) - exp(z)*sigma*y"], st.Conditions(0, ["y"]), st.Conditions(1, ["y"])), "rational"),
    ):
        with pytest.raises(st.InputError, match=why):
            problem.polynomial_pencil()
