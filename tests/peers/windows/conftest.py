"""The screen on which most tests of windows take place."""

from collections.abc import Iterator

import pytest

from tests.support.windows.desktop import Desktop, desktop


@pytest.fixture
def screen() -> Iterator[Desktop]:
    with desktop() as opened:
        yield opened
