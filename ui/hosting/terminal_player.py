"""Person who takes part at a terminal: the printed lines, and the commands that the person can type."""

import unicodedata
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Literal

from sim.common.robot_numbers import index_of, number_of
from thbridge.dialogue.wording.texts import NamedRoom, Texts
from thbridge.hunt.events import Commander, Condition
from thbridge.hunt.properties import Teller, TreasureProperty, values_in_words
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import RoomNames
from thbridge.hunt.treasures import name_in_words
from thbridge.roles.shared.participant_rules import JudgedRequest, KeeperReason, judge, revealed
from thbridge.roles.shared.team_notices import RaiseObjection
from thbridge.roles.shared.view import (
    AnswerDialogue,
    Consent,
    DialogueView,
    EndGame,
    GiveConsent,
    HandOver,
    IdentifyTreasure,
    LastWords,
    LeaveTreasure,
    MeasureProperty,
    OpenDialogue,
    ParticipantRequest,
    RefusalView,
    RequestHandback,
    RequestSuggestion,
    RobotView,
    RoomView,
    SelectRoom,
    SendRobot,
    SenseTreasure,
    StopRobot,
    TakePicture,
    TakeUpTreasure,
    TellProperty,
    View,
    refusal_wishes,
)
from thbridge.timing.wall_clock import utc_now
from ui.hosting.terminal_talk import TerminalTeamTalk
from ui.hosting.terminal_team import (
    allowed,
    asked_for_news,
    listed_takers,
    objection_news,
    objection_typed,
    reason_lines,
    taker_named,
    vote_lines,
    vote_news,
    vote_typed,
    why_not_ask_for,
)
from ui.model.consent_words import answer_in
from ui.model.playing.keys import choice_keys
from ui.model.playing.memory.history import spoken, stopped_words
from ui.model.playing.popups.dialogues import OVERRIDE
from ui.model.playing.popups.game_over import ending_lines
from ui.model.playing.possible import why_refused
from ui.model.playing.rules_sheet import rules_of
from ui.model.playing.seat_view import (
    asker_of,
    decisions,
    is_own,
    label_of,
    may_name,
    partner_of,
    sees_energy,
    sees_score,
)
from ui.model.playing.words import commander_in_words, outcome_of, verdict_words


