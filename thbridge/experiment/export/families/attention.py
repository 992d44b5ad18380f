"""The tables `robots` and `fluency`: waiting times of people and robots in a game.

A robot acts while it drives to a room. A robot waits for the person if it does not drive, sends messages, is under the
person's command, and can be sent to a room or is at an undecided treasure. The person waits while no robot waits for
the person. Sources: Hoffman, Evaluating fluency in human-robot collaboration (2019); Olsen and Goodrich, Metrics for
evaluating human-robot interactions (2003).
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

from sim.common.robot_numbers import number_of
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.export.families.attempts import Attempt, attempt_columns
from thbridge.experiment.export.families.decisions import GameDecision
from thbridge.experiment.export.families.described import (
    ExperimentTable,
    TableOf,
    count,
    number,
    seconds,
    share,
    whole,
)
from thbridge.experiment.export.families.game_recording import (
    GameRecording,
    RecordedTrial,
    TimedEvent,
    TimedMove,
    TimedUtterance,
)
from thbridge.experiment.progress import Run
from thbridge.hunt import rules
from thbridge.hunt.events import (
    Commander,
    HandbackRequested,
    MoveFailed,
    PropertyMeasured,
    PropertyTold,
    RobotArrived,
    RobotDeparted,
    TreasureIdentified,
    TreasureLeft,
    TreasurePictured,
    TreasureTakenUp,
)
from thbridge.hunt.game import GameState

_OF_A_ROBOT = (TreasurePictured, TreasureIdentified, PropertyMeasured, HandbackRequested)
_OF_A_ROOM = (PropertyTold, TreasureLeft, TreasureTakenUp)


@dataclass(slots=True)
class RobotStand:
    """Period in which a robot stood, from its arrival (or the start of the game) to its departure.

    Attributes:
        robot: index of the robot in the team.
        began: time at which the robot stopped, s.
        first_act: time at which the person first acted on the robot or talked to it, or None.
        last_act: time at which the person last acted on the robot or talked to it, or None.
        departed: time at which the robot departed, or None if the game ended before.
        by_person: True if the person sent the robot.
    """

    robot: int
    began: float
    first_act: float | None = None
    last_act: float | None = None
    departed: float | None = None
    by_person: bool = False

    def act(self, time: float) -> None:
        """Record an act of the person."""
        self.first_act, self.last_act = time if self.first_act is None else self.first_act, time


@dataclass(slots=True)
class RobotAttention:
    """Figures of a robot in a game.

    Attributes:
        stands: periods in which the robot stood.
        drives: duration of each move, s.
        arrived: number of moves that reached their room.
        failed: number of moves that did not reach their room.
        spent: energy that the robot spent.
        under_way: time for which the robot drove, s.
        waiting: time for which the robot waited for the person, s.
    """

    stands: list[RobotStand] = field(default_factory=list)
    drives: list[float] = field(default_factory=list)
    arrived: int = 0
    failed: int = 0
    spent: float = 0.0
    under_way: float = 0.0
    waiting: float = 0.0

    @property
    def attention(self) -> list[float]:
        """For each period of standing: time from its start to the person's first act on the robot, s."""
        return [each.first_act - each.began for each in self.stands if each.first_act is not None]

    @property
    def interaction(self) -> list[float]:
        """For each robot that the person sent: time from the person's first act to the robot's departure, s."""
        return [
            each.departed - each.first_act
            for each in self.stands
            if each.by_person and each.first_act is not None and each.departed is not None
        ]

    @property
    def delays(self) -> list[float]:
        """For each robot that the person sent: times from arrival to first act, and from last act to departure, s."""
        sent = [each for each in self.stands if each.by_person and each.departed is not None]
        known = ((each.began, each.first_act, each.last_act, each.departed) for each in sent)
        return [
            time
            for began, first, last, departed in known
            if first is not None and last is not None and departed is not None
            for time in (first - began, departed - last)
        ]


@dataclass(frozen=True, slots=True)
class AttentionFigures:
    """Figures of a game.

    Attributes:
        robots: figures of each robot.
        duration: duration of the game, s.
        person_waited: time for which no robot waited for the person, s.
        both: time for which at least one robot drove while another robot waited for the person, s.
    """

    robots: tuple[RobotAttention, ...]
    duration: float
    person_waited: float
    both: float


