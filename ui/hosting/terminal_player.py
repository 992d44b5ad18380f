"""A person as participant in the terminal: the lines they see, and the commands they may type."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Literal

from sim.common.robot_numbers import index_of, number_of, robot_name
from thbridge.files.language_texts import shipped_texts
from thbridge.hunt.costs import energy_text
from thbridge.hunt.events import Condition
from thbridge.hunt.properties import Teller, TreasureProperty, properties_in_words
from thbridge.hunt.rooms import RoomNames
from thbridge.hunt.treasures import name_in_words
from thbridge.roles.view import (
    AnswerDialogue,
    CallBack,
    Consent,
    DialogueView,
    GiveConsent,
    GiveUp,
    GiveUpTreasure,
    IdentifyTreasure,
    LastWords,
    MeasureProperty,
    OpenDialogue,
    ParticipantRequest,
    RequestHandback,
    RequestSuggestion,
    RobotView,
    RoomView,
    SelectRoom,
    SendRobot,
    SenseTreasure,
    TakePicture,
    TakeUpTreasure,
    TellProperty,
    View,
)
from thbridge.timing.wall_clock import utc_now
from ui.model.consent_words import QUESTION, answer_in
from ui.model.keys import choice_keys
from ui.model.playing.memory.history import spoken
from ui.model.playing.popups.dialogues import OVERRIDE
from ui.model.playing.words import outcome_of, verdict_words
from ui.model.rules_sheet import rules_of
from ui.story import CONDITIONS

HELP = """\
  1 4        talk with robot 1 about going to room 4
  1 ?        don't know: ask robot 1 where to go
  c   s      the first, or the last, answer in the dialogue that waits; or its letter, where it has one
  2   1:2    the second answer in the dialogue that waits; to robot 1, where several wait
  p 4        take a picture of what is in room 4; a terminal cannot show it
  m 4 WHAT   let the robot sense one more property of what is in room 4, where the game has such
  t 4 WHAT VALUE   tell what you see on the picture of room 4, where the game asks for it
  n 4 NAME   name the treasure in room 4 (the list: names)
  n 4 ?      don't know: ask the robot what it is, where robots argue
  l 4        leave the treasure in room 4
  u 4        take it up again, while the robot stands there
  b 1        call robot 1 back
  a 1        ask for robot 1, which somebody else commands, to be given back
  end        end the game
  names      which names treasures may have
  rules      the rules of the game
  ?          how things stand"""

YOURS = "  This is your decision."
"""Mark of the answer by which a person decides against a robot's advice."""
NO_NAMES = "No treasure has been found yet."


