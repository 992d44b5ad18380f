"""The researcher's window can be used at all sizes, with text of all sizes."""

import pytest
from PySide6.QtWidgets import QApplication

from tests.support.windows.layout_faults import SIZES, TEXTS, misfits, settle
from ui.windows import look
from ui.windows.key_sheet import KeySheet
from ui.windows.researcher.keys import GROUPS
from ui.windows.researcher.window import ResearcherWindow


@pytest.mark.parametrize("text", TEXTS)
def test_nothing_is_cut_off_or_covered(opened: ResearcherWindow, qapp: QApplication, text: float) -> None:
    look.apply_text_size(qapp, text)
    try:
        for size in SIZES:
            opened.resize(*size)
            settle()
            assert opened.size().toTuple() == size, "nothing makes it larger"
            assert misfits(opened) == [], size
    finally:
        look.apply_text_size(qapp, 1.0)


@pytest.mark.parametrize("text", TEXTS)
def test_the_sheet_of_keys_opens_within_the_screen(opened: ResearcherWindow, qapp: QApplication, text: float) -> None:
    look.apply_text_size(qapp, text)
    try:
        sheet = KeySheet(opened, GROUPS)
        sheet.open()
        settle()
        assert misfits(sheet) == []
        free = sheet.screen().availableSize()
        assert sheet.width() <= free.width() and sheet.height() <= free.height()
        sheet.close()
    finally:
        look.apply_text_size(qapp, 1.0)
