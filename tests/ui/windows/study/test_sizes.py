"""The study's form can be used at all sizes, with text of all sizes."""

import pytest
from PySide6.QtWidgets import QApplication

from tests.support.windows.layout_faults import SIZES, TEXTS, misfits, settle
from ui.windows import look
from ui.windows.study import StudyWindow


@pytest.mark.parametrize("text", TEXTS)
def test_nothing_is_cut_off_or_covered(window: StudyWindow, qapp: QApplication, text: float) -> None:
    look.apply_text_size(qapp, text)
    try:
        for show in (
            lambda: window.open_section("game"),
            lambda: window.open_section("noise"),
            lambda: window.search.setText("radius"),
            window.show_text,
            window.show_changes,
        ):
            show()
            for size in SIZES:
                window.resize(*size)
                settle()
                window.fields.finish()
                window.noise_fields.finish()
                settle()
                assert window.size().toTuple() == size, "nothing makes it larger"
                assert misfits(window) == [], size
    finally:
        look.apply_text_size(qapp, 1.0)


def test_what_a_small_window_has_no_width_for_is_scrolled_to(window: StudyWindow, qapp: QApplication) -> None:
    look.apply_text_size(qapp, 1.5)
    try:
        window.open_section("game")
        window.resize(800, 500)
        settle()
        window.fields.finish()
        settle()
        assert window.fields.widget().width() > window.fields.viewport().width()
        assert misfits(window) == []
    finally:
        look.apply_text_size(qapp, 1.0)