def figures_of(recording: GameRecording, decisions: Iterable[GameDecision], seat: str = "") -> AttentionFigures:
    """Return the figures of a game.

    Args:
        recording: recording of the game.
        decisions: decisions of the game. They show who sent the robots.
        seat: seat of the person, in a game with several seats; only their decisions and dialogues must be given.
    """
    by = {(each.robot, each.done): each.by for each in decisions if each.matter == "select-room"}
    robots = tuple(RobotAttention([RobotStand(robot, 0.0)]) for robot in range(recording.robots))
    argues = any(recording.moves)
    talks: set[int] = set()
    left: dict[int, float] = {}
    for each in recording.happenings:
        match each:
            case TimedUtterance(time, said):
                # Robots that do not argue open a dialogue to answer a request of the person.
                opens = not argues and said.dialogue not in talks
                talks.add(said.dialogue)
                if said.speaker == "human" or opens:
                    robots[said.robot].stands[-1].act(time)
            case TimedEvent(time, RobotDeparted(robot=robot)):
                stand = robots[robot].stands[-1]
                stand.by_person = by.get((robot, time)) == "person"
                if stand.by_person and stand.first_act is None:
                    stand.act(time)
                stand.departed, left[robot] = time, time
            case TimedEvent(time, RobotArrived(robot=robot) | MoveFailed(robot=robot)):
                figures = robots[robot]
                if robot in left:
                    figures.drives.append(time - left.pop(robot))
                figures.arrived += isinstance(each.event, RobotArrived)
                figures.failed += isinstance(each.event, MoveFailed)
                figures.stands.append(RobotStand(robot, time))
            case TimedEvent(time) if not seat or getattr(each.event, "seat", "") == seat:
                for robot in _acted_on(each):
                    robots[robot].stands[-1].act(time)
            case TimedEvent() | TimedMove():
                pass
    waited, both = _integrate(recording, robots, seat)
    return AttentionFigures(robots, recording.duration, waited, both)


def _acted_on(each: TimedEvent) -> Iterator[int]:
    """Yield the robot that the person acted on, if the event is an act of the person."""
    if isinstance(each.event, _OF_A_ROBOT) and each.event.robot is not None:
        yield each.event.robot
    elif isinstance(each.event, _OF_A_ROOM) and (robot := each.before.decider(each.event.room)) is not None:
        yield robot


def _integrate(recording: GameRecording, robots: Sequence[RobotAttention], seat: str) -> tuple[float, float]:
    """Add the driving times, waiting times and energies to the figures of robots.

    Return the time for which the person waited, and the time in which robots drove while another robot waited, s.
    """
    waited = both = 0.0
    events = [*recording.events]
    ends = [*(later.time for _, later in pairwise(events)), recording.duration]
    for each, end in zip(events, ends, strict=True):
        span = max(0.0, end - each.time)
        drives = [state.bound_for is not None for state in each.after.robots]
        waits = [waits_for_person(each.after, robot, seat) for robot in range(len(robots))]
        for robot, figures in enumerate(robots):
            figures.under_way += span * drives[robot]
            figures.waiting += span * waits[robot]
            figures.spent += each.before.robots[robot].energy - each.after.robots[robot].energy
        waited += span * (not any(waits))
        both += span * (any(waits) and any(drives))
    return waited, both


def waits_for_person(state: GameState, robot: int, seat: str = "") -> bool:
    """Return True if a robot waits for the person; see the module's description.

    In a game with several seats, a robot waits for the person of the seat that commands it.
    """
    here = state.robots[robot]
    if seat and here.command.name != seat:
        return False
    if state.ended or here.bound_for is not None or here.is_silent or here.command.by is not Commander.PARTICIPANT:
        return False
    if rules.affordable(state, robot):
        return True
    found = None if here.at.is_corridor else state.room(here.at)
    undecided = found is not None and found.sensed is not None and not found.is_decided
    return undecided and here.energy >= state.started.identify_cost


@dataclass(frozen=True, slots=True)
class _RobotSubject:
    """A robot in a trial."""

    run: Run
    attempt: Attempt
    robot: int
    figures: RobotAttention
    duration: float
    collisions: int


