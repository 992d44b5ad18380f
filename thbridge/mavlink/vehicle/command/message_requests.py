"""Commands by which stations request messages from a vehicle: once, or at an interval.

Source: MAVLink's `common.xml`, MAV_CMD.
"""

from collections.abc import Callable, Mapping

from sim.common.observations import TICKS_PER_SECOND
from thbridge.mavlink.vehicle.boot_time import MICROSECONDS_PER_TICK
from thbridge.mavlink.vehicle.command.requests import (
    ACCEPTED,
    INVALID_PARAM,
    CommandReply,
    CommandResult,
    CommandSpec,
    ReceivedCommand,
)
from thbridge.mavlink.vehicle.telemetry.capabilities import Capabilities
from thbridge.mavlink.vehicle.telemetry.streams import OFF, Streams, ticks_of
from thbridge.mavlink.vehicle.telemetry.telemetry import Telemetry, TelemetryState
from thbridge.mavlink.wire.dialect import mav
from thbridge.mavlink.wire.extra_messages import ProtocolVersion
from thbridge.mavlink.wire.mode_numbers import Mode

_LARGEST_ID = 0xFFFF
"""Maximum message id that MESSAGE_INTERVAL can contain."""


class MessageRequests:
    """Message requests to one vehicle.

    Args:
        streams: rates of its messages.
        telemetry: source of its messages.
        capabilities: source of its constant messages.
        state: returns its current state.
    """

    def __init__(
        self, streams: Streams, telemetry: Telemetry, capabilities: Capabilities, state: Callable[[], TelemetryState]
    ) -> None:
        self._streams = streams
        self._telemetry = telemetry
        self._capabilities = capabilities
        self._state = state

    def commands(self) -> Mapping[int, CommandSpec]:
        """Return the commands by their numbers. Any station may give them."""
        return {
            mav.MAV_CMD_SET_MESSAGE_INTERVAL: CommandSpec(self._set_message_interval),
            mav.MAV_CMD_GET_MESSAGE_INTERVAL: CommandSpec(self._get_message_interval),
            mav.MAV_CMD_REQUEST_MESSAGE: CommandSpec(self._request_message),
            mav.MAV_CMD_REQUEST_PROTOCOL_VERSION: CommandSpec(self._one(ProtocolVersion.id)),
            mav.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES: CommandSpec(self._one(mav.MAVLINK_MSG_ID_AUTOPILOT_VERSION)),
            mav.MAV_CMD_GET_HOME_POSITION: CommandSpec(self._one(mav.MAVLINK_MSG_ID_HOME_POSITION)),
        }

    def _one(self, number: int) -> Callable[[ReceivedCommand], CommandReply]:
        """Return a command that requests the message with this number."""
        return lambda _: self._requested(number)

    def _requested(self, number: int) -> CommandReply:
        message = self._telemetry.message(number, self._state())
        return (
            CommandReply(CommandResult.TEMPORARILY_REJECTED)
            if message is None
            else CommandReply(CommandResult.ACCEPTED, (message,))
        )

    def _request_message(self, request: ReceivedCommand) -> CommandReply:
        number = request.whole_param(1)
        if number is None:
            return INVALID_PARAM
        if number == mav.MAVLINK_MSG_ID_AVAILABLE_MODES:
            # Index 0 requests all modes. A single mode has an index from 1.
            place = request.whole_param(2, otherwise=0)
            if place is None or place > len(Mode):
                return INVALID_PARAM
            places = range(1, len(Mode) + 1) if place == 0 else (place,)
            return CommandReply(
                CommandResult.ACCEPTED, tuple(self._capabilities.available_mode(place) for place in places)
            )
        return self._requested(number) if number in self._streams else CommandReply(CommandResult.UNSUPPORTED)

    def _set_message_interval(self, request: ReceivedCommand) -> CommandReply:
        number, microseconds = request.whole_param(1), request.param(2)
        if number is None or microseconds is None or not (microseconds >= 0.0 or microseconds == -1.0):
            return INVALID_PARAM
        if number not in self._streams:
            return CommandReply(CommandResult.UNSUPPORTED)
        # In this command, 0 means the default rate, and -1 switches the message off.
        ticks = None if microseconds == 0.0 else OFF if microseconds < 0.0 else ticks_of(microseconds)
        if number == mav.MAVLINK_MSG_ID_HEARTBEAT:
            # Stations detect a vehicle by its heartbeats. So every link gets one heartbeat per second.
            return ACCEPTED if ticks in (None, TICKS_PER_SECOND) else INVALID_PARAM
        self._streams.change(request.link, number, ticks)
        return ACCEPTED

    def _get_message_interval(self, request: ReceivedCommand) -> CommandReply:
        number = request.whole_param(1)
        if number is None or number > _LARGEST_ID:
            return INVALID_PARAM
        # In MESSAGE_INTERVAL, 0 means that the message is not available.
        microseconds = 0
        if number in self._streams:
            ticks = self._streams.every(request.link, number)
            microseconds = -1 if ticks == OFF else ticks * MICROSECONDS_PER_TICK
        return CommandReply(CommandResult.ACCEPTED, (mav.MAVLink_message_interval_message(number, microseconds),))
