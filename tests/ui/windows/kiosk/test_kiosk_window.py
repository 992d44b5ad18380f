"""The kiosk's window page by page, by mouse and by keyboard; it tells all that happens with an item at once."""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import msgspec
import pytest
from msgspec import structs
from PySide6.QtCore import QEvent, QMimeData, QPoint, Qt
from PySide6.QtWidgets import QApplication, QLabel, QLineEdit, QScrollArea, QToolTip, QWidget
from pytestqt.qtbot import QtBot

from tests.support.hunts.participant_views import view
from tests.support.windows.english import english_in, strings_in
from tests.support.windows.layout_faults import misfits, settle
from tests.support.windows.preferences import preferred
from tests.support.windows.screen_reader import nameless, words_in
from thbridge.dialogue.wording.texts import Texts
from thbridge.experiment.questionnaires.scoring import NOT_APPLICABLE
from thbridge.files.language_texts import shipped_texts
from thbridge.roles.shared.notices import GameTexts
from ui.hosting.kiosk.words import headed
from ui.model.kiosk import (
    KIOSK,
    Answer,
    AnswerKept,
    BeginNext,
    CloseKiosk,
    ConsentReply,
    ConsentToAsk,
    FormItem,
    FormToFill,
    FromKiosk,
    GameNews,
    GamePrepared,
    GameRecorded,
    GameToJoin,
    HostStops,
    InstructionsNews,
    InstructionsSoFar,
    InstructionText,
    ItemNews,
    KioskClosed,
    MessageClosed,
    ResearcherMessage,
    StoppedTakingPart,
    StudyProgress,
    StudyTexts,
    TextToRead,
    TurnToAwait,
    WentBack,
    WentOn,
)
from ui.windows import look
from ui.windows.kiosk.items.panel import ItemPanel
from ui.windows.kiosk.pages.form import FormPage
from ui.windows.kiosk.pages.turn import TurnPage
from ui.windows.kiosk.window import BEGIN_KEYS, KioskProgram, KioskWindow
from ui.windows.participant.pages.pages import ConsentPage
from ui.windows.participant.widgets.buttons import ActionButton
from ui.windows.participant.widgets.reading import ReadingText
from ui.windows.participant_program import GamePage
from ui.windows.preferences import Preferences

TEXTS = shipped_texts()
SEVEN = ("not at all", "", "", "", "", "", "completely")
ITEMS = (
    FormItem("agree", "The robots did what I wanted.", "likert", SEVEN, not_applicable=True),
    FormItem("often", "How often did you look?", "likert", ("never", "seldom", "often")),
    FormItem("line", "How hard was it?", "analogue", low="easy", high="hard", step=5.0),
    FormItem("warm", "", "differential", ("cold", "", "", "", "warm"), "cold", "warm"),
    FormItem("age", "How old are you?", "number", minimum=18.0, maximum=99.0, unit="years"),
    FormItem("hand", "Which hand do you use?", "choice", options=("left", "right", "both")),
    FormItem("used", "Which have you used?", "choice", options=("a robot that cleans", "a drone"), several=True),
    FormItem("why", "What else?", "text", required=False),
)
OWN = {*strings_in(msgspec.to_builtins(ITEMS), frozenset({"id", "scale"})), "Some questions", "Answer."} - {""}
"""Words of a study's own, in whatever language."""
WAY = StudyProgress(3, 8)


@dataclass
class Opened:
    """The window, its clock, and what it told its host."""

    window: KioskWindow
    preferences: Preferences
    told: list[FromKiosk] = field(default_factory=list)
    now: float = 10.0

    def form(self, *ids: str, answers: dict[str, Answer] | None = None, back: bool = False) -> FormPage:
        items = tuple(item for item in ITEMS if item.id in ids or not ids)
        self.window.receive(FormToFill(7, "Some questions", "Answer.", items, answers or {}, back=back, progress=WAY))
        self.now += 1.0
        return self.page(FormPage)

    def page(self, kind: type) -> QWidget:
        page = self.window.pages.currentWidget()
        assert isinstance(page, kind)
        return page

    def news(self, item: str) -> list[tuple[str, Answer]]:
        return [(one.what, one.answer) for one in self.told if isinstance(one, ItemNews) and one.item == item]


