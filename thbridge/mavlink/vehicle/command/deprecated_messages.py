"""Deprecated messages. Ground stations sent them before commands for the same purposes existed.

Source: MAVLink's `common.xml`, SET_MODE, SET_HOME_POSITION and CHANGE_OPERATOR_CONTROL; ArduPilot, for mission items
that do not belong to a mission, and for the acknowledgement of SET_MODE.
"""

import math
from collections.abc import Iterator
from typing import TypeAlias

from thbridge.mavlink.values.vehicle_interface import Denied, Station, Target
from thbridge.mavlink.vehicle.command.table import CommandTable
from thbridge.mavlink.vehicle.geodesy import PER_DEGREE, GeoPoint, MapProjection
from thbridge.mavlink.vehicle.mode.home import HomePosition
from thbridge.mavlink.vehicle.mode.operator_control import OperatorControl
from thbridge.mavlink.vehicle.mode.state_machine import ModeStateMachine
from thbridge.mavlink.vehicle.parts import Announce, Microservice, TextSeverity, announce_denial
from thbridge.mavlink.wire.coordinates import GLOBAL
from thbridge.mavlink.wire.dialect import Message, mav
from thbridge.mavlink.wire.outgoing import LinkId, OutgoingMessage

_GUIDED_ITEM = 2
"""Value of `current` in a mission item that is not part of a mission but a goal to which the robot drives at once."""

_CONTROL_GRANTED, _CONTROL_ELSEWHERE = 0, 3
_REQUEST_CONTROL = 0

_Item: TypeAlias = mav.MAVLink_mission_item_int_message | mav.MAVLink_mission_item_message


class DeprecatedMessages(Microservice):
    """Deprecated messages to one vehicle.

    Args:
        commands: command table, which translates the numbers of modes.
        modes: the robot's mode state machine.
        control: state of the ground station that commands the robot.
        home: home position.
        earth: map projection.
        announce: sends texts to people.
    """

    def __init__(
        self,
        commands: CommandTable,
        modes: ModeStateMachine,
        control: OperatorControl,
        home: HomePosition,
        earth: MapProjection,
        announce: Announce,
    ) -> None:
        self._commands = commands
        self._modes = modes
        self._control = control
        self._home = home
        self._earth = earth
        self._announce = announce

    def handle_message(self, link: LinkId, sender: Station, message: Message) -> Iterator[OutgoingMessage]:
        """Process a deprecated request to set a mode, a goal or the home position, or to command the robot."""
        match message:
            case mav.MAVLink_set_mode_message():
                yield OutgoingMessage(self._set_mode(sender, message), link)
            case mav.MAVLink_mission_item_int_message() | mav.MAVLink_mission_item_message():
                if message.current == _GUIDED_ITEM:
                    yield OutgoingMessage(self._guided_item(sender, message), link)
            case mav.MAVLink_set_home_position_message():
                announce_denial(self._announce, self._set_home(sender, GeoPoint(message.latitude, message.longitude)))
            case mav.MAVLink_change_operator_control_message():
                yield OutgoingMessage(self._operator_control(sender, message), link)

    def _set_mode(self, sender: Station, message: mav.MAVLink_set_mode_message) -> Message:
        """Set a mode. The answer is a COMMAND_ACK with the message's id instead of a command, as in ArduPilot."""
        reply = self._commands.mode_reply(sender, message.base_mode, message.custom_mode, 0)
        if reply.sentence:
            self._announce(TextSeverity.WARNING, reply.sentence)
        number = mav.MAVLINK_MSG_ID_SET_MODE
        return mav.MAVLink_command_ack_message(number, reply.result, 0, 0, sender.system, sender.component)

    def _guided_item(self, sender: Station, item: _Item) -> Message:
        """Send the robot to the place of a mission item."""
        denied = self._control.objection(sender)
        if denied is None:
            # MISSION_ITEM contains degrees. MISSION_ITEM_INT contains degrees times 10 million.
            scale = 1 if isinstance(item, mav.MAVLink_mission_item_int_message) else PER_DEGREE
            if item.frame not in GLOBAL or not (math.isfinite(item.x) and math.isfinite(item.y)):
                denied = Denied("Only a latitude and a longitude can be gone to this way.")
            else:
                x, y = self._earth.map_point(GeoPoint(round(item.x * scale), round(item.y * scale)))
                denied = self._modes.go(Target(x, y))
        announce_denial(self._announce, denied)
        result = mav.MAV_MISSION_ACCEPTED if denied is None else mav.MAV_MISSION_DENIED
        return mav.MAVLink_mission_ack_message(sender.system, sender.component, result)

    def _set_home(self, sender: Station, place: GeoPoint) -> Denied | None:
        """Set the home position. The only answer is the message HOME_POSITION on all links."""
        reserved = self._control.reserved(sender)
        if reserved is not None:
            return reserved
        return self._home.set_here() if place.is_unset else self._home.set_to(Target(*self._earth.map_point(place)))

    def _operator_control(self, sender: Station, message: mav.MAVLink_change_operator_control_message) -> Message:
        """Let the sender command the robot or stop commanding it, like arming and disarming, but never by force."""
        granted = _CONTROL_GRANTED
        if message.control_request == _REQUEST_CONTROL:
            denied = self._modes.arm(sender, by_force=False)
            announce_denial(self._announce, denied)
            granted = _CONTROL_GRANTED if denied is None else _CONTROL_ELSEWHERE
        elif self._control.station == sender:
            self._modes.disarm()
        return mav.MAVLink_change_operator_control_ack_message(sender.system, message.control_request, granted)
