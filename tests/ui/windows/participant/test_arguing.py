"""A person in the window argues with robots, in a real game without a simulator: by mouse, and by keyboard alone."""

from collections.abc import Callable

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication, QScrollArea
from pytestqt.qtbot import QtBot

from tests.support.hunts.screen_player import ScreenPlayer
from tests.support.hunts.scripted_hunt import arguing_engine
from tests.support.windows import sample_screens
from tests.support.windows.layout_faults import settle
from tests.support.windows.participant_windows import Open, press
from tests.ui.windows.participant.window_player import WindowPlayer
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.files.language_texts import shipped_texts
from thbridge.hunt.events import RobotDeparted
from thbridge.roles.keeper.disclosed.briefing import Briefing
from ui.model.playing.screen import (
    Action,
    ChooseRobot,
    DialoguePopup,
    RequestSuggestionAct,
    SelectRoomAct,
    ShowNext,
    TypeDigit,
)
from ui.model.shared.theme import LIGHT
from ui.windows import look
from ui.windows.participant import ParticipantWindow
from ui.windows.participant.popups.dialogue import DialoguePanel

Sit = Callable[..., "Arguer"]
STATES = sample_screens.states()


class Arguer(WindowPlayer):
    """A person at the window, where robots argue."""

    def wait(self, ticks: int = 20) -> None:
        """Wait until the robot has replied, and then until the reply can be answered."""
        super().wait(ticks)
        super().wait(ticks)

    @property
    def pop(self) -> DialoguePopup:
        pop = self.seat.screen.popup
        assert isinstance(pop, DialoguePopup)
        return pop

    @property
    def labels(self) -> list[str]:
        """What is on the buttons of the answers."""
        shown = [button for button in self.window.dialogue.choices.buttons if button.isVisible()]
        return [button.face.label for button in shown if button.face is not None]

    @property
    def focused(self) -> str:
        """What is on the button that has the focus."""
        return getattr(getattr(QApplication.focusWidget(), "face", None), "label", "")

    def answer_of(self, text: str) -> int:
        found = [at for at, label in enumerate(self.labels) if text in label]
        assert found, (text, self.labels, self.pop.sentences)
        return found[0]

    def say(self, text: str) -> None:
        """Click the answer that contains a text."""
        self.qtbot.mouseClick(self.window.dialogue.choices.buttons[self.answer_of(text)], Qt.MouseButton.LeftButton)
        self.wait()

    def type(self, text: str) -> None:
        """Press the digit of the answer that contains a text."""
        self.key(str(self.answer_of(text) + 1))

    @property
    def departures(self) -> list[tuple[int, int]]:
        """Robots and rooms."""
        events = self.seat.hunt.log.events
        return [(event.robot, event.room.people) for event in events if isinstance(event, RobotDeparted)]


@pytest.fixture
def sit(qtbot: QtBot, qapp: QApplication) -> Sit:
    def make(condition: DialogueCondition = DialogueCondition.COLLABORATOR) -> Arguer:
        look.apply_palette(qapp, LIGHT)
        seat = ScreenPlayer(talk=arguing_engine(condition), briefing=Briefing(condition=condition))
        seat.hunt.puppets.ticks = 200
        window = ParticipantWindow(seat.model, lambda: seat.now, LIGHT)
        qtbot.addWidget(window)
        window.resize(1024, 600)
        window.show()
        window.activateWindow()
        qtbot.waitUntil(window.isActiveWindow)
        return Arguer(seat, window, qtbot)

    return make


def another_room(arguer: Arguer) -> int:
    """A room where the robot would not go by itself."""
    arguer.click(RequestSuggestionAct())
    wanted = arguer.pop.room
    arguer.say("Let us leave it")
    arguer.click(ShowNext())
    return next(room for room in range(1, 9) if room != wanted)


def test_a_person_is_persuaded(sit: Sit) -> None:
    arguer = sit()
    room = another_room(arguer)
    arguer.click(SelectRoomAct(room))
    arguer.say(f"Why not room {room}")
    assert "because" in arguer.pop.sentences[-1][1] or "reasons" in arguer.pop.sentences[-1][1]
    arguer.say("I have a question")
    arguer.say("Why room ")
    assert arguer.pop.sentences[-1][0] == "robot"
    arguer.say(f"All right, not room {room}")
    arguer.say("Where would you go, then?")
    while arguer.labels:
        arguer.say("All right")
    assert [who for who, _ in arguer.departures] == [0]
    assert arguer.departures[0][1] != room
    who, told = arguer.pop.sentences[-1]
    assert who == "robot" and f"to room {arguer.departures[0][1]}" in told
    assert arguer.pop.ended and arguer.pop.outcome == ""
    assert arguer.window.dialogue.isVisible()