@pytest.fixture
def opened(
    request: pytest.FixtureRequest, qtbot: QtBot, qapp: QApplication, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> Iterator[Opened]:
    monkeypatch.setattr(QApplication, "quit", lambda: None)
    told: list[FromKiosk] = []
    preferences, language = preferred(qapp, tmp_path), getattr(request, "param", "en")
    window = KioskWindow(shipped_texts(language), preferences, told.append, lambda: made.now)
    made = Opened(window, preferences, told)
    made.window.resize(1024, 600)
    made.window.show()
    made.window.activateWindow()
    qtbot.waitUntil(made.window.isActiveWindow)
    yield made
    made.window.receive(CloseKiosk())
    made.window.deleteLater()
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)


def panel(form: FormPage, item: str) -> ItemPanel:
    return next(one for one in form.panels if one.item.id == item)


def keys(qtbot: QtBot, *pressed: Qt.Key | str) -> None:
    for key in pressed:
        focused = QApplication.focusWidget()
        if isinstance(key, str):
            qtbot.keyClicks(focused, key)
        else:
            qtbot.keyClick(focused, key)


def test_a_text_is_left_once_and_not_before_it_can_have_been_seen(opened: Opened, qtbot: QtBot) -> None:
    opened.window.receive(TextToRead(4, "Welcome", "Please begin.", "Begin"))
    qtbot.keyClick(opened.window, Qt.Key.Key_Return)
    assert opened.told == []
    opened.now += 1.0
    qtbot.keyClick(opened.window, Qt.Key.Key_Return)
    qtbot.keyClick(opened.window, Qt.Key.Key_Return)
    assert opened.told == [WentOn(4)]


def test_a_completion_code_is_in_groups_and_spelled_for_screen_readers(opened: Opened) -> None:
    opened.window.receive(TextToRead(9, "Thank you", "You may go.", "Finish", code="AB23CD45"))
    (line,) = opened.window.findChildren(QLineEdit)
    assert line.text() == "AB23 CD45"
    assert line.accessibleName() == "Completion code: A, B, 2, 3, C, D, 4, 5"


@pytest.mark.parametrize(("key", "agrees"), [(Qt.Key.Key_A, True), (Qt.Key.Key_N, False)])
def test_consent_is_answered_by_its_keys_and_by_nothing_else(
    opened: Opened, qtbot: QtBot, key: Qt.Key, agrees: bool
) -> None:
    opened.window.receive(ConsentToAsk(5, "We record you."))
    opened.now += 1.0
    qtbot.keyClick(opened.window, Qt.Key.Key_Return)
    qtbot.keyClick(opened.window, key)
    qtbot.keyClick(opened.window, key)
    (reply,) = opened.told
    assert isinstance(reply, ConsentReply)
    assert (reply.page, reply.agrees) == (5, agrees)


def test_a_form_by_keyboard_alone(opened: Opened, qtbot: QtBot) -> None:
    form = opened.form()
    keys(qtbot, "6", Qt.Key.Key_Tab, Qt.Key.Key_Tab)
    keys(qtbot, "2", Qt.Key.Key_Return)
    keys(qtbot, Qt.Key.Key_Right, Qt.Key.Key_Right, Qt.Key.Key_Return)
    keys(qtbot, Qt.Key.Key_Right, Qt.Key.Key_Right, Qt.Key.Key_Space, Qt.Key.Key_Return)
    keys(qtbot, "41", Qt.Key.Key_Return)
    keys(qtbot, "3", Qt.Key.Key_Tab)
    keys(qtbot, "1", "2", Qt.Key.Key_Tab)
    keys(qtbot, "No.")
    qtbot.keyClick(QApplication.focusWidget(), Qt.Key.Key_Return, Qt.KeyboardModifier.ControlModifier)
    assert {one.item.id: one.answer for one in form.panels} == {
        "agree": 6.0,
        "often": 2.0,
        "line": 55.0,
        "warm": 2.0,
        "age": 41.0,
        "hand": "both",
        "used": ("a robot that cleans", "a drone"),
        "why": "No.",
    }
    assert opened.told[-1] == WentOn(7)
    given = [one.item for one in opened.told if isinstance(one, ItemNews) and one.what == "given"]
    assert given == [item.id for item in ITEMS], "each before the next is asked"
    assert opened.news("why") == [("shown", None), ("touched", None), ("changed", "No."), ("given", "No.")]


