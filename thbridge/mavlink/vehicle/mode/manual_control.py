"""Manual control by stick positions or velocities. Stations repeat them. Each is valid only for a short time.

Source of the three seconds: ArduPilot, Rover, `mode_guided.cpp` and the parameter RC_OVERRIDE_TIME. Scripts for
ArduPilot send a velocity once per second.
"""

from dataclasses import dataclass

from sim.common.geometry import IDENTITY, Pose2
from sim.common.observations import STANDSTILL, TICKS_PER_SECOND, Twist
from thbridge.mavlink.values.options import AutopilotIdentity
from thbridge.mavlink.values.vehicle_interface import Denied, VehicleInterface
from thbridge.mavlink.wire.coordinates import bounded, twist_towards

_DEADMAN = {AutopilotIdentity.GENERIC: TICKS_PER_SECOND // 2, AutopilotIdentity.ARDUPILOT: 3 * TICKS_PER_SECOND}
"""Ticks for which a command by hand is valid."""


@dataclass(frozen=True, slots=True)
class VelocitySetpoint:
    """Velocity setpoint. See `coordinates.twist_towards` for its fields."""

    frame: int
    first: float
    second: float
    yaw_rate: float


class ManualControl:
    """Manual control of one robot.

    Args:
        robot: interface to the robot.
        identity: autopilot that the vehicle claims to have.
    """

    def __init__(self, robot: VehicleInterface, identity: AutopilotIdentity) -> None:
        self._robot = robot
        self._deadman = _DEADMAN[identity]
        self._wanted: Twist | VelocitySetpoint | None = None
        self._until: int | None = None
        self._tick = 0
        self._base_in_map = IDENTITY

    @property
    def is_driving(self) -> bool:
        """True while the last command is valid."""
        return self._until is not None

    def follow(self, wanted: Twist | VelocitySetpoint) -> Denied | None:
        """Drive as commanded, within the speed limits. In each tick, a velocity is converted to a twist again."""
        denied = self._steer(wanted)
        if denied is None:
            self._wanted, self._until = wanted, self._tick + self._deadman
        return denied

    def release_control(self) -> None:
        """Forget the last command without stopping the robot."""
        self._wanted = self._until = None

    def step(self, tick: int, base_in_map: Pose2) -> None:
        """Follow the last command. If the command is too old, stop the robot."""
        self._tick, self._base_in_map = tick, base_in_map
        if self._until is None or self._wanted is None:
            return
        if tick >= self._until:
            self.release_control()
            self._robot.drive(STANDSTILL)
        else:
            # A robot drives by hand for half a second only, and a velocity in the map depends on the robot's heading.
            self._steer(self._wanted)

    def _steer(self, wanted: Twist | VelocitySetpoint) -> Denied | None:
        fastest = self._robot.fastest()
        if isinstance(wanted, Twist):
            return self._robot.drive(bounded(wanted, fastest))
        axes = (wanted.frame, wanted.first, wanted.second, wanted.yaw_rate)
        return self._robot.drive(twist_towards(*axes, self._base_in_map, fastest))