@dataclass(slots=True)
class TerminalPlayer:
    """A player who types. Steps that are agreed on, or need no decision, are done without asking again.

    Attributes:
        show: puts a line in front of the person.
        rooms: gives the names of the map's rooms.
        declined: the person does not take part.
    """

    show: Callable[[str], None]
    rooms: Callable[[], RoomNames] = RoomNames
    declined: bool = False
    _view: View | None = None
    _wanted: tuple[ParticipantRequest, ...] = ()
    _names: dict[int, str] = field(default_factory=dict)

    def requests(self, view: View) -> Sequence[ParticipantRequest]:
        """Return the requests typed since the last call, and those that follow from agreements; see `Player`."""
        if view != self._view:
            before, self._view = self._view, view
            for line in _changes(before, view, self.rooms()):
                self.show(line)
        wanted, self._wanted = self._wanted, ()
        follow = [request for consent in view.consents if (request := self._follow(consent)) is not None]
        sense = [SenseTreasure(room.room) for room in view.rooms if room.undecided and not room.found]
        return (*wanted, *follow, *sense)

    def type(self, line: str) -> None:
        """Take in one typed line; a line that cannot be understood is answered with help."""
        view = self._view
        if view is None:
            self.show("The game has not begun yet.")
            return
        if view.consent is not None:
            self._answer_consent(line)
            return
        match line.split():
            case []:
                pass
            case ["?"]:
                for state in _state_lines(view, self.rooms()):
                    self.show(state)
            case ["rules"]:
                for rule in rules_of(shipped_texts(), view):
                    self.show(f"  {rule}")
            case ["names"]:
                self.show(f"  {_listed(view.names)}" if view.names else NO_NAMES)
            case ["end"]:
                self._wanted = (GiveUp(view.game),)
            case [letter] if letter in (waiting := _letters(view)) or letter in ("c", "s"):
                self._answer(view, waiting.get(letter, 0 if letter == "c" else -1))
            case [answer] if _is_number(answer):
                self._answer_by_number(view, None, int(answer))
            case [answer] if all(map(_is_number, parts := answer.split(":"))) and len(parts) == 2:
                self._answer_by_number(view, index_of(int(parts[0])), int(parts[1]))
            case ["p", room] if _is_number(room):
                self._discuss(view, int(room), "take-picture")
            case ["n", room, "?"] if _is_number(room) and view.has_last_word is not None:
                self._discuss(view, int(room), "take-treasure", "")
            case ["n", room, *words] if _is_number(room) and words:
                self._name(view, int(room), " ".join(words))
            case ["m", room, *words] if _is_number(room) and words:
                self._measure(view, int(room), words)
            case ["t", room, *words] if _is_number(room) and words:
                self._tell(view, int(room), words)
            case ["l", room] if _is_number(room):
                self._wanted = (GiveUpTreasure(int(room)),)
            case ["u", room] if _is_number(room):
                self._wanted = (TakeUpTreasure(int(room)),)
            case ["b", robot] if _is_number(robot):
                self._wanted = (CallBack(index_of(int(robot))),)
            case ["a", robot] if _is_number(robot):
                self._wanted = (RequestHandback(index_of(int(robot))),)
            case [robot, "?"] if _is_number(robot):
                self._wanted = (RequestSuggestion(index_of(int(robot))),)
            case [robot, room] if _is_number(robot) and _is_number(room):
                self._wanted = (SelectRoom(index_of(int(robot)), int(room)),)
            case _:
                self.show(HELP)

    def _answer_consent(self, line: str) -> None:
        match answer_in(line):
            case True:
                self._wanted = (GiveConsent(utc_now()),)
            case False:
                self.declined = True
            case None:
                self.show(QUESTION)

    def _answer(self, view: View, choice: int) -> None:
        """Answer the first dialogue that waits; -1 is its last answer."""
        dialogue = _waiting(view)
        if dialogue is None:
            self.show("No robot waits for an answer.")
            return
        self._wanted = (AnswerDialogue(dialogue.dialogue, dialogue.turn, choice % len(dialogue.choices)),)

    def _answer_by_number(self, view: View, robot: int | None, number: int) -> None:
        waiting = [each for each in view.dialogues if each.choices and robot in (None, each.robot)]
        if not waiting:
            self.show("No robot waits for an answer." if robot is None else "This robot waits for no answer.")
        elif len(waiting) > 1:
            self.show(f"Several robots wait: type {number_of(waiting[0].robot)}:{number} to answer the first.")
        elif not 0 < number <= len(waiting[0].choices):
            self.show(f"The answers are 1 to {len(waiting[0].choices)}.")
        else:
            self._wanted = (AnswerDialogue(waiting[0].dialogue, waiting[0].turn, number - 1),)

    def _name(self, view: View, room: int, typed: str) -> None:
        words = name_in_words(typed).casefold()
        fitting = [name for name in view.names if name_in_words(name).casefold().startswith(words)]
        fitting = [name for name in fitting if name_in_words(name).casefold() == words] or fitting
        if len(fitting) != 1:
            self.show(f"{typed} is not one of: {_listed(view.names)}" if view.names else NO_NAMES)
            return
        self._names[room] = fitting[0]
        self._discuss(view, room, "take-treasure", None if view.has_last_word is None else fitting[0])

    def _measure(self, view: View, room: int, words: Sequence[str]) -> None:
        asked = _begun([each for each in view.properties if each.is_measured], words)
        if asked is None:
            self.show("Robots sense nothing of that name on request.")
        else:
            self._wanted = (MeasureProperty(room, asked.name),)

    def _tell(self, view: View, room: int, words: Sequence[str]) -> None:
        told = _begun([each for each in view.properties if each.told_by is Teller.PERSON], words)
        typed = " ".join(words).casefold()
        value = next(
            (value for value in (() if told is None else told.values) if typed.endswith(value.casefold())), None
        )
        if told is None or value is None:
            self.show("People tell nothing of that name here.")
        else:
            self._wanted = (TellProperty(room, told.name, value),)

    def _discuss(
        self, view: View, room: int, matter: Literal["take-picture", "take-treasure"], name: str | None = None
    ) -> None:
        robot = view.room(room).robot if 0 < room <= len(view.rooms) else None
        if robot is None:
            self.show(f"No robot stands in room {self.rooms().numbered(room)}.")
        else:
            self._wanted = (OpenDialogue(robot, matter, room, name),)

    def _follow(self, consent: Consent) -> ParticipantRequest | None:
        match consent.matter:
            case "select-room":
                return SendRobot(consent.robot, consent.room)
            case "take-picture":
                return TakePicture(consent.room)
            case "take-treasure":
                name = consent.name or self._names.get(consent.room, "")
                return IdentifyTreasure(consent.room, name) if name else None


