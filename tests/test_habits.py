"""What a release rests on: one version, files that name it, bounds that a script can pin, a program that runs as a module; and how the
sources are written: numbers that say where they come from, one name for one thing."""

from __future__ import annotations

import ast
import io
import re
import subprocess
import sys
import tokenize
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
import versions

import shootstab

ROOT = Path(__file__).parent.parent
SOURCES = sorted((ROOT / "shootstab").rglob("*.py"))


def test_the_version_stands_once_and_the_files_beside_the_licence_name_it() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    assert "version" in project["project"]["dynamic"]
    assert project["tool"]["setuptools"]["dynamic"]["version"] == {"attr": "shootstab.__version__"}
    assert f"\nversion: {shootstab.__version__}\n" in (ROOT / "CITATION.cff").read_text()
    assert re.search(r"^## (\S+)", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)[1] in (shootstab.__version__, "Unreleased")  # type: ignore[index]


@pytest.mark.parametrize("arguments", [["-m", "shootstab"], ["-m", "shootstab.cli.main"]])
def test_the_package_runs_as_a_module(arguments: list[str]) -> None:
    done = subprocess.run([sys.executable, *arguments, "--version"], cwd=ROOT, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout) == (0, f"shootstab {shootstab.__version__}\n")


def test_every_dependency_has_a_lower_bound_that_can_be_pinned() -> None:
    pins = [versions.oldest(r) for r in versions.requirements()]
    assert len(pins) > 10
    assert all(re.fullmatch(r"[A-Za-z0-9_-]+==\d+(\.\d+)*", pin) for pin in pins), pins
    assert "python-flint==0.9" in pins  # below, Arb's series of order zero end the process


@cache
def _tree(path: Path) -> ast.Module:
    """The syntax of a file."""
    return ast.parse(path.read_text())


@cache
def _nodes(path: Path) -> tuple[ast.AST, ...]:
    """All of it, flat."""
    return tuple(ast.walk(_tree(path)))


@cache
def _constants(path: Path) -> list[tuple[str, ast.expr, str]]:
    """The constants of a module: name, value, and what comments beside and above say of it."""
    lines = path.read_text().splitlines()
    found = []
    for node in _tree(path).body:
        if not isinstance(node, ast.Assign | ast.AnnAssign) or node.value is None:
            continue
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        first = node.lineno - 1
        while first and lines[first - 1].startswith("#"):
            first -= 1
        said = " ".join(line.partition("#")[2] for line in lines[first : node.end_lineno])
        names = [n.id for target in targets for n in ast.walk(target) if isinstance(n, ast.Name)]
        found += [(name, node.value, said) for name in names if re.fullmatch(r"_?[A-Z][A-Z0-9_]+", name)]
    return found


def _is_number(value: ast.expr) -> bool:
    """Whether a value is made of numbers alone, however it is computed: no words, no table, not the 0 or 1 of some arithmetic."""
    nodes = list(ast.walk(value))
    literals = [n.value for n in nodes if isinstance(n, ast.Constant)]
    if any(isinstance(n, ast.Dict) for n in nodes) or any(isinstance(c, str | bytes) for c in literals):
        return False
    unit = any(isinstance(n, ast.Call) for n in nodes) and set(map(repr, literals)) <= {"0", "1"}
    return any(isinstance(c, int | float | complex) for c in literals) and not unit


ORIGIN = re.compile(r"\b(chosen\b|derived\b|exact\b|published\b|defined by the \w+|measured \(validation/\w+\.py\))")


def test_every_number_says_where_it_comes_from() -> None:
    """Chosen, derived, measured (by which script), exact, published, or defined by a format or by the contract with users."""
    silent = [
        f"{path.relative_to(ROOT)}: {name}"
        for path in [*SOURCES, *(ROOT / "validation").rglob("*.py")]
        for name, value, said in _constants(path)
        if _is_number(value) and not ORIGIN.search(said)
    ]
    assert not silent, silent


def test_a_number_stands_on_the_line_of_its_name() -> None:
    """No number, nor a tuple of them, is put in parentheses for the sake of a long comment, between whose lines neither it nor its origin
    is seen."""
    wrapped = [
        f"{path.relative_to(ROOT)}:{node.lineno}: {ast.unparse(node)[:60]}"
        for path in SOURCES
        for node in _tree(path).body
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None and node.lineno != node.end_lineno
        if _is_number(node.value) and str(path.relative_to(ROOT / "shootstab")) not in TABLES
    ]
    assert wrapped == []


