"""The navigator, under move_base's names; the defaults are those that its code applies."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar, Literal

from sim.parameters.knobs import knob

Behaviour = Literal["conservative_reset", "rotate_recovery", "aggressive_reset"]


@dataclass(frozen=True, slots=True)
class RecoveryBehavior:
    """One entry of recovery_behaviors."""

    ros_only: ClassVar[Mapping[str, str]] = {"type": "the plugin's class; here the name says which behaviour it is"}

    name: Behaviour = field(metadata={"help": "which behaviour"})


@dataclass(frozen=True, slots=True)
class MoveBaseParameters:
    """The navigator, under move_base's names."""

    ros_only: ClassVar[Mapping[str, str]] = {
        "clearing_radius": "is read, and used nowhere",
        "make_plan_add_unreachable_goal": "shapes the answer of the make_plan service",
        "make_plan_clear_costmap": "lets the make_plan service clear the costmaps around the robot",
        "restore_defaults": "a button of dynamic_reconfigure",
    }

    base_global_planner: str = knob(
        "navfn/NavfnROS", "the global planner", choices=("navfn/NavfnROS", "global_planner/GlobalPlanner")
    )
    base_local_planner: str = knob(
        "base_local_planner/TrajectoryPlannerROS",
        "the local planner",
        choices=("base_local_planner/TrajectoryPlannerROS", "dwa_local_planner/DWAPlannerROS"),
    )
    planner_frequency: float = knob(0.0, "plans per second under way; 0: only when the present one fails", "Hz", 0, 50)
    controller_frequency: float = knob(20.0, "commands per second", "Hz", 1, 50)
    planner_patience: float = knob(5.0, "seconds without a plan before recovery", "s", 0, 100)
    controller_patience: float = knob(15.0, "seconds without a valid command before recovery", "s", 0, 100)
    max_planning_retries: int = knob(-1, "plans tried in vain before recovery; -1: as many as fit", "", -1, 1000)
    oscillation_timeout: float = knob(0.0, "seconds without progress before recovery; 0: never", "s", 0, 600)
    oscillation_distance: float = knob(0.5, "moving this far counts as progress", "m", 0, 10)
    recovery_behavior_enabled: bool = knob(True, "try to get free before giving up")
    clearing_rotation_allowed: bool = knob(True, "whether recovery may turn the robot in place")
    conservative_reset_dist: float = knob(
        3.0, "conservative_reset forgets obstacles seen outside a square of this side around the robot", "m", 0, 50
    )
    recovery_behaviors: tuple[RecoveryBehavior, ...] = knob(
        (
            RecoveryBehavior("conservative_reset"),
            RecoveryBehavior("rotate_recovery"),
            RecoveryBehavior("aggressive_reset"),
            RecoveryBehavior("rotate_recovery"),
        ),
        "what recovery tries, in this order",
    )
    shutdown_costmaps: bool = knob(False, "without a goal, take no notice of obstacles")
