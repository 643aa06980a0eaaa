"""Lemma E1 of the guide: no rule of a series with a tail loses a function that it should hold."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

flint = pytest.importorskip("flint")

from flint import acb, arb, ctx  # noqa: E402

from shootstab.multiprecision.tailed_series import TailedSeries, variable  # noqa: E402

N, LONG = 8, 60  # terms of the series under test, and of the truth

OPERATIONS: dict[str, Callable[[Any, Any], Any]] = {
    "sum": lambda a, b: a + b,
    "difference": lambda a, b: 1 - a - b,
    "product": lambda a, b: a * b,
    "quotient": lambda a, b: a / b,
    "inverse": lambda a, b: 2 / b,
    "square root": lambda a, b: b.sqrt(),
    "power": lambda a, b: b ** acb("-1.7"),
    "cube": lambda a, b: a**3,
    "exp": lambda a, b: a.exp(),
    "log": lambda a, b: b.log(),
    "sin": lambda a, b: a.sin(),
    "cosh": lambda a, b: a.cosh(),
    "tanh": lambda a, b: (a * acb("0.3")).tanh(),
    "tan": lambda a, b: (a * acb("0.2")).tan(),
    "sech": lambda a, b: (a * acb("0.3")).sech(),
    "erf": lambda a, b: (a * acb("0.4")).erf(),
}


def random_series(rng: np.random.Generator, first: complex) -> list[Any]:
    """LONG coefficients that decay, the first one given."""
    rate = rng.uniform(0.1, 0.5)
    sizes = 0.5 * rate ** np.arange(1, LONG) * rng.standard_normal((2, LONG - 1))
    return [acb(first.real, first.imag), *(acb(x, y) for x, y in sizes.T.tolist())]


def shortened(truth: list[Any]) -> TailedSeries:
    """The truth with N coefficients and the norm of the others as its tail."""
    return TailedSeries(truth[:N], N, sum((abs(x) for x in truth[N:]), arb(0)))


@pytest.mark.parametrize("name", OPERATIONS)
def test_a_rule_encloses_what_a_much_longer_series_gives(name: str) -> None:
    rng = np.random.default_rng(sum(map(ord, name)))
    operation = OPERATIONS[name]
    bounded, ratios = 0, []
    with ctx.workprec(160):
        for _ in range(150):
            a = random_series(rng, complex(*rng.standard_normal(2)))
            b = random_series(rng, complex(rng.uniform(1.5, 3.0), rng.uniform(-1.0, 1.0)))
            found = operation(shortened(a), shortened(b))
            truth = operation(TailedSeries(a, LONG), TailedSeries(b, LONG))
            for x, y in zip(found.c, truth.c, strict=False):
                assert x.overlaps(y)
            if found.tail.is_finite():
                bounded += 1
                missing = sum((abs(x) for x in truth.c[len(found.c) :]), arb(0))
                assert missing.lower() <= found.tail.upper()
                if missing > 0:
                    ratios.append(float((found.tail / missing).mid()))
    assert bounded > 50
    assert min(ratios) >= 1.0


def test_the_tail_of_erf_does_not_cancel() -> None:
    """1 + a t + a² t²/4: in u g the terms of order three cancel, in erf with their weights they do not."""
    with ctx.workprec(160):
        for a in (arb("0.1"), arb("0.01"), arb("0.001")):
            c = [acb(1), acb(a), acb(a * a / 4)]
            missing = sum((abs(x) for x in TailedSeries(c, LONG).erf().c[3:]), arb(0))
            assert missing < TailedSeries(c, 3).erf().tail < 10 * missing


def test_a_tail_that_no_rule_bounds_is_infinite_and_not_small() -> None:
    steep = TailedSeries([acb(1), acb(-1.5)], N)
    assert not (1 / steep).tail.is_finite()
    assert not steep.log().tail.is_finite()


def test_the_variable_has_no_tail() -> None:
    z = variable(acb(2), arb("0.5"), N)
    square = z * z
    assert [complex(x.mid()) for x in square.c] == [4, 2, 0.25]
    assert square.tail == 0


def test_no_branch_is_taken_across_its_cut() -> None:
    below = TailedSeries([acb(-2, "-1e-3"), acb(0, "0.1")], N)  # from the lower side of the negative axis to the upper one
    assert not below.sqrt().tail.is_finite()
    assert not below.log().tail.is_finite()
    assert (below * acb(0, 1)).sqrt().tail.is_finite()


def test_a_real_series_that_is_negative_has_the_root_and_logarithm_of_numbers() -> None:
    with ctx.workprec(100):
        z = variable(arb("0.3"), arb("0.1"), 30)
        for function in (lambda x: (x - 2).sqrt(), lambda x: (x - 2) ** acb("0.3"), lambda x: (x * x - 1).log()):
            found = function(z)
            at_end = sum(found.c, acb(0))
            truth = function(acb("0.4"))
            assert abs(at_end - truth).lower() <= found.tail.upper() < arb("1e-15")
        assert (z - 2).sin().real
        assert not (z - 2).sqrt().real
