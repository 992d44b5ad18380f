"""Layouts of message records in chunks: the bytes before each message, and the entry of each message in an index."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from thbridge.recording.bag.mcap_records import MESSAGE, MESSAGE_HEAD, U64
from thbridge.recording.bag.records import U32, message_head, time_bytes

_NO_TIME = time_bytes(0)
TIME = np.dtype(f"V{len(_NO_TIME)}")
"""A stamp in a record; in both formats, it has 8 bytes."""
_ROS1_HEAD = message_head(0) + _NO_TIME + U32.pack(0)
_MCAP_HEAD = MESSAGE_HEAD.pack(MESSAGE, 0, 0, 0, 0, 0)
_MCAP_COUNTED = len(_MCAP_HEAD) - 9
"""Bytes that the size of an MCAP record counts in addition to the message."""


class RecordLayout:
    """Layout of message records.

    Args:
        head: a record without the message.
        fields: format and offset in `head` of each field: `connection`, `times` (a field, or several), `size`,
            `sequence`.
        offset: format of the offset in an index entry.
        time_bytes: function that returns a stamp (nanoseconds) in the format of records.
        counted: number of bytes that `size` counts in addition to the message.

    Attributes:
        head_bytes: size of `head`.
        entry: type of an index entry: `time` and `offset`.
        is_numbered: True if records have a sequence number, which counts the messages of a connection from 0.
        time_bytes: see the arguments.
    """

    def __init__(
        self,
        head: bytes,
        fields: dict[str, tuple[str | np.dtype[np.void], int]],
        offset: str,
        time_bytes: Callable[[int], bytes],
        counted: int,
    ) -> None:
        self._head, self._counted = head, counted
        names, described = list(fields), list(fields.values())
        formats, offsets = [each for each, _ in described], [at for _, at in described]
        self._fields = np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": len(head)})
        self._times = [name for name in names if name.startswith("time")]
        self.head_bytes = len(head)
        self.entry = np.dtype([("time", TIME), ("offset", offset)])
        self.is_numbered = "sequence" in fields
        self.time_bytes = time_bytes

    def heads(
        self,
        numbers: NDArray[np.int64],
        times: NDArray[np.void],
        sizes: NDArray[np.int64],
        sequence: NDArray[np.int64],
    ) -> list[bytes]:
        """Return the heads of n messages.

        Args:
            numbers: (n,) numbers of their connections.
            times: (n,) stamps, in the format of `TIME`.
            sizes: (n,) lengths of the messages.
            sequence: (n,) sequence numbers, which are ignored if the layout has none.
        """
        rows = np.frombuffer(bytearray(self._head * len(sizes)), self._fields)
        rows["connection"], rows["size"] = numbers, sizes + self._counted
        for name in self._times:
            rows[name] = times
        if self.is_numbered:
            rows["sequence"] = sequence
        heads: list[bytes] = rows.view(f"V{len(self._head)}").tolist()
        return heads


ROS1 = RecordLayout(
    _ROS1_HEAD,
    {
        "connection": ("<u4", _ROS1_HEAD.index(b"conn=") + 5),
        "time": (TIME, len(_ROS1_HEAD) - U32.size - TIME.itemsize),
        "size": ("<u4", len(_ROS1_HEAD) - U32.size),
    },
    "<u4",
    time_bytes,
    counted=0,
)
MCAP = RecordLayout(
    _MCAP_HEAD,
    {
        "size": ("<u8", 1),
        "connection": ("<u2", 9),
        "sequence": ("<u4", 11),
        "time": (TIME, 15),
        "time_published": (TIME, 23),
    },
    "<u8",
    U64.pack,
    _MCAP_COUNTED,
)
