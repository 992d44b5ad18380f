"""A robot's parameters in MAVLink: numbers with short names. A ground station may change them at any time.

MAVLink sends 32-bit floats. The sent number is the 32-bit float nearest to the current value. A received number means
the shortest decimal that has the same 32-bit float. If the current value already has this 32-bit float, the parameter
does not change. So 0.1 remains 0.1, even if ground stations read values and send them back many times.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from operator import attrgetter
from types import NoneType
from typing import Protocol, cast

import numpy as np

from sim.parameters import DeclaredParameter, ParameterRejection, WorldParameters, live_parameters
from sim.parameters.reconfiguration import WORLD_PREFIX
from thbridge.mavlink.role.parameter_names import GROUPS, group_of, name_of
from thbridge.mavlink.values.vehicle_interface import Denied, ParameterDescription, ParameterSetting
from thbridge.roles.shared.robot_requests import ParameterValue, SetParameters, Tuning


@dataclass(frozen=True, slots=True)
class VehicleParameter:
    """A parameter of the study that MAVLink can represent.

    Attributes:
        name: its name in MAVLink, at most 16 characters of A-Z, 0-9 and _.
        declaration: its path, type, unit, bounds and choices.
    """

    name: str
    declaration: DeclaredParameter

    def to_number(self, value: ParameterValue) -> float:
        """Return the number for a value.

        The number of a word is its index among the choices, or -1 for the name of a plug-in. The number of None is 0.
        """
        if isinstance(value, str):
            choices = self.declaration.choices
            return float(choices.index(value)) if value in choices else -1.0
        return float(value or 0)

    def from_number(self, number: float) -> ParameterValue | Denied:
        """Return the value for a 32-bit number, or the reason why there is no value. Bounds are not checked."""
        types, choices = self.declaration.types, self.declaration.choices
        if float in types:
            # The shortest decimal number with the same 32 bits is the number that the station meant.
            return None if number == 0.0 and NoneType in types else float(str(np.float32(number)))
        if bool in types:
            return bool(number) if number in {0.0, 1.0} else Denied(f"{self.name} is 0 or 1, not {number:g}.")
        if not number.is_integer():
            return Denied(f"{self.name} is a whole number, not {number:g}.")
        if str not in types:
            return int(number)
        if not 0 <= number < len(choices):
            return Denied(f"{self.name} is a whole number from 0 to {len(choices) - 1}, not {number:g}.")
        return choices[int(number)]

    def description(self, default: ParameterValue) -> ParameterDescription:
        """Return the description for ground stations.

        Args:
            default: value of the parameter at the start of the session.
        """
        parameter = self.declaration
        path = parameter.path if parameter.path.startswith(WORLD_PREFIX) else f"robot.{parameter.path}"
        may_be_none = NoneType in parameter.types
        return ParameterDescription(
            self.name,
            parameter.help,
            f"{path} of the study{'; 0: null' if may_be_none else ''}",
            path.partition(".")[0],
            GROUPS[group_of(self.name)],
            parameter.unit,
            self.to_number(default),
            parameter.minimum,
            parameter.maximum,
            float not in parameter.types,
            ("off", "on") if bool in parameter.types else parameter.choices,
        )


def _is_numeric(parameter: DeclaredParameter) -> bool:
    return bool({bool, int, float} & {*parameter.types}) or bool(parameter.choices)


PARAMETERS = tuple(
    VehicleParameter(name_of(parameter.path), parameter)
    for parameter in (*live_parameters(), *live_parameters(WorldParameters, WORLD_PREFIX[:-1]))
    if _is_numeric(parameter)
)
"""All parameters in the order of sending: first parameters of the software, then the true noise of the sensors."""

_PLACES = {parameter.name: place for place, parameter in enumerate(PARAMETERS)}

_IN_TUNING = attrgetter(
    *(
        path if path.startswith(WORLD_PREFIX) else f"software.{path}"
        for path in (each.declaration.path for each in PARAMETERS)
    )
)


def values_of(tuning: Tuning) -> tuple[ParameterValue, ...]:
    """Return the current values, in the order of `PARAMETERS`."""
    return cast(tuple[ParameterValue, ...], _IN_TUNING(tuning))


class Tunable(Protocol):
    """Access to the parameters of a team, implemented by `SimR`."""

    def tuning(self, robot: int) -> Tuning | None:
        """Return a robot's parameters after all requests so far. If it is a real robot, return None."""

    def ask(self, request: SetParameters) -> None:
        """Queue a request for the next step."""


class VehicleParameters:
    """Parameters of one robot's vehicle. Their values are always current, even after changes by other clients.

    The vehicle of a real robot has no parameters, because they cannot be changed here.

    Args:
        robot: its index in the team.
        robots: the team.
    """

    def __init__(self, robot: int, robots: Tunable) -> None:
        self._robot = robot
        self._robots = robots
        self._at_first = robots.tuning(robot)
        self._of: Tuning | None = None
        self._settings: tuple[ParameterSetting, ...] = ()

    def descriptions(self) -> Sequence[ParameterDescription]:
        """Return the descriptions, with the values at the start of the session as defaults."""
        if self._at_first is None:
            return ()
        values = values_of(self._at_first)
        return tuple(parameter.description(value) for parameter, value in zip(PARAMETERS, values, strict=True))

    def settings(self) -> Sequence[ParameterSetting]:
        """Return all settings as they will be after all requests so far, always in the same order."""
        tuning = self._robots.tuning(self._robot)
        # Stations ask for each of some hundred parameters. So the settings are made again only after a change.
        if tuning is not None and tuning != self._of:
            numbers = (each.to_number(value) for each, value in zip(PARAMETERS, values_of(tuning), strict=True))
            nearest = np.fromiter(numbers, dtype=np.float32).tolist()
            self._settings = tuple(ParameterSetting(name, value) for name, value in zip(_PLACES, nearest, strict=True))
            self._of = tuning
        return self._settings

    def setting(self, name: str) -> ParameterSetting | None:
        """Return the setting of this name, or None if the name is unknown."""
        place, settings = _PLACES.get(name), self.settings()
        return None if place is None or not settings else settings[place]

    def change(self, name: str, value: float) -> ParameterSetting | Denied:
        """Set a parameter. Return its new setting, or the reason why its value does not change.

        Args:
            name: name of the parameter.
            value: any number, which is rounded to a 32-bit float.
        """
        before, tuning = self.setting(name), self._robots.tuning(self._robot)
        if before is None or tuning is None:
            return Denied(f"There is no parameter {name}.")
        parameter = PARAMETERS[_PLACES[name]]
        with np.errstate(over="ignore"):  # Numbers too large for 32 bits become infinite.
            wanted = float(np.float32(value))
        if not math.isfinite(wanted):
            return Denied(f"{name} is a number, not {wanted:g}.")
        # A number that is sent back unchanged must not round the present value to 32 bits.
        if wanted == before.value:
            return before
        meant = parameter.from_number(wanted)
        if isinstance(meant, Denied):
            return meant
        values = ((parameter.declaration.path, meant),)
        changed = tuning.changed(values)
        if isinstance(changed, ParameterRejection):
            return Denied(f"{changed.sentence}.")
        self._robots.ask(SetParameters(self._robot, values))
        return ParameterSetting(name, wanted)