@dataclass(slots=True)
class TerminalPlayer:
    """Player for a person who types.

    It carries out agreed steps, and steps that need no decision, without a further question.

    Attributes:
        show: function that prints a line.
        rooms: function that returns the names of the map's rooms.
        texts: function that returns the texts of the game's language.
        declined: True if the person does not take part.
        talk: texts between the people of a game with several participants.
    """

    show: Callable[[str], None]
    rooms: Callable[[], RoomNames]
    texts: Callable[[], Texts]
    declined: bool = False
    talk: TerminalTeamTalk = field(init=False)
    _view: View | None = None
    _wanted: tuple[ParticipantRequest, ...] = ()
    _typed: ParticipantRequest | None = None
    _names: dict[int, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.talk = TerminalTeamTalk(self.show, self.texts)

    def requests(self, view: View) -> Sequence[ParticipantRequest]:
        """Return the requests typed since the last call, and the requests that follow from agreements; see `Player`."""
        if view != self._view:
            before, self._view = self._view, view
            for line in Telling(self.texts(), self.rooms(), view, self._typed).changes(before):
                self.show(line)
            self.talk.see(before, view)
        wanted, self._wanted = self._wanted, ()
        self._typed = next(iter(wanted), self._typed)
        follow = [request for consent in view.consents if (request := self._follow(consent)) is not None]
        sense = [SenseTreasure(room.room) for room in view.rooms if room.undecided and not room.found]
        if view.team is not None:
            return (*wanted, *allowed(view, (*follow, *sense)), *self.talk.requests())
        return (*wanted, *follow, *sense)

    def type(self, line: str) -> None:
        """Handle one typed line; for an unknown command, show help."""
        view = self._view
        if view is None:
            self.show(self.texts().text("terminal.not_begun"))
            return
        if view.consent is not None:
            self._answer_consent(line)
            return
        if self.talk.type(unicodedata.normalize("NFC", line)):
            return
        telling = Telling(self.texts(), self.rooms(), view, self._typed)
        # Some keyboards and terminals send an accented letter as two characters.
        match unicodedata.normalize("NFC", line).split():
            case []:
                pass
            case ["?"]:
                for state in telling.state():
                    self.show(state)
            case [word] if self._means(word, "rules"):
                for rule in rules_of(self.texts(), view):
                    self.show(f"  {rule}")
            case [word] if self._means(word, "names"):
                self.show(f"  {_listed(view)}" if view.names else telling.texts.text("terminal.no_names"))
            case [word] if view.team is not None and self._means(word, "team"):
                for person in self.talk.people(view):
                    self.show(person)
            case [word] if self._means(word, "end"):
                self._ask(view, EndGame(view.game))
            case [letter] if letter in (waiting := _letters(view)) or letter in ("c", "s"):
                self._answer(view, waiting.get(letter, 0 if letter == "c" else -1))
            case [answer] if _is_number(answer):
                self._answer_by_number(view, None, int(answer))
            case [answer] if all(map(_is_number, parts := answer.split(":"))) and len(parts) == 2:
                self._answer_by_number(view, index_of(int(parts[0])), int(parts[1]))
            case ["p", room] if _is_number(room):
                self._take_picture(view, telling, int(room))
            case ["n", room, "?"] if _is_number(room) and view.has_last_word is not None:
                self._discuss(view, int(room), "take-treasure", "")
            case ["n", room, *words] if _is_number(room) and words:
                self._name(view, int(room), " ".join(words))
            case ["m", room, *words] if _is_number(room) and words:
                self._measure(view, telling, int(room), words)
            case ["t", room, *words] if _is_number(room) and words:
                self._report_property(view, telling, int(room), words)
            case ["l", room] if _is_number(room):
                self._leave(view, telling, int(room))
            case ["u", room] if _is_number(room):
                self._take_up(view, int(room))
            case ["b", robot] if _is_number(robot):
                self._ask(view, StopRobot(index_of(int(robot))))
            case ["g", robot, *words] if _is_number(robot) and view.team is not None:
                self._hand_over(view, index_of(int(robot)), " ".join(words))
            case ["o", robot, *words] if _is_number(robot) and view.team is not None:
                self._object(view, index_of(int(robot)), words)
            case [word, *reason] if view.team is not None and (agrees := answer_in(self.texts(), word)) is not None:
                self._vote(view, reason, agrees=agrees)
            case ["a", robot] if _is_number(robot):
                self._ask_back(view, index_of(int(robot)))
            case [robot, "?"] if _is_number(robot):
                self._ask_to_go(telling, RequestSuggestion(index_of(int(robot))))
            case [robot, room] if _is_number(robot) and _is_number(room):
                self._ask_to_go(telling, SelectRoom(index_of(int(robot)), int(room)))
            case _:
                self.show(self.texts().text("terminal.help"))
                if view.team is not None:
                    self.show(self.texts().text("terminal.help_team"))
                    if view.team.own.may_object:
                        self.show(self.texts().text("terminal.help_object"))
                    self.show(self.texts().text("terminal.help_people"))

    def _means(self, typed: str, word: str) -> bool:
        """Return True for a command word, in the game's language or in English."""
        return typed.casefold() in (word, self.texts().text(f"terminal.word_{word}").casefold())

    def _answer_consent(self, line: str) -> None:
        match answer_in(self.texts(), line):
            case True:
                self._wanted = (GiveConsent(utc_now()),)
            case False:
                self.declined = True
            case None:
                self.show(self.texts().text("terminal.question"))

    def _answer(self, view: View, choice: int) -> None:
        """Answer the first waiting dialogue; -1 is the last choice."""
        dialogue = _waiting(view)
        if dialogue is None:
            self.show(self.texts().text("terminal.nobody_waits"))
            return
        self._wanted = (AnswerDialogue(dialogue.dialogue, dialogue.turn, choice % len(dialogue.choices)),)

    def _answer_by_number(self, view: View, robot: int | None, number: int) -> None:
        waiting = [each for each in view.dialogues if each.choices and robot in (None, each.robot)]
        if not waiting:
            self.show(self.texts().text("terminal.nobody_waits" if robot is None else "terminal.does_not_wait"))
        elif len(waiting) > 1:
            self.show(self.texts().text("terminal.several_wait", answer=f"{number_of(waiting[0].robot)}:{number}"))
        elif not 0 < number <= len(waiting[0].choices):
            self.show(self.texts().text("terminal.answers_are", number=len(waiting[0].choices)))
        else:
            self._wanted = (AnswerDialogue(waiting[0].dialogue, waiting[0].turn, number - 1),)

    def _name(self, view: View, room: int, typed: str) -> None:
        words = name_in_words(typed).casefold()
        fitting = [name for name in view.names if view.word_for(name).casefold().startswith(words)]
        fitting = [name for name in fitting if view.word_for(name).casefold() == words] or fitting
        if len(fitting) != 1:
            key = "terminal.no_such_name" if view.names else "terminal.no_names"
            self.show(self.texts().text(key, names=_listed(view)))
            return
        self._names[room] = fitting[0]
        self._discuss(view, room, "take-treasure", None if view.has_last_word is None else fitting[0])

    def _ask(self, view: View, request: JudgedRequest) -> None:
        """Send a request, or show why it is impossible.

        Like windows, it does not send an impossible request: to a robot that decides alone when it is ignored, even a
        refused request is attention.
        """
        ruling = judge(revealed(view), request)
        if isinstance(ruling, RequestRefused):
            self.show(why_refused(self.texts(), revealed(view), ruling, request))
        else:
            self._wanted = (request,)

    def _ask_to_go(self, telling: "Telling", request: SelectRoom | RequestSuggestion) -> None:
        """Request a dialogue about a robot's next room. If that dialogue is open, only show it again, as windows do."""
        talks = (each for each in telling.view.dialogues if (each.robot, each.matter) == (request.robot, "select-room"))
        talk = next(talks, None)
        wish = None if isinstance(request, RequestSuggestion) else request.room
        if talk is not None and (talk.suggested if wish is None else talk.room == wish):
            for line in telling.again(talk):
                self.show(line)
        else:
            self._ask(telling.view, request)

    def _take_picture(self, view: View, telling: "Telling", room: int) -> None:
        place = _visited(view, room)
        if place is not None and place.picture is not None:
            self.show(telling.pictured(place))
        elif place is not None and not place.undecided:
            self.show(self.texts().text("hints.refused_already_decided"))
        else:
            self._discuss(view, room, "take-picture")

    def _measure(self, view: View, telling: "Telling", room: int, words: Sequence[str]) -> None:
        asked, place = _begun([each for each in view.properties if each.is_measured], words), _visited(view, room)
        if asked is None:
            self.show(self.texts().text("terminal.nothing_to_sense"))
        elif place is not None and asked.name in place.known:
            self.show(telling.known(place))
        else:
            self._ask(view, MeasureProperty(room, asked.name))

    def _report_property(self, view: View, telling: "Telling", room: int, words: Sequence[str]) -> None:
        told = _begun([each for each in view.properties if each.told_by is Teller.PERSON], words)
        typed, place = " ".join(words).casefold(), _visited(view, room)
        values = [] if told is None else [each for each in told.values if typed.endswith(told.shown(each).casefold())]
        if told is None or not values:
            self.show(self.texts().text("terminal.nothing_to_tell"))
        elif place is not None and place.told.get(told.name) == values[0]:
            self.show(telling.known(place))
        else:
            self._ask(view, TellProperty(room, told.name, values[0]))

    def _ask_back(self, view: View, robot: int) -> None:
        asked = view.robots[robot] if 0 <= robot < len(view.robots) else None
        if asked is not None and not asked.has_other_commander:
            self.show(self.texts().text("hints.you_command", robot=robot))
        elif asked is not None and (reason := why_not_ask_for(self.texts(), view, asked)):
            self.show(reason)
        elif asked is not None and asked.asked_back:
            self.show(self.texts().text("hints.asked_already", robot=robot))
        else:
            self._ask(view, RequestHandback(robot))

    def _hand_over(self, view: View, robot: int, typed: str) -> None:
        taker = taker_named(view, typed)
        if taker is None:
            self.show(self.texts().text("terminal.takers", seats=listed_takers(view) or "–"))
        else:
            self._ask(view, HandOver(robot, taker.name))

    def _vote(self, view: View, words: Sequence[str], *, agrees: bool) -> None:
        """Vote on the first open decision or, if the first word is the number of a decision, on this decision."""
        vote = vote_typed(view, words, agrees=agrees)
        if vote is None:
            self.show(self.texts().text("votes.none_open"))
        else:
            self._wanted = (vote,)

    def _object(self, view: View, robot: int, words: Sequence[str]) -> None:
        """Object in a teammate's dialogue with a robot or, if the number of a reason is missing, show the reasons."""
        match objection_typed(view, robot, words):
            case RaiseObjection() as objection:
                self._wanted = (objection,)
            case DialogueView() as dialogue:
                for line in reason_lines(self.texts(), dialogue):
                    self.show(line)
            case None:
                self.show(self.texts().text("terminal.nothing_to_object"))

    def _leave(self, view: View, telling: "Telling", room: int) -> None:
        place = _visited(view, room)
        if place is not None and place.left:
            self.show(telling.left(place))
        else:
            self._ask(view, LeaveTreasure(room))

    def _take_up(self, view: View, room: int) -> None:
        place = view.room(room) if 0 < room <= len(view.rooms) else None
        if place is None or place.left:
            self._ask(view, TakeUpTreasure(room))
        elif place.robot is None:
            self._show_no_robot(room)
        else:
            self.show(self.texts().text("hints.nothing_to_undo", robot=place.robot))

    def _discuss(
        self, view: View, room: int, matter: Literal["take-picture", "take-treasure"], name: str | None = None
    ) -> None:
        robot = view.room(room).robot if 0 < room <= len(view.rooms) else None
        if robot is None:
            self._show_no_robot(room)
        else:
            self._ask(view, OpenDialogue(robot, matter, room, name))

    def _show_no_robot(self, room: int) -> None:
        self.show(self.texts().text("terminal.no_robot", room=NamedRoom(room, self.rooms().named.get(room, ""))))

    def _follow(self, consent: Consent) -> ParticipantRequest | None:
        match consent.matter:
            case "select-room":
                return SendRobot(consent.robot, consent.room)
            case "take-picture":
                return TakePicture(consent.room)
            case "take-treasure":
                name = consent.name or self._names.get(consent.room, "")
                return IdentifyTreasure(consent.room, name) if name else None


def _visited(view: View, room: int) -> RoomView | None:
    """Return the room with this number if it is visited, or None."""
    return next((each for each in view.rooms if each.room == room and each.state == "visited"), None)


def _waiting(view: View) -> DialogueView | None:
    """Return the first dialogue that waits for an answer, or None."""
    return next((dialogue for dialogue in view.dialogues if dialogue.choices), None)


def _letters(view: View) -> dict[str, int]:
    """Return the index of each choice of the first waiting dialogue, by letter; empty if the choices are numbered."""
    dialogue = _waiting(view) if view.has_last_word is None else None
    return {} if dialogue is None else {letter: at for at, (letter, _) in enumerate(_lettered(dialogue))}


def _lettered(dialogue: DialogueView) -> list[tuple[str, str]]:
    """Return the letter and the text of each choice of a dialogue. The window uses the same letters as keys."""
    keys = map(str.lower, choice_keys(dialogue.choices))
    return list(zip(keys, dialogue.choices, strict=True))


def _begun(properties: Sequence[TreasureProperty], words: Sequence[str]) -> TreasureProperty | None:
    """Return the property whose label or name starts with the typed words, or None."""
    typed = " ".join(words).casefold()
    return next((each for each in properties if typed.startswith((each.label.casefold(), each.name))), None)


def _listed(view: View) -> str:
    return ", ".join(map(view.word_for, view.names))


def _is_number(word: str) -> bool:
    return word.isdecimal() and len(word) < 6


@dataclass(frozen=True, slots=True)
class Telling:
    """Lines about a view, in the language of the participant.

    Attributes:
        texts: texts of the language.
        rooms: names of the map's rooms.
        view: view to describe.
        typed: last typed request, to explain a refusal.
    """

    texts: Texts
    rooms: RoomNames
    view: View
    typed: ParticipantRequest | None

    def changes(self, before: View | None) -> list[str]:
        """Return lines about the changes since an earlier view."""
        view = self.view
        if view.consent is not None and (before is None or before.consent is None):
            return [*view.consent.splitlines(), self.texts.text("terminal.question")]
        if before is not None and before.consent is not None and view.consent is None:
            before = None
        if before is None or before.game != view.game:
            return [self.texts.text("terminal.game", number=view.game), *self.state()]
        lines = [*vote_news(self.texts, before, view), *asked_for_news(self.texts, before, view)]
        for was, now in zip(before.robots, view.robots, strict=True):
            lines += self._robot_changes(was, now)
        for old, new in zip(before.rooms, view.rooms, strict=True):
            lines += self._room_changes(old, new)
        known = {(dialogue.dialogue, dialogue.turn) for dialogue in before.dialogues}
        told = {dialogue.dialogue: len(dialogue.said) for dialogue in before.dialogues}
        for dialogue in view.dialogues:
            if (dialogue.dialogue, dialogue.turn) not in known:
                lines += self._asked(dialogue, told.get(dialogue.dialogue, 0))
        for words in view.last_words:
            if words not in before.last_words:
                lines += self._sentences(words, told.get(words.dialogue, 0))
                lines += () if words.is_told else (outcome_of(self.texts, words),)
        lines += objection_news(self.texts, before, view)
        # The result of a vote is among the news already.
        voted = view.refusal is not None and view.refusal.reason == KeeperReason.NOT_AGREED_ON
        if view.refusal is not None and view.refusal != before.refusal and not voted:
            lines.append(self._refused(view.refusal))
        if view.over is not None and before.over is None:
            over = self.texts.text("terminal.over", score=view.score)
            lines.append(over if sees_score(view) else self.texts.text("seats.over"))
            lines += ending_lines(self.texts, view)
        return lines

    def _refused(self, refusal: RefusalView) -> str:
        asked = self.typed is not None and refusal.wish in refusal_wishes(self.typed)
        return why_refused(self.texts, revealed(self.view), refusal, self.typed if asked else None)

    def state(self) -> list[str]:
        """Return lines about the current state."""
        view, lines = self.view, []
        for robot in view.robots:
            driving = robot.moving_to is not None
            key = "terminal.under_way" if driving else "terminal.in_room"
            key += "" if sees_energy(view) else "_only"
            room = self.room(robot.place if robot.moving_to is None else robot.moving_to)
            lines.append(self.texts.text(key, robot=robot.robot, energy=robot.energy, room=room))
            if robot.condition is not Condition.WELL:
                lines.append(self.texts.text(f"terminal.{robot.condition}", robot=robot.robot))
            if robot.blocked:
                lines.append(self.texts.text("history.blocked", robot=robot.robot))
            if robot.commander is not Commander.PARTICIPANT:
                lines.append(self.texts.text("terminal.commanded", robot=robot.robot, commander=self._commander(robot)))
            if asker := asker_of(view, robot.robot):
                lines.append(self.texts.text("seats.wants", seat=label_of(view, asker), robot=robot.robot))
        lines += [self._found(room) for room in view.rooms if room.found and room.undecided]
        free = " ".join(self.rooms.numbered(room.room) for room in view.rooms if room.state == "unvisited")
        lines += [line for each in decisions(view) for line in vote_lines(self.texts, view, each)]
        key = "terminal.not_visited" if free else "terminal.all_visited"
        key += "" if sees_score(view) else "_only"
        lines.append(self.texts.text(key, rooms=free, score=view.score))
        return [*(f"  {line}" for line in lines), *(line for each in view.dialogues for line in self.again(each))]

    def again(self, dialogue: DialogueView) -> list[str]:
        """Return lines about an open dialogue: its last sentence, and the choices."""
        return [f"  {line}" for line in self._asked(dialogue, len(dialogue.said) - 1)]

    def known(self, room: RoomView) -> str:
        """Return what is known about the treasure in a visited room; if it is decided, return only this."""
        return self._found(room) if room.undecided else self.texts.text("hints.refused_already_decided")

    def left(self, room: RoomView) -> str:
        """Return a line about a treasure that was left."""
        again = [] if room.robot is None else [self.texts.text("terminal.take_up", number=room.room)]
        return " ".join([self.texts.text("terminal.left", room=self.room(room.room)), *again])

    def pictured(self, room: RoomView) -> str:
        """Return a line about a picture that was taken."""
        return self.texts.text("terminal.pictured", room=self.room(room.room))

    def room(self, room: int) -> NamedRoom:
        """Return a room with its name, if it has one."""
        return NamedRoom(room, self.rooms.named.get(room, ""))

    def _commander(self, robot: RobotView) -> str:
        return commander_in_words(self.texts, robot.commander, robot.commander_name)

    def _robot_changes(self, was: RobotView, now: RobotView) -> list[str]:
        robot, lines = now.robot, []
        if now.moving_to is not None and was.moving_to != now.moving_to:
            goal = self.room(now.moving_to)
            key = "terminal.sets_out" if sees_energy(self.view) else "terminal.sets_out_only"
            lines.append(self.texts.text(key, robot=robot, energy=now.energy, room=goal))
        if was.moving_to is not None and now.moving_to is None:
            arrived = now.place == was.moving_to
            here = self.texts.text("terminal.arrived", robot=robot, room=self.room(now.place))
            lines.append(here if arrived else stopped_words(self.texts, was, now, shows_energy=sees_energy(self.view)))
        if now.blocked and not was.blocked:
            lines.append(self.texts.text("history.blocked", robot=robot))
        if now.condition is not was.condition:
            lines.append(self.texts.text(f"terminal.{now.condition}", robot=robot))
        if (now.commander, now.commander_name) != (was.commander, was.commander_name):
            other = now.commander is not Commander.PARTICIPANT
            mates = was.commander is Commander.TEAMMATE
            key = "terminal.commanded_now" if other else "seats.yours" if mates else "terminal.yours_again"
            lines.append(self.texts.text(key, robot=robot, commander=self._commander(now)))
        if now.asked_back and not was.asked_back:
            key = "seats.asked" if now.commander is Commander.TEAMMATE else "terminal.asked_back"
            commander = self._commander(now)
            lines.append(self.texts.text(key, robot=robot, commander=commander, seat=commander))
        return lines

    def _room_changes(self, old: RoomView, new: RoomView) -> list[str]:
        lines, room = [], self.room(new.room)
        if new.found and (new.known != old.known or (old.left and not new.left)):
            lines.append(self._found(new))
        if new.left and not old.left:
            lines.append(self.left(new))
        if new.picture is not None and old.picture is None:
            lines.append(self.pictured(new))
        if new.verdict is not None and old.verdict is None:
            word, shows = self.view.word_for(new.verdict.name), sees_score(self.view)
            words = verdict_words(self.texts, word, new.verdict.points, shows_points=shows)
            lines.append(self.texts.text("terminal.verdict", words=words, room=room))
        return lines

    def _found(self, room: RoomView) -> str:
        texts, properties, number = self.texts, self.view.properties, room.room
        values, place = values_in_words(properties, room.known), self.room(number)
        seen = (
            texts.text("terminal.found_with", values=values, room=place)
            if values
            else texts.text("terminal.found", room=place)
        )
        sense_more = "terminal.sense_more" if sees_energy(self.view) else "terminal.sense_more_only"
        more = [
            texts.text(sense_more, number=number, property=texts.noun(each.label), energy=each.cost)
            for each in properties
            if each.is_measured and each.name not in room.known and self._commands(room)
        ]
        more += [
            texts.text(
                "terminal.tell_more",
                number=number,
                property=texts.noun(each.label),
                values=", ".join(map(each.shown, each.values)),
            )
            for each in properties
            if each.told_by is Teller.PERSON
            and room.picture is not None
            and each.name not in room.told
            and may_name(self.view)
        ]
        name = [texts.text("terminal.name_it", number=number)] if may_name(self.view) else []
        return " ".join([seen, *more, *name])

    def _commands(self, room: RoomView) -> bool:
        """Return True if no teammate commands the robot in a room."""
        robot = None if room.robot is None else self.view.robots[room.robot]
        return robot is None or robot.commander is not Commander.TEAMMATE

    def _asked(self, dialogue: DialogueView, told: int = 0) -> list[str]:
        """Return lines about a dialogue that waits for an answer: sentences from number `told` on, and the choices.

        With lettered choices, the last sentence is shown again if there is no later one, indented like all repeated
        lines.
        """
        robot = dialogue.robot
        if not is_own(self.view, robot, dialogue.matter):
            return self._sentences(dialogue, told)
        if not dialogue.choices:
            return [self.texts.text("window.thinking", robot=robot)]
        if self.view.has_last_word is None:
            answers = ", ".join(f"{letter} {choice}" for letter, choice in _lettered(dialogue))
            asked = self.texts.text("terminal.asked", robot=robot, words=dialogue.said[-1], answers=answers)
            return [asked if told < len(dialogue.said) else f"  {asked}"]
        several = sum(bool(each.choices) for each in self.view.dialogues) > 1
        to = f"{number_of(robot)}:" if several else ""
        acts = dialogue.acts or ("",) * len(dialogue.choices)
        numbered = enumerate(zip(dialogue.choices, acts, strict=True), start=1)
        yours = f"  {self.texts.text('popups.your_decision')}"
        return [
            *self._sentences(dialogue, told),
            *(f"  {to}{number}  {text}{yours if act == OVERRIDE else ''}" for number, (text, act) in numbered),
        ]

    def _sentences(self, dialogue: DialogueView | LastWords, told: int) -> list[str]:
        """Return the sentences of a dialogue from number `told` on."""
        own = is_own(self.view, dialogue.robot, dialogue.matter)
        partner = partner_of(self.view, dialogue) if isinstance(dialogue, DialogueView) else ""
        partner = partner or self.view.robots[dialogue.robot].commander_name
        who = {
            "robot": self.texts.text("window.robot", robot=dialogue.robot),
            "you": self.texts.text("window.you"),
            "teammate": self.texts.text("seats.teammate_to", seat=partner, robot=dialogue.robot),
        }
        said = spoken(dialogue, own=own)[told:]
        return [self.texts.text("window.said", who=who[speaker], words=sentence) for speaker, sentence in said]
