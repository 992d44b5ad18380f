"""Odometry, transforms and velocities as rows of numbers. They make up most of a bag, so they are read in batches."""

from collections import defaultdict
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sim.numerics import elementary_arrays
from sim.numerics.float_array import FloatArray
from thbridge.analysis.fields.layout import FixedBlock, layout_of
from thbridge.analysis.fields.rows import GatheredRows
from thbridge.analysis.report.tracks import SeriesByTopic
from thbridge.ros.messages.types import ODOMETRY, TFMESSAGE, TWIST, plain_definition
from thbridge.ros.names import frame_name
from thbridge.ros.robots import is_map_frame, is_odom_frame

MESSAGES = 256
"""Number of messages of a topic that are read together."""


class MessageBatches:
    """Messages that wait for more messages of their topic, to be read together.

    Args:
        series: receives their rows.
        unread: receives a sentence for each topic with a message that cannot be read.
        seconds: function that converts stamps in nanoseconds to seconds of the report.
    """

    def __init__(
        self,
        series: SeriesByTopic,
        unread: dict[str, str],
        seconds: Callable[[NDArray[np.int64]], FloatArray],
    ) -> None:
        self._series, self._unread, self._seconds = series, unread, seconds
        self._waiting: defaultdict[tuple[str, str], list[tuple[int, bytes]]] = defaultdict(list)
        self._readers: dict[str, Callable[[str, FloatArray, GatheredRows], None]] = {
            ODOMETRY: self._odometry,
            TFMESSAGE: self._transforms,
            TWIST: self._velocities,
        }
        self._rows: dict[str, GatheredRows] = {}

    def takes(self, msgtype: str) -> bool:
        """Return True for types that are read in batches."""
        return msgtype in self._readers

    def add(self, recorded_ns: int, topic: str, msgtype: str, data: bytes) -> None:
        """Add a message of a type that is read in batches."""
        waiting = self._waiting[topic, msgtype]
        waiting.append((recorded_ns, data))
        if len(waiting) >= MESSAGES:
            self._read(topic, msgtype)

    def flush(self) -> None:
        """Read all waiting messages."""
        for topic, msgtype in [*self._waiting]:
            self._read(topic, msgtype)

    def _read(self, topic: str, msgtype: str) -> None:
        waiting = self._waiting.pop((topic, msgtype))
        rows = self._rows.get(msgtype)
        if rows is None:
            rows = self._rows[msgtype] = GatheredRows(layout_of(msgtype, plain_definition(msgtype).text))
        lengths = np.array([len(data) for _, data in waiting])
        lost = rows.add_all(bytearray().join(data for _, data in waiting), lengths)
        for problem in lost.values():
            self._unread[topic] = f"{topic} contains a message that cannot be read: {problem}"
        times = self._seconds(np.delete(np.array([stamp for stamp, _ in waiting], dtype=np.int64), list(lost)))
        if len(times):
            self._readers[msgtype](topic, times, rows)
        rows.clear()

    def _odometry(self, topic: str, times: FloatArray, rows: GatheredRows) -> None:
        values = _block(rows, 3)
        frame, child = rows.texts(1)[0], rows.texts(2)[0]
        poses = self._series.odometry.setdefault(topic, self._series.poses_of(frame, child))
        placed = np.column_stack((times, self._stamps(rows), _poses(values)))
        poses.rows.frombytes(self._series.plausible(topic, placed, times=2).tobytes())
        speeds = np.column_stack((times, values["8"], values["13"]))
        poses.speeds.frombytes(self._series.plausible(topic, speeds).tobytes())

    def _transforms(self, topic: str, times: FloatArray, rows: GatheredRows) -> None:
        (inner,) = rows.inner
        if not inner.count:
            return
        recorded = np.repeat(times, rows.lengths(0))
        poses = np.column_stack((recorded, self._stamps(inner), _poses(_block(inner, 3))))
        places: defaultdict[tuple[str, str], list[int]] = defaultdict(list)
        for place, frames in enumerate(zip(inner.texts(1), inner.texts(2), strict=True)):
            places[frames].append(place)
        for (parent, child), found in places.items():
            if is_map_frame(parent) or is_odom_frame(parent):
                key = (topic.strip("/").rpartition("/")[0], frame_name(parent), frame_name(child))
                edge = self._series.edges.setdefault(key, self._series.poses_of(key[1], key[2]))
                edge.rows.frombytes(self._series.plausible(topic, poses[found], times=2).tobytes())

    def _stamps(self, rows: GatheredRows) -> FloatArray:
        """Return (n,) times from the headers that begin the rows; NaN for stamps of 0."""
        moments = _block(rows, 0)["1"]
        stamps_ns = 1_000_000_000 * moments["sec"].astype(np.int64) + moments["nsec"]
        return np.where(stamps_ns == 0, np.nan, self._seconds(stamps_ns))

    def _velocities(self, topic: str, times: FloatArray, rows: GatheredRows) -> None:
        values = _block(rows, 0)
        commands = np.column_stack((times, values["0"], values["5"]))
        self._series.commands[topic].frombytes(self._series.plausible(topic, commands).tobytes())


def _block(rows: GatheredRows, index: int) -> NDArray[np.void]:
    """Return the numbers in the part `index` of these rows, as structures with the part's fields."""
    part = rows.record.parts[index]
    if not isinstance(part, FixedBlock):
        raise TypeError(f"part {index} of {rows.record.msgtype} is not a block of numbers")
    return rows.run(index, part)


def _poses(values: NDArray[np.void]) -> FloatArray:
    """Return (n, 3) x, y, yaw of blocks that begin with a position and a quaternion."""
    x, y, qx, qy, qz, qw = (values[name] for name in "013456")
    with np.errstate(over="ignore", invalid="ignore"):  # for invalid quaternions
        yaw = elementary_arrays.atan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz))
    return np.column_stack((x, y, np.where(yaw == np.pi, -np.pi, yaw)))
