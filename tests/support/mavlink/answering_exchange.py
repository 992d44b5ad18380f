"""Session for ground stations that answers every frame."""

from collections.abc import Callable, Sequence

from thbridge.mavlink.wire.dialect import crc_extra, mav, payload_of
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.links import DropReason, HubLink
from thbridge.mavlink.wire.outgoing import LinkId
from thbridge.mavlink.wire.traffic import FrameOutcome, OutgoingFrame


def frame(message: mav.MAVLink_message, system: int = 255, sequence: int = 0) -> Frame:
    number = message.get_msgId()
    return Frame(system, 190, sequence, number, payload_of(message), crc_extra(number) or 0)


ANSWER = frame(mav.MAVLink_ping_message(7, 1, 255, 190), system=1)


class AnsweringExchange:
    """Exchange that answers each frame it receives."""

    def __init__(self) -> None:
        self.names: dict[LinkId, str] = {}
        self.robots: dict[str, int | None] = {}
        self.gone: list[str] = []
        self.received: list[tuple[str, Frame]] = []
        self.transmit: Callable[[Sequence[OutgoingFrame]], None] = lambda sent: None

    def open_link(self, name: str, robot: int | None = None) -> LinkId:
        link = LinkId(len(self.names) + len(self.gone))
        self.names[link], self.robots[name] = name, robot
        return link

    def close_link(self, link: LinkId) -> None:
        self.gone.append(self.names.pop(link))

    def link(self, link: LinkId) -> HubLink | None:
        return None

    def receive_frame(self, link: LinkId, frame: Frame) -> FrameOutcome:
        self.received.append((self.names[link], frame))
        return FrameOutcome(DropReason.OURS if frame.system == 1 else None, [OutgoingFrame(link, ANSWER)])

    def say(self, *frames: Frame) -> None:
        self.transmit([OutgoingFrame(link, each) for each in frames for link in self.names])
