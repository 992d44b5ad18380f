"""Draws up the scene of a moment from the messages that hold then."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim.common.geometry import FloatArray
from sim.common.grid import OccupancyGrid
from thbridge.files.map_files import MapRoom
from thbridge.ros import names
from thbridge.ros.messages import types, unpack
from thbridge.ros.messages.pack import DiagnosticStatus
from thbridge.ros.messages.records import ScoreRecord
from thbridge.ros.robots import usual_first
from ui.model.scene import RoomMark
from ui.model.watching.decode_cache import DecodeCache
from ui.model.watching.frames import Frames
from ui.model.watching.messages import TopicSnapshot, WatchedMessage
from ui.model.watching.robot_scene_builder import DecodedTopics, RobotSceneBuilder, SceneContext
from ui.model.watching.robots import WatchedRobot
from ui.model.watching.scene import GameScene, Scene, ShownLayers, ThingScene, Wizard
from ui.model.watching.series import Series
from ui.model.watching.session_log import RoomStatus, SessionLog
from ui.model.watching.wizard import wizard

FRAMES_KEPT = 8
"""Moments whose frames are remembered: that of the scene, and those of the scans in it."""


@dataclass(frozen=True, slots=True, eq=False)
class SceneInputs:
    """What a scene is drawn up from, beside the messages of its moment.

    Attributes:
        cast: the robots.
        mapped: whether there is a map.
        series: numbers over time.
        story: what happened.
        rooms: of the map, where it is known.
        start_ns: when time begins, nanoseconds of ROS time.
        unreadable: sentences on topics that cannot be read.
    """

    robots: tuple[WatchedRobot, ...]
    mapped: bool
    series: Series
    log: SessionLog
    rooms: tuple[MapRoom, ...]
    start_ns: int
    unreadable: tuple[str, ...] = ()


class SceneBuilder:
    """Draws up one scene after the other; what does not change from one to the next is unpacked once."""

    def __init__(self) -> None:
        self._unpacked = DecodedTopics()
        self._scores = DecodeCache[ScoreRecord](unpack.score)
        self._things = DecodeCache[list[tuple[str, FloatArray]]](unpack.outlines)
        self._diagnoses = DecodeCache[list[DiagnosticStatus]](unpack.diagnostic_array)
        self._wizards = DecodeCache[Wizard](wizard)
        self._frames: deque[tuple[tuple[bytes, ...], Frames]] = deque(maxlen=FRAMES_KEPT)

    def build(self, levels: TopicSnapshot, watched: SceneInputs, shown: ShownLayers) -> Scene:
        """How things stand at the moment of these levels."""
        time = (levels.at_ns - watched.start_ns) / 1e9
        diagnoses = {each.name: each for each in self._diagnoses.of(levels.newest(names.DIAGNOSTICS)) or ()}

        def frames_at(at_ns: int) -> Frames:
            return self._frames_of(levels.frames(at_ns), watched.mapped)

        moment = SceneContext(
            levels, frames_at, frames_at(levels.at_ns), diagnoses, watched.series, time, shown, self._unpacked
        )
        score = self._scores.of(levels.newest(names.SCORE))
        things = self._things.of(levels.newest(names.THINGS)) or ()
        news, commanders = watched.log.rooms(levels.at_ns), watched.log.commanders(levels.at_ns)
        return Scene(
            stamp_ns=levels.at_ns,
            time=time,
            grid=self._map(levels),
            robots=tuple(
                RobotSceneBuilder(member, moment).build(commanders.get(member.robot, "")) for member in watched.robots
            ),
            things=tuple(ThingScene(name, outline) for name, outline in things),
            rooms=tuple(_room(room, news.get(room.room.people, RoomStatus())) for room in watched.rooms),
            game=None if score is None else GameScene(score.score, score.visited, score.rooms),
            wizard=self._wizards.of(levels.newest(names.WIZARD)) or Wizard(),
            unreadable=watched.unreadable,
        )

    def _frames_of(self, messages: Sequence[WatchedMessage], mapped: bool) -> Frames:
        said = tuple(message.data for message in messages)
        for known, frames in self._frames:
            if len(known) == len(said) and all(one is other for one, other in zip(known, said, strict=True)):
                return frames
        self._frames.appendleft((said, Frames(messages, mapped)))
        return self._frames[0][1]

    def _map(self, levels: TopicSnapshot) -> OccupancyGrid | None:
        maps = [
            topic
            for topic, msgtype in levels.topics.items()
            if msgtype == types.OCCUPANCY_GRID and "costmap" not in topic
        ]
        found = (self._unpacked.grids.of(levels.newest(topic)) for topic in usual_first(maps, (names.MAP.strip("/"),)))
        return next((told[1] for told in found if told is not None), None)


def _room(room: MapRoom, news: RoomStatus) -> RoomMark:
    return RoomMark(
        room=room.room.people,
        name=room.name,
        region=np.array(room.region),
        state=news.state,
        found=news.found,
        robot=news.robot,
    )
