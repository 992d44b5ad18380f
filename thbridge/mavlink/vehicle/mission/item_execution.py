"""Execution of mission items, one at a time, through the vehicle interface.

Source: the MAVLink developer guide, "Mission Protocol", and the descriptions in MAV_CMD.
Differences from the source: a robot reaches a waypoint only by arriving at it, not by passing within the acceptance
radius. The reason is that a point in a room is a move of the game, and ends at the goal pose of that room.
"""

import math
from collections import Counter
from dataclasses import dataclass

from sim.common.observations import TICKS_PER_SECOND
from thbridge.mavlink.values.options import VisitedRooms
from thbridge.mavlink.values.vehicle_interface import Denied, LegState, RobotReadings, Target, VehicleInterface
from thbridge.mavlink.vehicle.geodesy import GeoPoint, MapProjection
from thbridge.mavlink.vehicle.mission.items import MissionItem
from thbridge.mavlink.vehicle.mode.home import HomePosition
from thbridge.mavlink.wire.coordinates import PER_METRE, theta_of
from thbridge.mavlink.wire.dialect import mav

_IN_ROOM = frozenset((mav.MAV_CMD_IMAGE_START_CAPTURE, mav.MAV_CMD_USER_1, mav.MAV_CMD_USER_2))
"""Commands about the treasure in the room to which the previous item has sent the robot."""

_UNLIMITED = -1
"""Number of repeats of an endless jump."""


@dataclass(frozen=True, slots=True)
class _Driving:
    """Stage of an item that waits for the end of the mission's leg."""


@dataclass(frozen=True, slots=True)
class _Waiting:
    """Stage of an item that waits until this tick. If it is infinite, the item waits forever."""

    until: float


@dataclass(frozen=True, slots=True)
class ItemJump:
    """Jump to the item with this number."""

    to: int


@dataclass(frozen=True, slots=True)
class ItemSkip:
    """Decision to skip the item. `sentence` is the reason."""

    sentence: str


_Stage = _Driving | _Waiting
"""Stage of an item in execution."""


