"""Mode state machine: mode of a robot, and its behavior in this mode.

Callers first check by `OperatorControl` whether a station may move the robot.
"""

from dataclasses import dataclass

from sim.common.observations import TICKS_PER_SECOND
from thbridge.mavlink.values.options import Failsafe
from thbridge.mavlink.values.vehicle_interface import (
    NO_READINGS,
    DenialKind,
    Denied,
    RobotReadings,
    Station,
    Target,
    VehicleInterface,
)
from thbridge.mavlink.vehicle.mode.home import HomePosition
from thbridge.mavlink.vehicle.mode.manual_control import ManualControl, VelocitySetpoint
from thbridge.mavlink.vehicle.mode.operator_control import OperatorControl
from thbridge.mavlink.vehicle.mode.target_drive import TargetDrive
from thbridge.mavlink.vehicle.parts import Announce, MissionControl, TextSeverity, announce_denial
from thbridge.mavlink.wire.mode_numbers import Mode

_STOPPING = TICKS_PER_SECOND
"""Ticks after a stop in which a robot may still move, because it brakes."""


@dataclass(frozen=True, slots=True)
class PausedMode:
    """Activity that a pause has interrupted. It may be resumed.

    Attributes:
        mode: mode at that time.
        target: goal of the drive at that time. None if the robot was not driving to a goal.
    """

    mode: Mode
    target: Target | None


