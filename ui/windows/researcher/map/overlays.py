"""Layers of the researcher's map: particles, scans, costmaps, plans, paths, goals, obstacles."""

import numpy as np
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QBrush, QColor, QPainter, QPen, QPolygonF

from sim.numerics.float_array import FloatArray
from ui.model.watching.scene import NO_POINTS, RobotScene, Scene
from ui.windows.map import MapView
from ui.windows.map.layers import CostmapImageLayer, LineLayer, PointLayer, PoseLayer
from ui.windows.map.points import pieces, polygon
from ui.windows.researcher.docks.displays import DisplaysPanel, MapDisplay

Z_COSTS, Z_FLOOR, Z_FLAT, Z_ABOVE = -30, -20, -10, 10
"""Order of painting: below the robots when negative, above them otherwise."""


class ThingLayer:
    """A layer of obstacles, standing or moving."""

    z = Z_FLAT
    _outlines: tuple[tuple[str, FloatArray], ...] = ()

    def show(self, outlines: tuple[tuple[str, FloatArray], ...]) -> None:
        """Show obstacles: their names and (n, 2) corners."""
        self._outlines = outlines

    def paint(self, painter: QPainter, view: MapView) -> None:
        """Draw hatched outlines with their names."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for name, corners in self._outlines:
            body = polygon(view.camera.to_screen(corners))
            painter.setPen(QPen(QColor(view.colours.bad), 2.0))
            painter.setBrush(QBrush(QColor(view.colours.bad), Qt.BrushStyle.BDiagPattern))
            painter.drawPolygon(body)
            painter.setPen(QColor(view.colours.text))
            painter.drawText(QPointF(body.boundingRect().right() + 4.0, body.boundingRect().center().y()), name)


class PathLayer:
    """A layer with a path of one robot, in dashes or dots.

    Args:
        robot: drawn in this robot's colour.
        style: of the line.
    """

    z = Z_FLAT
    _points = NO_POINTS

    def __init__(self, robot: int, style: Qt.PenStyle) -> None:
        self._robot = robot
        self._style = style

    def show(self, points: FloatArray) -> None:
        """Show a path of (n, 2) points; a row of NaN stands between two pieces."""
        self._points = points

    def paint(self, painter: QPainter, view: MapView) -> None:
        """Draw a line through the points of each piece."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(QColor(view.colours.robot(self._robot)), 1.2, self._style))
        for piece in pieces(self._points):
            painter.drawPolyline(QPolygonF(polygon(view.camera.to_screen(piece))))


class ParticleLayer:
    """A layer of the selected robot's particles, above its body, which is often wider than they are spread."""

    z = Z_ABOVE
    _points = NO_POINTS

    def show(self, points: FloatArray) -> None:
        """Show (n, 2) particles."""
        self._points = points

    def paint(self, painter: QPainter, view: MapView) -> None:
        """Draw dots that are seen on every body."""
        colour = QColor(view.colours.text)
        colour.setAlphaF(0.6)
        painter.setPen(QPen(colour, 2.0, Qt.PenStyle.SolidLine, Qt.PenCapStyle.SquareCap))
        painter.drawPoints(polygon(view.camera.to_screen(self._points)))


class _RobotLayers:
    """The layers of one robot."""

    def __init__(self, robot: int, view: MapView) -> None:
        self.cloud = PointLayer(robot, Z_FLOOR, 2.0, 0.7)
        self.scan = PointLayer(robot, Z_FLAT, 3.0)
        self.plan = LineLayer(robot, Z_FLAT, 3.0)
        self.true_path = PathLayer(robot, Qt.PenStyle.DotLine)
        self.odometry = PathLayer(robot, Qt.PenStyle.DashDotLine)
        self.goal = PoseLayer(robot, Z_ABOVE, 3.0)
        self.footprint = LineLayer(robot, Z_ABOVE, 1.5)
        for layer in (self.cloud, self.scan, self.plan, self.true_path, self.odometry, self.goal, self.footprint):
            view.add_layer(layer)

    def show(self, robot: RobotScene, selected: bool, on: DisplaysPanel) -> None:
        self.cloud.show(NO_POINTS if selected else robot.cloud[:, :2])
        self.scan.show(robot.scan)
        self.plan.show((robot.local_plan,) if on.shows(MapDisplay.LOCAL_PLANS) else ())
        self.true_path.show(robot.truth_path if on.shows(MapDisplay.TRUE_PATHS) else NO_POINTS)
        self.odometry.show(robot.odometry_path if on.shows(MapDisplay.ODOMETRY) else NO_POINTS)
        goal = robot.goal if on.shows(MapDisplay.GOALS) else None
        self.goal.show(np.empty((0, 3)) if goal is None else goal.array()[np.newaxis])
        closed = np.concatenate((robot.footprint, robot.footprint[:1]))
        self.footprint.show((closed,) if on.shows(MapDisplay.FOOTPRINTS) else ())


class Overlays:
    """The layers of a map, kept up to date with the scene.

    Args:
        view: the map.
    """

    def __init__(self, view: MapView) -> None:
        self._view = view
        self._robots: dict[int, _RobotLayers] = {}
        self._costs = (CostmapImageLayer(Z_COSTS), CostmapImageLayer(Z_COSTS + 1))
        self._shown: list[object] = [None, None]
        self._things = ThingLayer()
        self._cloud = ParticleLayer()
        for layer in (*self._costs, self._things, self._cloud):
            view.add_layer(layer)

    def show(self, scene: Scene, selected: int, on: DisplaysPanel) -> None:
        """Show a scene; the map is repainted when its robots are shown next."""
        self._things.show(tuple((t.name, t.outline) for t in scene.things) if on.shows(MapDisplay.THINGS) else ())
        for robot in scene.robots:
            if robot.robot not in self._robots:
                self._robots[robot.robot] = _RobotLayers(robot.robot, self._view)
            self._robots[robot.robot].show(robot, robot.robot == selected, on)
        chosen = next((robot for robot in scene.robots if robot.robot == selected), None)
        self._cloud.show(NO_POINTS if chosen is None else chosen.cloud[:, :2])
        maps = (None, None) if chosen is None else (chosen.global_costmap, chosen.local_costmap)
        for place, (layer, costmap) in enumerate(zip(self._costs, maps, strict=True)):
            if costmap is self._shown[place]:
                continue
            self._shown[place] = costmap
            if costmap is None:
                layer.clear()
            else:
                layer.show(costmap.cells, costmap.origin, costmap.resolution)
