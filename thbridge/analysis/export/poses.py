"""The table `poses`: true, estimated and odometry poses of all robots at common times.

Poses are kept until the end of the recording (40 bytes each, all but the latest on disk), because the topics of true
and estimated poses are only known then. After that, the poses of one robot at a time are in memory.
"""

from collections.abc import Iterator

import numpy as np

from sim.numerics import elementary_arrays
from sim.numerics.float_array import FloatArray
from thbridge.analysis.export.tables import Table, TableRows
from thbridge.analysis.report.paths import at_times, wrapped
from thbridge.analysis.report.report import Track
from thbridge.analysis.report.tracks import BY_RECORDING, SeriesByTopic
from thbridge.files.tables.table_files import Column, Values
from thbridge.ros.messages.types import ODOMETRY, POSE_STAMPED, POSE_WITH_COVARIANCE
from thbridge.ros.robots import is_map_frame, is_odom_frame

NAME = "poses"
_NEEDED = {"t_s", "recorded_ns", "stamp_ns", "frame_id", "x_m", "y_m", "yaw_rad"}
_TRANSFORM = "geometry_msgs/TransformStamped"
_KINDS = (
    ("true", "true pose"),
    ("estimated", "pose that the robot believed"),
    ("odometry", "pose from odometry alone"),
)
_COLUMNS = (
    Column("robot", "string", "", "name of the robot"),
    Column(
        "t_s",
        "float64",
        "s",
        "time since the beginning of the recording, from headers; from the time of recording if a notice says so",
    ),
    *(
        Column(f"{kind}_{value}_{unit}", "float64", unit, f"{meaning}: {value}; nan if unknown")
        for kind, meaning in _KINDS
        for value, unit in (("x", "m"), ("y", "m"), ("yaw", "rad"))
    ),
    Column("error_m", "float64", "m", "distance between the estimated and the true pose"),
    Column("error_yaw_rad", "float64", "rad", "angle from the true to the estimated heading"),
)
TABLE = Table(
    NAME, "poses of all topics", "", "true, estimated and odometry poses of all robots at common times", _COLUMNS
)


class PosesTable:
    """Collector of poses from the rows of other tables, for one table of all robots."""

    def __init__(self) -> None:
        self._series = SeriesByTopic()
        self._notices: list[str] = []

    def add(self, piece: TableRows) -> None:
        """Keep the poses in some rows of a table, if there are any."""
        table = piece.table
        if table.msgtype not in {ODOMETRY, POSE_WITH_COVARIANCE, POSE_STAMPED, _TRANSFORM} or not piece.rows:
            return
        named = {column.name: values for column, values in zip(table.columns, piece.values, strict=True)}
        # Poses in arrays have no topic of their own. Types of other packages may also have these column names.
        if not named.keys() >= _NEEDED:
            return
        times, recorded, stamps = (np.asarray(named[name]) for name in ("t_s", "recorded_ns", "stamp_ns"))
        stamped = np.where(stamps == 0, np.nan, times + (stamps - recorded) / 1e9)
        rows = np.column_stack([times, stamped, *(np.asarray(named[name]) for name in ("x_m", "y_m", "yaw_rad"))])
        frames, children = _texts(named["frame_id"]), _texts(named.get("child_frame_id", [""] * piece.rows))
        if table.msgtype == _TRANSFORM:
            self._add_frames(table.source.partition(":")[0], frames, children, rows)
        elif table.msgtype == ODOMETRY:
            poses = self._series.odometry.setdefault(table.source, self._series.poses_of(frames[0], children[0]))
            poses.rows.frombytes(self._series.plausible(table.source, rows, times=2).tobytes())
        else:
            poses = self._series.poses.setdefault(table.source, self._series.poses_of(frames[0], ""))
            poses.rows.frombytes(self._series.plausible(table.source, rows, times=2).tobytes())

    def _add_frames(self, topic: str, parents: list[str], children: list[str], rows: FloatArray) -> None:
        pairs = np.array([f"{parent}\n{child}" for parent, child in zip(parents, children, strict=True)])
        for pair in dict.fromkeys(pairs.tolist()):
            parent, child = (frame.lstrip("/") for frame in pair.split("\n"))
            if is_map_frame(parent) or is_odom_frame(parent):
                key = (topic.strip("/").rpartition("/")[0], parent, child)
                edge = self._series.edges.setdefault(key, self._series.poses_of(parent, child))
                edge.rows.frombytes(self._series.plausible(topic, rows[pairs == pair], times=2).tobytes())

    def notices(self) -> tuple[str, ...]:
        """Sentences about omitted poses, and about times; complete after `pieces` is exhausted."""
        return tuple(f"poses: {sentence}" for sentence in (*self._series.left_out_sentences(), *self._notices))

    def pieces(self) -> Iterator[TableRows]:
        """Yield the table's rows, robot by robot; nothing if there were no poses."""
        for track in self._series.tracks(0.0):
            self._notices += (
                *track.faults,
                *(f"{track.label}: {note}." for note in track.sources if BY_RECORDING in note),
            )
            if (piece := _piece(track)).rows:
                yield piece


def _texts(values: Values) -> list[str]:
    return [str(value) for value in values] if isinstance(values, list) else []


def _piece(track: Track) -> TableRows:
    paths = (track.truth, track.estimate, track.odometry)
    # The times are taken from odometry, which has no gaps; without odometry, from the most frequent poses.
    times = (track.odometry if len(track.odometry) else max(paths, key=len))[:, 0]
    true, estimated, counted = (at_times(path, times) for path in paths)
    values: tuple[Values, ...] = (
        [track.name] * len(times),
        times,
        *(np.ascontiguousarray(poses[:, column]) for poses in (true, estimated, counted) for column in range(3)),
        elementary_arrays.hypot(estimated[:, 0] - true[:, 0], estimated[:, 1] - true[:, 1]),
        wrapped(estimated[:, 2] - true[:, 2]),
    )
    return TableRows(TABLE, len(times), values)


FRAMES = {
    (NAME, column.name): "map" if column.name.startswith(("true", "estimated")) else "frame of its odometry"
    for column in _COLUMNS
    if column.name.startswith(("true", "estimated", "odometry"))
}
"""Frames of the table's columns, for the dictionary."""
