"""The floors of the house: each imports only from below, no files form a circle, and the two paths to an eigenvalue share what they may."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

PACKAGE = Path(__file__).parent.parent / "shootstab"
FLOORS = {
    "core": 0,
    "checkers": 0,
    "kernels": 1,
    "problems": 2,
    "essential_spectrum": 3,
    "roots": 3,
    "spectral": 3,
    "discriminants": 4,
    "multiprecision": 4,
    "analyses": 5,
    "formulation": 5,
    "models": 6,
    "io": 7,
    "cli": 8,
    "presented": 9,
    "by_name": 10,
    "testing": 11,
    "__main__": 11,
    "pytest_plugin": 12,
}
LONGEST, LONGEST_CHECKER = 300, 940
CHUTE, GALLERY = "shootstab.models.chute", "shootstab.models.gallery"
LAWS = {f"{CHUTE}.{m}" for m in ("constitutive", "parameters", "balance", "descent", "registry", "steady_flow", "family")}


def modules() -> dict[str, Path]:
    return {".".join(p.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__"): p for p in PACKAGE.rglob("*.py")}


def imports(path: Path) -> set[str]:
    """What a module imports from shootstab, wherever in the file."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {a.name for a in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"relative import in {path}"
            found |= {f"{node.module}.{a.name}" for a in node.names} | {node.module or ""}
    known = modules()
    return {name for name in found if name in known and name != "shootstab"}


def floor(name: str) -> int:
    return FLOORS[name.split(".")[1]]


def test_every_module_lives_on_a_floor() -> None:
    assert {name.split(".")[1] for name in modules() if "." in name} == set(FLOORS)


def test_imports_go_down() -> None:
    for name, path in modules().items():
        if name == "shootstab":
            continue
        for other in imports(path):
            same_room = name.split(".")[1] == other.split(".")[1]
            assert same_room or floor(other) < floor(name), f"{name} imports {other}"


def test_rooms_on_one_floor_do_not_see_each_other() -> None:
    for name, path in modules().items():
        for other in imports(path) if "." in name else ():
            apart = name.split(".")[1] != other.split(".")[1] and floor(name) == floor(other)
            assert not apart, f"{name} imports {other}"


def test_models_know_nothing_of_each_other() -> None:
    for name, path in modules().items():
        if name.startswith(f"{CHUTE}."):
            assert not any(other.startswith(GALLERY) for other in imports(path)), name
        if name.startswith(f"{GALLERY}."):
            assert not any(other.startswith(CHUTE) for other in imports(path)), name


def test_no_files_form_a_circle() -> None:
    """An import inside a function counts too: it hides a circle and does not open it."""
    known = modules()
    edges = {name: {n for n in imports(path) if known[n].name != "__init__.py"} for name, path in known.items()}
    state: dict[str, str] = {}

    def visit(name: str, trail: tuple[str, ...]) -> None:
        assert state.get(name) != "open", " -> ".join((*trail[trail.index(name) :], name))
        if name not in state:
            state[name] = "open"
            for other in sorted(edges[name]):
                visit(other, (*trail, name))
            state[name] = "closed"

    for name in sorted(known):
        visit(name, ())


def test_no_module_is_too_long() -> None:
    """A checker is one file, so that whoever reads it has it all."""
    for name, path in modules().items():
        assert len(path.read_text().splitlines()) <= (LONGEST_CHECKER if ".checkers." in name else LONGEST), name


def reachable(start: str, beside: str = "") -> set[str]:
    """The modules that a module imports, and those import, itself among them; not through those whose names begin with beside."""
    known, seen, todo = modules(), set(), [start]
    while todo:
        name = todo.pop()
        if name not in seen:
            seen.add(name)
            found = [n for n in imports(known[name]) if known[n].name != "__init__.py"]
            todo += [n for n in found if not beside or not n.startswith(beside)]
    return seen


def test_shooting_and_pseudospectral_paths_share_the_steady_flow_only() -> None:
    spectral = reachable(f"{CHUTE}.chute_collocation")
    shooting = set().union(*(reachable(n) for n in ("shootstab.discriminants.frame", f"{CHUTE}.perturbations", "shootstab.roots.search")))
    shared = {n for n in spectral & shooting if not n.startswith("shootstab.core")}
    assert shared <= LAWS | {"shootstab.kernels.taylor_pieces", "shootstab.kernels.recorded_programs"}, shared
    assert not any(n.startswith("shootstab.spectral") or "collocation" in n for n in shooting)


def test_searches_know_the_discriminant_only() -> None:
    for name, path in modules().items():
        if name.startswith("shootstab.roots."):
            assert all(n.startswith(("shootstab.roots", "shootstab.core")) for n in imports(path)), name


def test_import_is_lazy() -> None:
    code = "import sys, shootstab; print([m for m in ('numpy', 'scipy', 'numba', 'mpmath', 'rich', 'matplotlib') if m in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip() == "[]"


def test_no_optional_library_is_imported_by_the_main_job() -> None:
    code = (
        "import sys, shootstab as st\n"
        "flow = st.chute.steady(far_temperature=7.0, e=0.8, e_w=0.8, r=0.6, tan_theta=0.3)\n"
        "st.refine(st.chute.problem(flow, kx=0.0, ky=0.01), guess=0.004)\n"
        "print([m for m in ('matplotlib', 'flint', 'h5py', 'dask', 'sympy', 'pytest') if m in sys.modules])"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip() == "[]"


def test_without_the_extras_every_model_is_there_and_what_needs_one_is_refused_in_a_line() -> None:
    code = (
        "import sys\n"
        "extras = 'matplotlib plotly flint h5py dask distributed sympy pytest hypothesis'\n"
        "sys.modules.update(dict.fromkeys(extras.split()))\n"
        "from shootstab.cli import main as cli\n"
        "from shootstab.io import scenes\n"
        "assert all(scenes.load(name).problem.size for name in ('low', 'benard', 'convection'))\n"
        "assert scenes.load('oblique-wave').problem.growing_region is None\n"
        "for words in (['prove', 'poiseuille', '--guess', '0.0037,-0.2375'], ['check', 'no.json'],\n"
        "              ['verify', 'poiseuille', '--prove', '--missing', 'none'], ['verify', 'poiseuille', '--html', 'no.html']):\n"
        "    print(cli.main(words))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.stdout, done.returncode) == ("2\n" * 4, 0), done.stderr
    lines = done.stderr.splitlines()
    assert [line[:11] for line in lines] == ["shootstab: "] * 4
    assert [line.partition("needs ")[2] for line in lines[:3]] == ["python-flint: install it with `pip install 'shootstab[precise]'`"] * 3
