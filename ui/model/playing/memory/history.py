"""Sentences about the events and dialogues of a game, for the history and for screen readers."""

from collections import deque
from collections.abc import Iterator, Sequence
from typing import Literal, Protocol

from thbridge.dialogue.wording.texts import Texts
from thbridge.hunt.properties import Teller, values_in_words
from thbridge.roles.shared.view import DialogueView, LastWords, RobotView, RoomView, View
from ui.model.playing.screen import HistoryLine
from ui.model.playing.seat_view import is_own, partner_of, sees_energy, sees_score
from ui.model.playing.words import outcome_of, verdict_words
from ui.model.shared.points import scored

MAX_LINES = 500
"""Maximum number of lines in the history."""

SpokenLine = tuple[Literal["robot", "you", "teammate", "objection"], str]
"""Speaker of a sentence, and the sentence. The sentence of an objection says who objects."""


class KeptLines(Protocol):
    """Lines of a game's history, kept for the next program that shows the same game."""

    def read(self) -> Sequence[HistoryLine]:
        """Return the lines that an earlier program has kept, oldest first."""

    def add(self, line: HistoryLine) -> None:
        """Keep a line."""

    def clear(self) -> None:
        """Drop all lines, because another game begins."""


class _NoLines:
    """Lines of a program that is the only one to show its game."""

    def read(self) -> Sequence[HistoryLine]:
        return ()

    def add(self, line: HistoryLine) -> None:
        pass

    def clear(self) -> None:
        pass


class GameHistory:
    """History of one game, and sentences that screen readers have not read out yet.

    Args:
        kept: lines of a program that showed the game before. If None, there is no such program.
    """

    def __init__(self, kept: KeptLines | None = None) -> None:
        self._kept = kept or _NoLines()
        self._lines: deque[HistoryLine] = deque(self._kept.read(), MAX_LINES)
        # Number of sentences in the history, for each open dialogue.
        self._known_sentences: dict[int, int] = {}
        self._announcements: list[str] = []
        # Robots that the participant has answered, until a view shows the answer.
        self._requested: set[int] = set()

    @property
    def lines(self) -> tuple[HistoryLine, ...]:
        """Lines of the history, oldest line first."""
        return tuple(self._lines)

    def following(self) -> "GameHistory":
        """Return the empty history of the next game."""
        self._kept.clear()
        return GameHistory(self._kept)

    def take_announcements(self) -> str:
        """Return the sentences for screen readers since the last call; empty if there are none."""
        news = " ".join(self._announcements)
        self._announcements.clear()
        return news

    def announce(self, sentence: str) -> None:
        """Add a sentence only for screen readers, not for the history."""
        self._announcements.append(sentence)

    def add_event(self, sentence: str, robot: int | None = None) -> None:
        """Add an event of the game."""
        self._append("game", robot, sentence)
        self._announcements.append(sentence)

    def add_request(self, robot: int, sentence: str) -> None:
        """Add the sentence by which the participant opened a dialogue."""
        self._append("you", robot, sentence)
        self._requested.add(robot)

    def add_answer(self, dialogue: DialogueView, choice: int) -> None:
        """Add the participant's choice at once, because views no longer contain it after the end of the dialogue."""
        if says(dialogue, choice):
            self._append("you", dialogue.robot, dialogue.choices[choice])
            self._known_sentences[dialogue.dialogue] = len(dialogue.said) + 1

    def receive(self, texts: Texts, before: View | None, view: View, *, once: bool = False) -> None:
        """Add everything that is new in a view. If `before` is None, this is the first view of the game.

        `Participant` describes `once`.
        """
        if before is None and self._lines:
            self._known_sentences = {each.dialogue: self._number_known(each) for each in view.dialogues}
        elif before is None:
            self._begin(texts, view, once=once)
        else:
            for was, now in zip(before.robots, view.robots, strict=True):
                for sentence in _robot_changes(texts, was, now, view):
                    self.add_event(sentence, now.robot)
            for old, new in zip(before.rooms, view.rooms, strict=True):
                for sentence in _room_changes(texts, view, old, new):
                    self.add_event(sentence, new.robot)
        for dialogue in view.dialogues:
            self._receive_sentences(texts, view, dialogue)
        ended = [words for words in view.last_words if before is not None and words not in before.last_words]
        for words in ended:
            self._receive_sentences(texts, view, words)
            if not (words.agreed or words.is_told):
                self.add_event(outcome_of(texts, words), words.robot)
        self._known_sentences = {
            dialogue.dialogue: self._known_sentences[dialogue.dialogue] for dialogue in view.dialogues
        }
        if view.over is not None and (before is None or before.over is None):
            over = texts.text("history.over", score=scored(view.score))
            self.add_event(over if sees_score(view) else texts.text("seats.over"))

    def _begin(self, texts: Texts, view: View, *, once: bool) -> None:
        fresh = all(room.state == "unvisited" for room in view.rooms)
        if fresh:
            key = "history.begins_once" if once else "history.begins"
        elif sees_score(view):
            key = "history.under_way_once" if once else "history.under_way"
        else:
            key = "seats.under_way_once" if once else "seats.under_way"
        self.add_event(
            texts.text(
                key,
                number=view.game,
                robots=texts.text("words.robots", count=len(view.robots)),
                rooms=texts.text("words.rooms", count=len(view.rooms)),
                score=scored(view.score),
            )
        )

    def _receive_sentences(self, texts: Texts, view: View, dialogue: DialogueView | LastWords) -> None:
        own = is_own(view, dialogue.robot, dialogue.matter)
        partner = partner_of(view, dialogue) if isinstance(dialogue, DialogueView) else ""
        partner = partner or ("" if own else view.robots[dialogue.robot].commander_name)
        sentences = spoken(dialogue, own=own)
        known = self._known_sentences.get(dialogue.dialogue)
        if known is None:
            # The participant's opening sentence is already in the history.
            is_hers = dialogue.matter != "take-picture" and [who for who, _ in sentences[:1]] == ["you"]
            known = 1 if is_hers and dialogue.robot in self._requested else 0
        self._requested.discard(dialogue.robot)
        for speaker, sentence in sentences[known:]:
            self._append(speaker, dialogue.robot, sentence, partner if speaker == "teammate" else "")
            if speaker == "robot":
                self._announcements.append(texts.text("history.robot_says", robot=dialogue.robot, sentence=sentence))
        self._known_sentences[dialogue.dialogue] = max(known, len(sentences))

    def _number_known(self, dialogue: DialogueView) -> int:
        """Return the number of a dialogue's sentences that an earlier program has kept."""
        said = [each for each in self._lines if each.robot == dialogue.robot and each.speaker != "game"]
        sentences = spoken(dialogue)
        for count in range(min(len(sentences), len(said)), 0, -1):
            # The words of the participant's opening sentence may differ.
            pairs = enumerate(zip(said[-count:], sentences, strict=False))
            if all(
                line.speaker == who and (line.text == text or (index == 0 and who == "you"))
                for index, (line, (who, text)) in pairs
            ):
                return count
        return 0

    def _append(
        self, speaker: Literal["robot", "you", "teammate", "game"], robot: int | None, text: str, teammate: str = ""
    ) -> None:
        self._lines.append(HistoryLine(speaker, robot, text, teammate))
        self._kept.add(self._lines[-1])


