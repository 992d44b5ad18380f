"""Robots on the map: footprints with a nose, trails, planned paths, ellipses of uncertainty, and labels."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QLineF, QPointF, Qt
from PySide6.QtGui import QColor, QFont, QPainter, QPen, QPolygonF, QTransform

from sim.common.geometry import Pose2
from sim.numerics.float_array import FloatArray
from thbridge.roles.notices import Ellipse
from ui.model.scene import RobotMark
from ui.model.theme import Palette
from ui.windows.map.badges import Anchor, Badge, Badges, BadgeText, place_labels
from ui.windows.map.camera import Camera
from ui.windows.map.points import lines, pieces, polygon

MIN_RADIUS = 8.0
"""Least radius with which a robot is drawn, pixels, however small the scale is."""

RING = 5.0
"""Pixels between the selected robot and its ring."""

TRAIL_STEPS = 4
"""Steps in which a trail fades."""

TRAIL_ALPHA = 0.5
"""Opacity of a trail at its newest end."""

LABEL_MARGIN = 40.0
"""Pixels outside the view at which a robot may still show its label in it."""

DASH, SPACE = 7.0, 5.0
"""Lengths of a dash and of the gap after it along a path, pixels."""


_ROUND = np.linspace(0.0, 2.0 * np.pi, 49)[:-1]
_CIRCLE = polygon(np.stack((np.cos(_ROUND), np.sin(_ROUND)), axis=1))
"""A circle of radius 1."""

_NOSE = np.array([[0.72, 0.0], [0.12, 0.42], [0.26, 0.0], [0.12, -0.42]])
"""An arrowhead on a robot that points ahead, in units of the body's reach."""


@dataclass(frozen=True, slots=True, eq=False)
class _Body:
    """A footprint as it is drawn, in the robot's own frame, metres.

    Attributes:
        outline: its corners.
        nose: the arrowhead that shows its front.
        reach: from its middle to its farthest corner.
    """

    outline: QPolygonF
    nose: QPolygonF
    reach: float

    @classmethod
    def of(cls, footprint: FloatArray) -> "_Body":
        reach = float(np.max(np.hypot(footprint[:, 0], footprint[:, 1]), initial=0.05))
        return cls(polygon(footprint), polygon(_NOSE * reach), reach)

    def scale(self, camera: Camera) -> float:
        """Scale at which it is drawn, pixels a metre: never too small to be seen."""
        return max(camera.scale, MIN_RADIUS / self.reach)

    def transform(self, camera: Camera, pose: Pose2) -> QTransform:
        """Transform from its own frame to pixels."""
        scale = self.scale(camera)
        c, s = scale * math.cos(pose.theta), scale * math.sin(pose.theta)
        return QTransform(c, -s, -s, -c, *camera.pixel(pose.x, pose.y))


@dataclass(frozen=True, slots=True, eq=False)
class _Trail:
    """A trail as it was drawn last: its points, the camera, and the lines made of both."""

    points: FloatArray
    camera: Camera
    lines: list[QLineF]


