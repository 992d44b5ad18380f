"""The study file: everything an admin can set, in one YAML file, every key of which may be left out.

The sections are frozen dataclasses. `knob` gives each field its default, meaning, unit and bounds, and the reader, its
error messages and the commented file that `thbridge study init` writes all come from there.
"""

import dataclasses
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, cast, get_type_hints

from sim.observations import TICKS_PER_SECOND
from sim.parameters import RobotParameters, WorldParameters, knob
from thbridge.adapters.errors import BadFile, BadFiles
from thbridge.adapters.text_server import DEFAULT_PORT
from thbridge.adapters.yaml_files import Loaded, allowed, load, load_text, quoted
from thbridge.study.bots import BotStrategy
from thbridge.wire.canonical import Dialect

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

_WORD = re.compile(r"[A-Za-z][A-Za-z0-9_-]*")
"""Text that needs no quotes, unless YAML means something else by it."""
_RESERVED = {"true", "false", "null", "yes", "no", "on", "off", "y", "n"}


@dataclass(frozen=True, slots=True)
class GameSection:
    """The rules that may be turned."""

    energy: float = knob(100.0, "energy of each robot at the start", "", 0.01, 1e6)
    picture_cost: float = knob(5.0, "energy of taking a picture", "", 0, 1e6)
    identify_cost: float = knob(1.0, "energy of naming a treasure", "", 0, 1e6)
    wrong_share: float = knob(1.0, "share of a treasure's points that a wrong name costs", "", 0, 10)
    costs: Path | None = knob(
        None, "path of a mapTimes file of travel costs; null: the map's own, or else the templates'"
    )


@dataclass(frozen=True, slots=True)
class ParticipantSection:
    """Who plays when no person does."""

    strategy: BotStrategy = knob(BotStrategy.SUGGESTION, "how a simulated participant chooses rooms")


class DialogueStrategy(StrEnum):
    """How robots choose what to say."""

    TEMPLATE = "template"


@dataclass(frozen=True, slots=True)
class DialogueSection:
    """How robots talk with the participant."""

    strategy: DialogueStrategy = knob(DialogueStrategy.TEMPLATE, "how robots choose what to say")


@dataclass(frozen=True, slots=True)
class ServerSection:
    """The text server that the programs of the game meet at."""

    host: str = knob("127.0.0.1", "address to listen on; 0.0.0.0 lets other machines in")
    port: int = knob(DEFAULT_PORT, "TCP port; 0 takes any that is free", "", 0, 65535)
    dialect: Dialect = knob(Dialect.LEGACY_2016, "which reading of %%goto comes first")


@dataclass(frozen=True, slots=True)
class Study:
    """A study: what is played, by whom, on which map, with which robots."""

    map: str = knob("arena8", "name of a map, or the path of a map folder (with a slash, from this file's folder)")
    templates: str = knob("original-2016", "name of a set of templates, or the path of its folder")
    robots: int = knob(2, "size of the team", "", 1, 64)
    seed: int = knob(1, "all chance is keyed by it; the same seed gives the same run", "", 0, 2**31 - 1)
    rate: float | None = knob(
        None, "simulated seconds per second; 0: as fast as it can; null: 1 when others take part, else 0", "", 0, 1000
    )
    game: GameSection = knob(GameSection(), "rules and energy")
    participant: ParticipantSection = knob(ParticipantSection(), "who plays when no person does")
    dialogue: DialogueSection = knob(DialogueSection(), "how robots talk")
    server: ServerSection = knob(ServerSection(), "the text server")
    world: WorldParameters = knob(WorldParameters(), "bodies, motors and sensors as they truly are")
    robot: RobotParameters = knob(RobotParameters(), "the software of every robot, under ROS's names")


def read_study(path: Path) -> Study:
    """Read a study file.

    Raises:
        BadFile: it cannot be read; as BadFiles, every fault of it at once.
    """
    return _consistent(load(path, Study))


def read_study_text(path: Path, text: str) -> Study:
    """As `read_study`, of a text that is at hand, such as the study in a bag; `path` is what faults are told under."""
    return _consistent(load_text(path, text, Study))


