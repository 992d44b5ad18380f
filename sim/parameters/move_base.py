"""The navigator, under move_base's names; the defaults are those that its code applies."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from sim.parameters.declaration import live, param

BUILT_IN_PLANNERS = ("navfn/NavfnROS", "global_planner/GlobalPlanner")
BUILT_IN_RECOVERIES = ("conservative_reset", "rotate_recovery", "aggressive_reset")


@dataclass(frozen=True, slots=True)
class RecoveryBehavior:
    """One entry of recovery_behaviors."""

    ros_only: ClassVar[Mapping[str, str]] = {"type": "the plugin's class; here the name says which behaviour it is"}

    name: str = field(
        metadata={
            "help": "which behaviour; also one that is installed",
            "choices": BUILT_IN_RECOVERIES,
            "plugins": "thbridge.recovery_behaviors",
        }
    )


@dataclass(frozen=True, slots=True)
class MoveBaseParameters:
    """The navigator, under move_base's names."""

    ros_only: ClassVar[Mapping[str, str]] = {
        "clearing_radius": "how far make_plan clears the costmaps around the robot: here it leaves them as they are",
        "make_plan_clear_costmap": "whether make_plan clears the costmaps: here it leaves them as they are",
        "restore_defaults": "a button of dynamic_reconfigure",
    }

    base_global_planner: str = live(
        "navfn/NavfnROS",
        "the global planner; also one that is installed, which cannot be chosen while the robot runs",
        choices=BUILT_IN_PLANNERS,
        plugins="thbridge.global_planners",
    )
    base_local_planner: str = live(
        "base_local_planner/TrajectoryPlannerROS",
        "the local planner",
        choices=("base_local_planner/TrajectoryPlannerROS", "dwa_local_planner/DWAPlannerROS"),
    )
    planner_frequency: float = live(0.0, "plans per second under way; 0: only when the present one fails", "Hz", 0, 50)
    controller_frequency: float = live(20.0, "commands per second", "Hz", 1, 50)
    planner_patience: float = live(5.0, "seconds without a plan before recovery", "s", 0, 100)
    controller_patience: float = live(15.0, "seconds without a valid command before recovery", "s", 0, 100)
    max_planning_retries: int = live(-1, "plans tried in vain before recovery; -1: as many as fit", "", -1, 1000)
    oscillation_timeout: float = live(
        0.0, "seconds without progress before recovery; 0: 20 s in one place", "s", 0, 600
    )
    oscillation_distance: float = live(0.5, "moving this far counts as progress", "m", 0, 10)
    recovery_behavior_enabled: bool = live(True, "try to get free before giving up")
    clearing_rotation_allowed: bool = live(True, "whether recovery may turn the robot in place")
    conservative_reset_dist: float = live(
        3.0, "conservative_reset forgets obstacles seen outside a square of this side around the robot", "m", 0, 50
    )
    recovery_behaviors: tuple[RecoveryBehavior, ...] = param(
        (
            RecoveryBehavior("conservative_reset"),
            RecoveryBehavior("rotate_recovery"),
            RecoveryBehavior("aggressive_reset"),
            RecoveryBehavior("rotate_recovery"),
        ),
        "what recovery tries, in this order",
    )
    make_plan_add_unreachable_goal: bool = live(
        True, "make_plan, where it finds a way only to a place near the goal, adds the goal itself to the end"
    )
    shutdown_costmaps: bool = live(False, "without a goal, take no notice of obstacles")
