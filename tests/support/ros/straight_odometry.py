"""Odometry of a straight drive."""

from sim.common.geometry import Pose2
from thbridge.offline.odometry import OdometryTrack
from thbridge.ros.odometry_faults import OdometrySample

SECOND = 1_000_000_000


def straight(start: int, count: int, offset: float = 0.0, period: int = SECOND // 10) -> list[OdometrySample]:
    """Return the odometry of a drive at 1 m/s along x from `offset`; it is received at the times of its stamps."""
    return [
        OdometrySample(start + i * period, start + i * period, Pose2(offset + i * period / SECOND, 0.0, 0.0))
        for i in range(count)
    ]


def x_at(track: OdometryTrack, stamp: int, received: int | None = None) -> float | None:
    pose = track.at(stamp, stamp if received is None else received)
    return None if pose is None else round(pose.x, 6)