def test_a_person_persuades_a_robot_by_keyboard_alone(sit: Sit) -> None:
    arguer = sit()
    arguer.key("D")
    wanted = arguer.pop.room
    arguer.type("Let us leave it")
    arguer.key("Esc")
    room = next(room for room in range(1, 9) if room != wanted)
    arguer.key(str(room))
    for text in ("Why not", "No, I still want", f"Go to room {room} next", "I want"):
        arguer.type(text)
    if arguer.labels:
        arguer.type(f"Go to room {room} next")
    assert arguer.departures == [(0, room)]
    assert arguer.pop.sentences[-1] == ("robot", f"All right, I go to room {room} next.")


def test_the_questions_lead_back_to_where_the_focus_was(sit: Sit) -> None:
    arguer = sit()
    arguer.key("D")
    for _ in range(1 + arguer.answer_of("I have a question")):
        arguer.key("Down")
    assert arguer.focused == "I have a question."
    arguer.key("Return")
    assert arguer.labels[-1] == "Back."
    assert arguer.focused == arguer.labels[0]
    arguer.key("Esc")
    assert arguer.focused == "I have a question."
    arguer.key("Return")
    arguer.key("Return")
    assert arguer.pop.sentences[-1][0] == "robot", "it has answered the first of the questions"
    assert arguer.focused == "I have a question."
    arguer.key("Up")
    arguer.key("Up")
    assert arguer.focused == arguer.labels[0]


def test_two_robots_wait_and_each_card_shows_its_dialogue(sit: Sit) -> None:
    arguer = sit()
    arguer.click(RequestSuggestionAct())
    arguer.key("Tab")
    arguer.click(RequestSuggestionAct())
    assert [card.state for card in arguer.seat.screen.cards] == ["waits for your answer"] * 2
    arguer.click(ChooseRobot(0))
    assert arguer.pop.robot == 0
    arguer.key("Tab")
    assert arguer.pop.robot == 1
    arguer.type("All right")
    assert [robot for robot, _ in arguer.departures] == [1]
    arguer.key("Tab")
    arguer.type("All right")
    assert [robot for robot, _ in arguer.departures] == [1, 0]


def test_a_dialogue_that_was_left_does_not_go_without_a_word(sit: Sit) -> None:
    arguer = sit()
    arguer.click(RequestSuggestionAct())
    arguer.type("Let us leave it")
    assert arguer.window.dialogue.isVisible()
    assert [who for who, _ in arguer.pop.sentences[-2:]] == ["you", "robot"]
    assert "here for now" in arguer.pop.sentences[-1][1] or "where I am for now" in arguer.pop.sentences[-1][1]
    assert arguer.departures == []
    arguer.key("Esc")
    assert not arguer.window.dialogue.isVisible()


def test_a_person_decides_against_advice(sit: Sit) -> None:
    arguer = sit(DialogueCondition.ADVISER)
    room = another_room(arguer)
    arguer.click(SelectRoomAct(room))
    button = arguer.window.dialogue.choices.buttons[arguer.answer_of("all the same")]
    assert "This is your decision." in button.accessibleDescription()
    arguer.say("all the same")
    assert arguer.departures == [(0, room)]


def test_a_supervised_robot_goes_with_one_click(sit: Sit) -> None:
    arguer = sit(DialogueCondition.SUPERVISOR)
    arguer.click(SelectRoomAct(6))
    assert arguer.departures == [(0, 6)]


def test_what_was_said_before_can_be_paged_through(opened: Open, qtbot: QtBot) -> None:
    shown = opened(STATES["arguing"], 1024, 600)
    transcript = shown.window.dialogue.transcript
    bar = transcript.verticalScrollBar()
    newest = bar.value()
    assert bar.maximum() > 0
    qtbot.keyClick(shown.window, Qt.Key.Key_PageUp)
    assert bar.value() < newest
    qtbot.keyClick(shown.window, Qt.Key.Key_PageDown)
    assert bar.value() >= newest


def test_a_digit_that_was_meant_for_an_answer_sends_no_robot_when_the_dialogue_ends(opened: Open, qtbot: QtBot) -> None:
    shown = opened(STATES["arguing"])
    shown.show(STATES["playing"])
    press(qtbot, shown.window, "1")
    assert TypeDigit(1) not in shown.done
    shown.now += 1.0
    press(qtbot, shown.window, "1")
    assert TypeDigit(1) in shown.done


def test_a_panel_that_fits_has_no_bar_whatever_size_it_had_before(qtbot: QtBot, qapp: QApplication) -> None:
    look.apply_palette(qapp, LIGHT)
    words = "Nobody has told me what to do for 12 seconds, so I am going to room 3 (South west)."
    close = Action(ShowNext(), "Close", "Esc")
    for width in range(300, 400, 2):
        panel = DialoguePanel(shipped_texts())
        qtbot.addWidget(panel)
        panel.show_pop(DialoguePopup(1, "Robot 2: go to room 3?", (("robot", words),), (), close, ended=True))
        panel.resize(width, 60)
        panel.show()
        settle()
        panel.resize(panel.wanted(width, 600))
        settle()
        bars = [area.verticalScrollBar() for area in panel.findChildren(QScrollArea)]
        assert bars and not any(bar.isVisible() for bar in bars), width
