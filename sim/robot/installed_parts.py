"""Installed parts of a robot's software, by the names that parameters contain."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from sim.parameters import RobotParameters, installed_names
from sim.robot.global_planning.path import PlannerFactory
from sim.robot.localization.estimate import LocalizerFactory
from sim.robot.navigator.recovery import RecoveryFactory


@dataclass(frozen=True, slots=True)
class InstalledParts:
    """Factories of installed parts, by name. If a part fails, it raises `PartFailed` and no other exception.

    Attributes:
        localizers: factories of localizers.
        planners: factories of global planners.
        recoveries: factories of recovery behaviors.
    """

    localizers: Mapping[str, LocalizerFactory] = field(default_factory=dict)
    planners: Mapping[str, PlannerFactory] = field(default_factory=dict)
    recoveries: Mapping[str, RecoveryFactory] = field(default_factory=dict)

    def check(self, parameters: RobotParameters) -> None:
        """Raise ValueError if parameters name a part that is not installed."""
        for kind, _, name in installed_names(parameters):
            if name not in getattr(self, kind):
                raise ValueError(f"there is no part {name} among the {kind}")
