"""Games of several people for the tables: who had which seat when, and what each seat said and did."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import groupby

from thbridge.experiment.export.families.attempts import Attempt, AttemptSubject
from thbridge.experiment.export.families.game_recording import (
    GameRecording,
    TimedEvent,
    TimedTeamEntry,
    TimedUtterance,
)
from thbridge.experiment.export.families.trials import RecordingState, Trial
from thbridge.experiment.groups import HOLDERS, GroupGame, GroupGames
from thbridge.experiment.lobby import SeatHolder
from thbridge.experiment.progress import Run
from thbridge.experiment.store.events import EventKind, LoggedEvent, RunState
from thbridge.hunt.events import (
    CommanderChanged,
    DecisionProposed,
    HandbackRequested,
    ObjectionRaised,
    PersonSaid,
    PropertyTold,
    RobotDeparted,
    SeatLeft,
    SeatTaken,
    TreasureIdentified,
    TreasureLeft,
    TreasurePictured,
    TreasureTakenUp,
    VoteCast,
)
from thbridge.hunt.seats import PlayedBy

_ACTS = (
    CommanderChanged,
    HandbackRequested,
    PropertyTold,
    RobotDeparted,
    TreasureIdentified,
    TreasureLeft,
    TreasurePictured,
    TreasureTakenUp,
)
"""Events that a participant causes by an act."""


@dataclass(frozen=True, slots=True)
class SeatChange:
    """Change of the holder of a seat; `time` is the simulated time since the first tick, s, or None if unknown."""

    kind: str
    time: float | None


@dataclass(slots=True)
class SeatActs:
    """Acts of a seat in a game.

    Attributes:
        moves: number of robots that the seat sent to a room.
        pictures: number of pictures that cost energy.
        named: number of treasures that the seat named.
        points: points for these names.
        replies: number of sentences in dialogues with robots.
        texts: number of texts to other seats.
        characters: total length of these texts.
        proposed: number of decisions that the seat proposed.
        votes: number of votes on decisions of other seats.
        agreed: number of these votes that agree.
        objections: number of objections in dialogues of other seats.
        followed: number of these objections that were followed; see `AnsweredObjection`.
        acts: number of all acts.
        turns: number of turns; a turn is a series of acts of one seat that no other seat interrupts.
    """

    moves: int = 0
    pictures: int = 0
    named: int = 0
    points: int = 0
    replies: int = 0
    texts: int = 0
    characters: int = 0
    proposed: int = 0
    votes: int = 0
    agreed: int = 0
    objections: int = 0
    followed: int = 0
    acts: int = 0
    turns: int = 0


@dataclass(slots=True)
class AnsweredObjection:
    """Objection of a seat in a dialogue of another seat, and its effect.

    Attributes:
        raised: the objection.
        time: time since the start of the game, s.
        matter: matter of the dialogue; empty if the dialogue has no sentence.
        decider: seat that talked with the robot; empty if it said nothing.
        followed: True if what the dialogue proposed was not done before the next dialogue with this robot.
    """

    raised: ObjectionRaised
    time: float
    matter: str = ""
    decider: str = ""
    followed: bool = True


@dataclass(slots=True)
class GroupActs:
    """Acts of all seats in a game.

    Attributes:
        seats: acts of each seat.
        turns: number of turns of all seats.
    """

    seats: dict[str, SeatActs] = field(default_factory=dict)
    turns: int = 0

    @property
    def texts(self) -> int:
        """Number of texts of all seats."""
        return sum(each.texts for each in self.seats.values())

    @property
    def proposed(self) -> int:
        """Number of decisions that seats proposed."""
        return sum(each.proposed for each in self.seats.values())

    def of(self, seat: str) -> SeatActs:
        """Return the acts of a seat."""
        return self.seats.setdefault(seat, SeatActs())


@dataclass(frozen=True, slots=True)
class RecordedGroup:
    """Game of a group, with its log and its recording.

    Attributes:
        game: the game.
        run: run of one person of the group; the design columns of the game are those of this person.
        attempt: attempt of this person at the game's step.
        runs: runs of the people of the group, by their seats.
        changes: changes of each seat's holder, in order.
        waited: time for which each person waited in the lobby, s, by their seats.
        trial: game of a person of the group, or None if no game was finished.
        recording: recording of the game, or None if it cannot be read.
        acts: what each seat said and did.
    """

    game: GroupGame
    run: Run
    attempt: Attempt
    runs: Mapping[str, Run]
    changes: Mapping[str, Sequence[SeatChange]]
    waited: Mapping[str, float]
    trial: Trial | None
    recording: GameRecording | None = None
    acts: GroupActs = field(default_factory=GroupActs)

    @property
    def all_count(self) -> bool:
        """True if the runs of all people of the group are complete and not excluded, and no person has withdrawn."""
        people = [*self.game.began.values()].count(SeatHolder.PERSON)
        return len(self.runs) == people and all(run.state is RunState.COMPLETE for run in self.runs.values())

    def participant(self, seat: str) -> str | None:
        """Return the id of the person of a seat. Return None for other holders, and for people who withdrew."""
        return self.game.people.get(seat)

    def holder(self, seat: str, time: float) -> SeatHolder | PlayedBy:
        """Return the holder of a seat at a time since the start of the game, s; a researcher by the recording."""
        if self.recording is not None and is_researchers(self.recording.team, seat, time):
            return PlayedBy.RESEARCHER
        began = 0.0 if self.recording is None else self.recording.began
        present = self.game.began[seat]
        for change in self.changes.get(seat, ()):
            if change.time is not None and change.time <= time + began:
                present = HOLDERS[EventKind(change.kind)]
        return present

    def recorded(self, recording: GameRecording) -> "RecordedGroup":
        """Return the game with its recording."""
        return replace(self, recording=recording, acts=acts_of(recording))

    def logged(self, name: str) -> str | None:
        """Return a value of the log's data about the finished game as text, or None."""
        value = None if self.trial is None else self.trial.logged(name)
        return None if value is None else str(value)

    @property
    def state(self) -> RecordingState:
        """State of the game's recording."""
        return RecordingState.NONE if self.trial is None else self.trial.recording


