"""Command table: the MAVLink commands that a vehicle knows, with carriers, access and execution.

Source: MAVLink's `common.xml`, MAV_CMD.
Differs: MISSION_START with zeros continues with the current item, as in ArduPilot, and not with item 0: ground stations
send it to continue too. To restart a mission, set item 0 as the current one.
"""

import math
from collections.abc import Callable, Mapping

from sim.common.geometry import Pose2
from thbridge.wire.mavlink.coordinates import GLOBAL, LOCAL, theta_of
from thbridge.wire.mavlink.dialect import mav
from thbridge.wire.mavlink.modes import Mode, mode_asked, mode_of_standard
from thbridge.wire.mavlink.options import AutopilotIdentity
from thbridge.wire.mavlink.vehicle.command.requests import (
    ACCEPTED,
    MALFORMED,
    CommandAccess,
    CommandCarrier,
    CommandReply,
    CommandResult,
    CommandSpec,
    ReceivedCommand,
    decimal_of,
    destination,
    reply_to,
)
from thbridge.wire.mavlink.vehicle.geodesy import MapProjection
from thbridge.wire.mavlink.vehicle.mode.home import HomePosition
from thbridge.wire.mavlink.vehicle.mode.operator_control import OperatorControl
from thbridge.wire.mavlink.vehicle.mode.state_machine import ModeStateMachine
from thbridge.wire.mavlink.vehicle_interface import Denied, Station, Target, VehicleInterface

_FORCED = frozenset({21196, 2989})
"""Values of the parameter "force" of arming: the standard's number, and MAVProxy's."""

_REPOSITION_CHANGES_MODE = 1
_LARGEST_ID = 0xFFFF
"""Largest number of a mission item."""


