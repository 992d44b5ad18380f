"""Write `docs/reference/parameters.md`: every parameter of the navigation stack, from the program's own classes.

python scripts/write_parameters.py [FILE]
"""

import argparse
import dataclasses
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, get_args, get_type_hints

from sim.parameters import RobotParameters, not_in_ros
from sim.parameters.declaration import is_section
from sim.parameters.reconfiguration import is_live
from thbridge.files.yaml.declarations import allowed, ros_only_of, sections_named_in

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

ROOT = Path(__file__).parents[1]

HEAD = """\
# Parameters

For people who tune robots, or who use parameter files of ROS.

This page lists every parameter of a robot's software, under its name in ROS. `scripts/write_parameters.py` writes the
page from the classes in `sim/parameters`. These classes also define the study file's reader and its error messages.

* The column *here*: **yes** means that the parameter has the same effect as in ROS. **live** means that it may also
  change while the robot runs, as in ROS with dynamic_reconfigure. (The goal tolerances of TrajectoryPlannerROS are
  live only here, not in ROS.) **accepted** means that the parameter has a meaning only inside ROS. Files may contain
  it, and a message says that it has no effect. **ours** means that ROS has no parameter of this name.
* The column *ROS* has the default that applies in ROS Noetic. It comes from the code of a node or from its `.cfg`,
  depending on which of the two takes precedence in ROS. The column *hunts* has the default of a study, if it is
  different.
* ROS files are read unchanged: `thbridge localize --params amcl.yaml`, `thbridge drive --params`, and in a study
  `ros_parameters: [amcl.yaml, costmap_common_params.yaml, move_base_params.yaml]`. If a launch file loads a file
  into a namespace (`ns="local_costmap"`), add the namespace to the file name: `local_costmap:costmap_local.yaml`.
* **Parameters that ROS files omit have ROS's defaults.** If a file is for a node (amcl, or move_base with its costmaps
  and planners), this node starts with the defaults of the column *ROS*. The program prints defaults that differ from
  the defaults of hunts, also with `--json` (`ros_defaults`). `thbridge localize` starts with ROS's defaults even
  without files. Noise presets and keys of the study override these defaults. Other nodes, and parameters that ROS does
  not have, keep the defaults of hunts. Parameters that the sections `world` and `robot` of a study omit keep them, too.
* The same options read files of ROS 2's Nav2: amcl, the costmaps, navfn, DWB (as DWAPlannerROS) and DWB's checkers.
  Their parameters have the names and defaults of Nav2, and the program prints these defaults. DWB's weights of paths
  and goals are halved, because DWB uses half the side of a cell for them. A critic that `critics` does not list has
  weight 0. In Nav2's files, a costmap without `plugins` has the static, obstacle and inflation layers. Without
  `track_unknown_space: true`, this costmap treats unknown cells of the map as free. The program uses the first goal
  checker and the first progress checker, or else Nav2's default checkers (0.25 m and 0.25 rad; 10 s for 0.5 m). Two
  defaults differ from Nav2, with a message: missing limits of speed and acceleration (0 in Nav2, so that the robot does
  not move), and heights of obstacles (lasers here scan in one plane). `move_base` replans at its own
  `planner_frequency`; Nav2's behavior tree replans once per second. Parameters without a counterpart have no effect,
  and a message names them: other planners (MPPI, Smac), nodes, critics and ranges.
* Layers and sensors of ROS 1's files are as in ROS 1, too. Without `plugins`, a costmap has the map only with
  `static_map: true`. Without `observation_sources`, it uses no sensor. A costmap that no file mentions keeps the map,
  the laser and the robot's body.
"""

TITLES = {
    ("amcl",): "amcl",
    ("ekf",): "Kalman filter (in place of robot_pose_ekf)",
    ("ukf",): "Unscented Kalman filter",
    ("fake_localization",): "fake_localization",
    ("global_costmap", "local_costmap"): "costmap_2d",
    ("NavfnROS",): "navfn",
    ("GlobalPlanner",): "global_planner",
    ("TrajectoryPlannerROS",): "base_local_planner",
    ("DWAPlannerROS",): "dwa_local_planner",
    ("move_base",): "move_base",
}
"""Headings by their sections. The two costmaps share a heading, because they have nearly the same parameters."""
OURS = "not ROS's"
NOTHING = "–"


