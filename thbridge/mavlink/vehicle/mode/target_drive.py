"""Drive to a target for a mode. It is a leg of the robot, and the number of this leg identifies it."""

from thbridge.mavlink.values.conventions import ARRIVED
from thbridge.mavlink.values.vehicle_interface import NO_READINGS, HelmLeg, LegState, RobotReadings, Target
from thbridge.mavlink.vehicle.parts import Announce, TextSeverity


class TargetDrive:
    """Last drive to a target that the mode of a robot started.

    Args:
        announce: sends texts to people.

    Attributes:
        number: number of its leg. None if there was no drive or it was aborted.
        target: its goal. None if there was no drive or it was aborted.
    """

    def __init__(self, announce: Announce) -> None:
        self._announce = announce
        self._readings = NO_READINGS
        self.number: int | None = None
        self.target: Target | None = None

    @property
    def leg(self) -> HelmLeg | None:
        """Progress of the drive. None if another leg has replaced it."""
        leg = self._readings.leg
        return leg if leg is not None and leg.number == self.number else None

    @property
    def is_under_way(self) -> bool:
        """True from the request of the drive to its end. The readings show a new leg some ticks after the request."""
        leg = self.leg
        return self.number is not None and (leg is None or leg.state is LegState.UNDER_WAY)

    def leads_to(self, target: Target) -> bool:
        """Return True if the drive has this target and has not failed."""
        leg = self.leg
        return target == self.target and (leg is None or leg.state is not LegState.FAILED)

    def begin(self, number: int, target: Target) -> None:
        """Store the leg that leads to a target."""
        self.number, self.target = number, target

    def abort(self) -> None:
        """Forget the leg without stopping the robot."""
        self.number = self.target = None

    def step(self, readings: RobotReadings) -> None:
        """Advance by one tick, and announce the end of the drive."""
        before = self.leg
        self._readings = readings
        now = self.leg
        if now is None or now.state is LegState.UNDER_WAY or now == before:
            return
        if now.state is LegState.ARRIVED:
            self._announce(TextSeverity.INFO, ARRIVED)
        else:
            self._announce(TextSeverity.WARNING, now.reason or "The robot did not get there.")