# numbers of formulas: counts, and simple fractions as in ½ (a + b), h/6, T^{5/2}
EXACT_INTEGERS, EXACT_FRACTIONS = range(11), (0.0, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0)
STYLE = re.compile(r"linewidths?|(?:framea|a)lpha|marker(?:size|edgewidth)|zorder")  # of a picture: nothing rests on them
# formulas with numbers of their own, each with its source in the docstring
FORMULAS = {
    "models/chute/constitutive.py": "the table of guide/theory.md, and (A 15)",
    "checkers/granular_chute.py": "the same, typed again",
}
PUBLISHED_DEFAULTS = "models/gallery"  # defaults of its problems: the parameters at which others have published digits
TABLES = {"kernels/tableau.py"}  # published numbers, a row of a table on each line


def _exempt(path: Path) -> Iterator[ast.AST]:
    """The numbers of a file that need no name: style, sizes of caches, bases of powers, and published parameters as defaults."""
    gallery = path.is_relative_to(ROOT / "shootstab" / PUBLISHED_DEFAULTS)
    for node in _nodes(path):
        if isinstance(node, ast.keyword) and (node.arg == "maxsize" or (node.arg and STYLE.fullmatch(node.arg))):
            yield from ast.walk(node.value)
        elif isinstance(node, ast.Dict):
            for key, value in zip(node.keys, node.values, strict=True):
                if isinstance(key, ast.Constant) and isinstance(key.value, str) and STYLE.fullmatch(key.value):
                    yield from ast.walk(value)
        elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow) and ast.unparse(node.left) == "10.0":
            yield node.left
        elif gallery and isinstance(node, ast.arguments):
            yield from (default for default in (*node.defaults, *node.kw_defaults) if default is not None)
        elif gallery and isinstance(node, ast.ClassDef):
            yield from (field.value for field in node.body if isinstance(field, ast.AnnAssign) and field.value is not None)


def _hidden(path: Path) -> Iterator[str]:
    """Numbers in functions and classes of a file that are neither exact nor exempt."""
    exempt = set(map(id, _exempt(path)))
    inside = {id(n): n for node in _tree(path).body if not isinstance(node, ast.Assign | ast.AnnAssign) for n in ast.walk(node)}
    for node in inside.values():
        if not isinstance(node, ast.Constant) or type(node.value) not in (int, float, complex) or id(node) in exempt:
            continue
        if abs(node.value) not in (EXACT_INTEGERS if isinstance(node.value, int) else EXACT_FRACTIONS):
            yield f"{path.name}:{node.lineno}: {node.value!r}"


def test_no_number_hides_in_a_function() -> None:
    """What was chosen, measured or published has a name and an origin, at the head of a module."""
    paths = [path for path in SOURCES if str(path.relative_to(ROOT / "shootstab")) not in FORMULAS]
    hidden = [place for path in paths for place in _hidden(path)]
    assert hidden == [], "\n".join(hidden)


def test_what_hides_in_a_function_is_found(tmp_path: Path) -> None:
    """A default, a budget, a lambda, a field and a base are seen; a power of ten, a style, a cache and h/6 are not."""
    text = "X = 5e-7\n@lru_cache(maxsize=64)\ndef f(h, r=1e-7):\n    plot(h / 6, 10.0**-h, linewidth=0.3)\n    return 17 * h + 1.3**r\n"
    text += "class C:\n    a: float = 0.3\n    g = sorted(x, key=lambda x: 1e-6 * x)\n"
    (tmp_path / "hiding.py").write_text(text)
    assert [place.rsplit(" ", 1)[1] for place in _hidden(tmp_path / "hiding.py")] == ["1e-07", "17", "1.3", "0.3", "1e-06"]


def test_a_measured_number_names_a_script_that_exists() -> None:
    named = {script for path in SOURCES for _, _, said in _constants(path) for script in re.findall(r"validation/\w+\.py", said)}
    assert named
    assert [script for script in named if not (ROOT / script).exists()] == []


def test_a_constant_has_one_name_and_one_value() -> None:
    """Two modules may not give one name: whoever needs the number of another imports it. Only what a registry reads of each of its
    modules is called the same in all of them: ENTRIES of the catalogue, MODEL of a model's scenes, and the names that a package loads late.
    """
    homes: dict[str, list[Path]] = {}
    for path in SOURCES:
        for name in {name for name, _, _ in _constants(path)} - {"ENTRIES", "MODEL", "_HOMES"}:
            homes.setdefault(name, []).append(path.relative_to(ROOT))
    assert {name: paths for name, paths in homes.items() if len(paths) > 1} == {}


