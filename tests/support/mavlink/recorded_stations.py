"""Recorded hunts with our own ground stations, in the same process."""

import asyncio
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from thbridge.app.compose.game import build_hider, build_keeper
from thbridge.app.compose.recording import build_publisher, build_record, build_writer
from thbridge.app.compose.robots import build_simr
from thbridge.app.compose.setting import read_setting
from thbridge.app.compose.vehicles import vehicle_factory
from thbridge.app.play import PLAY
from thbridge.app.replay.mavlink_replay import FramesOptions, FramesReplayed, replay_frames
from thbridge.app.session.broadcast import Broadcast
from thbridge.app.session.recording import BagRecorder
from thbridge.app.session.session import Session
from thbridge.mavlink.wire.dialect import Message, crc_extra, mav, payload_of
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.outgoing import LinkId
from thbridge.roles.participant.tabui import ParticipantUpdate, TabUI
from thbridge.roles.shared.view import ParticipantRequest, View
from thbridge.study.mavlink import MavlinkSection
from thbridge.study.study_file import Study
from thbridge.text_protocol.wire import legacy

STUDY = replace(Study(), seed=7, robots=2, mavlink=MavlinkSection(on=True))


class Station:
    """Ground station that is connected to a session by a separate link."""

    def __init__(
        self, session: Session, name: str = "udp 127.0.0.1:14550", system: int = 255, robot: int | None = None
    ) -> None:
        self._session = session
        self._system = system
        self._sequence = 0
        self._link: LinkId = session.links.open_link(name, robot)

    def say(self, message: Message) -> None:
        seed = crc_extra(message.get_msgId())
        assert seed is not None
        frame = Frame(self._system, 190, self._sequence, message.get_msgId(), payload_of(message), seed)
        self._sequence = (self._sequence + 1) % 256
        self._session.transmit(self._session.links.receive_frame(self._link, frame).replies)

    def beat(self) -> None:
        self.say(mav.MAVLink_heartbeat_message(mav.MAV_TYPE_GCS, mav.MAV_AUTOPILOT_INVALID, 0, 0, 0, 3))

    def leave(self) -> None:
        self._session.links.close_link(self._link)


class Follower:
    """Participant who watches the hunt, and sends no requests."""

    def requests(self, view: View) -> tuple[ParticipantRequest, ...]:
        return ()

    def observe(self, level: ParticipantUpdate) -> None:
        pass


def record(
    bag: Path, ticks: int, doing: Callable[[int, Session], None], study: Study = STUDY, follower: Follower | None = None
) -> None:
    """Record a hunt that nobody plays; call `doing`, which acts from outside the session, before each tick."""
    setting = read_setting(study, Path())
    simr = build_simr(setting)
    with build_writer(setting, bag) as writer:
        window = None if follower is None else TabUI(follower, follower)
        roles_within = [legacy.SIMR, legacy.HIDER, *([] if window is None else [window.name])]
        opening = build_record(setting, PLAY, roles_within, "" if window is None else "person")
        recorder = BagRecorder(Broadcast(build_publisher(setting), opening, setting.map.grid, [writer]))
        roles = [simr, build_hider(setting.templates, setting.study.seed)]
        session = Session(
            build_keeper(setting),
            roles,
            [recorder],
            () if window is None else (window,),
            vehicle_factory(setting, simr),
        )
        for tick in range(ticks):
            doing(tick, session)
            session.step()


def by_frames(bag: Path, study: Study = STUDY, to: Path | None = None) -> FramesReplayed:
    setting = read_setting(study, Path())
    return asyncio.run(replay_frames(bag, setting, FramesOptions(to=to), lambda tick_record: None))


def beating(stations: dict[str, Station]) -> Callable[[int, Session], None]:
    def beat(tick: int, session: Session) -> None:
        if tick == 10:
            stations["a"] = Station(session)
        if tick == 30:
            stations["b"] = Station(session, "tcp [::1]:5760", 254, robot=1)
        if tick % 25 == 10:
            for station in stations.values():
                station.beat()
        if tick == 90:
            stations.pop("b").leave()

    return beat


class Tour:
    """Ground station that arms the robots and sends each of them from room to room.

    In each room, the robot takes a picture, and the station identifies the find as the first treasure.
    """

    def __init__(self, rooms: dict[int, list[int]], study: Study = STUDY) -> None:
        self._left = rooms
        self._goals = [room.goal for room in read_setting(study, Path()).map.rooms]
        self._arrived = dict.fromkeys(rooms, 0)
        self._bound = dict.fromkeys(rooms, 0)

    def __call__(self, tick: int, session: Session) -> None:
        if tick == 20:
            self._station = Station(session)
        if tick >= 20 and tick % 50 == 20:
            self._station.beat()
        if tick == 30:
            for robot in self._left:
                self._order(robot, mav.MAV_CMD_COMPONENT_ARM_DISARM, 1)
        if tick < 50 or session.game is None:
            return
        for robot in self._left:
            state = session.game.robots[robot - 1]
            if state.bound_for is not None or state.at.people != self._bound[robot]:
                self._arrived[robot] = tick
            elif self._bound[robot] == 0 or tick - self._arrived[robot] == 30:
                self._send_on(robot)
            elif tick - self._arrived[robot] == 10:
                self._order(robot, mav.MAV_CMD_IMAGE_START_CAPTURE, 0, 0, 1)
            elif tick - self._arrived[robot] == 20:
                self._order(robot, mav.MAV_CMD_USER_1, 1)

    def _order(self, robot: int, command: int, *values: float) -> None:
        filled = (*values, *[0.0] * (7 - len(values)))
        self._station.say(mav.MAVLink_command_long_message(robot, 1, command, 0, *filled))

    def _send_on(self, robot: int) -> None:
        if not self._left[robot]:
            return
        self._bound[robot] = self._left[robot].pop(0)
        goal = self._goals[self._bound[robot] - 1]
        local, reposition = mav.MAV_FRAME_LOCAL_NED, mav.MAV_CMD_DO_REPOSITION
        north, east = round(goal.y * 1e4), round(goal.x * 1e4)
        order = (robot, 1, local, reposition, 0, 0, -1.0, 1.0, 0.0, math.nan, north, east, 0.0)
        self._station.say(mav.MAVLink_command_int_message(*order))
