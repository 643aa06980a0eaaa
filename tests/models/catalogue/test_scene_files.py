"""models/catalogue/scenes: the equations of the gallery, their published values derived again from closed forms, and to forty digits."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import mpmath
import pytest
from mpmath import mp, mpf

import shootstab as st
from shootstab.cli.main import main
from shootstab.core.errors import InputError
from shootstab.core.scene_notes import Known, known
from shootstab.io.scenes import load
from shootstab.models.catalogue.scene_files import scene_files

WORKING = 45  # digits of the closed forms


def doubly_diffusive(s: Any) -> Any:
    """(σ/Pr + q)(σ + q)(σ + τq) q = a² [Ra (σ + τq) − Rs (σ + q)], q = π² + a²."""
    a, tau = mpf("2.2"), mpf("0.3")
    q = mp.pi**2 + a * a
    return (s / 7 + q) * (s + q) * (s + tau * q) * q - a * a * (1200 * (s + tau * q) - 300 * (s + q))


def eady(s: Any) -> Any:
    """(c − 1/2)² = 1/4 − coth(k)/k + 1/k²."""
    k = mpf("1.2")
    return (1j * s / k - mpf(1) / 2) ** 2 - (mpf(1) / 4 - mp.coth(k) / k + 1 / k**2)


def holmboe(s: Any) -> Any:
    """w = −Σ_j [w′]_j e^{−k|z − z_j|}/2k of three sheets, each with its jump of w′."""
    k, sheets = mpf("1.2"), (-1, 0, 1)
    jumps = [1j * k / (s - 1j * k), k**2 / s**2, -1j * k / (s + 1j * k)]
    M = mp.matrix(3, 3)
    for i, z in enumerate(sheets):
        for j, x in enumerate(sheets):
            M[i, j] = int(i == j) + jumps[j] * mp.exp(-k * abs(z - x)) / (2 * k)
    return mp.det(M)


def interfacial(s: Any) -> Any:
    """ρ₁ (σ + ikU₁)² coth kh₁ + ρ₂ (σ + ikU₂)² coth kh₂ = −gk (ρ₁ − ρ₂)."""
    k, light, U = mpf("1.3"), mpf("0.8"), mpf("0.7")
    return s**2 * mp.coth(k) + light * (s + 1j * k * U) ** 2 * mp.coth(2 * k) + k * (1 - light)


def maxwell(s: Any) -> Any:
    """With x = z + (1 + Wσ)/ikW the four solutions for w are (x + i/kW) e^{±kx} and e^{λx}, λ = k(−iW ± (1 + W²)^{1/2})."""
    k, W = mpf(1), mpf(2)
    M = mp.matrix(4, 4)
    for i, x in enumerate(z + (1 + W * s) / (1j * k * W) for z in (0, 1)):
        for j, rate in enumerate((k, -k)):
            y = x + 1j / (k * W)
            M[2 * i, j], M[2 * i + 1, j] = (f * mp.exp(rate * i) for f in (y, 1 + rate * y))
        for j, sign in enumerate((1, -1), 2):
            rate = k * (-1j * W + sign * mp.sqrt(1 + W * W))
            M[2 * i, j], M[2 * i + 1, j] = (f * mp.exp(rate * i) for f in (1, rate))
    return mp.det(M)


def two_layers(s: Any) -> Any:
    """The determinant of cubics in each layer, φ = φ′ = 0 at y = ∓1, with Yih's conditions at y = 0, a → 0, times c − 1."""
    c, m = 1j * s / mpf("1e-5"), mpf(3)
    cubics = [[(1, 2, 2, 0), (1, 3, 6, 6)], [(1, -2, 2, 0), (-1, 3, -6, 6)]]  # φ, φ′, φ″, φ‴ of (y ± 1)² and (y ± 1)³
    M = mp.matrix(4, 4)
    for j, (below, above) in enumerate(zip(*cubics, strict=True)):
        slip = mpf(2) / 3 / (c - 1)  # U′ above less U′ below, over c − U
        M[0, j], M[1, j], M[2, j], M[3, j] = below[0], below[1] - slip * below[0], below[2], below[3]
        M[0, j + 2], M[1, j + 2], M[2, j + 2], M[3, j + 2] = -above[0], -above[1], -m * above[2], -m * above[3]
    return (c - 1) * mp.det(M)


def internal_wave(s: Any) -> Any:
    """y = k(c − z): √y times modified Bessel functions of the order ν = (1/4 − J)^{1/2}."""
    c, nu = 1j * s, mp.sqrt(mpf(1) / 4 - 5)
    I = mp.besseli  # noqa: E741
    return I(nu, c - 1) * I(-nu, c) - I(-nu, c - 1) * I(nu, c)


