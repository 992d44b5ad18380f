"""How a parameter is declared: default, meaning, unit and bounds in one place.

A class of ROS parameters may hold `ros_only: ClassVar[Mapping[str, str]]`: names that only mean something inside ROS,
each with what it does there. Files may have them, and are told that they change nothing.

Three habits of ROS's files have a name too. `renamed: ClassVar[Mapping[str, str]]`: an old name that ROS still reads,
and the present one. `passed_on: ClassVar[Mapping[str, str]]`: a name that ROS hands down to a part, whatever the part
itself says, and where: `obstacle_range` to `obstacle_layer.obstacle_range`. `sections_named_in: ClassVar[str]`: a field
that holds a tuple of sections, each with a `name`; in a file it is a text of the names with blanks between, and each
section stands under its name beside it.
"""

from dataclasses import field
from typing import TypeVar

T = TypeVar("T")


def param(
    default: T,
    help: str,  # noqa: A002 - the word that argument parsers use for it
    unit: str = "",
    minimum: float | None = None,
    maximum: float | None = None,
    choices: tuple[str, ...] = (),
) -> T:
    """A dataclass field that an admin may set, with what a reader of the file needs to know about it.

    Args:
        default: the value when the file is silent; immutable.
        help: one sentence for the admin.
        unit: SI, e.g. "m", "m/s", "rad"; empty for a pure number.
        minimum: least allowed value, inclusive.
        maximum: greatest allowed value, inclusive.
        choices: the allowed words; empty when free.
    """
    metadata = {"help": help, "unit": unit, "minimum": minimum, "maximum": maximum, "choices": choices}
    # Every parameter class is frozen, so one default may serve all.
    return field(default=default, metadata=metadata)


def live(
    default: T,
    help: str,  # noqa: A002 - as above
    unit: str = "",
    minimum: float | None = None,
    maximum: float | None = None,
    choices: tuple[str, ...] = (),
) -> T:
    """A knob that may be turned while a robot runs. Where ROS has it, it stands in a .cfg file for dynamic_reconfigure.

    Arguments as for `knob`; see `sim.parameters.reconfiguration`.
    """
    metadata = {"help": help, "unit": unit, "minimum": minimum, "maximum": maximum, "choices": choices, "live": True}
    return field(default=default, metadata=metadata)
