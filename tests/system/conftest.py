"""What several tests of whole programs need."""

from collections.abc import Iterator

import pytest

from tests.support.disks.forgetting_disk import ForgettingDisk, why_not


@pytest.fixture(scope="module")
def disk(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ForgettingDisk]:
    if (reason := why_not()) is not None:
        pytest.skip(f"there is no disk that forgets: {reason}")
    with ForgettingDisk(tmp_path_factory.mktemp("disk") / "mount") as disk:
        yield disk
