"""The page before a game: an introduction, the number of robots, and a practice game."""

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QKeySequence, QResizeEvent, QShortcut
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QWidget

from thbridge.files.language_texts import shipped_texts
from ui.model.keys import HELP, help_line
from ui.windows import look
from ui.windows.look import GAP, spaced
from ui.windows.participant.pages.pages import PAGE_KEYS, HelpSheet
from ui.windows.participant.widgets.buttons import ActionButton, ButtonFace
from ui.windows.participant.widgets.focus import make_region
from ui.windows.participant.widgets.panels import ModalOverlay, page_column

INTRODUCTION = (
    "Treasures are hidden in the rooms of this house. Your robots find them, and you decide together where each robot "
    "goes, and what it has found. Every move costs energy, and so does every picture. Name a treasure right to win its "
    "points; a wrong name loses some."
)

_LAST_DIGIT = 9
_IN_A_ROW = 5
"""Most choices side by side."""


class StartPage(QWidget):
    """Asks how many robots shall play.

    Attributes:
        start: begin a game with so many robots.
        tutorial: begin the practice game.
    """

    start = Signal(int)
    tutorial = Signal()

    def __init__(
        self, least: int, most: int, usual: int, rules: tuple[str, ...] = (), parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        make_region(self, "Start")
        self._number = usual
        rows = spaced(page_column(self, 680), 2 * GAP)
        rows.addStretch(2)
        rows.addWidget(look.label("Treasure hunt", "hero", bold=True))
        rows.addWidget(look.label(INTRODUCTION))
        rows.addSpacing(GAP)
        asks = most > least
        heading = "How many robots?" if asks else f"You will command {_robots(usual)}."
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
        self.sheet, self.practise = ActionButton(hints=True), ActionButton(hints=True)
        self.begin = ActionButton("main", hints=True)
        self.sheet.show_face(ButtonFace("Rules and keys", HELP.keys[0]), "Rules and keys")
        self.sheet.clicked.connect(self._toggle_help)
        self.practise.show_face(ButtonFace("Try it out first", "T"), "Try it out first: a short practice game")
        self.practise.clicked.connect(self.tutorial)
        self.begin.clicked.connect(lambda: self.start.emit(self._number))
        foot = spaced(QHBoxLayout(), GAP)
        foot.addWidget(self.sheet, 1)
        foot.addWidget(self.practise, 1)
        foot.addWidget(self.begin, 1)
        rows.addLayout(foot)
        rows.addStretch(3)
        self._rules = rules
        self.overlay, self.help = ModalOverlay(self), HelpSheet()
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
        """Choose so many robots."""
        self._number = number
        for other, button in self.choices.items():
            button.setChecked(other == number)
        words = f"Start with {_robots(number)}"
        self.begin.show_face(ButtonFace(words, "Enter"), words)

    def _toggle_help(self) -> None:
        """Open the sheet of rules and keys, or close it."""
        opens = not self.overlay.isVisible()
        if opens:
            self.help.show_help(self._rules, self._key_lines(), HELP.keys[0])
        self.overlay.show_panel(self.help if opens else None, 720)
        self._closing.setEnabled(opens)
        (self.help.close_button if opens else self).setFocus()

    def focusNextPrevChild(self, forward: bool) -> bool:
        """Keep Tab from what lies behind the overlay."""
        return self.overlay.keeps_tab(forward=forward) or super().focusNextPrevChild(forward)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Let the overlay cover all."""
        super().resizeEvent(event)
        self.overlay.setGeometry(self.rect())

    def _choice(self, number: int) -> ActionButton:
        button = ActionButton("large")
        button.setCheckable(True)
        # The number is its own key, so none is printed beside it.
        button.show_face(ButtonFace(str(number)), _robots(number))
        button.clicked.connect(lambda: self.choose(number))
        return button

    def _key_lines(self) -> tuple[tuple[str, str], ...]:
        """Keys of this page, for the sheet."""
        digits = [str(number) for number in self.choices if number <= _LAST_DIGIT]
        asks = len(self.choices) > 1 and digits
        return (
            *([(f"{digits[0]} to {digits[-1]}", "Choose how many robots")] if asks else []),
            ("T", "Try it out first: a short practice game"),
            ("Enter", "Start"),
            help_line(shipped_texts(), HELP),
            ("Tab", "Go to the next button"),
            *PAGE_KEYS,
        )

    def _enter(self) -> None:
        """Start; or close the sheet, which comes first while it is open."""
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


def _robots(number: int) -> str:
    return f"{number} robot{'s' if number > 1 else ''}"
