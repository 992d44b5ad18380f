"""Driving by hand: by sticks or velocities that are said again and again, and hold only for a moment.

Source: ArduPilot, Rover, `mode_guided.cpp` and the parameter RC_OVERRIDE_TIME, of its three seconds: scripts for it say
a velocity once a second.
"""

from dataclasses import dataclass

from sim.common.geometry import Pose2
from sim.common.observations import STANDSTILL, TICKS_PER_SECOND, Twist
from thbridge.wire.mavlink.coordinates import bounded, twist_towards
from thbridge.wire.mavlink.options import AutopilotIdentity
from thbridge.wire.mavlink.vehicle_interface import Denied, VehicleInterface

_DEADMAN = {AutopilotIdentity.GENERIC: TICKS_PER_SECOND // 2, AutopilotIdentity.ARDUPILOT: 3 * TICKS_PER_SECOND}
"""Ticks for which what a hand says holds."""


@dataclass(frozen=True, slots=True)
class VelocitySetpoint:
    """How fast the robot was told to move: see `coordinates.twist_towards`."""

    frame: int
    first: float
    second: float
    yaw_rate: float


class ManualControl:
    """The hand that drives one robot, if any.

    Args:
        helm: the robot.
        identity: whose autopilot it says it has.
    """

    def __init__(self, helm: VehicleInterface, identity: AutopilotIdentity) -> None:
        self._helm = helm
        self._deadman = _DEADMAN[identity]
        self._wanted: Twist | VelocitySetpoint | None = None
        self._until: int | None = None

    @property
    def drives(self) -> bool:
        """What it said last still holds."""
        return self._until is not None

    def follow(self, wanted: Twist | VelocitySetpoint, tick: int, base_in_map: Pose2) -> Denied | None:
        """Drive like this, at most as fast as a hand may; a velocity is steered to anew in each tick."""
        denied = self._steer(wanted, base_in_map)
        if denied is None:
            self._wanted, self._until = wanted, tick + self._deadman
        return denied

    def let_go(self) -> None:
        """It drives no more; the robot itself is not halted."""
        self._wanted = self._until = None

    def step(self, tick: int, base_in_map: Pose2) -> None:
        """A tick has passed: keep to what was said until it is too old; then stand still."""
        if self._until is None or self._wanted is None:
            return
        if tick >= self._until:
            self.let_go()
            self._helm.drive(STANDSTILL)
        else:
            self._steer(self._wanted, base_in_map)

    def _steer(self, wanted: Twist | VelocitySetpoint, base_in_map: Pose2) -> Denied | None:
        fastest = self._helm.fastest()
        if isinstance(wanted, Twist):
            return self._helm.drive(bounded(wanted, fastest))
        axes = (wanted.frame, wanted.first, wanted.second, wanted.yaw_rate)
        return self._helm.drive(twist_towards(*axes, base_in_map, fastest))
