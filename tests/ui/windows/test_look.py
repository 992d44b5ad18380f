"""Windows are light or dark as the system or the person wants, and legible."""

from collections.abc import Iterator

import pytest
from PySide6.QtWidgets import QApplication, QMessageBox, QStyle
from pytestqt.qtbot import QtBot

from ui.model.shared.theme import DARK, LIGHT, contrast
from ui.windows import look


def test_type_is_never_smaller_than_what_reads_well(qapp: QApplication) -> None:
    look.apply_palette(qapp, LIGHT)
    once = look.font().pointSizeF()
    look.apply_palette(qapp, LIGHT)
    assert look.font().pointSizeF() == once >= 10.5, "dressing twice does not grow the type"
    assert look.font("small").pointSizeF() >= 9.0


@pytest.mark.parametrize("palette", [LIGHT, DARK], ids=["light", "dark"])
def test_the_number_on_a_robots_chip_can_be_read(qapp: QApplication, palette) -> None:
    look.apply_palette(qapp, palette)
    assert all(contrast(look.text_colour_on(robot), robot) >= 4.5 for robot in palette.robots)
    look.apply_palette(qapp, LIGHT)


class IconStyle(look.WindowStyle):
    """Qt's style as on desktops whose buttons have icons."""

    def styleHint(self, hint: QStyle.StyleHint, *others: object) -> int:
        return int(hint is QStyle.StyleHint.SH_DialogButtonBox_ButtonsHaveIcons) or super().styleHint(hint, *others)


@pytest.fixture
def icons_on_buttons(qapp: QApplication) -> Iterator[None]:
    look.apply_palette(qapp, LIGHT)
    qapp.setStyle(IconStyle())
    yield
    qapp.setStyle(look.WindowStyle())


@pytest.mark.usefixtures("icons_on_buttons")
def test_boxes_have_flat_signs_and_buttons_without_icons(qtbot: QtBot) -> None:
    box = QMessageBox(QMessageBox.Icon.Warning, "Desk", "Close the desk?")
    qtbot.addWidget(box)
    cancel = box.addButton(QMessageBox.StandardButton.Cancel)
    box.show()
    assert cancel.icon().isNull()
    sign = box.iconPixmap().toImage()
    assert sign.pixelColor(sign.width() // 4, sign.height() // 2).name() == LIGHT.bad
