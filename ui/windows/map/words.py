"""Description of the map in words, for screen readers."""

from collections.abc import Sequence

import numpy as np

from sim.common.robot_numbers import robot_name
from ui.model.scene import VISITED, RobotMark, RoomMark
from ui.windows.map.geometry import contains


def describe(rooms: Sequence[RoomMark], robots: Sequence[RobotMark]) -> str:
    """Describe how many rooms there are, which are visited or expect a robot, and where every robot is."""
    sentences = [f"Map: {len(rooms)} room{'' if len(rooms) == 1 else 's'}"]
    for told, states in (("visited", VISITED), ("won", ("won",)), ("lost", ("lost",))):
        numbers = [mark.room for mark in rooms if mark.state in states]
        if numbers:
            sentences.append(f"{told}: {_listed(numbers)}")
    for robot in robots:
        where = _where(robot, rooms)
        going = _going(robot, rooms)
        trouble = ", in trouble" if robot.trouble else ""
        commanded = f", commanded by {robot.commander}" if robot.commander else ""
        chosen = ", selected" if robot.selected else ""
        sentences.append(f"{robot_name(robot.robot)} {where}{going}{trouble}{commanded}{chosen}")
    return "; ".join(sentences) + "."


def _where(robot: RobotMark, rooms: Sequence[RoomMark]) -> str:
    here = np.array([[robot.pose.x, robot.pose.y]])
    room = next((mark.room for mark in rooms if contains(mark.region, here)[0]), None)
    return "in the corridor" if room is None else f"in room {room}"


def _going(robot: RobotMark, rooms: Sequence[RoomMark]) -> str:
    target = next((mark.room for mark in rooms if mark.state == "reserved" and mark.robot == robot.robot), None)
    return "" if target is None else f", on its way to room {target}"


def _listed(numbers: Sequence[int]) -> str:
    words = [str(number) for number in numbers]
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"
