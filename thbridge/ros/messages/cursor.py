"""Reader of the bytes of ROS messages. Fields are in order and little-endian. Texts and arrays follow their length."""

from struct import Struct, error
from typing import Self

import numpy as np
from numpy.typing import NDArray

UINT8 = Struct("<B")
INT32 = Struct("<i")
UINT32 = Struct("<I")
INT64 = Struct("<q")
UINT64 = Struct("<Q")
FLOAT32 = Struct("<f")
STAMP = Struct("<II")
POSE = Struct("<7d")


class Cursor:
    """Reader of the fields of a message, one by one. Each method raises ValueError if the message ends too early."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._at = 0

    @classmethod
    def behind_header(cls, data: bytes) -> Self:
        """Return a reader that starts after the header of a message."""
        cursor = cls(data)
        cursor.header()
        return cursor

    @property
    def has_more(self) -> bool:
        """True if the message contains further bytes."""
        return self._at < len(self._data)

    def take(self, count: int) -> bytes:
        """Read the next `count` bytes."""
        end = self._at + count
        if end > len(self._data):
            raise ValueError("the message ends too early")
        taken = self._data[self._at : end]
        self._at = end
        return taken

    def remaining(self) -> bytes:
        """Return all bytes that are not read yet, without reading them."""
        return self._data[self._at :]

    def integer(self, form: Struct) -> int:
        """Read an integer of this struct format."""
        try:
            (value,) = form.unpack_from(self._data, self._at)
        except error:
            raise ValueError("the message ends too early") from None
        self._at += form.size
        return int(value)

    def real(self) -> float:
        """Read a float32."""
        (value,) = FLOAT32.unpack(self.take(FLOAT32.size))
        return float(value)

    def reals(self, count: int) -> NDArray[np.float64]:
        """Read (count,) float64."""
        return np.frombuffer(self.take(8 * count), dtype="<f8").astype(np.float64)

    def string(self) -> str:
        """Read a text. Bytes that are not UTF-8 are replaced."""
        return self.take(self.integer(UINT32)).decode(errors="replace")

    def stamp(self) -> int:
        """Read a time in nanoseconds."""
        seconds, nanoseconds = STAMP.unpack(self.take(STAMP.size))
        return int(seconds) * 1_000_000_000 + int(nanoseconds)

    def header(self) -> tuple[int, str]:
        """Read a header. Return its stamp in nanoseconds and its frame."""
        self.take(UINT32.size)
        return self.stamp(), self.string()

    def spatial_pose(self) -> tuple[float, float, float, float, float, float, float]:
        """Read a three-dimensional pose: x, y, z and a quaternion x, y, z, w."""
        x, y, z, qx, qy, qz, qw = POSE.unpack(self.take(POSE.size))
        return x, y, z, qx, qy, qz, qw