def test_a_form_by_mouse(opened: Opened, qtbot: QtBot) -> None:
    form = opened.form("agree", "line", "hand")
    settle()
    for button in (panel(form, "agree").field.buttons[3], panel(form, "hand").field.buttons[0]):
        qtbot.mouseClick(button, Qt.MouseButton.LeftButton)
    line = panel(form, "line").field.line
    qtbot.mouseClick(line, Qt.MouseButton.LeftButton, pos=line.rect().center())
    qtbot.mouseClick(form.go_on, Qt.MouseButton.LeftButton)
    assert opened.news("agree") == [("shown", None), ("touched", None), ("changed", 4.0), ("given", 4.0)]
    assert opened.news("line")[-1] == ("given", 50.0)
    assert opened.told[-1] == WentOn(7)


def test_nothing_looks_like_an_answer_before_there_is_one(opened: Opened) -> None:
    form = opened.form()
    assert all(one.answer is None for one in form.panels)
    assert QApplication.focusWidget() is form.panels[0]
    assert not panel(form, "line").field.line.marked


def test_what_is_missing_is_pointed_at_and_what_is_there_stays(opened: Opened, qtbot: QtBot) -> None:
    form = opened.form("often", "age", "why")
    keys(qtbot, "1", Qt.Key.Key_Tab, "17")
    qtbot.mouseClick(form.go_on, Qt.MouseButton.LeftButton)
    assert not any(isinstance(one, WentOn) for one in opened.told)
    assert panel(form, "often").missing.isHidden()
    assert panel(form, "age").missing.text() == "Please enter a number from 18 to 99."
    assert "Please enter a number" in panel(form, "age").accessibleName()
    assert QApplication.focusWidget() is panel(form, "age").field.line
    assert panel(form, "why").missing.isHidden(), "it may be left out"


def test_a_page_that_has_just_come_is_not_left_by_a_second_click(opened: Opened, qtbot: QtBot) -> None:
    form = opened.form("why")
    opened.now -= 1.0
    qtbot.mouseClick(form.go_on, Qt.MouseButton.LeftButton)
    assert not any(isinstance(one, WentOn) for one in opened.told)
    opened.now += 1.0
    qtbot.mouseClick(form.go_on, Qt.MouseButton.LeftButton)
    assert opened.told[-1] == WentOn(7)


@pytest.mark.parametrize("by", ["mouse", "keyboard"])
def test_the_way_back_leaves_what_is_missing_and_gives_what_is_begun(opened: Opened, qtbot: QtBot, by: str) -> None:
    form = opened.form("age", "hand", back=True)
    keys(qtbot, "41")
    if by == "mouse":
        qtbot.mouseClick(form.back, Qt.MouseButton.LeftButton)
    else:
        qtbot.keyClick(QApplication.focusWidget(), Qt.Key.Key_Left, Qt.KeyboardModifier.AltModifier)
    assert opened.news("age")[-1] == ("given", 41.0)
    assert opened.told[-1] == WentBack(7)
    assert opened.form("age").back is None, "a first page has none"


def test_keys_go_on_where_the_mouse_was(opened: Opened, qtbot: QtBot) -> None:
    form = opened.form("agree", "line")
    settle()
    line = panel(form, "line").field.line
    qtbot.mouseClick(line, Qt.MouseButton.LeftButton, pos=line.rect().center())
    keys(qtbot, Qt.Key.Key_Right)
    assert panel(form, "line").answer == 55.0
    qtbot.mouseClick(panel(form, "agree").field.buttons[3], Qt.MouseButton.LeftButton)
    keys(qtbot, "2")
    assert (panel(form, "agree").answer, panel(form, "line").answer) == (2.0, 55.0)


def test_a_code_is_one_line_and_enter_leads_on(opened: Opened, qtbot: QtBot) -> None:
    asked = FormItem("code", "Which code?", "text", one_line=True)
    opened.window.receive(FormToFill(7, "Before you begin", "", (asked,)))
    opened.now += 1.0
    keys(qtbot, "AB 12", Qt.Key.Key_Return, Qt.Key.Key_Return)
    assert ("given", "AB 12") in opened.news("code")
    assert opened.told[-1] == WentOn(7)


def test_a_short_consent_is_no_higher_than_its_text(opened: Opened) -> None:
    opened.window.receive(ConsentToAsk(5, "We record you."))
    settle()
    assert opened.page(ConsentPage).findChild(ReadingText).height() < 120
    opened.window.receive(ConsentToAsk(6, "We record you. " * 400))
    settle()
    shown = opened.page(ConsentPage).findChild(ReadingText)
    assert shown.height() > 250 and shown.verticalScrollBar().maximum() > 0
    assert opened.page(ConsentPage).agree.isVisible()


