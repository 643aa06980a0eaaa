"""problems/singular_curve: the continuous spectrum of the inside from the pencil, and the verdicts that rest on it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import shootstab as st
from shootstab.core.errors import InputError, Undecidable
from shootstab.problems.pencil_function import PencilFunction
from shootstab.problems.singular_curve import SingularCurve, singular_curves

LINE = np.linspace(0.0, 1.0, 65).astype(np.complex128)
FIXED = [[1.0, 0.0]]


def planted(C0: Any, C1: Any, seed: int = 1) -> PencilFunction:
    """C0(z), C1(z) behind two constant random unitary matrices, so that nothing is to be seen in the entries."""
    n = len(C0(0.5))
    rng = np.random.default_rng(seed)
    S, T = (np.linalg.qr(rng.normal(size=(n, n)) + 1j * rng.normal(size=(n, n)))[0] for _ in range(2))

    def pencil(z: complex) -> tuple[Any, ...]:
        return S @ np.asarray(C0(z)) @ T, S @ np.asarray(C1(z)) @ T, np.eye(n), np.eye(n)

    return PencilFunction(n, pencil)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("multiplicity", [1, 2, 3])
def test_one_curve_of_any_multiplicity_at_real_and_complex_z(scale: float, multiplicity: int) -> None:
    """σ_c = scale (1 + z² − i z), beside eigenvalues at infinity, one of them defective."""

    def C0(z: complex) -> Any:
        curve = -scale * (1 + z * z - 1j * z)
        return np.diag([1.0, 1.0, *[curve] * multiplicity])

    def C1(z: complex) -> Any:
        moving = np.diag([0.0, 0.0, *[1.0] * multiplicity])
        moving[0, 1] = 1 / scale
        return moving

    curve = singular_curves(planted(C0, C1), LINE)
    assert isinstance(curve, SingularCurve)
    assert curve.multiplicity == multiplicity
    z = np.array([0.1, 0.7, 0.3 + 0.2j, -0.4j])
    np.testing.assert_allclose(curve(z), scale * (1 + z * z - 1j * z), rtol=1e-8)


def test_no_curve() -> None:
    """C without σ; with σ where it cannot matter, as in [[1, 0], [−σ, 1]]; and in equations without derivative beside it."""
    for C0, C1 in (
        (np.eye(2), np.zeros((2, 2))),
        (np.eye(2), np.array([[0, 0], [-1.0, 0]])),
        (np.eye(3), np.eye(3, k=1)),
    ):
        assert singular_curves(planted(lambda z, C=C0: C, lambda z, C=C1: C), LINE) == ()


def test_several_curves_are_followed_one_by_one() -> None:
    """±i(1 + z) and 3 + z, which do not meet: in each its own values, in the order of z."""
    found = singular_curves(
        planted(lambda z: -np.diag([1j * (1 + z), -1j * (1 + z), 3 + z, -1.0]), lambda z: np.diag([1.0, 1, 1, 0])), LINE
    )
    assert isinstance(found, tuple)
    expected = [1j * (1 + LINE), -1j * (1 + LINE), 3 + LINE]
    assert len(found) == 3
    for curve in found:
        assert min(np.abs(curve - e).max() for e in expected) < 1e-10


def test_a_curve_that_no_path_leads_around_is_given_by_its_values() -> None:
    """Constant, or of a pencil that is not analytic or takes real z only."""

    def interpolated(z: complex) -> Any:
        if isinstance(z, complex):
            raise TypeError("real z only")
        return -np.diag([np.interp(z, [0, 1], [1, 2]), 1.0])

    for C0 in (lambda z: -np.diag([2.0, 1.0]), lambda z: -np.diag([1 + abs(z - 0.5), 1.0]), interpolated):
        found = singular_curves(planted(C0, lambda z: np.diag([1.0, 0.0])), LINE)
        assert isinstance(found, tuple)
        assert len(found) == 1
        np.testing.assert_allclose(found[0], [-complex(C0(z)[0, 0]) for z in LINE.real.tolist()], rtol=1e-9)


# problems, with and without the word


def alfven(continuum: Any) -> st.LinearProblem:
    """((λ + ω²) y′)′ = k² (λ + ω²) y with ω² = 1 + z, λ = σ²: nothing but the continuous spectrum −2 ≤ λ ≤ −1."""

    def pencil(z: complex) -> tuple[Any, ...]:
        return np.diag([1 + z, 1]), np.diag([1, 0]), np.array([[0, 1], [4 * (1 + z), 0]]), np.array([[0, 0], [4, 0]])

    return st.problem(2, pencil, st.Wall(0, FIXED), st.Wall(1, FIXED), continuum=continuum)


def shear(continuum: Any) -> st.LinearProblem:
    """Rayleigh's equation for tanh y between walls at ±3, α = 0.9."""
    a = 0.9

    def pencil(y: complex) -> tuple[Any, ...]:
        U = np.tanh(y)
        D0 = np.array([[0, 1], [1j * a * U * (a * a - 2 * (1 - U * U)), 0]])
        return np.diag([1, 1j * a * U]), np.diag([0, 1]), D0, np.array([[0, 0], [a * a, 0]])

    return st.problem(2, pencil, st.Wall(-3, FIXED), st.Wall(3, FIXED), continuum=continuum)


