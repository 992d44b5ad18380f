"""Telemetry messages of a vehicle. They contain its robot's own estimates."""

import math
from collections.abc import Callable
from dataclasses import dataclass

from sim.common.observations import TICKS_PER_SECOND
from sim.numerics import elementary
from thbridge.mavlink.values.conventions import COMMANDER
from thbridge.mavlink.values.options import AutopilotIdentity
from thbridge.mavlink.values.vehicle_interface import RobotReadings
from thbridge.mavlink.vehicle.boot_time import microseconds, milliseconds
from thbridge.mavlink.vehicle.geodesy import MapProjection
from thbridge.mavlink.vehicle.telemetry.capabilities import Capabilities
from thbridge.mavlink.vehicle.telemetry.streams import OFF
from thbridge.mavlink.wire.coordinates import compass, north_east, quaternion, yaw_of
from thbridge.mavlink.wire.dialect import Message, mav
from thbridge.mavlink.wire.extra_messages import ComponentInformation, ComponentMetadata, ProtocolVersion
from thbridge.mavlink.wire.mode_numbers import Mode, custom_mode, standard_mode

_UNKNOWN_16 = 0xFFFF
_POSITION_ONLY = 0x0DF8
"""Type mask of a target: ignore velocity, acceleration, yaw and yaw rate."""

_KNOWS_WHERE = mav.MAV_SYS_STATUS_SENSOR_GPS | mav.MAV_SYS_STATUS_AHRS | mav.MAV_SYS_STATUS_SENSOR_XY_POSITION_CONTROL
_SENSORS = (
    # Ground stations consider a vehicle ready if it reports a healthy gyroscope, accelerometer and compass.
    mav.MAV_SYS_STATUS_SENSOR_3D_GYRO
    | mav.MAV_SYS_STATUS_SENSOR_3D_ACCEL
    | mav.MAV_SYS_STATUS_SENSOR_3D_MAG
    | mav.MAV_SYS_STATUS_SENSOR_LASER_POSITION
    | mav.MAV_SYS_STATUS_SENSOR_ANGULAR_RATE_CONTROL
    | mav.MAV_SYS_STATUS_SENSOR_YAW_POSITION
    | mav.MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS
    | mav.MAV_SYS_STATUS_SENSOR_BATTERY
    | mav.MAV_SYS_STATUS_PREARM_CHECK
    | _KNOWS_WHERE
)

_KNOWS_HOW_IT_MOVES = mav.EKF_ATTITUDE | mav.EKF_VELOCITY_HORIZ | mav.EKF_VELOCITY_VERT
_KNOWS_ITS_PLACE = (
    mav.EKF_POS_HORIZ_REL
    | mav.EKF_POS_HORIZ_ABS
    | mav.EKF_POS_VERT_ABS
    | mav.EKF_PRED_POS_HORIZ_REL
    | mav.EKF_PRED_POS_HORIZ_ABS
)
"""Flags of a good estimate in ArduPilot. DroneKit reports a vehicle as armable only after the last of these flags."""

_SATELLITES = 12
_ACCURACY = 50
"""Accuracy of position and velocity in mm and mm/s. This is typical of the robots' estimates indoors."""


@dataclass(frozen=True, slots=True)
class TelemetryState:
    """State of a vehicle after a tick. Its messages are made from this state.

    Attributes:
        tick: number of the tick.
        readings: readings of its robot.
        mode: mode for ground stations.
        armed: True if a station commands the robot, or the robot moves.
        commander: see `OperatorControl.commander_id`.
    """

    tick: int
    readings: RobotReadings
    mode: Mode
    armed: bool
    commander: int

    @property
    def milliseconds(self) -> int:
        """Simulated time since the session began, milliseconds."""
        return milliseconds(self.tick)

    @property
    def system_status(self) -> int:
        """State of the vehicle, a code of MAV_STATE."""
        if self.readings.lost:
            return mav.MAV_STATE_CRITICAL
        return mav.MAV_STATE_ACTIVE if self.armed else mav.MAV_STATE_STANDBY


