"""Floor 4, spectral: the mathematics first, then published numbers, then independence from the shooting path."""

from __future__ import annotations

import ast
from pathlib import Path

import numpy as np
import pytest

import shootstab
from shootstab.core.errors import ConvergenceError, InputError
from shootstab.models.chute import chute_collocation as chute
from shootstab.models.chute import collocation_profile as profile
from shootstab.models.chute.family import steady_by_flux
from shootstab.models.chute.parameters import Chute
from shootstab.models.chute.steady_flow import Flow, descend
from shootstab.models.gallery import poiseuille_collocation as orr_sommerfeld
from shootstab.spectral import chebyshev, inverse, qz

CHUTE = Chute(e=0.8, e_w=0.8, r=0.6, tan_theta=0.3)
WAVES = {"high": (0.0, 0.0100), "mid": (0.0, 0.0125), "low": (0.011, 0.0)}
# Woodhouse & Hogg (2010) print 0.00397, 0.00102 and 0.00727 − 0.0119i (low: one unit off in the third digit, guide/theory.md 1.1)
PRINTED = {"high": 0.00397, "mid": 0.00102, "low": 0.00727 - 0.0119j}
FIVE_DIGITS = {"high": 0.0039705, "mid": 0.0010229, "low": 0.0072756 - 0.0118650j}
SIGMA = {"high": 0.003970504640, "mid": 0.001022920820, "low": 0.007275583546 - 0.011865047381j}
FIG2, FIG2_SIGMA = (5e-4, 0.0), 0.001692431201 - 0.001566238810j
# S. A. Orszag (1971), to 14 digits by many since
POISEUILLE = 0.23752648882047 + 0.00373967062298j


@pytest.fixture(scope="module")
def flows() -> dict[str, Flow]:
    return {branch: steady_by_flux(CHUTE, 3.0, branch) for branch in WAVES}


# --- Chebyshev


@pytest.mark.parametrize("degree", [4, 7, 16, 33])
def test_differentiation_is_exact_on_polynomials(degree: int) -> None:
    grid = chebyshev.interval(degree, 0.5, 2.0)
    p = np.polynomial.Polynomial(np.random.default_rng(degree).standard_normal(degree + 1), domain=[0.5, 2.0])
    assert np.allclose(grid.D @ p(grid.z), p.deriv()(grid.z), rtol=0, atol=1e-13 * degree**4)
    assert np.abs(grid.D @ np.ones(degree + 1)).max() < 1e-13 * degree**2


def test_derivatives_of_a_smooth_function_lose_few_digits() -> None:
    grid = chebyshev.interval(64)
    assert np.abs(grid.D @ np.exp(grid.z) - np.exp(grid.z)).max() < 1e-11


@pytest.mark.parametrize("degree", [5, 12])
def test_coefficients_and_values_are_inverse(degree: int) -> None:
    values = np.random.default_rng(0).standard_normal((3, degree + 1))
    a = chebyshev.coefficients(values)
    assert np.allclose(chebyshev.values(a), values, rtol=0, atol=1e-14)
    y = np.linspace(-1, 1, 11)
    expected = np.polynomial.chebyshev.chebval(y, a.T)
    assert np.allclose(values @ chebyshev.interpolation(degree, y).T, expected, rtol=0, atol=1e-13)


def test_roots_and_extrema() -> None:
    T9 = np.polynomial.Chebyshev.basis(9)
    assert np.abs(T9(chebyshev.roots(8))).max() < 1e-14
    assert np.allclose(np.abs(T9(chebyshev.extrema(9))), 1, rtol=0, atol=1e-14)