def test_the_same_verdicts_with_and_without_continuum() -> None:
    cases = (
        (alfven, lambda z: -1 - z, [-1.5, -1.2000001, -1.7 + 1e-9j, -0.5, -3.0, -1.5 + 0.3j]),
        (shear, lambda y: -0.9j * np.tanh(y), [0.0375, 0.3j, 0.1 + 0.1j]),
    )
    for make, curve, claims in cases:
        told, found = make(curve), make(None)
        z = np.array([0.2, 0.6 + 0.1j])
        np.testing.assert_allclose(found.continuum(z), told.continuum(z), rtol=1e-12)
        verdicts = [
            [v.verdict for v in st.verify(p, claims, digits=4, region=st.Rectangle(0.5 - 1j, 1 + 1j)).verdicts] for p in (told, found)
        ]
        assert verdicts[0] == verdicts[1]
        assert "unresolved" not in verdicts[1]


def test_modes_next_to_the_continuum_are_found_without_the_word() -> None:
    modes = [st.refine(shear(c), 0.0375, rtol=1e-9) for c in (lambda y: -0.9j * np.tanh(y), None, False)]
    for mode in modes[1:]:
        assert abs(mode.sigma - modes[0].sigma) <= mode.error + modes[0].error
    assert modes[1].path != "real"
    assert modes[2].path == "real"


def test_two_curves_are_refused_and_named() -> None:
    """(σ² + ω²) as a first-order system: σ = ±i(1 + z). A region that neither enters is counted, one that one enters is not."""

    def pencil(z: complex) -> tuple[Any, ...]:
        w = 1 + z
        C0, C1 = np.diag([1.0, 1j * w, -1j * w]).astype(complex), np.diag([0.0, 1, 1])
        D0 = np.array([[0, 1, 1], [1, 0, 0], [1, 0, 0]], dtype=complex)
        return C0, C1, D0, np.diag([0.0, 1.0, 1.0])

    problem = st.problem(3, pencil, st.Wall(0, [[1, 0, 0]]), st.Wall(1, [[1, 0, 0], [0, 1, 1]]))
    assert len(problem.crossings) == 2
    with pytest.raises(Undecidable, match="continuous spectrum"):
        st.count(problem, st.Disc(1.5j, 0.1))
    assert st.verify(problem, [1.5j], region=st.Rectangle(1 - 0.1j, 2 + 0.1j)).verdicts[0].verdict == "continuum"


@pytest.mark.parametrize("wrong", [True, 0.3j, "none"])
def test_a_continuum_that_is_none(wrong: Any) -> None:
    with pytest.raises(InputError, match="a function of z, or False"):
        alfven(wrong)
