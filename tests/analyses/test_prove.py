"""Proofs: against eigenvalues known exactly, against many digits, and against a checker that shares nothing with them."""

from __future__ import annotations

import copy
import math
from typing import Any

import mpmath
import numpy as np
import pytest

flint = pytest.importorskip("flint")

from flint import acb, arb, ctx  # noqa: E402

import shootstab as st  # noqa: E402
from shootstab.analyses.certificate import certify, check  # noqa: E402
from shootstab.analyses.prove import prove, prove_disc, prove_growing, prove_interval, prove_region  # noqa: E402
from shootstab.formulation.expression import function, number  # noqa: E402
from shootstab.formulation.statement import open_parameter  # noqa: E402
from shootstab.formulation.vanishing import Vanishing  # noqa: E402
from shootstab.multiprecision import enclosure  # noqa: E402
from shootstab.multiprecision.closed_form_enclosure import ClosedFormEnclosable  # noqa: E402
from shootstab.multiprecision.enclosure import Enclosure  # noqa: E402

MODE = 0.0037396706229799 - 0.2375264888204701j  # Orszag's, R = 10000, α = 1


class EnclosedString:
    """ψ″ = σ ψ with ψ = 0 at 0 and 1: σ = −(nπ)². The state is (ψ, ψ′)."""

    size, decaying = 2, 1

    def exact_ends(self, exact: Any) -> tuple[Any, Any]:
        return 0, 1

    def exact_pencil(self, z: Any, exact: Any) -> tuple[Any, ...]:
        return {(0, 0): 1, (1, 1): 1}, {}, {(0, 1): 1}, {(1, 0): 1}

    def exact_far(self, sigma: Any, exact: Any) -> list[list[int]]:
        return [[0], [1]]

    def exact_wall(self, exact: Any) -> tuple[list[list[int]], list[list[int]]]:
        return [[1, 0]], [[0, 0]]


class Airy(EnclosedString):
    """(1 + z/2) ψ′ = χ, χ′ = (z + σ) ψ: C depends on z, so that A = C⁻¹D is a series with a tail."""

    def exact_pencil(self, z: Any, exact: Any) -> tuple[Any, ...]:
        return {(0, 0): 1 + z / 2, (1, 1): 1}, {}, {(0, 1): 1, (1, 0): z}, {(1, 0): 1}


def string_D(sigma: complex) -> Any:
    """sinh(√σ)/√σ."""
    root = mpmath.sqrt(mpmath.mpmathify(sigma))
    return mpmath.sinh(root) / root


@pytest.mark.parametrize("sigma", [-3.0 + 0.5j, 40 - 7j, -500 + 0.125j])
def test_the_enclosure_holds_the_exact_value(sigma: complex) -> None:
    with ctx.workprec(200), mpmath.workprec(200):
        D = Enclosure(ClosedFormEnclosable(EnclosedString()), 200)(acb(sigma.real, sigma.imag))  # type: ignore[arg-type]
        truth = string_D(sigma)
        assert D.real.contains(arb(mpmath.nstr(truth.real, 40))) or abs(D.real - arb(mpmath.nstr(truth.real, 40))) < arb("1e-35") * abs(D)
        assert D.rel_accuracy_bits() > 100


def test_the_bound_on_growth_lies_above_the_values() -> None:
    rng = np.random.default_rng(3)
    with ctx.workprec(120):
        enclosure = Enclosure(ClosedFormEnclosable(st.gallery.PlanePoiseuille(half=True)), 120)
        at, radius = acb(MODE.real, MODE.imag), 0.05
        spread = arb(0, radius)
        bound = enclosure.growth(acb(at.real + spread, at.imag + spread))
        for phase in rng.uniform(0, 2 * math.pi, 5).tolist():
            D = enclosure(at + radius * acb(math.cos(phase), math.sin(phase)) * acb("0.99"))
            assert abs(D).log() < bound


