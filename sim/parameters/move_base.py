"""The navigator, under move_base's names."""

from dataclasses import dataclass

from sim.parameters.knobs import knob


@dataclass(frozen=True, slots=True)
class MoveBaseParameters:
    """The navigator, under move_base's names."""

    controller_frequency: float = knob(10.0, "commands per second (ROS: 20)", "Hz", 1, 50)
    planner_patience: float = knob(5.0, "seconds without a plan before recovery", "s", 0, 100)
    oscillation_timeout: float = knob(10.0, "seconds without progress before recovery; 0: never (ROS: 0)", "s", 0, 600)
    oscillation_distance: float = knob(0.5, "moving this far counts as progress", "m", 0, 10)
    recovery_behavior_enabled: bool = knob(True, "try to get free before giving up")