class CommandTable:
    """Commands of one vehicle.

    Args:
        robot: interface to the robot.
        modes: the robot's mode state machine.
        control: the station in command of the robot.
        home: home position.
        base_in_map: returns the robot's pose.
        earth: map projection.
        identity: autopilot that the vehicle presents itself as.
        requests: commands that request messages, by their numbers.
    """

    def __init__(
        self,
        helm: VehicleInterface,
        conduct: ModeStateMachine,
        command: OperatorControl,
        home: HomePosition,
        base_in_map: Callable[[], Pose2],
        earth: MapProjection,
        identity: AutopilotIdentity,
        requests: Mapping[int, CommandSpec],
    ) -> None:
        self._helm = helm
        self._conduct = conduct
        self._command = command
        self._home = home
        self._base_in_map = base_in_map
        self._earth = earth
        self._identity = identity
        places = GLOBAL | LOCAL
        by_commander = CommandAccess.COMMANDER
        self._known: dict[int, CommandSpec] = {
            **requests,
            mav.MAV_CMD_COMPONENT_ARM_DISARM: CommandSpec(self._arm_disarm),
            mav.MAV_CMD_RUN_PREARM_CHECKS: CommandSpec(lambda _: ACCEPTED),
            mav.MAV_CMD_DO_SET_MODE: CommandSpec(self._set_mode),
            mav.MAV_CMD_DO_SET_STANDARD_MODE: CommandSpec(self._set_standard_mode),
            mav.MAV_CMD_DO_PAUSE_CONTINUE: CommandSpec(self._pause_continue),
            mav.MAV_CMD_NAV_LOITER_UNLIM: CommandSpec(self._hold),
            mav.MAV_CMD_DO_REPOSITION: CommandSpec(self._reposition, CommandCarrier.INT, places, by_commander),
            mav.MAV_CMD_NAV_WAYPOINT: CommandSpec(self._waypoint, CommandCarrier.INT, places, by_commander),
            mav.MAV_CMD_NAV_RETURN_TO_LAUNCH: CommandSpec(self._return, who=by_commander),
            mav.MAV_CMD_DO_CHANGE_SPEED: CommandSpec(self._change_speed, who=by_commander),
            mav.MAV_CMD_MISSION_START: CommandSpec(self._start_mission, who=by_commander),
            mav.MAV_CMD_DO_SET_MISSION_CURRENT: CommandSpec(self._select_item),
            mav.MAV_CMD_DO_SET_HOME: CommandSpec(self._set_home, frames=places, who=CommandAccess.NO_RIVAL),
            mav.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN: CommandSpec(lambda _: _NO_REBOOT),
            mav.MAV_CMD_IMAGE_START_CAPTURE: CommandSpec(self._photograph, who=by_commander, once=True),
            mav.MAV_CMD_USER_1: CommandSpec(self._identify, CommandCarrier.LONG, who=by_commander, once=True),
            mav.MAV_CMD_USER_2: CommandSpec(self._leave, CommandCarrier.LONG, who=by_commander, once=True),
        }

    def find(self, number: int) -> CommandSpec | None:
        """Return the command of this number, if it is known."""
        return self._known.get(number)

    # -- command and modes --------------------------------------------------------------------------------------------

    def _arm_disarm(self, order: ReceivedCommand) -> CommandReply:
        match order.given(1):
            case 1.0:
                return reply_to(self._conduct.arm(order.station, by_force=order.given(2) in _FORCED))
            case 0.0:
                self._conduct.disarm()
                return ACCEPTED
        return MALFORMED

    def _set_mode(self, order: ReceivedCommand) -> CommandReply:
        base, main, sub = order.whole(1), order.whole(2), order.whole(3, otherwise=0)
        if base is None or main is None or sub is None:
            return MALFORMED
        return self.mode_reply(order.station, base, main, sub)

    def mode_reply(self, station: Station, base: int, main: int, sub: int) -> CommandReply:
        """Change the mode to the one of these numbers of DO_SET_MODE or SET_MODE."""
        mode: Mode | None
        if base & mav.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED:
            mode = mode_asked(self._identity, main, sub)
        else:
            mode = Mode.MANUAL if base & mav.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED else None
        if mode is None:
            return CommandReply(CommandResult.DENIED, sentence="There is no such mode.")
        return reply_to(self._conduct.choose(station, mode))

    def _set_standard_mode(self, order: ReceivedCommand) -> CommandReply:
        code = order.whole(1)
        mode = None if code is None else mode_of_standard(code)
        return MALFORMED if mode is None else reply_to(self._conduct.choose(order.station, mode))

    def _pause_continue(self, order: ReceivedCommand) -> CommandReply:
        match order.given(1):
            case 0.0:
                self._conduct.pause()
                return ACCEPTED
            case 1.0:
                objection = self._command.objection(order.station)
                return reply_to(objection or self._conduct.proceed())
        return MALFORMED

    def _hold(self, order: ReceivedCommand) -> CommandReply:
        self._conduct.stop()
        return ACCEPTED

    # -- goals --------------------------------------------------------------------------------------------------------

    def _reposition(self, order: ReceivedCommand) -> CommandReply:
        options = order.whole(2, otherwise=_REPOSITION_CHANGES_MODE)
        if options is None:
            return MALFORMED
        if not options & _REPOSITION_CHANGES_MODE and self._conduct.mode not in (Mode.GUIDED, Mode.HOLD):
            return CommandReply(
                CommandResult.DENIED, sentence=f"The robot is in mode {self._conduct.mode.value}, not GUIDED."
            )
        speed = order.given(1)
        return self._go(order, decimal_of(speed) if speed is not None and speed > 0.0 else None, order.given(4))

    def _waypoint(self, order: ReceivedCommand) -> CommandReply:
        yaw = order.given(4)
        reply = self._go(order, None, None if yaw is None else math.radians(yaw))
        way = self._conduct.sent
        if reply.result is not CommandResult.ACCEPTED or way is None:
            return reply
        return CommandReply(CommandResult.IN_PROGRESS, way=way)

    def _go(self, order: ReceivedCommand, speed: float | None, yaw: float | None) -> CommandReply:
        point = self._destination(order)
        if isinstance(point, Denied):
            return reply_to(point)
        if point is None:
            here = self._base_in_map()
            point = here.x, here.y
        if yaw == 0.0 and self._identity is AutopilotIdentity.ARDUPILOT:
            # Stations send 0 to ArduPilot for an open heading; its own rovers ignore this parameter.
            yaw = None
        return reply_to(self._conduct.go(Target(*point, None if yaw is None else theta_of(yaw)), speed))

    def _destination(self, order: ReceivedCommand) -> tuple[float, float] | Denied | None:
        return destination(order, self._base_in_map(), self._earth)

    def _return(self, order: ReceivedCommand) -> CommandReply:
        return reply_to(self._conduct.go_home())

    def _change_speed(self, order: ReceivedCommand) -> CommandReply:
        kind, speed = order.whole(1, otherwise=mav.SPEED_TYPE_GROUNDSPEED), order.given(2)
        if kind not in (mav.SPEED_TYPE_AIRSPEED, mav.SPEED_TYPE_GROUNDSPEED):
            return MALFORMED
        if speed is None or speed == -1.0:
            return ACCEPTED
        if speed == -2.0:
            return reply_to(self._helm.limit_speed(-1.0))
        return reply_to(self._helm.limit_speed(decimal_of(speed))) if speed > 0.0 else MALFORMED

    def _start_mission(self, order: ReceivedCommand) -> CommandReply:
        first, last = order.whole(1, otherwise=0), order.whole(2, otherwise=0)
        if first is None or last is None:
            return MALFORMED
        # Stations that want to continue, or the whole mission, send zeros.
        return reply_to(self._conduct.run(first or None, last or None))

    def _select_item(self, order: ReceivedCommand) -> CommandReply:
        item = order.whole(1)
        if item is None or item > _LARGEST_ID:
            return MALFORMED
        objection = self._command.objection(order.station) if self._conduct.mode is Mode.AUTO else None
        return reply_to(objection or self._conduct.select(item))

    def _set_home(self, order: ReceivedCommand) -> CommandReply:
        is_here, point = order.whole(1, otherwise=0), self._destination(order)
        if is_here not in (0, 1):
            return MALFORMED
        if is_here or point is None:
            return reply_to(self._home.set_here())
        if isinstance(point, Denied):
            return reply_to(point)
        return reply_to(self._home.set_to(Target(*point)))

    # -- the game -----------------------------------------------------------------------------------------------------

    def _photograph(self, order: ReceivedCommand) -> CommandReply:
        pictures = order.whole(3, otherwise=1)
        if pictures is None or pictures > 1:
            return CommandReply(CommandResult.DENIED, sentence="One picture at a time.")
        return reply_to(self._helm.photograph())

    def _identify(self, order: ReceivedCommand) -> CommandReply:
        number = order.whole(1)
        return MALFORMED if not number else reply_to(self._helm.identify(number))

    def _leave(self, order: ReceivedCommand) -> CommandReply:
        return reply_to(self._helm.leave())


_NO_REBOOT = CommandReply(CommandResult.DENIED, sentence="A robot of a running game is not restarted.")
