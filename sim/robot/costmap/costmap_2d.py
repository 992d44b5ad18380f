"""Costmap of a robot, built from the robot's parameters.

Source: ros-planning/navigation, costmap_2d/src/costmap_2d_ros.cpp.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from sim.common.grid import OccupancyGrid
from sim.common.observations import TICKS_PER_SECOND, Neighbour
from sim.numerics.float_array import FloatArray
from sim.parameters import CostmapParameters, LocalCostmapParameters
from sim.robot.costmap.costs import CostFrame, Costs, Window
from sim.robot.costmap.footprint import of_radius, pad, radii
from sim.robot.costmap.inflation import InflationLayer
from sim.robot.costmap.layered import CostmapLayer, LayeredCostmap
from sim.robot.costmap.obstacle import CostmapObservation, ObstacleLayer
from sim.robot.costmap.robots import RobotsLayer
from sim.robot.costmap.static import StaticLayer


class Costmap2D:
    """A costmap with these layers, if enabled, in this order: static, obstacle, robots, inflation.

    Args:
        parameters: parameters of costmap_2d. If they are for a local costmap, the costmap moves with the robot.
        body: (n, 2) corners of the robot's true body, base frame, meters. They are used if the parameters have no
            footprint.
        grid: the map. The costmap has the same cells. The map's origin must not be rotated.

    Attributes:
        footprint: (n, 2) padded corners, base frame, meters.
        inscribed_radius: inscribed radius of the padded footprint, meters.
        circumscribed_radius: circumscribed radius of the padded footprint, meters.
        circular: True if the footprint is a circle (robot_radius), not a polygon.
        obstacles: layer of the obstacles that the laser has seen.
    """

    def __init__(self, parameters: CostmapParameters, body: FloatArray, grid: OccupancyGrid) -> None:
        self._grid = grid
        self._body = body
        self._robots = RobotsLayer(parameters.robots_layer, grid)
        self._cleared = 0
        self._build(parameters)

    def _build(self, parameters: CostmapParameters) -> None:
        """Build the costmap again. Keep only the layer of the robots."""
        grid = self._grid
        self._parameters = parameters
        self.footprint = pad(_corners(parameters, self._body), parameters.footprint_padding)
        self.inscribed_radius, self.circumscribed_radius = radii(self.footprint)
        self.circular = not parameters.footprint and parameters.robot_radius is not None
        self._shape: tuple[int, int] | None = None
        if isinstance(parameters, LocalCostmapParameters):
            # Rounding errors must not change the number of cells.
            self._shape = (
                int(parameters.height / grid.resolution + 1e-9),
                int(parameters.width / grid.resolution + 1e-9),
            )
        self.obstacles = ObstacleLayer(
            parameters.obstacle_layer,
            grid,
            self.footprint,
            parameters.track_unknown_space,
            self._shape,
            explained_by_walls=parameters.static_layer.enabled,
        )
        self._clear_ticks = round(TICKS_PER_SECOND / parameters.update_frequency)
        self._layers = _enabled(parameters, grid, self.inscribed_radius, self.obstacles, self._robots)
        self._walls: Costs | None = None
        if self._shape is None:
            self._walls = _walls_of(replace(parameters, publish_frequency=0.0), grid, self.inscribed_radius)
        self._layered = self._empty(self._layers)

    def _empty(self, layers: Sequence[CostmapLayer]) -> LayeredCostmap:
        """Make a costmap of the same size. It contains no obstacles except the walls, if they are known here."""
        track = self._parameters.track_unknown_space
        return LayeredCostmap(self._grid, layers, self._shape, track, self._walls)

    def configure(self, parameters: CostmapParameters) -> None:
        """Continue with these parameters and the present marks. Update the costs immediately."""
        if replace(parameters, publish_frequency=self._parameters.publish_frequency) == self._parameters:
            return
        seen, window = self.obstacles, self._layered.window
        middle = (window.row + window.row_end) // 2, (window.col + window.col_end) // 2
        self._build(parameters)
        if self._shape is not None:
            rows, cols = self._shape
            self._layered.origin = (middle[0] - rows // 2, middle[1] - cols // 2)
            self.obstacles.roll(self._layered.origin)
        self.obstacles.take_over(seen)
        self._layered.compose()

    @property
    def costs(self) -> Costs:
        """(rows, cols) costs of the last update."""
        return self._layered.costs

    @property
    def frame(self) -> CostFrame:
        """Frame of the costs in the map."""
        return self._layered.frame

    def observe(self, seen: CostmapObservation) -> None:
        """Process a scan. Mark immediately, and clear at the update rate of the costmap."""
        self._roll(seen.base_in_map.x, seen.base_in_map.y)
        tick = seen.scan.tick
        clears = not 0 < tick - self._cleared < self._clear_ticks
        if clears:
            self._cleared = tick
        self.obstacles.observe(seen, clears)

    def update_neighbours(self, neighbours: Sequence[Neighbour]) -> None:
        """Process the last broadcasts of the other robots."""
        self._robots.update_neighbours(neighbours)

    def update(self, x: float, y: float) -> tuple[Window, ...]:
        """Update the costs for a robot at this map point.

        Returns:
            The windows that were written, in cells of the static map. They may overlap.
        """
        self._roll(x, y)
        return self._layered.update()

    def without_robots(self) -> Costs:
        """Return (rows, cols) costs without the other robots."""
        return self._composed([layer for layer in self._layers if layer is not self._robots])

    def without_observations(self) -> Costs:
        """Return (rows, cols) costs without the other robots and without laser marks. They must not be changed."""
        if self._walls is not None:
            return self._walls
        blank = self.obstacles.copied()
        blank.clear()
        layers = [blank if layer is self.obstacles else layer for layer in self._layers]
        return self._composed([layer for layer in layers if layer is not self._robots])

    def _composed(self, layers: Sequence[CostmapLayer]) -> Costs:
        composed = self._empty(layers)
        composed.origin = self._layered.origin
        composed.compose()
        return composed.costs

    def as_updated(
        self, x: float, y: float, neighbours: Sequence[Neighbour], pending: CostmapObservation | None = None
    ) -> tuple[Costs, CostFrame]:
        """Return the costs and their frame as they would be after an update. The costmap does not change.

        Args:
            x: position of the robot in the map, with `y`.
            neighbours: the other robots.
            pending: a scan that the update would process.

        Returns:
            (rows, cols) costs and their frame.
        """
        robots = RobotsLayer(self._parameters.robots_layer, self._grid)
        changes = pending is not None or self._shape is not None
        obstacles = self.obstacles.copied() if changes else self.obstacles
        instead: dict[CostmapLayer, CostmapLayer] = {self._robots: robots, self.obstacles: obstacles}
        layers = [instead.get(layer, layer) for layer in self._layers]
        updated = self._empty(layers)
        updated.roll(x, y)
        robots.update_neighbours(neighbours if self._shape is None else robots.reaching(updated.window, neighbours))
        obstacles.roll(updated.origin)
        if pending is not None:
            obstacles.observe(pending)
        updated.compose()
        return updated.costs, updated.frame

    def _roll(self, x: float, y: float) -> None:
        self._layered.roll(x, y)
        self.obstacles.roll(self._layered.origin)


def _enabled(
    parameters: CostmapParameters,
    grid: OccupancyGrid,
    inscribed_radius: float,
    obstacles: ObstacleLayer,
    robots: RobotsLayer,
) -> list[CostmapLayer]:
    """Return the enabled layers, in the order in which they write."""
    static = StaticLayer(parameters.static_layer, grid)
    inflation = InflationLayer(parameters.inflation_layer, grid.resolution, inscribed_radius)
    layers: tuple[tuple[CostmapLayer, bool], ...] = (
        (static, parameters.static_layer.enabled),
        (obstacles, parameters.obstacle_layer.enabled),
        (robots, parameters.robots_layer.enabled),
        (inflation, parameters.inflation_layer.enabled),
    )
    return [layer for layer, enabled in layers if enabled]


@lru_cache(maxsize=8)
def _walls_of(parameters: CostmapParameters, grid: OccupancyGrid, inscribed_radius: float) -> Costs:
    """Return (rows, cols) costs of a costmap that covers the map, before any scan or broadcast.

    All robots with the same parameters share these costs, so they must not be changed.
    """
    obstacles = ObstacleLayer(
        parameters.obstacle_layer, grid, np.empty((0, 2)), parameters.track_unknown_space, explained_by_walls=False
    )
    robots = RobotsLayer(parameters.robots_layer, grid)
    track = parameters.track_unknown_space
    walls = LayeredCostmap(grid, _enabled(parameters, grid, inscribed_radius, obstacles, robots), None, track)
    walls.compose()
    return walls.costs


def _corners(parameters: CostmapParameters, body: FloatArray) -> FloatArray:
    if parameters.footprint:
        return np.array(parameters.footprint)
    if parameters.robot_radius is not None:
        return of_radius(parameters.robot_radius)
    return body
