"""Global planners, under the names of navfn and global_planner."""

from dataclasses import dataclass

from sim.parameters.knobs import knob


@dataclass(frozen=True, slots=True)
class NavfnParameters:
    """The global planner, under navfn's names."""

    allow_unknown: bool = knob(True, "plans may cross unknown space")