def test_not_applicable_is_an_answer_of_its_own(opened: Opened, qtbot: QtBot) -> None:
    form = opened.form("agree")
    keys(qtbot, "5", "n")
    assert panel(form, "agree").answer == NOT_APPLICABLE
    keys(qtbot, "2")
    assert panel(form, "agree").answer == 2.0
    answers = [answer for what, answer in opened.news("agree") if what == "changed"]
    assert answers == [5.0, NOT_APPLICABLE, 2.0]


def test_answers_given_before_are_shown_as_given(opened: Opened) -> None:
    answers: dict[str, Answer] = {
        "agree": NOT_APPLICABLE, "often": 3.0, "line": 20.0, "warm": 1.0, "age": 30.0, "hand": "left",
        "used": ("a drone",), "why": "Because.",
    }  # fmt: skip
    form = opened.form(answers=answers)
    assert {one.item.id: one.answer for one in form.panels} == answers
    assert [one for one in opened.told if isinstance(one, ItemNews) and one.what != "shown"] == []


def test_typing_is_told_at_each_pause_and_pastes_are(opened: Opened, qtbot: QtBot) -> None:
    form = opened.form("why")
    keys(qtbot, "So far")
    qtbot.waitUntil(lambda: ("changed", "So far") in opened.news("why"))
    assert ("given", "So far") not in opened.news("why")
    pasted = QMimeData()
    pasted.setText(" and more")
    panel(form, "why").field.text.insertFromMimeData(pasted)
    (paste,) = [one for one in opened.told if isinstance(one, ItemNews) and one.what == "pasted"]
    assert paste.characters == len(" and more")


def test_items_are_shown_when_they_are_in_sight(opened: Opened, qtbot: QtBot) -> None:
    form = opened.form()
    qtbot.waitUntil(lambda: ("shown", None) in opened.news("often"))
    assert opened.news("why") == []
    panel(form, "why").focus_target().setFocus()
    qtbot.waitUntil(lambda: ("shown", None) in opened.news("why"))


def test_what_leads_on_stands_below_the_items_where_they_scroll_too(opened: Opened, qtbot: QtBot) -> None:
    for ids, scrolls in (((), True), (("often",), False)):
        form = opened.form(*ids)
        bar = form.findChild(QScrollArea).verticalScrollBar()
        qtbot.waitUntil(lambda bar=bar, scrolls=scrolls: bar.isVisible() is scrolls)
        settle()
        ends = [one.mapToGlobal(QPoint(one.width(), 0)).x() for one in (form.panels[0], form.go_on)]
        assert ends[0] == ends[1], ids


def test_of_several_answers_it_is_told_that_there_may_be(opened: Opened) -> None:
    form = opened.form("hand", "used")
    told = {one.item.id: [label.text() for label in one.findChildren(QLabel)] for one in form.panels}
    assert "You may choose several answers." in told["used"]
    assert "You may choose several answers." not in told["hand"]


def test_the_next_person_begins_with_text_and_sound_as_usual(opened: Opened) -> None:
    preferences = opened.preferences
    preferences.choose_text_size(200)
    preferences.choose_sound(False)
    opened.window.receive(TextToRead(8, "Thank you", "You may go.", "Finish", code="AB23CD45"))
    assert preferences.percent == 200, "the person who reads the code is still there"
    opened.window.receive(TextToRead(9, "Welcome", "Please begin.", "Begin", anew=True))
    assert (preferences.percent, preferences.sound_on) == (100, True)


def test_closing_asks_and_only_the_researcher_closes(opened: Opened, qtbot: QtBot) -> None:
    window = opened.window
    opened.form("often")
    window.close()
    assert window.isVisible() and window.leaving_panel.isVisible()
    keys(qtbot, Qt.Key.Key_Escape)
    assert not window.overlay.isVisible()
    window.close()
    qtbot.mouseClick(window.leaving_panel.stop, Qt.MouseButton.LeftButton)
    assert opened.told[-1] == StoppedTakingPart()
    window.receive(TextToRead(8, "Welcome", "Please begin.", "Begin"))
    window.close()
    assert not window.leaving_panel.stop.isVisible(), "nobody takes part there"
    assert window.leaving_panel.accessibleName() == "Close the window?"
    assert window.leaving_panel.stay.face is not None and window.leaving_panel.stay.face.label == "Leave it open"
    qtbot.mouseClick(window.leaving_panel.close_button, Qt.MouseButton.LeftButton)
    assert opened.told[-1] == KioskClosed()
    assert not window.isVisible()


