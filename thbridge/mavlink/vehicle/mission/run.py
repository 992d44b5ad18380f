"""Mission execution: one item after the other, through the vehicle interface.

Source: the MAVLink developer guide, "Mission Protocol", and the descriptions in MAV_CMD.
Differs: a waypoint is reached when the robot has arrived there, never by passing within the acceptance radius, because
a point in a room is a move of the game and ends at that room's own place.
"""

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace

from sim.common.observations import TICKS_PER_SECOND
from thbridge.mavlink.values.options import VisitedRooms
from thbridge.mavlink.values.vehicle_interface import (
    DenialKind,
    Denied,
    LegState,
    RobotReadings,
    Station,
    Target,
    VehicleInterface,
)
from thbridge.mavlink.vehicle.geodesy import GeoPoint, MapProjection
from thbridge.mavlink.vehicle.mission.ids import MissionCurrent, plan_id
from thbridge.mavlink.vehicle.mission.items import MissionItem
from thbridge.mavlink.vehicle.mode.home import HomePosition
from thbridge.mavlink.vehicle.parts import Announce, TextSeverity
from thbridge.mavlink.wire.coordinates import PER_METRE, theta_of
from thbridge.mavlink.wire.dialect import mav
from thbridge.mavlink.wire.outgoing import OutgoingMessage

_HOME = MissionItem(mav.MAV_CMD_NAV_WAYPOINT, mav.MAV_FRAME_GLOBAL)
"""Placeholder in a plan for the home position, which may change."""

_NO_TOTAL = 2**16 - 1
"""Total number of items when there is no mission."""

_IN_MISSION_MODE, _SUSPENDED = 1, 2

_IN_ROOM = frozenset((mav.MAV_CMD_IMAGE_START_CAPTURE, mav.MAV_CMD_USER_1, mav.MAV_CMD_USER_2))
"""Commands about the treasure of the room to which the item before them has led."""

_UNLIMITED = -1
"""Repeats of a jump without end."""


@dataclass(frozen=True, slots=True)
class _Driving:
    """Stage of an item that waits for the end of the mission's leg."""


@dataclass(frozen=True, slots=True)
class _Waiting:
    """Stage of an item that waits for this tick; infinity: for ever."""

    until: float


@dataclass(frozen=True, slots=True)
class _Jump:
    """Jump to this item."""

    to: int


@dataclass(frozen=True, slots=True)
class _Skip:
    """Skip the item, for this reason."""

    sentence: str


_Stage = _Driving | _Waiting
"""Stage of an item in execution."""


