"""Page before a game, with an introduction, a choice of the number of robots, and a practice game."""

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QKeySequence, QResizeEvent, QShortcut
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QWidget

from thbridge.dialogue.wording.texts import Texts
from ui.model.playing.keys import HELP, SETTINGS_KEYS, help_line, shown_key
from ui.windows import look
from ui.windows.look import GAP, spaced
from ui.windows.participant.pages.pages import HelpSheet, page_keys
from ui.windows.participant.widgets.buttons import ActionButton, ButtonFace
from ui.windows.participant.widgets.focus import make_region
from ui.windows.participant.widgets.panels import ModalOverlay, page_column

_LAST_DIGIT = 9
_IN_A_ROW = 5
"""Maximum number of choices in a row."""


class StartPage(QWidget):
    """Page that asks for the number of robots.

    Args:
        texts: texts in the window's language.
        least: smallest number of robots to choose from.
        most: maximum number of robots to choose from.
        usual: number of robots that is selected at first.
        rules: rules of the game, in sentences.
        parent: parent widget.

    Attributes:
        start: signal: start a game with this number of robots.
        tutorial: signal: start the practice game.
        settings_wanted: signal: open the settings.
    """

    start = Signal(int)
    tutorial = Signal()
    settings_wanted = Signal()

    def __init__(
        self,
        texts: Texts,
        least: int,
        most: int,
        usual: int,
        rules: tuple[str, ...] = (),
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self._texts = texts
        make_region(self, texts.text("start.start"))
        self._number = usual
        rows = spaced(page_column(self, 680), 2 * GAP)
        rows.addStretch(2)
        head = spaced(QHBoxLayout(), GAP)
        head.addWidget(look.label(texts.text("window.title"), "hero", bold=True), 1)
        self.settings = ActionButton(texts, "small")
        settings = texts.text("settings.title")
        self.settings.show_face(ButtonFace(settings, SETTINGS_KEYS), settings)
        self.settings.clicked.connect(self.settings_wanted)
        head.addWidget(self.settings)
        rows.addLayout(head)
        rows.addWidget(look.label(texts.text("start.introduction")))
        rows.addSpacing(GAP)
        asks = most > least
        heading = texts.text("start.how_many") if asks else texts.text("start.you_command", count=usual)
        rows.addWidget(look.label(heading, "title", bold=asks))
        self.choices = {number: self._choice(number) for number in range(least, most + 1)}
        grid = spaced(QGridLayout(), GAP)
        lines = -(-len(self.choices) // _IN_A_ROW)
        in_a_line = -(-len(self.choices) // lines)
        for at, button in enumerate(self.choices.values()):
            grid.addWidget(button, at // in_a_line, at % in_a_line)
        rows.addLayout(grid)
        for button in self.choices.values():
            button.setVisible(asks)
        rows.addSpacing(2 * GAP)
        self.sheet, self.practise = ActionButton(texts, hints=True), ActionButton(texts, hints=True)
        self.begin = ActionButton(texts, "main", hints=True)
        sheet = texts.text("pages.rules_and_keys")
        self.sheet.show_face(ButtonFace(sheet, HELP.keys[0]), sheet)
        self.sheet.clicked.connect(self._toggle_help)
        self.practise.show_face(ButtonFace(texts.text("start.try_out"), "T"), texts.text("start.try_out_hint"))
        self.practise.clicked.connect(self.tutorial)
        self.begin.clicked.connect(lambda: self.start.emit(self._number))
        foot = spaced(QHBoxLayout(), GAP)
        foot.addWidget(self.sheet, 1)
        foot.addWidget(self.practise, 1)
        foot.addWidget(self.begin, 1)
        rows.addLayout(foot)
        rows.addStretch(3)
        self._rules = rules
        self.overlay, self.help = ModalOverlay(self), HelpSheet(texts)
        self.help.requested.connect(self._toggle_help)
        for help_key in HELP.keys:
            self._shortcut(help_key).activated.connect(self._toggle_help)
        self._closing = self._shortcut("Esc")
        self._closing.activated.connect(self._toggle_help)
        self._closing.setEnabled(False)
        for number, button in self.choices.items():
            if number <= _LAST_DIGIT:
                self._key(str(number), button)
        self._key("T", self.practise)
        for enter in ("Return", "Enter"):
            self._shortcut(enter).activated.connect(self._enter)
        self.choose(usual)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setFocus()

    def choose(self, number: int) -> None:
        """Choose this number of robots."""
        self._number = number
        for other, button in self.choices.items():
            button.setChecked(other == number)
        words = self._texts.text("start.begin", count=number)
        self.begin.show_face(ButtonFace(words, "Enter"), words)

    def _toggle_help(self) -> None:
        """Open or close the sheet of rules and keys."""
        opens = not self.overlay.isVisible()
        if opens:
            self.help.show_help(self._rules, self._key_lines(), HELP.keys[0])
        self.overlay.show_panel(self.help if opens else None, 720)
        self._closing.setEnabled(opens)
        (self.help.close_button if opens else self).setFocus()

    def focusNextPrevChild(self, forward: bool) -> bool:
        """Let Tab move only within the overlay while it is shown."""
        return self.overlay.keeps_tab(forward=forward) or super().focusNextPrevChild(forward)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Give the overlay the size of the page."""
        super().resizeEvent(event)
        self.overlay.setGeometry(self.rect())

    def _choice(self, number: int) -> ActionButton:
        button = ActionButton(self._texts, "large")
        button.setCheckable(True)
        # The label is the key, so no key is printed next to it.
        button.show_face(ButtonFace(str(number)), self._texts.text("words.robots", count=number))
        button.clicked.connect(lambda: self.choose(number))
        return button

    def _key_lines(self) -> tuple[tuple[str, str], ...]:
        """Return the keys of this page, with descriptions, for the sheet of rules and keys."""
        texts = self._texts
        digits = [str(number) for number in self.choices if number <= _LAST_DIGIT]
        asks = len(self.choices) > 1 and digits
        numbers = texts.text("keys.one_to_other", key=digits[0], other_key=digits[-1]) if asks else ""
        return (
            *([(numbers, texts.text("start.key_numbers"))] if asks else []),
            ("T", texts.text("start.try_out_hint")),
            (shown_key(texts, "Enter"), texts.text("start.key_begin")),
            help_line(texts, HELP),
            (shown_key(texts, "Tab"), texts.text("start.key_tab")),
            *page_keys(texts),
        )

    def _enter(self) -> None:
        """Start the game. If the sheet of rules and keys is open, close the sheet instead."""
        if self.overlay.isVisible():
            self._toggle_help()
        else:
            self.begin.click()

    def _key(self, key: str, button: ActionButton) -> None:
        self._shortcut(key).activated.connect(lambda: None if self.overlay.isVisible() else button.click())

    def _shortcut(self, key: str) -> QShortcut:
        shortcut = QShortcut(QKeySequence(key), self)
        shortcut.setContext(Qt.ShortcutContext.WidgetWithChildrenShortcut)
        shortcut.setAutoRepeat(False)
        return shortcut
