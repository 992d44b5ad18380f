"""Layered costmaps, under costmap_2d's names."""

from dataclasses import dataclass

from sim.parameters.knobs import knob


@dataclass(frozen=True, slots=True)
class ObstacleParameters:
    """Marking and clearing by the laser (costmap_2d's ObstacleLayer)."""

    obstacle_range: float = knob(1.5, "farther readings do not mark", "m", 0, 50)
    raytrace_range: float = knob(1.5, "farther space is not cleared", "m", 0, 50)


@dataclass(frozen=True, slots=True)
class InflationParameters:
    """Costs around obstacles (costmap_2d's InflationLayer)."""

    inflation_radius: float = knob(0.5, "costs reach this far from an obstacle", "m", 0, 50)
    cost_scaling_factor: float = knob(10.0, "how fast the costs fall with the distance", "1/m", 0, 100)


@dataclass(frozen=True, slots=True)
class CostmapParameters:
    """Layered costmaps, under costmap_2d's names."""

    update_frequency: float = knob(5.0, "updates per second", "Hz", 0.1, 50)
    width: float = knob(4.0, "side of the rolling local map", "m", 1, 50)
    footprint_padding: float = knob(0.01, "added to every corner of the footprint", "m", 0, 1)
    obstacle_layer: ObstacleParameters = knob(ObstacleParameters(), "marking and clearing by the laser")
    inflation_layer: InflationParameters = knob(InflationParameters(), "costs around obstacles")
