"""Session: a hunt that the caller advances, observes and controls."""

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import count
from pathlib import Path
from typing import Self

import numpy as np

from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND, Twist
from sim.common.robot_numbers import number_of
from sim.inputs import CancelGoal, GlobalLocalization, KidnapRobot, KillRobot, PutThing, RemoveThing, ReviveRobot
from sim.robot.navigator.goals import GoalReached, GoalResult, NoPath
from sim.snapshot import TeamSnapshot
from thbridge.api.errors import HuntError, as_hunt_errors
from thbridge.api.participant import HuntParticipant, QueuePlayer, checked_index, whole
from thbridge.api.snapshot import HuntSnapshot, Ranges, snapshot_of
from thbridge.api.study import HuntStudy, Simulated, setting_of
from thbridge.api.view import HuntView
from thbridge.app.compose.game import build_participants
from thbridge.app.compose.recording import begin_recording, build_record, build_recorder
from thbridge.app.compose.robots import build_team
from thbridge.app.compose.session import NOT_RECORDED, SessionRecording, build_programs, open_session
from thbridge.app.compose.setting import StudySetting
from thbridge.app.play import PLAY, EndCondition
from thbridge.app.session.recording import TlogRecorder
from thbridge.app.session.session import Session, TickRecord, TickRecorder
from thbridge.app.session.watch_requests import WatchRequest, objection
from thbridge.files.plugins import PARTICIPANTS
from thbridge.hunt.codec import kind_of, to_json
from thbridge.hunt.events import Commander, JournalEntry
from thbridge.hunt.rooms import Room
from thbridge.hunt.seats import ONE_SEAT, PlayedBy
from thbridge.mavlink.files.tlog import TlogFile
from thbridge.recording.bag.recording_names import problem_of
from thbridge.recording.journal_folder import JournalStore
from thbridge.recording.recordings import journal_of, tlog_of
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.robot_requests import (
    CommandRequest,
    ParameterValue,
    ReleaseCommand,
    SetParameters,
    StationIdentify,
    StationLeave,
    StationSend,
    StationStop,
    StationTakePicture,
    TakeCommand,
)
from thbridge.roles.shared.seat_programs import program_of
from thbridge.roles.shared.view import ParticipantRequest
from thbridge.ros.messages.goal_owners import GoalOwner
from thbridge.ros.messages.records import InitialPose, SimpleGoal, VelocityCommand
from thbridge.study.things import Shape, ThingEntry

SENDER = "api"
"""Name of the caller in recordings."""

PROGRAM = "program"
"""Name of the participant in recordings when the caller plays."""

AN_HOUR = 3600.0


@dataclass(frozen=True, slots=True)
class HuntEvent:
    """Event of a session.

    Attributes:
        seconds: simulated time of the session.
        kind: kind of the event. Events of the game are "started", "hidden", "departed", "arrived", "failed", "sensed",
            "pictured", "identified", "left", "ended" and further kinds, as in recordings. In a game with several seats,
            "personsaid", "proposed", "voted", "settled" and "objected" are texts, votes and objections of participants,
            and `data` has the `seat` of the participant who caused an event. Other events are "said" (a sentence in a
            dialogue), "refused" (a refused request), and "goal" (the end of a robot's goal).
        robot: number of the robot, from 1; None if the event is not about a robot.
        room: number of the room, from 1; None if the event is not about a room.
        text: for "said", the sentence; for "refused", the reason; for "goal", "reached", "cancelled", or the reason for
            the failure; otherwise empty.
        data: other fields of the event, as in a recording.
    """

    seconds: float
    kind: str
    robot: int | None = None
    room: int | None = None
    text: str = ""
    data: Mapping[str, object] = field(default_factory=dict)


