"""Somebody who plays a whole hunt by MAVLink alone, with pymavlink's `mavutil`, and hears nothing but frames."""

import math
import os
import re
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

os.environ["MAVLINK20"] = "1"
from pymavlink import mavutil

from tests.peers.window_player import TREASURES

mav = mavutil.mavlink

OWN = 255
PATIENCE = 2.0
"""Seconds until a command is said again."""

_DONE = object()

Deed = Iterator[None]
"""What one robot is led through; it goes on whenever something was heard."""


class Hunter:
    """A ground station that leads robots, all at once, from a thread of its own while it is entered.

    Args:
        port: UDP on this machine, to which robots speak.
        goals: of the rooms by number, meters east and north.
        names: of all treasures, in the order in which MAVLink numbers them.
    """

    def __init__(self, port: int, goals: dict[int, tuple[float, float]], names: Sequence[str]) -> None:
        self._master: Any = mavutil.mavlink_connection(
            f"udpin:127.0.0.1:{port}", source_system=OWN, source_component=190, dialect="all"
        )
        self._goals = goals
        self._names = names
        self._beaten = -math.inf
        self._robots: dict[int, Deed] = {}
        self._acks: dict[tuple[int, int], int] = {}
        self._asked: dict[int, tuple[str, int]] = {}
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self.heard: list[tuple[int, str]] = []
        """What robots told people, each with its number."""
        self.refused: list[tuple[int, int, int]] = []
        """Robot, command and result of what was refused."""

    @property
    def arrivals(self) -> list[tuple[int, int]]:
        """Which robot reached which room, in order."""
        found = ((robot, re.fullmatch(r"Robot \d+ is in room (\d+)\.", text)) for robot, text in self.heard)
        return [(robot, int(room[1])) for robot, room in found if room is not None]

    @property
    def score(self) -> int:
        """What naming treasures has brought."""
        found = (re.fullmatch(r"Room \d+: .*, ([+-]\d+) points\.", text) for _, text in self.heard)
        return sum(int(points[1]) for points in found if points is not None)

    @property
    def over(self) -> bool:
        """Whether somebody said that the game is."""
        if not self._thread.is_alive():
            raise RuntimeError("the hunter is gone")
        return any(text.startswith("The game is over") for _, text in self.heard)

    def __enter__(self) -> "Hunter":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self._thread.join()
        self._master.close()

    def lead(self, robot: int, rooms: Sequence[int]) -> None:
        """Arm a robot and send it from room to room; what is there it photographs, and calls it by its name."""
        self._robots[robot] = self._from_room_to_room(robot, rooms)

    def upload(self, robot: int, rooms: Sequence[int], guess: int) -> None:
        """Arm a robot and let it do the same by itself, as a mission; whatever is there is called the same."""
        self._robots[robot] = self._mission(robot, rooms, guess)

    def _run(self) -> None:
        while not self._over.wait(0.01):
            if time.monotonic() - self._beaten > 0.5:
                self._beaten = time.monotonic()
                self._master.mav.heartbeat_send(mav.MAV_TYPE_GCS, mav.MAV_AUTOPILOT_INVALID, 0, 0, 0)
            self._hear()
            for robot, deed in list(self._robots.items()):
                if next(deed, _DONE) is _DONE:
                    del self._robots[robot]
        self._hear()

    def _hear(self) -> None:
        while (told := self._master.recv_msg()) is not None:
            self._take(told)

    def _take(self, told: Any) -> None:
        robot = told.get_srcSystem()
        match told.get_type():
            case "COMMAND_ACK" if told.result != mav.MAV_RESULT_IN_PROGRESS:
                self._acks[robot, told.command] = told.result
            case "MISSION_REQUEST_INT" | "MISSION_REQUEST":
                self._asked[robot] = ("item", told.seq)
            case "MISSION_ACK":
                self._asked[robot] = ("ack", told.type)
            case "STATUSTEXT":
                self.heard.append((robot, told.text))

    def _from_room_to_room(self, robot: int, rooms: Sequence[int]) -> Deed:
        yield from self._arm(robot)
        for room in rooms:
            if (yield from self._sends(robot, room)) != mav.MAV_RESULT_ACCEPTED:
                continue
            found = None
            while (found := self._seen(robot, room)) is None:
                yield
            number = self._names.index(found) + 1
            yield from self._commands(robot, mav.MAV_CMD_IMAGE_START_CAPTURE, 0, 0, 1)
            while not self._told(robot, f"Room {room}: a picture was taken"):
                yield
            yield from self._commands(robot, mav.MAV_CMD_USER_1, number)
            while not self._told(robot, f"Room {room}: {found}"):
                yield

    def _sends(self, robot: int, room: int) -> Iterator[None]:
        reposition = mav.MAV_CMD_DO_REPOSITION
        east, north = (round(metres * 1e4) for metres in self._goals[room])
        order = (robot, 1, mav.MAV_FRAME_LOCAL_NED, reposition, 0, 0, -1, 1, 0, math.nan, north, east, 0)
        return self._says(robot, reposition, lambda: self._master.mav.command_int_send(*order))

    def _mission(self, robot: int, rooms: Sequence[int], guess: int) -> Deed:
        yield from self._arm(robot)
        items: list[tuple[int, tuple[float, ...]]] = []
        for room in rooms:
            east, north = self._goals[room]
            items += [
                (mav.MAV_CMD_NAV_WAYPOINT, (0, 0, 0, math.nan, round(north * 1e4), round(east * 1e4))),
                (mav.MAV_CMD_IMAGE_START_CAPTURE, (0, 0, 1, 0, 0, 0)),
                (mav.MAV_CMD_USER_1, (guess, 0, 0, 0, 0, 0)),
            ]
        while (yield from self._upload(robot, items)) != mav.MAV_MISSION_ACCEPTED:
            pass  # it was too slow for simulated time
        yield from self._commands(robot, mav.MAV_CMD_MISSION_START)
        while not all(self._told(robot, f"Room {room}: {self._names[guess - 1]}") for room in rooms):
            yield

    def _upload(self, robot: int, items: Sequence[tuple[int, tuple[float, ...]]]) -> Any:
        """Give a robot its mission, as it asks for it; what it says at the end."""
        self._asked.pop(robot, None)
        self._master.mav.mission_count_send(robot, 1, len(items))
        while (asked := self._asked.pop(robot, ("", 0)))[0] != "ack":
            if asked[0] == "item":
                command, values = items[asked[1]]
                self._master.mav.mission_item_int_send(
                    robot, 1, asked[1], mav.MAV_FRAME_LOCAL_NED, command, 0, 1, *values[:4], *map(int, values[4:]), 0
                )
            yield
        return asked[1]

    def _arm(self, robot: int) -> Deed:
        while (yield from self._commands(robot, mav.MAV_CMD_COMPONENT_ARM_DISARM, 1)) != mav.MAV_RESULT_ACCEPTED:
            self.refused.pop()  # the game has not begun yet

    def _commands(self, robot: int, command: int, *values: float) -> Iterator[None]:
        seven = [*values, *[0.0] * (7 - len(values))]
        return self._says(robot, command, lambda: self._master.mav.command_long_send(robot, 1, command, 0, *seven))

    def _says(self, robot: int, command: int, send: Callable[[], object]) -> Any:
        """Say a command until it is answered; what is answered."""
        self._acks.pop((robot, command), None)
        said = -math.inf
        while (robot, command) not in self._acks:
            if time.monotonic() - said > PATIENCE:
                said = time.monotonic()
                send()
            yield
        result = self._acks[robot, command]
        if result != mav.MAV_RESULT_ACCEPTED:
            self.refused.append((robot, command, result))
        return result

    def _told(self, robot: int, beginning: str) -> bool:
        return any(teller == robot and text.startswith(beginning) for teller, text in self.heard)

    def _seen(self, robot: int, room: int) -> str | None:
        """The name of what a robot senses in a room."""
        for (colour, footprint), name in TREASURES.items():
            if self._told(robot, f"Room {room}: something {colour.lower()}, {footprint.lower()}."):
                return name
        return None
