"""Write `docs/reference/mavlink-parameters.md`: the MAVLink names of the study's parameters, and their ranges.

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

This page is for people who read or change parameters of a robot with a ground station.

It lists the numbers of the study that a ground station may change while the robots drive, by their MAVLink names.
`scripts/write_mavlink_parameters.py` writes this page.

* The column "path" has the key in the study file, below `robot:`. Paths that begin with `world` are at the top level.
  The column "default" has the value that a robot starts with if the study does not set the key.
* A change affects one robot, takes effect in the next tick, and is recorded, so that a replay repeats it.
* All values are REAL32. The vehicle sends the nearest REAL32 to the current value. Setting a value that was read
  changes nothing. A value that a station sets means the shortest decimal number with the same REAL32.
* *0 or 1* is a switch. A word is sent as its index among the choices, from 0.
* The file `parameters.json` of each vehicle has the same contents for ground stations; see mavlink-commands.md.
* A value is refused if it is not a number, has a fraction where only whole numbers are allowed, or is out of range.
  The vehicle then sends the old value.

## Parameters of the vehicle

These three parameters come before the parameters of the robot. They have the names that ArduPilot's rovers use.

| name | key of the study | meaning | range |
|---|---|---|---|
| `SYSID_THISMAV` | | the robot's number | fixed |
| `FS_GCS_TIMEOUT` | `mavlink: lost_after` | time without heartbeats after which a station is lost | 1 to 600 s |
| `FS_ACTION` | `mavlink: failsafe` | action of a robot after the loss of its station | 0: continue, 1: home, 2: stop |
"""


def range_of(parameter: VehicleParameter) -> str:
    """Return the allowed values in words."""
    declaration = parameter.declaration
    if bool in declaration.types:
        return "0 or 1"
    if declaration.choices:
        return ", ".join(f"{place}: {word}" for place, word in enumerate(declaration.choices))
    words = allowed(None, {"minimum": declaration.minimum, "maximum": declaration.maximum})
    whole = "whole, " if int in declaration.types else ""
    return f"{whole}{words}{'; 0: null' if NoneType in declaration.types else ''}"


def rows(parameters: list[tuple[VehicleParameter, float]]) -> Iterator[str]:
    """Return the lines of a table of parameters and their default values."""
    yield "| name | path | meaning | default | unit | range |\n|---|---|---|---|---|---|"
    for parameter, sent in parameters:
        declared = parameter.declaration
        cells = (
            f"`{parameter.name}`",
            f"`{declared.path}`",
            declared.help,
            f"{sent:.7g}",
            declared.unit,
            range_of(parameter),
        )
        yield "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def document() -> str:
    """Return the whole page."""
    at_first = values_of(Tuning(RobotParameters(), WorldParameters()))
    sent = [(parameter, parameter.to_number(value)) for parameter, value in zip(PARAMETERS, at_first, strict=True)]
    parts = [HEAD]
    for group, parameters in groupby(sent, key=lambda each: group_of(each[0].name)):
        parts += [f"\n## {group}: {GROUPS[group]}\n", *rows([*parameters])]
    return "\n".join(parts) + "\n"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    page = ROOT / "docs" / "reference" / "mavlink-parameters.md"
    parser.add_argument("file", nargs="?", type=Path, metavar="FILE", default=page, help=f"default: {page.name}")
    parser.parse_args().file.write_text(document(), encoding="utf-8")
