"""Poses of a recording in the order of their times, with jumps that cannot be the motion of a robot."""

from dataclasses import dataclass

import numpy as np

from sim.numerics.float_array import FloatArray
from thbridge.ros.clock_changes import stamps_by_clock
from thbridge.ros.odometry_faults import RecordedFault, sound_poses

LATEST, EARLIEST = 10.0, -0.25
"""Maximum and minimum time from the stamp of a message to its recording, seconds, if one clock sets both: tf2 keeps
transforms for 10 s, and a recorder that uses /clock is late by up to one period of /clock."""
RECORDED, STAMPED = 0, 1
"""Columns of the two times in rows (time of recording, stamp, x, y, theta)."""


@dataclass(frozen=True, slots=True, eq=False)
class SoundPath:
    """Poses over time.

    Attributes:
        rows: (n, 4) time, x, y, theta; times increase.
        recorded: (n,) time of recording of each.
        cuts: (k,) times of jumps, which cannot be motion of a robot.
        faults: faults, in the order of recording.
    """

    rows: FloatArray
    recorded: FloatArray
    cuts: FloatArray
    faults: tuple[RecordedFault, ...]


def unfit_stamps(rows: FloatArray) -> str | None:
    """Return the reason, as a clause, why stamps cannot be compared with stamps of other topics; None if they can.

    Args:
        rows: (n, 5) time of recording, stamp (NaN where it is 0), x, y, theta.
    """
    if not len(rows):
        return None
    if np.isnan(rows[:, STAMPED]).any():
        return "are stamped 0"
    moved = (np.diff(rows[:, 2:], axis=0) != 0.0).any(axis=1)
    if moved.any() and 2 * np.count_nonzero(moved & (np.diff(rows[:, STAMPED]) == 0.0)) >= np.count_nonzero(moved):
        return "have one stamp for many poses"
    late = float(np.median(rows[:, RECORDED] - rows[:, STAMPED]))
    if not EARLIEST <= late <= LATEST:
        return f"are {abs(late):.1f} s {'before' if late > 0.0 else 'after'} the time of recording"
    runs, _ = stamps_by_clock(_nanoseconds(rows[:, STAMPED]), _nanoseconds(rows[:, RECORDED]))
    return "are from a clock that was changed" if len(runs) > 1 else None


def sound_path(rows: FloatArray, by_stamp: bool, believed: bool = False) -> SoundPath:
    """Return the poses in the order of their times, without poses that cannot be true.

    Args:
        rows: see `unfit_stamps`, in the order of recording.
        by_stamp: True to use stamps as times, False to use times of recording.
        believed: True if the poses are a robot's belief, which may be wrong. In this case, only poses with an odd stamp
            are omitted.
    """
    times = rows[:, STAMPED if by_stamp else RECORDED]
    sound = sound_poses(_nanoseconds(rows[:, RECORDED]), _nanoseconds(times), rows[:, 2:])
    kept, cuts = sound.kept, times[sound.kept[sound.cuts]]
    if believed and len(sound.outliers):
        kept = np.concatenate((kept, sound.outliers))
        kept = kept[np.argsort(times[kept], kind="stable")]
        outlier = np.isin(kept, sound.outliers)
        cuts = np.union1d(cuts, times[kept[1:][outlier[1:] | outlier[:-1]]])
    return SoundPath(np.column_stack((times, rows[:, 2:]))[kept], rows[kept, RECORDED], cuts, sound.faults)


def _nanoseconds(seconds: FloatArray) -> "np.ndarray[tuple[int], np.dtype[np.int64]]":
    return np.rint(1e9 * seconds).astype(np.int64)