def test_whoever_takes_part_sees_how_to_stop(opened: Opened, qtbot: QtBot) -> None:
    window = opened.window
    window.receive(TextToRead(3, "Welcome", "Please begin.", "Begin"))
    assert not window.progress.stop.isVisible(), "nobody takes part yet"
    window.receive(ConsentToAsk(4, "We record you.", progress=WAY))
    qtbot.mouseClick(window.progress.stop, Qt.MouseButton.LeftButton)
    assert window.leaving_panel.isVisible() and window.leaving_panel.stop.isVisible()
    assert opened.told == [], "it only asks"
    keys(qtbot, Qt.Key.Key_Escape)
    qtbot.keyClick(window, Qt.Key.Key_F4, Qt.KeyboardModifier.AltModifier)
    assert window.leaving_panel.isVisible()


def game(opened: Opened, *to_do: str, practice: bool = True) -> GamePage:
    """A game whose server is not reached."""
    opened.window.receive(GameToJoin(7, "127.0.0.1", 1, "x", practice, progress=WAY, to_do=to_do))
    settle()
    return opened.page(GamePage)


def labels(widget: QWidget) -> list[str]:
    return [label.text() for label in widget.findChildren(QLabel) if label.isVisible() and label.text()]


def test_no_key_leaves_practice_before_all_is_done(opened: Opened, qtbot: QtBot) -> None:
    page = game(opened, "send a robot to a room", "name a treasure")
    assert "Before you go on: send a robot to a room, name a treasure." in labels(page)
    button = next(one for one in page.findChildren(ActionButton) if one.face and one.face.key == "F10")
    assert button.accessibleName() == "Go on with the study, not possible at the moment"
    qtbot.keyClick(opened.window, Qt.Key.Key_F10)
    qtbot.mouseClick(button, Qt.MouseButton.LeftButton)
    # Here, unlike on a screen, the tool tip that gives the reason takes keys away from the window.
    QToolTip.hideText()
    opened.window.activateWindow()
    qtbot.waitUntil(opened.window.isActiveWindow)
    opened.window.receive(GameNews(7, 500, ("name a treasure",)))
    qtbot.keyClick(opened.window, Qt.Key.Key_F10)
    assert "Before you go on: name a treasure." in labels(page)
    assert not any(isinstance(one, WentOn) for one in opened.told)
    opened.window.receive(GameNews(7, 499))
    assert button.accessibleName() == "Go on with the study"
    qtbot.keyClick(opened.window, Qt.Key.Key_F10)
    assert opened.told[-1] == WentOn(7)


def test_games_too_show_the_step_the_time_left_and_how_to_stop(
    opened: Opened, qtbot: QtBot, monkeypatch: pytest.MonkeyPatch
) -> None:
    said: list[str] = []
    monkeypatch.setattr(
        "ui.windows.kiosk.window.QAccessible.updateAccessibility", lambda event: said.append(event.message())
    )
    game(opened, practice=False)
    shown = {}
    for seconds in (600, 541, 540, 61, 60, 59, 11, 10, 9, 1, 0):
        opened.window.receive(GameNews(7, seconds))
        shown[seconds] = labels(opened.window.progress)
    assert shown[600] == ["Step 3 of 8", "10 minutes left in this game"]
    assert shown[541] == shown[600], "minutes are rounded up"
    assert shown[540][1] == "9 minutes left in this game"
    assert (shown[61][1], shown[60][1]) == ("2 minutes left in this game", "60 seconds left in this game")
    assert (shown[1][1], shown[0][1]) == ("1 second left in this game", "0 seconds left in this game")
    assert said == ["60 seconds left in this game", "10 seconds left in this game"]
    assert not opened.window.progress.settings.isVisible(), "the game has a button of its own"
    assert opened.window.progress.stop.isVisible()
    qtbot.mouseClick(opened.window.progress.stop, Qt.MouseButton.LeftButton)
    assert opened.window.leaving_panel.isVisible()
    keys(qtbot, Qt.Key.Key_Escape)
    assert not opened.window.leaving_panel.isVisible()
    opened.window.receive(GameNews(6, 3))
    assert labels(opened.window.progress) == shown[0], "news of another page is void"
    opened.window.receive(TextToRead(8, "A pause", "Rest.", progress=WAY))
    assert labels(opened.window.progress) == ["Step 3 of 8"]
    assert opened.window.progress.settings.isVisible()


