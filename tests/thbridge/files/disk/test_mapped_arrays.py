from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from thbridge.files.disk import mapped_arrays
from thbridge.files.disk.mapped_arrays import mapped


def fields() -> Iterator[NDArray[np.float32]]:
    for number in range(20):
        yield np.full((700, 1500), number, dtype=np.float32)


def resident() -> float:
    """Memory that the process has to itself, MB; pages of files that it looks at are not counted."""
    with Path("/proc/self/status").open() as status:
        return next(int(line.split()[1]) for line in status if line.startswith("RssAnon")) / 1024.0


@pytest.mark.parametrize("most", [0, 1 << 40])
def test_arrays_are_the_same_in_a_file_and_in_memory(most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mapped_arrays, "MOST", most)
    kept = mapped(fields(), 1 << 30)
    assert [each.shape for each in kept] == [(700, 1500)] * 20
    assert all((each == number).all() for number, each in enumerate(kept))
    kept[3][1, 2] = 7.0
    assert kept[3].flags.c_contiguous and kept[3][1, 2] == 7.0 and kept[4][1, 2] == 4.0


def test_memory_holds_none_of_many_large_ones() -> None:
    before, files = resident(), len([*Path("/proc/self/fd").iterdir()])
    kept = mapped(fields(), 84_000_000)
    assert sum(float(each[600, 700]) for each in kept) == sum(range(20))
    assert resident() - before < 30.0
    del kept
    assert len([*Path("/proc/self/fd").iterdir()]) == files
