"""Write `docs/reference/parameters.md`: every parameter of the navigation stack, from where the programs have them.

python scripts/write_parameters.py [FILE]
"""

import argparse
import dataclasses
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import get_args, get_type_hints

from sim.parameters import RobotParameters, not_in_ros
from sim.parameters.reconfiguration import is_live
from thbridge.files.yaml.declarations import allowed, ros_only_of, sections_named_in

ROOT = Path(__file__).parents[1]

HEAD = """\
# Parameters

Every parameter of a robot's software, under the name it has in ROS. `scripts/write_parameters.py` writes this page from
the classes in `sim/parameters`, which the study file's reader and its error messages are made of too.

* **yes**: does here what it does in ROS. **live**: that, and it may change while the robot runs, which it can in ROS by
  dynamic_reconfigure (but for the goal tolerances of TrajectoryPlannerROS). **accepted**: means something inside ROS
  only; files may have it, and are told that it changes nothing. **ours**: ROS has no such name.
* *ROS* is the default that really applies in ROS noetic, from a node's code or from its `.cfg`, whichever wins there.
  *Hunts* is what a study begins with, where that is something else.
* Files of ROS are read as they are: `thbridge localize --params amcl.yaml`, `thbridge drive --params`, and in a study
  `ros_parameters: [amcl.yaml, costmap_common_params.yaml, move_base_params.yaml]`. Where a launch file loads one into a
  namespace (`ns="local_costmap"`), name it with that: `local_costmap:costmap_local.yaml`.
* **What files of ROS leave out is as in ROS**: a node that any of them is for (amcl; or move_base with its costmaps and
  planners) begins with the column *ROS*, and those of these defaults that hunts do not have are told, also by `--json`
  (`ros_defaults`). `thbridge localize` begins there without files too. Presets of noise and lines of the study win over
  that. Other nodes, and names that ROS does not have, stay as in hunts; so does what the sections `world` and `robot`
  of a study leave out.
* Files of ROS 2's Nav2 are read by the same options: amcl, the costmaps, navfn, DWB (as DWAPlannerROS) and its
  checkers, under their own names and with Nav2's defaults, which are told. DWB's weights of paths and goals are halved,
  as DWB takes half of a cell's side for them; a critic that `critics` does not list has the weight 0. A costmap without
  `plugins` has the static, obstacle and inflation layers there; without `track_unknown_space: true` it takes the map's
  unknown cells for free. The first goal checker and progress checker hold, also Nav2's by default (0.25 m
  and 0.25 rad; 10 s for 0.5 m). Two defaults differ from Nav2, with a message: missing limits of speed and
  acceleration (0 in Nav2, so that the robot does not move), and heights of obstacles (lasers here see in one plane).
  `move_base` replans at its own `planner_frequency`; Nav2's behavior tree replans once a second. What has no
  counterpart is named, and has no effect: other planners (MPPI, Smac), nodes, critics and ranges.
* Layers and sensors are as in ROS 1, too: without `plugins`, a costmap has the map only by `static_map: true`, without
  `observation_sources` it sees nothing. A costmap of which no file says anything keeps map, laser and the robot's body.
"""

TITLES = {
    ("amcl",): "amcl",
    ("ekf",): "Kalman filter (robot_pose_ekf's place)",
    ("ukf",): "Unscented Kalman filter",
    ("fake_localization",): "fake_localization",
    ("global_costmap", "local_costmap"): "costmap_2d",
    ("NavfnROS",): "navfn",
    ("GlobalPlanner",): "global_planner",
    ("TrajectoryPlannerROS",): "base_local_planner",
    ("DWAPlannerROS",): "dwa_local_planner",
    ("move_base",): "move_base",
}
"""Headings, by the sections under them; the costmaps have nearly all parameters in common."""
OURS = "not ROS's"
NOTHING = "–"


@dataclass(frozen=True)
class Row:
    """One parameter."""

    name: str
    state: str
    default: str = NOTHING
    hunts: str = NOTHING
    unit: str = ""
    range: str = ""
    meaning: str = ""

    def line(self) -> str:
        """Return the line of the table."""
        cells = (f"`{self.name}`", self.state, self.default, self.hunts, self.unit, self.range, self.meaning)
        return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def rows(standard: object, hunts: object, prefix: str = "", ours: bool = False) -> Iterator[Row]:
    """Return the rows of all parameters of a section and of those inside it.

    Args:
        standard: the section with ROS's defaults.
        hunts: the section as studies begin with it.
        prefix: of the names, with its dot.
        ours: ROS has no such section.
    """
    into = type(standard)
    hints = get_type_hints(into)
    for field in dataclasses.fields(standard):
        own, other = getattr(standard, field.name), getattr(hunts, field.name)
        name, help_text = prefix + field.name, field.metadata["help"]
        live = is_live(field)
        theirs = not ours and field.name not in not_in_ros(into)
        state = ("live" if live else "yes") if theirs else f"ours{', live' if live else ''}"
        if dataclasses.is_dataclass(own):
            yield from rows(own, other, f"{name}.", not theirs)
            continue
        item = next(iter(get_args(hints[field.name])), None)
        if dataclasses.is_dataclass(item):
            names = field.name == sections_named_in(into)
            lists = [", ".join(entry.name for entry in entries) or "none" for entries in (own, other)]
            yield Row(name, state, lists[0], lists[1] if lists[1] != lists[0] else NOTHING, meaning=meaning(help_text))
            inner = f"{prefix}NAME." if names else f"{name}[]."
            # Sections with a name of their own begin at the class's defaults, whatever those that are there say.
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
    """Return a value as files have it."""
    if isinstance(value, tuple):
        return f"[{', '.join(map(shown, value))}]"
    words = {None: "null", True: "true", False: "false"}
    return words[value] if value is None or isinstance(value, bool) else str(value)


def meaning(help_text: str) -> str:
    """Return a help text without its remark on whose parameter it is."""
    return re.sub(rf"\s*\({OURS}(?:; )?([^)]*)\)", lambda found: f" ({found[1]})" if found[1] else "", help_text)


def both(first: list[Row], second: list[Row]) -> Iterator[Row]:
    """Return the rows of two sections in one table; where they differ, the global costmap's word comes first."""
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
        "file", nargs="?", type=Path, metavar="FILE", default=page, help="by default docs/reference/parameters.md"
    )
    parser.parse_args().file.write_text(document(), encoding="utf-8")
