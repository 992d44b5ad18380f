"""The participant's window can be used at all sizes, with text of all sizes."""

from collections.abc import Iterator

import pytest
from PySide6.QtWidgets import QApplication

from tests.ui.windows import samples
from tests.ui.windows.fitting import SIZES, TEXTS, misfits, settle
from tests.ui.windows.participant.conftest import Opened
from tests.ui.windows.participant.test_window import STATES, Open
from ui.windows import look


@pytest.fixture
def text(request: pytest.FixtureRequest, qapp: QApplication) -> Iterator[float]:
    yield request.param
    look.apply_text_size(qapp, 1.0)


def windows(opened: Open) -> dict[int, Opened]:
    return {rooms: opened(samples.playing(rooms=rooms)) for rooms in (8, 12)}


@pytest.mark.parametrize("text", TEXTS, indirect=True)
def test_nothing_is_cut_off_or_covered(opened: Open, qapp: QApplication, text: float) -> None:
    shown = windows(opened)
    look.apply_text_size(qapp, text)
    for name, screen in STATES.items():
        one = shown[len(screen.tiles)]
        one.show(screen)
        for size in SIZES:
            one.window.resize(*size)
            settle()
            assert misfits(one.window) == [], (name, size)
