"""The floors of the house: each imports only from below, and the two paths to an eigenvalue share what they may and nothing else."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

PACKAGE = Path(__file__).parent.parent / "shootstab"
FLOORS = {
    "vocabulary": 0,
    "kernels": 1,
    "problems": 2,
    "discriminants": 3,
    "roots": 4,
    "spectral": 4,
    "questions": 5,
    "faces": 6,
    "testing": 7,
}
LONGEST = 320


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


def test_no_module_is_too_long() -> None:
    for name, path in modules().items():
        assert len(path.read_text().splitlines()) <= LONGEST, name


def reachable(start: str) -> set[str]:
    known, seen, todo = modules(), set(), [start]
    while todo:
        name = todo.pop()
        if name not in seen:
            seen.add(name)
            todo += [n for n in imports(known[name]) if known[n].name != "__init__.py"]
    return seen


def test_shooting_and_pseudospectral_paths_share_the_steady_flow_only() -> None:
    spectral = set().union(*(reachable(n) for n in modules() if n.startswith("shootstab.spectral.")))
    shooting = set().union(*(reachable(f"shootstab.{n}") for n in ("discriminants.frame", "problems.chute.problem", "roots.find")))
    shared = {n for n in spectral & shooting if not n.startswith("shootstab.vocabulary")}
    chute = "shootstab.problems.chute"
    allowed = {f"{chute}.{m}" for m in ("constitutive", "parameters", "balance", "descent", "steady", "family")}
    assert shared <= allowed | {"shootstab.kernels.tableau"}, shared - allowed
    assert not any(n.startswith("shootstab.spectral") for n in shooting)


def test_searches_know_the_discriminant_only() -> None:
    for name, path in modules().items():
        if name.startswith("shootstab.roots."):
            above = {n for n in imports(path) if not n.startswith(("shootstab.roots", "shootstab.vocabulary"))}
            assert above <= {"shootstab.discriminants.protocol"}, name


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
