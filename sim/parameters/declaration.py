"""Declaration of parameters: default, meaning, unit and bounds in one place.

A class of ROS parameters may have these class variables:

* `ros_only: Mapping[str, str]`: names that only have a meaning inside ROS, with this meaning. Files may contain these
  names. They have no effect, and the reader of the file reports this.
* `renamed: Mapping[str, str]`: old names that ROS still reads, and the present names.
* `passed_on: Mapping[str, str]`: names that ROS passes on to a section, where they override the section's own value,
  and the path of this value. Example: `obstacle_range` overrides `obstacle_layer.obstacle_range`.
* `sections_named_in: str`: the name of a field with a tuple of sections, each with a `name`. In a file, the field is a
  text of these names, separated by blanks. Each section is at the same level as the field, under its own name.
* `not_in_ros: frozenset[str]`: the fields that ROS does not have.
"""

from dataclasses import field, is_dataclass
from typing import TYPE_CHECKING, TypeGuard, TypeVar

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

T = TypeVar("T")


def param(
    default: T,
    help: str,  # noqa: A002 - the word that argument parsers use
    unit: str = "",
    minimum: float | None = None,
    maximum: float | None = None,
    choices: tuple[str, ...] = (),
    plugins: str = "",
) -> T:
    """Declare a dataclass field that an admin may set.

    Args:
        default: value if the file does not give one; immutable.
        help: one sentence for the admin.
        unit: SI unit, e.g. "m", "m/s", "rad"; empty for a pure number.
        minimum: minimum allowed value, inclusive.
        maximum: maximum allowed value, inclusive.
        choices: allowed words; if empty, any word.
        plugins: group of entry points. Names of installed plug-ins of this group are allowed in addition to
            `choices`. If empty, there is no group.
    """
    metadata = _metadata(help, unit, minimum, maximum, choices, plugins)
    # Parameter classes are frozen, so all instances may share one default.
    return field(default=default, metadata=metadata)


def live(
    default: T,
    help: str,  # noqa: A002 - as above
    unit: str = "",
    minimum: float | None = None,
    maximum: float | None = None,
    choices: tuple[str, ...] = (),
    plugins: str = "",
) -> T:
    """Declare a parameter that may change while a robot runs. ROS has it in a .cfg file of dynamic_reconfigure.

    The arguments are the same as for `param`. See `sim.parameters.reconfiguration`, also about parameters that ROS
    does not have.
    """
    return field(default=default, metadata=_metadata(help, unit, minimum, maximum, choices, plugins) | {"live": True})


def _metadata(
    help: str,  # noqa: A002 - as above
    unit: str,
    minimum: float | None,
    maximum: float | None,
    choices: tuple[str, ...],
    plugins: str,
) -> dict[str, object]:
    known: dict[str, object] = {
        "help": help,
        "unit": unit,
        "minimum": minimum,
        "maximum": maximum,
        "choices": choices,
    }
    return known | {"plugins": plugins} if plugins else known


def is_section(value: object) -> "TypeGuard[DataclassInstance]":
    """Return True if the value is a section: a dataclass that contains parameters."""
    return is_dataclass(value) and not isinstance(value, type)
