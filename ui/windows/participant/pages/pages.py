"""Pages that fill or cover the window: connecting, consent, a question, help, and the end of the game."""

from collections.abc import Callable

from PySide6.QtCore import QElapsedTimer, QRectF, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QHideEvent, QKeySequence, QPaintEvent, QShortcut, QShowEvent
from PySide6.QtWidgets import (
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QProgressBar,
    QScrollArea,
    QVBoxLayout,
    QWidget,
)

from thbridge.dialogue.wording.texts import Texts
from ui.model.playing.keys import button_keys, keyed, shown_key
from ui.model.playing.screen import Action, Confirmation, DeclineConsentAct, GameOverPage, GiveConsentAct, ShowHelp
from ui.windows import look
from ui.windows.look import GAP, colours, follow_text, smooth_painter, spaced
from ui.windows.participant.widgets.buttons import ActionButton, ActionRow, ActionWidget, ButtonFace
from ui.windows.participant.widgets.focus import make_region
from ui.windows.participant.widgets.painting import key_cap, key_size
from ui.windows.participant.widgets.panels import TitledPanel, page_column, set_text
from ui.windows.participant.widgets.reading import ReadingText

FILLS = 1000
"""Stretch factor of a text, which gets all the space that it needs before the empty space around it grows."""


def page_keys(texts: Texts) -> tuple[tuple[str, str], ...]:
    """Return the keys that work on every page, with descriptions, for people who move from button to button."""
    return *button_keys(texts), (shown_key(texts, "Ctrl+Q"), texts.text("pages.key_close"))


def window_keys(texts: Texts) -> tuple[tuple[str, str], ...]:
    """Return the keys of the window that do not belong to the game, with descriptions."""
    keys = texts.text("keys.one_or_other", key="F6", other_key=shown_key(texts, "Ctrl+Tab"))
    return (keys, texts.text("pages.key_next_part")), *page_keys(texts)


class ConnectingPage(QWidget):
    """Page before the game, which shows the reason for waiting and the waiting time so far.

    Args:
        texts: texts in the window's language.
        parent: parent widget.
        can_cancel: True to show the button *Cancel*.

    Attributes:
        cancelled: signal: the participant does not want to wait any longer.
    """

    cancelled = Signal()

    def __init__(self, texts: Texts, parent: QWidget | None = None, *, can_cancel: bool = False) -> None:
        super().__init__(parent)
        self._texts = texts
        make_region(self, texts.text("pages.connecting"))
        # Keep the focus on the page. A second press of Enter, meant for the previous page, must not cancel.
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        rows = spaced(QVBoxLayout(self), GAP, 4 * GAP)
        self._title = look.label(texts.text("pages.one_moment"), "hero", bold=True)
        self._what = look.label(size="title", muted=True)
        self.bar, self.waited = QProgressBar(), look.label(muted=True)
        self.bar.setRange(0, 0)  # Busy indicator, because the duration is unknown.
        self.bar.setTextVisible(False)
        self.bar.setAccessibleName(texts.text("pages.one_moment"))
        follow_text(self.bar, lambda bar: bar.setFixedWidth(look.px(280)))
        self.cancel = ActionButton(texts)
        label = texts.text("pages.cancel")
        self.cancel.show_face(ButtonFace(label, "Esc"), label)
        self.cancel.clicked.connect(self.cancelled)
        if not can_cancel:
            self.cancel.hide()
        rows.addStretch(2)
        for line in (self._title, self._what, self.bar, self.waited, self.cancel):
            if isinstance(line, QLabel):
                line.setAlignment(Qt.AlignmentFlag.AlignCenter)
                rows.addWidget(line)
            else:
                rows.addWidget(line, 0, Qt.AlignmentFlag.AlignHCenter)
        rows.addStretch(3)
        if can_cancel:
            QShortcut(QKeySequence("Esc"), self, self.cancel.click)
        self._since = QElapsedTimer()
        self._counting = QTimer(self, interval=1000)
        self._counting.timeout.connect(self._count)

    def show_waiting(self, text: str) -> None:
        """Show the reason for waiting."""
        set_text(self._what, text)

    def showEvent(self, event: QShowEvent) -> None:
        """Start to count the seconds of waiting."""
        super().showEvent(event)
        self._since.start()
        self._count()
        self._counting.start()

    def hideEvent(self, event: QHideEvent) -> None:
        """Stop the count of seconds."""
        super().hideEvent(event)
        self._counting.stop()

    def _count(self) -> None:
        set_text(self.waited, self._texts.text("pages.waited", count=round(self._since.elapsed() / 1000)))


