"""Global planners, under the names of navfn and global_planner."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from sim.parameters.declaration import live, param

_WINDOW = "the size of a window around the robot: read, but never used by ROS either"


@dataclass(frozen=True, slots=True)
class NavfnParameters:
    """The global planner, under navfn's names."""

    ros_only: ClassVar[Mapping[str, str]] = {
        "planner_window_x": _WINDOW,
        "planner_window_y": _WINDOW,
        "visualize_potential": "whether the potential is published",
    }

    allow_unknown: bool = param(True, "plans may cross unknown space")
    default_tolerance: float = param(0.0, "how far from a goal that cannot be reached plans may end", "m", 0, 50)
    use_astar: bool = param(False, "A* instead of Dijkstra (navfn has it, but NavfnROS never uses it)")


@dataclass(frozen=True, slots=True)
class GlobalPlannerParameters:
    """The other global planner, under global_planner's names."""

    ros_only: ClassVar[Mapping[str, str]] = {
        "planner_window_x": _WINDOW,
        "planner_window_y": _WINDOW,
        "publish_potential": "whether the potential is published",
        "publish_scale": "how the potential is scaled when published",
        "outline_map": "whether the map's rim is an obstacle: here it always is",
    }

    allow_unknown: bool = param(True, "plans may cross unknown space")
    default_tolerance: float = param(0.0, "how far from a goal that cannot be reached plans may end", "m", 0, 50)
    use_dijkstra: bool = param(True, "Dijkstra, else A*")
    use_quadratic: bool = param(True, "potentials grow alike in all directions, else along rows and columns")
    use_grid_path: bool = param(False, "paths go from cell to cell, else down the slope of the potential")
    old_navfn_behavior: bool = param(False, "paths begin and end at the centres of cells, as navfn's do")
    lethal_cost: int = live(253, "cells of this cost, of one less with Dijkstra, or more cannot be passed", "", 1, 255)
    neutral_cost: int = live(50, "what it costs to pass a free cell", "", 1, 255)
    cost_factor: float = live(3.0, "what the costmap's costs are multiplied by (with Dijkstra)", "", 0.01, 5.0)
    orientation_mode: int = live(
        1,
        "headings along plans: 0 none, 1 forward, 2 evenly from start to goal, 3 forward and evenly at last,"
        " 4 backward, 5 leftward, 6 rightward",
        "",
        0,
        6,
    )
    orientation_window_size: int = live(1, "how many poses on each side a heading is taken from", "", 1, 255)
