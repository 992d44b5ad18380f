"""Manual control and setpoints. Stations send them many times per second and get no acknowledgement."""

import math
from collections.abc import Iterable
from typing import TypeAlias

from sim.common.observations import Twist
from thbridge.mavlink.values.vehicle_interface import (
    NO_READINGS,
    Denied,
    RobotReadings,
    Station,
    Target,
    VehicleInterface,
)
from thbridge.mavlink.vehicle.geodesy import GeoPoint, MapProjection
from thbridge.mavlink.vehicle.mode.manual_control import ManualControl, VelocitySetpoint
from thbridge.mavlink.vehicle.mode.operator_control import OperatorControl
from thbridge.mavlink.vehicle.mode.state_machine import ModeStateMachine
from thbridge.mavlink.vehicle.parts import Announce, Microservice, announce_denial
from thbridge.mavlink.wire.coordinates import GLOBAL, LOCAL, point_in_map, theta_of
from thbridge.mavlink.wire.dialect import Message, mav
from thbridge.mavlink.wire.mode_numbers import Mode
from thbridge.mavlink.wire.outgoing import LinkId, OutgoingMessage

_NO_AXIS = 0x7FFF
"""Value of an unused axis."""
_FULL_STICK = 1000.0

_RC_MIDDLE, _RC_FULL = 1500, 500.0
_RC_RANGE = range(800, 2201)
"""Pulse widths of radio control, microseconds. Other numbers mean that a channel is not overridden."""
_RC_RELEASED = 0

_IGNORE_POSITION = 0b11
_IGNORE_VELOCITY = 0b11 << 3
_IGNORE_YAW = 1 << 10
_IGNORE_YAW_RATE = 1 << 11

_Setpoint: TypeAlias = mav.MAVLink_set_position_target_local_ned_message | (
    mav.MAVLink_set_position_target_global_int_message
)