QUICK = FormItem("quick", "What is 7 times 8?", "text", one_line=True, seconds=20.0)


def test_an_item_with_a_time_limit_is_closed_with_the_answer_so_far(
    opened: Opened, qtbot: QtBot, monkeypatch: pytest.MonkeyPatch
) -> None:
    said: list[str] = []
    monkeypatch.setattr(
        "ui.windows.kiosk.items.panel.QAccessible.updateAccessibility", lambda event: said.append(event.message())
    )
    opened.window.receive(FormToFill(7, "Quickly", "", (QUICK,), progress=WAY))
    form = opened.page(FormPage)
    one = panel(form, "quick")
    assert "20 seconds left" in labels(one)
    assert one.accessibleName() == "Question 1 of 1: What is 7 times 8? Not answered. Time limit: 20 seconds."
    keys(qtbot, "5")
    opened.now += 10.0
    qtbot.waitUntil(lambda: "10 seconds left" in labels(one))
    assert said == ["10 seconds left"]
    keys(qtbot, "6")
    opened.now += 10.0
    qtbot.waitUntil(lambda: one.closed)
    assert opened.news("quick")[-1] == ("timed out", "56")
    assert said[-1] == TEXTS.text("forms.time_is_over") and TEXTS.text("forms.time_is_over") in labels(one)
    assert one.accessibleName().endswith(f"Answered: 56. {TEXTS.text('forms.time_is_over')}")
    assert QApplication.focusWidget() is form.go_on
    keys(qtbot, "7")
    assert one.answer == "56", "it is closed"
    qtbot.mouseClick(form.go_on, Qt.MouseButton.LeftButton)
    assert opened.told[-1] == WentOn(7)
    assert [what for what, _ in opened.news("quick")].count("timed out") == 1
    assert ("given", "56") not in opened.news("quick")


def test_an_item_that_is_closed_without_an_answer_does_not_hold_anybody_up(opened: Opened, qtbot: QtBot) -> None:
    opened.window.receive(FormToFill(7, "Quickly", "", (QUICK,), progress=WAY))
    form = opened.page(FormPage)
    opened.now += 25.0
    qtbot.waitUntil(lambda: panel(form, "quick").closed)
    assert opened.news("quick")[-1] == ("timed out", None)
    qtbot.mouseClick(form.go_on, Qt.MouseButton.LeftButton)
    assert opened.told[-1] == WentOn(7)


def test_a_window_that_is_opened_again_keeps_an_item_closed(opened: Opened) -> None:
    page = FormToFill(7, "Quickly", "", (QUICK,), progress=WAY)
    kept = KIOSK.kept([InstructionsSoFar(()), page], AnswerKept(7, "quick", "5", timed_out=True))
    assert kept == [InstructionsSoFar(()), structs.replace(page, answers={"quick": "5"}, timed_out=("quick",))]
    opened.window.receive(kept[1])
    assert panel(opened.page(FormPage), "quick").closed
    assert opened.news("quick") == [("shown", None)] or opened.news("quick") == []
    assert KIOSK.kept([*kept, GameNews(7, 3)], page) == [InstructionsSoFar(()), page]
    assert KIOSK.kept([page, GameNews(7, 4)], GameNews(7, 3)) == [page, GameNews(7, 3)]


def reading(opened: Opened) -> list[bool]:
    return [one.is_open for one in opened.told if isinstance(one, InstructionsNews)]


def test_instructions_are_read_again_by_f1_on_any_page_and_the_page_waits(opened: Opened, qtbot: QtBot) -> None:
    window = opened.window
    form = opened.form("often")
    qtbot.keyClick(window, Qt.Key.Key_F1)
    assert reading(opened) == [], "nothing was read yet"
    assert not window.progress.again.isVisible()
    window.receive(InstructionsSoFar((InstructionText("Send robots."), InstructionText("*Name* treasures.", True))))
    assert window.progress.again.isVisible()
    qtbot.keyClick(window, Qt.Key.Key_F1)
    texts = [one.toPlainText() for one in window.instructions.findChildren(ReadingText) if one.isVisible()]
    assert texts == ["Send robots.", "Name treasures."]
    assert reading(opened) == [True]
    for key in (Qt.Key.Key_1, Qt.Key.Key_Return):
        qtbot.keyClick(window, key)
    qtbot.keyClick(window, Qt.Key.Key_Return, Qt.KeyboardModifier.ControlModifier)
    assert panel(form, "often").answer is None, "keys do nothing behind it"
    assert not any(isinstance(one, WentOn) for one in opened.told)
    qtbot.keyClick(window, Qt.Key.Key_F1)
    qtbot.keyClick(window, Qt.Key.Key_F1)
    qtbot.keyClick(window, Qt.Key.Key_Escape)
    assert reading(opened) == [True, False, True, False]
    keys(qtbot, "2")
    assert panel(form, "often").answer == 2.0, "and all goes on where it was"
    qtbot.mouseClick(window.progress.again, Qt.MouseButton.LeftButton)
    window.receive(InstructionsSoFar(()))
    assert reading(opened)[-2:] == [True, False], "the next person has read none"
    assert not window.overlay.isVisible() and not window.progress.again.isVisible()


