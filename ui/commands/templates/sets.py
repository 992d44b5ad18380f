"""Shared parts of the commands about template sets."""

import shutil
from pathlib import Path

from thbridge.files.resources import shipped
from thbridge.files.set_words import WORDS, languages_beside
from thbridge.files.template_files import DIALOGUE_TEXT, SET, TemplateSet, read_template_set
from ui.command_line.terminal import bad_input


def folder_of(name: str) -> Path:
    """Return the folder of a set, given its name or path."""
    wanted = f"./{name}" if "/" not in name and Path(name).is_dir() else name
    with bad_input():
        return shipped().find("templates", wanted, Path())


def read_set(name: str) -> TemplateSet:
    """Return the set, given its name or path."""
    folder = folder_of(name)
    with bad_input():
        return read_template_set(folder)


def copy_set(source: Path, folder: Path) -> None:
    """Copy a set, so that the user can change the copy. Its texts in other languages are not copied."""
    others = shutil.ignore_patterns(*languages_beside(source, (DIALOGUE_TEXT, WORDS)))
    shutil.copytree(source, folder, ignore=others, dirs_exist_ok=True)
    path = folder / SET
    if path.exists():
        lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
        left = [line for line in lines if not line.startswith("language:")]
        if any(line.strip() and not line.startswith("#") for line in left):
            path.write_text("".join(left), encoding="utf-8")
        else:
            path.unlink()