def default_streams(position_rate: float, identity: AutopilotIdentity) -> dict[int, int]:
    """Return the interval of each message that can be requested, ticks.

    Args:
        position_rate: rate of position, attitude and speed, Hz.
        identity: autopilot that the vehicle claims to have.
    """
    often = max(1, round(TICKS_PER_SECOND / position_rate)) if position_rate > 0.0 else OFF
    return {
        mav.MAVLINK_MSG_ID_HEARTBEAT: TICKS_PER_SECOND,
        mav.MAVLINK_MSG_ID_SYS_STATUS: TICKS_PER_SECOND,
        mav.MAVLINK_MSG_ID_SYSTEM_TIME: TICKS_PER_SECOND,
        mav.MAVLINK_MSG_ID_GPS_RAW_INT: TICKS_PER_SECOND,
        mav.MAVLINK_MSG_ID_MISSION_CURRENT: TICKS_PER_SECOND,
        mav.MAVLINK_MSG_ID_BATTERY_STATUS: TICKS_PER_SECOND,
        mav.MAVLINK_MSG_ID_NAMED_VALUE_INT: TICKS_PER_SECOND,
        # This message is specific to ArduPilot.
        mav.MAVLINK_MSG_ID_EKF_STATUS_REPORT: TICKS_PER_SECOND if identity is AutopilotIdentity.ARDUPILOT else OFF,
        mav.MAVLINK_MSG_ID_ATTITUDE: often,
        mav.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: often,
        mav.MAVLINK_MSG_ID_LOCAL_POSITION_NED: often,
        mav.MAVLINK_MSG_ID_VFR_HUD: often,
        mav.MAVLINK_MSG_ID_ATTITUDE_QUATERNION: OFF,
        mav.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN: OFF,
        mav.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT: OFF,
        mav.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED: OFF,
        mav.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT: OFF,
        mav.MAVLINK_MSG_ID_AUTOPILOT_VERSION: OFF,
        mav.MAVLINK_MSG_ID_HOME_POSITION: OFF,
        mav.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: OFF,
        ProtocolVersion.id: OFF,
        ComponentInformation.id: OFF,
        ComponentMetadata.id: OFF,
        mav.MAVLINK_MSG_ID_CURRENT_MODE: OFF,
        mav.MAVLINK_MSG_ID_AVAILABLE_MODES_MONITOR: OFF,
    }


