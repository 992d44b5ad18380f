"""Description of the map in words, for screen readers."""

from collections.abc import Sequence

import numpy as np

from sim.common.geometry import Pose2
from thbridge.dialogue.wording.texts import Texts
from thbridge.hunt.rooms import CORRIDOR
from ui.model.shared.map_geometry import contains
from ui.model.shared.scene import VISITED, RobotMark, RoomMark


def describe(texts: Texts, rooms: Sequence[RoomMark], robots: Sequence[RobotMark]) -> str:
    """Return a description of the number of rooms, their states, and the places of all robots."""
    clauses = [texts.text("map.rooms", rooms=texts.text("words.rooms", count=len(rooms)))]
    for key, states in (("map.visited", VISITED), ("map.won", ("won",)), ("map.lost", ("lost",))):
        numbers = [str(mark.room) for mark in rooms if mark.state in states]
        if numbers:
            clauses.append(texts.text(key, rooms=texts.listed(numbers)))
    return "; ".join([*clauses, *(_robot(texts, robot, rooms) for robot in robots)]) + "."


def _robot(texts: Texts, robot: RobotMark, rooms: Sequence[RoomMark]) -> str:
    parts = [texts.clause("map.robot", robot=robot.robot, room=_place(robot.pose, rooms))]
    target = next((mark.room for mark in rooms if mark.state == "reserved" and mark.robot == robot.robot), None)
    if target is not None:
        parts.append(texts.clause("map.going", room=target))
    if robot.trouble:
        parts.append(texts.clause("map.trouble"))
    if robot.commander:
        parts.append(texts.clause("map.commanded", commander=robot.commander))
    if robot.selected:
        parts.append(texts.clause("map.selected"))
    return ", ".join(parts)


def _place(pose: Pose2, rooms: Sequence[RoomMark]) -> int:
    here = np.array([[pose.x, pose.y]])
    return next((mark.room for mark in rooms if contains(mark.region, here)[0]), CORRIDOR.people)