def _nouns(path: Path) -> Iterator[tuple[str, str]]:
    """Classes, and the other names in capital and small letters that a module gives to types, with what each stands for."""
    yield from ((node.name, f"class of {path}") for node in _nodes(ROOT / path) if isinstance(node, ast.ClassDef))
    for node in _tree(ROOT / path).body:
        if isinstance(node, ast.Assign) and not ast.unparse(node.value).startswith("TypeVar("):
            names = [n.id for target in node.targets for n in ast.walk(target) if isinstance(n, ast.Name)]
            yield from ((name, ast.unparse(node.value)) for name in names if re.fullmatch(r"_?[A-Z]\w*[a-z]\w*", name))


def test_a_noun_stands_for_one_thing() -> None:
    """No two classes have one name, in the package, the validation or the tests, and no name for a type means another elsewhere;
    an underscore before it makes no other noun."""
    classes: dict[str, set[str]] = {}
    for path in [*SOURCES, *(ROOT / "validation").rglob("*.py"), *(ROOT / "tests").rglob("*.py")]:
        for name, meaning in _nouns(path.relative_to(ROOT)):
            if path in SOURCES or meaning.startswith("class"):
                classes.setdefault(name.lstrip("_"), set()).add(meaning)
    assert {name: meanings for name, meanings in classes.items() if len(meanings) > 1} == {}


TELEGRAM = re.compile(
    r"(?:of|by|with|from|to|in|on|at|as|off|about|between|beyond|below|above|over|under|per|without|within|through|that of|for|and|but|or|"
    r"so|not|whose|which|be)\b",
    re.IGNORECASE,
)


def _sentences(path: Path) -> Iterator[tuple[int, str]]:
    """Docstrings and comments, a block of comment lines as one, each with its line."""
    text = path.read_text()
    for node in _nodes(path):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and (said := ast.get_docstring(node)):
            yield node.body[0].lineno, said
    last = -1
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            row, own_line = token.start[0], token.line.lstrip().startswith("#")
            if not (own_line and row == last + 1):
                yield row, re.sub(rf"^#\s*(?:{ORIGIN.pattern}:\s*)?", "", token.string)
            last = row if own_line else -1


def test_no_sentence_has_lost_its_noun() -> None:
    """No docstring or comment begins with a preposition, a conjunction or a relative: those say of what, but not what."""
    paths = [*SOURCES, *(ROOT / "validation").rglob("*.py")]
    found = [(path.relative_to(ROOT), line, said) for path in paths for line, said in _sentences(path)]
    assert len(found) > 3000
    lost = [f"{path}:{line}: {said[:60]}" for path, line, said in found if TELEGRAM.match(said)]
    assert lost == [], "\n".join(lost)


LENGTH = r"[\w…′]+(?: ?[+·−] ?[\w…′]+)*"
SHAPE = re.compile(rf"\({LENGTH}(?:,|(?:, {LENGTH})+)\)|\b\w×\w\b")


def test_the_pattern_for_a_shape_takes_shapes_and_no_prose() -> None:
    shapes = "(m,)", "(n, k)", "(…, 6)", "(2N + 1,)", "(E + E1,)", "(MOST_TERMS, n, n)", "n×k"
    assert [said for said in shapes if not SHAPE.search(f"a mesh {said} of nodes")] == []
    prose = "(A 9)", "(2.13)", "(see there)", "(m)", "of n", "(here, but not there)"
    assert [said for said in prose if SHAPE.search(f"a mesh {said}")] == []


def _array_types() -> re.Pattern[str]:
    """Every annotation that stands for arrays: those of NumPy, matrices of many digits, and the names that modules give to either."""
    named = {"NDArray", "ArrayLike", "Matrix", "Terms"}
    meanings = [pair for path in SOURCES for pair in _nouns(path.relative_to(ROOT)) if not pair[1].startswith("class")]
    for _ in range(3):  # a name of a name of a name
        named |= {name for name, meaning in meanings if set(re.findall(r"\w+", meaning)) & named and "Callable" not in meaning}
    return re.compile(rf"\b({'|'.join(sorted(named))})\b")


ARRAY = _array_types()


def _is_array(annotation: ast.expr | None) -> bool:
    """Whether an annotation holds an array; a function of arrays is none."""
    return annotation is not None and bool(ARRAY.search(said := ast.unparse(annotation))) and "Callable" not in said