def test_instructions_are_read_again_in_a_game_with_its_rules_and_keys(opened: Opened, qtbot: QtBot) -> None:
    opened.window.receive(InstructionsSoFar((InstructionText("Send robots."),)))
    page = game(opened, practice=False)
    page._model.connected(0.0)
    page._model.receive(view(), 0.0)
    qtbot.waitUntil(page.window_of_game.top.isVisible)
    for _ in range(2):
        qtbot.keyClick(opened.window, Qt.Key.Key_F1)
        settle()
    assert reading(opened) == [True, False]
    assert not opened.window.progress.again.isVisible(), "the game has a button of its own"
    qtbot.keyClick(opened.window, Qt.Key.Key_H)
    settle()
    sheet = page.window_of_game.help
    assert sheet.accessibleName() == "Instructions, rules and keys"
    assert [one.toPlainText() for one in sheet.findChildren(ReadingText)] == ["Send robots."]
    # Keys of the game do nothing behind the question whether to leave.
    opened.window.close()
    keys(qtbot, Qt.Key.Key_Escape)
    assert not opened.window.overlay.isVisible() and sheet.isVisible()
    opened.window.receive(GamePrepared(8, "The time is over.", WAY))
    assert reading(opened) == [True, False, True, False]


def test_the_researchers_keys(opened: Opened, qtbot: QtBot) -> None:
    held = Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.AltModifier | Qt.KeyboardModifier.ShiftModifier
    assert BEGIN_KEYS == "Ctrl+Alt+Shift+N"
    qtbot.keyClick(opened.window, Qt.Key.Key_N, held)
    assert opened.told == [BeginNext()]
    qtbot.keyClick(opened.window, Qt.Key.Key_Q, held)
    assert opened.told[-1] == KioskClosed()


def test_a_window_whose_host_died_stays_and_says_so_until_another_one_comes(opened: Opened) -> None:
    opened.window.leave()
    words = [label.text() for label in opened.window.findChildren(QLabel) if label.isVisible()]
    assert "The program has stopped" in words
    opened.window.give_way()
    assert not opened.window.isVisible()


def test_nothing_is_shown_before_the_words_come(
    request: pytest.FixtureRequest, qapp: QApplication, monkeypatch: pytest.MonkeyPatch
) -> None:
    gone: list[str] = []
    monkeypatch.setattr(qapp, "quit", lambda: gone.append("quit"))
    told: list[FromKiosk] = []
    program = KioskProgram(qapp, "light", told.append, windowed=True, title="")
    program.receive(TextToRead(1, "Willkommen", "Bitte beginnen Sie."))
    assert program.window is None
    program.leave()
    assert gone == ["quit"]
    program.receive(StudyTexts(GameTexts.of(shipped_texts("de"))))
    window = program.window
    assert window is not None

    def delete() -> None:
        window.deleteLater()
        QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)

    # A window that a failed test leaves behind would let later tests fail.
    request.addfinalizer(delete)
    assert window.isVisible()
    program.receive(TextToRead(1, "Willkommen", "Bitte beginnen Sie."))
    program.leave()
    assert "Das Programm wurde unterbrochen" in labels(window)
    window.give_way()
    assert told == [KioskClosed()]


