"""Lemma E10 of the guide: a polynomial of σ and of a parameter stays within its spread of the function it was made of."""

from __future__ import annotations

import cmath
import math
from typing import Any

import numpy as np
import pytest

flint = pytest.importorskip("flint")

from flint import acb, arb, ctx  # noqa: E402

from shootstab.core.errors import ConvergenceError  # noqa: E402
from shootstab.roots.two_variables import two_variable_model  # noqa: E402

WIDER, AWAY, POINTS, VALUES = 4, 4, 24, 20


def model(root: complex, speed: complex) -> Any:
    """Of D = (u − root − speed τ) e^{u + τ/8} on |u| ≤ 1, |τ| ≤ 1."""

    def at(tau: Any) -> Any:
        return lambda u: (u - acb(root) - acb(speed) * tau) * (u + tau / 8).exp()

    D = [at((2 * acb(i) / VALUES).exp_pi_i()) for i in range(VALUES)]
    bound = arb(WIDER + abs(root) + abs(speed) * AWAY).log() + WIDER + AWAY / 8
    return two_variable_model(D, bound, acb(0), arb(1), arb(1) / WIDER, arb(1) / AWAY, POINTS)


def test_the_polynomial_is_within_its_spread_of_the_function() -> None:
    rng = np.random.default_rng(11)
    with ctx.workprec(100):
        for _ in range(20):
            root, speed = (complex(*rng.uniform(-0.4, 0.4, 2)) for _ in range(2))
            found = model(root, speed)
            assert found.spread < arb("1e-6")
            for _ in range(20):
                u, tau = (math.sqrt(rng.uniform()) * cmath.exp(2j * math.pi * rng.uniform()) for _ in range(2))
                exact = (acb(u) - acb(root) - acb(speed) * acb(tau)) * (acb(u) + acb(tau) / 8).exp()
                value = found.polynomial(acb(u))
                for power, p in enumerate(found.varying, 1):
                    value = value + acb(tau) ** power * p(acb(u))
                assert abs(exact - value).lower() <= found.spread


def test_a_count_holds_for_every_parameter_or_is_refused() -> None:
    square = [acb(-0.5, -0.5), acb(0.5, -0.5), acb(0.5, 0.5), acb(-0.5, 0.5)]
    with ctx.workprec(100):
        assert model(0.1 + 0.1j, 0.1).count(square)[0] == 1
        assert model(0.8 + 0j, 0.1).count(square)[0] == 0
        with pytest.raises(ConvergenceError):
            model(0.45 + 0j, 0.1).count(square)  # the zero leaves the square at τ = 1/2
