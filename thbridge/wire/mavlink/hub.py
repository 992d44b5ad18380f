"""Joins vehicles and links: who is reached where, what is meant for whom, and the count of each sender on each link.

The rules of routing are MAVLink's: what names no target goes to everybody; what names one goes to where its target was
heard from, and nowhere else; nothing goes back to the link that it came from.

Source: the MAVLink developer guide, "Routing".
"""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from sim.observations import TICKS_PER_SECOND
from thbridge.wire.mavlink.dialect import EVERYBODY, Message, crc_extra, decoded, payload_of, target_of
from thbridge.wire.mavlink.frame import Frame
from thbridge.wire.mavlink.helm import Readings, Station
from thbridge.wire.mavlink.said import COMPONENT, LinkId, Said
from thbridge.wire.mavlink.vehicle import Vehicle


@dataclass(frozen=True, slots=True)
class Sent:
    """A frame that goes out on a link."""

    link: LinkId
    frame: Frame


@dataclass(frozen=True, slots=True)
class Traffic:
    """A frame that a vehicle heard or said.

    Attributes:
        robot: which vehicle's, from 0.
        heard: whether it heard it; or else it said it.
        link: the name of the link.
        frame: without its signature.
    """

    robot: int
    heard: bool
    link: str
    frame: Frame


@dataclass(slots=True)
class _Link:
    """What the hub knows of a link: its name, and the tick in which it was last heard, if it ever was."""

    name: str
    heard: int | None = None


class Hub:
    """The vehicles of one team and all links to them.

    Args:
        vehicles: in the team's order.
        patience: seconds without a frame after which a link counts as asleep: it gets heartbeats and nothing else.
    """

    def __init__(self, vehicles: Sequence[Vehicle], patience: float) -> None:
        self._vehicles = tuple(vehicles)
        self._by_system = {vehicle.system: robot for robot, vehicle in enumerate(vehicles)}
        self._patience = round(patience * TICKS_PER_SECOND)
        self._links: dict[LinkId, _Link] = {}
        self._routes: dict[Station, LinkId] = {}
        self._counts: defaultdict[tuple[LinkId, int], int] = defaultdict(int)
        self._traffic: list[Traffic] = []
        self._tick = 0

    @property
    def vehicles(self) -> tuple[Vehicle, ...]:
        """In the team's order."""
        return self._vehicles

    def open(self, link: LinkId, name: str) -> None:
        """From now on there is this link; one of the same number is closed before."""
        self.close(link)
        self._links[link] = _Link(name)

    def close(self, link: LinkId) -> None:
        """A link is gone, and whoever was reached by it."""
        if self._links.pop(link, None) is None:
            return
        self._routes = {station: there for station, there in self._routes.items() if there != link}
        for vehicle in self._vehicles:
            self._counts.pop((link, vehicle.system), None)
            vehicle.forget(link)

    def receive(self, link: LinkId, frame: Frame, robot: int | None = None) -> list[Sent]:
        """A frame has come in.

        Args:
            link: where; an unknown one is ignored.
            frame: checked, and without its signature.
            robot: the only vehicle that is to hear it; None: whoever it is meant for.

        Returns:
            What goes out at once.
        """
        there = self._links.get(link)
        message = decoded(frame.message_id, frame.payload)
        if there is None or message is None or frame.system in self._by_system:
            return []
        there.heard = self._tick
        sender = Station(frame.system, frame.component)
        self._routes[sender] = link
        system, component = target_of(message)
        sent: list[Sent] = []
        for number in self._meant(system, component) if robot is None else (robot,):
            self._traffic.append(Traffic(number, True, there.name, frame))
            sent += self._said(number, self._vehicles[number].hear(link, sender, message))
        if robot is None and system not in self._by_system:
            sent += [Sent(other, frame) for other in self._beyond(link, system, component)]
        return sent

    def step(self, tick: int, readings: Sequence[Readings]) -> list[Sent]:
        """A tick has passed: what vehicles say by themselves.

        Args:
            tick: which.
            readings: of each robot, in the team's order.
        """
        self._tick = tick
        sent: list[Sent] = []
        for robot, (vehicle, reading) in enumerate(zip(self._vehicles, readings, strict=True)):
            sent += self._said(robot, vehicle.step(tick, reading))
        return sent

    def take_traffic(self) -> tuple[Traffic, ...]:
        """What vehicles heard and said since the last call, in order."""
        traffic, self._traffic = tuple(self._traffic), []
        return traffic

    def _meant(self, system: int, component: int) -> Iterable[int]:
        """The vehicles that a message with this target is meant for."""
        if component not in (EVERYBODY, COMPONENT):
            return ()
        if system == EVERYBODY:
            return range(len(self._vehicles))
        robot = self._by_system.get(system)
        return () if robot is None else (robot,)

    def _beyond(self, link: LinkId, system: int, component: int) -> Iterable[LinkId]:
        """The other links that a message with this target goes on to."""
        if system == EVERYBODY:
            return [other for other in self._links if other != link]
        there = {
            route
            for station, route in self._routes.items()
            if station.system == system and component in (EVERYBODY, station.component)
        }
        return sorted(there - {link})

    def _said(self, robot: int, said: Iterable[Said]) -> list[Sent]:
        sent: list[Sent] = []
        for word in said:
            payload = payload_of(word.message)
            for link in self._reached(word):
                frame = self._frame(link, robot, word.message, payload)
                self._traffic.append(Traffic(robot, False, self._links[link].name, frame))
                sent.append(Sent(link, frame))
        return sent

    def _reached(self, word: Said) -> Iterable[LinkId]:
        if word.link is not None:
            return [word.link] if word.link in self._links else []
        return [
            link
            for link, state in self._links.items()
            if link not in word.besides and (word.to_sleepers or self._is_awake(state))
        ]

    def _is_awake(self, link: _Link) -> bool:
        return link.heard is not None and self._tick - link.heard <= self._patience

    def _frame(self, link: LinkId, robot: int, message: Message, payload: bytes) -> Frame:
        system = self._vehicles[robot].system
        count = self._counts[link, system]
        self._counts[link, system] = (count + 1) % 256
        seed = crc_extra(message.get_msgId())
        return Frame(system, COMPONENT, count, message.get_msgId(), payload, 0 if seed is None else seed)