def is_researchers(team: Sequence[TimedTeamEntry], seat: str, time: float) -> bool:
    """Return True if a researcher plays a seat at a time since the start of the game, s."""
    present: PlayedBy | None = None
    for each in team:
        match each.entry:
            case SeatTaken(seat=taken, by=by) if taken == seat and each.time <= time:
                present = by
            case SeatLeft(seat=left) if left == seat and each.time <= time:
                present = None
            case _:
                pass
    return present is PlayedBy.RESEARCHER


def recorded_groups(
    games: GroupGames, runs: Mapping[str, Run], events: Iterable[LoggedEvent], trials: Iterable[Trial]
) -> Iterator[RecordedGroup]:
    """Yield the games of all groups, in the order of the log, without their recordings.

    Args:
        games: games of the log.
        runs: run of each person.
        events: events of the log.
        trials: games of all people.
    """
    changes: dict[tuple[str, int], dict[str, list[SeatChange]]] = {}
    waited: dict[tuple[str, int], dict[str, float]] = {}
    for event in (each.event for each in events):
        data = event.data or {}
        key, seat = (str(data.get("group", "")), event.step), str(data.get("seat", ""))
        if event.kind in HOLDERS:
            change = SeatChange(event.kind, event.clocks.simulated)
            changes.setdefault(key, {}).setdefault(seat, []).append(change)
        elif event.kind == EventKind.GROUP_FORMED:
            waited.setdefault(key, {})[seat] = float(str(data.get("waited_s", 0.0)))
    played = {(each.run.participant, each.attempt.step.number): each for each in trials}
    for key, game in games.items():
        own = [played[person, game.step] for person in game.people.values() if (person, game.step) in played]
        if own:
            finished = next((trial for trial in own if trial.attempt.game is not None), None)
            people = {seat: runs[person] for seat, person in game.people.items()}
            first = own[0]
            yield RecordedGroup(
                game, first.run, first.attempt, people, changes.get(key, {}), waited.get(key, {}), finished
            )


