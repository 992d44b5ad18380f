"""Requests of watchers (researchers' windows) to the robots and about the session's pace."""

import json
import logging
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from itertools import count
from typing import TypeAlias, get_args

from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND
from sim.inputs import (
    CancelGoal,
    ClearCostmaps,
    GlobalLocalization,
    KidnapRobot,
    KillRobot,
    NomotionUpdate,
    PlaceRobot,
    PutThing,
    RemoveThing,
    ReviveRobot,
    SendGoal,
    SetPoseEstimate,
)
from sim.parameters.reconfiguration import ParameterRejection
from thbridge.app.session.input_records import decode_request, decode_value, encode_request
from thbridge.roles.shared.robot_requests import (
    PACE_REQUESTS,
    PaceRequest,
    Pause,
    Request,
    Resume,
    SetParameters,
    SetRate,
    Step,
    Tuning,
    WizardAdvice,
    WizardMode,
    WizardMove,
    WizardRequest,
)
from thbridge.roles.simr.team import RobotTeam
from thbridge.ros.clients import FARTHEST, is_covariance
from thbridge.ros.messages.goal_owners import GoalOwner
from thbridge.ros.messages.records import CancelRequest, InitialPose, SimpleGoal, VelocityCommand
from thbridge.ros.topics import RosMessage
from thbridge.study.things import fault_of_thing
from thbridge.timing.pacer import Pacer
from thbridge.watching.sockets.server import SessionPace

MOST_PENDING = 200
"""Largest number of requests between two ticks; more than a person makes during a pause."""

MOST_CHARACTERS = 500
"""Largest number of characters of a name, or of a sentence in a robot's place."""

WATCH_SENDER = "watch"
"""Sender of the requests that the session makes when the last watcher has left."""

SLOWEST, FASTEST = 0.01, 1000.0
"""Range of rates that can be requested, in addition to 0."""

MOST_STEPS = 600 * TICKS_PER_SECOND

WatchRequest: TypeAlias = (
    SendGoal
    | CancelGoal
    | SimpleGoal
    | CancelRequest
    | VelocityCommand
    | InitialPose
    | SetPoseEstimate
    | GlobalLocalization
    | NomotionUpdate
    | ClearCostmaps
    | SetParameters
    | PutThing
    | RemoveThing
    | KidnapRobot
    | PlaceRobot
    | KillRobot
    | ReviveRobot
    | WizardMode
    | WizardMove
    | WizardAdvice
)
"""Requests that watchers may send. The other requests belong to the game, or have another form here."""

_GRANTED: tuple[type[WatchRequest], ...] = get_args(WatchRequest)

_log = logging.getLogger(__name__)


def request_line(sender: str, request: Request | PaceRequest) -> bytes:
    """Return the line of a watcher's request."""
    return encode_request(sender, request).encode() + b"\n"