@pytest.mark.parametrize("z_half", [3.0, 10.0, 13.0])
@pytest.mark.parametrize("focus", [0.0, 3.0])
def test_map_of_malik(z_half: float, focus: float) -> None:
    grid = chebyshev.malik(80, 20.0, z_half, focus)
    assert grid.z[0] == 0.0 and grid.z[-1] == 20.0 and (np.diff(grid.z) > 0).all()
    assert grid.z[40] == pytest.approx(z_half, rel=1e-14)
    assert np.allclose(grid.D @ np.exp(-grid.z / 10), -np.exp(-grid.z / 10) / 10, rtol=0, atol=1e-8)
    if focus == 0.0 and z_half != 10.0:  # (2.18)–(2.19), singular at z_half = z_max/2
        a, b = 20 * z_half / (2 * z_half - 20), z_half / (2 * z_half - 20)
        assert np.allclose(2 * (a - grid.z * b) / (a - grid.z) - 1, chebyshev.extrema(80), rtol=0, atol=1e-13)


# --- the pencil of the chute


def test_steady_flow_shifted_in_z_solves_the_linear_equations(flows: dict[str, Flow]) -> None:
    """The equations do not contain z: ∂(ν0, u0, T0)/∂z is a perturbation with σ = K = 0. Checks every z-derivative in A."""
    flow, M = flows["high"], 60
    window = chute.window(flow, *WAVES["high"])
    s = profile.profile(flow, chebyshev.malik(M, *window).z)
    A, _ = chute.assemble(flow, 0.0, 1e-30, M, *window)
    zero = np.zeros(M + 1)
    terms = A * np.concatenate([s.log_nu_z, s.u_z, zero, zero, s.T_z])
    inner = np.arange(5 * M + 5).reshape(5, -1)[:, 1:-1].ravel()
    assert np.abs(terms.sum(axis=1))[inner].max() < 1e-8 * np.abs(terms).max()


def test_neighbouring_steady_flow_solves_the_linear_equations(flows: dict[str, Flow]) -> None:
    """∂/∂T_∞ of the family, at fixed z, has σ = K = 0 too, and at the base it satisfies Richman's conditions, u0 included."""
    M, T, h = 60, flows["high"].far_temperature, 1e-4
    window = chute.window(flows["high"], *WAVES["high"])
    z = chebyshev.malik(M, *window).z
    A, _ = chute.assemble(flows["high"], 0.0, 1e-30, M, *window)
    near = [profile.profile(descend(CHUTE, T * (1 + k * h)), z) for k in (-2, -1, 1, 2)]
    log_nu, u, temperature = (
        np.array([f(s) for s in near]).T @ np.array([1, -8, 8, -1]) / (12 * h)
        for f in (lambda s: np.log(s.nu), lambda s: s.u, lambda s: s.T)
    )
    zero = np.zeros(M + 1)
    terms = A * np.concatenate([log_nu, u, zero, zero, temperature])
    rows = np.arange(5 * M + 5).reshape(5, -1)[:, :-1].ravel()
    assert np.abs(terms.sum(axis=1))[rows].max() < 1e-8 * np.abs(terms).max()


def test_pencil_is_real_without_kx_and_has_the_papers_size(flows: dict[str, Flow]) -> None:
    A, B = chute.assemble(flows["high"], *WAVES["high"], 20)
    assert A.dtype == B.dtype == float and A.shape == B.shape == (105, 105)
    A, B = chute.assemble(flows["high"], *FIG2, 20)
    assert A.dtype == B.dtype == complex
    assert np.abs(A).max(axis=1) == pytest.approx(np.ones(105))
    assert (np.abs(B).sum(axis=1) == 0).sum() == 8


def test_directions_along_the_base_are_alike_without_shear_terms(flows: dict[str, Flow]) -> None:
    """k → −k conjugates the pencil: σ(−kx) = conj σ(kx), and ky enters by its square."""
    flow = flows["mid"]
    oblique = chute.refine(flow, 0.002, 0.012, SIGMA["mid"], 50).sigma
    assert chute.refine(flow, -0.002, 0.012, oblique.conjugate(), 50).sigma == pytest.approx(oblique.conjugate(), rel=1e-9)
    assert chute.refine(flow, 0.002, -0.012, oblique, 50).sigma == pytest.approx(oblique, rel=1e-9)


