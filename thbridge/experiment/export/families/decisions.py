"""The table `decisions`: robots' advice, the person's choices, decision times and appropriate reliance."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from sim.common.robot_numbers import number_of
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.export.families.attempts import Attempt, attempt_columns
from thbridge.experiment.export.families.described import (
    ExperimentTable,
    TableOf,
    count,
    flag,
    seconds,
    share,
    text,
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
    GameStarted,
    MoveFailed,
    RobotArrived,
    RobotDeparted,
    RoomAdvised,
    TreasureIdentified,
    TreasureLeft,
    TreasurePictured,
)
from thbridge.hunt.game import GameState
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.team_planner import TeamPlanner
from thbridge.hunt.treasures import same_name
from thbridge.roles.keeper.advice.adviser import Adviser
from thbridge.roles.shared.participant_rules import Discussed
from thbridge.ros.messages.session_records import DialogueMoveRecord
from thbridge.timing.pace_meter import TOLERANCE

_NEXT = re.compile(r"next\(Robot\d+, Room(\d+)\)")
_TREASURE = re.compile(r"treasure_in\((.*), Room\d+\)")


@dataclass(frozen=True, slots=True)
class GameDecision:
    """A decision in a game.

    Attributes:
        robot: index of the robot in the team.
        matter: "select-room", "take-picture" or "take-treasure".
        by: decision maker: "person", "robot" (alone), "ground station" or "researcher".
        shown: time since the start of the game at which the options appeared, s.
        chosen: time of the choice, s.
        done: time at which the choice was carried out, s.
        options: possible choices at that time; empty except for select-room.
        choice: the chosen room, the given name, "picture", or "left".
        advice: the room or name that the robot advised; empty if there was no advice.
        advised: time of the advice, s, or None.
        advice_from: "asked" (an event advised), or "argued" (the robot asserted the advice); empty without advice.
        confidence: stated confidence in the advice, or None.
        is_right: True if the advice was right, None if this is unknown.
        first_choice: the person's proposal before the robot gave its opinion; may be empty.
        refused: True if the robot rejected or denied the person's proposal.
        dialogues: number of dialogues about the decision.
        points: points for a name.
        seat: seat of the decision maker; empty in games with one participant.
    """

    robot: int
    matter: str
    by: str
    shown: float
    chosen: float
    done: float
    options: tuple[str, ...]
    choice: str
    advice: str = ""
    advised: float | None = None
    advice_from: str = ""
    confidence: float | None = None
    is_right: bool | None = None
    first_choice: str = ""
    refused: bool = False
    dialogues: int = 0
    points: int | None = None
    seat: str = ""

    @property
    def agreed(self) -> bool | None:
        """True if the choice is equal to the advice. None if there was no advice, or if the person did not decide."""
        return self.choice == self.advice if self.advice and self.by == "person" else None

    @property
    def is_appropriate(self) -> bool | None:
        """True if the person took right advice or did not take wrong advice. None if this is unknown."""
        return None if self.agreed is None or self.is_right is None else self.agreed == self.is_right

    @property
    def disagreed(self) -> bool | None:
        """True if the robot rejected the first choice or advised another choice. None if there was no first choice."""
        return (self.refused or self.advice not in {"", self.first_choice}) if self.first_choice else None

    @property
    def switched(self) -> bool | None:
        """True if the person gave up the first choice after the robot disagreed. None if the robot did not disagree."""
        return self.choice != self.first_choice if self.disagreed and self.by == "person" else None


@dataclass(slots=True)
class _Matter:
    """An open decision about a robot, with the relevant sentences and acts."""

    shown: float
    advice: str = ""
    advised: float | None = None
    advice_from: str = ""
    confidence: float | None = None
    is_right: bool | None = None
    first_choice: str = ""
    talks: set[int] = field(default_factory=set)
    spoke: float | None = None
    alone: bool = False
    refused: bool = False
    refused_last: str = ""

    def argued(self, time: float, advice: str, *, is_right: bool | None) -> None:
        """Record that the robot asserted a choice. Advice at the person's request has priority."""
        if self.advice_from != "asked":
            self.advice, self.advised, self.advice_from, self.is_right = advice, time, "argued", is_right


