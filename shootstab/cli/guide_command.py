"""`shootstab guide [TOPIC]`: the pages of the manual that lie in the package."""

from __future__ import annotations

from argparse import Namespace
from importlib.resources import files

from shootstab.core.errors import InputError
from shootstab.io.notation import nearest

FIRST_TOPICS = ("first-minutes", "verdicts", "error-bars", "your-own-spectrum", "your-own-equations")  # the others follow by name


def topics() -> dict[str, str]:
    """Every topic with the title of its page, those for newcomers first."""
    pages = {p.name.removesuffix(".md"): p.read_text(encoding="utf-8") for p in files("shootstab").joinpath("guide").iterdir()}
    order = [*FIRST_TOPICS, *sorted(pages.keys() - set(FIRST_TOPICS))]
    return {name: pages[name].splitlines()[0].removeprefix("# ") for name in order}


def guide(options: Namespace) -> int:
    """A page as it is written, or the list of all."""
    titles = topics()
    if options.topic is None:
        print("shootstab guide TOPIC shows one of these pages:\n")
        for name, title in titles.items():
            print(f"  {name:<20}{title}")
        return 0
    if options.topic not in titles:
        raise InputError(f"guide {options.topic}: no such topic{nearest(options.topic, titles)}: allowed is one of {', '.join(titles)}")
    print(files("shootstab").joinpath("guide", f"{options.topic}.md").read_text(encoding="utf-8"), end="")
    return 0
