"""Parameters of the vehicle itself: system id and failsafe, with ArduPilot's names. The robot's parameters follow.

Source: ArduPilot's parameter list of Rover: SYSID_THISMAV, FS_GCS_TIMEOUT, FS_ACTION.
Differences from the source: FS_ACTION has only the three values in `ACTIONS`, and 0 means to continue. There is no
FS_GCS_ENABLE.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from thbridge.mavlink.values.options import LONGEST_TIMEOUT, SHORTEST_TIMEOUT, Failsafe
from thbridge.mavlink.values.vehicle_interface import (
    DenialKind,
    Denied,
    ParameterDescription,
    ParameterSetting,
    ParameterSettings,
)
from thbridge.mavlink.vehicle.mode.operator_control import OperatorControl
from thbridge.mavlink.vehicle.mode.state_machine import ModeStateMachine

SYSTEM_ID = "SYSID_THISMAV"
TIMEOUT = "FS_GCS_TIMEOUT"
ACTION = "FS_ACTION"

ACTIONS: Mapping[Failsafe, int] = {Failsafe.CONTINUE: 0, Failsafe.HOME: 1, Failsafe.STOP: 2}
"""Values of `FS_ACTION`. In ArduPilot they mean: no action, RTL (return to launch), hold."""

_SECTION, _GROUP = "mavlink", "vehicle"


class FailsafeParameters:
    """Parameters of one vehicle, followed by the parameters of its robot. It implements `ParameterSettings`.

    Args:
        system: its system id. This is its robot's number, and it does not change.
        robot: parameters of its robot.
        control: state that contains the heartbeat timeout.
        modes: state machine that contains the failsafe action.
    """

    def __init__(
        self, system: int, robot: ParameterSettings, control: OperatorControl, modes: ModeStateMachine
    ) -> None:
        self._system = system
        self._robot = robot
        self._control = control
        self._modes = modes
        self._at_first = {own.name: own.value for own in self._own()}

    def descriptions(self) -> Sequence[ParameterDescription]:
        """See `ParameterSettings`."""
        return (
            ParameterDescription(SYSTEM_ID, "the robot's number", "system id of MAVLink", _SECTION, _GROUP, fixed=True),
            ParameterDescription(
                TIMEOUT,
                "time without heartbeats after which a station is lost",
                "mavlink.lost_after of the study",
                _SECTION,
                _GROUP,
                "s",
                self._at_first[TIMEOUT],
                SHORTEST_TIMEOUT,
                LONGEST_TIMEOUT,
            ),
            ParameterDescription(
                ACTION,
                "action of a robot after its ground station is lost",
                "mavlink.failsafe of the study",
                _SECTION,
                _GROUP,
                default=self._at_first[ACTION],
                whole=True,
                words=tuple(failsafe.value for failsafe in sorted(ACTIONS, key=ACTIONS.__getitem__)),
            ),
            *self._robot.descriptions(),
        )

    def settings(self) -> Sequence[ParameterSetting]:
        """See `ParameterSettings`."""
        return (*self._own(), *self._robot.settings())

    def change(self, name: str, value: float) -> ParameterSetting | Denied:
        """See `ParameterSettings`."""
        before = next((own for own in self._own() if own.name == name), None)
        if before is None:
            return self._robot.change(name, value)
        denied = None if value == before.value else self._turn(name, value)
        return denied or ParameterSetting(name, value)

    def _turn(self, name: str, value: float) -> Denied | None:
        if name == SYSTEM_ID:
            return Denied(f"{SYSTEM_ID} is the robot's number.", DenialKind.UNSUPPORTED)
        if name == TIMEOUT:
            if not SHORTEST_TIMEOUT <= value <= LONGEST_TIMEOUT:
                return Denied(f"{TIMEOUT} is {SHORTEST_TIMEOUT:g} to {LONGEST_TIMEOUT:g} s, not {value:g}.")
            self._control.lost_after = value
            return None
        for failsafe, number in ACTIONS.items():
            if value == number:
                self._modes.failsafe = failsafe
                return None
        return Denied(f"{ACTION} is 0 (carry on), 1 (go home) or 2 (stop), not {value:g}.")

    def _own(self) -> tuple[ParameterSetting, ...]:
        return (
            ParameterSetting(SYSTEM_ID, float(self._system)),
            ParameterSetting(TIMEOUT, float(np.float32(self._control.lost_after))),
            ParameterSetting(ACTION, float(ACTIONS[self._modes.failsafe])),
        )
