"""Page on which a person waits for their turn, with a clock and a button to stop waiting."""

import time
from collections.abc import Callable

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QWidget

from thbridge.dialogue.wording.texts import Texts
from ui.model.kiosk import TurnToAwait, waited_words
from ui.windows import look
from ui.windows.kiosk.pages.text import READING
from ui.windows.look import GAP, spaced
from ui.windows.participant.widgets.buttons import ActionButton, ButtonFace
from ui.windows.participant.widgets.focus import make_region
from ui.windows.participant.widgets.panels import page_column, set_text


class TurnPage(QWidget):
    """Page of a person who waits, for example for the other people of a game.

    Args:
        turn: the turn that they await.
        texts: texts of the study.
        clock: monotonic clock, seconds.

    Attributes:
        stopped: signal: the person does not want to wait any longer.
        stop: button for this.
    """

    stopped = Signal()

    def __init__(self, turn: TurnToAwait, texts: Texts, clock: Callable[[], float] = time.monotonic) -> None:
        super().__init__()
        self._texts = texts
        self._clock, self._came = clock, clock()
        make_region(self, turn.heading)
        # Keep the focus on the page. A second press of Enter, meant for the previous page, must not stop the wait.
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        rows = spaced(page_column(self, 760), 2 * GAP, 0)
        rows.addStretch(2)
        rows.addWidget(look.label(turn.heading, "hero", bold=True))
        self._text, self.waited = look.label(size="title"), look.label(muted=True)
        rows.addWidget(self._text)
        rows.addWidget(self.waited)
        self.stop = ActionButton(texts)
        label = texts.text("web.stop_waiting")
        self.stop.show_face(ButtonFace(label), label)
        self.stop.clicked.connect(self._stop)
        rows.addSpacing(GAP)
        rows.addWidget(self.stop, 0, Qt.AlignmentFlag.AlignRight)
        rows.addStretch(3)
        self.show_turn(turn)

    def show_turn(self, turn: TurnToAwait) -> None:
        """Show the text, the time waited, and the number of people who come first."""
        set_text(self._text, turn.text)
        set_text(self.waited, waited_words(self._texts, turn))

    def _stop(self) -> None:
        if self._clock() - self._came >= READING:
            self.stopped.emit()
