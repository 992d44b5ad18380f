"""Frames between links and vehicles: sent frames, results of received frames, and the list of both for recordings."""

from collections.abc import Sequence
from dataclasses import dataclass

from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.links import DropReason
from thbridge.mavlink.wire.outgoing import LinkId


@dataclass(frozen=True, slots=True)
class OutgoingFrame:
    """Frame that must be sent on a link."""

    link: LinkId
    frame: Frame


@dataclass(frozen=True, slots=True)
class FrameOutcome:
    """Result of a received frame.

    Attributes:
        dropped: reason why the frame was dropped. None if it was processed.
        replies: frames that must be sent at once.
    """

    dropped: DropReason | None = None
    replies: Sequence[OutgoingFrame] = ()


@dataclass(frozen=True, slots=True)
class Traffic:
    """Frame that a vehicle received or sent.

    Attributes:
        robot: index of the vehicle in the team.
        incoming: True if the vehicle received the frame. False if the vehicle sent it.
        link: name of the link.
        frame: frame without its signature.
    """

    robot: int
    incoming: bool
    link: str
    frame: Frame
