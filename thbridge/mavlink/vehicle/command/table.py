"""Command table: the MAVLink commands of a vehicle, with allowed messages, allowed stations and execution.

Source: MAVLink's `common.xml`, MAV_CMD.
Differences from the source: MISSION_START with zeros continues with the current item, as in ArduPilot, and not with
item 0. The reason is that ground stations also send it to continue. To restart a mission, set item 0 as the current
item.
"""

import math
from collections.abc import Callable, Mapping

from sim.common.geometry import Pose2
from thbridge.mavlink.values.options import AutopilotIdentity
from thbridge.mavlink.values.vehicle_interface import Denied, Station, Target, VehicleInterface
from thbridge.mavlink.vehicle.command.requests import (
    ACCEPTED,
    INVALID_PARAM,
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
from thbridge.mavlink.vehicle.geodesy import MapProjection
from thbridge.mavlink.vehicle.mode.home import HomePosition
from thbridge.mavlink.vehicle.mode.operator_control import OperatorControl
from thbridge.mavlink.vehicle.mode.state_machine import ModeStateMachine
from thbridge.mavlink.wire.coordinates import GLOBAL, LOCAL, theta_of
from thbridge.mavlink.wire.dialect import mav
from thbridge.mavlink.wire.mode_numbers import Mode, mode_from_standard, requested_mode

_FORCED = frozenset({21196, 2989})
"""Values of the "force" parameter of arming: the standard's number and MAVProxy's number."""

_REPOSITION_CHANGES_MODE = 1
_LARGEST_ID = 0xFFFF
"""Highest possible number of a mission item."""


class CommandTable:
    """Commands of one vehicle.

    Args:
        robot: interface to the robot.
        modes: the robot's mode state machine.
        control: the station in command of the robot.
        home: home position.
        base_in_map: returns the robot's pose in the map.
        earth: map projection.
        identity: autopilot that the vehicle claims to have.
        requests: commands that request messages, by command number.
    """

    def __init__(
        self,
        robot: VehicleInterface,
        modes: ModeStateMachine,
        control: OperatorControl,
        home: HomePosition,
        base_in_map: Callable[[], Pose2],
        earth: MapProjection,
        identity: AutopilotIdentity,
        requests: Mapping[int, CommandSpec],
    ) -> None:
        self._robot = robot
        self._modes = modes
        self._control = control
        self._home = home
        self._base_in_map = base_in_map
        self._earth = earth
        self._identity = identity
        places = GLOBAL | LOCAL
        by_commander = CommandAccess.COMMANDER
        self._known: dict[int, CommandSpec] = {
            **requests,
            # Commands without `access` stop the robot, have no effect, or check the commander themselves.
            mav.MAV_CMD_COMPONENT_ARM_DISARM: CommandSpec(self._arm_disarm),
            mav.MAV_CMD_RUN_PREARM_CHECKS: CommandSpec(lambda _: ACCEPTED),
            mav.MAV_CMD_DO_SET_MODE: CommandSpec(self._set_mode),
            mav.MAV_CMD_DO_SET_STANDARD_MODE: CommandSpec(self._set_standard_mode),
            mav.MAV_CMD_DO_PAUSE_CONTINUE: CommandSpec(self._pause_continue),
            mav.MAV_CMD_NAV_LOITER_UNLIM: CommandSpec(self._hold),
            mav.MAV_CMD_DO_REPOSITION: CommandSpec(self._reposition, CommandCarrier.INT, places, by_commander),
            mav.MAV_CMD_NAV_WAYPOINT: CommandSpec(self._waypoint, CommandCarrier.INT, places, by_commander),
            mav.MAV_CMD_NAV_RETURN_TO_LAUNCH: CommandSpec(self._return, access=by_commander),
            mav.MAV_CMD_DO_CHANGE_SPEED: CommandSpec(self._change_speed, access=by_commander),
            mav.MAV_CMD_MISSION_START: CommandSpec(self._start_mission, access=by_commander),
            mav.MAV_CMD_DO_SET_MISSION_CURRENT: CommandSpec(self._select_item),
            mav.MAV_CMD_DO_SET_HOME: CommandSpec(self._set_home, frames=places, access=CommandAccess.NO_RIVAL),
            mav.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN: CommandSpec(lambda _: _NO_REBOOT),
            mav.MAV_CMD_IMAGE_START_CAPTURE: CommandSpec(self._photograph, access=by_commander, once=True),
            mav.MAV_CMD_USER_1: CommandSpec(self._identify, CommandCarrier.LONG, access=by_commander, once=True),
            mav.MAV_CMD_USER_2: CommandSpec(self._leave, CommandCarrier.LONG, access=by_commander, once=True),
        }

    def find(self, number: int) -> CommandSpec | None:
        """Return the command of this number, or None."""
        return self._known.get(number)

    # -- command and modes --------------------------------------------------------------------------------------------

    def _arm_disarm(self, request: ReceivedCommand) -> CommandReply:
        match request.param(1):
            case 1.0:
                return reply_to(self._modes.arm(request.station, by_force=request.param(2) in _FORCED))
            case 0.0:
                self._modes.disarm()
                return ACCEPTED
        return INVALID_PARAM

    def _set_mode(self, request: ReceivedCommand) -> CommandReply:
        base, main, sub = request.whole_param(1), request.whole_param(2), request.whole_param(3, otherwise=0)
        if base is None or main is None or sub is None:
            return INVALID_PARAM
        return self.mode_reply(request.station, base, main, sub)

    def mode_reply(self, station: Station, base: int, main: int, sub: int) -> CommandReply:
        """Change the mode. DO_SET_MODE and SET_MODE contain these numbers of the new mode."""
        mode: Mode | None
        if base & mav.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED:
            mode = requested_mode(self._identity, main, sub)
        else:
            mode = Mode.MANUAL if base & mav.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED else None
        if mode is None:
            return CommandReply(CommandResult.DENIED, sentence="There is no such mode.")
        return reply_to(self._modes.request_mode(station, mode))

    def _set_standard_mode(self, request: ReceivedCommand) -> CommandReply:
        code = request.whole_param(1)
        mode = None if code is None else mode_from_standard(code)
        return INVALID_PARAM if mode is None else reply_to(self._modes.request_mode(request.station, mode))

    def _pause_continue(self, request: ReceivedCommand) -> CommandReply:
        match request.param(1):
            case 0.0:
                self._modes.pause()
                return ACCEPTED
            case 1.0:
                objection = self._control.objection(request.station)
                return reply_to(objection or self._modes.resume())
        return INVALID_PARAM

    def _hold(self, request: ReceivedCommand) -> CommandReply:
        self._modes.stop()
        return ACCEPTED

    # -- goals --------------------------------------------------------------------------------------------------------

    def _reposition(self, request: ReceivedCommand) -> CommandReply:
        options = request.whole_param(2, otherwise=_REPOSITION_CHANGES_MODE)
        if options is None:
            return INVALID_PARAM
        if not options & _REPOSITION_CHANGES_MODE and self._modes.mode not in (Mode.GUIDED, Mode.HOLD):
            return CommandReply(
                CommandResult.DENIED, sentence=f"The robot is in mode {self._modes.mode.value}, not GUIDED."
            )
        speed = request.param(1)
        return self._go(request, decimal_of(speed) if speed is not None and speed > 0.0 else None, request.param(4))

    def _waypoint(self, request: ReceivedCommand) -> CommandReply:
        yaw = request.param(4)
        reply = self._go(request, None, None if yaw is None else math.radians(yaw))
        leg = self._modes.drive.number
        if reply.result is not CommandResult.ACCEPTED or leg is None:
            return reply
        return CommandReply(CommandResult.IN_PROGRESS, leg=leg)

    def _go(self, request: ReceivedCommand, speed: float | None, yaw: float | None) -> CommandReply:
        point = self._destination(request)
        if isinstance(point, Denied):
            return reply_to(point)
        if point is None:
            here = self._base_in_map()
            point = here.x, here.y
        if yaw == 0.0 and self._identity is AutopilotIdentity.ARDUPILOT:
            # Stations send 0 to ArduPilot if any heading is allowed. ArduPilot's rovers ignore this parameter.
            yaw = None
        denied = None if speed is None else self._robot.limit_speed(speed)
        return reply_to(denied or self._modes.go(Target(*point, None if yaw is None else theta_of(yaw))))

    def _destination(self, request: ReceivedCommand) -> tuple[float, float] | Denied | None:
        return destination(request, self._base_in_map(), self._earth)

    def _return(self, request: ReceivedCommand) -> CommandReply:
        return reply_to(self._modes.enter(Mode.RETURN))

    def _change_speed(self, request: ReceivedCommand) -> CommandReply:
        kind, speed = request.whole_param(1, otherwise=mav.SPEED_TYPE_GROUNDSPEED), request.param(2)
        if kind not in (mav.SPEED_TYPE_AIRSPEED, mav.SPEED_TYPE_GROUNDSPEED):
            return INVALID_PARAM
        # In this command, -1 keeps the speed, and -2 restores the default speed.
        if speed is None or speed == -1.0:
            return ACCEPTED
        if speed == -2.0:
            return reply_to(self._robot.limit_speed(-1.0))
        return reply_to(self._robot.limit_speed(decimal_of(speed))) if speed > 0.0 else INVALID_PARAM

    def _start_mission(self, request: ReceivedCommand) -> CommandReply:
        first, last = request.whole_param(1, otherwise=0), request.whole_param(2, otherwise=0)
        if first is None or last is None:
            return INVALID_PARAM
        # Stations send zeros to continue a mission, or to run all of it.
        return reply_to(self._modes.start_mission(first or None, last or None))

    def _select_item(self, request: ReceivedCommand) -> CommandReply:
        item = request.whole_param(1)
        if item is None or item > _LARGEST_ID:
            return INVALID_PARAM
        objection = self._control.objection(request.station) if self._modes.mode is Mode.AUTO else None
        return reply_to(objection or self._modes.plan.select(item))

    def _set_home(self, request: ReceivedCommand) -> CommandReply:
        is_here, point = request.whole_param(1, otherwise=0), self._destination(request)
        if is_here not in (0, 1):
            return INVALID_PARAM
        if is_here or point is None:
            return reply_to(self._home.set_here())
        if isinstance(point, Denied):
            return reply_to(point)
        return reply_to(self._home.set_to(Target(*point)))

    # -- the game -----------------------------------------------------------------------------------------------------

    def _photograph(self, request: ReceivedCommand) -> CommandReply:
        pictures = request.whole_param(3, otherwise=1)
        if pictures is None or pictures > 1:
            return CommandReply(CommandResult.DENIED, sentence="One picture at a time.")
        return reply_to(self._robot.photograph())

    def _identify(self, request: ReceivedCommand) -> CommandReply:
        number = request.whole_param(1)
        return INVALID_PARAM if not number else reply_to(self._robot.identify(number))

    def _leave(self, request: ReceivedCommand) -> CommandReply:
        return reply_to(self._robot.leave())


_NO_REBOOT = CommandReply(CommandResult.DENIED, sentence="A robot of a running game is not restarted.")