@pytest.mark.parametrize(("radius", "count"), [(1.0, 1), (5.0, 1), (1e-6, 1)])
def test_discs_about_an_eigenvalue_known_exactly(radius: float, count: int) -> None:
    proof = prove_disc(st.ClosedProblem(EnclosedString()), -(math.pi**2), radius)  # type: ignore[arg-type]
    assert proof.count == count
    assert proof.margin > 1.0


def test_a_disc_without_eigenvalues_and_one_with_several() -> None:
    problem = st.ClosedProblem(EnclosedString())  # type: ignore[arg-type]
    assert prove_disc(problem, -20.0, 5.0).count == 0
    found = prove_region(problem, st.Rectangle(-100 - 4j, -5 + 4j))
    assert found.count == 3  # π², 4π² and 9π²


def test_an_edge_within_a_rounding_of_an_eigenvalue_is_on_the_right_side_of_it() -> None:
    problem, edge = st.ClosedProblem(EnclosedString()), -9.869604401089358  # type: ignore[arg-type]
    with mpmath.workdps(30):
        assert edge > -(mpmath.pi**2)
    assert prove_region(problem, st.Rectangle(edge - 1j, -5 + 1j)).count == 0
    assert prove_region(problem, st.Rectangle(float(np.nextafter(edge, -10.0)) - 1j, -5 + 1j)).count == 1


def test_a_pencil_whose_C_depends_on_z() -> None:
    problem = st.ClosedProblem(Airy())  # type: ignore[arg-type]
    mode = st.refine(problem, -12.0, rtol=1e-11)
    proof = prove(problem, complex(mode.sigma), digits=10)
    assert proof.count == 1
    assert abs(float(proof.region["centre"]["re"]) - complex(mode.sigma).real) < 1e-9


@pytest.mark.parametrize("digits", [6, 30])
def test_orszags_mode(digits: int) -> None:
    proof = prove(st.gallery.PlanePoiseuille(half=True), MODE, digits=digits)
    assert proof.count == 1
    centre = complex(float(proof.region["centre"]["re"]), float(proof.region["centre"]["im"]))
    assert abs(centre - MODE) < 1e-15 + 10.0 ** -(digits + 4)
    assert float(proof.region["radius"]) <= 10.0**-digits * abs(MODE) * 1.0000001
    assert proof.alone is not None and proof.alone > 1e-3
    assert proof.statement.startswith("exactly one eigenvalue lies in |σ − (0.00373967")


def test_a_certificate_is_accepted_and_tampered_ones_are_not() -> None:
    problem = st.gallery.PlanePoiseuille(100.0, 1.0, half=True)
    certificate = certify(problem, prove(problem, -0.163 - 0.463j, digits=10))
    assert check(certificate) is None
    rng = np.random.default_rng(7)
    digits = certificate["region"]["re"]
    for _ in range(4):
        false = copy.deepcopy(certificate)
        at = int(rng.integers(4, 9))
        false["region"]["re"] = digits[:at] + str((int(digits[at]) + int(rng.integers(1, 9))) % 10) + digits[at + 1 :]
        assert check(false) is not None
    for key, value in (
        ("count", 0),
        ("count", 2),
        ("order", 12),
        ("steps", ["1.5"]),
        ("format", 1),
        ("outer", "1e-20"),
        ("outer", "2147483648"),  # the bound on D there is a number of millions of digits
        ("outer", "1e308"),
    ):
        assert check({**certificate, key: value}) is not None, key
    for name, value in (("reynolds", "100.1"), ("alpha", "1.001"), ("modes", "odd")):
        assert check({**certificate, "problem": {**certificate["problem"], name: value}}) is not None, name
    assert check({**certificate, "region": {**certificate["region"], "radius": "__import__('os')"}}) is not None


