"""Driving by hand: by sticks or velocities that are said again and again, and hold only for a moment."""

from dataclasses import dataclass

from sim.geometry import Pose2
from sim.observations import STANDSTILL, TICKS_PER_SECOND, Twist
from thbridge.wire.mavlink.coordinates import bounded, twist_towards
from thbridge.wire.mavlink.helm import Denied, Helm

DEADMAN = TICKS_PER_SECOND // 2
"""Ticks for which what a hand says holds."""


@dataclass(frozen=True, slots=True)
class Velocity:
    """How fast the robot was told to move: see `coordinates.twist_towards`."""

    frame: int
    first: float
    second: float
    yaw_rate: float


class Hand:
    """The hand that drives one robot, if any.

    Args:
        helm: the robot.
    """

    def __init__(self, helm: Helm) -> None:
        self._helm = helm
        self._velocity: Velocity | None = None
        self._until: int | None = None

    @property
    def drives(self) -> bool:
        """What it said last still holds."""
        return self._until is not None

    def drive(self, twist: Twist, tick: int) -> Denied | None:
        """Drive like this, at most as fast as a hand may."""
        self._until = tick + DEADMAN
        return self._helm.drive(bounded(twist, self._helm.fastest()))

    def follow(self, velocity: Velocity, tick: int, base_in_map: Pose2) -> Denied | None:
        """Drive at a velocity, which the robot steers to anew in each tick."""
        denied = self._steer(velocity, base_in_map)
        if denied is None:
            self._velocity, self._until = velocity, tick + DEADMAN
        return denied

    def let_go(self) -> None:
        """It drives no more; the robot itself is not halted."""
        self._velocity = self._until = None

    def step(self, tick: int, base_in_map: Pose2) -> None:
        """A tick has passed: keep to a velocity until it is too old; then stand still."""
        if self._until is None:
            return
        if tick >= self._until:
            self.let_go()
            self._helm.drive(STANDSTILL)
        elif self._velocity is not None:
            self._steer(self._velocity, base_in_map)

    def _steer(self, velocity: Velocity, base_in_map: Pose2) -> Denied | None:
        return self._helm.drive(
            twist_towards(
                velocity.frame,
                velocity.first,
                velocity.second,
                velocity.yaw_rate,
                base_in_map,
                self._helm.fastest(),
            )
        )
