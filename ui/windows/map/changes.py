"""Tests for visible changes of the map. Usually nothing has moved, so that nothing needs to be painted."""

from collections.abc import Sequence

import numpy as np

from sim.common.geometry import Pose2
from ui.model.shared.scene import RobotMark, RoomMark

VISIBLE_SHIFT = 0.1
"""Smallest visible shift, pixels."""

VISIBLE_TURN = 0.005
"""Smallest visible turn, radians."""


def same_rooms(some: Sequence[RoomMark], others: Sequence[RoomMark]) -> bool:
    """Return True if two sequences of rooms look the same."""
    return len(some) == len(others) and all(map(_same_room, some, others))


def _same_room(one: RoomMark, other: RoomMark) -> bool:
    return one is other or (
        (one.room, one.name, one.state, one.choosable, one.considered)
        == (other.room, other.name, other.state, other.choosable, other.considered)
        and (one.found, one.robot, one.answer) == (other.found, other.robot, other.answer)
        and np.array_equal(one.region, other.region)
    )


def settled(shown: Sequence[RobotMark], robots: Sequence[RobotMark], scale: float) -> tuple[RobotMark, ...]:
    """Return the marks of the current robots.

    If a robot looks the same as before at this scale (pixels per meter), return its old mark.
    """
    before = {mark.robot: mark for mark in shown}
    return tuple(_settled(before.get(mark.robot), mark, scale) for mark in robots)


def _settled(shown: RobotMark | None, mark: RobotMark, scale: float) -> RobotMark:
    return mark if shown is None or not _same_robot(shown, mark, scale) else shown


def _same_robot(one: RobotMark, other: RobotMark, scale: float) -> bool:
    return (
        (one.label, one.selected, one.trouble, one.ellipse, one.commander)
        == (other.label, other.selected, other.trouble, other.ellipse, other.commander)
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