@pytest.mark.parametrize(
    "arguments",
    [(0.0, 0.0, 20), (0.0, np.nan, 20), (0.0, 0.01, 3), (0.0, 0.01, 20, 100.0, 120.0), (0.0, 0.01, 20, 100.0, 20.0, -1.0)],
)
def test_bad_input_is_refused(flows: dict[str, Flow], arguments: tuple[float, ...]) -> None:
    with pytest.raises(InputError, match="allowed"):
        chute.assemble(flows["high"], *arguments)  # type: ignore[arg-type]


# --- the paper's modes


@pytest.mark.parametrize("scene", WAVES)
def test_modes_of_the_paper(flows: dict[str, Flow], scene: str) -> None:
    spectrum = chute.spectrum(flows[scene], *WAVES[scene], M=60)
    leading = spectrum.eigenvalues[0]
    assert leading == pytest.approx(SIGMA[scene], rel=3e-7)
    assert abs(leading - FIVE_DIGITS[scene]) < 0.8e-7
    assert abs(leading.real - PRINTED[scene].real) < 1e-5 and abs(leading.imag - PRINTED[scene].imag) < 5e-5
    assert spectrum.eigenvalues[1].real < 0.0 and spectrum.truncation == 60
    assert (np.diff(spectrum.eigenvalues.real) <= 0).all()
    assert spectrum.drift[0] < 1e-5 * abs(leading) and 0.0 < spectrum.tail[0] < 1e-3


@pytest.mark.parametrize(("scene", "M"), [("high", 60), ("mid", 80), ("low", 100)])
def test_converged_values(flows: dict[str, Flow], scene: str, M: int) -> None:
    assert chute.refine(flows[scene], *WAVES[scene], FIVE_DIGITS[scene], M).sigma == pytest.approx(SIGMA[scene], rel=1e-9)


def test_convergence_is_exponential(flows: dict[str, Flow]) -> None:
    errors = [abs(chute.refine(flows["high"], *WAVES["high"], SIGMA["high"], M).sigma / SIGMA["high"] - 1) for M in (20, 30, 40)]
    assert errors[1] < errors[0] / 10 and errors[2] < errors[1] / 5
    assert errors[2] < 3e-8


def test_the_papers_own_map_converges_too(flows: dict[str, Flow]) -> None:
    flow = flows["high"]
    z_max, z_half, focus = chute.window(flow, *WAVES["high"], focus=0.0)
    assert focus == 0.0
    assert chute.refine(flow, *WAVES["high"], SIGMA["high"], 60, z_max, z_half, 0.0).sigma == pytest.approx(SIGMA["high"], rel=3e-9)


def test_isotropic_wall(flows: dict[str, Flow]) -> None:
    """guide/theory.md 1.3: ∂v/∂y in S_z moves mid to 0.0010251."""
    chute_isotropic = Chute(e=0.8, e_w=0.8, r=0.6, tan_theta=0.3, wall="isotropic")
    flow = descend(chute_isotropic, flows["mid"].far_temperature)
    assert abs(chute.refine(flow, *WAVES["mid"], 0.0010251, 60).sigma - 0.0010251) < 0.6e-7


def test_truncated_far_field(flows: dict[str, Flow]) -> None:
    """Kept modes do not know where the domain ends, from ν0(z_m) = 1e−10 on; small K included."""
    flow = flows["high"]
    for kx, ky in (WAVES["high"], FIG2):
        short, long = (chute.spectrum(flow, kx, ky, M=44, z_max=profile.truncation_height(flow, nu)) for nu in (1e-10, 1e-13))
        assert len(short.eigenvalues) > 6
        for sigma in short.eigenvalues[:6]:
            assert np.abs(long.raw - sigma).min() < 3e-5 * abs(sigma)
        assert short.eigenvalues[0] == pytest.approx(long.eigenvalues[0], rel=1e-6)
    assert np.exp(flow.states_at(profile.truncation_height(flow, 1e-11))[0].real) == pytest.approx(1e-11, rel=1e-6)


