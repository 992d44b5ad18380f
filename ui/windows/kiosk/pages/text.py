"""Pages with a text and one button to the next page."""

import time
from collections.abc import Callable

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QKeySequence, QShortcut
from PySide6.QtWidgets import QLineEdit, QVBoxLayout, QWidget

from thbridge.dialogue.wording.texts import Texts
from ui.model.kiosk import TextToRead
from ui.windows import look
from ui.windows.look import GAP, follow_text, px, spaced
from ui.windows.participant.pages.pages import FILLS
from ui.windows.participant.widgets.buttons import ActionButton, ButtonFace
from ui.windows.participant.widgets.focus import make_region
from ui.windows.participant.widgets.panels import page_column
from ui.windows.participant.widgets.reading import ReadingText

SHORT = 500
"""Maximum number of characters of a text in the middle of the page. A longer text is in a panel that scrolls."""
READING = 0.4
"""Seconds during which a new page ignores presses, because they were meant for the previous page."""
_IN_A_GROUP = 4


class ReadingPage(QWidget):
    """Page with a text to read.

    Args:
        page: the text.
        texts: texts of the study.
        clock: monotonic clock, seconds.

    Attributes:
        went_on: signal: the person continues.
    """

    went_on = Signal()

    def __init__(self, page: TextToRead, texts: Texts, clock: Callable[[], float] = time.monotonic) -> None:
        super().__init__()
        self._clock, self._came = clock, clock()
        make_region(self, page.heading or texts.text("kiosk.text_to_read"))
        rows = spaced(page_column(self, 760), 2 * GAP, 0)
        is_short = len(page.text) <= SHORT and not page.markdown
        rows.addStretch(2)
        if page.heading:
            rows.addWidget(look.label(page.heading, "hero", bold=True))
        self.text: ReadingText | None = None
        if is_short:
            rows.addWidget(look.label(page.text.rstrip(), "title"))
        else:
            self.text = ReadingText(page.heading or texts.text("kiosk.text_to_read"))
            self.text.show_text(page.text, markdown=page.markdown)
            rows.addWidget(self.text, FILLS)
        if page.code:
            _add_code(rows, page.code, texts)
        self.go_on: ActionButton | None = None
        label = texts.text("kiosk.continue") if page.button is None else page.button
        if label:
            self.go_on = ActionButton(texts, "main")
            self.go_on.show_face(ButtonFace(label, "Enter"), label)
            if is_short:
                self.go_on.setAccessibleDescription(page.text[:SHORT])
            self.go_on.clicked.connect(self._leave)
            rows.addSpacing(GAP)
            rows.addWidget(self.go_on, 0, Qt.AlignmentFlag.AlignRight)
            for key in ("Return", "Enter"):
                shortcut = QShortcut(QKeySequence(key), self)
                shortcut.setAutoRepeat(False)
                shortcut.activated.connect(self.go_on.click)
        rows.addStretch(3)

    def start(self) -> None:
        """Give the focus to the text, or to the button."""
        target = self.text or self.go_on
        if target is not None:
            target.setFocus(Qt.FocusReason.OtherFocusReason)

    def _leave(self) -> None:
        if self._clock() - self._came >= READING:
            self.went_on.emit()


def _add_code(rows: QVBoxLayout, code: str, texts: Texts) -> None:
    rows.addWidget(look.label(texts.text("kiosk.completion_code"), bold=True))
    groups = " ".join(code[at : at + _IN_A_GROUP] for at in range(0, len(code), _IN_A_GROUP))
    shown = follow_text(QLineEdit(groups), lambda it: it.setFont(look.font("hero", bold=True)))
    shown.setReadOnly(True)
    shown.setAlignment(Qt.AlignmentFlag.AlignCenter)
    follow_text(shown, lambda it: it.setMaximumWidth(px(420)))
    shown.setAccessibleName(texts.text("kiosk.completion_code_name", code=", ".join(code)))
    rows.addWidget(shown)
    rows.addWidget(look.label(texts.text("kiosk.completion_code_blank"), "small", muted=True))
