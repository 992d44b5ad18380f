"""Telemetry logs: each frame behind the microseconds at which it was heard or said, as ground stations keep them.

Source: the format of MAVProxy's and QGroundControl's `.tlog` files.

Differs: no real time. The stamps are those of the bag beside it, so tools show dates of January 1970.
"""

import struct
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import replace

from thbridge.wire.mavlink.frames.frame import Frame
from thbridge.wire.mavlink.hub import Traffic

_STAMP = struct.Struct(">Q")


class Tlog:
    """A log of all vehicles, as if it were one more link on which all was said and heard once.

    So what vehicles say is counted by the log's own sequence numbers, and tools find no frames lost.
    """

    def __init__(self) -> None:
        self._counts: defaultdict[int, int] = defaultdict(int)

    def records(self, microseconds: int, traffic: Iterable[Traffic]) -> bytes:
        """What to append for some traffic, in order.

        Args:
            microseconds: when it was.
            traffic: of one tick; a message that went to several links, or was heard by several vehicles, is there
                several times on end.
        """
        stamp = _STAMP.pack(microseconds)
        records: list[bytes] = []
        last: Traffic | None = None
        for one in traffic:
            if last is None or not _same(last, one):
                records += (stamp, (one.frame if one.heard else self._counted(one.frame)).to_bytes())
            last = one
        return b"".join(records)

    def _counted(self, frame: Frame) -> Frame:
        count = self._counts[frame.system]
        self._counts[frame.system] = (count + 1) % 256
        return replace(frame, sequence=count)


def _same(last: Traffic, one: Traffic) -> bool:
    """Whether it is the same message, heard by another vehicle or said on another link."""
    if one.heard:
        return last.heard and last.frame is one.frame
    said = (one.robot, one.frame.message_id, one.frame.payload)
    return not last.heard and last.link != one.link and (last.robot, last.frame.message_id, last.frame.payload) == said
