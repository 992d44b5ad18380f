"""Minimal ground station for commands of the command line, without its socket.

It sends heartbeats, repeats commands until robots acknowledge them, and stores the latest telemetry of every robot.

Source: the MAVLink developer guide, "Heartbeat" and "Command Protocol".
"""

import math
from dataclasses import dataclass, replace
from typing import TypeAlias

from sim.numerics import elementary
from thbridge.mavlink.values.conventions import COMMANDER
from thbridge.mavlink.wire.dialect import TEXT_SIZE, Message, crc_extra, decoded, mav, payload_of
from thbridge.mavlink.wire.frames.frame import Frame, missing_between

SYSTEM = 255
COMPONENT = mav.MAV_COMP_ID_MISSIONPLANNER
ROBOT = mav.MAV_COMP_ID_AUTOPILOT1

HEARTBEAT_PERIOD = 1.0
ACK_TIMEOUT = 0.5
TRIES = 5
PROGRESS_TIMEOUT = 3.0
"""Seconds without an acknowledgement, after an acknowledgement of progress. Then the command counts as unanswered."""

_MOST_SYSTEMS = 255


@dataclass(frozen=True, slots=True)
class StationCommand:
    """Command to a robot.

    Attributes:
        number: a code of MAV_CMD.
        parameters: up to seven parameters. Missing parameters are 0.
        frame: a code of MAV_FRAME, which is sent in COMMAND_INT. If None, the command is sent in COMMAND_LONG.
    """

    number: int
    parameters: tuple[float, ...] = ()
    frame: int | None = None


@dataclass(frozen=True, slots=True)
class CommandAcked:
    """Final acknowledgement of a command. `result` is a code of MAV_RESULT."""

    system: int
    command: int
    result: int


@dataclass(frozen=True, slots=True)
class CommandUnanswered:
    """Command that was sent several times and not acknowledged."""

    system: int
    command: int


@dataclass(frozen=True, slots=True)
class StatusTextReceived:
    """Text that a robot sends to people. `severity` is a code of MAV_SEVERITY."""

    system: int
    severity: int
    text: str


StationEvent: TypeAlias = CommandAcked | CommandUnanswered | StatusTextReceived


@dataclass(slots=True)
class KnownRobot:
    """Latest telemetry of a robot. Times are seconds of the station's clock.

    Attributes:
        system: its system id.
        autopilot: a code of MAV_AUTOPILOT.
        custom_mode: mode number of its autopilot.
        base_mode: bits of MAV_MODE_FLAG.
        first_heartbeat: time of its first heartbeat.
        last_heartbeat: time of its last heartbeat.
        last_frame: time of its last frame.
        x: meters east of the map's origin. NaN while unknown.
        y: meters north of the map's origin.
        latitude: degrees. NaN while unknown.
        longitude: degrees.
        speed: m/s.
        energy: remaining fraction, from 0 to 1. NaN while unknown.
        frames: number of frames received from the robot.
        lost: number of frames lost in transmission.
        commander: its commander. See `conventions.COMMANDER`. None while unknown.
        text: its last text for people.
    """

    system: int
    autopilot: int
    custom_mode: int
    base_mode: int
    first_heartbeat: float
    last_heartbeat: float
    last_frame: float
    x: float = math.nan
    y: float = math.nan
    latitude: float = math.nan
    longitude: float = math.nan
    speed: float = math.nan
    energy: float = math.nan
    frames: int = 0
    lost: int = 0
    commander: int | None = None
    text: str = ""

    @property
    def armed(self) -> bool:
        """True if its motors are enabled."""
        return bool(self.base_mode & mav.MAV_MODE_FLAG_SAFETY_ARMED)


@dataclass(frozen=True, slots=True)
class _Pending:
    """Command that waits for its acknowledgement until `due`."""

    command: StationCommand
    tries: int
    due: float
    in_progress: bool = False