def test_complex_spectrum_of_figure_2(flows: dict[str, Flow]) -> None:
    """The raw spectrum holds a balloon around σ_c(z) of (2.13); none of it is kept."""
    spectrum = chute.spectrum(flows["high"], *FIG2)
    assert spectrum.eigenvalues[0] == pytest.approx(FIG2_SIGMA, rel=1e-8)
    near_top = np.abs(spectrum.raw + 1j * FIG2[0] * flows["high"].far_velocity) < 5e-4
    assert near_top.sum() > 10
    kept = np.abs(spectrum.eigenvalues + 1j * FIG2[0] * flows["high"].far_velocity) < 5e-4
    assert not kept.any()


def test_cross_stream_modes_separate_without_ky(flows: dict[str, Flow]) -> None:
    both = chute.spectrum(flows["high"], *FIG2, M=30, filtered=False)
    plane = chute.spectrum(flows["high"], *FIG2, M=30, filtered=False, cross_stream=False)
    assert len(both.raw) - len(plane.raw) == 29
    from scipy.linalg import eigvals

    whole = eigvals(*chute.assemble(flows["high"], *FIG2, 30))
    slow = both.raw[np.abs(both.raw) < 3]
    assert (np.abs(whole[np.isfinite(whole)][:, None] - slow).min(axis=0) < 1e-6 * np.abs(slow) + 1e-9).mean() > 0.8


def test_raw_spectrum_costs_one_qz(flows: dict[str, Flow], monkeypatch: pytest.MonkeyPatch) -> None:
    degrees: list[int] = []
    original = chute.assemble
    monkeypatch.setattr(chute, "assemble", lambda *a: degrees.append(a[3]) or original(*a))
    raw = chute.spectrum(flows["high"], *WAVES["high"], M=30, filtered=False)
    assert degrees == [30] and raw.larger_truncation == 0
    assert len(raw.raw) == len(raw.eigenvalues) and np.isnan(raw.drift).all() and np.isnan(raw.tail).all()


# --- inverse iteration


def test_inverse_iteration_agrees_with_qz(flows: dict[str, Flow]) -> None:
    for kx, ky in (WAVES["high"], FIG2):
        spectrum = chute.spectrum(flows["high"], kx, ky, M=40)
        for sigma in spectrum.eigenvalues[:3]:
            result = chute.refine(flows["high"], kx, ky, sigma * 1.001, 40)
            assert result.sigma == pytest.approx(sigma, rel=3e-9)
            assert result.residual < 1e-13 and result.iterations < 15


def test_inverse_iteration_on_a_known_pencil() -> None:
    """A = VΛV⁻¹ with known eigenvalues; the step falls as the cube."""
    V = np.random.default_rng(1).standard_normal((30, 30))
    A = V @ np.diag(np.arange(1.0, 31.0)) @ np.linalg.inv(V)
    result = inverse.refine(A, np.eye(30), 7.2)
    assert result.sigma == pytest.approx(7.0, rel=1e-11) and result.sigma.imag == 0.0 and result.iterations <= 8
    assert np.allclose(A @ result.vector, 7 * result.vector, rtol=0, atol=1e-9)


def test_inverse_iteration_says_when_it_does_not_settle() -> None:
    with pytest.raises(ConvergenceError, match="did not settle"):
        inverse.refine(np.diag(np.arange(1.0, 5.0)) + np.ones((4, 4)), np.eye(4), 2.4, max_iterations=2)


# --- plane Poiseuille


