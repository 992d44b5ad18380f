"""Parameters of global planners, with the names of navfn and global_planner."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from sim.parameters.declaration import live, param

_WINDOW = "size of a window around the robot; ROS reads it but does not use it"


@dataclass(frozen=True, slots=True)
class NavfnParameters:
    """The first global planner. Its parameters are named as in navfn."""

    ros_only: ClassVar[Mapping[str, str]] = {
        "planner_window_x": _WINDOW,
        "planner_window_y": _WINDOW,
        "visualize_potential": "publish the potential",
    }

    allow_unknown: bool = param(True, "allow plans to cross unknown space")
    default_tolerance: float = param(
        0.0, "maximum distance between the end of a plan and a goal that cannot be reached", "m", 0, 50
    )
    use_astar: bool = param(False, "use A* instead of Dijkstra (navfn has both, but NavfnROS never uses A*)")


@dataclass(frozen=True, slots=True)
class GlobalPlannerParameters:
    """The second global planner. Its parameters are named as in global_planner."""

    ros_only: ClassVar[Mapping[str, str]] = {
        "planner_window_x": _WINDOW,
        "planner_window_y": _WINDOW,
        "publish_potential": "publish the potential",
        "publish_scale": "scale of the published potential",
        "outline_map": "treat the border of the map as an obstacle; here it always is one",
    }

    allow_unknown: bool = param(True, "allow plans to cross unknown space")
    default_tolerance: float = param(
        0.0, "maximum distance between the end of a plan and a goal that cannot be reached", "m", 0, 50
    )
    use_dijkstra: bool = param(True, "use Dijkstra; if false, use A*")
    use_quadratic: bool = param(
        True, "compute potentials that grow equally in all directions; if false, along rows and columns only"
    )
    use_grid_path: bool = param(False, "make paths from cell to cell; if false, along the gradient of the potential")
    old_navfn_behavior: bool = param(False, "make paths begin and end at cell centers, as navfn does")
    lethal_cost: int = live(
        253,
        "minimum cost of cells that plans never cross; with Dijkstra, this cost minus 1",
        "",
        1,
        255,
    )
    neutral_cost: int = live(50, "cost of crossing a free cell", "", 1, 255)
    cost_factor: float = live(3.0, "factor for the costs of the costmap (with Dijkstra)", "", 0.01, 5.0)
    orientation_mode: int = live(
        1,
        "headings along plans: 0 none, 1 forward, 2 interpolated from start to goal, 3 forward then interpolated,"
        " 4 backward, 5 leftward, 6 rightward",
        "",
        0,
        6,
    )
    orientation_window_size: int = live(
        1, "number of poses before and after a pose that determine its heading", "", 1, 255
    )