class ItemExecution:
    """Execution of the mission items of one robot.

    Args:
        robot: interface to the robot.
        home: home position.
        earth: map projection.
        ardupilot: True if headings at waypoints are ignored, as in ArduPilot.
        visited_rooms: action at an item that leads into an already visited room.
    """

    def __init__(
        self,
        robot: VehicleInterface,
        home: HomePosition,
        earth: MapProjection,
        ardupilot: bool,
        visited_rooms: VisitedRooms,
    ) -> None:
        self._robot = robot
        self._home = home
        self._earth = earth
        self._ardupilot = ardupilot
        self._skips = visited_rooms is VisitedRooms.SKIP
        self._stage: _Stage | None = None
        # Leg that the robot drives for the mission.
        self._leg: int | None = None
        self._jumps: Counter[int] = Counter()
        # `_skipped`: items that were skipped since the robot's last arrival. `_is_elsewhere`: True if the last item
        # with a place was skipped.
        self._skipped: set[int] = set()
        self._is_elsewhere = False

    def misplaced(self, item: MissionItem) -> Denied | None:
        """Return a denial if the robot can never reach the place of an item. Return None for all other items."""
        if not item.has_place or item.is_here:
            return None
        sets_home = item.command == mav.MAV_CMD_DO_SET_HOME
        return (self._robot.misplaced if sets_home else self._robot.unreachable)(*self._point(item))

    def step(
        self, number: int, item: MissionItem, tick: int, readings: RobotReadings
    ) -> _Stage | ItemJump | ItemSkip | Denied | None:
        """Begin or continue the item with this number. Return its stage or result. None means that it is done."""
        stage = self._stage
        result = self._begin(number, item, tick) if stage is None else self._continue(stage, item, tick, readings)
        if isinstance(result, Denied | ItemSkip) or (isinstance(result, _Waiting) and stage is None):
            # The robot may still drive for an item that this item has replaced.
            self.stand()
        self._stage = result if isinstance(result, _Driving | _Waiting) else None
        return result

    def stand(self) -> None:
        """Stop the robot if it is driving for the mission."""
        if self._leg is not None:
            self._robot.stop_robot()
            self._leg = None

    def drop(self) -> None:
        """Stop executing the item. Later it begins again from its start. The caller must stop the robot."""
        self._stage = self._leg = None

    def restart(self) -> None:
        """Forget the progress, as if the mission started with the next item."""
        self._stage = None
        self._jumps.clear()
        self._skipped.clear()
        self._is_elsewhere = False

    def _begin(self, number: int, item: MissionItem, tick: int) -> _Stage | ItemJump | ItemSkip | Denied | None:
        """Begin an item. Return its stage or its result. None means that it is done at once."""
        first, second, _, _ = item.params
        match item.command:
            case command if self._is_elsewhere and command in _IN_ROOM:
                return self._skip(number, Denied("It is for the room that was skipped."))
            case mav.MAV_CMD_NAV_WAYPOINT | mav.MAV_CMD_NAV_LOITER_TIME | mav.MAV_CMD_NAV_LOITER_UNLIM:
                return self._leg_to(number, self._target(item)) if item.has_place else _stay(item, tick)
            case mav.MAV_CMD_NAV_RETURN_TO_LAUNCH:
                return self._leg_to(number, self._home.target)
            case mav.MAV_CMD_DO_SET_HOME if item.is_here:
                return self._home.set_here()
            case mav.MAV_CMD_DO_SET_HOME:
                return self._home.set_to(Target(*self._point(item)))
            case mav.MAV_CMD_NAV_DELAY | mav.MAV_CMD_CONDITION_DELAY:
                return _Waiting(tick + first * TICKS_PER_SECOND)
            case mav.MAV_CMD_DO_JUMP:
                return self._jump(number, int(first), int(second))
            case mav.MAV_CMD_DO_CHANGE_SPEED:
                # NaN and -1 keep the limit. Other negative numbers, such as -2, restore the study's limit.
                return None if math.isnan(second) or second == -1 else self._robot.limit_speed(second)
            case mav.MAV_CMD_IMAGE_START_CAPTURE:
                return self._robot.photograph()
            case mav.MAV_CMD_USER_1:
                return self._robot.identify(int(first))
            case _:
                return self._robot.leave()

    def _continue(self, stage: _Stage, item: MissionItem, tick: int, readings: RobotReadings) -> _Stage | Denied | None:
        """Return the stage of an item one tick later. None means that it is done."""
        if isinstance(stage, _Waiting):
            return stage if tick < stage.until else None
        leg = readings.leg
        if leg is None or leg.number != self._leg or leg.state is LegState.UNDER_WAY:
            return stage
        self._leg = None
        if leg.state is LegState.FAILED:
            return Denied(leg.reason or "The robot did not get there.")
        self._skipped.clear()
        return _stay(item, tick)

    def _leg_to(self, item: int, target: Target) -> _Driving | ItemSkip | Denied:
        leg = self._robot.go_to(target)
        if isinstance(leg, Denied):
            if not (leg.is_done and self._skips):
                return leg
            self._is_elsewhere = True
            return self._skip(item, leg)
        self._leg, self._is_elsewhere = leg, False
        return _Driving()

    def _skip(self, item: int, denied: Denied) -> ItemSkip | Denied:
        """Skip an item. If it was skipped since the last arrival, deny it, because nothing is left to do."""
        if item in self._skipped:
            return denied
        self._skipped.add(item)
        return ItemSkip(denied.sentence)

    def _jump(self, item: int, to: int, repeats: int) -> ItemJump | None:
        if repeats != _UNLIMITED and self._jumps[item] >= repeats:
            return None
        self._jumps[item] += 1
        return ItemJump(to)

    def _target(self, item: MissionItem) -> Target:
        """Return the goal of an item, including the heading."""
        yaw = item.params[3]
        looks_anywhere = self._ardupilot or item.command == mav.MAV_CMD_NAV_LOITER_TIME or math.isnan(yaw)
        return Target(*self._point(item), None if looks_anywhere else theta_of(math.radians(yaw)))

    def _point(self, item: MissionItem) -> tuple[float, float]:
        """Return the place of an item, meters east and north in the map."""
        if item.frame == mav.MAV_FRAME_LOCAL_NED:
            return item.y / PER_METRE, item.x / PER_METRE
        return self._earth.map_point(GeoPoint(item.x, item.y))


def _stay(item: MissionItem, tick: int) -> _Waiting | None:
    """Return the stage in which the robot stays at an item's place. Return None if it does not stay."""
    match item.command:
        case mav.MAV_CMD_NAV_WAYPOINT | mav.MAV_CMD_NAV_LOITER_TIME if item.params[0] > 0.0:
            return _Waiting(tick + item.params[0] * TICKS_PER_SECOND)
        case mav.MAV_CMD_NAV_LOITER_UNLIM:
            return _Waiting(math.inf)
        case _:
            return None
