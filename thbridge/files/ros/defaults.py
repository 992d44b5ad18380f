"""ROS's defaults that differ from the defaults of hunts. They apply if ROS files leave a parameter out."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import cast

from sim.parameters import RobotParameters, parameters_of
from thbridge.files.ros.parameters import COSTMAPS, PLANNERS


@dataclass(frozen=True, slots=True)
class RosDefault:
    """A parameter that ROS files leave out, with ROS's default.

    Attributes:
        name: path of the parameter, such as `amcl.max_particles`.
        value: ROS's default, which is used.
        hunts: value in hunts.
    """

    name: str
    value: object
    hunts: object

    def as_json(self) -> dict[str, object]:
        """Return the default as a JSON object."""
        return {"name": self.name, "value": _plain(self.value), "hunts": _plain(self.hunts)}


def ros_defaults(
    robot: RobotParameters, start: RobotParameters, hunts: RobotParameters, written: Collection[str]
) -> tuple[RosDefault, ...]:
    """Return the parameters for which a robot uses ROS's default, although hunts have another value.

    Parameters of unused planners, of disabled layers, and the radius of a robot with a footprint are left out.

    Args:
        robot: parameters of the robot.
        start: parameters before files were read (`RosFiles.start`).
        hunts: standard parameters.
        written: paths of the parameters that the files contain.
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
    """Yield a sentence for each section with these parameters, and a sentence for parameters of both costmaps."""
    lists: dict[str, list[str]] = {}
    shared = _shared(defaults)
    for default in defaults:
        section, _, own = default.name.partition(".")
        if own in shared and section == COSTMAPS[1]:
            continue
        title = " and ".join(COSTMAPS) if own in shared and section in COSTMAPS else section
        lists.setdefault(title, []).append(f"{own} {_shown(default.value)} ({_shown(default.hunts)})")
    for title, items in lists.items():
        yield f"{title}: parameters left out, with ROS's defaults (the values of hunts in brackets): {', '.join(items)}"


def _shared(defaults: Sequence[RosDefault]) -> set[str]:
    """Return the names of the parameters that are the same in both costmaps."""
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
    """Return a value in types of YAML and JSON; sections in a list are replaced by their names."""
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