class HuntSession:
    """Hunt that the caller advances step by step, without windows, clocks or sockets.

    The same study and the same inputs always give the same hunt. Requests of the caller take effect in the next tick. A
    recording contains these requests, and `thbridge replay` can replay it.
    Close the session with `close`, or use it in a `with` statement.

    Args:
        study: the study.
        participant: name of a simulated participant, built-in or installed. If None, the caller plays.
        record: path of a recording: `NAME.bag` (ROS 1), `NAME.mcap` (ROS 2), or a name without ending (rosbag2
            folder); an existing recording is renamed first. If None, nothing is recorded.
        seats: names of the seats that the caller plays, in a study with several. Simulated participants play the
            others, with the strategy `participant` or, if this is None, with the study's strategies. If `seats` is
            None, the caller plays all seats, or none if `participant` is given.

    Raises:
        HuntError: the recording cannot be written to this path, or the study does not have one of the seats.

    Attributes:
        study: the study.
        events: events so far, oldest first.
        participant: requests of the participant, if the caller plays; in a study with several seats, of the first seat
            that the caller plays. See `seat` for the others.
    """

    def __init__(
        self,
        study: HuntStudy,
        participant: Simulated | None = None,
        record: str | Path | None = None,
        seats: Sequence[str] | None = None,
    ) -> None:
        setting = setting_of(study)
        if participant is not None:
            setting = with_strategy(setting, participant)
        self.study = study
        self.events: list[HuntEvent] = []
        self._setting = setting
        self._goals = count()
        played = _played_seats(setting, seats, is_simulated=participant is not None)
        self._queues = {seat: QueuePlayer() for seat in played}
        places = [each.name for each in setting.study.seats] or [ONE_SEAT.name]
        with as_hunt_errors():
            others = () if {*played} == {*places} else build_participants(setting, participant)
        simulated = {each.name: each for each in others}
        self._programs = {
            seat: (
                TabUI(self._queues[seat], seat=seat, by=PlayedBy.PROGRAM)
                if seat in played
                else simulated[program_of(seat)]
            )
            for seat in places
        }
        self._first = next(iter(played), places[0])
        self.participant = self.seat(self._first)
        self._ending = EndCondition(math.inf)
        self._finished = False
        self._scans: list[Ranges] = [np.full(setting.study.world.laser.beams, np.nan, np.float32)] * study.robots
        self._last: TeamSnapshot | None = None
        self._open = ExitStack()
        self._closed = False
        self._team = build_team(setting)
        programs = build_programs(setting, tuple(self._programs.values()), team=self._team)
        recording = NOT_RECORDED
        if record is not None:
            recording = self._recording(Path(record), programs.names, PROGRAM if played else participant or "")
        self._session = open_session(setting, programs, recording)

    def _recording(self, bag: Path, roles: Sequence[str], participant: str) -> SessionRecording:
        setting = self._setting
        if (problem := problem_of(bag, setting.study.recording.compression)) is not None:
            raise HuntError(f"record: {problem}", bag)
        # If a later step fails, the files opened so far are closed.
        with as_hunt_errors(), ExitStack() as opened:
            writer = opened.enter_context(begin_recording(setting, bag))
            log = opened.enter_context(closing(JournalStore(journal_of(bag))))
            opening = build_record(setting, PLAY, roles, participant)
            recorders: list[TickRecorder] = [build_recorder(setting, opening, [writer])]
            if setting.study.mavlink.on and setting.study.mavlink.tlog:
                recorders.append(TlogRecorder(opened.enter_context(TlogFile(tlog_of(bag)))))
            self._open = opened.pop_all()
        return SessionRecording(recorders, log)

    # Time

    def step(self, ticks: int = 1) -> HuntSnapshot:
        """Run a number of ticks of 20 ms, and return the state after the last tick.

        Raises:
            HuntError: the session is closed, or the recording cannot be written.
        """
        if ticks < 1:
            raise HuntError(f"ticks: {ticks} is below 1. Give at least 1.")
        for _ in range(ticks):
            self._step()
        return self.snapshot

    def run(self, seconds: float) -> HuntSnapshot:
        """Run for some seconds of simulated time, and return the state at the end. Raises the same errors as `step`."""
        return self.step(max(round(seconds * TICKS_PER_SECOND), 1))

    def run_until(self, condition: "str | Callable[[HuntSession], bool]", at_most: float = AN_HOUR) -> bool:
        """Run for at least one tick, until a condition is true.

        Args:
            condition: "ready" (a robot waits for a decision), the kind of an event, such as "arrived", or a function
                that has the session as argument.
            at_most: largest duration in simulated seconds.

        Returns:
            True if the condition became true, False if the game or the time ended first.

        Raises:
            HuntError: for the same reasons as `step`.
        """
        last = self._session.tick + max(round(at_most * TICKS_PER_SECOND), 1)
        while True:
            seen = len(self.events)
            self._step()
            if callable(condition):
                happened = condition(self)
            elif condition == "ready":
                happened = bool(self.ready)
            else:
                happened = any(event.kind == condition for event in self.events[seen:])
            if happened:
                return True
            if self._session.tick >= last or self.over:
                return False

    def play(self, at_most: float = AN_HOUR) -> bool:
        """Run until half a second after the end of the game, as `thbridge play` does; return True if the game is over.

        Args:
            at_most: limit in simulated seconds.

        Raises:
            HuntError: for the same reasons as `step`.
        """
        last = self._session.tick + max(round(at_most * TICKS_PER_SECOND), 1)
        while not self._finished and self._session.tick < last:
            self._step()
        return self.over

    def _step(self) -> None:
        if self._closed:
            raise HuntError("the session is closed. Start a new session.")
        with as_hunt_errors():
            record = self._session.step()
        snapshot = record.snapshot
        assert snapshot is not None  # noqa: S101  # the robots are in this session
        self._last = snapshot
        self._finished = self._ending.reached(self._session)
        # All other outputs have neither a scan nor a result.
        for robot, output in snapshot.renewed.items():
            if (scan := output.observations.scan) is not None:
                self._scans[robot] = scan.ranges
            if (result := output.navigation.result) is not None:
                self.events.append(HuntEvent(self.seconds, "goal", number_of(robot), text=_end_of_goal(result)))
        if record.events or record.team or record.utterances or record.refusals:
            self.events += _events_in(record, self.seconds)

    # State

    @property
    def tick(self) -> int:
        """Number of ticks so far."""
        return self._session.tick

    @property
    def seconds(self) -> float:
        """Simulated seconds so far."""
        return self._session.tick / TICKS_PER_SECOND

    @property
    def over(self) -> bool:
        """True if the game has ended."""
        game = self._session.game
        return game is not None and game.ended is not None

    @property
    def ready(self) -> tuple[int, ...]:
        """Numbers of the robots that are at rest and could drive to a room."""
        game = self._session.game
        if game is None or game.treasures is None or game.ended is not None:
            return ()
        return tuple(
            number_of(robot)
            for robot, state in enumerate(game.robots)
            if state.bound_for is None and not state.is_blocked and not state.is_silent
        )

    @property
    def snapshot(self) -> HuntSnapshot:
        """State after the last tick. Raises HuntError: no tick has been run yet."""
        if self._last is None:
            raise HuntError("the session has no state before its first tick. Call `step` first.")
        return snapshot_of(self._last, self._session.game, tuple(self._scans))

    @property
    def view(self) -> HuntView | None:
        """Part of the state that the participant may know; None in the first ticks, before the game sends a view.

        In a study with several seats, this is the view of `participant`.
        """
        return self.participant.view

    def seat(self, name: str) -> HuntParticipant:
        """Return the requests and the view of the participant of a seat. A simulated participant has only a view.

        Raises:
            HuntError: the study has no such seat.
        """
        program = self._programs.get(name)
        if program is None:
            raise _no_seat(self._setting, name)
        return HuntParticipant(partial(self._say, name), lambda: program.view, self.study.robots, name)

    # Requests to the game: the rules apply, but no dialogue is needed

    def send(self, robot: int, room: int) -> None:
        """Send a robot to a room as a ground station does: the caller takes command of the robot, without a dialogue.

        A request that the rules refuse (room already visited, too little energy) has no effect and causes no event.
        """
        number = whole("room", room)
        self._commanded(robot, lambda index: StationSend(index, number))

    def stop(self, robot: int) -> None:
        """Stop a robot that is driving to a room."""
        self._session.ask(SENDER, StationStop(self._index(robot)))

    def take_picture(self, robot: int) -> None:
        """Take a picture of the treasure in the room where a robot is."""
        self._commanded(robot, StationTakePicture)

    def name_treasure(self, robot: int, name: str) -> None:
        """Name the treasure in the room where a robot is."""
        self._commanded(robot, lambda index: StationIdentify(index, name))

    def leave_treasure(self, robot: int) -> None:
        """Leave the treasure in the room where a robot is undecided."""
        self._commanded(robot, StationLeave)

    def hand_back(self, robot: int) -> None:
        """Give the command of a robot back to the participant."""
        self._session.ask(SENDER, ReleaseCommand(self._index(robot)))

    def _commanded(self, robot: int, request: Callable[[int], CommandRequest]) -> None:
        index, game = self._index(robot), self._session.game
        if game is None or game.robots[index].holder.by is not Commander.GROUND_STATION:
            self._session.ask(SENDER, TakeCommand(index, SENDER))
        self._session.ask(SENDER, request(index))

    # Requests to robots

    def set_goal(self, robot: int, x: float, y: float, theta: float = 0.0) -> None:
        """Set a goal of move_base outside the game (meters, radians, map frame). Its end is an event "goal".

        Raises:
            HuntError: the robot does not exist, or the request is refused. The same applies to the methods below.
        """
        goal = SimpleGoal(self._index(robot), _pose(x, y, theta), next(self._goals), owner=GoalOwner.RESEARCHER)
        self._ask(goal)

    def cancel_goal(self, robot: int) -> None:
        """Cancel a robot's goal."""
        self._ask(CancelGoal(self._index(robot)))

    def drive(self, robot: int, linear: float, angular: float) -> None:
        """Drive a robot (m/s, rad/s) for half a second, or until the next `drive` (ROS: cmd_vel)."""
        self._ask(VelocityCommand(self._index(robot), Twist(float(linear), float(angular))))

    def set_pose(
        self, robot: int, x: float, y: float, theta: float, covariance: Sequence[Sequence[float]] | None = None
    ) -> None:
        """Send a pose to a robot's localizer (ROS: initialpose); `covariance` is (3, 3), by default as in rviz."""
        rows = np.diag([0.25, 0.25, 0.06853891909122467]) if covariance is None else np.array(covariance, np.float64)
        self._ask(InitialPose(self._index(robot), _pose(x, y, theta), rows))

    def forget_pose(self, robot: int) -> None:
        """Make a robot forget its pose, so that it localizes globally (ROS: global_localization)."""
        self._ask(GlobalLocalization(self._index(robot)))

    def carry(self, robot: int, x: float, y: float, theta: float) -> None:
        """Move a robot to another pose without informing its software."""
        self._ask(KidnapRobot(self._index(robot), _pose(x, y, theta)))

    def kill(self, robot: int) -> None:
        """Stop a robot's software: the robot stands still and sends nothing."""
        self._ask(KillRobot(self._index(robot)))

    def revive(self, robot: int) -> None:
        """Restart the software of a dead robot."""
        self._ask(ReviveRobot(self._index(robot)))

    def put_thing(self, name: str, shape: str, x: float, y: float, yaw: float = 0.0) -> None:
        """Place a "crate", "door", "fire" or "person" as soon as the place is free.

        A thing of the same name is replaced.
        """
        if shape not in set(Shape) - {Shape.POLYGON}:
            raise HuntError(f"shape: unknown shape {shape}. Write crate, door, fire or person.", key="shape")
        self._ask(PutThing(ThingEntry(name, Shape(shape), (float(x), float(y), float(yaw))).thing()))

    def remove_thing(self, name: str) -> None:
        """Remove a thing."""
        self._ask(RemoveThing(name))

    def set_parameters(self, robot: int, values: Mapping[str, ParameterValue]) -> None:
        """Change parameters of a running robot, such as `{"amcl.kld_err": 0.05}`.

        Parameters in `world.` change the simulated world instead of the robot's software.
        """
        given = ((key, value.item() if isinstance(value, np.generic) else value) for key, value in values.items())
        self._ask(SetParameters(self._index(robot), tuple(given)))

    def _ask(self, request: WatchRequest) -> None:
        if not all(map(math.isfinite, _numbers(request))):
            raise HuntError(f"{_numbers(request)}: all numbers must be finite. Replace NaN and infinity.")
        reason = objection(request, self._team)
        if reason is not None:
            raise HuntError(f"{reason}. Nothing was changed.")
        self._session.ask(SENDER, request)

    def _say(self, seat: str, request: ParticipantRequest) -> None:
        queue = self._queues.get(seat)
        if queue is None:
            problem = f"a simulated participant plays {seat}".rstrip()
            remedy = f"Add {seat!r} to `seats`" if seat else "Start the session without `participant`"
            raise HuntError(f"{problem}. {remedy} to play yourself.", key="seats" if seat else "participant")
        queue.put(request)
        self._programs[seat].poll_player()

    def _index(self, robot: int) -> int:
        return checked_index(robot, self.study.robots)

    # The end

    def close(self) -> None:
        """End the session, and complete its recording.

        Raises:
            HuntError: the recording cannot be written.
        """
        self._closed = True
        with as_hunt_errors():
            self._open.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        state = "closed" if self._closed else "over" if self.over else "open"
        return f"<HuntSession {state}, {self.seconds:.2f} s of {self.study!r}>"