def test_a_certificate_of_a_rectangle() -> None:
    """R = 100: three modes of the channel in a rectangle; a side moved across one of them is refused."""
    channel, region = st.gallery.PlanePoiseuille(100.0, 1.0, half=False), st.Rectangle(-0.4 - 1.0j, 0.1 + 0j)
    proof = prove_region(channel, region)
    certificate = certify(channel, proof)
    assert sum(part["count"] for part in certificate["parts"]) == proof.count == 3
    assert check(certificate) is None
    for part in certificate["parts"]:
        assert check({**part, "count": part["count"] + 1}) is not None
        assert check({**part, "region": {**part["region"], "right": "-0.5"}}) is not None
        assert check({**part, "region": {**part["region"], "right": "-0.35"}}) is not None
        assert check({**part, "region": {"left": "-0.4"}}) is not None


def test_a_certificate_of_all_that_grows() -> None:
    """R = 50: no mode of the channel has Re σ ≥ −0.1, and one even mode has Re σ ≥ −0.3, near −0.228 − 0.510i."""
    channel = st.gallery.PlanePoiseuille(50.0, 1.0, half=False)
    proof = prove_growing(channel, -0.1, spare_bits=24)
    certificate = certify(channel, proof, 24)
    assert [part["count"] for part in certificate["parts"]] == [0, 0]
    assert check(certificate) is None
    for part in certificate["parts"]:
        assert check({**part, "count": 1}) is not None
        assert check({**part, "problem": {**part["problem"], "reynolds": "6000"}}) is not None
    even = st.gallery.PlanePoiseuille(50.0, 1.0, half=True)
    found = st.find(even, st.Rectangle(-0.3 - 1.1j, 0.5 + 0.1j)).modes
    one = certify(even, prove_growing(even, -0.3, spare_bits=24), 24)
    assert one["count"] == len(found) > 0
    assert check(one) is None
    assert check({**one, "count": one["count"] - 1}) is not None
    # a lower floor takes in another mode, and the count is wrong there
    assert check({**one, "region": {"floor": "-1.5"}}) is not None


def test_the_checker_imports_neither_the_program_nor_flint() -> None:
    import ast
    import sys
    from pathlib import Path

    import shootstab.checkers

    for path in Path(shootstab.checkers.__file__).parent.glob("*.py"):
        names = {
            alias.name.split(".")[0]
            for node in ast.walk(ast.parse(path.read_text()))
            if isinstance(node, ast.Import)
            for alias in node.names
        } | {(node.module or "").split(".")[0] for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.ImportFrom)}
        assert names <= {"mpmath", *sys.stdlib_module_names}, path


def test_problems_in_equations_with_eigenvalues_known_exactly() -> None:
    """Powers of σ, a condition with σ at both ends, functions of z: each against its exact eigenvalue."""
    water = st.equations(
        ["f"], ["d(f,2) - k**2*f"], st.Conditions(-1, ["d(f)"]), st.Conditions(0, ["sigma**2*f + g*d(f)"]), parameters={"k": 1, "g": 1}
    )
    stretched = st.equations(["y"], ["d(y,2) - d(y) + sigma*exp(2*z)*y"], st.Conditions(0, ["y"]), st.Conditions(1, ["y"]))
    ends = st.equations(["y"], ["d(y,2) + y"], st.Conditions(0, ["d(y) - sigma*y"]), st.Conditions(1, ["d(y) + sigma*y"]))
    with mpmath.workdps(40):
        cases = (
            (water, mpmath.sqrt(mpmath.tanh(1)) * 1j),
            (stretched, (mpmath.pi / (mpmath.e - 1)) ** 2),
            (ends, mpmath.tan(mpmath.mpf(1) / 2)),  # y = cos(z − 1/2)
        )
        for problem, truth in cases:
            proof = prove(problem, complex(truth), digits=20)
            at, radius = proof.region["centre"], mpmath.mpf(proof.region["radius"])
            assert proof.count == 1
            assert abs(mpmath.mpc(at["re"], at["im"]) - truth) < radius <= 1e-20 * abs(truth) * 1.0001


