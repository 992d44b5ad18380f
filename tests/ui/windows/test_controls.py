"""Boxes have edges and signs that are seen, light and dark."""

from collections.abc import Callable, Iterator

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QApplication, QCheckBox, QLineEdit, QTreeWidget, QTreeWidgetItem, QWidget
from pytestqt.qtbot import QtBot

from ui.model.shared.theme import DARK, LIGHT, Palette, contrast
from ui.windows.controls import ChoiceBox
from ui.windows.look import apply_palette


@pytest.fixture(params=[LIGHT, DARK], ids=["light", "dark"])
def palette(request: pytest.FixtureRequest, qapp: QApplication) -> Iterator[Palette]:
    apply_palette(qapp, request.param)
    yield request.param
    apply_palette(qapp, LIGHT)


def drawn(qtbot: QtBot, widget: QWidget) -> QImage:
    qtbot.addWidget(widget)
    widget.resize(160, 32)
    with qtbot.waitExposed(widget):
        widget.show()
    return widget.grab().toImage()


def colours_across(image: QImage, row: int, least: int, most: int) -> set[str]:
    return {image.pixelColor(x, row).name() for x in range(least, most)}


@pytest.mark.parametrize("made", [QLineEdit, ChoiceBox, lambda: QCheckBox("")], ids=["line", "choices", "tick"])
def test_edges_stand_out(qtbot: QtBot, palette: Palette, made) -> None:
    image = drawn(qtbot, made())
    inside = image.pixelColor(8, 16).name()
    assert max(contrast(colour, inside) for colour in colours_across(image, 16, 0, 3)) >= 3.0


def ticked_box() -> QWidget:
    box = QCheckBox("")
    box.setChecked(True)
    return box


def ticked_row() -> QWidget:
    tree = QTreeWidget()
    tree.setHeaderHidden(True)
    tree.setRootIsDecorated(False)
    row = QTreeWidgetItem(tree, [""])
    row.setCheckState(0, Qt.CheckState.Checked)
    return tree


@pytest.mark.parametrize("made", [ticked_box, ticked_row])
def test_a_tick_is_told_by_its_shape_too(qtbot: QtBot, palette: Palette, made: Callable[[], QWidget]) -> None:
    image = drawn(qtbot, made())
    seen = {image.pixelColor(x, y).name() for x in range(24) for y in range(image.height())}
    assert {palette.accent, palette.on_accent} <= seen


def test_choices_have_an_arrow(qtbot: QtBot, palette: Palette) -> None:
    image = drawn(qtbot, ChoiceBox())
    assert max(contrast(colour, palette.panel) for colour in colours_across(image, 16, 138, 150)) >= 3.0
