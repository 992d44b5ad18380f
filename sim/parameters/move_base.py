"""Parameters of the navigator, with the names of move_base and the defaults in its code."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from sim.parameters.declaration import live, param

BUILT_IN_PLANNERS = ("navfn/NavfnROS", "global_planner/GlobalPlanner")
BUILT_IN_RECOVERIES = ("conservative_reset", "rotate_recovery", "aggressive_reset")


@dataclass(frozen=True, slots=True)
class RecoveryBehavior:
    """One entry of recovery_behaviors."""

    ros_only: ClassVar[Mapping[str, str]] = {"type": "class of the plugin; here the name selects the behavior"}

    name: str = field(
        metadata={
            "help": "name of the recovery behavior: built in or installed",
            "choices": BUILT_IN_RECOVERIES,
            "plugins": "thbridge.recovery_behaviors",
        }
    )


@dataclass(frozen=True, slots=True)
class MoveBaseParameters:
    """The navigator. Its parameters are named as in move_base."""

    ros_only: ClassVar[Mapping[str, str]] = {
        "clearing_radius": "radius in which make_plan clears the costmaps; here make_plan does not clear them",
        "make_plan_clear_costmap": "let make_plan clear the costmaps; here make_plan does not clear them",
        "restore_defaults": "a button of dynamic_reconfigure",
    }

    base_global_planner: str = live(
        "navfn/NavfnROS",
        "global planner: built in or installed; installed planners cannot be chosen while the robot runs",
        choices=BUILT_IN_PLANNERS,
        plugins="thbridge.global_planners",
    )
    base_local_planner: str = live(
        "base_local_planner/TrajectoryPlannerROS",
        "local planner",
        choices=("base_local_planner/TrajectoryPlannerROS", "dwa_local_planner/DWAPlannerROS"),
    )
    planner_frequency: float = live(
        0.0, "rate of replanning while driving; 0: replan only when the present plan fails", "Hz", 0, 50
    )
    controller_frequency: float = live(20.0, "rate of velocity commands", "Hz", 1, 50)
    planner_patience: float = live(5.0, "time without a plan before recovery starts", "s", 0, 100)
    controller_patience: float = live(15.0, "time without a valid velocity command before recovery starts", "s", 0, 100)
    max_planning_retries: int = live(
        -1,
        "number of failed planning attempts before recovery starts; -1: only planner_patience limits them",
        "",
        -1,
        1000,
    )
    oscillation_timeout: float = live(
        0.0, "time without progress before recovery starts; 0: 20 s without leaving the spot", "s", 0, 600
    )
    oscillation_distance: float = live(0.5, "distance that counts as progress", "m", 0, 10)
    recovery_behavior_enabled: bool = live(True, "run recovery behaviors before a goal is given up")
    clearing_rotation_allowed: bool = live(True, "allow rotate_recovery to turn the robot in place")
    conservative_reset_dist: float = live(
        3.0,
        "conservative_reset clears obstacles outside a square around the robot; this is the length of its sides",
        "m",
        0,
        50,
    )
    recovery_behaviors: tuple[RecoveryBehavior, ...] = param(
        (
            RecoveryBehavior("conservative_reset"),
            RecoveryBehavior("rotate_recovery"),
            RecoveryBehavior("aggressive_reset"),
            RecoveryBehavior("rotate_recovery"),
        ),
        "recovery behaviors in the order in which they run",
    )
    make_plan_add_unreachable_goal: bool = live(
        True, "if make_plan finds a path only to a point near the goal, append the goal itself"
    )
    shutdown_costmaps: bool = live(False, "do not update the costmaps from scans while the robot has no goal")
