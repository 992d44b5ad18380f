"""Events and dialogues of a game in sentences, for the history and for screen readers."""

from collections import deque
from collections.abc import Iterator
from typing import Literal

from sim.common.robot_numbers import robot_name
from thbridge.hunt.costs import energy_text
from thbridge.hunt.events import Condition
from thbridge.hunt.properties import Teller, properties_in_words, value_in_words
from thbridge.roles.view import DialogueView, LastWords, RobotView, RoomView, View
from ui.model.playing.words import counted, outcome_of, place_name, scored, titled, verdict_words
from ui.model.screen import HistoryLine

MAX_LINES = 500
"""Lines kept."""

SpokenLine = tuple[Literal["robot", "you"], str]
"""Speaker and sentence."""

_CONDITIONS = {
    Condition.WELL: "is well again.",
    Condition.LOST: "is lost: it does not know where it is.",
    Condition.SILENT: "does not answer any more.",
}


class GameHistory:
    """Lines of one game so far, and the sentences still to be announced."""

    def __init__(self) -> None:
        self._lines: deque[HistoryLine] = deque(maxlen=MAX_LINES)
        # Number of sentences of each open dialogue that are in the history.
        self._known_sentences: dict[int, int] = {}
        self._announcements: list[str] = []
        # Robots to which the participant has said something that no view has answered yet.
        self._requested: set[int] = set()

    @property
    def lines(self) -> tuple[HistoryLine, ...]:
        """Oldest first."""
        return tuple(self._lines)

    def take_announcements(self) -> str:
        """Return the sentences added since the last call; empty when there is none."""
        news = " ".join(self._announcements)
        self._announcements.clear()
        return news

    def announce(self, sentence: str) -> None:
        """Add a sentence for screen readers that is no part of the history."""
        self._announcements.append(sentence)

    def add_event(self, sentence: str, robot: int | None = None) -> None:
        """Add an event of the game."""
        self._append("game", robot, sentence)
        self._announcements.append(sentence)

    def add_request(self, robot: int, sentence: str) -> None:
        """Add the sentence with which the participant opened a dialogue."""
        self._append("you", robot, sentence)
        self._requested.add(robot)

    def add_answer(self, dialogue: DialogueView, choice: int) -> None:
        """Add the participant's choice now: once the dialogue is over, no view shows it again."""
        if says(dialogue, choice):
            self._append("you", dialogue.robot, dialogue.choices[choice])
            self._known_sentences[dialogue.dialogue] = len(dialogue.said) + 1

    def receive(self, before: View | None, view: View, *, once: bool = False) -> None:
        """Add the news of a view; `before` is None when the game is new to this program, `once` as in `Participant`."""
        if before is None:
            self._begin(view, "The game" if once else f"Game {view.game}")
        else:
            for was, now in zip(before.robots, view.robots, strict=True):
                for sentence in _robot_changes(was, now, view):
                    self.add_event(sentence, now.robot)
            for old, new in zip(before.rooms, view.rooms, strict=True):
                for sentence in _room_changes(view, old, new):
                    self.add_event(sentence, new.robot)
        for dialogue in view.dialogues:
            self._receive_sentences(dialogue)
        ended = [words for words in view.last_words if before is not None and words not in before.last_words]
        for words in ended:
            self._receive_sentences(words)
            if not (words.agreed or words.is_told):
                self.add_event(outcome_of(words), words.robot)
        self._known_sentences = {
            dialogue.dialogue: self._known_sentences[dialogue.dialogue] for dialogue in view.dialogues
        }
        if view.over is not None and (before is None or before.over is None):
            self.add_event(f"The game is over. The score is {scored(view.score)}.")

    def _begin(self, view: View, game: str) -> None:
        team = f"{counted(len(view.robots), 'robot')} and {counted(len(view.rooms), 'room')}"
        fresh = all(room.state == "unvisited" for room in view.rooms)
        self.add_event(
            f"{game} begins, with {team}."
            if fresh
            else f"{game} is under way, with {team}; the score is {scored(view.score)}."
        )

    def _receive_sentences(self, dialogue: DialogueView | LastWords) -> None:
        sentences = spoken(dialogue)
        known = self._known_sentences.get(dialogue.dialogue)
        if known is None:
            # What the participant opened it with is in the history since they did so.
            is_hers = dialogue.matter != "take-picture" and [who for who, _ in sentences[:1]] == ["you"]
            known = 1 if is_hers and dialogue.robot in self._requested else 0
        self._requested.discard(dialogue.robot)
        for speaker, sentence in sentences[known:]:
            self._append(speaker, dialogue.robot, sentence)
            if speaker == "robot":
                self._announcements.append(f"{titled(dialogue.robot)}: {sentence}")
        self._known_sentences[dialogue.dialogue] = max(known, len(sentences))

    def _append(self, speaker: Literal["robot", "you", "game"], robot: int | None, text: str) -> None:
        self._lines.append(HistoryLine(speaker, robot, text))


