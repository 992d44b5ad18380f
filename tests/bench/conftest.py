"""What bench tests share: budgets, and the office."""

import gc
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.bench.budget import FILE, Budgets
from thbridge.files.map_files import Map, read_map
from thbridge.files.resources import shipped


@pytest.fixture(scope="session")
def office() -> Map:
    """The shipped map of 520 x 280 cells."""
    return read_map(shipped().find("maps", "office", Path()))


@pytest.fixture(scope="session")
def _budgets(pytestconfig: pytest.Config) -> Iterator[Budgets]:
    budgets = Budgets(FILE, write=bool(pytestconfig.getoption("--write-budgets")))
    yield budgets
    budgets.save()


@pytest.fixture
def budgets(_budgets: Budgets) -> Iterator[Budgets]:
    """Judges what was measured: `budgets.time(name, seconds)`, or `budgets.ratio(name, ours / theirs)`.

    What other tests have left in memory is kept from the garbage collector: it would walk it in the midst of a figure.
    """
    gc.collect()
    gc.freeze()
    _budgets.begin()
    yield _budgets
    gc.unfreeze()
