"""The window of an arena can be used at all sizes, with text of all sizes."""

import pytest
from PySide6.QtWidgets import QApplication

from tests.support.windows.layout_faults import SIZES, TEXTS, misfits, settle
from ui.windows import look
from ui.windows.arena.window import ArenaWindow


@pytest.mark.parametrize("text", TEXTS)
def test_nothing_is_cut_off_or_covered(window: ArenaWindow, qapp: QApplication, text: float) -> None:
    look.apply_text_size(qapp, text)
    try:
        for refusal in ("", "No robot can turn there: it needs 0.35 m to the nearest wall."):
            window.pointer.refusal = refusal
            window.show_all()
            for size in SIZES:
                window.resize(*size)
                settle()
                assert window.size().toTuple() == size, "nothing makes it larger"
                assert misfits(window) == [], size
    finally:
        look.apply_text_size(qapp, 1.0)
