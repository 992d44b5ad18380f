"""The other side of a link: a ground station without its socket, as small as the command line needs one.

It keeps its heartbeat, sends commands until they are answered, and remembers what every robot says of itself.

Source: the MAVLink developer guide, "Heartbeat" and "Command Protocol".
"""

import math
from dataclasses import dataclass, replace
from typing import TypeAlias

from thbridge.wire.mavlink.conventions import COMMANDER
from thbridge.wire.mavlink.dialect import TEXT_SIZE, Message, crc_extra, decoded, mav, payload_of
from thbridge.wire.mavlink.frames.frame import Frame, missing_between

SYSTEM = 255
COMPONENT = mav.MAV_COMP_ID_MISSIONPLANNER
ROBOT = mav.MAV_COMP_ID_AUTOPILOT1

HEARTBEAT_SECONDS = 1.0
ANSWER_SECONDS = 0.5
TRIES = 5
PROGRESS_SECONDS = 3.0
"""How long news of a command may take whose answer was that it is in progress."""

_MOST_SYSTEMS = 255


@dataclass(frozen=True, slots=True)
class StationCommand:
    """A command to a robot.

    Attributes:
        number: of MAV_CMD.
        parameters: up to seven; those that are left out are 0.
        frame: of MAV_FRAME, for a command that travels as COMMAND_INT; None: COMMAND_LONG.
    """

    number: int
    parameters: tuple[float, ...] = ()
    frame: int | None = None


@dataclass(frozen=True, slots=True)
class CommandAcked:
    """A robot has answered a command, for good; `result` is of MAV_RESULT."""

    system: int
    command: int
    result: int


@dataclass(frozen=True, slots=True)
class CommandUnanswered:
    """A robot has not answered a command, however often it was sent."""

    system: int
    command: int


@dataclass(frozen=True, slots=True)
class StatusTextReceived:
    """A robot said something to people; `severity` is of MAV_SEVERITY."""

    system: int
    severity: int
    text: str


StationEvent: TypeAlias = CommandAcked | CommandUnanswered | StatusTextReceived


@dataclass(slots=True)
class KnownRobot:
    """What is known of a robot.

    Attributes:
        system: its system id.
        autopilot: of MAV_AUTOPILOT.
        custom_mode: as its autopilot counts modes.
        base_mode: bits of MAV_MODE_FLAG.
        first: when it was first heard.
        heard: when its last heartbeat came.
        last: when its last frame came.
        x: metres east of the map's origin; NaN as long as it has not said so.
        y: metres north of it.
        latitude: degrees; NaN as long as it has not said so.
        longitude: degrees.
        speed: m/s.
        energy: what is left, from 0 to 1; NaN as long as it has not said so.
        frames: that came from it.
        lost: frames that it sent and that did not come.
        commander: who commands it, see `conventions.COMMANDER`; None as long as it has not said so.
        text: what it said last to people.
    """

    system: int
    autopilot: int
    custom_mode: int
    base_mode: int
    first: float
    heard: float
    last: float
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
        """Whether its motors obey."""
        return bool(self.base_mode & mav.MAV_MODE_FLAG_SAFETY_ARMED)


@dataclass(frozen=True, slots=True)
class _Pending:
    """A command that waits for its answer until `due`."""

    order: StationCommand
    tries: int
    due: float
    in_progress: bool = False