def says(dialogue: DialogueView, choice: int) -> bool:
    """Return True if a choice is a sentence; False if it only opens or closes the questions."""
    return dialogue.acts[choice : choice + 1] not in {("open-questions",), ("close-questions",)}


def spoken(
    dialogue: DialogueView | LastWords, *, own: bool = True
) -> tuple[tuple[Literal["robot", "you", "teammate"], str], ...]:
    """Return the sentences of a dialogue, each with its speaker. If `own` is False, a teammate talks with the robot.

    If the view does not name the speakers, robot and participant alternate, and the robot begins.
    """
    told = dialogue.speakers or ["person" if index % 2 else "robot" for index in range(len(dialogue.said))]
    return tuple(
        ("robot" if speaker == "robot" else "you" if own else "teammate", sentence)
        for speaker, sentence in zip(told, dialogue.said, strict=True)
    )


def stopped_words(texts: Texts, was: RobotView, now: RobotView, *, shows_energy: bool) -> str:
    """Return sentences about a robot that has stopped on its path, with the refunded energy if it is shown."""
    stopped = texts.text("history.stopped", robot=now.robot, room=was.moving_to or 0)
    back = now.energy - was.energy
    if now.moving_to is None and back > 0.0 and shows_energy:
        return f"{stopped} {texts.text('history.energy_back', energy=back)}"
    return stopped


def _robot_changes(texts: Texts, was: RobotView, now: RobotView, view: View) -> Iterator[str]:
    robot = now.robot
    if was.moving_to is not None and was.moving_to != now.moving_to:
        if view.room(was.moving_to).state == "visited":
            yield texts.text("history.arrived", robot=robot, room=was.moving_to)
        else:
            yield stopped_words(texts, was, now, shows_energy=sees_energy(view))
    if now.moving_to is not None and was.moving_to != now.moving_to:
        yield (
            texts.text("history.sets_out", robot=robot, room=now.moving_to, energy=now.energy)
            if sees_energy(view)
            else texts.text("seats.sets_out", robot=robot, room=now.moving_to)
        )
    if now.condition is not was.condition:
        yield texts.text(f"history.condition_{now.condition}", robot=robot)
    if now.blocked and not was.blocked:
        yield texts.text("history.blocked", robot=robot)


def _room_changes(texts: Texts, view: View, old: RoomView, new: RoomView) -> Iterator[str]:
    room = new.room
    if new.sensed is not None and not old.found:
        values = values_in_words(view.properties, new.sensed)
        yield (
            texts.text("history.found_with", values=values, room=room)
            if values
            else texts.text("history.found", room=room)
        )
    elif new.known != old.known:
        for each in view.properties:
            value = new.known.get(each.name)
            if value is not None and value != old.known.get(each.name):
                yield texts.text(
                    "history.person_tells" if each.told_by is Teller.PERSON else "history.robot_senses",
                    room=room,
                    property=texts.noun(each.label),
                    value=each.word(value),
                )
    if new.picture is not None and old.picture is None:
        yield (
            texts.text("history.picture", room=room)
            if new.robot is None
            else texts.text("history.picture_by", room=room, robot=new.robot)
        )
    if new.verdict is not None and old.verdict is None:
        yield texts.text(
            "history.named",
            room=room,
            verdict=verdict_words(
                texts, view.word_for(new.verdict.name), new.verdict.points, shows_points=sees_score(view)
            ),
        )
    if new.left and not old.left:
        yield texts.text("history.left", room=room)
    if old.left and not new.left:
        yield texts.text("history.taken_up", room=room)