CLOSED_FORMS: dict[str, Callable[[Any], Any]] = {
    "davies": lambda s: s**4 + 625,
    "bistable-front": lambda s: s * (s + mpf(3) / 8),
    "double-diffusion": doubly_diffusive,
    "eady": eady,
    "holmboe": holmboe,
    "interfacial-waves": interfacial,
    "kdv-soliton": lambda s: s**2 - mpf(1) / 8,
    "kink": lambda s: s**2 + mpf(3) / 2,
    "legendre": lambda s: s - 4 * 5,
    "maxwell-couette": maxwell,
    "mri": lambda s: s - mpf(3) / 4,
    "nls-soliton": lambda s: s * (s + mpf("0.6")),
    "poschl-teller": lambda s: s - mpf("0.2") ** 2,
    "resistive-slab": lambda s: s**2 + mpf("0.05") * (1 + mp.pi**2) * s + 1,
    "taylor-goldstein": internal_wave,
    "two-layers": two_layers,
    "water-waves": lambda s: s**2 + mp.tanh(1),
}
MANY = (
    *(("eady", 40), ("mri", 40), ("taylor-goldstein", 40), ("water-waves", 40)),
    *(("holmboe", 20), ("interfacial-waves", 20), ("double-diffusion", 20)),
)


def published(name: str) -> Known:
    found = known(scene_files()[name].tables)
    assert found is not None
    return found


def exact(name: str) -> Any:
    """The zero of the closed form next to the published value, at the working precision."""
    start = mpmath.mpc(*published(name).value)
    return mp.findroot(CLOSED_FORMS[name], (start * (1 + mpf(10) ** -8), start), solver="muller" if start.imag else "secant")


@pytest.mark.parametrize("name", CLOSED_FORMS)
def test_published_values_are_those_of_the_closed_forms(name: str) -> None:
    with mpmath.workdps(WORKING):
        value = exact(name)
        size = max(abs(value.real), abs(value.imag))
        assert abs(value - mpmath.mpc(*published(name).value)) < size * mpf(10) ** (1 - published(name).digits)


@pytest.mark.parametrize(("name", "digits"), MANY)
def test_many_digits_of_what_is_known_in_closed_form(name: str, digits: int) -> None:
    with mpmath.workdps(WORKING):
        value = exact(name)
        mode = st.refine(scene_files()[name].problem(), complex(value), digits=digits)
        assert mode.converged
        assert abs(mode.sigma - value) < mpf(10) ** (1 - digits)


@pytest.mark.parametrize("name", scene_files())
def test_two_derivations_agree(name: str) -> None:
    """The collocation of the equations as they stand has the mode; to fewer digits near a continuous spectrum, and at infinity."""
    problem = scene_files()[name].problem()
    assert problem.pseudospectral is not None
    value = published(name).double
    bounded = all(problem.statement.finite)
    allowed = 1e-3 if name in ("maxwell-couette", "oldroyd-couette") else 1e-9 if bounded else 1e-6
    found = problem.pseudospectral.ways["qz"](60 if bounded else 80, value)[0]
    assert abs(found - value) < max(allowed, 10.0 ** (1 - published(name).digits)) * abs(value)


def test_a_scene_file_says_what_it_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The file of a built-in scene is a scene file like any other; what it says of itself is told."""
    folder = Path(__file__).parents[3] / "shootstab" / "models" / "catalogue" / "scenes"
    assert {path.stem for path in folder.iterdir()} == set(scene_files())
    path = tmp_path / "mine.toml"
    path.write_bytes((folder / "taylor-couette.toml").read_bytes())
    here, there = load(str(path)), load("taylor-couette")
    assert here.details == there.details
    assert here.description == there.description == "Taylor vortices at the radius ratio 1/2, outer cylinder at rest"
    assert "1 < r < 2, all modes; order 6 in u, v, w, p; lengths the gap" in here.heading
    assert main(["refine", str(path), "--guess", "68", "--json", "-"]) == 0
    assert abs(float(json.loads(capsys.readouterr().out)["sigma"]["re"]) - 68.186268346) < 1e-8


WATER = (Path(__file__).parents[3] / "shootstab/models/catalogue/scenes/water-waves.toml").read_text(encoding="utf-8")
MISTAKES = (
    ("order = 2", "order = 3", r"\[about\] order = 3: the equations are found to be of order 2"),
    ("order = 2", 'order = "2"', r"\[about\] order = '2': allowed is an integer"),
    ("order = 2", "order = true", r"\[about\] order = True: allowed is an integer"),
    ("[about]", "[notes]", r"unknown key 'notes': allowed is \[problem\], and beside it \[about\] and \[published\]"),
    ("scales =", "units =", r"\[about\] has the unknown key 'units': allowed are description, order, scales, eigenvalue"),
    ('"0.8726936208978296915436"', "0.87", r"\[published\] value = .*: allowed is \[.re., .im.\], decimals as strings"),
    ("digits = 22", "digits = 0", r"\[published\] digits = 0: allowed is a positive integer"),
    ("digits = 22\n", "", r"\[published\] lacks the key digits"),
)


@pytest.mark.parametrize(("old", "new", "told"), MISTAKES)
def test_what_is_wrong_in_it_is_named(tmp_path: Path, old: str, new: str, told: str) -> None:
    assert old in WATER
    path = tmp_path / "mine.toml"
    path.write_text(WATER.replace(old, new), encoding="utf-8")
    with pytest.raises(InputError, match=told):
        load(str(path))