class RobotPainter:
    """Paints robots; keeps from frame to frame what stays the same."""

    def __init__(self, palette: Palette) -> None:
        self._palette = palette
        self._badges = Badges()
        self._places: dict[int, int] = {}
        self._bodies: dict[bytes, _Body] = {}
        self._trails: dict[int, _Trail] = {}

    def set_palette(self, palette: Palette) -> None:
        """Use other colours."""
        self._palette = palette
        self._badges.clear()

    def invalidate(self) -> None:
        """Make the labels anew, for example with another font."""
        self._badges.clear()

    def paint(
        self,
        painter: QPainter,
        camera: Camera,
        robots: Sequence[RobotMark],
        words: FloatArray,
        font: QFont,
        ratio: float,
    ) -> None:
        """Paint all robots: what lies flat on the floor first, labels last and off these (m, 4) boxes of words."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        order = sorted(robots, key=lambda mark: (mark.selected, -mark.robot))
        for mark in order:
            self._paint_trail(painter, camera, mark)
        for mark in order:
            self._paint_path(painter, camera, mark)
        for mark in order:
            self._paint_belief(painter, camera, mark)
        for mark in order:
            self._paint_body(painter, camera, mark)
        seen = [mark for mark in order[::-1] if camera.sees(mark.pose.x, mark.pose.y, LABEL_MARGIN)]
        if not seen:
            return
        badges = [self._badges.of(self._badge_text(mark), self._palette, font, ratio) for mark in seen]
        anchors = [self._anchor(camera, mark, badge) for mark, badge in zip(seen, badges, strict=True)]
        corners, places = place_labels(anchors, [self._places.get(mark.robot, -1) for mark in seen], words)
        self._places = {mark.robot: place for mark, place in zip(seen, places, strict=True)}
        for badge, (x, y) in zip(badges, corners.tolist(), strict=True):
            painter.drawPixmap(QPointF(round(x * ratio) / ratio, round(y * ratio) / ratio), badge.picture)

    def _badge_text(self, mark: RobotMark) -> BadgeText:
        return BadgeText(mark.label, self._colour(mark), mark.selected, mark.trouble, mark.commander)

    def _body(self, footprint: FloatArray) -> _Body:
        key = footprint.tobytes()
        body = self._bodies.get(key)
        if body is None:
            body = self._bodies[key] = _Body.of(footprint)
        return body

    def _colour(self, mark: RobotMark) -> str:
        return self._palette.robot(mark.robot)

    def _paint_trail(self, painter: QPainter, camera: Camera, mark: RobotMark) -> None:
        if not len(mark.trail):
            return
        pieces = [
            *self._trail_lines(camera, mark),
            QLineF(*camera.pixel(*mark.trail[-1].tolist()), *camera.pixel(mark.pose.x, mark.pose.y)),
        ]
        colour = QColor(self._colour(mark))
        for step in range(TRAIL_STEPS):
            colour.setAlphaF(TRAIL_ALPHA * (step + 1) / TRAIL_STEPS)
            pen = QPen(colour, 2.5)
            pen.setCapStyle(Qt.PenCapStyle.FlatCap)
            painter.setPen(pen)
            painter.drawLines(pieces[len(pieces) * step // TRAIL_STEPS : len(pieces) * (step + 1) // TRAIL_STEPS])

    def _trail_lines(self, camera: Camera, mark: RobotMark) -> list[QLineF]:
        kept = self._trails.get(mark.robot)
        if kept is None or kept.points is not mark.trail or kept.camera != camera:
            parts = [camera.to_screen(part) for part in pieces(mark.trail)]
            drawn = [line for pixels in parts for line in lines(pixels[:-1], pixels[1:])]
            kept = self._trails[mark.robot] = _Trail(mark.trail, camera, drawn)
        return kept.lines

    def _paint_path(self, painter: QPainter, camera: Camera, mark: RobotMark) -> None:
        if len(mark.path) < 2:
            return
        pixels = camera.to_screen(mark.path)
        colour = QColor(self._colour(mark))
        pen = QPen(colour, 2.5 if mark.selected else 1.8)
        pen.setCapStyle(Qt.PenCapStyle.FlatCap)
        painter.setPen(pen)
        painter.drawLines(lines(*_dashes(pixels)))
        x, y = pixels[-1].tolist()
        painter.setPen(QPen(colour, 2.0))
        painter.drawLine(QPointF(x, y), QPointF(x, y - 17.0))
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(colour)
        painter.drawPolygon(QPolygonF([QPointF(x, y - 18.0), QPointF(x + 12.0, y - 13.5), QPointF(x, y - 9.0)]))

    def _paint_belief(self, painter: QPainter, camera: Camera, mark: RobotMark) -> None:
        if mark.ellipse is not None:
            self._paint_ellipse(painter, camera, mark, mark.ellipse)
        if mark.truth is not None:
            self._paint_truth(painter, camera, mark, mark.truth)

    def _paint_ellipse(self, painter: QPainter, camera: Camera, mark: RobotMark, ellipse: Ellipse) -> None:
        c, s = camera.scale * math.cos(ellipse.angle), camera.scale * math.sin(ellipse.angle)
        centre = camera.pixel(mark.pose.x, mark.pose.y)
        transform = QTransform(c * ellipse.major, -s * ellipse.major, -s * ellipse.minor, -c * ellipse.minor, *centre)
        outline = transform.map(_CIRCLE)
        colour = QColor(self._colour(mark))
        colour.setAlpha(40)
        # A filling without smooth edges under a smooth outline looks the same and takes a quarter of the time.
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(colour)
        painter.drawPolygon(outline)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(QColor(self._colour(mark)), 1.0))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawPolygon(outline)

    def _paint_truth(self, painter: QPainter, camera: Camera, mark: RobotMark, truth: Pose2) -> None:
        pen = QPen(QColor(self._palette.text), 1.5)
        pen.setDashPattern([2.0, 2.0])
        painter.setPen(pen)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        body = self._body(mark.footprint)
        painter.drawPolygon(body.transform(camera, truth).map(body.outline))
        painter.drawLine(QPointF(*camera.pixel(truth.x, truth.y)), QPointF(*camera.pixel(mark.pose.x, mark.pose.y)))

    def _paint_body(self, painter: QPainter, camera: Camera, mark: RobotMark) -> None:
        centre = QPointF(*camera.pixel(mark.pose.x, mark.pose.y))
        body = self._body(mark.footprint)
        radius = body.reach * body.scale(camera)
        if mark.selected:
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.setPen(QPen(QColor(self._palette.panel), 5.0))
            painter.drawEllipse(centre, radius + RING, radius + RING)
            painter.setPen(QPen(QColor(self._palette.accent), 2.5))
            painter.drawEllipse(centre, radius + RING, radius + RING)
        pen = QPen(QColor(self._palette.panel), 1.5)
        pen.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
        painter.setPen(pen)
        painter.setBrush(QColor(self._colour(mark)))
        transform = body.transform(camera, mark.pose)
        painter.drawPolygon(transform.map(body.outline))
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(self._palette.panel))
        painter.drawPolygon(transform.map(body.nose))

    def _anchor(self, camera: Camera, mark: RobotMark, badge: Badge) -> Anchor:
        body = self._body(mark.footprint)
        ring = RING + 1.0 if mark.selected else 0.0
        radius = body.reach * body.scale(camera) + ring
        return Anchor(*camera.pixel(mark.pose.x, mark.pose.y), radius, badge.width, badge.height)


def _dashes(pixels: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return both ends of each dash along a line.

    Dashes are counted from the far end, so that they lie still while the near end is used up. Single lines are painted
    five times faster than Qt's dashed polylines.
    """
    steps = np.diff(pixels[::-1], axis=0)
    along = np.concatenate(([0.0], np.cumsum(np.hypot(steps[:, 0], steps[:, 1]))))
    starts = np.arange(0.0, along[-1], DASH + SPACE)
    ends = np.minimum(starts + DASH, along[-1])
    xs, ys = pixels[::-1, 0], pixels[::-1, 1]
    first = np.stack((np.interp(starts, along, xs), np.interp(starts, along, ys)), axis=1)
    return first, np.stack((np.interp(ends, along, xs), np.interp(ends, along, ys)), axis=1)
