"""Marks of rooms and robots on the participant's map."""

import numpy as np

from sim.common.robot_numbers import number_of
from sim.numerics.float_array import FloatArray
from thbridge.dialogue.wording.texts import Texts
from thbridge.roles.shared.notices import FloorPlan
from thbridge.roles.shared.view import View
from ui.model.playing.cards import is_in_trouble
from ui.model.playing.motion import DisplayedRobot
from ui.model.playing.screen import RoomTile
from ui.model.playing.words import commander_in_words
from ui.model.shared.scene import RobotMark, RoomMark


class MapMarks:
    """Maker of marks from the shapes in a floor plan.

    Args:
        floor_plan: the rooms, and the robots' footprint.
    """

    def __init__(self, floor_plan: FloorPlan) -> None:
        self._rooms = {room.room: _corners(room.region) for room in floor_plan.rooms}
        self._footprint = _corners(floor_plan.footprint)

    def rooms(self, tiles: tuple[RoomTile, ...]) -> tuple[RoomMark, ...]:
        """Return the marks of the rooms, with the states of the rooms' tiles.

        Rooms that are not in the floor plan are omitted.
        """
        return tuple(
            RoomMark(
                room=tile.room,
                name=tile.name,
                region=self._rooms[tile.room],
                state=tile.state,
                choosable=tile.choose.enabled,
                considered=tile.considered,
                found=tile.found,
                found_shorter=tile.found_shorter,
                robot=tile.robot,
            )
            for tile in tiles
            if tile.room in self._rooms
        )

    def robots(
        self, texts: Texts, moving: tuple[DisplayedRobot, ...], view: View, selected: int
    ) -> tuple[RobotMark, ...]:
        """Return the marks of the robots at their displayed poses."""
        return tuple(
            RobotMark(
                robot=robot.robot,
                label=str(number_of(robot.robot)),
                pose=motion.pose,
                footprint=self._footprint,
                selected=robot.robot == selected,
                trouble=is_in_trouble(robot),
                trail=motion.trail,
                path=motion.path,
                ellipse=motion.ellipse,
                truth=motion.truth,
                commander=commander_in_words(texts, robot.commander, robot.commander_name),
            )
            for robot, motion in zip(view.robots, moving, strict=False)
        )


def _corners(points: tuple[tuple[float, float], ...]) -> FloatArray:
    return np.array(points, dtype=np.float64).reshape(-1, 2)
