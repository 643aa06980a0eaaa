"""The manual as a site: the pages of the guide, and a reference made of the docstrings; needs the extra `docs`."""

from __future__ import annotations

import importlib.util
import inspect
import re
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from shootstab.core.errors import InputError, OutputError

REFERENCE = "reference"
REFERENCE_TITLE = "Reference: the names in Python"
NAMED_BLOCK = re.compile(r"^```(\w+) (\S+)$", re.MULTILINE)  # a fenced block with the name of the file that it is saved as


def reference() -> str:
    """Every public name of the package with its signature and its docstring, in Markdown; public methods and properties too."""
    import shootstab

    parts = [f"# {REFERENCE_TITLE}\n\n`import shootstab as st`\n"]
    for name in dir(shootstab):
        value = getattr(shootstab, name)
        if name.startswith("_"):
            continue
        if inspect.ismodule(value):
            names = [n for n in getattr(value, "__all__", None) or dir(value) if not n.startswith("_") and _own(getattr(value, n))]
            parts += [part for n in names for part in _described(f"st.{name}.{n}", getattr(value, n))]
        else:
            parts += _described(f"st.{name}", value)
    return "\n".join(parts)


def _own(value: Any) -> bool:
    """Whether a name of a module is a function or class of this package, and no import of it."""
    return (inspect.isfunction(value) or inspect.isclass(value)) and value.__module__.startswith("shootstab")


def _described(name: str, value: Any) -> Iterator[str]:
    yield f"## {name}\n\n{_block(name, value)}{_said(value)}\n"
    if not inspect.isclass(value):
        return
    for member, held in inspect.getmembers(value):
        if member.startswith("_") or member in dir(Exception):
            continue
        if isinstance(held, property) or inspect.isfunction(held):
            said = _said(held.fget if isinstance(held, property) else held)
            if said:
                yield f"### {name}.{member}\n\n{_block(member, held)}{said}\n"


def _block(name: str, value: Any) -> str:
    """The signature as a block of Python; empty where there is none."""
    try:
        return f"```python\n{name.removeprefix('st.')}{inspect.signature(value)}\n```\n\n"
    except (TypeError, ValueError):
        return ""


def _said(value: Any) -> str:
    return inspect.cleandoc(getattr(value, "__doc__", None) or "")


def require(folder: Path) -> None:
    """Raise InputError if no site can be made there."""
    if importlib.util.find_spec("mkdocs") is None:
        raise InputError(f"{folder}: a site needs mkdocs: install it with `pip install 'shootstab[docs]'`")
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise InputError(f"{folder}: is there already: allowed is a folder that is new or empty")


def make(pages: dict[str, tuple[str, str]], folder: Path) -> None:
    """Write the site of pages, by name a title and a text; a warning of mkdocs is an error. Raises InputError and OutputError."""
    require(folder)
    from mkdocs.commands.build import build
    from mkdocs.config import load_config
    from mkdocs.exceptions import MkDocsException

    with tempfile.TemporaryDirectory() as parent:
        made = Path(parent, "pages")
        made.mkdir()
        for name, (_, text) in pages.items():
            Path(made, f"{name}.md").write_text(NAMED_BLOCK.sub(r"`\2`:\n\n```\1", text), encoding="utf-8")
        listed = "".join(f"- [{title}]({name}.md)\n" for name, (title, _) in pages.items())
        first = "# shootstab\n\nAn independent second opinion on eigenvalues of linear stability problems.\n\n"
        Path(made, "index.md").write_text(first + listed, encoding="utf-8")
        nav = [{"shootstab": "index.md"}, *({title: f"{name}.md"} for name, (title, _) in pages.items())]
        settings: dict[str, Any] = {
            "site_name": "shootstab",
            "docs_dir": str(made),
            "use_directory_urls": False,
            "nav": nav,
            "plugins": [],
            "strict": True,
        }
        source = Path(parent, "mkdocs.yml")
        source.write_text("site_name: shootstab\n", encoding="utf-8")
        try:
            build(load_config(str(source), site_dir=str(folder.absolute()), **settings))
        except MkDocsException as error:
            raise OutputError(f"{folder}: {error}") from error