class GroundStation:
    """Ground station on one link.

    Args:
        system: its own system id.
        component: its own component id.
    """

    def __init__(self, system: int = SYSTEM, component: int = COMPONENT) -> None:
        self.robots: dict[int, KnownRobot] = {}
        """Robots by their system ids."""
        self._system = system
        self._component = component
        self._sequence = 0
        self._outgoing: list[Frame] = []
        self._last_heartbeat: float | None = None
        self._pending: dict[tuple[int, int], _Pending] = {}
        self._sequences: dict[int, int] = {}
        self._texts: dict[tuple[int, int], str] = {}

    def take_frames(self) -> list[Frame]:
        """Return the frames that must be sent, and remove them from the queue."""
        frames, self._outgoing = self._outgoing, []
        return frames

    def send_command(self, system: int, command: StationCommand, now: float) -> None:
        """Send a command. It replaces a pending command with the same number.

        The event `CommandAcked` or `CommandUnanswered` follows.
        """
        self._transmit(system, _Pending(command, 1, now + ACK_TIMEOUT))

    def request(self, system: int, message_id: int, now: float) -> None:
        """Request one message from a robot."""
        self.send_command(system, StationCommand(mav.MAV_CMD_REQUEST_MESSAGE, (float(message_id),)), now)

    def advance(self, now: float) -> list[StationEvent]:
        """Send heartbeats, repeat commands that are due, and return the events."""
        if self._last_heartbeat is None or now - self._last_heartbeat >= HEARTBEAT_PERIOD:
            self._last_heartbeat = now
            kind, pilot, state = mav.MAV_TYPE_GCS, mav.MAV_AUTOPILOT_INVALID, mav.MAV_STATE_ACTIVE
            self._send(mav.MAVLink_heartbeat_message(kind, pilot, 0, 0, state, 3))
        events: list[StationEvent] = []
        for (system, command), waiting in tuple(self._pending.items()):
            if now < waiting.due:
                continue
            # A command in progress has arrived, so it is not sent again.
            if waiting.in_progress or waiting.tries >= TRIES:
                del self._pending[system, command]
                events.append(CommandUnanswered(system, command))
            else:
                again = replace(waiting, tries=waiting.tries + 1, due=now + ACK_TIMEOUT)
                self._transmit(system, again)
        return events

    def receive_frame(self, frame: Frame, now: float) -> list[StationEvent]:
        """Process a received frame and return the events. Frames that do not come from robots are ignored."""
        message = decoded(frame.message_id, frame.payload)
        if message is None or frame.component != ROBOT:
            return []
        robot = self._robot_of(frame.system, message, now)
        if robot is None:
            return []
        last = self._sequences.get(frame.system)
        robot.lost += 0 if last is None else missing_between(last, frame.sequence)
        self._sequences[frame.system] = frame.sequence
        robot.frames += 1
        robot.last_frame = now
        return self._handle(robot, message, now)

    def _robot_of(self, system: int, message: Message, now: float) -> KnownRobot | None:
        """Return the robot with this id, or None before its first heartbeat."""
        robot = self.robots.get(system)
        if robot is None and isinstance(message, mav.MAVLink_heartbeat_message) and len(self.robots) < _MOST_SYSTEMS:
            robot = KnownRobot(system, message.autopilot, message.custom_mode, message.base_mode, now, now, now)
            self.robots[system] = robot
        return robot

    def _handle(self, robot: KnownRobot, message: Message, now: float) -> list[StationEvent]:
        match message:
            case mav.MAVLink_heartbeat_message():
                robot.autopilot, robot.last_heartbeat = message.autopilot, now
                robot.custom_mode, robot.base_mode = message.custom_mode, message.base_mode
            case mav.MAVLink_local_position_ned_message():
                # MAVLink's local frame has x north and y east. Maps have x east and y north.
                robot.x, robot.y = message.y, message.x
                robot.speed = elementary.hypot(message.vx, message.vy)
            case mav.MAVLink_global_position_int_message():
                robot.latitude, robot.longitude = message.lat / 1e7, message.lon / 1e7
            case mav.MAVLink_battery_status_message():
                robot.energy = message.battery_remaining / 100
            case mav.MAVLink_named_value_int_message() if _text(message.name) == COMMANDER:
                robot.commander = message.value
            case mav.MAVLink_command_ack_message():
                return self._acked(robot.system, message, now)
            case mav.MAVLink_statustext_message():
                return self._texted(robot, message)
        return []

    def _acked(self, system: int, ack: mav.MAVLink_command_ack_message, now: float) -> list[StationEvent]:
        # The target is an extension of the message. It is 0 if an autopilot does not send it.
        if (ack.target_system or self._system, ack.target_component or self._component) != (
            self._system,
            self._component,
        ):
            return []
        key = (system, ack.command)
        waiting = self._pending.get(key)
        if waiting is None:
            return []
        if ack.result == mav.MAV_RESULT_IN_PROGRESS:
            self._pending[key] = replace(waiting, in_progress=True, due=now + PROGRESS_TIMEOUT)
            return []
        del self._pending[key]
        return [CommandAcked(system, ack.command, ack.result)]

    def _texted(self, robot: KnownRobot, message: mav.MAVLink_statustext_message) -> list[StationEvent]:
        """Join the chunks of a long text. The last chunk is shorter than the other chunks."""
        piece = _text(message.text)
        # Id 0 means that the text fits into one message.
        if message.id:
            key = (robot.system, message.id)
            piece = self._texts.pop(key, "") + piece if message.chunk_seq else piece
            if len(piece) >= TEXT_SIZE * (message.chunk_seq + 1):
                self._texts[key] = piece
                return []
        robot.text = piece
        return [StatusTextReceived(robot.system, message.severity, piece)]

    def _transmit(self, system: int, waiting: _Pending) -> None:
        command = waiting.command
        self._pending[system, command.number] = waiting
        given = (*command.parameters, *(0.0,) * (7 - len(command.parameters)))
        first, second, third, fourth, x, y, z = given
        if command.frame is None:
            # `confirmation` counts the repetitions, so that the robot does not execute a repeated command again.
            self._send(
                mav.MAVLink_command_long_message(
                    system, ROBOT, command.number, waiting.tries - 1, first, second, third, fourth, x, y, z
                )
            )
        else:
            self._send(
                mav.MAVLink_command_int_message(
                    system, ROBOT, command.frame, command.number, 0, 0, first, second, third, fourth, int(x), int(y), z
                )
            )

    def _send(self, message: Message) -> None:
        seed = crc_extra(message.get_msgId()) or 0
        self._outgoing.append(
            Frame(self._system, self._component, self._sequence, message.get_msgId(), payload_of(message), seed)
        )
        self._sequence = (self._sequence + 1) % 256  # The field has one byte.


def _text(raw: str | bytes) -> str:
    """Return the text of a character field, which is padded with zeros."""
    data = raw if isinstance(raw, bytes) else raw.encode()
    return data.rstrip(b"\0").decode("utf-8", "replace")
