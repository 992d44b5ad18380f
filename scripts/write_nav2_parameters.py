"""Write `docs/reference/nav2-parameters.md`: the parameters of a robot's Nav2 nodes, with their paths.

python scripts/write_nav2_parameters.py [FILE]
"""

import argparse
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from sim.parameters import RobotParameters
from thbridge.files.yaml.declarations import allowed
from thbridge.ros2.nav2_parameters import robot_nodes
from thbridge.ros2.parameters import NodeParameter, ParameterKind, ParameterNode

ROOT = Path(__file__).parents[1]

HEAD = """\
# Nav2 parameters

This page is for people who read or change parameters of a robot on a ROS 2 graph, for example with `ros2 param` or
rqt_reconfigure. `scripts/write_nav2_parameters.py` writes this page. [Nav2 services, actions and
topics](nav2-services.md) lists what else these nodes offer.

Each robot has the nodes below, in its namespace (`/robot1`, `/robot2`). The nodes of costmaps are
`global_costmap/global_costmap` and `local_costmap/local_costmap`. The tables list the parameters that Nav2 also has.
The column "path" has the key in the study file, below `robot:`.

* Each other parameter of a robot has its path as its name, for example `move_base.planner_frequency` of the node
  `bt_navigator`. `ros2 param list` shows these parameters as well. The node `/thbridge` has the rest of the study.
* A change affects one robot, takes effect in the next tick, and is recorded, so that a replay repeats it. A robot
  without energy ignores changes. Then the node publishes the old value again.
* *fixed* parameters are read-only, because they cannot change during a session. Their values are those of the study.
* A value has the type in the table. As in ROS 2, `1` is no double: write `1.0`. A null of the study is sent as 0.
* A node refuses a value out of range with a reason. If a value does not change anything, there is no event.
* Clients can set 200 parameters per tick. Each node accepts 10 requests per tick. The node refuses further requests.
* `FollowPath` is the local planner and `GridBased` is the global planner that the robot has at the start. The tables
  have their names with `DWAPlannerROS` and `NavfnROS`. With `TrajectoryPlannerROS`, `FollowPath` has its accelerations,
  velocities, `sim_time`, granularities and samples. With `GlobalPlanner`, `GridBased` has `tolerance` and
  `allow_unknown`. All other parameters of planners have their paths as names.

## Parameters of Nav2 that do not exist here

* amcl: `robot_model_type` (see `amcl.odom_model_type`), `set_initial_pose`, `initial_pose.z`, `save_pose_rate`,
  `transform_tolerance`, `first_map_only`, `always_reset_initial_pose`, `random_seed`
* controller_server: `failure_tolerance` (see `move_base.controller_patience`), velocity thresholds, topics of odometry
  and of speed limits
* DWB: sideways motion, `decel_lim_*`, `prune_*`, `publish_*`, other critics
* planner_server: `expected_planner_frequency` (see `move_base.planner_frequency`), `costmap_update_timeout`
* behavior_server: `behavior_plugins`, limits of its behaviors (see `move_base.recovery_behaviors`)
* bt_navigator: behavior trees and their plug-ins
* waypoint_follower: `loop_rate`, tasks at waypoints
* map_server: `yaml_filename`
* costmaps: filters, heights, voxels, ages of readings, minimum ranges, `transform_tolerance`, origins
"""


def range_of(parameter: NodeParameter) -> str:
    """Return the allowed values in words."""
    if parameter.read_only:
        return "fixed"
    if parameter.kind is ParameterKind.BOOL:
        return "true, false"
    if parameter.choices:
        return ", ".join(parameter.choices)
    return allowed(None, {"minimum": parameter.minimum, "maximum": parameter.maximum})


def path_of(parameter: NodeParameter) -> str:
    """Return the path in the study. Return an empty text if the study does not have the parameter."""
    last = parameter.description.rpartition(" (")[2]
    return parameter.path or (last[:-1] if last.endswith(")") and "." in last else "")


def rows(node: ParameterNode) -> Iterator[str]:
    """Return the lines of a table of a node's parameters."""
    yield "| name | type | path | values |\n|---|---|---|---|"
    for parameter in node.parameters.values():
        path = path_of(parameter)
        if path and parameter.name != path:
            cells = f"`{parameter.name}`", parameter.kind.name.lower(), f"`{path}`", range_of(parameter)
            yield "| " + " | ".join(cells) + " |"


def document() -> str:
    """Return the whole page."""
    software = RobotParameters()
    base = replace(software.move_base, base_local_planner="dwa_local_planner/DWAPlannerROS")
    parts = [HEAD]
    for node in robot_nodes(0, replace(software, move_base=base), 0.05):
        lines = [*rows(node)]
        if len(lines) > 1:
            parts += [f"\n## {node.name}\n", *lines]
    return "\n".join(parts) + "\n"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    page = ROOT / "docs" / "reference" / "nav2-parameters.md"
    parser.add_argument("file", nargs="?", type=Path, metavar="FILE", default=page, help=f"default: {page.name}")
    parser.parse_args().file.write_text(document(), encoding="utf-8")
