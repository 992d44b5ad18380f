"""What bench tests share: budgets, the office, and what the peers that are measured beside us are built from."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.bench.budget import Budgets
from thbridge.files.map_files import Map, read_map
from thbridge.files.resources import shipped


@pytest.fixture(scope="session")
def navigation() -> Path:
    """A checkout of github.com/ros-planning/navigation, named by NAVIGATION_SRC."""
    source = os.environ.get("NAVIGATION_SRC")
    if not source:
        pytest.skip("NAVIGATION_SRC names no checkout of ros-planning/navigation")
    return Path(source)


@pytest.fixture(scope="session")
def office() -> Map:
    """The shipped map of 520 x 280 cells."""
    return read_map(shipped().find("maps", "office", Path()))


@pytest.fixture(scope="session")
def budgets(pytestconfig: pytest.Config) -> Iterator[Budgets]:
    """Judges what was measured: `budgets.time(name, seconds)`, or `budgets.ratio(name, ours / theirs)`."""
    budgets = Budgets(write=bool(pytestconfig.getoption("--write-budgets")))
    yield budgets
    budgets.save()