def _waiting(view: View) -> DialogueView | None:
    """The first dialogue that waits for an answer, or None."""
    return next((dialogue for dialogue in view.dialogues if dialogue.choices), None)


def _letters(view: View) -> dict[str, int]:
    """The answers of the first dialogue that waits, by the letters in front of them; none where they are numbered."""
    dialogue = _waiting(view) if view.has_last_word is None else None
    return {} if dialogue is None else {letter: at for at, (letter, _) in enumerate(_lettered(dialogue))}


def _lettered(dialogue: DialogueView) -> list[tuple[str, str]]:
    """The answers of a dialogue, each after its letter, which is its key in the window."""
    keys = map(str.lower, choice_keys(dialogue.choices))
    return list(zip(keys, dialogue.choices, strict=True))


def _begun(properties: Sequence[TreasureProperty], words: Sequence[str]) -> TreasureProperty | None:
    """The property whose label or name the typed words begin with, or None."""
    typed = " ".join(words).casefold()
    return next((each for each in properties if typed.startswith((each.label.casefold(), each.name))), None)


def _listed(names: Sequence[str]) -> str:
    return ", ".join(name_in_words(name) for name in names)


def _is_number(word: str) -> bool:
    return word.isdecimal() and len(word) < 6


def _changes(before: View | None, view: View, rooms: RoomNames) -> list[str]:
    """Lines that tell a person the changes since the view before."""
    if view.consent is not None and (before is None or before.consent is None):
        return [*view.consent.splitlines(), QUESTION]
    if before is not None and before.consent is not None and view.consent is None:
        before = None
    if before is None or before.game != view.game:
        return [
            f"Game {view.game}. Type rules for its rules, ? to see how things stand, h for help.",
            *_state_lines(view, rooms),
        ]
    lines: list[str] = []
    for was, now in zip(before.robots, view.robots, strict=True):
        lines += _robot_changes(was, now, rooms)
    for old, new in zip(before.rooms, view.rooms, strict=True):
        lines += _room_changes(view, old, new, rooms)
    known = {(dialogue.dialogue, dialogue.turn) for dialogue in before.dialogues}
    told = {dialogue.dialogue: len(dialogue.said) for dialogue in before.dialogues}
    for dialogue in view.dialogues:
        if (dialogue.dialogue, dialogue.turn) not in known:
            lines += _asked(view, dialogue, told.get(dialogue.dialogue, 0))
    for words in view.last_words:
        if words not in before.last_words:
            lines += _told(words, told.get(words.dialogue, 0))
            lines += () if words.is_told else (outcome_of(shipped_texts(), words),)
    if view.refusal is not None and view.refusal != before.refusal:
        lines.append(view.refusal.sentence)
    if view.over is not None and before.over is None:
        lines.append(f"The game is over. Score {view.score}.")
    return lines


def _robot_changes(was: RobotView, now: RobotView, rooms: RoomNames) -> list[str]:
    name = robot_name(now.robot).capitalize()
    lines = []
    if now.moving_to is not None and was.moving_to != now.moving_to:
        lines.append(
            f"{name} sets out for {rooms.titled(now.moving_to)}; it has {energy_text(now.energy)} energy left."
        )
    if was.moving_to is not None and now.moving_to is None:
        there = now.place == was.moving_to
        lines.append(f"{name} is in {rooms.titled(now.place)}." if there else f"{name} has stopped.")
    if now.condition is not was.condition:
        lines.append(f"{name} {CONDITIONS[now.condition]}")
    if (now.commander, now.commander_name) != (was.commander, was.commander_name):
        other = now.other_commander
        lines.append(f"{name} is commanded by {other} now." if other else f"{name} is yours again.")
    if now.asked_back and not was.asked_back:
        lines.append(f"You have asked {now.other_commander} for {robot_name(now.robot)} back.")
    return lines