def test_every_function_of_the_language_in_a_proof() -> None:
    """Against the digits of the other arithmetic, which encloses nothing."""
    functions = "tanh(z)*sech(z)*sqrt(2+sin(z))*log(3+z)*erf(z)*tan(z/3)*cosh(z)*sinh(i*z)*(1+z)**(1/3)/(2+z)"
    written = f"d(y,2) + sigma*y + {functions}*y + exp(i*z)*sqrt(z-2)*y"
    problem = st.equations(["y"], [written], st.Conditions(0, ["y"]), st.Conditions(1, ["d(y)"]))
    mode = st.refine(problem, 3.1725 - 0.9374j, digits=20)
    with mpmath.workdps(30):
        proof = prove_disc(problem, complex(mode.sigma), 1e-12)
    assert proof.count == 1


def test_the_channel_is_the_product_of_its_parities() -> None:
    """At R = 100 the two least damped modes have different parities; D of the channel is a constant times D_even D_odd."""
    channel = st.gallery.PlanePoiseuille(100.0, 1.0, half=False)
    proof = prove_region(channel, st.Rectangle(-0.5 - 1.0j, 0.2 + 0j))
    assert sum(proof.counts) == proof.count == st.count(channel, st.Rectangle(-0.5 - 1.0j, 0.2 + 0j))
    assert min(proof.counts) >= 1
    assert "E9" in proof.lemmas
    with ctx.workprec(400):
        for sigma in (acb("0.1", "-0.3"), acb("-0.7", "0.2")):
            whole = Enclosure(ClosedFormEnclosable(channel), 400)(sigma)
            even, odd = (Enclosure(ClosedFormEnclosable(part), 400)(sigma) for part in channel.factors)
            assert abs(abs(whole / (even * odd)) - 4) < arb("1e-30")


def test_the_modes_of_convection_that_grow() -> None:
    layer = st.gallery.benard(2000.0, 3.117)
    proof = prove_growing(layer, 0.0)
    assert (proof.count, proof.lemmas[-1]) == (1, "P2")
    assert prove_growing(st.gallery.benard(1700.0, 3.117), -1.0).count == 1
    assert prove_growing(st.gallery.benard(1700.0, 3.117), 0.0).count == 0  # Ra_c = 1707.76
    assert (
        st.gallery.benard(2000.0 + 1j, 3.117).growing_region(0.0)[1] == "P3"
    )  # no formula for it, but the numerical range of its equations


def test_a_disc_next_to_a_continuous_spectrum_is_looked_at_in_a_smaller_circle() -> None:
    """σ = 0, where C is singular, lies no farther away than the circle on which D would be bounded at first."""
    slab = st.scene("resistive-slab").problem
    mode = -0.271740110027234 + 0.962370673182837j  # σ² + η(k² + π²)σ + k²B² = 0
    proof = prove_disc(slab, mode, 1e-8)
    assert proof.count == 1
    with pytest.raises(st.ConvergenceError, match="C may be singular"):
        prove_disc(slab, mode, 1.2)


def test_intervals_of_a_parameter() -> None:
    """y″ + k y = σ y between walls: σ = k − n²π². For k to 2 one of them lies in the rectangle; at k = π² + 3 it leaves it."""
    string = st.equations(["y"], ["d(y,2) + k*y - sigma*y"], st.Conditions(0, ["y"]), st.Conditions(1, ["y"]), parameters={"k": 1.0})
    region = st.Rectangle(-20 - 4j, 3 + 4j)
    proof = prove_interval(string, "k", 0.0, 2.0, region)
    assert (proof.count, proof.lemmas[-1]) == (1, "E10")
    assert proof.statement.startswith("for every k from 0 to 2 exactly one eigenvalue lies in the rectangle")
    with pytest.raises(st.ConvergenceError, match=r"1 at k = 12\.5 and 0 at k = 13: one crosses its boundary between"):
        prove_interval(string, "k", 12.5, 13.0, region)
    with pytest.raises(st.InputError, match="taylor is no parameter"):
        prove_interval(string, "taylor", 0.0, 5.0, region)