def acts_of(recording: GameRecording) -> GroupActs:
    """Return the acts of all seats in a game."""
    found = GroupActs()
    for seat, each in _acts_in(recording):
        acts = found.of(seat)
        acts.acts += 1
        match each:
            case TimedEvent(event=event):
                acts.moves += isinstance(event, RobotDeparted)
                acts.pictures += isinstance(event, TreasurePictured) and event.cost > 0.0
                if isinstance(event, TreasureIdentified):
                    acts.named += 1
                    acts.points += event.points
            case TimedUtterance():
                acts.replies += 1
            case TimedTeamEntry(entry=ObjectionRaised()):
                acts.objections += 1
            case TimedTeamEntry(entry=PersonSaid(text=text)):
                acts.texts += 1
                acts.characters += len(text)
            case TimedTeamEntry(entry=DecisionProposed()):
                acts.proposed += 1
            case TimedTeamEntry(entry=VoteCast(agrees=agrees)):
                acts.votes += 1
                acts.agreed += agrees
    for seat in turns_in(recording):
        found.of(seat).turns += 1
        found.turns += 1
    for answered in objections_in(recording):
        found.of(answered.raised.seat).followed += answered.followed
    return found


def turns_in(recording: GameRecording) -> list[str]:
    """Return the seat of each turn in a game; a turn is a series of acts of one seat that no other seat interrupts."""
    return [seat for seat, _ in groupby(seat for seat, _ in _acts_in(recording))]


def _acts_in(recording: GameRecording) -> Iterator[tuple[str, TimedEvent | TimedUtterance | TimedTeamEntry]]:
    """Yield the acts, sentences, texts, votes and objections of seats in a game, in order, with the seat of each."""
    for each in sorted((*recording.happenings, *recording.team), key=lambda each: each.time):
        match each:
            case TimedEvent(event=event) if isinstance(event, _ACTS) and event.seat:
                yield event.seat, each
            case TimedUtterance(said=said) if said.seat:
                yield said.seat, each
            case TimedTeamEntry(entry=ObjectionRaised() | PersonSaid() | DecisionProposed() | VoteCast() as entry):
                yield entry.seat, each
            case _:
                pass


def subject_of(group: RecordedGroup) -> AttemptSubject:
    """Return the attempt of one person of a group, for the columns of the design."""
    return AttemptSubject(group.run, group.attempt)


def objections_in(recording: GameRecording) -> list[AnsweredObjection]:
    """Return the objections in a game, in order."""
    found: list[AnsweredObjection] = []
    matters: dict[int, str] = {}
    speakers: dict[int, str] = {}
    undecided: list[AnsweredObjection] = []
    for each in sorted((*recording.happenings, *recording.team), key=lambda each: each.time):
        match each:
            case TimedUtterance(said=said):
                matters.setdefault(said.dialogue, said.scenario)
                if said.seat:
                    speakers.setdefault(said.dialogue, said.seat)
                # The next dialogue with a robot ends what an earlier one can lead to.
                undecided = [
                    it for it in undecided if it.raised.robot != said.robot or it.raised.dialogue == said.dialogue
                ]
            case TimedTeamEntry(entry=ObjectionRaised() as raised, time=time):
                undecided.append(AnsweredObjection(raised, time, matters.get(raised.dialogue, "")))
                found.append(undecided[-1])
            case TimedEvent(event=RobotDeparted() | TreasurePictured() | TreasureIdentified() as event):
                for answered in undecided:
                    about = (answered.raised.robot, answered.raised.room)
                    if answered.matter == _MATTERS[type(event)] and (event.robot, event.room) == about:
                        answered.followed = False
    for answered in found:
        answered.decider = speakers.get(answered.raised.dialogue, "")
    return found


_MATTERS: Mapping[type, str] = {
    RobotDeparted: "select-room",
    TreasurePictured: "take-picture",
    TreasureIdentified: "take-treasure",
}
"""Matter of the dialogue after which an event happens."""
