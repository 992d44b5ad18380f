"""Mission of a robot: its plan, and the item in execution.

Source: the MAVLink developer guide, "Mission Protocol".
"""

from collections.abc import Iterator
from dataclasses import replace

from thbridge.mavlink.values.options import VisitedRooms
from thbridge.mavlink.values.vehicle_interface import (
    DenialKind,
    Denied,
    RobotReadings,
    Station,
    VehicleInterface,
)
from thbridge.mavlink.vehicle.geodesy import MapProjection
from thbridge.mavlink.vehicle.mission.ids import MissionCurrent, plan_id
from thbridge.mavlink.vehicle.mission.item_execution import ItemExecution, ItemJump, ItemSkip
from thbridge.mavlink.vehicle.mission.items import MissionItem
from thbridge.mavlink.vehicle.mode.home import HomePosition
from thbridge.mavlink.vehicle.parts import Announce, TextSeverity
from thbridge.mavlink.wire.dialect import mav
from thbridge.mavlink.wire.outgoing import OutgoingMessage

_HOME = MissionItem(mav.MAV_CMD_NAV_WAYPOINT, mav.MAV_FRAME_GLOBAL)
"""Placeholder in a plan for the home position. The home position itself can change."""

_NO_TOTAL = 2**16 - 1
"""Value of `total` in MISSION_CURRENT if there is no mission."""

_IN_MISSION_MODE, _SUSPENDED = 1, 2


class MissionRun:
    """Mission of one robot, and its state.

    Args:
        robot: interface to the robot.
        home: home position.
        earth: map projection.
        announce: sends texts about the mission to people.
        ardupilot: True if plans are treated as in ArduPilot. The first item is home, even if a station sends another
            item. Headings at waypoints are ignored. A mission continues automatically, even if `autocontinue` is False.
        visited_rooms: action at an item that leads into an already visited room.

    Attributes:
        plan: all items. The first item of an ArduPilot plan is a placeholder for home.
        plan_id: id of the plan.
        execution: execution of its items.
        current_item: number of the item that is executed or will be executed next.
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
        self._home = home
        self._earth = earth
        self._announce = announce
        self.execution = ItemExecution(robot, home, earth, ardupilot, visited_rooms)
        self.plan: tuple[MissionItem, ...] = ()
        self.plan_id = plan_id(())
        self.current_item = 0
        self._last: int | None = None
        self._state: int = mav.MISSION_STATE_NOT_STARTED
        self._commander: str | None = None

    @property
    def readable(self) -> tuple[MissionItem, ...]:
        """Items for download: the items of the plan. For ArduPilot, there is a home item even if the plan is empty."""
        return (self._home_item(), *self.plan[1:]) if self._ardupilot else self.plan

    @property
    def running(self) -> bool:
        """True while items are executed. It becomes False when the mission ends or an item fails."""
        return self._state == mav.MISSION_STATE_ACTIVE

    def is_home(self, item: int) -> bool:
        """Return True if this item is ArduPilot's home."""
        return self._ardupilot and item == 0

    def current(self) -> MissionCurrent:
        """Return MISSION_CURRENT."""
        state, total = (self._state, self._size) if self._size > 0 else (mav.MISSION_STATE_NO_MISSION, _NO_TOTAL)
        mode = _IN_MISSION_MODE if self.running else _SUSPENDED
        return MissionCurrent(self.current_item, total, state, mode, self.plan_id)

    def objection(self, station: Station) -> Denied | None:
        """Return a denial if the mission of another station is running."""
        if self.running and self._commander not in (None, str(station)):
            return Denied(f"A mission of {self._commander} is under way.", DenialKind.NOT_NOW)
        return None

    def replace(self, plan: tuple[MissionItem, ...]) -> None:
        """Replace the plan.

        If both plans are equal up to the current item, a running or paused mission continues with this item.
        Otherwise it restarts.
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
                self.execution.stand()
                self._state = mav.MISSION_STATE_NOT_STARTED

    def start(self, first: int | None = None, last: int | None = None) -> Denied | None:
        """Execute the mission.

        Args:
            first: number of the first item. If None, start with the current item, or with item 0 if the mission has
                ended.
            last: number of the last item. If None, execute the plan to its end.
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
        """Stop the execution. When the mission resumes, the current item begins again."""
        if self.running:
            self._state = mav.MISSION_STATE_PAUSED
            self.execution.drop()

    def select(self, item: int) -> Denied | None:
        """Make this item the next item. A running mission continues with it at once; other missions start with it."""
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
        number, item = self.current_item, self.plan[self.current_item]
        # ArduPilot's home is only stored in the plan. The mission continues with the next item at once.
        match None if self.is_home(number) else self.execution.step(number, item, tick, readings):
            case Denied(sentence):
                self.pause()
                self._announce(TextSeverity.WARNING, f"Mission halted at item {number}. {sentence}")
                yield OutgoingMessage(self.current())
            case ItemSkip(sentence):
                self._announce(TextSeverity.NOTICE, f"Mission item {number} skipped. {sentence}")
                yield from self._proceed(item)
            case ItemJump(to):
                self.current_item = to
                yield OutgoingMessage(self.current())
            case None:
                if not self.is_home(number):
                    yield OutgoingMessage(mav.MAVLink_mission_item_reached_message(number))
                yield from self._proceed(item)

    @property
    def _size(self) -> int:
        """Number of items to execute."""
        return len(self.plan) - self._ardupilot

    def _home_item(self) -> MissionItem:
        place = self._home.place
        return replace(_HOME, x=place.latitude, y=place.longitude, z=self._earth.altitude)

    def _restart_at(self, item: int) -> None:
        """Make this item the current item, as if the mission started with it."""
        self.current_item = item
        self.execution.restart()

    def _proceed(self, item: MissionItem) -> Iterator[OutgoingMessage]:
        """Continue with the next item, or end the mission."""
        if self.current_item in (self._last, len(self.plan) - 1):
            self.execution.stand()
            self._state = mav.MISSION_STATE_COMPLETE
            self._announce(TextSeverity.INFO, "Mission complete.")
        else:
            self.current_item += 1
            if not (item.autocontinue or self._ardupilot):
                self.execution.stand()
                self.pause()
                self._announce(TextSeverity.NOTICE, f"Mission waits before item {self.current_item}, as its plan says.")
        yield OutgoingMessage(self.current())