def robots(design: ExperimentDesign, trial: RecordedTrial, game: AttentionFigures) -> ExperimentTable:
    """Return the rows of a trial's robots."""
    table: TableOf[_RobotSubject] = TableOf(
        "robots",
        "a robot in a trial",
        (
            *attempt_columns(design),
            whole("robot", "number of the robot, from 1", lambda row: number_of(row.robot), least=1),
            count("rooms_reached", "number of rooms that the robot reached", lambda row: row.figures.arrived),
            count("moves_failed", "number of moves that did not reach their room", lambda row: row.figures.failed),
            count("collisions", "number of collisions with a wall or another robot", lambda row: row.collisions),
            number("energy_spent", "", "energy that the robot spent, game units", lambda row: row.figures.spent),
            seconds(
                "under_way_s",
                "time for which the robot drove: from each event departed to the next event arrived or failed, or to "
                "the end of the game",
                lambda row: row.figures.under_way,
            ),
            share(
                "idle",
                "share of the game in which the robot did not drive",
                lambda row: _over(row.duration - row.figures.under_way, row.duration),
            ),
            seconds(
                "waiting_s",
                "time for which the robot waited for the participant: it did not drive, sent messages, was under the "
                "participant's command, and could be sent to a room or was at an undecided treasure",
                lambda row: row.figures.waiting,
            ),
            count(
                "stands",
                "number of periods in which the robot stood, including the start of the game",
                lambda row: len(row.figures.stands),
            ),
            seconds(
                "attention_s",
                "mean time from the event started, arrived or failed to the person's first act on the robot (sentence, "
                "request for advice, picture, name, property, departure); periods without an act do not count",
                lambda row: _mean(row.figures.attention),
            ),
            seconds(
                "interaction_s",
                "mean time from the person's first act on the standing robot to the event departed; only departures by "
                "the person count",
                lambda row: _mean(row.figures.interaction),
            ),
            seconds(
                "neglect_s",
                "mean time for which the robot worked without the person: from departed to arrived or failed",
                lambda row: _mean(row.figures.drives),
            ),
        ),
    )
    return table.of(
        _RobotSubject(trial.run, trial.attempt, robot, figures, game.duration, trial.recording.collisions[robot])
        for robot, figures in enumerate(game.robots)
    )


@dataclass(frozen=True, slots=True)
class _FluencySubject:
    """The game of a trial."""

    run: Run
    attempt: Attempt
    game: AttentionFigures

    def all_of(self, name: str) -> list[float]:
        """Return the figures of all robots together."""
        return [value for robot in self.game.robots for value in getattr(robot, name)]

    @property
    def fan_out(self) -> float | None:
        """Neglect time divided by interaction time, plus one."""
        neglect, interaction = _mean(self.all_of("drives")), _mean(self.all_of("interaction"))
        return None if neglect is None or not interaction else neglect / interaction + 1.0


def fluency(design: ExperimentDesign, trial: RecordedTrial, game: AttentionFigures) -> ExperimentTable:
    """Return the row of a trial's fluency."""
    table: TableOf[_FluencySubject] = TableOf(
        "fluency",
        "a trial: waiting times of the person and the robots (Hoffman 2019)",
        (
            *attempt_columns(design),
            seconds(
                "game_s",
                "simulated time from the event started to the event ended, or to the end of the recording",
                lambda row: row.game.duration,
            ),
            share(
                "human_idle",
                "share of the game in which no robot waited for the person: each robot was driving, silent or under "
                "another command, or could not be sent to a room and was not at an undecided treasure",
                lambda row: _over(row.game.person_waited, row.game.duration),
            ),
            share(
                "robot_idle",
                "share of the game in which a robot did not drive (departed to arrived or failed), mean over all "
                "robots",
                lambda row: _mean(
                    [1.0 - each.under_way / row.game.duration for each in row.game.robots if row.game.duration]
                ),
            ),
            share(
                "concurrent_activity",
                "share of the game in which at least one robot drove while another robot waited for the person",
                lambda row: _over(row.game.both, row.game.duration),
            ),
            number(
                "functional_delay",
                "",
                "sum of delays divided by the duration of the game; delays: from the event started, arrived or failed "
                "to the person's first act on the robot, and from the last act to departed; only departures by the "
                "person count; may be above 1 for several robots",
                lambda row: _over(math.fsum(row.all_of("delays")), row.game.duration),
            ),
            seconds(
                "attention_s",
                "mean as in the table robots, but over all robots",
                lambda row: _mean(row.all_of("attention")),
            ),
            seconds(
                "interaction_s",
                "mean as in the table robots, but over all robots",
                lambda row: _mean(row.all_of("interaction")),
            ),
            seconds(
                "neglect_s", "mean as in the table robots, but over all robots", lambda row: _mean(row.all_of("drives"))
            ),
            number(
                "fan_out",
                "",
                "neglect_s divided by interaction_s, plus 1 (Olsen and Goodrich 2003); empty if there was no "
                "interaction",
                lambda row: row.fan_out,
                1,
            ),
        ),
    )
    return table.of([_FluencySubject(trial.run, trial.attempt, game)])


def _mean(values: Sequence[float]) -> float | None:
    return math.fsum(values) / len(values) if values else None


def _over(part: float, whole_of_it: float) -> float | None:
    return part / whole_of_it if whole_of_it > 0.0 else None
