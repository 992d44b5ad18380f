"""Robots of a game as MAVLink vehicles, with their pilots and their hub. The session steps them in each tick."""

from collections.abc import Callable, Sequence
from itertools import count
from typing import TypeAlias

from sim.common.robot_numbers import number_of
from sim.snapshot import TeamSnapshot
from thbridge.hunt.game import GameState
from thbridge.mavlink.hub import Hub
from thbridge.mavlink.role.pilot import Pilot
from thbridge.mavlink.values.options import VehicleOptions
from thbridge.mavlink.vehicle.vehicle import Vehicle
from thbridge.mavlink.wire.outgoing import LinkId, VehicleStatus
from thbridge.mavlink.wire.traffic import OutgoingFrame
from thbridge.roles.shared.robot_requests import Request

RequestSink: TypeAlias = Callable[[Request], None]
"""Function that queues a request to the robots and the game for the next tick."""


class Vehicles:
    """All vehicles of a team, and the links to them.

    Args:
        pilots: pilots of the robots, in the team's order.
        options: options of the study.

    Attributes:
        hub: router of the frames of open links.
    """

    def __init__(self, pilots: Sequence[Pilot], options: VehicleOptions) -> None:
        self._pilots = tuple(pilots)
        systems = [Vehicle(number_of(robot), pilot, options) for robot, pilot in enumerate(pilots)]
        self.hub = Hub(systems, options.lost_after)
        self._numbers = count()

    @property
    def statuses(self) -> tuple[VehicleStatus, ...]:
        """Status of each vehicle."""
        return tuple(vehicle.status for vehicle in self.hub.vehicles)

    def open(self, name: str, robot: int | None) -> LinkId:
        """Open a link of this name with a new number. See `Hub.open`."""
        link = LinkId(next(self._numbers))
        self.hub.open(link, name, robot)
        return link

    def step(self, snapshot: TeamSnapshot, game: GameState | None) -> list[OutgoingFrame]:
        """Update after a tick of the robots and the game, and return the frames that vehicles send."""
        readings = [pilot.follow(snapshot, game) for pilot in self._pilots]
        return self.hub.step(snapshot.tick, readings)
