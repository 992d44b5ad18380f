"""Person at the terminal, read from the printed lines and from the effects of typed commands."""

import copy
import re
from collections.abc import Iterator
from typing import Any

from tests.support.front_ends.person import Person
from tests.support.front_ends.shown import Deed, Shown
from thbridge.app.compose.setting import texts_of
from thbridge.dialogue.wording.texts import Texts
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.participant_rules import judge, revealed
from thbridge.roles.shared.view import (
    AnswerDialogue,
    EndGame,
    LeaveTreasure,
    MeasureProperty,
    OpenDialogue,
    ParticipantRequest,
    RequestHandback,
    RequestSuggestion,
    SelectRoom,
    StopRobot,
    TakeUpTreasure,
    TellProperty,
    View,
)
from thbridge.study.study_file import Study
from ui.hosting.terminal_player import TerminalPlayer
from ui.model.playing.screen import (
    Act,
    AnswerDialogueAct,
    AskWhatItIs,
    EndGameAct,
    IdentifyTreasureAct,
    LeaveTreasureAct,
    MeasurePropertyAct,
    RequestHandbackAct,
    RequestSuggestionAct,
    SelectRoomAct,
    StopRobotAct,
    TakePictureAct,
    TakeUpTreasureAct,
    TellPropertyAct,
)


class TerminalPerson(Person):
    """Person at the terminal.

    Attributes:
        lines: all printed lines.
    """

    def __init__(self, study: Study) -> None:
        self.lines: list[str] = []
        self._first_texts = texts_of(study, None)
        self.player = TerminalPlayer(self.lines.append, lambda: self.tabui.room_names, lambda: self.texts)
        super().__init__(study, TabUI(self.player))

    @property
    def texts(self) -> Texts:
        """Texts of the game's language."""
        return self.tabui.texts or self._first_texts

    @property
    def view(self) -> View:
        """The last view."""
        assert self.tabui.view is not None
        return self.tabui.view

    def look(self) -> None:
        """Do nothing: each line is printed once."""

    def press(self, act: Act) -> None:
        """Do nothing: see `type`."""

    def type(self, line: str) -> None:
        """Type a line."""
        self.player.type(line)

    def printed(self, line: str) -> list[str]:
        """Return the lines that a command prints that only shows something."""
        before = len(self.lines)
        self.type(line)
        lines = self.lines[before:]
        del self.lines[before:]
        return lines

    def line_for(self, act: Act, page: dict[str, Any], picked: str | None) -> str:
        """Return the command for an act on a page of the same game; empty if it has none.

        Args:
            act: the act.
            page: page of a browser in the same game.
            picked: name that was selected.
        """
        robot = 1 + next(card["robot"] for card in page["cards"] if card["selected"])
        room = (page["treasure"] or {}).get("room")
        match act:
            case SelectRoomAct(goal):
                return f"{robot} {goal}"
            case RequestSuggestionAct():
                return f"{robot} ?"
            case AnswerDialogueAct(choice):
                return self._answer(page["dialogue"]["robot"], page["dialogue"]["choices"][choice]["label"])
            case TakePictureAct():
                return f"p {room}"
            case MeasurePropertyAct(name):
                return f"m {room} {name}"
            case TellPropertyAct(name, value):
                told = next(each for each in self.view.properties if each.name == name)
                return f"t {room} {name} {told.shown(value)}"
            case IdentifyTreasureAct():
                return f"n {room} {self.view.word_for(picked or self.view.names[0])}"
            case AskWhatItIs():
                return f"n {room} ?"
            case LeaveTreasureAct():
                return f"l {room}"
            case TakeUpTreasureAct(taker):
                place = robot - 1 if taker is None else taker
                return f"u {self.view.robots[place].place}"
            case StopRobotAct(mover):
                return f"b {robot if mover is None else mover + 1}"
            case RequestHandbackAct(asked):
                return f"a {robot if asked is None else asked + 1}"
            case EndGameAct():
                return "end"
            case _:
                return ""

    def _answer(self, robot: int, label: str) -> str:
        """Return the command for an answer, as the lines show it."""
        several = sum(bool(each.choices) for each in self.view.dialogues) > 1
        if self.view.has_last_word is None:
            asked = self.texts.robot(robot).casefold()
            line = next(line for line in reversed(self.lines) if line.casefold().strip().startswith(f"{asked}: "))
            choices = next(each.choices for each in self.view.dialogues if each.robot == robot)
            assert all(choice in line for choice in choices)
            return f"{robot + 1}:{choices.index(label) + 1}" if several else str(choices.index(label) + 1)
        marked = re.compile(rf"  (?:(?P<robot>{robot + 1}):)?(?P<number>\d)  {re.escape(label)}(?P<more>  .*)?")
        match = next(found for line in reversed(self.lines) if (found := marked.fullmatch(line)))
        return f"{robot + 1}:{match['number']}" if several else match["number"]

    # What can be done -------------------------------------------------------------------------------------------------

    def deeds(self) -> set[Deed]:
        """Return everything that a person can do with a command now, and the game would grant."""
        view = self.view
        known = revealed(view)
        # A repeated wish shows the open dialogue again, as a press on the same button does in the other front ends.
        talks = [each for each in view.dialogues if each.matter == "select-room"]
        again = [SelectRoom(each.robot, each.room) for each in talks]
        again += [RequestSuggestion(each.robot) for each in talks if each.suggested]
        done = {self._deed(wish) for wish in again if isinstance(judge(known, wish), tuple)}
        for line in self._commands():
            request = self._request(line)
            if isinstance(request, AnswerDialogue):
                asked = next(each for each in view.dialogues if each.dialogue == request.dialogue)
                done.add(("answer", asked.robot, asked.choices[request.choice]))
            elif request is not None and isinstance(judge(known, request), tuple):
                done.add(self._deed(request))
        return done

    def _request(self, line: str) -> ParticipantRequest | None:
        """Return the request of a command without sending it; None if the terminal does not understand it."""
        probe = copy.copy(self.player)
        probe.show = lambda _line: None
        probe._names = dict(self.player._names)
        usual = len(probe.requests(self.view))
        probe.type(line)
        wanted = probe.requests(self.view)
        return wanted[0] if len(wanted) > usual else None

    def _commands(self) -> Iterator[str]:
        view = self.view
        rooms = range(1, len(view.rooms) + 1)
        for robot in range(1, len(view.robots) + 1):
            yield from (f"{robot} {room}" for room in rooms)
            yield from (f"{robot} ?", f"b {robot}", f"a {robot}")
            yield from (f"{robot}:{number}" for number in range(1, 6))
        for room in rooms:
            yield from (f"p {room}", f"n {room} ?", f"l {room}", f"u {room}")
            yield from (f"n {room} {view.word_for(name)}" for name in view.names)
            yield from (f"m {room} {each.name}" for each in view.properties)
            yield from (
                f"t {room} {each.name} {each.shown(value)}" for each in view.properties for value in each.values
            )
        yield "end"

    def _deed(self, request: ParticipantRequest) -> Deed:
        view = self.view
        match request:
            case SelectRoom(robot, room):
                return "go", robot, room
            case RequestSuggestion(robot):
                return "advice", robot
            case StopRobot(robot):
                return "stop", robot
            case RequestHandback(robot):
                return "ask back", robot
            case OpenDialogue(_, "take-picture", room):
                return "picture", room
            case OpenDialogue(_, _, room, ""):
                return "ask name", room
            case OpenDialogue(_, _, room):
                return "name", room
            case LeaveTreasure(room):
                return "leave", room
            case TakeUpTreasure(room):
                return "take up", view.room(room).robot
            case MeasureProperty(room, name):
                return "measure", room, name
            case TellProperty(room, name, value):
                return "tell", room, name, value
            case EndGame():
                return ("end",)
        raise AssertionError(request)