@pytest.mark.parametrize("even", [False, True])
def test_plane_poiseuille(even: bool) -> None:
    spectrum = orr_sommerfeld.spectrum(10000.0, 1.0, 80, even=even)
    assert abs(1j * spectrum.eigenvalues[0] - POISEUILLE) < 1e-10
    assert len(spectrum.eigenvalues) >= 10


def test_poiseuille_even_modes_are_modes_of_the_channel() -> None:
    whole, even = (orr_sommerfeld.spectrum(2000.0, 1.2, M, even=e) for M, e in ((64, False), (65, True)))
    assert all(np.abs(whole.raw - sigma).min() < 1e-5 * abs(sigma) for sigma in even.eigenvalues)
    assert len(whole.eigenvalues) > len(even.eigenvalues) > 5


def test_poiseuille_refuses_bad_input() -> None:
    with pytest.raises(InputError, match="reynolds"):
        orr_sommerfeld.spectrum(-1.0, 1.0, 40)
    with pytest.raises(InputError, match="M ="):
        orr_sommerfeld.spectrum(1e4, 1.0, 2)


# --- filtering


def test_filter_drops_what_does_not_decay() -> None:
    smooth = np.exp(chebyshev.extrema(40))
    rough = np.random.default_rng(0).standard_normal(41)
    tails = qz.tails(np.array([[smooth, smooth], [smooth, rough], [smooth, 1e-12 * rough]]))
    assert tails[0] < 1e-13 < 1e-2 < tails[1] and tails[2] < 1e-8
    with pytest.raises(InputError, match="tolerance"):
        qz.spectrum(lambda M: (np.eye(M), np.eye(M)), 4, lambda x: x, drift_tolerance=0.0)


# --- independence

ROOT = Path(shootstab.__file__).parent
ALLOWED = {
    "shootstab.models.chute.constitutive",
    "shootstab.models.chute.balance",
    "shootstab.models.chute.descent",
    "shootstab.models.chute.steady_flow",
    "shootstab.models.chute.parameters",
    "shootstab.models.chute.family",
    "shootstab.models.chute.registry",
    # the steady flow's own integration, of formulas that are recorded: programs of numbers, whatever they stand for
    "shootstab.kernels.taylor_pieces",
    "shootstab.kernels.recorded_programs",
}
OUTSIDE = {"numpy", "scipy", "__future__", "ast", "collections", "dataclasses", "functools", "itertools", "math", "pathlib", "typing"}


def _imports(path: Path) -> set[str]:
    """Modules that a file imports, those inside functions included; `from package import module` names the module."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0 and node.module is not None
            inside = ROOT.joinpath(*node.module.split(".")[1:])
            if node.module.startswith("shootstab") and inside.is_dir():
                found |= {f"{node.module}.{alias.name}" for alias in node.names}
            else:
                found.add(node.module)
    return found


def test_reference_shares_only_constitutive_law_and_steady_flow() -> None:
    """Neither directly nor through what it imports does the reference see the shooting path."""
    twins = [*(ROOT / "models" / "chute").glob("*collocation*.py"), ROOT / "models" / "gallery" / "poiseuille_collocation.py"]
    own = {".".join(p.relative_to(ROOT.parent).with_suffix("").parts): p for p in [*(ROOT / "spectral").glob("*.py"), *twins]}
    assert len(own) > 6
    direct = set().union(*map(_imports, own.values()))
    assert {name.split(".")[0] for name in direct} <= OUTSIDE | {"shootstab"}
    waiting, seen = {name for name in direct if name.startswith("shootstab")}, set()
    while waiting:
        name = waiting.pop()
        seen.add(name)
        waiting |= {n for n in _imports(ROOT.joinpath(*name.split(".")[1:]).with_suffix(".py")) if n.startswith("shootstab")} - seen
    foreign = {name for name in seen if not name.startswith(("shootstab.spectral.", "shootstab.core.")) and name not in own}
    assert foreign <= ALLOWED