@dataclass(slots=True)
class _Opening:
    """State at the start of a dialogue, for the planner of the robot."""

    state: GameState
    discussed: tuple[Discussed, ...]

    def planned(self, planner: TeamPlanner, robot: int) -> str | None:
        """Return the room number that a robot without errors would suggest, or None."""
        advice = Adviser(planner).advise(self.state, self.discussed, robot)
        return None if isinstance(advice, RequestRefused) else str(advice.planned.people)


def decisions_of(recording: GameRecording, planner: TeamPlanner = TeamPlanner.JOINT) -> Iterator[GameDecision]:
    """Yield all decisions of a game that were carried out, in order.

    Args:
        recording: recording of the game.
        planner: the robots' planner. A robot's argument for a room is right if the planner suggested this room at the
            start of the dialogue.
    """
    open_: dict[tuple[int, str], _Matter] = {}
    openings: dict[int, _Opening] = {}
    subjects: dict[int, Discussed] = {}
    argues, seats = any(recording.moves), recording.seats
    advised_at: dict[int, float] = {}
    now: TimedEvent | None = None

    def of(robot: int, matter: str, time: float) -> _Matter:
        return open_.setdefault((robot, matter), _Matter(time))

    def made(each: TimedEvent, robot: int, matter: str, choice: str, points: int | None = None) -> GameDecision:
        about = open_.pop((robot, matter), _Matter(each.time))
        command = each.before.robots[robot].command.by
        # If the robot's last sentence rejected a room, the robot drives to the room of its own choice.
        is_alone = about.alone or about.refused_last not in {"", choice}
        by = "robot" if is_alone else "person" if command is Commander.PARTICIPANT else str(command)
        rooms = rules.affordable(each.before, robot) if matter == "select-room" else ()
        chosen = about.spoke if about.spoke is not None and by == "person" else each.time
        return GameDecision(
            robot=robot,
            matter=matter,
            by=by,
            shown=about.shown,
            chosen=chosen,
            done=each.time,
            options=tuple(str(room.people) for room in rooms),
            choice=choice,
            advice=about.advice,
            advised=about.advised,
            advice_from=about.advice_from,
            confidence=about.confidence,
            is_right=about.is_right,
            first_choice=about.first_choice,
            refused=about.refused,
            dialogues=len(about.talks),
            points=points,
            seat=str(getattr(each.event, "seat", "")) or each.before.robots[robot].command.name * bool(seats),
        )

    def begin_talk(talk: int, robot: int) -> None:
        if now is not None and talk not in openings:
            others = tuple(about for about in subjects.values() if about.robot != robot)
            openings[talk] = _Opening(now.after, others)

    def is_planned(talk: int, robot: int, room: str) -> bool | None:
        planned = openings[talk].planned(planner, robot) if talk in openings else None
        return None if planned is None else planned == room

    for each in recording.happenings:
        match each:
            case TimedEvent(time, event):
                now = each
                match event:
                    case GameStarted(robots=robots):
                        for robot in range(robots):
                            of(robot, "select-room", time)
                    case RobotArrived(robot=robot):
                        open_[robot, "take-picture"] = _Matter(time)
                        open_[robot, "take-treasure"] = _Matter(time)
                        open_[robot, "select-room"] = _Matter(time)
                    case MoveFailed(robot=robot):
                        open_[robot, "select-room"] = _Matter(time)
                    case RoomAdvised(robot, room, _, planned, _, confidence):
                        about = of(robot, "select-room", time)
                        about.advice, about.advised, about.advice_from = str(room.people), time, "asked"
                        about.confidence, about.is_right = confidence, room == planned
                        advised_at[robot] = time
                        subjects[robot] = Discussed(robot, "select-room", room.people)
                    case RobotDeparted(robot, room):
                        subjects.pop(robot, None)
                        yield made(each, robot, "select-room", str(room.people))
                    case TreasurePictured(robot=robot, cost=cost) if cost > 0.0:
                        yield made(each, robot, "take-picture", "picture")
                    case TreasureIdentified(robot=int() as robot, name=str() as name, points=points):
                        yield made(each, robot, "take-treasure", name, points)
                        _come_up(open_, robot, time)
                    case TreasureLeft(room) if (decider := each.before.decider(room)) is not None:
                        yield made(each, decider, "take-treasure", "left")
                        _come_up(open_, decider, time)
            case TimedUtterance(time, said):
                begin_talk(said.dialogue, said.robot)
                if said.room is not None and said.scenario == "select-room":
                    subjects[said.robot] = Discussed(said.robot, "select-room", said.room)
                about = of(said.robot, said.scenario, time)
                about.alone |= said.move == "decide-alone"
                opens = said.dialogue not in about.talks
                about.talks.add(said.dialogue)
                if said.speaker == "human":
                    about.spoke, about.refused_last = time, ""
                elif said.move == "reject" and said.scenario == "select-room":
                    about.refused_last = str(said.room)
                # Robots that do not argue ask about the person's chosen room, or suggest a room.
                proposed = opens and not argues and said.scenario == "select-room" and said.room is not None
                if proposed and advised_at.get(said.robot) != time and not about.first_choice and not about.advice:
                    about.first_choice = str(said.room)
            case TimedMove(time, move) if move.speaker == "robot" and _denied(move):
                about = of(move.robot, "select-room" if _NEXT.search(move.content) else "take-treasure", time)
                about.refused = True
            case TimedMove(time, move) if move.locution == "assert" and not move.is_booked:
                begin_talk(move.talk, move.robot)
                if goes := _NEXT.fullmatch(move.content):
                    subjects[move.robot] = Discussed(move.robot, "select-room", int(goes[1]))
                    about = of(move.robot, "select-room", time)
                    if move.speaker == "robot":
                        about.argued(time, goes[1], is_right=is_planned(move.talk, move.robot, goes[1]))
                    elif not about.first_choice and not about.advice:
                        about.first_choice = goes[1]
                elif named := _TREASURE.fullmatch(move.content):
                    about = of(move.robot, "take-treasure", time)
                    if move.speaker == "robot":
                        about.argued(time, named[1], is_right=_is_treasure(now, move.robot, named[1]))
                    elif not about.first_choice and not about.advice:
                        about.first_choice = named[1]


