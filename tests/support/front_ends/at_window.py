"""Person at the participant's window, read from its widgets and from what they paint."""

import re
from collections.abc import Iterator
from typing import TypeVar

from PySide6.QtCore import QBuffer, QPoint, Qt
from PySide6.QtGui import QPainter
from PySide6.QtSvg import QSvgGenerator
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLabel, QWidget

from tests.support.front_ends.person import Person
from tests.support.front_ends.shown import Offer, Shown
from thbridge.app.compose.setting import texts_of
from thbridge.dialogue.wording.texts import Texts
from thbridge.roles.participant.tabui import ParticipantUpdate, TabUI
from thbridge.study.study_file import Study
from ui.model.playing.keys import shown_key
from ui.model.playing.participant import Participant
from ui.model.playing.screen import Act, PickName
from ui.model.shared.theme import LIGHT
from ui.windows.participant import ParticipantWindow
from ui.windows.participant.pages.pages import KeyCap, window_keys
from ui.windows.participant.popups.finding import TreasureFacts
from ui.windows.participant.widgets.buttons import ParticipantButton
from ui.windows.participant.widgets.panels import SpeechBubble, TitledPanel

WidgetT = TypeVar("WidgetT", bound=QWidget)

SIZE = (1900, 1200)
"""Width and height of the window: no text is cut off."""


