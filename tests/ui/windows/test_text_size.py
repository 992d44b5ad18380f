"""Text has the size that the user wants, in all windows at once, and windows open within the screen."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from PySide6.QtCore import QSize
from PySide6.QtWidgets import QApplication, QLabel, QWidget
from pytestqt.qtbot import QtBot

from ui.model.shared.theme import LIGHT
from ui.windows import look


@pytest.fixture
def file(tmp_path: Path, qapp: QApplication) -> Iterator[Path]:
    look.apply_palette(qapp, LIGHT)
    yield tmp_path / "settings" / "windows.ini"
    look.apply_text_size(qapp, 1.0)


def test_lengths_follow_the_text(qtbot: QtBot, qapp: QApplication, file: Path) -> None:
    label = look.follow_text(QLabel("Room 4"), lambda it: it.setFixedWidth(look.px(100)))
    qtbot.addWidget(label)
    usual = label.width()
    look.apply_text_size(qapp, 1.5)
    assert label.width() == pytest.approx(1.5 * usual, abs=1)


def test_text_grows_with_the_screen_and_never_shrinks() -> None:
    screens = [QSize(1024, 600), QSize(1366, 768), QSize(1920, 1080), QSize(2560, 1440), QSize(7680, 4320)]
    assert [round(look.usual_growth(screen), 3) for screen in screens] == [1.0, 1.0, 1.175, 1.4, 1.5]


@pytest.mark.parametrize("text", [0.8, 1.0, 2.0])
def test_a_window_opens_within_the_screen_with_its_frame(qapp: QApplication, file: Path, text: float) -> None:
    look.apply_text_size(qapp, text)
    window = QWidget()
    look.open_within_screen(window, QSize(1480, 940))
    free = window.screen().availableSize()
    assert window.width() <= free.width() - 16 and window.height() <= free.height() - 40
