"""The robots of a game as MAVLink vehicles: their hub, stepped with the session, and their pilots."""

from collections.abc import Callable, Sequence
from itertools import count
from typing import Protocol, TypeAlias

from sim.common.robot_numbers import number_of
from sim.team import TeamSnapshot
from thbridge.hunt.game import GameState
from thbridge.protocols.mavlink.frames.frame import Frame
from thbridge.protocols.mavlink.hub import Hub
from thbridge.protocols.mavlink.links import LinkReport
from thbridge.protocols.mavlink.options import VehicleOptions
from thbridge.protocols.mavlink.outgoing import LinkId, VehicleStatus
from thbridge.protocols.mavlink.traffic import FrameOutcome, OutgoingFrame, Traffic
from thbridge.protocols.mavlink.vehicle.vehicle import Vehicle
from thbridge.protocols.mavlink.vehicle_interface import RobotReadings, VehicleInterface
from thbridge.roles.robot_requests import Request

RequestSink: TypeAlias = Callable[[Request], None]
"""Takes requests to robots and game for the next tick."""


class VehiclePilot(VehicleInterface, Protocol):
    """A vehicle interface that follows robot and game."""

    def follow(self, snapshot: TeamSnapshot, game: GameState | None) -> RobotReadings:
        """Update after a tick, and return the robot's readings."""


class Vehicles:
    """All vehicles of a team, and the links to them.

    Args:
        pilots: one for each robot, in the team's order.
        options: of the study.
    """

    def __init__(self, pilots: Sequence[VehiclePilot], options: VehicleOptions) -> None:
        self._pilots = tuple(pilots)
        systems = [Vehicle(number_of(robot), pilot, options) for robot, pilot in enumerate(pilots)]
        self._hub = Hub(systems, options.lost_after)
        self._numbers = count()

    @property
    def statuses(self) -> tuple[VehicleStatus, ...]:
        """Status of each vehicle."""
        return tuple(vehicle.status for vehicle in self._hub.vehicles)

    def open(self, name: str, robot: int | None) -> LinkId:
        """Open a link of this name; its number was never used before. See `Hub.open`."""
        link = LinkId(next(self._numbers))
        self._hub.open(link, name, robot)
        return link

    def close(self, link: LinkId) -> None:
        """Close an open link."""
        self._hub.close(link)

    def name_of(self, link: LinkId) -> str | None:
        """See `Hub.name_of`."""
        return self._hub.name_of(link)

    def report(self, link: LinkId) -> LinkReport | None:
        """See `Hub.report`."""
        return self._hub.report(link)

    def receive(self, link: LinkId, frame: Frame, robot: int | None) -> FrameOutcome:
        """See `Hub.receive`; a frame for a robot that does not exist has no effect."""
        if robot is not None and not 0 <= robot < len(self._pilots):
            return FrameOutcome()
        return self._hub.receive(link, frame, robot)

    def step(self, snapshot: TeamSnapshot, game: GameState | None) -> list[OutgoingFrame]:
        """Update after a tick of robots and game, and return the frames that vehicles send by themselves."""
        readings = [pilot.follow(snapshot, game) for pilot in self._pilots]
        return self._hub.step(snapshot.tick, readings)

    def keep_alive(self) -> list[OutgoingFrame]:
        """See `Hub.keep_alive`."""
        return self._hub.keep_alive()

    def take_traffic(self) -> tuple[Traffic, ...]:
        """Return the frames that vehicles received and sent since the last call, in order."""
        return self._hub.take_traffic()