def pages(texts: Texts = TEXTS) -> dict[str, Callable[[Opened], object]]:
    """Each page of the kiosk, by its name."""
    ended, score = texts.text("kiosk.game_ended"), texts.text("kiosk.your_score", score=3)
    stops = HostStops(texts.text("kiosk.pauses"), texts.text("kiosk.failed_text"))
    comes, thanks = texts.text("kiosk.game_comes"), texts.text("kiosk.thank_you")
    finish, completed = texts.text("kiosk.finish"), texts.text("kiosk.completed")
    return {
        "welcome": lambda it: it.window.receive(
            TextToRead(1, *headed(texts, "welcome"), texts.text("kiosk.begin"), anew=True)
        ),
        "text": lambda it: (
            it.window.receive(InstructionsSoFar((InstructionText("1, 2, 3. " * 200),))),
            it.window.receive(TextToRead(1, texts.text("kiosk.instructions"), "1, 2, 3. " * 200, progress=WAY)),
        ),
        "again": lambda it: (pages(texts)["text"](it), it.window.progress.again.click()),
        "consent": lambda it: it.window.receive(ConsentToAsk(1, "1, 2, 3.", progress=WAY)),
        "form": lambda it: it.form(back=True),
        "missing": lambda it: it.form(back=True).go_on.click(),
        "waiting": lambda it: it.window.receive(GamePrepared(1, comes, WAY)),
        "turn": lambda it: it.window.receive(TurnToAwait(1, *headed(texts, "waiting_for_others", "web"), 65, 2, WAY)),
        "message": lambda it: (pages(texts)["welcome"](it), it.window.receive(ResearcherMessage("1, 2, 3."))),
        "result": lambda it: it.window.receive(GameRecorded(1, ended, score, WAY)),
        "code": lambda it: it.window.receive(TextToRead(1, thanks, completed, finish, code="AB23CD45")),
        "leaving": lambda it: (it.form("often"), it.window.close()),
        "paused": lambda it: it.window.receive(stops),
        "stopped": lambda it: (it.form("often"), it.window.leave()),
        "stopped between": lambda it: it.window.leave(),
    }


@pytest.mark.parametrize("factor", [1.0, pytest.param(2.0, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", pages())
@pytest.mark.parametrize("opened", ["en", "de"], indirect=True)
def test_pages_fit_and_speak(
    opened: Opened, qapp: QApplication, name: str, factor: float, request: pytest.FixtureRequest
) -> None:
    language = request.node.callspec.params["opened"]
    look.apply_text_size(qapp, factor)
    try:
        pages(shipped_texts(language))[name](opened)
        for size in ((1024, 600), (1920, 1080)):
            opened.window.resize(*size)
            settle()
            assert misfits(opened.window) == [], size
        assert nameless(opened.window) == []
    finally:
        look.apply_text_size(qapp, 1.0)
    if language != "en":
        own = re.compile("|".join(sorted(map(re.escape, OWN), key=len, reverse=True)), re.IGNORECASE)
        assert english_in([own.sub("", words) for words in words_in(opened.window)], language) == []


def test_a_person_who_waits_sees_the_time_and_can_stop(opened: Opened, qtbot: QtBot) -> None:
    turn = TurnToAwait(6, "Please wait", "It begins soon.", progress=WAY)
    opened.window.receive(turn)
    page = opened.page(TurnPage)
    opened.window.receive(structs.replace(turn, waited=65, before=2))
    assert opened.page(TurnPage) is page
    assert {"Please wait", "It begins soon.", "You have waited 1:05. 2 people are before you."} <= {*words_in(page)}
    page.stop.click()
    assert opened.told == [], "the press was meant for the page before"
    opened.now += 1.0
    page.stop.click()
    page.stop.click()
    assert opened.told == [WentOn(6)]


def test_a_message_of_the_researcher_is_shown_until_it_is_closed(opened: Opened, qtbot: QtBot) -> None:
    opened.window.receive(TextToRead(4, "Welcome", "Please begin.", "Begin"))
    opened.window.receive(ResearcherMessage("Please put on the headphones."))
    assert opened.window.message_panel.isVisible()
    assert "Please put on the headphones." in words_in(opened.window.message_panel)
    opened.now += 1.0
    qtbot.keyClick(QApplication.focusWidget(), Qt.Key.Key_Escape)
    assert not opened.window.message_panel.isVisible()
    qtbot.keyClick(QApplication.focusWidget(), Qt.Key.Key_Return)
    assert opened.told == [MessageClosed(), WentOn(4)]


def test_the_next_person_does_not_see_a_message_for_the_person_before(opened: Opened) -> None:
    opened.window.receive(ResearcherMessage("Please hurry."))
    begin = TextToRead(5, "Welcome", "Please begin.", "Begin", anew=True)
    opened.window.receive(begin)
    assert not opened.window.message_panel.isVisible()
    assert [*KIOSK.kept([ResearcherMessage("Please hurry.")], begin)] == [begin]