def _consistent(loaded: Loaded[Study]) -> Study:
    faults = tuple(_contradictions(loaded))
    if faults:
        raise BadFiles(faults)
    return loaded.value


def _contradictions(loaded: Loaded[Study]) -> Iterator[BadFile]:
    """What is allowed on its own but not together."""
    study = loaded.value
    laser, amcl, planner = study.world.laser, study.robot.amcl, study.robot.TrajectoryPlannerROS
    if TICKS_PER_SECOND % laser.rate:
        rates = [str(rate) for rate in range(1, TICKS_PER_SECOND + 1) if TICKS_PER_SECOND % rate == 0]
        problem = f"{laser.rate} does not divide the {TICKS_PER_SECOND} steps of a second"
        yield loaded.fault("world.laser.rate", problem, f"Write one of {', '.join(rates)}")
    for low_key, low, high_key, high in (
        ("world.laser.range_min", laser.range_min, "world.laser.range_max", laser.range_max),
        ("robot.amcl.min_particles", amcl.min_particles, "robot.amcl.max_particles", amcl.max_particles),
        ("robot.TrajectoryPlannerROS.min_vel_x", planner.min_vel_x,
         "robot.TrajectoryPlannerROS.max_vel_x", planner.max_vel_x),
        ("robot.TrajectoryPlannerROS.min_in_place_vel_theta", planner.min_in_place_vel_theta,
         "robot.TrajectoryPlannerROS.max_vel_theta", planner.max_vel_theta),
    ):  # fmt: skip
        if low > high:
            yield loaded.fault(low_key, f"{low} is above {high_key}, which is {high}", "Lower it, or raise the other")
    if not _surrounds_origin(study.world.footprint):
        problem = "these corners do not surround the robot's centre (0, 0)"
        yield loaded.fault("world.footprint", problem, "Write three or more corners in turn around it")


def _surrounds_origin(corners: tuple[tuple[float, float], ...]) -> bool:
    """Whether a polygon winds around (0, 0) once, without touching it."""
    sides = list(zip(corners, corners[1:] + corners[:1], strict=True))
    angles = [math.atan2(x0 * y1 - y0 * x1, x0 * x1 + y0 * y1) for (x0, y0), (x1, y1) in sides]
    touches = any(abs(abs(angle) - math.pi) < 1e-9 for angle in angles)
    return len(corners) > 2 and not touches and abs(abs(sum(angles)) - 2 * math.pi) < 1e-6


def resolved(study: Study) -> str:
    """The whole study as YAML, defaults included; reading it gives an equal study."""
    return "\n".join(_lines(study, indent="", commented=False)) + "\n"


def commented_study() -> str:
    """A study file with every key at its default, each under its meaning, unit and range."""
    head = ["# A study. Every key may be left out; what is written here are the defaults.", ""]
    return "\n".join(head + list(_lines(Study(), indent="", commented=True))) + "\n"


def _lines(section: "DataclassInstance", indent: str, commented: bool) -> Iterator[str]:
    hints = cast(Mapping[str, object], get_type_hints(type(section)))
    for knob_field in dataclasses.fields(section):
        value = cast(object, getattr(section, knob_field.name))
        words = allowed(hints[knob_field.name], knob_field.metadata)
        comment = f"{indent}# {knob_field.metadata['help']}" + (f" [{words}]" if words else "")
        section_begins = dataclasses.is_dataclass(value) and not isinstance(value, type)
        if commented and section_begins and not indent:
            yield ""
        if commented:
            yield comment
        if section_begins:
            yield f"{indent}{knob_field.name}:"
            yield from _lines(cast("DataclassInstance", value), indent + "  ", commented)
        else:
            yield f"{indent}{knob_field.name}: {_written(value)}"


def _written(value: object) -> str:
    """One value as YAML that reads back equal."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, tuple):
        return f"[{', '.join(_written(item) for item in value)}]"
    text = str(value)
    return text if _WORD.fullmatch(text) and text.lower() not in _RESERVED else quoted(text)
