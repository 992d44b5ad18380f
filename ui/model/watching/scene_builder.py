"""Builder of the scene at a moment, from the messages that are valid at that moment."""

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import msgspec
import numpy as np

from sim.common.grid import OccupancyGrid
from sim.numerics.float_array import FloatArray
from thbridge.files.map_files import MapRoom
from thbridge.ros import names
from thbridge.ros.messages import types, unpack
from thbridge.ros.messages.pack import DiagnosticStatus
from thbridge.ros.robots import usual_first
from ui.model.shared.scene import RoomMark
from ui.model.watching.decode_cache import DecodeCache
from ui.model.watching.frames import Frames
from ui.model.watching.messages import TopicSnapshot, WatchedMessage
from ui.model.watching.robot_scene_builder import DecodedTopics, RobotSceneBuilder, SceneContext
from ui.model.watching.robots import WatchedRobot
from ui.model.watching.scene import Scene, ShownLayers, ThingScene, Wizard
from ui.model.watching.series import Series
from ui.model.watching.session_log import RoomStatus, SessionLog

FRAMES_KEPT = 8
"""Number of moments whose frames are cached: the moment of the scene, and the moments of the robots' scans."""


@dataclass(frozen=True, slots=True, eq=False)
class SceneInputs:
    """Inputs of a scene, in addition to the messages that are valid at its moment.

    Attributes:
        robots: robots with the names of their topics.
        mapped: True if there is a map.
        series: values over time.
        log: events, dialogue, lines and inputs.
        rooms: rooms of the map; empty if the map is unknown.
        start_ns: ROS time of the beginning, nanoseconds.
    """

    robots: tuple[WatchedRobot, ...]
    mapped: bool
    series: Series
    log: SessionLog
    rooms: tuple[MapRoom, ...]
    start_ns: int


class SceneBuilder:
    """Builder of successive scenes. Each message is decoded only once, even if several scenes contain it."""

    def __init__(self) -> None:
        self._decoded = DecodedTopics()
        self._things = DecodeCache[list[tuple[str, FloatArray]]](unpack.outlines)
        self._diagnoses = DecodeCache[list[DiagnosticStatus]](unpack.diagnostic_array)
        self._wizards = DecodeCache[Wizard](decode_wizard)
        self._frames: deque[tuple[tuple[bytes, ...], Frames]] = deque(maxlen=FRAMES_KEPT)

    def build(self, snapshot: TopicSnapshot, watched: SceneInputs, shown: ShownLayers) -> Scene:
        """Return the scene at the moment of these messages."""
        time = (snapshot.at_ns - watched.start_ns) / 1e9
        diagnoses = {each.name: each for each in self._diagnoses.of(snapshot.newest(names.DIAGNOSTICS)) or ()}

        def frames_at(at_ns: int) -> Frames:
            return self._frames_of(snapshot.frames(at_ns), watched.mapped)

        game_ns = watched.log.game_start(snapshot.at_ns)
        context = SceneContext(
            snapshot,
            frames_at,
            frames_at(snapshot.at_ns),
            diagnoses,
            watched.series,
            time,
            -math.inf if game_ns is None else (game_ns - watched.start_ns) / 1e9,
            shown,
            self._decoded,
        )

        def carried(robot: int) -> list[float]:
            return [(stamp - watched.start_ns) / 1e9 for stamp in watched.log.carried(robot)]

        things = self._things.of(snapshot.newest(names.THINGS)) or ()
        statuses, commanders = watched.log.rooms(snapshot.at_ns), watched.log.commanders(snapshot.at_ns)
        return Scene(
            stamp_ns=snapshot.at_ns,
            grid=self._map(snapshot),
            robots=tuple(
                RobotSceneBuilder(robot, context).build(commanders.get(robot.robot, ""), carried(robot.robot))
                for robot in watched.robots
            ),
            things=tuple(ThingScene(name, outline) for name, outline in things),
            rooms=tuple(_room(room, statuses.get(room.room.people, RoomStatus())) for room in watched.rooms),
            wizard=self._wizards.of(snapshot.newest(names.WIZARD)) or Wizard(),
        )

    def _frames_of(self, messages: Sequence[WatchedMessage], mapped: bool) -> Frames:
        data = tuple(message.data for message in messages)
        for known, frames in self._frames:
            if len(known) == len(data) and all(one is other for one, other in zip(known, data, strict=True)):
                return frames
        self._frames.appendleft((data, Frames(messages, mapped)))
        return self._frames[0][1]

    def _map(self, snapshot: TopicSnapshot) -> OccupancyGrid | None:
        maps = [
            topic
            for topic, msgtype in snapshot.topics.items()
            if msgtype == types.OCCUPANCY_GRID and "costmap" not in topic
        ]
        found = (self._decoded.grids.of(snapshot.newest(topic)) for topic in usual_first(maps, (names.MAP.strip("/"),)))
        return next((grid[1] for grid in found if grid is not None), None)


def decode_wizard(data: bytes) -> Wizard:
    """Decode a std_msgs/String of the topic `names.WIZARD`, which contains a `Wizard` as JSON.

    Raises:
        ValueError: the data are not a `Wizard` as JSON.
    """
    try:
        return msgspec.json.decode(unpack.string(data).encode(), type=Wizard)
    except msgspec.DecodeError as error:
        raise ValueError(str(error)) from None


def _room(room: MapRoom, status: RoomStatus) -> RoomMark:
    return RoomMark(
        room=room.room.people,
        name=room.name,
        region=np.array(room.region),
        state=status.state,
        found=status.found,
        robot=status.robot,
        answer=status.answer,
        answer_shorter=status.answer_shorter,
    )
