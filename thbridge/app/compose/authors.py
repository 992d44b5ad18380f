"""Authors of wordings that are installed: programs of labs, which a study names."""

import difflib
from importlib.metadata import entry_points
from pathlib import Path

from thbridge.dialogue.wording.authors import WordingAuthor
from thbridge.files.errors import BadFile

GROUP = "thbridge.wordings"
"""The group of entry points under which authors are installed."""


def installed_author(name: str) -> WordingAuthor:
    """Return the author of a name: the function that the entry point of this name names.

    Raises:
        BadFile: there is none of this name, or it cannot be imported, or is no function.
    """
    found = {each.name: each for each in entry_points(group=GROUP)}
    if name not in found:
        near = difflib.get_close_matches(name, found, n=1)
        installed = f"Installed are: {', '.join(sorted(found))}" if found else "None is installed"
        remedy = f"The nearest is {near[0]}" if near else installed
        raise BadFile(Path(GROUP), f"no author of wordings {name} is installed", remedy, key=name)
    entry = found[name]
    try:
        author: object = entry.load()
    except Exception as error:
        problem = f"{entry.value} cannot be imported: {type(error).__name__}: {error}"
        raise BadFile(Path(GROUP), problem, "Mend it, or install it anew", key=name) from error
    if not callable(author):
        raise BadFile(Path(GROUP), f"{entry.value} is no function", "Name one that takes a request", key=name)
    return author