def _played_seats(setting: StudySetting, wanted: Sequence[str] | None, *, is_simulated: bool) -> Sequence[str]:
    """Return the seats that the caller plays; see `HuntSession`. Raises HuntError: there is no such seat."""
    names = [each.name for each in setting.study.seats]
    if wanted is None:
        return () if is_simulated else names or (ONE_SEAT.name,)
    for name in wanted:
        if name not in names:
            raise _no_seat(setting, name)
    return wanted


def _no_seat(setting: StudySetting, name: str) -> HuntError:
    names = ", ".join(each.name for each in setting.study.seats)
    remedy = f"Write one of these: {names}" if names else "Omit the argument"
    return HuntError(f"seats: the study has no seat {name!r}. {remedy}.", key="seats")


def noted(seconds: float, event: JournalEntry) -> HuntEvent:
    """Return an event of the game as a `HuntEvent`."""
    data: dict[str, object] = json.loads(to_json(event))
    for key in ("v", "event", "robot", "room"):
        data.pop(key, None)
    robot: int | None = getattr(event, "robot", None)
    room: Room | None = getattr(event, "room", None)
    return HuntEvent(
        seconds,
        kind_of(type(event)),
        None if robot is None else number_of(robot),
        None if room is None else room.people,
        data=data,
    )


