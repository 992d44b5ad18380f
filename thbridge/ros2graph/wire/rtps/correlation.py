"""Correlation of responses with requests, in the two styles of ROS 2 on DDS.

rmw_fastrtps names the request in the inline quality of service: its sequence number, and the GUID of the client's
reader (a client sends this GUID with the request) or writer. rmw_cyclonedds puts 16 bytes after the CDR header of both
messages: 8 bytes for the client, and a sequence number.

Source: rmw_fastrtps_shared_cpp, rmw_request.cpp and rmw_response.cpp; rmw_cyclonedds_cpp, serdata.hpp and rmw_node.cpp.
"""

import struct
from collections.abc import Sequence
from hashlib import blake2b

from thbridge.ros2graph.wire.rtps.guids import Guid
from thbridge.ros2graph.wire.rtps.parameters import Parameter, Pid, encode_inline

HEADER_SIZE = 16
_CDR_SIZE = 4
_UNKNOWN_SEQUENCE = (-1, 0)
_UNKNOWN_GUID = bytes(16)


def related(guid: Guid, sequence: int | None = None) -> bytes:
    """Return the inline quality of service of a message that refers to a request.

    Args:
        guid: GUID of the client's reader or writer.
        sequence: number of the request; None in the request itself.
    """
    high, low = _UNKNOWN_SEQUENCE if sequence is None else (sequence >> 32, sequence & 0xFFFFFFFF)
    identity = guid + struct.pack("<iI", high, low)
    # Fast DDS before 2.11 reads only its own parameter, and newer versions ignore it unless they sent it.
    return encode_inline(
        [(Pid.RELATED_SAMPLE_IDENTITY, identity), (Pid.EPROSIMA_RELATED_SAMPLE_IDENTITY, identity)]
    )  # fmt: skip


def related_request(inline: Sequence[Parameter]) -> tuple[Guid, int] | None:
    """Return the GUID and the sequence number to which a message refers. None if it refers to nothing."""
    for each in inline:
        if each.pid in {Pid.RELATED_SAMPLE_IDENTITY, Pid.EPROSIMA_RELATED_SAMPLE_IDENTITY} and len(each.value) >= 24:
            guid = each.value[:16]
            high, low = struct.unpack_from(each.order + "iI", each.value, 16)
            return None if guid == _UNKNOWN_GUID else (guid, (high << 32) + low)
    return None


def client_key(writer: Guid) -> bytes:
    """Return the 8 bytes by which a client recognizes the responses to its requests."""
    return blake2b(writer, digest_size=8).digest()


def header_of(key: bytes, sequence: int) -> bytes:
    """Return the 16 bytes that name a request."""
    return key + struct.pack("<q", sequence)


def insert_header(message: bytes, header: bytes) -> bytes:
    """Return a message with 16 bytes after its CDR header."""
    return message[:_CDR_SIZE] + header + message[_CDR_SIZE:]


def split_header(message: bytes) -> tuple[bytes, bytes]:
    """Return the 16 bytes after the CDR header of a message, and the message without them.

    Raises:
        ValueError: the message is too short.
    """
    end = _CDR_SIZE + HEADER_SIZE
    if len(message) < end:
        raise ValueError("a request or response has no header of rmw_cyclonedds")
    return message[_CDR_SIZE:end], message[:_CDR_SIZE] + message[end:]


def sequence_of(header: bytes) -> int:
    """Return the sequence number in 16 bytes that name a request."""
    sequence: int = struct.unpack_from("<q", header, 8)[0]
    return sequence