def _documented(tree: ast.Module) -> Iterator[tuple[str, bool, ast.FunctionDef]]:
    """Public functions and methods: name, whether a protocol states it, and the definition."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
            yield node.name, False, node
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            stated = any(ast.unparse(base) == "Protocol" for base in node.bases)
            for method in node.body:
                if isinstance(method, ast.FunctionDef) and (not method.name.startswith("_") or method.name == "__call__"):
                    yield method.name, stated, method


def test_shapes_stand_in_every_public_docstring_with_arrays() -> None:
    """A shape, and the name of every array that is taken: in its own docstring, or for a method in that of its protocol."""
    found = [(path, *entry) for path in SOURCES for entry in _documented(_tree(path))]
    promised = {name for _, name, stated, function in found if stated and SHAPE.search(ast.get_docstring(function) or "")}
    silent = []
    for path, name, stated, function in found:
        taken = [a.arg for a in [*function.args.args, *function.args.kwonlyargs] if _is_array(a.annotation)]
        if not (taken or _is_array(function.returns)) or (name in promised and not stated):
            continue
        said = ast.get_docstring(function) or ""
        unnamed = [argument for argument in taken if not re.search(rf"(?<![A-Za-z]){argument}(?![A-Za-z])", said)]
        if unnamed or not SHAPE.search(said):
            silent.append(f"{path.relative_to(ROOT)}: {name} {unnamed}")
    assert len(promised) > 5
    assert silent == []


def test_shapes_stand_in_every_public_record_with_arrays() -> None:
    """The docstring of a class with fields that are arrays gives shapes."""
    classes = [(path, node) for path in SOURCES for node in _tree(path).body if isinstance(node, ast.ClassDef)]
    with_arrays = [
        (path, node)
        for path, node in classes
        if not node.name.startswith("_") and any(isinstance(field, ast.AnnAssign) and _is_array(field.annotation) for field in node.body)
    ]
    assert len(with_arrays) > 30
    assert [f"{path.name}: {node.name}" for path, node in with_arrays if not SHAPE.search(ast.get_docstring(node) or "")] == []


def test_no_test_reaches_into_private_names() -> None:
    """What starts with an underscore is read by its own file only; `_replace` and its kin are public in named tuples."""
    public = {"_replace", "_asdict", "_fields", "_exit"}
    reached = []
    for path in [*(ROOT / "tests").rglob("*.py"), *(ROOT / "validation").rglob("*.py")]:
        for node in _nodes(path):
            names = [a.name for a in node.names] if isinstance(node, ast.ImportFrom) and node.module != "__future__" else []
            if isinstance(node, ast.Attribute) and not (isinstance(node.value, ast.Name) and node.value.id in ("self", "cls")):
                names = [node.attr]
            if isinstance(node, ast.Call) and ast.unparse(node.func).endswith(("setattr", "getattr")) and len(node.args) > 1:
                names = [n.value for n in node.args if isinstance(n, ast.Constant) and isinstance(n.value, str)]
            private = {n for n in names if n.startswith("_") and not n.endswith("__")} - public
            reached += [f"{path.relative_to(ROOT)}:{node.lineno}: {name}" for name in private]
    assert reached == []


# scripts of the validation whose subject is that of a module of the package, or a room of it
ONE_SUBJECT = {"far_field", "parameters", "scenes", "truncation"}


def test_a_file_name_stands_for_one_thing() -> None:
    """In package, validation and tests: only `__init__`, and a problem's entry in the catalogue, which has the name of its problem."""
    homes: dict[str, list[str]] = {}
    for path in [path for folder in ("shootstab", "validation", "tests") for path in (ROOT / folder).rglob("*.py")]:
        script_of_one_subject = path.is_relative_to(ROOT / "validation") and path.stem in ONE_SUBJECT
        if path.name not in ("__init__.py", "__main__.py") and path.parent.name != "catalogue" and not script_of_one_subject:
            homes.setdefault(path.stem, []).append(str(path.relative_to(ROOT)))
    assert {name: paths for name, paths in homes.items() if len(paths) > 1} == {}
    entries = {path.stem for path in (ROOT / "shootstab/models/catalogue").glob("*.py")}
    others = {path.stem for path in SOURCES if path.parent.name != "catalogue"} - {"__init__"}
    problems = {path.stem for path in (ROOT / "shootstab/models/gallery").glob("*.py")}
    assert entries & others <= problems | {"__init__"}


def test_no_answer_depends_on_the_time_of_day() -> None:
    """A clock may be turned while a program runs: it reads none but those that only go on, and those for seconds alone."""
    reads = re.compile(r"\btime\.(time|localtime|gmtime|ctime)\b|\bfrom time import .*\btime\b|\bdatetime\b|\bst_mtime\b|\bgetmtime\b")
    assert [path.name for path in sorted((ROOT / "shootstab").rglob("*.py")) if reads.search(path.read_text())] == []
