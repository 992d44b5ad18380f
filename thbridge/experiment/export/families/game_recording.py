"""Reader of a trial's recording for the tables: events, utterances and dialogue moves, with their times."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

from thbridge.analysis.report.dialogues import DialogueGatherer, RecordedGame
from thbridge.experiment.export.families.attempts import Attempt
from thbridge.experiment.export.families.trials import Trial
from thbridge.experiment.progress import Run
from thbridge.files.errors import BadFile
from thbridge.hunt import game
from thbridge.hunt.codec import from_json
from thbridge.hunt.events import Event, GameEnded, GameStarted, JournalOnly, TeamEntry
from thbridge.recording.bag.reading.reader import RawMessage, info, messages
from thbridge.ros.messages import types, unpack
from thbridge.ros.messages.session_records import DialogueMoveRecord, UtteranceRecord
from thbridge.ros.messages.stamps import START_NS
from thbridge.ros.names import DIALOGUE_MOVES, DIALOGUE_STATES, GAME_EVENTS, TEAM, UTTERANCES

_TOPICS = (GAME_EVENTS, UTTERANCES, DIALOGUE_MOVES, DIALOGUE_STATES, TEAM)
_NOT_OF_THE_GAME = frozenset({"collision", "appeared", "vanished", "died", "revived", "carried", "authored"})
"""Kinds of recorded events that are not events of the hunt."""


@dataclass(frozen=True, slots=True)
class TimedEvent:
    """An event of the hunt.

    Attributes:
        time: time since the start of the game, s.
        event: the event.
        before: state of the game before the event.
        after: state of the game after the event.
    """

    time: float
    event: Event
    before: game.GameState
    after: game.GameState


@dataclass(frozen=True, slots=True)
class TimedUtterance:
    """An utterance, and its time in seconds since the start of the game."""

    time: float
    said: UtteranceRecord


@dataclass(frozen=True, slots=True)
class TimedMove:
    """A move in a dialogue game, and its time in seconds since the start of the game."""

    time: float
    move: DialogueMoveRecord


@dataclass(frozen=True, slots=True)
class TimedTeamEntry:
    """A text or vote of a participant, or their presence, and its time in seconds since the start of the game."""

    time: float
    entry: TeamEntry


Happening = TimedEvent | TimedUtterance | TimedMove


@dataclass(frozen=True, slots=True)
class RecordedTrial:
    """A trial and the recording of its game.

    Attributes:
        trial: the trial.
        recording: recording of the trial's game.
    """

    trial: Trial
    recording: "GameRecording"

    @property
    def run(self) -> Run:
        """The person's run."""
        return self.trial.run

    @property
    def attempt(self) -> Attempt:
        """The attempt at the trial."""
        return self.trial.attempt

    def wall(self, begin: float, end: float | None) -> float | None:
        """Return the real time between two simulated times of the game, s, or None if unknown."""
        if end is None:
            return None
        start, stop = (self.trial.wall(self.recording.began + moment) for moment in (begin, end))
        return None if start is None or stop is None else max(stop - start, 0.0)


@dataclass(slots=True)
class GameRecording:
    """Contents of a game's recording for the tables. If a recording has several games, this is the last game.

    Attributes:
        happenings: events, utterances and moves, in order.
        collisions: number of collisions of each robot, by its index.
        duration: time from the start to the end of the game, or to the end of the recording, s.
        games: the dialogue games.
        began: simulated time from the first tick of the recording to the start of the game, s.
        team: texts and votes of the participants, in a game with several seats, in order.
    """

    happenings: list[Happening] = field(default_factory=list)
    collisions: Counter[int] = field(default_factory=Counter)
    duration: float = 0.0
    games: tuple[RecordedGame, ...] = ()
    began: float = 0.0
    team: list[TimedTeamEntry] = field(default_factory=list)

    @property
    def events(self) -> Iterator[TimedEvent]:
        """The events of the hunt."""
        return (each for each in self.happenings if isinstance(each, TimedEvent))

    @property
    def utterances(self) -> Iterator[TimedUtterance]:
        """All utterances."""
        return (each for each in self.happenings if isinstance(each, TimedUtterance))

    @property
    def moves(self) -> Iterator[TimedMove]:
        """Moves in dialogue games."""
        return (each for each in self.happenings if isinstance(each, TimedMove))

    @property
    def robots(self) -> int:
        """Number of robots."""
        return next(len(each.after.robots) for each in self.events)

    @property
    def seats(self) -> tuple[str, ...]:
        """Names of the seats; empty if the game has one participant."""
        return next((tuple(seat.name for seat in each.after.started.seats) for each in self.events), ())

    def of_seat(self, seat: str) -> "GameRecording":
        """Return the recording with only the dialogues of a seat.

        A dialogue belongs to the first seat that speaks in it. If no seat speaks, it belongs to the seat that commanded
        the robot.
        """
        commands: dict[int, str] = {}
        spoke: dict[int, str] = {}
        silent: dict[int, str] = {}
        for each in self.happenings:
            match each:
                case TimedEvent(after=state):
                    commands = {robot: here.command.name for robot, here in enumerate(state.robots)}
                case TimedUtterance(said=said):
                    silent.setdefault(said.dialogue, commands.get(said.robot, ""))
                    if said.seat:
                        spoke.setdefault(said.dialogue, said.seat)
                case TimedMove(move=move):
                    silent.setdefault(move.talk, commands.get(move.robot, ""))
        own = {talk for talk, name in {**silent, **spoke}.items() if name == seat}
        return replace(
            self,
            happenings=[each for each in self.happenings if _talk_of(each) in {None, *own}],
            games=tuple(played for played in self.games if played.talk in own),
        )