def _denied(move: DialogueMoveRecord) -> bool:
    """Return True if a dialogue move is against a room or a name."""
    if move.locution == "assert" and move.content.startswith("not "):
        return bool(_NEXT.fullmatch(move.content[4:]) or _TREASURE.fullmatch(move.content[4:]))
    return move.locution == "reject" and bool(_NEXT.fullmatch(move.content) or _TREASURE.fullmatch(move.content))


def _come_up(open_: dict[tuple[int, str], _Matter], robot: int, time: float) -> None:
    """Open the decision on the next room after a decision on the treasure. If it was already discussed, do nothing."""
    about = open_.get((robot, "select-room"))
    if about is not None and not about.talks and not about.advice:
        open_[robot, "select-room"] = _Matter(time)


def _is_treasure(now: TimedEvent | None, robot: int, name: str) -> bool | None:
    if now is None or now.after.treasures is None or now.after.robots[robot].at.is_corridor:
        return None
    treasure = now.after.treasure(now.after.robots[robot].at)
    return None if treasure is None else same_name(treasure.name, name)


@dataclass(frozen=True, slots=True)
class _Numbered:
    """A decision in a trial, with its number."""

    trial: RecordedTrial
    number: int
    made: GameDecision

    @property
    def run(self) -> Run:
        """The person's run."""
        return self.trial.run

    @property
    def attempt(self) -> Attempt:
        """The attempt at the trial."""
        return self.trial.attempt