class ControlInputs(Microservice):
    """Manual control and setpoints of one vehicle.

    Stations send them even when they do not intend to drive. If the mode does not use them, they are ignored without a
    warning. If the mode uses them, a station that does not command the robot gets a warning.

    Args:
        system: system id of the vehicle. MANUAL_CONTROL contains only this id and no component.
        robot: interface to the robot.
        modes: the robot's mode state machine.
        hand: manual control.
        control: the station in command of the robot.
        earth: map projection.
        announce: sends texts to people.
    """

    def __init__(
        self,
        system: int,
        robot: VehicleInterface,
        modes: ModeStateMachine,
        hand: ManualControl,
        control: OperatorControl,
        earth: MapProjection,
        announce: Announce,
    ) -> None:
        self._system = system
        self._robot = robot
        self._modes = modes
        self._hand = hand
        self._control = control
        self._earth = earth
        self._announce = announce
        self._readings = NO_READINGS

    def handle_message(self, link: LinkId, sender: Station, message: Message) -> Iterable[OutgoingMessage]:
        """Process a manual control message or a setpoint. There is no answer."""
        match message:
            case mav.MAVLink_manual_control_message():
                if message.target == self._system:
                    self._stick(sender, message)
            case mav.MAVLink_rc_channels_override_message():
                self._radio(sender, message)
            case (
                mav.MAVLink_set_position_target_local_ned_message()
                | mav.MAVLink_set_position_target_global_int_message()
            ):
                announce_denial(self._announce, self._setpoint(sender, message))
        return ()

    def step(self, tick: int, readings: RobotReadings) -> Iterable[OutgoingMessage]:
        """Store the readings. No messages are sent."""
        self._readings = readings
        return ()

    # -- manual control -----------------------------------------------------------------------------------------------

    def _stick(self, sender: Station, message: mav.MAVLink_manual_control_message) -> None:
        """Drive by MANUAL_CONTROL: x is forward. r is the turn. If there is no r, y is the turn.

        Positive values turn right. All ground stations send such values, although the standard describes r differently.
        """
        forward = message.x
        turn = message.y if message.r == _NO_AXIS else message.r
        if _NO_AXIS not in (forward, turn):
            self._drive(sender, forward / _FULL_STICK, turn / _FULL_STICK)

    def _radio(self, sender: Station, message: mav.MAVLink_rc_channels_override_message) -> None:
        """Drive by radio control. Channel 1 steers, and channel 3 is the throttle, as in ArduPilot's rovers."""
        steering, throttle = message.chan1_raw, message.chan3_raw
        if steering in _RC_RANGE or throttle in _RC_RANGE:
            turn, forward = (
                (value - _RC_MIDDLE) / _RC_FULL if value in _RC_RANGE else 0.0 for value in (steering, throttle)
            )
            self._drive(sender, forward, turn)
        elif _RC_RELEASED in (steering, throttle) and self._hand.is_driving:
            # The station no longer overrides the radio. There is no radio that could steer the robot, so it stops.
            self._drive(sender, 0.0, 0.0)

    def _drive(self, sender: Station, forward: float, turn: float) -> None:
        """Drive by hand. `forward` and `turn` (positive: right) are fractions of the speed limits."""
        if self._modes.mode is not Mode.MANUAL:
            return
        fastest = self._robot.fastest()
        twist = Twist(forward * fastest.linear, -turn * fastest.angular)
        announce_denial(self._announce, self._control.objection(sender) or self._hand.follow(twist))

    # -- setpoints ----------------------------------------------------------------------------------------------------

    def _setpoint(self, sender: Station, message: _Setpoint) -> Denied | None:
        if self._modes.mode is not Mode.GUIDED:
            return None
        objection = self._control.objection(sender)
        if objection is not None:
            return objection
        mask = message.type_mask
        yaw = None if mask & _IGNORE_YAW else message.yaw
        yaw_rate = 0.0 if mask & _IGNORE_YAW_RATE else message.yaw_rate
        if mask & _IGNORE_POSITION == 0:
            point = self._point(message)
            if point is None or not _all_finite(*point, yaw or 0.0):
                return Denied("This setpoint is none that the robot understands.")
            return self._modes.follow_target(Target(*point, None if yaw is None else theta_of(yaw)))
        velocity = self._velocity(message, yaw_rate)
        if velocity is None:
            return Denied("This setpoint is none that the robot understands.")
        return self._modes.follow_velocity(velocity)

    def _point(self, message: _Setpoint) -> tuple[float, float] | None:
        """Return the point of the map in a setpoint."""
        if isinstance(message, mav.MAVLink_set_position_target_global_int_message):
            if message.coordinate_frame not in GLOBAL:
                return None
            return self._earth.map_point(GeoPoint(message.lat_int, message.lon_int))
        if message.coordinate_frame not in LOCAL:
            return None
        return point_in_map(message.coordinate_frame, message.x, message.y, self._readings.base_in_map)

    def _velocity(self, message: _Setpoint, yaw_rate: float) -> VelocitySetpoint | None:
        """Return the velocity in a setpoint. A setpoint with only a yaw rate is a turn in place."""
        if message.type_mask & _IGNORE_VELOCITY == _IGNORE_VELOCITY:
            if message.type_mask & _IGNORE_YAW_RATE:
                return None
            velocity = VelocitySetpoint(mav.MAV_FRAME_BODY_FRD, 0.0, 0.0, yaw_rate)
        else:
            # In global frames, velocities are north and east, like the map's axes.
            frame = mav.MAV_FRAME_LOCAL_NED if message.coordinate_frame in GLOBAL else message.coordinate_frame
            velocity = VelocitySetpoint(frame, message.vx, message.vy, yaw_rate)
        is_one = velocity.frame in LOCAL and _all_finite(velocity.first, velocity.second, yaw_rate)
        return velocity if is_one else None


def _all_finite(*values: float) -> bool:
    return all(math.isfinite(value) for value in values)