class ModeStateMachine:
    """Mode state machine of one robot.

    Args:
        robot: interface to the robot.
        hand: manual control.
        control: the station in command of the robot.
        plan: its mission.
        home: home position.
        failsafe: action after the loss of the station that commands the robot.
        announce: sends texts to people.

    Attributes:
        drive: the last drive to a target that this state machine started.
        plan: see `Args`.
        failsafe: see `Args`. It may be changed.
    """

    def __init__(
        self,
        robot: VehicleInterface,
        hand: ManualControl,
        control: OperatorControl,
        plan: MissionControl,
        home: HomePosition,
        failsafe: Failsafe,
        announce: Announce,
    ) -> None:
        self._robot = robot
        self._control = control
        self._home = home
        self._hand = hand
        self.drive = TargetDrive(announce)
        self.plan = plan
        self.failsafe = failsafe
        self._announce = announce
        self._readings = NO_READINGS
        self._tick = 0
        self._mode = Mode.HOLD
        self._paused: PausedMode | None = None
        self._stopped_at = -_STOPPING
        self._continues_alone = False

    @property
    def mode(self) -> Mode:
        """Mode for ground stations. It is GUIDED if the robot drives for another commander, such as the participant."""
        commanded = self._control.station is not None
        if self._is_moved() and (self._mode is Mode.HOLD or (not commanded and not self.drive.is_under_way)):
            return Mode.GUIDED
        return self._mode

    @property
    def armed(self) -> bool:
        """True if a station commands the robot, or the robot moves."""
        return self._control.station is not None or self._is_moved()

    def arm(self, station: Station, by_force: bool) -> Denied | None:
        """Let a station command the robot.

        The robot continues its activity. If no station commanded it before, it enters the mode that was requested then.
        """
        before = self._control.station
        denied = self._control.take(station, by_force)
        if denied is not None or before == station:
            return denied
        self._continues_alone = False
        if before is None and self._mode is not Mode.HOLD:
            chosen, self._mode = self._mode, Mode.HOLD
            announce_denial(self._announce, self.enter(chosen))
        return None

    def disarm(self) -> None:
        """Stop, and let the participant command the robot again."""
        self.stop()
        self._control.release()

    def request_mode(self, station: Station, mode: Mode) -> Denied | None:
        """Change the mode for a station.

        Any station may choose HOLD. If no station commands the robot, other modes are stored until a station arms the
        robot.
        """
        if mode is Mode.HOLD:
            self.stop()
            return None
        if self._control.station is None:
            self._mode = mode
            self._announce(TextSeverity.NOTICE, f"Mode {mode.value} begins when the robot is armed.")
            return None
        return self._control.objection(station) or self.enter(mode)

    def enter(self, mode: Mode) -> Denied | None:
        """Change the mode. If this is denied, the mode stays the same or becomes HOLD."""
        match mode:
            case Mode.AUTO:
                return self.start_mission(None, None)
            case Mode.RETURN:
                return self.go(self._home.target, mode)
            case Mode.HOLD:
                self.stop()
            case Mode.GUIDED | Mode.MANUAL if mode is not self._mode:
                self.stop()
                self._mode = mode
        return None

    def stop(self) -> None:
        """Stop the robot, even if another commander has sent it, and enter HOLD."""
        self._leave()
        self._robot.stop_robot()
        self._mode = Mode.HOLD
        self._stopped_at = self._tick

    def start_mission(self, first: int | None, last: int | None) -> Denied | None:
        """Run the mission. See `MissionControl.start`."""
        if self._mode is Mode.AUTO and self.plan.running and first is None and last is None:
            return None
        if self._readings.under_way and not self.plan.running:
            # If the first item of the mission did not move the robot, the present drive would continue.
            self.stop()
        denied = self.plan.start(first, last)
        if denied is None:
            self._forget_leg()
            self._mode = Mode.AUTO
        return denied

    def go(self, target: Target, mode: Mode = Mode.GUIDED) -> Denied | None:
        """Drive to a point, and change to this mode."""
        # Ask first, because the present activity continues after a denial.
        number = self._robot.go_to(target)
        if isinstance(number, Denied):
            return number
        self._leave()
        self.drive.begin(number, target)
        self._mode = mode
        return None

    def follow_target(self, target: Target) -> Denied | None:
        """Drive to a point that is sent repeatedly. Do nothing in modes other than GUIDED."""
        # The target is repeated, so a drive that already leads to it must not begin again.
        if self._mode is not Mode.GUIDED or self.drive.leads_to(target):
            return None
        return self.go(target)

    def follow_velocity(self, velocity: VelocitySetpoint) -> Denied | None:
        """Drive at a velocity that is sent repeatedly. Do nothing in modes other than GUIDED."""
        if self._mode is not Mode.GUIDED:
            return None
        denied = self._hand.follow(velocity)
        if denied is None:
            self.drive.abort()
            self._paused = None
        return denied

    def pause(self) -> None:
        """Stop, and store the present activity for `resume`."""
        # A second pause must keep the stored activity, because the robot already stands.
        paused = self._paused
        if paused is None and self._mode is not Mode.HOLD:
            paused = PausedMode(self._mode, self.drive.target if self.drive.is_under_way else None)
        self.stop()
        self._paused = paused

    def resume(self) -> Denied | None:
        """Continue the activity that a pause has interrupted. If the mode is not HOLD, do nothing."""
        if self._mode is not Mode.HOLD:
            return None
        paused = self._paused
        if paused is None:
            return Denied("There is nothing to continue.", DenialKind.NOT_NOW)
        denied = self.go(paused.target, paused.mode) if paused.target is not None else self.enter(paused.mode)
        if denied is None:
            self._paused = None
        return denied

    def step(self, tick: int, readings: RobotReadings) -> None:
        """Advance by one tick."""
        self._tick, self._readings = tick, readings
        taken_away = self._control.follow(tick, readings)
        if taken_away:
            self._leave()
            self._mode = Mode.HOLD
        self.drive.step(readings)
        self._hand.step(tick, readings.base_in_map)
        if self._is_over():
            self._mode = Mode.HOLD
        if self._control.is_lost:
            self._step_failsafe()
        else:
            self._continues_alone = False

    def _step_failsafe(self) -> None:
        if self._control.is_overruled:
            # The loss of a station must not stop a researcher's drive. The station only loses its own command.
            self._leave()
            self._mode = Mode.HOLD
            self._control.release()
            return
        if self._continues_alone:
            # With CONTINUE, the participant commands the robot only after the end of the drive or the mission.
            if not self.plan.running and not self.drive.is_under_way:
                self._mode = Mode.HOLD
                self._control.release()
            return
        what = {Failsafe.STOP: "stops", Failsafe.HOME: "goes home", Failsafe.CONTINUE: "carries on"}[self.failsafe]
        self._announce(TextSeverity.CRITICAL, f"{self._control.station} is lost: the robot {what}.")
        if self.failsafe is Failsafe.CONTINUE:
            self._continues_alone = True
            return
        denied = self.enter(Mode.RETURN) if self.failsafe is Failsafe.HOME else None
        announce_denial(self._announce, denied)
        if self.failsafe is Failsafe.STOP or denied is not None:
            self.stop()
        self._control.release()

    def _is_over(self) -> bool:
        """Return True if the activity of the mode has ended."""
        if self._control.station is not None:
            return self._mode is Mode.AUTO and not self.plan.running
        return self._mode is Mode.RETURN and self.drive.number is not None and not self.drive.is_under_way

    def _is_moved(self) -> bool:
        return self._readings.under_way and self._tick - self._stopped_at >= _STOPPING

    def _leave(self) -> None:
        """Abort the activity of the mode without stopping the robot."""
        if self.plan.running:
            self.plan.pause()
        self._forget_leg()

    def _forget_leg(self) -> None:
        self.drive.abort()
        self._paused = None
        self._hand.release_control()
