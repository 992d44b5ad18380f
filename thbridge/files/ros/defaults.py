"""Defaults of ROS that hold because files of ROS leave parameters out, and differ from those of hunts."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import cast

from sim.parameters import RobotParameters, parameters_of
from thbridge.files.ros.parameters import COSTMAPS, PLANNERS


@dataclass(frozen=True, slots=True)
class RosDefault:
    """A parameter that files of ROS leave out, with ROS's default.

    Attributes:
        name: its path, `amcl.max_particles`.
        value: ROS's default, which holds.
        hunts: the value that it has in hunts.
    """

    name: str
    value: object
    hunts: object

    def as_json(self) -> dict[str, object]:
        """Return it as the JSON object has it."""
        return {"name": self.name, "value": _plain(self.value), "hunts": _plain(self.hunts)}


def ros_defaults(
    robot: RobotParameters, start: RobotParameters, hunts: RobotParameters, written: Collection[str]
) -> tuple[RosDefault, ...]:
    """Those parameters of a robot that matter to it and are ROS's defaults, where hunts have others.

    Planners that do not drive, layers that are off, and the radius of a robot with a footprint do not matter.

    Args:
        robot: its parameters.
        start: what they were before files were read (`RosFiles.start`).
        hunts: the standard ones.
        written: paths of the parameters that stand in files.
    """
    known, begun = dict(parameters_of(robot)), dict(parameters_of(start))
    chosen = {robot.move_base.base_global_planner, robot.move_base.base_local_planner}
    idle = {kind.rpartition("/")[2] for kinds in PLANNERS.values() for kind in kinds if kind not in chosen}

    def matters(name: str) -> bool:
        section, _, own = name.partition(".")
        if section in idle:
            return False
        layer, dot, _ = own.partition(".")
        if dot and own != f"{layer}.enabled" and known[f"{section}.{layer}.enabled"] is False:
            return False
        return own != "robot_radius" or not known[f"{section}.footprint"]

    return tuple(
        RosDefault(name, value, standard)
        for (name, standard) in parameters_of(hunts)
        if (value := begun[name]) != standard and known[name] == value and name not in written and matters(name)
    )


def sentences_of(defaults: Sequence[RosDefault]) -> Iterator[str]:
    """Yield a sentence for each section with such parameters; what the costmaps have in common stands in one."""
    lists: dict[str, list[str]] = {}
    shared = _shared(defaults)
    for default in defaults:
        section, _, own = default.name.partition(".")
        if own in shared and section == COSTMAPS[1]:
            continue
        title = " and ".join(COSTMAPS) if own in shared and section in COSTMAPS else section
        lists.setdefault(title, []).append(f"{own} {_shown(default.value)} ({_shown(default.hunts)})")
    for title, items in lists.items():
        yield f"{title}: left out, so as in ROS (and in hunts): {', '.join(items)}"


def _shared(defaults: Sequence[RosDefault]) -> set[str]:
    """Names of the parameters that are the same in both costmaps."""
    costmaps = [
        {
            (d.name.partition(".")[2], _shown(d.value), _shown(d.hunts))
            for d in defaults
            if d.name.startswith(f"{costmap}.")
        }
        for costmap in COSTMAPS
    ]
    return {name for name, _, _ in costmaps[0] & costmaps[1]}


def _plain(value: object) -> object:
    """The value as YAML and JSON have it; sections in a list are their names."""
    if isinstance(value, tuple):
        return [_plain(item) for item in cast(tuple[object, ...], value)]
    return cast(object, getattr(value, "name", value))


def _shown(value: object) -> str:
    plain = _plain(value)
    if isinstance(plain, list):
        return " ".join(map(str, cast(list[object], plain))) or "none"
    return (
        {None: "null", True: "true", False: "false"}[plain] if plain is None or isinstance(plain, bool) else str(plain)
    )
