"""Packages with plug-ins, installed as `pip install` does, for tests."""

import sys
from collections.abc import Mapping
from pathlib import Path

import pytest


def install_plugins(
    folder: Path, monkeypatch: pytest.MonkeyPatch, name: str, groups: Mapping[str, Mapping[str, str]], source: str
) -> None:
    """Install the distribution `name` 1.0 for one test.

    Args:
        folder: folder for its files.
        monkeypatch: fixture of the test.
        name: name of its module; the distribution's name has hyphens instead of underscores.
        groups: for each group, names in its module by the names of the entry points.
        source: source text of its module.
    """
    info = folder / f"{name}-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name.replace('_', '-')}\nVersion: 1.0\n")
    lines = (
        line
        for group, entries in groups.items()
        for line in (f"[{group}]", *(f"{entry} = {name}:{value}" for entry, value in entries.items()))
    )
    (info / "entry_points.txt").write_text("\n".join(lines) + "\n")
    (folder / f"{name}.py").write_text(source)
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.delitem(sys.modules, name, raising=False)
