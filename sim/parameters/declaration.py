"""Declaration of parameters: default, meaning, unit and bounds in one place.

A class of ROS parameters may hold `ros_only: ClassVar[Mapping[str, str]]`: names that only mean something inside ROS,
each with what it does there. Files may have them; they change nothing, and whoever reads the file reports that.

Three customs of ROS's parameter files are declared by name too. `renamed: ClassVar[Mapping[str, str]]`: an old name
that ROS still reads, and the present one. `passed_on: ClassVar[Mapping[str, str]]`: a name that ROS hands down to a
part, over the part's own value, and the path there: `obstacle_range` to `obstacle_layer.obstacle_range`.
`sections_named_in: ClassVar[str]`: a field that holds a tuple of sections, each with a `name`; in a file it is a text
of the names with blanks between, and each section stands under its name beside it.

`not_in_ros: ClassVar[frozenset[str]]` names the fields that ROS does not have.
"""

from dataclasses import field, is_dataclass
from typing import TYPE_CHECKING, TypeGuard, TypeVar

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

T = TypeVar("T")


def param(
    default: T,
    help: str,  # noqa: A002 - the word that argument parsers use for it
    unit: str = "",
    minimum: float | None = None,
    maximum: float | None = None,
    choices: tuple[str, ...] = (),
    plugins: str = "",
) -> T:
    """Declare a dataclass field that an admin may set, with what a reader of the file needs to know about it.

    Args:
        default: the value when the file does not give one; immutable.
        help: one sentence for the admin.
        unit: SI, e.g. "m", "m/s", "rad"; empty for a pure number.
        minimum: least allowed value, inclusive.
        maximum: greatest allowed value, inclusive.
        choices: the allowed words; empty when free.
        plugins: group of entry points, whose installed names are allowed in addition to the choices; empty: none.
    """
    metadata = _metadata(help, unit, minimum, maximum, choices, plugins)
    # Every parameter class is frozen, so one default may serve all.
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
    """Declare a parameter that may change while a robot runs; ROS has it in a .cfg file for dynamic_reconfigure.

    Arguments as for `param`; see `sim.parameters.reconfiguration`, also for those that ROS does not have.
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
    """Return True for a section of parameters, which holds more of them."""
    return is_dataclass(value) and not isinstance(value, type)