class Telemetry:
    """Messages of one vehicle.

    Args:
        capabilities: its constant messages.
        identity: autopilot that it claims to have.
        earth: map projection.
        home_position: returns HOME_POSITION for a tick.
        mission_current: returns MISSION_CURRENT.
    """

    def __init__(
        self,
        capabilities: Capabilities,
        identity: AutopilotIdentity,
        earth: MapProjection,
        home_position: Callable[[int], Message],
        mission_current: Callable[[], Message],
    ) -> None:
        self._identity = identity
        self._earth = earth
        self._altitude = round(earth.altitude * 1000.0)
        self._capabilities = capabilities.makers()
        self._makers: dict[int, Callable[[TelemetryState], Message | None]] = {
            mav.MAVLINK_MSG_ID_HEARTBEAT: self._heartbeat,
            mav.MAVLINK_MSG_ID_SYS_STATUS: self._sys_status,
            # Simulated time is not the time of day. So the first field, Unix time, stays unknown.
            mav.MAVLINK_MSG_ID_SYSTEM_TIME: lambda now: mav.MAVLink_system_time_message(0, now.milliseconds),
            mav.MAVLINK_MSG_ID_GPS_RAW_INT: self._gps_raw_int,
            mav.MAVLINK_MSG_ID_MISSION_CURRENT: lambda _: mission_current(),
            mav.MAVLINK_MSG_ID_BATTERY_STATUS: self._battery_status,
            mav.MAVLINK_MSG_ID_NAMED_VALUE_INT: lambda now: mav.MAVLink_named_value_int_message(
                now.milliseconds, COMMANDER.encode(), now.commander
            ),
            mav.MAVLINK_MSG_ID_EKF_STATUS_REPORT: self._ekf_status_report,
            mav.MAVLINK_MSG_ID_ATTITUDE: self._attitude,
            mav.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: self._global_position_int,
            mav.MAVLINK_MSG_ID_LOCAL_POSITION_NED: self._local_position_ned,
            mav.MAVLINK_MSG_ID_VFR_HUD: self._vfr_hud,
            mav.MAVLINK_MSG_ID_ATTITUDE_QUATERNION: self._attitude_quaternion,
            mav.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT: self._nav_controller_output,
            mav.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED: self._position_target_local_ned,
            mav.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT: self._position_target_global_int,
            mav.MAVLINK_MSG_ID_HOME_POSITION: lambda now: home_position(now.tick),
            mav.MAVLINK_MSG_ID_CURRENT_MODE: self._current_mode,
        }

    def message(self, number: int, state: TelemetryState) -> Message | None:
        """Return a message of `default_streams`, or None if it has no content, such as the goal of a resting robot."""
        constant = self._capabilities.get(number)
        return self._makers[number](state) if constant is None else constant(state.tick)

    def _heartbeat(self, now: TelemetryState) -> Message:
        ardupilot = self._identity is AutopilotIdentity.ARDUPILOT
        return mav.MAVLink_heartbeat_message(
            mav.MAV_TYPE_GROUND_ROVER,
            mav.MAV_AUTOPILOT_ARDUPILOTMEGA if ardupilot else mav.MAV_AUTOPILOT_GENERIC,
            base_mode(now),
            custom_mode(self._identity, now.mode),
            now.system_status,
            3,
        )

    def _sys_status(self, now: TelemetryState) -> Message:
        # There is no fence. But MAVProxy reports a breach of a fence that is not healthy, even if it is not present.
        healthy = (_SENSORS & ~_KNOWS_WHERE if now.readings.lost else _SENSORS) | mav.MAV_SYS_STATUS_GEOFENCE
        remaining = _remaining(now.readings)
        return mav.MAVLink_sys_status_message(
            _SENSORS, _SENSORS, healthy, 0, _UNKNOWN_16, -1, remaining, 0, 0, 0, 0, 0, 0
        )

    def _battery_status(self, now: TelemetryState) -> Message:
        remaining = _remaining(now.readings)
        if remaining > 20:
            charge = mav.MAV_BATTERY_CHARGE_STATE_OK
        elif remaining > 0:
            charge = mav.MAV_BATTERY_CHARGE_STATE_LOW
        else:
            charge = mav.MAV_BATTERY_CHARGE_STATE_CRITICAL
        whole, no_voltages = mav.MAV_BATTERY_FUNCTION_ALL, [_UNKNOWN_16] * 10
        kind = mav.MAV_BATTERY_TYPE_UNKNOWN
        return mav.MAVLink_battery_status_message(
            0, whole, kind, 0x7FFF, no_voltages, -1, -1, -1, remaining, 0, charge, [0, 0, 0, 0], 0, 0
        )

    def _ekf_status_report(self, now: TelemetryState) -> Message:
        flags = _KNOWS_HOW_IT_MOVES if now.readings.lost else _KNOWS_HOW_IT_MOVES | _KNOWS_ITS_PLACE
        return mav.MAVLink_ekf_status_report_message(flags, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

    def _gps_raw_int(self, now: TelemetryState) -> Message:
        pose, twist = now.readings.base_in_map, now.readings.twist
        place = self._earth.geo_point(pose.x, pose.y)
        fix = mav.GPS_FIX_TYPE_NO_FIX if now.readings.lost else mav.GPS_FIX_TYPE_3D_FIX
        heading = _hundredths(compass(pose.theta))
        # A robot that backs up moves opposite to its heading.
        course = heading if twist.linear >= 0.0 else (heading + 18_000) % 36_000
        # In this message a yaw of 0 means "not available", so north is 36000.
        return mav.MAVLink_gps_raw_int_message(
            microseconds(now.tick),
            fix,
            place.latitude,
            place.longitude,
            self._altitude,
            100,
            100,
            _within(abs(twist.linear) * 100.0, 0, _UNKNOWN_16 - 1),
            course,
            _SATELLITES,
            self._altitude,
            _ACCURACY,
            _ACCURACY,
            _ACCURACY,
            0,
            heading or 36_000,
        )

    def _attitude(self, now: TelemetryState) -> Message:
        # MAVLink's z axis points down, so a turn to the right is positive.
        yaw, rate = yaw_of(now.readings.base_in_map.theta), -now.readings.twist.angular
        return mav.MAVLink_attitude_message(now.milliseconds, 0.0, 0.0, yaw, 0.0, 0.0, rate)

    def _attitude_quaternion(self, now: TelemetryState) -> Message:
        q, rate = quaternion(now.readings.base_in_map.theta), -now.readings.twist.angular
        return mav.MAVLink_attitude_quaternion_message(now.milliseconds, *q, 0.0, 0.0, rate)

    def _global_position_int(self, now: TelemetryState) -> Message:
        pose = now.readings.base_in_map
        place, (north, east) = self._earth.geo_point(pose.x, pose.y), north_east(now.readings.twist, pose.theta)
        speeds = (_centimetres(north), _centimetres(east), 0)
        heading = _hundredths(compass(pose.theta))
        where = (place.latitude, place.longitude, self._altitude, 0)
        return mav.MAVLink_global_position_int_message(now.milliseconds, *where, *speeds, heading)

    def _local_position_ned(self, now: TelemetryState) -> Message:
        pose = now.readings.base_in_map
        north, east = north_east(now.readings.twist, pose.theta)
        return mav.MAVLink_local_position_ned_message(now.milliseconds, pose.y, pose.x, 0.0, north, east, 0.0)

    def _vfr_hud(self, now: TelemetryState) -> Message:
        speed = abs(now.readings.twist.linear)
        heading = int(compass(now.readings.base_in_map.theta))
        return mav.MAVLink_vfr_hud_message(0.0, speed, heading, 0, self._earth.altitude, 0.0)

    def _nav_controller_output(self, now: TelemetryState) -> Message | None:
        goal, pose, leg = now.readings.goal_in_map, now.readings.base_in_map, now.readings.leg
        if goal is None:
            return None
        bearing = round(compass(elementary.atan2(goal.y - pose.y, goal.x - pose.x)))
        remaining = pose.distance(goal) if leg is None else leg.remaining
        metres = _within(remaining, 0, _UNKNOWN_16)
        return mav.MAVLink_nav_controller_output_message(0.0, 0.0, bearing, bearing, metres, 0.0, 0.0, 0.0)

    def _position_target_local_ned(self, now: TelemetryState) -> Message | None:
        goal = now.readings.goal_in_map
        if goal is None:
            return None
        frame, nothing = mav.MAV_FRAME_LOCAL_NED, (0.0,) * 6
        where = (goal.y, goal.x, 0.0)
        return mav.MAVLink_position_target_local_ned_message(
            now.milliseconds, frame, _POSITION_ONLY, *where, *nothing, 0.0, 0.0
        )

    def _position_target_global_int(self, now: TelemetryState) -> Message | None:
        goal = now.readings.goal_in_map
        if goal is None:
            return None
        place, frame, nothing = self._earth.geo_point(goal.x, goal.y), mav.MAV_FRAME_GLOBAL_INT, (0.0,) * 6
        where = (place.latitude, place.longitude, self._earth.altitude)
        return mav.MAVLink_position_target_global_int_message(
            now.milliseconds, frame, _POSITION_ONLY, *where, *nothing, 0.0, 0.0
        )

    def _current_mode(self, now: TelemetryState) -> Message:
        custom = custom_mode(self._identity, now.mode)
        return mav.MAVLink_current_mode_message(standard_mode(now.mode), custom, custom)


def base_mode(now: TelemetryState) -> int:
    """Return the bits of MAV_MODE_FLAG."""
    bits: int = mav.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
    if now.armed:
        bits |= mav.MAV_MODE_FLAG_SAFETY_ARMED
    match now.mode:
        case Mode.MANUAL:
            bits |= mav.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED
        case Mode.GUIDED:
            bits |= mav.MAV_MODE_FLAG_GUIDED_ENABLED
        case Mode.AUTO | Mode.RETURN:
            bits |= mav.MAV_MODE_FLAG_GUIDED_ENABLED | mav.MAV_MODE_FLAG_AUTO_ENABLED
    return bits


def _remaining(readings: RobotReadings) -> int:
    """Return the remaining energy in percent, or -1 if it is unlimited or unknown."""
    if not 0.0 < readings.capacity < math.inf:
        return -1
    return _within(100.0 * readings.energy / readings.capacity, 0, 100)


def _within(value: float, low: int, high: int) -> int:
    """Return the nearest whole number from `low` to `high`."""
    return round(max(low, min(value, high)))


def _centimetres(speed: float) -> int:
    return _within(100.0 * speed, -0x7FFF, 0x7FFF)


def _hundredths(degrees: float) -> int:
    """Convert a compass heading to hundredths of a degree, from 0 to 35999."""
    return round(degrees * 100.0) % 36_000
