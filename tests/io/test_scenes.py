"""io/scenes.py: names, TOML files and module:object, and every way to get them wrong."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from shootstab.by_name import scene_of
from shootstab.core.errors import InputError, NoFlowError
from shootstab.io.scenes import built_in, load
from shootstab.models.chute.chute_scene import GROWTH_UNIT
from shootstab.models.gallery.poiseuille import PlanePoiseuille

GOOD = """
[flow]
e = 0.8
e_w = 0.8
r = 0.6
tan_theta = 0.3
far_temperature = 7.0
[wave]
kx = 0.0
ky = 0.01
"""


def write(folder: Path, text: str | bytes, name: str = "scene.toml") -> str:
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return str(path)


def test_the_papers_scenes_are_the_papers() -> None:
    # Woodhouse & Hogg 2010: Q0 = 3, e = e_w = 0.8, r = 0.6, tanθ = 0.3, and the most unstable wavenumbers
    waves = {"high": (0.0, 0.01), "mid": (0.0, 0.0125), "low": (0.011, 0.0), "fig2": (5e-4, 0.0)}
    temperatures = []
    for name, (kx, ky) in waves.items():
        scene = load(name)
        assert scene.flow is not None
        problem: Any = scene.problem
        assert (problem.kx, problem.ky) == (kx, ky)
        chute = scene.flow.chute
        assert (chute.e, chute.e_w, chute.r, chute.tan_theta, chute.nu_max) == (0.8, 0.8, 0.6, 0.3, 0.62)
        assert scene.flow.mass_flux == pytest.approx(3.0, rel=1e-11)
        assert scene.unit == GROWTH_UNIT
        temperatures.append(scene.flow.far_temperature)
    high, mid, low, fig2 = temperatures
    assert high > mid > low
    assert fig2 == high


def test_poiseuille_has_no_grains() -> None:
    scene = load("poiseuille")
    assert scene.problem == PlanePoiseuille(10000.0, 1.0, half=False)
    assert scene.flow is None
    assert scene.unit == ""


def test_every_built_in_scene_says_what_it_is() -> None:
    for name, listed in built_in().items():
        scene = load(name)
        assert listed.scene.description
        assert scene.description == listed.scene.description
        assert scene.details == listed.details
        assert scene.problem.size >= 2
        equations: Any = getattr(scene.problem, "function", scene.problem)  # of a whole line, before it is folded
        written = getattr(scene.problem, "first_order", None)  # in equations
        assert scene.details.order == (equations.size if written is None else written.order)
        assert all(vars(scene.details).values())
        assert scene.heading.startswith(f"{name}: {scene.description} (")


@pytest.mark.parametrize(
    ("name", "wavenumber"),
    [
        ("low", ("kx", 0.011)),
        ("blasius", ("alpha", 0.179)),
        ("suction", ("alpha", 0.1555)),
        ("eady", ("k", 1.2)),
        ("pipe", ("a", 1.0)),  # exp(σt + iaz + inθ)
        ("mri", None),
        ("davies", None),
    ],
)
def test_the_streamwise_wavenumber_of_a_scene(name: str, wavenumber: tuple[str, float] | None) -> None:
    scene = load(name)
    assert scene.wavenumber == wavenumber
    assert scene_of(scene.problem).wavenumber == (wavenumber if name in ("low", "eady") else None)


def test_of_two_wavenumbers_none_is_taken(tmp_path: Path) -> None:
    """α may be an expansion as well; the words on the eigenvalue say which it is."""
    lines = '[problem]\nparameters = { alpha = 2, k = 3 }\nunknowns = ["u"]\nequations = ["d(u,2) - alpha*k*u = sigma*u"]\n'
    lines += 'left = { at = 0, conditions = ["u"] }\nright = { at = 1, conditions = ["u"] }\n'
    (tmp_path / "own.toml").write_text(lines)
    assert load(str(tmp_path / "own.toml")).wavenumber is None
    (tmp_path / "own.toml").write_text(lines + '[about]\neigenvalue = "σ of exp(σt + ikx)"\n')
    assert load(str(tmp_path / "own.toml")).wavenumber == ("k", 3.0)


def test_scene_file(tmp_path: Path) -> None:
    scene = load(write(tmp_path, GOOD))
    assert scene.flow is not None
    assert scene.flow.far_temperature == 7.0
    problem: Any = scene.problem
    assert (problem.kx, problem.ky) == (0.0, 0.01)


def test_integers_are_numbers_too(tmp_path: Path) -> None:
    scene = load(write(tmp_path, GOOD.replace("7.0", "7").replace("kx = 0.0", "kx = 0")))
    assert scene.flow is not None
    assert scene.flow.far_temperature == 7.0


def test_optional_keys_reach_the_chute(tmp_path: Path) -> None:
    options = 'e = 0.8\nnu_max = 0.64\nradial = "carnahan-starling"\nwall = "isotropic"'
    scene = load(write(tmp_path, GOOD.replace("e = 0.8", options, 1)))
    assert scene.flow is not None
    chute = scene.flow.chute
    assert (chute.nu_max, chute.radial, chute.wall) == (0.64, "carnahan-starling", "isotropic")


def test_byte_order_mark_and_windows_lines(tmp_path: Path) -> None:
    scene = load(write(tmp_path, b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").encode()))
    assert scene.flow is not None


def test_gallery_file(tmp_path: Path) -> None:
    path = write(tmp_path, '[problem]\nname = "poiseuille"\nreynolds = 5772.22\nalpha = 1.02\nhalf = false\n')
    assert load(path).problem == PlanePoiseuille(5772.22, 1.02, half=False)


GALLERY = '[problem]\nname = "poiseuille"\nreynolds = 1e4\nalpha = 1\n'
WRONG = {
    # what is wrong: (text, words that the line must hold)
    "unknown key": (GOOD.replace("r = 0.6", "r = 0.6\nrough = 1"), ("'rough'", "allowed", "tan_theta")),
    "unknown key in wave": (GOOD + "kz = 1", ("[wave]", "'kz'", "kx, ky")),
    "unknown table": (GOOD + "[waves]\n", ("'waves'", "[flow] and [wave]")),
    "missing key": (GOOD.replace("tan_theta = 0.3\n", ""), ("lacks", "tan_theta")),
    "missing wave key": (GOOD.replace("kx = 0.0\n", ""), ("[wave]", "lacks", "kx")),
    "missing table": (GOOD.partition("[wave]")[0], ("lacks [wave]",)),
    "empty file": ("", ("lacks [flow]",)),
    "string for a number": (GOOD.replace("r = 0.6", 'r = "0.6"'), ("r = '0.6'", "a finite number")),
    "truth for a number": (GOOD.replace("r = 0.6", "r = true"), ("r = True", "a finite number")),
    "number for a string": (GOOD.replace("r = 0.6", "r = 0.6\nwall = 3"), ("wall = 3", "a string")),
    "not a table": ("flow = 3\n[wave]\nkx = 1\nky = 1\n", ("flow = 3", "[flow]")),
    "nan": (GOOD.replace("ky = 0.01", "ky = nan"), ("ky = nan", "a finite number")),
    "infinity": (GOOD.replace("7.0", "inf"), ("far_temperature = inf", "a finite number")),
    "more than a double": (GOOD.replace("7.0", "1" + 400 * "0"), ("far_temperature", "a finite number")),
    "e > 1": (GOOD.replace("e = 0.8", "e = 1.8", 1), ("e = 1.8", "0 < e <= 1")),
    "e_w = 0": (GOOD.replace("e_w = 0.8", "e_w = 0.0"), ("e_w = 0.0", "0 < e_w <= 1")),
    "r >= 1": (GOOD.replace("r = 0.6", "r = 1.0"), ("r = 1.0", "0 <= r < 1")),
    "tan_theta <= 0": (GOOD.replace("0.3", "-0.3"), ("tan_theta = -0.3", "above 0")),
    "cold": (GOOD.replace("7.0", "0"), ("far_temperature = 0", "above 0")),
    "no wave": (GOOD.replace("ky = 0.01", "ky = 0"), ("kx = 0", "ky = 0")),
    "two flows": (GOOD.replace("7.0", "7.0\nmass_flux = 3"), ("mass_flux and far_temperature", "exactly one")),
    "no flow": (GOOD.replace("far_temperature = 7.0", ""), ("exactly one of mass_flux, far_temperature",)),
    "unknown model": (GOOD.replace("r = 0.6", 'r = 0.6\nradial = "x"'), ("radial = 'x'", "lun-savage")),
    "branch without flux": (GOOD.replace("7.0", '7.0\nbranch = "high"'), ("branch = 'high'", "mass_flux")),
    "which branch": (GOOD.replace("far_temperature = 7.0", "mass_flux = 3"), ("mass_flux = 3", "branch", "mid")),
    "no such branch": (GOOD.replace("far_temperature = 7.0", 'mass_flux = 3\nbranch = "best"'), ("branch = 'best'", "mid")),
    "broken": ("[flow\ne = 0.8", ("broken TOML",)),
    "twice": (GOOD + "ky = 0.02", ("broken TOML",)),
    "not text": (b"\xff\xfe\x00", ("broken TOML",)),
    "deep": ("a = " + 5000 * "[", ("broken TOML",)),
    "both kinds": (GOOD + GALLERY, ("'flow'", "[problem]")),
    "no name": ("[problem]\nreynolds = 1e4\nalpha = 1\n", ("name = None", "poiseuille")),
    "no such name": (GALLERY.replace("poiseuille", "couette"), ("'couette'", "poiseuille")),
    "name is a list": (GALLERY.replace('"poiseuille"', "[1]"), ("name = [1]", "poiseuille")),
    "problem is no table": ("problem = 1", ("name", "poiseuille")),
    "no reynolds": (GALLERY.replace("reynolds = 1e4\n", ""), ("lacks", "reynolds")),
    "reynolds < 0": (GALLERY.replace("1e4", "-1"), ("reynolds = -1", "above 0")),
    "half a number": (GALLERY + "half = 1\n", ("half = 1", "true or false")),
}


@pytest.mark.parametrize("what", WRONG)
def test_wrong_scene_files_are_refused_in_one_line(tmp_path: Path, what: str) -> None:
    text, words = WRONG[what]
    path = write(tmp_path, text)
    with pytest.raises(InputError) as refusal:
        load(path)
    message = str(refusal.value)
    assert message.startswith(path)
    assert "\n" not in message
    for word in words:
        assert word in message


def test_where_there_is_no_flow_the_error_stays_a_noflow_error(tmp_path: Path) -> None:
    # no flow of Q0 = 1e9: T∞ would be above 1000
    path = write(tmp_path, GOOD.replace("far_temperature = 7.0", "mass_flux = 1e9"))
    with pytest.raises(NoFlowError, match="mass_flux") as refusal:
        load(path)
    assert str(refusal.value).startswith(path)


@pytest.mark.parametrize(
    ("name", "words"),
    [("nowhere", "high, mid, low, fig2"), ("nowhere.toml", "No such file"), ("", "no such scene"), ("nowhere:problem", "No module named")],
)
def test_what_is_not_there(name: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        load(name)


def test_a_folder_is_no_scene(tmp_path: Path) -> None:
    folder = tmp_path / "folder.toml"
    folder.mkdir()
    with pytest.raises(InputError, match="cannot be read"):
        load(str(folder))


USERS = """
from shootstab.models.gallery.poiseuille import PlanePoiseuille

