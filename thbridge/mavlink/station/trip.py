"""Trip of one robot that a ground station commands: arm the robot, send it, wait for its arrival, disarm it.

The trip uses a `GroundStation`. It has no sockets and clocks.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum, auto

from sim.numerics import elementary
from thbridge.mavlink.station.ground_station import (
    HEARTBEAT_PERIOD,
    CommandAcked,
    CommandUnanswered,
    GroundStation,
    KnownRobot,
    StationCommand,
    StationEvent,
    StatusTextReceived,
)
from thbridge.mavlink.values.conventions import ARRIVED
from thbridge.mavlink.values.vehicle_interface import Target
from thbridge.mavlink.wire.coordinates import PER_METRE, yaw_of
from thbridge.mavlink.wire.dialect import mav

ARRIVAL_RADIUS = 0.3
"""Distance to the goal in meters within which a standing robot has arrived, even if it does not report its arrival."""

DISCOVERY_TIMEOUT = 5.0
HEARTBEAT_TIMEOUT = 5.0
_TEXT_TIMEOUT = 0.5
"""Seconds to wait for the text with a robot's reason for a refusal."""
_STANDING_SECONDS = 3.0
_STANDING = 0.02
"""A robot counts as standing if its speed is below this, m/s."""

_ARM = StationCommand(mav.MAV_CMD_COMPONENT_ARM_DISARM, (1.0,))
_DISARM = StationCommand(mav.MAV_CMD_COMPONENT_ARM_DISARM, (0.0,))


@dataclass(frozen=True, slots=True)
class TripOutcome:
    """Outcome of a trip.

    Attributes:
        problem: reason, for people, why the robot did not arrive. Empty if it arrived.
        unanswered: True if the robot did not answer a command.
    """

    problem: str
    unanswered: bool = False


class StationTripStage(Enum):
    """Stage of a trip."""

    SEARCHING = auto()
    TAKING = auto()
    ASKING = auto()
    UNDER_WAY = auto()
    LISTENING = auto()
    RETURNING = auto()
    OVER = auto()