class WindowPerson(Person):
    """Person at the window, who uses the mouse.

    Attributes:
        window: the window; the caller frees it.
    """

    def __init__(self, study: Study) -> None:
        self._model = Participant(texts=texts_of(study, None), once=True)
        self._model.connected(0.0)
        super().__init__(study, TabUI(self, self))
        self.window = ParticipantWindow(self._model, lambda: self.now, LIGHT)
        self.window.resize(*SIZE)
        self.window.show()

    def observe(self, level: ParticipantUpdate) -> None:
        """Pass on a message of the game; see `ParticipantObserver`."""
        self._model.receive(level, self.now)

    def requests(self, _view: object) -> tuple[object, ...]:
        """Return the requests of the window; see `Player`."""
        return self._model.requests()

    def look(self) -> None:
        """Draw the present state."""
        self.window.refresh()

    def press(self, act: Act) -> None:
        """Click the button of an act, or the name in the list. If the act is impossible, press its key.

        A click on such a button shows the reason next to it, and a key shows it in the banner.
        """
        QApplication.processEvents()
        if isinstance(act, PickName):
            names = self.window.treasure.names
            texts = [names.item(row) for row in range(names.count())]
            # A word at the beginning of a line has a capital letter.
            word = self._word(act.name or "").casefold()
            item = next(each for each in texts if each.text().casefold().startswith(word))
            names.scrollToItem(item)
            QTest.mouseClick(names.viewport(), Qt.MouseButton.LeftButton, pos=names.visualItemRect(item).center())
            return
        button = next(each for each in _buttons(self.window) if each.act == act)
        if button.face is not None and not button.face.enabled:
            self.window.do(act)
            return
        self._bring_into_sight(button)
        QTest.mouseClick(button, Qt.MouseButton.LeftButton)

    def _word(self, name: str) -> str:
        view = self.tabui.view
        return name if view is None else view.word_for(name)

    def _bring_into_sight(self, button: ParticipantButton) -> None:
        middle = button.mapTo(self.window, QPoint(button.width() // 2, button.height() // 2))
        assert self.window.rect().contains(middle), f"{button.act} is not in the window"

    def shown(self) -> Shown:
        """Read the window."""
        for _ in range(2):  # The second time lays out what the first one has made.
            QApplication.processEvents()
        return read_window(self.window, self._model.texts)


def read_window(window: ParticipantWindow, texts: Texts) -> Shown:
    """Return what the window shows, without the keys on the help sheet that a browser has for itself."""
    shown = Shown()
    for button in _buttons(window):
        face = button.face
        if button.act is None or face is None:
            continue
        # The label of a key is what the button paints; the name is what a screen reader reads.
        key = shown_key(texts, face.key) if face.key else ""
        shown.offers[button.act] = Offer(face.label, key, face.hint, face.enabled, face.busy, button.accessibleName())
    shown.put("banner", window.map_area.banner.accessibleName() if window.map_area.banner.isVisible() else "")
    shown.put("top", *_labels(window.top))
    shown.put("score", window.top.score.accessibleName())
    shown.put("remark", window.column.hint.text())
    shown.put("queue", *_labels(window.waiting))
    shown.put("waiting", *(chip.accessibleName() for chip in window.waiting.chips if not chip.isHidden()))
    shown.put("history", *window.history.toPlainText().splitlines())
    shown.put("cards", *(painted(card.face) for card in window.column.cards.cards))
    shown.put("tiles", *(painted(tile) for tile in window.column.tiles.tiles))
    if window.dialogue.isVisible():
        panel = window.dialogue
        shown.put("dialogue", *_labels(panel))
        shown.put("sentences", *(each.accessibleName() for each in _visible(panel, SpeechBubble)))
        shown.put("facts", *_facts(panel))
        shown.put("picture", "picture" if panel.picture.isVisible() else "")
    if window.treasure.isVisible():
        panel = window.treasure
        named = panel.name_it.face
        # A low pop-up has the cost and gain of a name below the list instead of on the button.
        shown.put("treasure", *(each for each in _labels(panel) if named is None or each != named.hint))
        shown.put("facts", *_facts(panel))
        if panel.picture.isVisible():
            shown.put("picture", painted(panel.picture) or "picture")
        if panel.verdict.isVisible():
            points, _, verdict = painted(panel.verdict).partition(" ")
            shown.put("verdict", points, verdict)
        items = [panel.names.item(row) for row in range(panel.names.count())]
        shown.names = tuple((item.text(), item.isSelected()) for item in items)
    if window.question.isVisible():
        shown.put("question", *_labels(window.question))
    if window.ending.isVisible():
        title, *lines = _labels(window.ending)
        shown.put("ending", title, *(line for text in lines for line in text.split("\n")))
    if window.help.isVisible():
        _read_help(window.help, texts, shown)
    shown.put("enlarged", "picture" if window.large.isVisible() else "")
    return shown


def _read_help(sheet: TitledPanel, texts: Texts, shown: Shown) -> None:
    keys = [cap.accessibleName() for cap in _visible(sheet, KeyCap)]
    texts_below = _labels(sheet)[1:]
    count = len(texts_below) - len(keys)
    rules, effects = texts_below[:count], texts_below[count:]
    # A browser has Ctrl+Tab and Ctrl+Q for itself.
    part, *_, close = window_keys(texts)
    # It has another key for the next part, and calls itself a page.
    in_browser = ("F6", texts.text("browser.pages.key_next_part"))
    lines = [line for line in zip(keys, effects, strict=True) if line != close]
    shown.put("rules", *rules)
    shown.put("help", *(" ".join(in_browser if line == part else line) for line in lines))


def _buttons(window: QWidget) -> list[ParticipantButton]:
    return [button for button in window.findChildren(ParticipantButton) if button.isVisible() and button.isEnabled()]


def _visible(inside: QWidget, kind: type[WidgetT]) -> Iterator[WidgetT]:
    return (each for each in inside.findChildren(kind) if each.isVisible())


def _labels(inside: QWidget) -> list[str]:
    return [label.text() for label in _visible(inside, QLabel) if label.text()]


def _facts(panel: QWidget) -> list[str]:
    return [painted(each) for each in _visible(panel, TreasureFacts)]


def painted(widget: QWidget) -> str:
    """Return the words that a widget paints, in the order of painting."""
    out = QBuffer()
    drawing = QSvgGenerator()
    drawing.setOutputDevice(out)
    drawing.setSize(widget.size())
    painter = QPainter(drawing)
    widget.render(painter, QPoint(0, 0))
    painter.end()
    svg = bytes(out.data().data()).decode()
    words = re.findall(r"<text[^>]*>(.*?)</text>", svg, re.DOTALL)
    return " ".join(word.strip() for word in words)
