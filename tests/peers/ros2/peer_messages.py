"""Types and messages that tests with peers of ROS 2 use, as CDR."""

import struct

from thbridge.ros2.supports import MessageSupport, ServiceSupport

STRING = MessageSupport(
    "std_msgs/msg/String", "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
)
GRID = MessageSupport(
    "nav_msgs/msg/OccupancyGrid", "RIHS01_8d348150c12913a31ee0ec170fbf25089e4745d17035792a1ba94d6f0bc0cfc7"
)
SET_BOOL = ServiceSupport(
    "std_srvs/srv/SetBool",
    "RIHS01_abe9e4bb6b41b40e6789712c00ec8871923e089af3f667a79992a428cff2da0a",
    MessageSupport(
        "std_srvs/srv/SetBool_Request", "RIHS01_c62fbb99d94e1b25e8ef9e109f9581956bb1b3361a45a4e5810c36a90d29932e"
    ),
    MessageSupport(
        "std_srvs/srv/SetBool_Response", "RIHS01_d0814e7f7b4880ab77e9c57426c7aa1562ab69f11eef8e2e968812f9cbd0b059"
    ),
)


def string(text: str) -> bytes:
    """A std_msgs/msg/String as CDR."""
    data = text.encode() + b"\x00"
    return b"\x00\x01\x00\x00" + struct.pack("<I", len(data)) + data


def text_of(message: bytes) -> str:
    """The text of a std_msgs/msg/String."""
    (size,) = struct.unpack_from("<I", message, 4)
    return message[8 : 7 + size].decode()


def grid(width: int, height: int) -> bytes:
    """A nav_msgs/msg/OccupancyGrid as CDR, with different cells."""
    head = struct.pack("<iiI4sI", 1, 2, 4, b"map\x00", 0) + bytes(4)
    info = struct.pack("<fII4x7d", 0.05, width, height, *range(7))
    cells = bytes(at * 7 % 101 for at in range(width * height))
    return b"\x00\x01\x00\x00" + head + info + struct.pack("<I", len(cells)) + cells


def request(*, data: bool) -> bytes:
    """A request of SetBool as CDR."""
    return bytes([0, 1, 0, 0, data])


def response(*, success: bool, message: str) -> bytes:
    """A response of SetBool as CDR."""
    return bytes([0, 1, 0, 0, success, 0, 0, 0]) + string(message)[4:]


def success_and_message(data: bytes) -> tuple[bool, str]:
    """The fields of a response."""
    return bool(data[4]), text_of(bytes(4) + data[8:])