class GroundStation:
    """One ground station on one link.

    Args:
        system: its own system id.
        component: its own component id.
    """

    def __init__(self, system: int = SYSTEM, component: int = COMPONENT) -> None:
        self.robots: dict[int, KnownRobot] = {}
        """Those that have been heard, by their system ids."""
        self._system = system
        self._component = component
        self._sequence = 0
        self._outgoing: list[Frame] = []
        self._beaten: float | None = None
        self._pending: dict[tuple[int, int], _Pending] = {}
        self._sequences: dict[int, int] = {}
        self._texts: dict[tuple[int, int], str] = {}

    def take_frames(self) -> list[Frame]:
        """What is to be sent."""
        frames, self._outgoing = self._outgoing, []
        return frames

    def order(self, system: int, order: StationCommand, now: float) -> None:
        """Command a robot; `Acked` or `Unanswered` follows. The same command on its way is given up for it."""
        self._send_order(system, _Pending(order, 1, now + ANSWER_SECONDS))

    def request(self, system: int, message_id: int, now: float) -> None:
        """Ask a robot for one message."""
        self.order(system, StationCommand(mav.MAV_CMD_REQUEST_MESSAGE, (float(message_id),)), now)

    def advance(self, now: float) -> list[StationEvent]:
        """Time has passed."""
        if self._beaten is None or now - self._beaten >= HEARTBEAT_SECONDS:
            self._beaten = now
            kind, pilot, state = mav.MAV_TYPE_GCS, mav.MAV_AUTOPILOT_INVALID, mav.MAV_STATE_ACTIVE
            self._say(mav.MAVLink_heartbeat_message(kind, pilot, 0, 0, state, 3))
        events: list[StationEvent] = []
        for (system, command), waiting in tuple(self._pending.items()):
            if now < waiting.due:
                continue
            if waiting.in_progress or waiting.tries >= TRIES:
                del self._pending[system, command]
                events.append(CommandUnanswered(system, command))
            else:
                again = replace(waiting, tries=waiting.tries + 1, due=now + ANSWER_SECONDS)
                self._send_order(system, again)
        return events

    def receive_frame(self, frame: Frame, now: float) -> list[StationEvent]:
        """A frame has come in; what does not come from a robot is ignored."""
        message = decoded(frame.message_id, frame.payload)
        if message is None or frame.component != ROBOT:
            return []
        robot = self._seen(frame.system, message, now)
        if robot is None:
            return []
        last = self._sequences.get(frame.system)
        robot.lost += 0 if last is None else missing_between(last, frame.sequence)
        self._sequences[frame.system] = frame.sequence
        robot.frames += 1
        robot.last = now
        return self._understood(robot, message, now)

    def _seen(self, system: int, message: Message, now: float) -> KnownRobot | None:
        """The robot of this id; None: it has not said by a heartbeat that it is one."""
        robot = self.robots.get(system)
        if robot is None and isinstance(message, mav.MAVLink_heartbeat_message) and len(self.robots) < _MOST_SYSTEMS:
            robot = KnownRobot(system, message.autopilot, message.custom_mode, message.base_mode, now, now, now)
            self.robots[system] = robot
        return robot

    def _understood(self, robot: KnownRobot, message: Message, now: float) -> list[StationEvent]:
        match message:
            case mav.MAVLink_heartbeat_message():
                robot.autopilot, robot.heard = message.autopilot, now
                robot.custom_mode, robot.base_mode = message.custom_mode, message.base_mode
            case mav.MAVLink_local_position_ned_message():
                robot.x, robot.y = message.y, message.x
                robot.speed = math.hypot(message.vx, message.vy)
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
            self._pending[key] = replace(waiting, in_progress=True, due=now + PROGRESS_SECONDS)
            return []
        del self._pending[key]
        return [CommandAcked(system, ack.command, ack.result)]

    def _texted(self, robot: KnownRobot, message: mav.MAVLink_statustext_message) -> list[StationEvent]:
        """Long texts come in pieces, of which the last is shorter than the others."""
        piece = _text(message.text)
        if message.id:
            key = (robot.system, message.id)
            piece = self._texts.pop(key, "") + piece if message.chunk_seq else piece
            if len(piece) >= TEXT_SIZE * (message.chunk_seq + 1):
                self._texts[key] = piece
                return []
        robot.text = piece
        return [StatusTextReceived(robot.system, message.severity, piece)]

    def _send_order(self, system: int, waiting: _Pending) -> None:
        order = waiting.order
        self._pending[system, order.number] = waiting
        given = (*order.parameters, *(0.0,) * (7 - len(order.parameters)))
        first, second, third, fourth, x, y, z = given
        if order.frame is None:
            self._say(
                mav.MAVLink_command_long_message(
                    system, ROBOT, order.number, waiting.tries - 1, first, second, third, fourth, x, y, z
                )
            )
        else:
            self._say(
                mav.MAVLink_command_int_message(
                    system, ROBOT, order.frame, order.number, 0, 0, first, second, third, fourth, int(x), int(y), z
                )
            )

    def _say(self, message: Message) -> None:
        seed = crc_extra(message.get_msgId()) or 0
        self._outgoing.append(
            Frame(self._system, self._component, self._sequence, message.get_msgId(), payload_of(message), seed)
        )
        self._sequence = (self._sequence + 1) % 256


def _text(raw: str | bytes) -> str:
    """A field of characters, which are padded with zeros."""
    data = raw if isinstance(raw, bytes) else raw.encode()
    return data.rstrip(b"\0").decode("utf-8", "replace")
