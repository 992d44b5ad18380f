"""Lists of the endpoints of each node: messages on `ros_discovery_info`.

Source: rmw_dds_common/msg/ParticipantEntitiesInfo, NodeEntitiesInfo and Gid (16 bytes since Iron).
"""

import re
import struct
from collections.abc import Sequence
from dataclasses import dataclass

from thbridge.ros2graph.values.graph import NodeName
from thbridge.ros2graph.wire.rtps.guids import Guid

MOST_NODES = 1024
"""Maximum number of nodes of a participant."""

_HEADER = b"\x00\x01\x00\x00"
_LONGEST_NAME = 256
_NAMES = re.compile(r"(/[A-Za-z0-9_]+)+")


@dataclass(frozen=True, slots=True)
class NodeEntities:
    """Node with the GUIDs of its readers and writers."""

    node: NodeName
    readers: Sequence[Guid]
    writers: Sequence[Guid]


def encode_entities(participant: Guid, nodes: Sequence[NodeEntities]) -> bytes:
    """Return the message that lists the nodes of a participant."""
    data = bytearray(participant + struct.pack("<I", len(nodes)))
    for each in nodes:
        for text in (each.node.namespace, each.node.name):
            encoded = text.encode() + b"\x00"
            data += bytes(-len(data) % 4) + struct.pack("<I", len(encoded)) + encoded
        for gids in (each.readers, each.writers):
            data += bytes(-len(data) % 4) + struct.pack("<I", len(gids)) + b"".join(gids)
    return _HEADER + bytes(data)


def decode_entities(message: bytes) -> list[NodeEntities]:
    """Return the nodes of a participant.

    Raises:
        ValueError: this is no such message.
    """
    if message[:2] not in {b"\x00\x00", b"\x00\x01"}:
        raise ValueError("the list of nodes is no CDR")
    cursor = _Cursor(message[4:], "<" if message[1] else ">")
    cursor.take(16)
    count = cursor.number()
    if count > MOST_NODES:
        raise ValueError("a participant has too many nodes")
    return [NodeEntities(cursor.node(), cursor.gids(), cursor.gids()) for _ in range(count)]


class _Cursor:
    """Position in the data of a message."""

    def __init__(self, data: bytes, order: str) -> None:
        self._data = data
        self._number = struct.Struct(order + "I")
        self._at = 0

    def take(self, size: int) -> bytes:
        """Return the next bytes."""
        if self._at + size > len(self._data):
            raise ValueError("the list of nodes is incomplete")
        taken = self._data[self._at : self._at + size]
        self._at += size
        return taken

    def number(self) -> int:
        """Return the next number."""
        self._at += -self._at % 4
        value: int = self._number.unpack(self.take(4))[0]
        return value

    def string(self) -> str:
        """Return the next string."""
        size = self.number()
        if size > _LONGEST_NAME + 1:
            raise ValueError("the name of a node is too long")
        return self.take(size).rstrip(b"\x00").decode()

    def node(self) -> NodeName:
        """Return the next name of a node."""
        name = NodeName(self.string() or "/", self.string())
        if not _NAMES.fullmatch(name.whole):
            raise ValueError("the name of a node has other characters than ROS allows")
        return name

    def gids(self) -> list[Guid]:
        """Return the next list of GUIDs."""
        data = self.take(16 * self.number())
        return [data[at : at + 16] for at in range(0, len(data), 16)]
