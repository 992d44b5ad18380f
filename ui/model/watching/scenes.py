"""Draws up the scene of a moment from the messages that hold then."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim.geometry import FloatArray
from sim.grid import OccupancyGrid
from thbridge.adapters.map_files import MapRoom
from thbridge.ros import names, types, unpack
from thbridge.ros.pack import Diagnosis
from thbridge.ros.records import Score
from thbridge.ros.robots import usual_first
from ui.model.scene import RoomMark
from ui.model.watching.cast import Member
from ui.model.watching.decoded import Decoded
from ui.model.watching.frames import Frames
from ui.model.watching.robot_view import Moment, RobotView, Unpacked
from ui.model.watching.said import Levels, Said
from ui.model.watching.scene import GameScene, Scene, Shown, ThingScene, Wizard
from ui.model.watching.series import Series
from ui.model.watching.story import RoomNews, Story
from ui.model.watching.wizard import WIZARD, wizard


@dataclass(frozen=True, slots=True, eq=False)
class Watched:
    """What a scene is drawn up from, beside the messages of its moment.

    Attributes:
        cast: the robots.
        series: numbers over time.
        story: what happened.
        rooms: of the map, where it is known.
        start_ns: when time begins, nanoseconds of ROS time.
        unreadable: sentences on topics that cannot be read.
    """

    cast: tuple[Member, ...]
    series: Series
    story: Story
    rooms: tuple[MapRoom, ...]
    start_ns: int
    unreadable: tuple[str, ...] = ()


class Scenes:
    """Draws up one scene after the other; what does not change from one to the next is unpacked once."""

    def __init__(self) -> None:
        self._unpacked = Unpacked()
        self._scores = Decoded[Score](unpack.score)
        self._things = Decoded[list[tuple[str, FloatArray]]](unpack.outlines)
        self._diagnoses = Decoded[list[Diagnosis]](unpack.diagnostic_array)
        self._wizards = Decoded[Wizard](wizard)
        self._frames: tuple[tuple[bytes, ...], Frames] | None = None

    def scene(self, levels: Levels, watched: Watched, shown: Shown) -> Scene:
        """How things stand at the moment of these levels."""
        time = (levels.at_ns - watched.start_ns) / 1e9
        diagnoses = {each.name: each for each in self._diagnoses.of(levels.newest(names.DIAGNOSTICS)) or ()}
        frames = self._frames_of(levels.frames(levels.at_ns))
        moment = Moment(levels, frames, diagnoses, watched.series, time, shown, self._unpacked)
        score = self._scores.of(levels.newest(names.SCORE))
        things = self._things.of(levels.newest(names.THINGS)) or ()
        news = watched.story.rooms(levels.at_ns)
        return Scene(
            stamp_ns=levels.at_ns,
            time=time,
            grid=self._map(levels),
            robots=tuple(RobotView(member, moment).scene() for member in watched.cast),
            things=tuple(ThingScene(name, outline) for name, outline in things),
            rooms=tuple(_room(room, news.get(room.room.people, RoomNews())) for room in watched.rooms),
            game=None if score is None else GameScene(score.score, score.visited, score.rooms),
            wizard=self._wizards.of(levels.newest(WIZARD)) or Wizard(),
            unreadable=watched.unreadable,
        )

    def _frames_of(self, messages: Sequence[Said]) -> Frames:
        said = tuple(message.data for message in messages)
        known = self._frames
        if known is None or len(known[0]) != len(said) or any(a is not b for a, b in zip(known[0], said, strict=True)):
            known = self._frames = (said, Frames(messages))
        return known[1]

    def _map(self, levels: Levels) -> OccupancyGrid | None:
        maps = [
            topic
            for topic, msgtype in levels.topics.items()
            if msgtype == types.OCCUPANCY_GRID and "costmap" not in topic
        ]
        found = (self._unpacked.grids.of(levels.newest(topic)) for topic in usual_first(maps, (names.MAP.strip("/"),)))
        return next((grid for grid in found if grid is not None), None)


def _room(room: MapRoom, news: RoomNews) -> RoomMark:
    return RoomMark(
        room=room.room.people,
        name=room.name,
        region=np.array(room.region),
        state=news.state,
        found=news.found,
        robot=news.robot,
    )
