"""Parts of the commands about template sets."""

from pathlib import Path

from thbridge.files.resources import shipped
from thbridge.files.template_files import TemplateSet, read_template_set
from ui.terminal import bad_input


def folder_of(name: str) -> Path:
    """The folder of the set of a name or path."""
    wanted = f"./{name}" if "/" not in name and Path(name).is_dir() else name
    with bad_input():
        return shipped().find("templates", wanted, Path())


def read_set(name: str) -> TemplateSet:
    """The set of a name or path."""
    folder = folder_of(name)
    with bad_input():
        return read_template_set(folder)
