"""Requests of watchers (researchers' windows) to the robots, the game and the session's clock."""

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
"""Maximum number of requests between two ticks. A person always makes fewer requests during a pause."""

MOST_CHARACTERS = 500
"""Maximum number of characters of a name, or of a sentence that a person writes for a robot."""

WATCH_SENDER = "watch"
"""Name of the sender of the requests that the session makes when the last watcher has disconnected."""

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
"""Requests that watchers may send. All other requests belong to the game, or have another form for watchers."""

_GRANTED: tuple[type[WatchRequest], ...] = get_args(WatchRequest)

_log = logging.getLogger(__name__)


def request_line(sender: str, request: Request | PaceRequest) -> bytes:
    """Return a watcher's request as a line."""
    return encode_request(sender, request).encode() + b"\n"


class WatchRequestHandler:
    """Handler that grants or refuses requests of watchers.

    Args:
        ask: callback with the name of the sender and a granted request.
        robots: the team.
        pacer: pacer of the session.
        granted: callback with the name of a key and a granted request. If None, there is no callback.
        has_game: True if the game is in this session, so that a watcher can speak for a robot.
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
        """Record that the session has processed the pending requests in a tick."""
        self._waiting = 0

    def pace(self) -> SessionPace:
        """Return the pace of the session."""
        return SessionPace(self._pacer.paused, self._pacer.rate, self._pacer.lag)

    def unwatched(self) -> None:
        """End a pause and the wizard mode after the last watcher has disconnected.

        Otherwise the session and the robots would wait for a watcher.
        """
        self._pacer.resume()
        for robot in sorted(self._puppets):
            self._ask(WATCH_SENDER, WizardMode(robot, on=False))
        self._puppets.clear()

    def ask(self, watcher: str, request: Mapping[str, object], key: str = "") -> str | None:
        """Grant or refuse a request in JSON. Return None if it is granted, otherwise the reason for the refusal.

        Args:
            watcher: name of the connection; a request without a key may name another sender.
            request: request in the form of `request_line`.
            key: name of the watcher's key; empty if there is none.
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
                return "the coordinates of the place are too large for any map"
            asked = decode_request({"fields": {}, **request})
        except ValueError as error:
            return str(error)
        if not isinstance(asked.request, _GRANTED):
            return f"watchers cannot send the request {name}"
        if isinstance(asked.request, WizardRequest) and not self._has_game:
            return "you cannot speak for a robot here, because the game runs in another program"
        if len(asked.sender) > MOST_CHARACTERS:
            return f"the sender's name has more than {MOST_CHARACTERS} characters"
        if self._waiting >= MOST_PENDING:
            return f"{MOST_PENDING} requests are already waiting for the next tick"
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
                    return f"the rate must be 0 (as fast as possible), or from {SLOWEST:g} to {FASTEST:g}"
                self._pacer.set_rate(rate)
            case Step(ticks):
                if not 1 <= ticks <= MOST_STEPS:
                    return f"the number of ticks must be from 1 to {MOST_STEPS}"
                self._pacer.step(ticks)
        _log.info("a watcher requests: %s", request)
        return None

    def _numbered(self, request: WatchRequest) -> WatchRequest:
        """Return the request. If it has a goal, the goal gets a new number, and the researcher becomes its owner."""
        match request:
            case SendGoal(_, goal):
                return replace(request, goal=replace(goal, id=next(self._goals), owner=GoalOwner.RESEARCHER))
            case SimpleGoal():
                return replace(request, number=next(self._goals), owner=GoalOwner.RESEARCHER)
        return request


def _lies_far(fields: object) -> bool:
    """Return True if a thing's coordinates are so large that a check of its shape would overflow."""
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
    """Return the reason why these robots cannot accept a request, in words for people; None if they can.

    The session does not check requests, so this function checks all requests of watchers.
    """
    if not isinstance(request, PutThing | RemoveThing | WizardMove) and not 0 <= request.robot < robots.size:
        return f"there is no robot with the index {request.robot}: the indices are 0 to {robots.size - 1}"
    match request:
        case SendGoal(_, goal):
            return _objection_to_pose(goal.base_in_map)
        case SimpleGoal(_, pose):
            return "the goal has no pose" if pose is None else _objection_to_pose(pose)
        case KidnapRobot(_, pose) | PlaceRobot(_, pose):
            return _objection_to_pose(pose)
        case InitialPose(_, pose, covariance) | SetPoseEstimate(_, pose, covariance):
            unfit = (
                None
                if is_covariance(covariance)
                else "the covariance is invalid: the matrix must be (3, 3) and positive semi-definite"
            )
            return _objection_to_pose(pose) or unfit
        case VelocityCommand(_, twist):
            return None if _are_near(twist.linear, twist.angular) else "the speed is too high"
        case SetParameters(robot, values):
            if robot >= len(robots.parameters):
                return "the parameters of these robots cannot be changed here"
            changed = Tuning(robots.parameters[robot], robots.worlds[robot]).changed(values)
            return changed.sentence if isinstance(changed, ParameterRejection) else None
        case PutThing(thing):
            return fault_of_thing(thing, FARTHEST, MOST_CHARACTERS)
        case WizardMove(text=text) if len(text) > MOST_CHARACTERS or not text.isprintable():
            return f"the sentence of a robot must be one line of at most {MOST_CHARACTERS} characters"
        case RemoveThing(name) | CancelRequest(_, name):
            return None if len(name) <= MOST_CHARACTERS else f"a name must have at most {MOST_CHARACTERS} characters"
    return None


def _objection_to_pose(pose: Pose2) -> str | None:
    return None if _are_near(pose.x, pose.y, pose.theta) else "the coordinates of the place are too large for any map"


def _are_near(*numbers: float) -> bool:
    """Return True if all numbers are at most `FARTHEST` from 0; return False if a number is NaN."""
    return all(abs(number) <= FARTHEST for number in numbers)