def deeds_on(page: dict[str, Any], shown: Shown, texts: Texts) -> set[Deed]:
    """Return everything that a person can do on a page with its buttons, as `TerminalPerson.deeds` does."""
    robot = next(card["robot"] for card in page["cards"] if card["selected"])
    pop = page["treasure"] or {}
    room = pop.get("room")
    done: set[Deed] = set()
    for act, offer in shown.offers.items():
        pick_first = isinstance(act, IdentifyTreasureAct) and offer.hint == texts.text("hints.pick_first")
        if not (offer.possible or pick_first) or offer.pending:
            continue
        match act:
            case SelectRoomAct(goal):
                done.add(("go", robot, goal))
            case RequestSuggestionAct():
                done.add(("advice", robot))
            case StopRobotAct(mover):
                done.add(("stop", mover))
            case RequestHandbackAct(asked):
                done.add(("ask back", asked))
            case TakeUpTreasureAct(taker):
                done.add(("take up", taker))
            case AnswerDialogueAct():
                done.add(("answer", page["dialogue"]["robot"], offer.label))
            case TakePictureAct():
                done.add(("picture", room))
            case IdentifyTreasureAct():
                done.add(("name", room))
            case AskWhatItIs():
                done.add(("ask name", room))
            case LeaveTreasureAct():
                done.add(("leave", room))
            case MeasurePropertyAct(name):
                done.add(("measure", room, name))
            case TellPropertyAct(name, value):
                done.add(("tell", room, name, value))
            case EndGameAct():
                done.add(("end",))
    return done
