"""Parts of a robot's software that labs bring, by the names that parameters have for them."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Literal

from sim.parameters import BUILT_IN_LOCALIZERS, BUILT_IN_PLANNERS, BUILT_IN_RECOVERIES, RobotParameters
from sim.robot.global_planning.path import PlannerFactory
from sim.robot.localization.estimate import LocalizerFactory
from sim.robot.navigator.recovery import RecoveryFactory

PartKind = Literal["localizers", "planners", "recoveries"]


@dataclass(frozen=True, slots=True)
class InstalledParts:
    """Factories of parts. What they make raises `PartFailed`, and nothing else, where it fails.

    Attributes:
        localizers: localizers.
        planners: global planners.
        recoveries: recovery behaviors.
    """

    localizers: Mapping[str, LocalizerFactory] = field(default_factory=dict)
    planners: Mapping[str, PlannerFactory] = field(default_factory=dict)
    recoveries: Mapping[str, RecoveryFactory] = field(default_factory=dict)

    def check(self, parameters: RobotParameters) -> None:
        """Raise ValueError where parameters name a part that is not here."""
        for kind, _, name in installed_names(parameters):
            if name not in getattr(self, kind):
                raise ValueError(f"there is no part {name} among the {kind}")


def installed_names(parameters: RobotParameters) -> Iterator[tuple[PartKind, str, str]]:
    """Yield the kind, the parameter and the name of each part that parameters name and that is not built in."""
    if parameters.localization not in BUILT_IN_LOCALIZERS:
        yield "localizers", "localization", parameters.localization
    if parameters.move_base.base_global_planner not in BUILT_IN_PLANNERS:
        yield "planners", "move_base.base_global_planner", parameters.move_base.base_global_planner
    for behavior in parameters.move_base.recovery_behaviors:
        if behavior.name not in BUILT_IN_RECOVERIES:
            yield "recoveries", "move_base.recovery_behaviors", behavior.name