def says(dialogue: DialogueView, choice: int) -> bool:
    """Return True when a choice says something; to look for a question, and to ask none after all, does not."""
    return dialogue.acts[choice : choice + 1] not in {("open-questions",), ("close-questions",)}


def spoken(dialogue: DialogueView | LastWords) -> tuple[SpokenLine, ...]:
    """Return the sentences of a dialogue with their speakers; those that are not told alternate after the robot."""
    told = dialogue.speakers or ["person" if index % 2 else "robot" for index in range(len(dialogue.said))]
    return tuple(
        ("robot" if speaker == "robot" else "you", sentence)
        for speaker, sentence in zip(told, dialogue.said, strict=True)
    )


def stopped_words(was: RobotView, now: RobotView) -> str:
    """Sentence about a robot that has stopped on its way, with the energy that comes back to it."""
    back = now.energy - was.energy
    refund = f" {energy_text(back)} energy comes back." if now.moving_to is None and back > 0.0 else ""
    return f"{titled(now.robot)} has stopped before {place_name(was.moving_to or 0)}.{refund}"


def _robot_changes(was: RobotView, now: RobotView, view: View) -> Iterator[str]:
    name = titled(now.robot)
    if was.moving_to is not None and was.moving_to != now.moving_to:
        if view.room(was.moving_to).state == "visited":
            yield f"{name} is in {place_name(was.moving_to)}."
        else:
            yield stopped_words(was, now)
    if now.moving_to is not None and was.moving_to != now.moving_to:
        yield f"{name} sets out for {place_name(now.moving_to)}; it has {energy_text(now.energy)} energy left."
    if now.condition is not was.condition:
        yield f"{name} {_CONDITIONS[now.condition]}"
    if now.blocked and not was.blocked:
        yield f"{name} has no energy left."


def _room_changes(view: View, old: RoomView, new: RoomView) -> Iterator[str]:
    if new.sensed is not None and not old.found:
        yield f"In room {new.room} is {properties_in_words(view.properties, new.sensed)}."
    elif new.known != old.known:
        for each in view.properties:
            value = new.known.get(each.name)
            if value is not None and value != old.known.get(each.name):
                who = "You say" if each.told_by is Teller.PERSON else "Sensed"
                yield f"{who} of what is in room {new.room}: {each.label.lower()} {value_in_words(value)}."
    if new.picture is not None and old.picture is None:
        by = "" if new.robot is None else f" by {robot_name(new.robot)}"
        yield f"A picture is taken in room {new.room}{by}."
    if new.verdict is not None and old.verdict is None:
        yield f"Room {new.room}: {verdict_words(new.verdict.name, new.verdict.points)}"
    if new.left and not old.left:
        yield f"What is in room {new.room} is left there."
    if old.left and not new.left:
        yield f"What is in room {new.room} is taken up again."
