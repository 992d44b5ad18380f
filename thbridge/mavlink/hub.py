"""MAVLink router between vehicles and links. It also numbers the frames of each vehicle on each link.

The routing rules are those of MAVLink. A message without a target goes to all links and vehicles. A message with a
target goes only to links on which frames of that target arrived. No message goes back to its origin. If frames of one
sender arrive on two links, another program joins these links. Then no message of this sender is forwarded to these
links. Otherwise the message would circulate without end.

Source: the MAVLink developer guide, "Routing".
"""

from collections.abc import Iterable, Sequence

from sim.common.observations import TICKS_PER_SECOND
from thbridge.mavlink.values.vehicle_interface import RobotReadings, Station
from thbridge.mavlink.vehicle.vehicle import Vehicle
from thbridge.mavlink.wire.dialect import BROADCAST, SECRETS, crc_extra, decoded, mav, payload_of, target_of
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.links import DropReason, HubLink
from thbridge.mavlink.wire.outgoing import LinkId, OutgoingMessage
from thbridge.mavlink.wire.traffic import FrameOutcome, OutgoingFrame, Traffic

COMPONENT = mav.MAV_COMP_ID_AUTOPILOT1
"""Component id of a vehicle. A vehicle has only this component."""


class Hub:
    """Vehicles of one team and all links to them.

    Args:
        vehicles: vehicles in the team's order.
        timeout: seconds without a frame after which a link is inactive. Inactive links get only heartbeats.

    Attributes:
        vehicles: the vehicles of the team.
    """

    def __init__(self, vehicles: Sequence[Vehicle], timeout: float) -> None:
        self.vehicles = tuple(vehicles)
        self._by_system = {vehicle.system: robot for robot, vehicle in enumerate(vehicles)}
        self._timeout = round(timeout * TICKS_PER_SECOND)
        self._links: dict[LinkId, HubLink] = {}
        self._traffic: list[Traffic] = []
        self._tick = 0

    def open(self, link: LinkId, name: str, robot: int | None = None) -> None:
        """Open a link. If a link of this number is open, close it first.

        Args:
            link: its number.
            name: name for people.
            robot: index of the only vehicle on the link. The link then gets no frames of other stations, because a
                program that supports only one vehicle may mistake them for frames of the vehicle. If None, all vehicles
                are on the link.
        """
        self.close(link)
        self._links[link] = HubLink(name, self._timeout, robot)

    def close(self, link: LinkId) -> None:
        """Remove a link and all stations on it."""
        if self._links.pop(link, None) is not None:
            for vehicle in self.vehicles:
                vehicle.forget(link)

    def link(self, link: LinkId) -> HubLink | None:
        """Return the state of an open link, or None if no open link has this number."""
        return self._links.get(link)

    def _reason_to_drop(self, link: HubLink, frame: Frame) -> DropReason | None:
        if frame.system in self._by_system and frame.component == COMPONENT:
            # Other components may share a robot's system id: its companion computer, mavros or MAVSDK on it.
            return DropReason.OURS
        # System id 0 addresses all systems, so it cannot be the address of a sender.
        if frame.system == BROADCAST:
            return DropReason.BROADCAST_SENDER
        # Signing keys come from a file. A key on the wire would be readable in recordings.
        if frame.message_id in SECRETS:
            return DropReason.SECRET
        # The checksum includes a seed of the message's definition, so an unknown message cannot be checked.
        if crc_extra(frame.message_id) is None:
            return DropReason.UNKNOWN
        sender = Station(frame.system, frame.component)
        return None if link.has_room_for(sender, self._tick) else DropReason.CROWDED

    def receive(self, link: LinkId, frame: Frame, robot: int | None = None) -> FrameOutcome:
        """Process a received frame.

        Args:
            link: link on which it arrived. If the link is not open, the frame is ignored.
            frame: verified frame without its signature.
            robot: index of the only vehicle that receives it. If None, the target in the message determines the
                vehicles. A frame for a vehicle that does not exist has no effect.
        """
        there = self._links.get(link)
        if there is None or not (robot is None or 0 <= robot < len(self.vehicles)):
            return FrameOutcome()
        dropped, message = self._reason_to_drop(there, frame), None
        if dropped is None:
            message = decoded(frame.message_id, frame.payload)
        if message is None:
            dropped = dropped or DropReason.UNKNOWN
            there.dropped[dropped] += 1
            return FrameOutcome(dropped)
        sender = Station(frame.system, frame.component)
        there.record_frame(sender, frame.sequence, self._tick)
        system, component = target_of(message)
        sent: list[OutgoingFrame] = []
        addressed = self._addressed(system, component) if robot is None else (robot,)
        for number in filter(there.reaches, addressed):
            self._traffic.append(Traffic(number, True, there.name, frame))
            sent += self._numbered(number, self.vehicles[number].handle_message(link, sender, message))
        # Programs on a link of one robot may mistake frames of other stations for frames of the robot.
        is_shared = robot is None and there.robot is None
        if is_shared and (system not in self._by_system or component != COMPONENT):
            for other in self._forwarded_to(link, sender, system, component):
                self._links[other].sent += 1
                sent.append(OutgoingFrame(other, frame))
        return FrameOutcome(replies=sent)

    def step(self, tick: int, readings: Sequence[RobotReadings]) -> list[OutgoingFrame]:
        """Step all vehicles by one tick and return their frames.

        Args:
            tick: number of the tick.
            readings: readings of each robot, in the team's order.
        """
        self._tick = tick
        sent: list[OutgoingFrame] = []
        for robot, (vehicle, reading) in enumerate(zip(self.vehicles, readings, strict=True)):
            sent += self._numbered(robot, vehicle.step(tick, reading))
        return sent

    def keep_alive(self) -> list[OutgoingFrame]:
        """Return heartbeats of all vehicles for a period without ticks.

        Ground stations disconnect silent vehicles by their own clock, even if the session is paused.
        """
        return [
            frame
            for robot, vehicle in enumerate(self.vehicles)
            for frame in self._numbered(robot, vehicle.keep_alive())
        ]

    def take_traffic(self) -> tuple[Traffic, ...]:
        """Return the frames that vehicles received and sent since the last call, in order."""
        traffic, self._traffic = tuple(self._traffic), []
        return traffic

    def _addressed(self, system: int, component: int) -> Iterable[int]:
        """Return the vehicles addressed by this target."""
        # In MAVLink, component id 0 addresses all components of a system.
        if component not in (BROADCAST, COMPONENT):
            return ()
        if system == BROADCAST:
            return range(len(self.vehicles))
        robot = self._by_system.get(system)
        return () if robot is None else (robot,)

    def _forwarded_to(self, origin: LinkId, sender: Station, system: int, component: int) -> list[LinkId]:
        """Return the other links to which a message with this target is forwarded."""
        wanted = None if component == BROADCAST else component
        return [
            number
            for number, link in self._links.items()
            if number != origin
            and link.robot is None
            # The sender is also present on this link, so the message has already arrived there.
            and not link.is_present(sender, self._tick)
            and (link.is_active(self._tick) if system == BROADCAST else link.leads_to(system, wanted, self._tick))
        ]

    def _numbered(self, robot: int, messages: Iterable[OutgoingMessage]) -> list[OutgoingFrame]:
        sent: list[OutgoingFrame] = []
        system = self.vehicles[robot].system
        for outgoing in messages:
            message_id, payload = outgoing.message.get_msgId(), payload_of(outgoing.message)
            seed = crc_extra(message_id) or 0
            # Each link counts on its own. Otherwise frames on other links would look like losses.
            for number, link in self._reached(outgoing, robot):
                frame = Frame(system, COMPONENT, link.next_sequence(system), message_id, payload, seed)
                self._traffic.append(Traffic(robot, False, link.name, frame))
                sent.append(OutgoingFrame(number, frame))
        return sent

    def _reached(self, outgoing: OutgoingMessage, robot: int) -> list[tuple[LinkId, HubLink]]:
        """Return the links on which a vehicle's message is sent."""
        if outgoing.link is not None:
            there = self._links.get(outgoing.link)
            return [] if there is None or not there.reaches(robot) else [(outgoing.link, there)]
        return [
            (number, link)
            for number, link in self._links.items()
            if link.reaches(robot)
            and number not in outgoing.except_links
            and (outgoing.to_inactive or link.is_active(self._tick))
        ]