def _room_changes(view: View, old: RoomView, new: RoomView, rooms: RoomNames) -> list[str]:
    lines = []
    room = f"Room {rooms.numbered(new.room)}"
    if new.found and (new.known != old.known or (old.left and not new.left)):
        lines.append(_found(view, new, rooms))
    if new.left and not old.left:
        again = f" u {new.room} takes it up again, until its robot sets out." if new.robot is not None else ""
        lines.append(f"{room}: what is there is left there.{again}")
    if new.picture is not None and old.picture is None:
        lines.append(f"{room}: a picture is taken. A terminal cannot show it.")
    if new.verdict is not None and old.verdict is None:
        lines.append(f"{room}: {verdict_words(shipped_texts(), new.verdict.name, new.verdict.points)}")
    return lines


def _found(view: View, room: RoomView, rooms: RoomNames) -> str:
    seen = properties_in_words(view.properties, room.known)
    more = [
        f" m {room.room} {each.label.lower()} senses its {each.label.lower()} for {energy_text(each.cost)} energy."
        for each in view.properties
        if each.is_measured and each.name not in room.known
    ]
    more += [
        f" t {room.room} {each.label.lower()} VALUE tells its {each.label.lower()}: {', '.join(each.values)}."
        for each in view.properties
        if each.told_by is Teller.PERSON and room.picture is not None and each.name not in room.told
    ]
    return f"Room {rooms.numbered(room.room)}: {seen}.{''.join(more)} n {room.room} NAME names it."


def _asked(view: View, dialogue: DialogueView, told: int = 0) -> list[str]:
    """Lines on what waits for an answer; where robots argue, those from sentence number `told` on, and the choices."""
    name = robot_name(dialogue.robot).capitalize()
    if not dialogue.choices:
        return [f"{name} is thinking."]
    if view.has_last_word is None:
        answers = ", ".join(f"{letter} {choice}" for letter, choice in _lettered(dialogue))
        return [f"{name}: {dialogue.said[-1]}   [{answers}]"]
    several = sum(bool(each.choices) for each in view.dialogues) > 1
    to = f"{number_of(dialogue.robot)}:" if several else ""
    acts = dialogue.acts or ("",) * len(dialogue.choices)
    numbered = enumerate(zip(dialogue.choices, acts, strict=True), start=1)
    return [
        *_told(dialogue, told),
        *(f"  {to}{number}  {text}{YOURS if act == OVERRIDE else ''}" for number, (text, act) in numbered),
    ]


def _told(dialogue: DialogueView | LastWords, told: int) -> list[str]:
    """Sentences of a dialogue from number `told` on."""
    name = robot_name(dialogue.robot).capitalize()
    return [f"{name if speaker == 'robot' else 'You'}: {sentence}" for speaker, sentence in spoken(dialogue)[told:]]


def _state_lines(view: View, rooms: RoomNames) -> list[str]:
    lines = []
    for robot in view.robots:
        goal = robot.moving_to
        where = f"in {rooms.titled(robot.place)}" if goal is None else f"under way to {rooms.titled(goal)}"
        name = robot_name(robot.robot).capitalize()
        lines.append(f"  {name}: {where}, energy {energy_text(robot.energy)}")
        if robot.condition is not Condition.WELL:
            lines.append(f"  {name} {CONDITIONS[robot.condition]}")
        if other := robot.other_commander:
            lines.append(f"  {name} is commanded by {other}.")
    lines += [f"  {_found(view, room, rooms)}" for room in view.rooms if room.found and room.undecided]
    free = [rooms.numbered(room.room) for room in view.rooms if room.state == "unvisited"]
    lines.append(f"  Rooms not visited: {' '.join(free) or 'none'}. Score {view.score}.")
    lines += [f"  {line}" for dialogue in view.dialogues for line in _asked(view, dialogue, len(dialogue.said) - 1)]
    return lines
