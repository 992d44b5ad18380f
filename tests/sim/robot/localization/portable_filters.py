"""Prints digests of what Kalman filters make of random motions and matches: the same on every machine."""

import hashlib
from collections.abc import Iterator

import numpy as np

from sim.common.geometry import Pose2
from sim.numerics.matrices import product
from sim.numerics.noise_arrays import NoiseStream
from sim.parameters import UkfParameters
from sim.robot.localization.pose_filters import ExtendedPoseFilter, MeasuredMotion, PoseFilter, UnscentedPoseFilter


def filters() -> tuple[PoseFilter, ...]:
    """New filters of each kind."""
    wide = UkfParameters(alpha=0.7, beta=1.3, kappa=0.2)
    return ExtendedPoseFilter(), UnscentedPoseFilter(UkfParameters()), UnscentedPoseFilter(wide)


def random_steps(pose_filter: PoseFilter, count: int) -> Iterator[int]:
    """Move a filter at random, correct it in every third step, and yield the number of each step."""
    pose_filter.reset(Pose2(1.3, -2.7, 0.4), np.diag((0.25, 0.25, 0.07)))
    noise = NoiseStream.named(1, "steps")
    for number in range(count):
        drawn = noise.normals(number, 15)
        x, y, turn, drive_noise, turn_noise, *error = drawn[:8].tolist()
        step = Pose2(0.2 + 0.1 * x, 0.02 * y, 0.2 * turn)
        pose_filter.predict(MeasuredMotion(step, 0.01 * abs(drive_noise), 0.02 * abs(turn_noise)))
        if number % 3 == 0:
            root = 0.05 * np.tril(np.resize(drawn[8:], (3, 3)))
            covariance = product(root, np.ascontiguousarray(root.T)) + np.diag((1e-4, 1e-4, 1e-4))
            mean = pose_filter.mean
            dx, dy, off = (0.05 * each for each in error)
            pose_filter.update(Pose2(mean.x + dx, mean.y + dy, mean.theta + off), covariance)
        yield number


def digest_of(pose_filter: PoseFilter) -> str:
    """Return the digest of all means and covariances of 500 steps."""
    said = hashlib.sha256()
    for _ in random_steps(pose_filter, 500):
        said.update(pose_filter.mean.array().tobytes() + pose_filter.covariance.tobytes())
    return said.hexdigest()


if __name__ == "__main__":
    print(*map(digest_of, filters()))
