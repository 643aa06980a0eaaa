"""`shootstab guide [TOPIC]`: the pages of the manual that lie in the package, one by one or as a site."""

from __future__ import annotations

from argparse import Namespace
from importlib.resources import files

from shootstab.cli import site
from shootstab.core.errors import InputError
from shootstab.io.notation import nearest

FIRST_TOPICS = ("first-minutes", "verdicts", "error-bars", "your-own-spectrum", "your-own-equations")  # the others follow by name


def topics() -> dict[str, str]:
    """Every topic with the title of its page, those for newcomers first."""
    pages = {p.name.removesuffix(".md"): p.read_text(encoding="utf-8") for p in files("shootstab").joinpath("guide").iterdir()}
    order = [*FIRST_TOPICS, *sorted(pages.keys() - set(FIRST_TOPICS))]
    return {name: pages[name].splitlines()[0].removeprefix("# ") for name in order} | {site.REFERENCE: site.REFERENCE_TITLE}


def page(topic: str) -> str:
    """The page as it is written; the reference is made of the docstrings."""
    if topic == site.REFERENCE:
        return site.reference()
    return files("shootstab").joinpath("guide", f"{topic}.md").read_text(encoding="utf-8")


def guide(options: Namespace) -> int:
    """A page as it is written, or the list of all."""
    titles = topics()
    if options.site is not None:
        if options.topic is not None:
            raise InputError("guide --site: allowed without a topic, for all of them")
        site.make({name: (title, page(name)) for name, title in titles.items()}, options.site)
        print(f"{len(titles)} pages in {options.site}, from index.html on")
        return 0
    if options.topic is None:
        print("shootstab guide TOPIC shows one of these pages:\n")
        for name, title in titles.items():
            print(f"  {name:<20}{title}")
        return 0
    if options.topic not in titles:
        raise InputError(f"guide {options.topic}: no such topic{nearest(options.topic, titles)}: allowed is one of {', '.join(titles)}")
    print(page(options.topic), end="")
    return 0