class MissionRun:
    """Mission of one robot, and its state.

    Args:
        robot: interface to the robot.
        home: home position.
        earth: map projection.
        announce: sends texts about the mission to people.
        ardupilot: read plans as ArduPilot does: the first item is home, whatever a station sends for it, headings at
            waypoints are free, and a mission continues by itself, whatever `autocontinue` is.
        visited_rooms: action at an item that leads into a room that was visited already.

    Attributes:
        plan: all items; the first of an ArduPilot plan is a placeholder for home.
        plan_id: id of the plan.
        current_item: number of the item that is or will be executed.
    """

    def __init__(
        self,
        robot: VehicleInterface,
        home: HomePosition,
        earth: MapProjection,
        announce: Announce,
        ardupilot: bool,
        visited_rooms: VisitedRooms = VisitedRooms.HALT,
    ) -> None:
        self._ardupilot = ardupilot
        self._robot = robot
        self._home = home
        self._earth = earth
        self._announce = announce
        self._skips = visited_rooms is VisitedRooms.SKIP
        self.plan: tuple[MissionItem, ...] = ()
        self.plan_id = plan_id(())
        self.current_item = 0
        self._last: int | None = None
        self._state: int = mav.MISSION_STATE_NOT_STARTED
        self._stage: _Stage | None = None
        # The leg that the robot drives for the mission.
        self._leg: int | None = None
        self._jumps: Counter[int] = Counter()
        # The items that were skipped since the robot last arrived anywhere, and whether the last one with a place was.
        self._skipped: set[int] = set()
        self._is_elsewhere = False
        self._commander: str | None = None

    @property
    def readable(self) -> tuple[MissionItem, ...]:
        """Items for download: those of the plan, with ArduPilot's home even when the plan is empty."""
        return (self._home_item(), *self.plan[1:]) if self._ardupilot else self.plan

    @property
    def running(self) -> bool:
        """True while items are executed; it stops by itself at its end, and where an item fails."""
        return self._state == mav.MISSION_STATE_ACTIVE

    def is_home(self, item: int) -> bool:
        """Return True when this item is ArduPilot's home."""
        return self._ardupilot and item == 0

    def current(self) -> MissionCurrent:
        """Return MISSION_CURRENT."""
        state, total = (self._state, self._size) if self._size > 0 else (mav.MISSION_STATE_NO_MISSION, _NO_TOTAL)
        mode = _IN_MISSION_MODE if self.running else _SUSPENDED
        return MissionCurrent(self.current_item, total, state, mode, self.plan_id)

    def objection(self, station: Station) -> Denied | None:
        """Return a denial when the mission runs by the command of another station."""
        if self.running and self._commander not in (None, str(station)):
            return Denied(f"A mission of {self._commander} is under way.", DenialKind.NOT_NOW)
        return None

    def replace(self, plan: tuple[MissionItem, ...]) -> None:
        """Replace the plan.

        A running or paused mission keeps its current item if both plans are equal up to that, and restarts otherwise.
        """
        if self._ardupilot and plan:
            plan = (_HOME, *plan[1:])
        done = self.current_item + 1
        is_begun = self._state in (mav.MISSION_STATE_ACTIVE, mav.MISSION_STATE_PAUSED)
        goes_on = is_begun and len(plan) >= done and plan[:done] == self.plan[:done]
        self.plan, self.plan_id, self._last = plan, plan_id(plan), None
        if not goes_on:
            self._restart_at(0)
            if self._size <= 0 or not self.running:
                self._stand()
                self._state = mav.MISSION_STATE_NOT_STARTED

    def misplaced(self, item: MissionItem) -> Denied | None:
        """Return the denial of an item whose place the robot can never get to; None when it can, or has no place."""
        if not item.has_place or item.is_here:
            return None
        sets_home = item.command == mav.MAV_CMD_DO_SET_HOME
        return (self._robot.misplaced if sets_home else self._robot.unreachable)(*self._point(item))

    def start(self, first: int | None = None, last: int | None = None) -> Denied | None:
        """Execute the mission.

        Args:
            first: the item to begin with; None: the current one, and item 0 after the mission's end.
            last: the item to end with; None: the last.
        """
        if self._size <= 0:
            return Denied("There is no mission.", DenialKind.NOT_NOW)
        if first is None and self._state == mav.MISSION_STATE_COMPLETE:
            first = 0
        if first is not None and first not in range(len(self.plan)):
            return Denied(f"The mission has no item {first}.")
        if last is not None and last not in range(self.current_item if first is None else first, len(self.plan)):
            return Denied(f"The mission cannot end with item {last}.")
        if first is not None:
            self._restart_at(first)
        self._last = last
        self._state = mav.MISSION_STATE_ACTIVE
        return None

    def pause(self) -> None:
        """Stop the execution; the current item begins again when the mission continues."""
        if self.running:
            self._state = mav.MISSION_STATE_PAUSED
            self._stage = self._leg = None

    def select(self, item: int) -> Denied | None:
        """Continue with this item, now if the mission runs and else when it starts."""
        if item not in range(len(self.plan)):
            return Denied(f"The mission has no item {item}.")
        self._restart_at(item)
        if self._state == mav.MISSION_STATE_COMPLETE:
            self._state = mav.MISSION_STATE_PAUSED
        return None

    def step(self, tick: int, readings: RobotReadings) -> Iterator[OutgoingMessage]:
        """Advance the mission by one tick."""
        self._commander = readings.commander
        if not self.running:
            return
        item = self.plan[self.current_item]
        stage = self._begin(item, tick) if self._stage is None else self._continue(self._stage, item, tick, readings)
        match stage:
            case Denied(sentence):
                self._stand()
                self.pause()
                self._announce(TextSeverity.WARNING, f"Mission halted at item {self.current_item}. {sentence}")
                yield OutgoingMessage(self.current())
            case _Skip(sentence):
                # The robot may still drive for an item that `select` replaced by this one.
                self._stand()
                self._announce(TextSeverity.NOTICE, f"Mission item {self.current_item} skipped. {sentence}")
                yield from self._proceed(item)
            case _Jump(to):
                self._go(to)
                yield OutgoingMessage(self.current())
            case None:
                yield from self._done(item)
            case _Waiting() if self._stage is None:
                self._stand()  # See above.
                self._stage = stage
            case _:
                self._stage = stage

    @property
    def _size(self) -> int:
        """Number of items to execute."""
        return len(self.plan) - self._ardupilot

    def _home_item(self) -> MissionItem:
        place = self._home.place
        return replace(_HOME, x=place.latitude, y=place.longitude, z=self._earth.altitude)

    def _go(self, item: int) -> None:
        """Make this item the current one, to be begun."""
        self.current_item, self._stage = item, None

    def _restart_at(self, item: int) -> None:
        """Make this item the current one, as if the mission began with it."""
        self._go(item)
        self._jumps.clear()
        self._skipped.clear()
        self._is_elsewhere = False

    def _begin(self, item: MissionItem, tick: int) -> _Stage | _Jump | _Skip | Denied | None:
        """Begin an item and return its stage; None when it is done at once."""
        if self.is_home(self.current_item):
            return None
        first, second, _, _ = item.params
        match item.command:
            case command if self._is_elsewhere and command in _IN_ROOM:
                return self._skip(Denied("It is for the room that was skipped."))
            case mav.MAV_CMD_NAV_WAYPOINT | mav.MAV_CMD_NAV_LOITER_TIME | mav.MAV_CMD_NAV_LOITER_UNLIM:
                return self._leg_to(self._target(item)) if item.has_place else _stay(item, tick)
            case mav.MAV_CMD_NAV_RETURN_TO_LAUNCH:
                return self._leg_to(self._home.target)
            case mav.MAV_CMD_DO_SET_HOME if item.is_here:
                return self._home.set_here()
            case mav.MAV_CMD_DO_SET_HOME:
                return self._home.set_to(Target(*self._point(item)))
            case mav.MAV_CMD_NAV_DELAY | mav.MAV_CMD_CONDITION_DELAY:
                return _Waiting(tick + first * TICKS_PER_SECOND)
            case mav.MAV_CMD_DO_JUMP:
                return self._jump(int(first), int(second))
            case mav.MAV_CMD_DO_CHANGE_SPEED:
                # NaN and -1 keep the limit; -2, as all numbers below zero, restores the study's.
                return None if math.isnan(second) or second == -1 else self._robot.limit_speed(second)
            case mav.MAV_CMD_IMAGE_START_CAPTURE:
                return self._robot.photograph()
            case mav.MAV_CMD_USER_1:
                return self._robot.identify(int(first))
            case _:
                return self._robot.leave()

    def _continue(self, stage: _Stage, item: MissionItem, tick: int, readings: RobotReadings) -> _Stage | Denied | None:
        """Return an item's stage one tick later; None when it is done."""
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

    def _done(self, item: MissionItem) -> Iterator[OutgoingMessage]:
        """End the current item."""
        if not self.is_home(self.current_item):
            yield OutgoingMessage(mav.MAVLink_mission_item_reached_message(self.current_item))
        yield from self._proceed(item)

    def _proceed(self, item: MissionItem) -> Iterator[OutgoingMessage]:
        """Go on with the next item, or end the mission."""
        if self.current_item in (self._last, len(self.plan) - 1):
            self._stand()
            self._state, self._stage = mav.MISSION_STATE_COMPLETE, None
            self._announce(TextSeverity.INFO, "Mission complete.")
        else:
            self._go(self.current_item + 1)
            if not (item.autocontinue or self._ardupilot):
                self._stand()
                self.pause()
                self._announce(TextSeverity.NOTICE, f"Mission waits before item {self.current_item}, as its plan says.")
        yield OutgoingMessage(self.current())

    def _leg_to(self, target: Target) -> _Driving | _Skip | Denied:
        number = self._robot.go_to(target)
        if isinstance(number, Denied):
            if not (number.is_done and self._skips):
                return number
            self._is_elsewhere = True
            return self._skip(number)
        self._leg, self._is_elsewhere = number, False
        return _Driving()

    def _skip(self, denied: Denied) -> _Skip | Denied:
        """Skip the current item; halt where it comes again without a way in between: nothing is left to do."""
        if self.current_item in self._skipped:
            return denied
        self._skipped.add(self.current_item)
        return _Skip(denied.sentence)

    def _stand(self) -> None:
        """Halt the robot if it drives for the mission."""
        if self._leg is not None:
            self._robot.halt()
            self._leg = None

    def _jump(self, to: int, repeats: int) -> _Jump | None:
        if repeats != _UNLIMITED and self._jumps[self.current_item] >= repeats:
            return None
        self._jumps[self.current_item] += 1
        return _Jump(to)

    def _target(self, item: MissionItem) -> Target:
        """Return the goal of an item, with the heading there."""
        yaw = item.params[3]
        looks_anywhere = self._ardupilot or item.command == mav.MAV_CMD_NAV_LOITER_TIME or math.isnan(yaw)
        return Target(*self._point(item), None if looks_anywhere else theta_of(math.radians(yaw)))

    def _point(self, item: MissionItem) -> tuple[float, float]:
        """Return the place of an item, metres east and north in the map."""
        if item.frame == mav.MAV_FRAME_LOCAL_NED:
            return item.y / PER_METRE, item.x / PER_METRE
        return self._earth.map_point(GeoPoint(item.x, item.y))


def _stay(item: MissionItem, tick: int) -> _Waiting | None:
    """Return the stage in which the robot stays at an item's place; None when it does not stay."""
    match item.command:
        case mav.MAV_CMD_NAV_WAYPOINT | mav.MAV_CMD_NAV_LOITER_TIME if item.params[0] > 0.0:
            return _Waiting(tick + item.params[0] * TICKS_PER_SECOND)
        case mav.MAV_CMD_NAV_LOITER_UNLIM:
            return _Waiting(math.inf)
        case _:
            return None