class WatchRequestHandler:
    """Handler that grants or refuses requests of watchers.

    Args:
        ask: called with granted requests and the names of their senders.
        robots: the team.
        pacer: pacer of the session.
        granted: called with the name of a key and the granted request; None for no callback.
        has_game: True when the game is in this session, so that a watcher can speak in a robot's place.
    """

    def __init__(
        self,
        ask: Callable[[str, Request], None],
        robots: RobotTeam,
        pacer: Pacer,
        granted: Callable[[str, str], None] | None = None,
        *,
        has_game: bool,
    ) -> None:
        self._ask = ask
        self._note_granted = granted
        self._robots = robots
        self._pacer = pacer
        self._has_game = has_game
        self._puppets: set[int] = set()
        self._goals = count()
        self._waiting = 0

    def take(self, tick: int, messages: Iterable[RosMessage]) -> None:
        """Note a tick: the session has processed the pending requests."""
        self._waiting = 0

    def pace(self) -> SessionPace:
        """Return the pace of the session."""
        return SessionPace(self._pacer.paused, self._pacer.rate, self._pacer.lag)

    def unwatched(self) -> None:
        """End pause and wizard mode after the last watcher has left, so that session and robots do not wait for one."""
        self._pacer.resume()
        for robot in sorted(self._puppets):
            self._ask(WATCH_SENDER, WizardMode(robot, on=False))
        self._puppets.clear()

    def ask(self, watcher: str, request: Mapping[str, object], key: str = "") -> str | None:
        """Grant a request in JSON; return None, or the reason for a refusal.

        Args:
            watcher: name of the connection; a request without a key may name another sender.
            request: as `request_line` writes it.
            key: name of the watcher's key; empty if it has none.
        """
        said = {**request, "sender": watcher} if key else {"sender": watcher, **request}
        reason = self._ask_for(said)
        if reason is None and key and self._note_granted is not None:
            fields = json.dumps(said.get("fields", {}))
            self._note_granted(key, f"{said.get('request')} {fields[:MOST_CHARACTERS]}")
        return reason

    def _ask_for(self, request: Mapping[str, object]) -> str | None:
        name = request.get("request")
        kind = PACE_REQUESTS.get(name) if isinstance(name, str) else None
        try:
            if kind is not None:
                return self._turn(decode_value(request.get("fields", {}), kind))
            if _lies_far(request.get("fields")):
                return "the place is farther away than any map is large"
            asked = decode_request({"fields": {}, **request})
        except ValueError as error:
            return str(error)
        if not isinstance(asked.request, _GRANTED):
            return f"{name} is not allowed here"
        if isinstance(asked.request, WizardRequest) and not self._has_game:
            return "nothing can be said in a robot's place here: the game runs in another program"
        if len(asked.sender) > MOST_CHARACTERS:
            return f"the sender's name has more than {MOST_CHARACTERS} characters"
        if self._waiting >= MOST_PENDING:
            return f"{MOST_PENDING} requests wait for the next tick already"
        reason = objection(asked.request, self._robots)
        if reason is None:
            self._waiting += 1
            if isinstance(asked.request, WizardMode):
                self._puppets.add(asked.request.robot)
            self._ask(asked.sender, self._numbered(asked.request))
        return reason

    def _turn(self, request: PaceRequest) -> str | None:
        match request:
            case Pause():
                self._pacer.pause()
            case Resume():
                self._pacer.resume()
            case SetRate(rate):
                if rate != 0.0 and not SLOWEST <= rate <= FASTEST:
                    return f"a rate is 0, as fast as the machine can, or from {SLOWEST:g} to {FASTEST:g}"
                self._pacer.set_rate(rate)
            case Step(ticks):
                if not 1 <= ticks <= MOST_STEPS:
                    return f"steps are 1 to {MOST_STEPS} ticks"
                self._pacer.step(ticks)
        _log.info("a watcher requests: %s", request)
        return None

    def _numbered(self, request: WatchRequest) -> WatchRequest:
        """Return the request. A goal in it always gets a new number, and the researcher becomes its owner."""
        match request:
            case SendGoal(_, goal):
                return replace(request, goal=replace(goal, id=next(self._goals), owner=GoalOwner.RESEARCHER))
            case SimpleGoal():
                return replace(request, number=next(self._goals), owner=GoalOwner.RESEARCHER)
        return request


def _lies_far(fields: object) -> bool:
    """Return True when a thing's coordinates are so large that checks of its shape would overflow."""
    match fields:
        case {"thing": {**thing}}:
            return any(_is_far(thing.get(key)) for key in ("base_in_map", "footprint", "path"))
    return False


def _is_far(value: object) -> bool:
    match value:
        case Mapping():
            return any(_is_far(inner) for inner in value.values())
        case list():
            return any(_is_far(inner) for inner in value)
        case int() | float():
            return abs(value) > FARTHEST
    return False


def objection(request: WatchRequest, robots: RobotTeam) -> str | None:
    """Return the reason, for people, why these robots cannot accept a request; None if they can.

    A session does not check requests, so all checks of a watcher's input are here.
    """
    if not isinstance(request, PutThing | RemoveThing | WizardMove) and not 0 <= request.robot < robots.size:
        return f"there is no robot {request.robot}: robots count from 0 here, and there are {robots.size}"
    match request:
        case SendGoal(_, goal):
            return _objection_to_pose(goal.base_in_map)
        case SimpleGoal(_, pose):
            return "it has no pose" if pose is None else _objection_to_pose(pose)
        case KidnapRobot(_, pose) | PlaceRobot(_, pose):
            return _objection_to_pose(pose)
        case InitialPose(_, pose, covariance) | SetPoseEstimate(_, pose, covariance):
            unfit = (
                None
                if is_covariance(covariance)
                else "its covariance is invalid: it must be (3, 3) and positive semi-definite"
            )
            return _objection_to_pose(pose) or unfit
        case VelocityCommand(_, twist):
            return None if _are_near(twist.linear, twist.angular) else "the speed is too high"
        case SetParameters(robot, values):
            if robot >= len(robots.parameters):
                return "the software of these robots cannot be changed from here"
            changed = Tuning(robots.parameters[robot], robots.worlds[robot]).changed(values)
            return changed.sentence if isinstance(changed, ParameterRejection) else None
        case PutThing(thing):
            return fault_of_thing(thing, FARTHEST, MOST_CHARACTERS)
        case WizardMove(text=text) if len(text) > MOST_CHARACTERS or not text.isprintable():
            return f"a robot can say one line of at most {MOST_CHARACTERS} characters"
        case RemoveThing(name) | CancelRequest(_, name):
            return None if len(name) <= MOST_CHARACTERS else f"a name has at most {MOST_CHARACTERS} characters"
    return None


def _objection_to_pose(pose: Pose2) -> str | None:
    return None if _are_near(pose.x, pose.y, pose.theta) else "the place is farther away than any map is large"


def _are_near(*numbers: float) -> bool:
    """Return True when each number is at most `FARTHEST` from 0; NaN is not."""
    return all(abs(number) <= FARTHEST for number in numbers)
