"""Text has the size that the user wants, in all windows at once, and windows open within the screen."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from PySide6.QtCore import QSettings, QSize, Qt
from PySide6.QtWidgets import QApplication, QLabel, QMessageBox, QPushButton, QVBoxLayout, QWidget
from pytestqt.qtbot import QtBot

from ui.model.theme import LIGHT
from ui.windows import look


@pytest.fixture
def file(tmp_path: Path, qapp: QApplication) -> Iterator[Path]:
    look.apply_palette(qapp, LIGHT)
    yield tmp_path / "settings" / "windows.ini"
    look.apply_text_size(qapp, 1.0)


def text_size(qapp: QApplication, file: Path) -> look.TextSize:
    return look.TextSize(qapp, QSettings(str(file), QSettings.Format.IniFormat))


def test_keys_make_text_larger_and_smaller(qtbot: QtBot, qapp: QApplication, file: Path) -> None:
    size = text_size(qapp, file)
    window = QWidget()
    qtbot.addWidget(window)
    rows = QVBoxLayout(window)
    label, button = look.label("Room 4", "title"), QPushButton("Reset")
    rows.addWidget(label)
    rows.addWidget(button)
    size.add_keys(window)
    with qtbot.waitActive(window):
        window.show()
        window.activateWindow()
    before = label.font().pointSizeF(), button.font().pointSizeF()

    def pressed(key: Qt.Key, times: int = 1) -> tuple[float, float]:
        for _ in range(times):
            qtbot.keyClick(window, key, Qt.KeyboardModifier.ControlModifier)
        return label.font().pointSizeF() / before[0], button.font().pointSizeF() / before[1]

    assert pressed(Qt.Key.Key_Plus) == pytest.approx((1.1, 1.1))
    assert pressed(Qt.Key.Key_Equal) == pytest.approx((1.25, 1.25)), "Plus without Shift on many keyboards"
    assert pressed(Qt.Key.Key_Plus, times=9) == pytest.approx((2.0, 2.0)), "the largest"
    assert pressed(Qt.Key.Key_0) == pytest.approx((1.0, 1.0))
    assert pressed(Qt.Key.Key_Minus, times=9) == pytest.approx((0.8, 0.8)), "the smallest"


@pytest.mark.parametrize("modal", [True, False])
def test_keys_choose_the_size_in_a_box_over_the_window_too(
    qtbot: QtBot, qapp: QApplication, file: Path, modal: bool
) -> None:
    size, window = text_size(qapp, file), QWidget()
    qtbot.addWidget(window)
    inside = QVBoxLayout(window)
    opener = QPushButton("Reset")
    inside.addWidget(opener)
    size.add_keys(window)
    with qtbot.waitActive(window):
        window.show()
        window.activateWindow()

    def pressed_in_a_box() -> int:
        box = QMessageBox(QMessageBox.Icon.Question, "Robot 1", "Kill it?", parent=opener)
        box.setModal(modal)
        box.show()
        box.activateWindow()
        qtbot.waitUntil(lambda: qapp.focusWindow() == box.windowHandle())
        qtbot.keyClick(box, Qt.Key.Key_Plus, Qt.KeyboardModifier.ControlModifier)
        box.close()
        window.activateWindow()
        qtbot.waitUntil(lambda: qapp.focusWindow() == window.windowHandle())
        return size.percent

    assert [pressed_in_a_box(), pressed_in_a_box()] == [110, 125]
    qtbot.keyClick(window, Qt.Key.Key_0, Qt.KeyboardModifier.ControlModifier)
    assert size.percent == 100


def test_the_size_is_kept_and_followed_by_other_programs(qtbot: QtBot, qapp: QApplication, file: Path) -> None:
    first, other = text_size(qapp, file), text_size(qapp, file)
    first.step(1)
    qtbot.waitUntil(lambda: other.percent == first.percent == 110)
    other.step(-1)
    qtbot.waitUntil(lambda: first.percent == 100)
    first.step(-1)
    assert text_size(qapp, file).percent == 90


@pytest.mark.parametrize(("written", "percent"), [("x", 100), ("-5", 100), ("117", 110), ("9999", 200), ("", 100)])
def test_a_size_that_nobody_could_choose_does_no_harm(
    qapp: QApplication, file: Path, written: str, percent: int
) -> None:
    file.parent.mkdir()
    file.write_text(f"[text]\npercent={written}\n")
    assert text_size(qapp, file).percent == percent


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