def _events_in(record: TickRecord, seconds: float) -> Iterator[HuntEvent]:
    """Yield the events of a tick: events of the game and of its participants, sentences, and refused requests."""
    for event in (*record.events, *record.team):
        yield noted(seconds, event)
    for said in record.utterances:
        topic, data = said.topic, {"speaker": said.speaker.name.lower(), "dialogue": said.dialogue}
        if said.seat:
            data["seat"] = said.seat
        yield HuntEvent(seconds, "said", number_of(topic.robot), topic.room.people, said.text, data)
    for refusal in record.refusals:
        yield HuntEvent(seconds, "refused", text=refusal.refused.sentence)


def _end_of_goal(result: GoalResult) -> str:
    match result:
        case GoalReached():
            return "reached"
        case NoPath(sentence=sentence):
            return sentence
        case _:
            return "cancelled"


def inside(session: HuntSession) -> Session:
    """Return the internal session of a `HuntSession`."""
    return session._session


def with_strategy(setting: StudySetting, strategy: str) -> StudySetting:
    """Return a setting whose simulated participant uses a strategy.

    Raises:
        HuntError: there is no strategy of this name.
    """
    if strategy not in set(BotStrategy) and strategy not in PARTICIPANTS.names():
        problem = f"participant: no strategy is called {strategy!r}"
        known = ", ".join((*BotStrategy, *PARTICIPANTS.names()))
        raise HuntError(f"{problem}. Write {known}, or None.", key="participant")
    participant = replace(setting.study.participant, strategy=strategy)
    return replace(setting, study=replace(setting.study, participant=participant))


def _pose(x: float, y: float, theta: float) -> Pose2:
    """Return a pose from numbers of any type, including types of NumPy."""
    return Pose2(float(x), float(y), float(theta))


def _numbers(request: WatchRequest) -> tuple[float, ...]:
    """Return the numbers of a request that must be finite."""
    match request:
        case (
            SimpleGoal(_, Pose2(x, y, theta)) | InitialPose(_, Pose2(x, y, theta)) | KidnapRobot(_, Pose2(x, y, theta))
        ):
            return x, y, theta
        case VelocityCommand(_, twist):
            return twist.linear, twist.angular
        case PutThing(thing):
            return thing.base_in_map.x, thing.base_in_map.y, thing.base_in_map.theta
    return ()