@dataclass(frozen=True)
class Row:
    """Row of one parameter."""

    name: str
    state: str
    default: str = NOTHING
    hunts: str = NOTHING
    unit: str = ""
    range: str = ""
    meaning: str = ""

    def line(self) -> str:
        """Return the row as a line of a Markdown table."""
        cells = (f"`{self.name}`", self.state, self.default, self.hunts, self.unit, self.range, self.meaning)
        return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def rows(standard: "DataclassInstance", hunts: object, prefix: str = "", ours: bool = False) -> Iterator[Row]:
    """Yield the rows of all parameters of a section and of its subsections.

    Args:
        standard: section with ROS's defaults.
        hunts: section with the defaults of studies.
        prefix: prefix of the names, which ends in a dot, or an empty text.
        ours: True if ROS has no such section.
    """
    into = type(standard)
    hints = get_type_hints(into)
    for field in dataclasses.fields(standard):
        own, other = getattr(standard, field.name), getattr(hunts, field.name)
        name, help_text = prefix + field.name, field.metadata["help"]
        live = is_live(field)
        theirs = not ours and field.name not in not_in_ros(into)
        state = ("live" if live else "yes") if theirs else f"ours{', live' if live else ''}"
        if is_section(own):
            yield from rows(own, other, f"{name}.", not theirs)
            continue
        item = next(iter(get_args(hints[field.name])), None)
        if isinstance(item, type) and dataclasses.is_dataclass(item):
            names = field.name == sections_named_in(into)
            lists = [", ".join(entry.name for entry in entries) or "none" for entries in (own, other)]
            yield Row(name, state, lists[0], lists[1] if lists[1] != lists[0] else NOTHING, meaning=meaning(help_text))
            inner = f"{prefix}NAME." if names else f"{name}[]."
            # Sections with a freely chosen name begin with the class's defaults, even if a section with this name
            # exists.
            sample = item() if names else own[0]
            for row in rows(sample, sample, inner, ours):
                if not row.name.endswith(".name"):
                    yield row
                elif not names:
                    yield dataclasses.replace(row, default=NOTHING)
            continue
        choices = allowed(hints[field.name], {**field.metadata, "unit": ""})
        yield Row(
            name,
            state,
            shown(own),
            NOTHING if own == other else shown(other),
            field.metadata.get("unit", ""),
            choices,
            meaning(help_text),
        )
    for old, new in getattr(into, "renamed", {}).items():
        yield Row(prefix + old, "yes", meaning=f"old name of `{new}`")
    for name, place in getattr(into, "passed_on", {}).items():
        if name not in hints:
            yield Row(prefix + name, "yes", meaning=f"the same as `{place}`")
    for name, what in ros_only_of(into).items():
        yield Row(prefix + name, "accepted", meaning=what)


def shown(value: object) -> str:
    """Return a value as files contain it."""
    if isinstance(value, tuple):
        return f"[{', '.join(map(shown, value))}]"
    words = {None: "null", True: "true", False: "false"}
    return words[value] if value is None or isinstance(value, bool) else str(value)


def meaning(help_text: str) -> str:
    """Return a help text without its remark about the parameter's origin."""
    return re.sub(rf"\s*\({OURS}(?:; )?([^)]*)\)", lambda found: f" ({found[1]})" if found[1] else "", help_text)


def both(first: list[Row], second: list[Row]) -> Iterator[Row]:
    """Yield the rows of two sections as one table; where the sections differ, the global costmap comes first."""
    others = {row.name: row for row in second}
    for row in first:
        other = others.pop(row.name, None)
        if other is None or other == row:
            yield row
        elif other.state != row.state:
            yield dataclasses.replace(other, meaning=f"{other.meaning}; global costmap: {row.meaning}")
        else:
            hunts = [each.default if each.hunts == NOTHING else each.hunts for each in (row, other)]
            yield dataclasses.replace(row, hunts=f"{hunts[0]}, local {hunts[1]}")
    yield from (dataclasses.replace(row, meaning=f"{row.meaning} (local costmap)") for row in others.values())


def document() -> str:
    """Return the whole page."""
    robot = RobotParameters()
    parts = [HEAD]
    for sections, title in TITLES.items():
        tables, headings = [], []
        for section in sections:
            own = getattr(robot, section, None)
            if own is None:
                continue
            tables.append(list(rows(type(own)(), own, ours=section in not_in_ros(RobotParameters))))
            headings.append(f"`{section}`: {(type(own).__doc__ or '').splitlines()[0]}")
        if not tables:
            continue
        parts.append(f"\n## {title}\n\n{' '.join(headings)}\n")
        parts.append("| name | here | ROS | hunts | unit | range | meaning |\n|---|---|---|---|---|---|---|")
        parts += [row.line() for row in (both(*tables) if len(tables) == 2 else tables[0])]
    return "\n".join(parts) + "\n"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    page = ROOT / "docs" / "reference" / "parameters.md"
    parser.add_argument(
        "file", nargs="?", type=Path, metavar="FILE", default=page, help="default: docs/reference/parameters.md"
    )
    parser.parse_args().file.write_text(document(), encoding="utf-8")