problem = PlanePoiseuille(8000.0, 0.9)
number = 3

def make():
    return PlanePoiseuille(7000.0, 0.8)

class Mine(PlanePoiseuille):
    pass

class Drawer:
    inside = problem
"""


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> str:
    """A module of the user's own in the current directory; its name, which no other test shares."""
    name = f"own_{abs(hash(request.node.name))}"
    write(tmp_path, USERS, f"{name}.py")
    monkeypatch.chdir(tmp_path)
    return name


def test_a_problem_of_the_users_own(own: str) -> None:
    scene = load(f"{own}:problem")
    assert scene.problem.size == 4
    assert scene.problem.pencil(np.zeros(1, dtype=np.complex128)).D1[0, 3, 2] == 8000.0
    assert load(f"{own}:Drawer.inside").problem is scene.problem


def test_a_function_may_make_the_problem(own: str) -> None:
    problem: Any = load(f"{own}:make").problem
    assert problem.reynolds == 7000.0


@pytest.mark.parametrize(
    ("path", "words"), [("number", "lacks size"), ("none", "no attribute"), ("Mine", "is a class"), ("", "cannot be loaded")]
)
def test_what_is_no_problem(own: str, path: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        load(f"{own}:{path}")


@pytest.mark.parametrize("body", ["1/0", "def (", "import sys; sys.exit(3)", "import nothing_of_that_name"])
def test_whatever_a_users_module_raises_is_one_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, body: str) -> None:
    name = f"broken_{abs(hash(body))}"
    write(tmp_path, body, f"{name}.py")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match="cannot be loaded"):
        load(f"{name}:problem")
