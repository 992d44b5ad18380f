"""Installed parts that parameters name. Installed parts are parts that are not built in."""

from collections.abc import Iterator
from typing import Literal

from sim.parameters.move_base import BUILT_IN_PLANNERS, BUILT_IN_RECOVERIES
from sim.parameters.robot import BUILT_IN_LOCALIZERS, RobotParameters

PartKind = Literal["localizers", "planners", "recoveries"]


def installed_names(parameters: RobotParameters) -> Iterator[tuple[PartKind, str, str]]:
    """Yield kind, parameter and name of each installed part in the parameters."""
    if parameters.localization not in BUILT_IN_LOCALIZERS:
        yield "localizers", "localization", parameters.localization
    if parameters.move_base.base_global_planner not in BUILT_IN_PLANNERS:
        yield "planners", "move_base.base_global_planner", parameters.move_base.base_global_planner
    for behavior in parameters.move_base.recovery_behaviors:
        if behavior.name not in BUILT_IN_RECOVERIES:
            yield "recoveries", "move_base.recovery_behaviors", behavior.name