class ConsentPage(ActionWidget):
    """Page with the text of a consent, and the buttons to agree and to decline."""

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        make_region(self, texts.text("pages.consent"))
        rows = spaced(page_column(self, 760), 2 * GAP, 0)
        rows.addStretch(2)
        rows.addWidget(look.label(texts.text("pages.before"), "hero", bold=True))
        self._text = ReadingText(texts.text("pages.agree_to"))
        rows.addWidget(self._text, FILLS)
        # Both buttons look equally important, because the study must not suggest an answer.
        self.decline, self.agree = ActionButton(texts, hints=True), ActionButton(texts, hints=True)
        foot = _foot(rows)
        for button in (self.decline, self.agree):
            button.requested.connect(self.requested)
            foot.addWidget(button)
        rows.addStretch(3)

    def show_consent(self, text: str, agree: Action, decline: Action, *, markdown: bool = False) -> None:
        """Show this consent."""
        self._text.show_text(text, markdown=markdown)
        self.agree.show_action(agree)
        self.decline.show_action(decline)


def consent_page(
    texts: Texts, text: str, answered: Callable[[bool], None], hint_of_no: str, *, markdown: bool = False
) -> ConsentPage:
    """Return a consent page for use outside a game; the page handles its own keys.

    Args:
        texts: texts in the window's language.
        text: text of the consent.
        answered: function to call with the answer; True means that the person takes part.
        hint_of_no: consequences of declining.
        markdown: True if the text is Markdown.
    """
    page = ConsentPage(texts)
    agree = keyed(GiveConsentAct(), texts.text("game.agree"), hint=texts.text("game.agree_hint"))
    decline = keyed(DeclineConsentAct(), texts.text("game.decline"), hint=hint_of_no)
    page.show_consent(text, agree, decline, markdown=markdown)
    page.requested.connect(lambda act: answered(isinstance(act, GiveConsentAct)))
    for button in (page.agree, page.decline):
        QShortcut(QKeySequence(button.face.key if button.face else ""), page).activated.connect(button.click)
    return page