def _talk_of(happening: Happening) -> int | None:
    """Return the number of the dialogue of an utterance or move, or None for an event."""
    match happening:
        case TimedUtterance(said=said):
            return said.dialogue
        case TimedMove(move=move):
            return move.talk
        case TimedEvent():
            return None


def read_game(bag: Path) -> GameRecording:
    """Read a game.

    Raises:
        BadFile: the recording has no game that this release can read.
    """
    builder = _Builder()
    try:
        for message in messages(bag, _TOPICS):
            builder.take(message)
        end_ns = info(bag).end_ns
        return builder.recording(end_ns)
    except ValueError as error:
        remedy = "Use the release of thbridge that recorded the game"
        raise BadFile(bag, f"the game in this recording cannot be read ({error})", remedy) from None


class _Builder:
    """Builder of a `GameRecording` from messages."""

    def __init__(self) -> None:
        self._begin_ns = 0
        self._state: game.GameState | None = None
        self._recording = GameRecording()
        self._dialogues = DialogueGatherer()
        self._ended: float | None = None

    def take(self, message: RawMessage) -> None:
        """Process a message. Raises ValueError if it cannot be read."""
        if message.md5 != types.plain_definition(message.msgtype).md5:
            raise ValueError(f"{message.topic} has the type {message.msgtype} of another release")
        time = (message.stamp_ns - self._begin_ns) / 1e9
        match message.msgtype:
            case types.GAME_EVENT if message.topic == TEAM:
                entry = from_json(unpack.game_event(message.data).json)
                if not isinstance(entry, TeamEntry):
                    raise ValueError(f"{TEAM} has an event that is neither a text nor a vote")
                self._recording.team.append(TimedTeamEntry(time, entry))
            case types.GAME_EVENT:
                self._event(message.stamp_ns, message.data)
            case types.UTTERANCE:
                utterance = unpack.utterance(message.data)
                self._dialogues.take_utterance(utterance)
                self._recording.happenings.append(TimedUtterance(time, utterance))
            case types.DIALOGUE_MOVE:
                move = unpack.dialogue_move(message.data)
                self._dialogues.take_move(time, move)
                self._recording.happenings.append(TimedMove(time, move))
            case types.DIALOGUE_STATE:
                self._dialogues.take_state(unpack.dialogue_state(message.data))

    def _event(self, stamp_ns: int, data: bytes) -> None:
        record = unpack.game_event(data)
        if record.kind in _NOT_OF_THE_GAME:
            if record.kind == "collision" and record.robot is not None:
                self._recording.collisions[record.robot] += 1
            return
        event = from_json(record.json)
        if isinstance(event, JournalOnly):
            raise ValueError(f"it has an event {record.kind}, which is only valid in journals")
        if isinstance(event, GameStarted):
            self._recording, self._dialogues, self._ended = GameRecording(), DialogueGatherer(), None
            self._begin_ns, self._state = stamp_ns, game.begin(event)
            self._recording.began = (stamp_ns - START_NS) / 1e9
        if self._state is None:
            raise ValueError("the start of the game is missing")
        time, before = (stamp_ns - self._begin_ns) / 1e9, self._state
        self._state = game.apply(before, event)
        if isinstance(event, GameEnded):
            self._ended = time
        self._recording.happenings.append(TimedEvent(time, event, before, self._state))

    def recording(self, end_ns: int | None) -> GameRecording:
        """Return the present recording. Raises ValueError if it has no game."""
        if self._state is None:
            raise ValueError("it has no game")
        end = 0.0 if end_ns is None else (end_ns - self._begin_ns) / 1e9
        self._recording.duration = end if self._ended is None else self._ended
        self._recording.games = self._dialogues.dialogues().games
        return self._recording
