"""Robot that gives the answers that a test sets, and records the requests of its helm."""

from dataclasses import dataclass, field, replace

from sim.common.geometry import Pose2
from sim.common.observations import Twist
from thbridge.mavlink.values.vehicle_interface import (
    Denied,
    HelmLeg,
    LegState,
    ParameterDescription,
    ParameterSetting,
    RobotReadings,
)

AT_REST = RobotReadings(
    base_in_map=Pose2(1.0, 2.0, 0.0),
    twist=Twist(0.0, 0.0),
    goal_in_map=None,
    energy=100.0,
    capacity=100.0,
    responsive=True,
    lost=False,
    under_way=False,
    commander=None,
    commanded_by="participant",
    leg=None,
)


@dataclass
class ModelRobot:
    """Robot whose legs end when a test ends them; it grants every other request unless `refusal` is set.

    Attributes:
        asked: calls that change something, in order.
        refusal: answer to the next calls. If None, they are granted.
        values: values of its parameters, by name.
        readings: readings that it reports.
        barred: denials of unreachable places, by meters east and north.
    """

    asked: list[tuple] = field(default_factory=list)
    refusal: Denied | None = None
    values: dict[str, float] = field(default_factory=lambda: {f"PARAM_{n:02}": n / 2 for n in range(20)})
    readings: RobotReadings = AT_REST
    barred: dict[tuple[int, int], Denied] = field(default_factory=dict)

    def arrive(self):
        """End the current leg as arrived."""
        self.readings = replace(self.readings, leg=replace(self.readings.leg, state=LegState.ARRIVED))

    def fail(self, reason):
        """End the current leg as failed."""
        self.readings = replace(self.readings, leg=replace(self.readings.leg, state=LegState.FAILED, reason=reason))

    def _done(self, *call):
        self.asked.append(call)
        return self.refusal

    def take(self, station):
        return self._done("take", station)

    def release(self):
        self._done("release")

    def go_to(self, target):
        if self._done("go_to", round(target.x, 2), round(target.y, 2), target.heading):
            return self.refusal
        leg = self.readings.leg
        number = 1 if leg is None else leg.number + 1
        self.readings = replace(self.readings, leg=HelmLeg(number, LegState.UNDER_WAY, 1.0))
        return number

    def stop_robot(self):
        self._done("halt")

    def drive(self, twist):
        return self._done("drive", twist)

    def fastest(self):
        return Twist(1.0, 1.0)

    def limit_speed(self, speed):
        return self._done("limit_speed", speed)

    def start(self):
        return Pose2(1.0, 2.0, 0.0)

    @property
    def parameters(self):
        return self

    def descriptions(self):
        return [ParameterDescription(name, "a number", "", "robot", "tests", default=0.0) for name in self.values]

    def misplaced(self, x, y):
        return None if max(abs(x), abs(y)) < 20.0 else Denied("There the map has nothing.")

    def unreachable(self, x, y):
        return self.barred.get((round(x), round(y)))

    def settings(self):
        return [ParameterSetting(name, value) for name, value in self.values.items()]

    def setting(self, name):
        return ParameterSetting(name, self.values[name]) if name in self.values else None

    def change(self, name, value):
        if self._done("change", name, value):
            return self.refusal
        self.values[name] = value
        return ParameterSetting(name, value)

    def photograph(self):
        return self._done("photograph")

    def identify(self, number):
        return self._done("identify", number)

    def leave(self):
        return self._done("leave")
