"""Links of a session to the robots' vehicles, which records the inputs of the links."""

from typing import TYPE_CHECKING

from thbridge.app.session import inputs
from thbridge.app.session.inputs import InputQueue
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.links import HubLink
from thbridge.mavlink.wire.outgoing import LinkId
from thbridge.mavlink.wire.traffic import FrameOutcome, OutgoingFrame

if TYPE_CHECKING:  # Only sessions with robots need these.
    from thbridge.mavlink.role.vehicles import Vehicles


class RecordedLinks:
    """Links of ground stations. All received frames are inputs of the next tick.

    Args:
        vehicles: the robots; None if they are not MAVLink vehicles.
        queue: queue of the inputs.
    """

    def __init__(self, vehicles: "Vehicles | None", queue: InputQueue) -> None:
        self._vehicles = vehicles
        self._inputs = queue

    def open_link(self, name: str, robot: int | None = None) -> LinkId:
        """Open a link to the robots' vehicles.

        Args:
            name: name of the link.
            robot: index of the only robot on the link, from 0. If None, the link is for all robots.

        Raises:
            ValueError: the robots are not MAVLink vehicles.
        """
        if self._vehicles is None:
            raise ValueError("the robots are not MAVLink vehicles")
        link = self._vehicles.open(name, robot)
        self._inputs.add(inputs.LinkOpened(link, name, robot))
        return link

    def close_link(self, link: LinkId) -> None:
        """Close a link; this has no effect if the link is already closed."""
        there = self.link(link)
        if self._vehicles is not None and there is not None:
            self._vehicles.hub.close(link)
            self._inputs.add(inputs.LinkClosed(link, there.name))

    def link(self, link: LinkId) -> HubLink | None:
        """Return the state of an open link; None if the link is not open."""
        return None if self._vehicles is None else self._vehicles.hub.link(link)

    def receive_frame(self, link: LinkId, frame: Frame, robot: int | None = None) -> FrameOutcome:
        """Process a received frame.

        The vehicles process the frame at once, in their state after the last tick. Requests of vehicles to robots and
        game take effect in the next tick.

        Args:
            link: number of the link. A frame of an unknown link is dropped.
            frame: the frame, checked and without signature.
            robot: index of the only robot that receives the frame, from 0. If None, all robots that the frame addresses
                receive it.

        Returns:
            The reason why the frame was dropped, or the frames sent in reply, for `transmit`.
        """
        there = self.link(link)
        if self._vehicles is None or there is None:
            return FrameOutcome()
        outcome = self._vehicles.hub.receive(link, frame, robot)
        # A dropped frame is not recorded, because it has no effect, and may contain a secret.
        if outcome.dropped is None:
            self._inputs.add(inputs.FrameReceived(link, there.name, frame, robot))
        return outcome

    def keep_alive(self) -> list[OutgoingFrame]:
        """Return the heartbeats that are due in real time while the session is paused or slow."""
        if self._vehicles is None:
            return []
        self._inputs.add(inputs.HeartbeatsSent())
        return self._vehicles.hub.keep_alive()
