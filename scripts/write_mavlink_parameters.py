"""Write `docs/reference/mavlink-parameters.md`: what the study's parameters are called in MAVLink, and what may be set.

python scripts/write_mavlink_parameters.py [FILE]
"""

import argparse
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path
from types import NoneType

from sim.parameters import RobotParameters, WorldParameters
from thbridge.files.yaml.declarations import allowed
from thbridge.mavlink.role.parameter_names import GROUPS, group_of
from thbridge.mavlink.role.parameters import PARAMETERS, VehicleParameter, values_of
from thbridge.roles.shared.robot_requests import Tuning

ROOT = Path(__file__).parents[1]

HEAD = """\
# MAVLink parameters

The numbers of the study that a ground station may change while the robots drive, by their MAVLink names.
`scripts/write_mavlink_parameters.py` writes this page.

* The path is that of the study file, below `robot:`; those that begin with `world` stand at the file's top. A study
  that says nothing begins with the value in the fourth column. A change concerns one robot, acts in the next tick, and
  is recorded: a replay does it again.
* All are REAL32. What is told is the nearest such number to the value in force, and to set what is told changes
  nothing. What is set means the shortest decimal that is told so.
* *0 or 1* is a switch. Words are told as their place among the choices, from 0.
* Ground stations are told what stands here in the file `parameters.json` of each vehicle; see mavlink-commands.md.
* What is not a number, has a fraction where there can be none, or is out of its range is refused, and the old value
  told.

## The vehicle's own

Three come before those of the robot, under the names that ArduPilot's rovers have for them.

| name | key of the study | meaning | range |
|---|---|---|---|
| `SYSID_THISMAV` | | the robot's number | fixed |
| `FS_GCS_TIMEOUT` | `mavlink: lost_after` | time without heartbeats after which a station counts as lost | 1 to 600 s |
| `FS_ACTION` | `mavlink: failsafe` | what a robot does whose ground station is lost | 0: continue, 1: home, 2: stop |
"""


def range_of(parameter: VehicleParameter) -> str:
    """Return the values that may be set, in words."""
    declaration = parameter.declaration
    if bool in declaration.types:
        return "0 or 1"
    if declaration.choices:
        return ", ".join(f"{place}: {word}" for place, word in enumerate(declaration.choices))
    words = allowed(None, {"minimum": declaration.minimum, "maximum": declaration.maximum})
    whole = "whole, " if int in declaration.types else ""
    return f"{whole}{words}{'; 0: null' if NoneType in declaration.types else ''}"


def rows(parameters: list[tuple[VehicleParameter, float]]) -> Iterator[str]:
    """Return the lines of a table of parameters and their first values."""
    yield "| name | path | meaning | at first | unit | range |\n|---|---|---|---|---|---|"
    for parameter, told in parameters:
        declared = parameter.declaration
        cells = (
            f"`{parameter.name}`",
            f"`{declared.path}`",
            declared.help,
            f"{told:.7g}",
            declared.unit,
            range_of(parameter),
        )
        yield "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def document() -> str:
    """Return the whole page."""
    at_first = values_of(Tuning(RobotParameters(), WorldParameters()))
    told = [(parameter, parameter.to_number(value)) for parameter, value in zip(PARAMETERS, at_first, strict=True)]
    parts = [HEAD]
    for group, parameters in groupby(told, key=lambda each: group_of(each[0].name)):
        parts += [f"\n## {group}: {GROUPS[group]}\n", *rows([*parameters])]
    return "\n".join(parts) + "\n"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    page = ROOT / "docs" / "reference" / "mavlink-parameters.md"
    parser.add_argument("file", nargs="?", type=Path, metavar="FILE", default=page, help=f"default: {page.name}")
    parser.parse_args().file.write_text(document(), encoding="utf-8")