def decisions(design: ExperimentDesign, trial: RecordedTrial, made: Sequence[GameDecision]) -> ExperimentTable:
    """Return the rows of a trial's decisions."""
    table: TableOf[_Numbered] = TableOf(
        "decisions",
        "a decision that was carried out in a trial",
        (
            *attempt_columns(design),
            whole("decision", "number of the decision in the trial, from 1", lambda row: row.number, least=1),
            whole(
                "robot", "number of the robot in this decision, from 1", lambda row: number_of(row.made.robot), least=1
            ),
            text(
                "matter",
                "kind of the decision: select-room, take-picture or take-treasure",
                lambda row: row.made.matter,
            ),
            text(
                "decided_by",
                "decision maker: person, robot (alone), ground station or researcher",
                lambda row: row.made.by,
            ),
            text(
                "options",
                "for select-room: numbers of the rooms to which the robot could be sent at that time",
                lambda row: "; ".join(row.made.options) or None,
            ),
            text(
                "advice",
                "room or name that the robot advised; empty if there was no advice",
                lambda row: row.made.advice or None,
            ),
            text(
                "advice_from",
                "source of the advice; asked: the person asked or the robot offered it (event advised); argued: the "
                "robot asserted it in a dialogue game",
                lambda row: row.made.advice_from or None,
            ),
            share("confidence", "confidence that the robot stated for the advice", lambda row: row.made.confidence),
            flag(
                "advice_right",
                "true if the advised room is the planner's room (for argued: computed from the recorded game at the "
                "start of the dialogue), or the advised name is the treasure's name; empty if this was not recorded",
                lambda row: row.made.is_right,
            ),
            text(
                "first_choice",
                "the person's proposal before the robot gave advice",
                lambda row: row.made.first_choice or None,
            ),
            flag(
                "disagreed",
                "true if the robot rejected or denied the first choice or advised another choice; empty without a "
                "first "
                "choice",
                lambda row: row.made.disagreed,
            ),
            text(
                "choice",
                "chosen room, given name, picture, or left (the person gave up the treasure)",
                lambda row: row.made.choice,
            ),
            seconds(
                "shown_s",
                "simulated time since the start of the game at which the decision became possible; for a room: event "
                "started, arrived or failed, or end of the decision on the treasure in the robot's room; for a "
                "treasure: event arrived",
                lambda row: row.made.shown,
            ),
            seconds(
                "decision_s",
                "simulated time from shown_s to the choice; time of the choice: the person's last sentence about the "
                "decision, or the act if the person said nothing",
                lambda row: row.made.chosen - row.made.shown,
            ),
            seconds(
                "after_advice_s",
                "simulated time from the latest advice to the choice",
                lambda row: None if row.made.advised is None else max(0.0, row.made.chosen - row.made.advised),
            ),
            seconds(
                "shown_wall_s",
                f"shown_s in real time, accurate to {TOLERANCE:g} s, without the time between a crash and the resume "
                "of "
                f"the game; empty for rehearsals and for games of earlier releases",
                lambda row: row.trial.wall(0.0, row.made.shown),
            ),
            seconds(
                "decision_wall_s",
                "decision_s in real time; accuracy and empty values as for shown_wall_s",
                lambda row: row.trial.wall(row.made.shown, row.made.chosen),
            ),
            seconds(
                "after_advice_wall_s",
                "after_advice_s in real time; accuracy and empty values as for shown_wall_s",
                lambda row: None if row.made.advised is None else row.trial.wall(row.made.advised, row.made.chosen),
            ),
            flag(
                "agreed",
                "true if the person's choice was the advice; empty without advice",
                lambda row: row.made.agreed,
            ),
            flag(
                "appropriate",
                "appropriate reliance: true if the person took right advice or refused wrong advice",
                lambda row: row.made.is_appropriate,
            ),
            flag(
                "switched",
                "true if the person gave up the first choice after the robot disagreed; empty if the robot did not "
                "disagree",
                lambda row: row.made.switched,
            ),
            count("dialogues", "number of dialogues about the decision", lambda row: row.made.dialogues),
            whole("points", "points for the given name", lambda row: row.made.points),
        ),
    )
    return table.of(_Numbered(trial, number, each) for number, each in enumerate(made, start=1))