class StationTrip:
    """Trip of one robot.

    Args:
        station: ground station that commands the robot.
        system: system id of the robot.
        destination: goal of the trip.
        keep: True if the station commands the robot even after the trip.
        now: seconds of the station's clock.

    Attributes:
        stage: current stage.
        outcome: outcome of the trip. None until the trip is over.
    """

    def __init__(self, station: GroundStation, system: int, destination: Target, keep: bool, now: float) -> None:
        self.stage = StationTripStage.SEARCHING
        self.outcome: TripOutcome | None = None
        self._station = station
        self._system = system
        self._destination = destination
        self._keep = keep
        self._since = now
        self._commands = False
        self._problem = ""
        self._unanswered = False
        self._stood = now

    @property
    def remaining(self) -> float:
        """Straight distance to the goal, meters; NaN while unknown."""
        robot = self._station.robots.get(self._system)
        return math.nan if robot is None else _distance(self._destination, robot)

    def advance(self, events: Iterable[StationEvent], now: float) -> None:
        """Process the station's events, and check timeouts."""
        for event in events:
            if event.system == self._system:
                self._handle_event(event, now)
        robot = self._station.robots.get(self._system)
        waited = now - self._since
        match self.stage:
            case StationTripStage.SEARCHING if robot is not None:
                self._send(StationTripStage.TAKING, _ARM, now)
            case StationTripStage.SEARCHING if waited > DISCOVERY_TIMEOUT:
                there = ", ".join(str(system) for system in sorted(self._station.robots))
                self._fail(f"robot {self._system} sends nothing; robots that send: {there or 'none'}", now)
            case StationTripStage.UNDER_WAY if robot is not None:
                self._watch(robot, now)
            case StationTripStage.LISTENING if waited > _TEXT_TIMEOUT:
                self._hand_back(now)

    def give_up(self, now: float) -> None:
        """Abort the trip. Disarm the robot, so that it stops and the participant commands it again."""
        self._problem = "given up"
        self._keep = False
        self._hand_back(now)

    def _handle_event(self, event: StationEvent, now: float) -> None:
        match event:
            case CommandAcked(_, mav.MAV_CMD_COMPONENT_ARM_DISARM, result) if self.stage is StationTripStage.TAKING:
                if result == mav.MAV_RESULT_ACCEPTED:
                    self._commands = True
                    self._send(StationTripStage.ASKING, _command_to(self._destination), now)
                else:
                    self._fail(f"robot {self._system} refuses to change its commander ({_word(result)})", now)
            case CommandAcked(_, mav.MAV_CMD_DO_REPOSITION, result) if self.stage is StationTripStage.ASKING:
                if result == mav.MAV_RESULT_ACCEPTED:
                    self.stage, self._since, self._stood = StationTripStage.UNDER_WAY, now, now
                else:
                    self._fail(f"robot {self._system} refuses to drive there ({_word(result)})", now)
            case CommandUnanswered() if self.stage in (StationTripStage.TAKING, StationTripStage.ASKING):
                self._unanswered = True
                self._fail(f"robot {self._system} does not answer", now)
            case CommandAcked() | CommandUnanswered() if self.stage is StationTripStage.RETURNING:
                self._end()
            case StatusTextReceived(_, severity, text):
                self._handle_text(severity, text, now)

    def _handle_text(self, severity: int, text: str, now: float) -> None:
        """Process a text of the robot, because it explains more than a result code."""
        if self.stage is StationTripStage.UNDER_WAY and text == ARRIVED:
            self._hand_back(now)
        elif severity <= mav.MAV_SEVERITY_WARNING:
            if self.stage is StationTripStage.UNDER_WAY:
                self._fail(text, now)
            elif self.stage is StationTripStage.LISTENING:
                self._problem = text

    def _watch(self, robot: KnownRobot, now: float) -> None:
        """Check the heartbeat, position and arming of the robot, because its texts may be lost on the link."""
        # This condition is also True for NaN, an unknown speed.
        if not robot.speed < _STANDING:
            self._stood = now
        if now - robot.last_heartbeat > HEARTBEAT_TIMEOUT:
            self._fail(f"robot {self._system} no longer sends heartbeats", now)
        elif now - self._stood > _STANDING_SECONDS and _distance(self._destination, robot) < ARRIVAL_RADIUS:
            self._hand_back(now)
        elif (
            not robot.armed and robot.last_heartbeat - self._since > HEARTBEAT_PERIOD
        ):  # In an earlier heartbeat, the robot may not know its commander yet.
            self._fail(f"another client now commands robot {self._system}", now)

    def _send(self, stage: StationTripStage, command: StationCommand, now: float) -> None:
        self.stage, self._since = stage, now
        self._station.send_command(self._system, command, now)

    def _fail(self, problem: str, now: float) -> None:
        # A text that explains a refusal follows the acknowledgement, so wait for it.
        self._problem = problem
        self.stage, self._since = StationTripStage.LISTENING, now

    def _hand_back(self, now: float) -> None:
        if self._commands and not self._keep:
            self._send(StationTripStage.RETURNING, _DISARM, now)
        else:
            self._end()

    def _end(self) -> None:
        self.stage, self.outcome = StationTripStage.OVER, TripOutcome(self._problem, self._unanswered)


def _command_to(target: Target) -> StationCommand:
    """Return the command that sends a robot to a goal, in MAVLink's local frame: x north, y east."""
    # In MAVLink, NaN means any heading.
    yaw = math.nan if target.heading is None else yaw_of(target.heading)
    place = (round(target.y * PER_METRE), round(target.x * PER_METRE))
    parameters = (-1.0, float(mav.MAV_DO_REPOSITION_FLAGS_CHANGE_MODE), 0.0, yaw, *place, 0.0)
    return StationCommand(mav.MAV_CMD_DO_REPOSITION, parameters, mav.MAV_FRAME_LOCAL_NED)


def _distance(target: Target, robot: KnownRobot) -> float:
    """Return the distance in meters from a robot's position estimate to a goal. NaN while the estimate is unknown."""
    return elementary.hypot(target.x - robot.x, target.y - robot.y)


def _word(result: int) -> str:
    """Return a code of MAV_RESULT as a word."""
    known = mav.enums["MAV_RESULT"].get(result)
    return f"result {result}" if known is None else known.name.removeprefix("MAV_RESULT_").replace("_", " ").lower()
