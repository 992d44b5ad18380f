"""Joins vehicles and links: who is reached where, what is meant for whom, and the count of each sender on each link.

The rules of routing are MAVLink's: what names no target goes to everybody; what names one goes to where its target was
heard from, and nowhere else; nothing goes back to where it came from. Whoever is heard on two links, because they
are joined elsewhere too, is not told on one what it said on the other: so nothing goes round in circles.

Source: the MAVLink developer guide, "Routing".
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from sim.common.observations import TICKS_PER_SECOND
from thbridge.wire.mavlink.dialect import EVERYBODY, SECRETS, crc_extra, decoded, payload_of, target_of
from thbridge.wire.mavlink.frames.frame import Frame
from thbridge.wire.mavlink.links import DropReason, HubLink, LinkReport
from thbridge.wire.mavlink.outgoing import COMPONENT, LinkId, OutgoingMessage
from thbridge.wire.mavlink.vehicle.vehicle import Vehicle
from thbridge.wire.mavlink.vehicle_interface import RobotReadings, Station


@dataclass(frozen=True, slots=True)
class OutgoingFrame:
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
        self._links: dict[LinkId, HubLink] = {}
        self._traffic: list[Traffic] = []
        self._tick = 0

    @property
    def vehicles(self) -> tuple[Vehicle, ...]:
        """In the team's order."""
        return self._vehicles

    def open(self, link: LinkId, name: str, robot: int | None = None) -> None:
        """From now on there is this link; one of the same number is closed before.

        Args:
            link: its number.
            name: for people.
            robot: the only vehicle that is to be found there, from 0, and no station from elsewhere either: programs
                that know one vehicle may take a station's words for the vehicle's. None: all are.
        """
        self.close(link)
        self._links[link] = HubLink(name, self._patience, robot)

    def close(self, link: LinkId) -> None:
        """A link is gone, and whoever was reached by it."""
        if self._links.pop(link, None) is not None:
            for vehicle in self._vehicles:
                vehicle.forget(link)

    def report(self, link: LinkId) -> LinkReport | None:
        """How a link stands; None: there is none of this number."""
        there = self._links.get(link)
        return None if there is None else there.report(self._tick)

    def why_not(self, link: LinkId, frame: Frame) -> DropReason | None:
        """Why a frame that comes in on a link would be dropped; None: it would not."""
        there = self._links.get(link)
        if frame.system in self._by_system and frame.component == COMPONENT:
            # Other components may have a robot's system id: its companion computer, mavros or MAVSDK on it.
            return DropReason.OURS
        if frame.system == EVERYBODY:
            return DropReason.NOBODY
        if frame.message_id in SECRETS:
            return DropReason.SECRET
        if crc_extra(frame.message_id) is None:
            return DropReason.UNKNOWN
        sender = Station(frame.system, frame.component)
        return None if there is None or there.has_room_for(sender, self._tick) else DropReason.CROWDED

    def receive(self, link: LinkId, frame: Frame, robot: int | None = None) -> list[OutgoingFrame]:
        """A frame has come in.

        Args:
            link: where; an unknown one is ignored.
            frame: checked, and without its signature.
            robot: the only vehicle that is to hear it; None: whoever it is meant for.

        Returns:
            What goes out at once.
        """
        there, message = self._links.get(link), decoded(frame.message_id, frame.payload)
        if there is None:
            return []
        why = self.why_not(link, frame)
        if message is None or why is not None:
            there.dropped[why or DropReason.UNKNOWN] += 1
            return []
        sender = Station(frame.system, frame.component)
        there.hear(sender, frame.sequence, self._tick)
        system, component = target_of(message)
        sent: list[OutgoingFrame] = []
        meant = self._meant(system, component) if robot is None else (robot,)
        for number in filter(there.reaches, meant):
            self._traffic.append(Traffic(number, True, there.name, frame))
            sent += self._said(number, self._vehicles[number].hear(link, sender, message))
        is_shared = robot is None and there.robot is None
        if is_shared and (system not in self._by_system or component != COMPONENT):
            for other in self._beyond(link, sender, system, component):
                self._links[other].sent += 1
                sent.append(OutgoingFrame(other, frame))
        return sent

    def step(self, tick: int, readings: Sequence[RobotReadings]) -> list[OutgoingFrame]:
        """A tick has passed: what vehicles say by themselves.

        Args:
            tick: which.
            readings: of each robot, in the team's order.
        """
        self._tick = tick
        sent: list[OutgoingFrame] = []
        for robot, (vehicle, reading) in enumerate(zip(self._vehicles, readings, strict=True)):
            sent += self._said(robot, vehicle.step(tick, reading))
        return sent

    def keep_alive(self) -> list[OutgoingFrame]:
        """No tick has passed for a while: the heartbeats of all vehicles."""
        return [
            frame for robot, vehicle in enumerate(self._vehicles) for frame in self._said(robot, vehicle.keep_alive())
        ]

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

    def _beyond(self, origin: LinkId, sender: Station, system: int, component: int) -> list[LinkId]:
        """The other links that a message with this target goes on to."""
        wanted = None if component == EVERYBODY else component
        return [
            number
            for number, link in self._links.items()
            if number != origin
            and link.robot is None
            and not link.has(sender, self._tick)
            and (link.is_awake(self._tick) if system == EVERYBODY else link.leads_to(system, wanted, self._tick))
        ]

    def _said(self, robot: int, said: Iterable[OutgoingMessage]) -> list[OutgoingFrame]:
        sent: list[OutgoingFrame] = []
        system = self._vehicles[robot].system
        for word in said:
            message_id, payload = word.message.get_msgId(), payload_of(word.message)
            seed = crc_extra(message_id) or 0
            for number, link in self._reached(word, robot):
                frame = Frame(system, COMPONENT, link.next_sequence(system), message_id, payload, seed)
                self._traffic.append(Traffic(robot, False, link.name, frame))
                sent.append(OutgoingFrame(number, frame))
        return sent

    def _reached(self, word: OutgoingMessage, robot: int) -> list[tuple[LinkId, HubLink]]:
        """The links on which a vehicle's word goes out."""
        if word.link is not None:
            there = self._links.get(word.link)
            return [] if there is None or not there.reaches(robot) else [(word.link, there)]
        return [
            (number, link)
            for number, link in self._links.items()
            if link.reaches(robot) and number not in word.besides and (word.to_sleepers or link.is_awake(self._tick))
        ]