class ThanksPage(QWidget):
    """Page for a person who does not take part.

    Attributes:
        close_button: button that closes the window.
    """

    def __init__(self, texts: Texts, text: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        make_region(self, texts.text("pages.thanks"))
        rows = spaced(page_column(self, 680), 2 * GAP)
        rows.addStretch(2)
        rows.addWidget(look.label(texts.text("pages.thanks"), "hero", bold=True))
        rows.addWidget(look.label(text, "title"))
        self.close_button = ActionButton(texts, "main")
        self.close_button.show_face(ButtonFace(texts.text("popups.close"), "Enter"), texts.text("pages.close_window"))
        for enter in ("Return", "Enter"):
            QShortcut(QKeySequence(enter), self).activated.connect(self.close_button.click)
        _foot(rows).addWidget(self.close_button)
        rows.addStretch(3)


class QuestionPanel(TitledPanel):
    """Panel with a question that asks the person to confirm an act."""

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(texts, texts.text("pages.question"), parent)
        self._text = look.label()
        self.rows.addWidget(self._text, 1)
        foot = _foot(self.rows)
        # The default button must not confirm an act that cannot be undone.
        self.no, self.yes = ActionButton(texts, "main", hints=True), ActionButton(texts, hints=True)
        for button in (self.no, self.yes):
            button.requested.connect(self.requested)
            foot.addWidget(button)
        self.others = ActionRow(texts, foot, self.requested, hints=True)

    def show_question(self, question: Confirmation) -> None:
        """Show this question."""
        self.entitle(question.title)
        set_text(self._text, question.text)
        self.yes.show_action(question.yes)
        self.no.show_action(question.no)
        self.others.show_actions(question.others)


class EndingPanel(TitledPanel):
    """Panel at the end of the game."""

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(texts, texts.text("pages.game_over"), parent)
        self._lines = look.label()
        self._lines.setAlignment(Qt.AlignmentFlag.AlignTop)
        self._area = _text_area(self._lines, texts.text("pages.how_it_ended"))
        self.again = ActionButton(texts, "main")
        self.again.requested.connect(self.requested)
        self.rows.addWidget(self._area, 1)
        self.rows.addWidget(self.again)
        self._ways = [self.again]

    def add_way_back(self, button: ActionButton) -> None:
        """Add a button that leaves the game, below the button for the next game."""
        self._ways.append(button)
        self.rows.addWidget(button)

    def show_ending(self, ending: GameOverPage) -> None:
        """Show this end of the game."""
        self.entitle(ending.title)
        set_text(self._lines, "\n".join(ending.lines))
        self.again.show_action(ending.again)

    def wanted(self, width: int, height: int) -> QSize:
        """Return the size at which all lines fit, but at most the available space.

        If the space is too small, the lines scroll.
        """
        lines = max(self._lines.heightForWidth(width - 8 * GAP), self._area.minimumSizeHint().height())
        ways = sum(way.sizeHint().height() + self.rows.spacing() for way in self._ways)
        around = self.top.sizeHint().height() + ways + 8 * GAP
        return QSize(width, min(height, lines + around))


class KeyCap(QWidget):
    """Widget that shows keys in the same form as on buttons."""

    def __init__(self, keys: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._keys = keys
        self.setAccessibleName(keys)
        follow_text(self, KeyCap._fit)

    def _fit(self) -> None:
        wide, high = key_size(self._keys)
        self.setFixedSize(QSize(int(wide) + 2, int(high) + 2))

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw the keys."""
        painter = smooth_painter(self)
        key_cap(painter, QRectF(self.rect()).adjusted(1, 1, -1, -1), self._keys, colours().text)


class HelpSheet(TitledPanel):
    """Sheet with the rules, and with all keys and their effects. In a study, it also shows the study's instructions.

    Attributes:
        instructions: texts above the rules, each with a flag: True for Markdown.
    """

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(texts, texts.text("pages.rules_and_keys"), parent)
        self.instructions: tuple[tuple[str, bool], ...] = ()
        self.close_button = ActionButton(texts)
        self.close_button.requested.connect(self.requested)
        self.top.addWidget(self.close_button)
        self._area = _text_area(None, texts.text("pages.rules_and_meanings"))
        self.rows.addWidget(self._area, 1)
        self._shown: tuple[object, ...] | None = None

    def show_help(self, rules: tuple[str, ...], lines: tuple[tuple[str, str], ...], key: str) -> None:
        """Show these rules and keys; `key` closes the sheet."""
        self.close_button.show_action(Action(ShowHelp(), self._texts.text("popups.close"), key))
        if (rules, lines, self.instructions) == self._shown:
            return
        self._shown = rules, lines, self.instructions
        title = self._texts.text(self._title_key(has_keys=bool(lines)))
        self.entitle(title)
        self._area.setAccessibleName(title)
        inside = QWidget()
        grid = QGridLayout(inside)
        grid.setContentsMargins(0, 0, GAP, 0)
        grid.setHorizontalSpacing(2 * GAP)
        grid.setVerticalSpacing(int(0.75 * GAP))
        grid.setColumnStretch(1, 1)
        for row, (text, markdown) in enumerate(self.instructions):
            shown = ReadingText(self._texts.text("pages.instructions"), whole=True)
            shown.show_text(text, markdown=markdown)
            grid.addWidget(shown, row, 0, 1, 2)
        above = len(self.instructions)
        for row, rule in enumerate(rules, above):
            grid.addWidget(look.label(rule), row, 0, 1, 2)
        for row, (keys, does) in enumerate(lines, above + len(rules)):
            grid.addWidget(KeyCap(keys), row, 0, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
            grid.addWidget(look.label(does), row, 1)
        self._area.setWidget(inside)
        inside.setAutoFillBackground(False)

    def _title_key(self, *, has_keys: bool) -> str:
        """Return the name of the text that is the title."""
        if not self.instructions:
            return "pages.rules_and_keys"
        return "pages.instructions_and_rules" if has_keys else "pages.instructions"

    def wanted(self, width: int, height: int) -> QSize:
        """Return the size at which all lines fit, but at most the available space."""
        inside = self._area.widget()
        lines = inside.sizeHint().height() if inside is not None else 0
        return QSize(width, min(height, lines + self.top.sizeHint().height() + 6 * GAP))


def _text_area(inside: QWidget | None, name: str) -> QScrollArea:
    """Return a scroll area for a text. Its name is for screen readers."""
    area = QScrollArea(widgetResizable=True)
    area.setFrameShape(QFrame.Shape.NoFrame)
    area.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    area.setAccessibleName(name)
    area.viewport().setAutoFillBackground(False)
    if inside is not None:
        area.setWidget(inside)
        inside.setAutoFillBackground(False)
    return area


def _foot(rows: QVBoxLayout) -> QHBoxLayout:
    """Add a row below the other rows, and align its widgets to the right.

    The row is added while it is empty. If a layout that contains a spacer is added, PySide treats the spacer as an
    object that Python owns, and deletes the spacer a second time.
    """
    row = QHBoxLayout()
    rows.addLayout(row)
    row.setSpacing(GAP)
    row.addStretch(1)
    return row