def test_a_term_that_vanishes_for_the_value_at_hand_alone_is_kept() -> None:
    """√k − 1 is zero for the k = 1 that stands in the equations and for no other: no reduction with k left open leaves it out."""
    k, vanishes = open_parameter("k", 1), Vanishing(0.0, 1.0, {})
    assert not vanishes(function("sqrt", k) - number(1))
    assert vanishes(function("sqrt", k) ** 2 - k)


def test_a_root_of_a_parameter_is_enclosed_off_its_cut_only() -> None:
    """Beyond 0 √k is no analytic function of k: nothing finite comes out for a disc that holds it."""
    roots = st.equations(["y"], ["d(y,2) + sqrt(k)*y - sigma*y"], st.Conditions(0, ["y"]), st.Conditions(1, ["y"]), parameters={"k": 1.0})
    made = roots.varied("k")  # type: ignore[misc]
    with ctx.workprec(80):
        wide = {radius: acb(arb(1, radius), arb(0, radius)) for radius in (0.5, 1.5)}
        growths = [made(k).enclosure(80, acb(-9, 1)).growth(acb(-9, 1)) for k in wide.values()]
    assert [bool(growth.is_finite()) for growth in growths] == [True, False]


def test_convection_is_stable_over_an_interval() -> None:
    proof = prove_interval(st.gallery.benard(1000.0, 3.117), "rayleigh", 1630.0, 1631.0, floor=25.0)
    assert proof.count == 0
    assert proof.statement == "for every rayleigh from 1630 to 1631 no eigenvalue has Re σ ≥ 25.0"


def test_what_cannot_be_proved_says_why() -> None:
    with pytest.raises(st.InputError, match="closed form"):
        prove(st.problem(2, lambda z: (np.eye(2), np.eye(2)), st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]])), 0.0)
    given = st.equations(
        ["y"], ["d(y,2) - sigma*U*y"], st.Conditions(0, ["y"]), st.Conditions(1, ["y"]), given={"U": lambda z, order: 1.0 + 0 * z}
    )
    with pytest.raises(st.InputError, match="in equations"):
        prove(given, -9.87)
    with pytest.raises(st.InputError, match="no theorem"):
        prove_growing(st.ClosedProblem(EnclosedString()), 0.0)  # type: ignore[arg-type]
    with pytest.raises(st.InputError, match="digits"):
        prove(st.gallery.PlanePoiseuille(), MODE, digits=0)
    with pytest.raises(st.ConvergenceError, match="take a smaller disc"):
        prove_disc(st.ClosedProblem(EnclosedString()), -25.0, 14.0)  # type: ignore[arg-type]


@pytest.mark.slow
def test_all_modes_of_poiseuille_flow_that_grow() -> None:
    proof = prove_growing(st.gallery.PlanePoiseuille(half=True), -1e-3)
    assert proof.count == 1
    assert proof.statement == "exactly one eigenvalue has Re σ ≥ -0.001"


def test_no_enclosure_begins_beside_a_singular_point_or_takes_steps_without_end(monkeypatch: pytest.MonkeyPatch) -> None:
    walls = st.Conditions(0, ["y"]), st.Conditions(1, ["y"])
    with pytest.raises(st.ConvergenceError, match="no step is short enough for an enclosure at z = 0: the coefficients are singular"):
        prove_disc(st.equations(["y"], ["d(y,2) + 3*y/(z - 1/10**12)**2 - sigma*y"], *walls), -10, 1.0)
    monkeypatch.setattr(enclosure, "ENCLOSURE_STEPS", 1)
    with pytest.raises(st.ConvergenceError, match="the enclosure of D would need more than 1 steps at sigma"):
        prove_disc(st.equations(["y"], ["d(y,2) - sigma*y"], *walls), -1e6, 1.0)
