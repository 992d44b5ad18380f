"""Telemetry logs in the format of ground stations. Before each frame is the time at which it was received or sent.

Source: the format of MAVProxy's and QGroundControl's `.tlog` files.

Difference from the source: the log contains the time stamps of the bag next to it instead of real times. So tools show
dates of January 1970.
"""

import struct
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import replace

from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.traffic import Traffic

_STAMP = struct.Struct(">Q")


class Tlog:
    """Log of all vehicles. It is like a link on which each message is sent once.

    The frames of vehicles get the log's own sequence numbers, so that tools report no lost frames.
    """

    def __init__(self) -> None:
        self._counts: defaultdict[int, int] = defaultdict(int)

    def records(self, microseconds: int, traffic: Iterable[Traffic]) -> bytes:
        """Return the bytes to append to the log for these frames, in order.

        Args:
            microseconds: time at which the frames were received or sent.
            traffic: frames of one tick. If several links or vehicles got a message, it occurs several times in a row.
        """
        stamp = _STAMP.pack(microseconds)
        records: list[bytes] = []
        last: Traffic | None = None
        for one in traffic:
            if last is None or not _same(last, one):
                records += (stamp, (one.frame if one.incoming else self._counted(one.frame)).to_bytes())
            last = one
        return b"".join(records)

    def _counted(self, frame: Frame) -> Frame:
        count = self._counts[frame.system]
        self._counts[frame.system] = (count + 1) % 256
        return replace(frame, sequence=count)


def _same(last: Traffic, one: Traffic) -> bool:
    """Return True if both frames contain the same message, for another vehicle or on another link."""
    if one.incoming:
        return last.incoming and last.frame is one.frame
    content = (one.robot, one.frame.message_id, one.frame.payload)
    return (
        not last.incoming
        and last.link != one.link
        and (last.robot, last.frame.message_id, last.frame.payload) == content
    )
