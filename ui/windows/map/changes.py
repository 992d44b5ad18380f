"""Tests for visible changes of the map: most of the time nothing moves, and nothing need be painted."""

from collections.abc import Sequence

import numpy as np

from sim.common.geometry import Pose2
from ui.model.scene import RobotMark, RoomMark

VISIBLE_SHIFT = 0.1
"""Least shift that shows, pixels."""

VISIBLE_TURN = 0.005
"""Least turn that shows, radians."""


def same_rooms(some: Sequence[RoomMark], others: Sequence[RoomMark]) -> bool:
    """Return True when two sequences of rooms look the same."""
    return len(some) == len(others) and all(map(_same_room, some, others))


def _same_room(one: RoomMark, other: RoomMark) -> bool:
    return one is other or (
        (one.room, one.name, one.state, one.choosable, one.considered)
        == (other.room, other.name, other.state, other.choosable, other.considered)
        and (one.found, one.robot, one.answer) == (other.found, other.robot, other.answer)
        and np.array_equal(one.region, other.region)
    )


def same_robots(some: Sequence[RobotMark], others: Sequence[RobotMark], scale: float) -> bool:
    """Return True when two sequences of robots look the same at so many pixels a metre."""
    return len(some) == len(others) and all(_same_robot(*pair, scale) for pair in zip(some, others, strict=True))


def _same_robot(one: RobotMark, other: RobotMark, scale: float) -> bool:
    return (
        (one.robot, one.label, one.selected, one.trouble, one.ellipse)
        == (other.robot, other.label, other.selected, other.trouble, other.ellipse)
        and _same_pose(one.pose, other.pose, scale)
        and _same_pose(one.truth, other.truth, scale)
        and one.footprint is other.footprint
        and (one.trail is other.trail or np.array_equal(one.trail, other.trail, equal_nan=True))
        and one.path.shape == other.path.shape
        and bool(np.all(np.abs(one.path - other.path) * scale < VISIBLE_SHIFT))
    )


def _same_pose(one: Pose2 | None, other: Pose2 | None, scale: float) -> bool:
    if one is None or other is None:
        return one is other
    return one.distance(other) * scale < VISIBLE_SHIFT and abs(one.theta - other.theta) < VISIBLE_TURN
