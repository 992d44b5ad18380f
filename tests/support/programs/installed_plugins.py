"""Packages with plug-ins, as `pip install` leaves them, for tests."""

import sys
from collections.abc import Mapping
from pathlib import Path

import pytest


def install_plugins(
    folder: Path, monkeypatch: pytest.MonkeyPatch, name: str, groups: Mapping[str, Mapping[str, str]], source: str
) -> None:
    """Install the distribution `name` 1.0 for one test.

    Args:
        folder: where its files are written.
        monkeypatch: of the test.
        name: of its module; the distribution has hyphens in place of underscores.
        groups: names in its module by the names of entry points, by group.
        source: of its module.
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
