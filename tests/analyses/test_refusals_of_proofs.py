"""Refusals of proofs and certificates that no other test reaches."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

pytest.importorskip("flint")

import shootstab as st
from shootstab.analyses import certificate, disc_proof, interval_proof
from shootstab.analyses import prove as proofs
from shootstab.analyses.enclosables import whole
from shootstab.analyses.prove import prove, prove_disc, prove_interval, prove_region
from shootstab.core.errors import ConvergenceError, InputError
from shootstab.io.scenes import load

WALLS = st.Conditions(0, ["y"]), st.Conditions(1, ["y"])
FIRST = -(math.pi**2)


def string() -> Any:
    """y″ + ky = σy between walls: σ = k − n²π²."""
    return st.equations(["y"], ["d(y,2) + k*y - sigma*y"], *WALLS, parameters={"k": 0.0})


def one_way() -> Any:
    """D = e^{−σ} has no zero."""
    return st.equations(["u", "v"], ["d(u) = sigma*u", "d(v) = -sigma*v"], st.Conditions(0, ["u"]), st.Conditions(1, ["v"]))


REFUSED: dict[str, tuple[Callable[[], Any], type[Exception], str]] = {
    "radius 0": (lambda: prove_disc(string(), FIRST, 0.0), InputError, r"radius = 0\.0: allowed is a finite number above 0"),
    "convection at 0": (
        lambda: prove_interval(st.gallery.benard(1000.0, 3.117), "rayleigh", 0.0, 1.0, floor=25.0),
        InputError,
        r"rayleigh from 0\.0: allowed is a number above 0",
    ),
    "no mode": (lambda: prove(one_way(), 0.3), ConvergenceError, "no mode to prove: not converged: neither Newton nor Muller arrives"),
    "a mode at 0": (
        lambda: prove(st.equations(["y"], ["d(y,2) = sigma*y"], st.Conditions(0, ["d(y)"]), st.Conditions(1, ["d(y)"])), 1e-3),
        ConvergenceError,
        "no mode to prove: it may be at 0, which has no digits: ask for a disc about 0",
    ),
    "a seed that is no mode": (
        lambda: disc_proof.polished(whole(string()), -20 + 0j, 1e-12, 12, "1e-6"),
        ConvergenceError,
        r"no mode to prove: the secants leave the mode that double precision found at -20\+0j",
    ),
    "a certificate of a half-annulus": (
        lambda: certificate.certify(
            st.gallery.PlanePoiseuille(20.0, 1.0, half=True),
            prove_region(st.gallery.PlanePoiseuille(20.0, 1.0, half=True), st.HalfAnnulus(0.5, 0.01, 0.1)),
        ),
        InputError,
        "a proof on a half-annulus: allowed is one on a disc, a rectangle, or on all eigenvalues that grow",
    ),
    "a certificate of another half-annulus": (
        lambda: certificate.certify(string(), prove_region(string(), st.HalfAnnulus(5.0, 0.1, 1.0))),
        InputError,
        "a proof on another region than a disc or rectangle: allowed is a certificate of one on these",
    ),
    "a certificate for an interval": (
        lambda: certificate.certify(string(), prove_interval(string(), "k", 0.5, 0.6, st.Rectangle(-1 - 1j, 1 + 1j))),
        InputError,
        "a proof for every k from 1/2 to 3/5: allowed is one for one value of the parameters",
    ),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_was_wrong_is_named(what: str) -> None:
    ask, kind, words = REFUSED[what]
    with pytest.raises(kind, match=words):
        ask()


def test_a_certificate_that_its_checker_does_not_accept_is_not_handed_out() -> None:
    even = st.gallery.PlanePoiseuille(20.0, 1.0, half=True)
    proof = prove_disc(even, 0.5, 0.05)
    assert proof.count == 0
    with pytest.raises(ConvergenceError, match="the checker does not accept the certificate: "):
        certificate.certify(even, replace(proof, counts=(1,)))


def test_bits_that_do_not_suffice_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(disc_proof, "SPARE_BITS", 10)
    monkeypatch.setattr(disc_proof, "MOST_BITS", 12)
    with pytest.raises(ConvergenceError, match=r"1\d bits do not enclose D well enough on the circle of radius 1\.0"):
        prove_disc(string(), FIRST, 1.0)


def test_subintervals_that_do_not_suffice_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """k − π² lies in the rectangle for all k to 9, but the interval is long for one piece."""
    monkeypatch.setattr(interval_proof, "MOST_SUBINTERVALS", 1)
    words = r"1 subintervals do not do: next to k = .* an eigenvalue is on the boundary of the region or near to it: allowed is"
    with pytest.raises(ConvergenceError, match=words):
        prove_interval(string(), "k", 0.0, 9.0, st.Rectangle(-20 - 4j, 3 + 4j))


def test_a_disc_without_the_mode_of_double_precision_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(proofs, "polished", lambda form, seed, error, places, radius: (repr(seed.real + 1.0), repr(seed.imag)))
    with pytest.raises(ConvergenceError, match=r"no eigenvalue lies in \|σ − \(-8\.8696\d+ .*\)\| < 1e-\d+, next to what double"):
        prove(string(), -9.8)


@pytest.mark.slow
def test_rates_that_differ_by_a_power_of_the_coefficients_do_not_matter() -> None:
    """The soliton of Korteweg and de Vries has them at its mode, where the series of single solutions have logarithms; a graph has none."""
    problem = load("kdv-soliton").problem
    assert prove(problem, 0.3535533905932738, 12).count == 1
