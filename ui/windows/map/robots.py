"""Robots on the map: footprints with a nose, trails, planned paths, ellipses of uncertainty, and labels."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from PySide6.QtCore import QPointF, QRect, QRectF, QSizeF, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF, QRegion, QTransform

from sim.common.geometry import Pose2
from sim.numerics.float_array import FloatArray
from sim.robot.costmap.footprint import radii
from thbridge.roles.shared.notices import Ellipse
from ui.model.shared.scene import RobotMark
from ui.windows.map.badges import Anchor, Badge, Badges, BadgeText, place_labels
from ui.windows.map.box import MapBox
from ui.windows.map.ground import Ground
from ui.windows.map.item import Z_ROBOTS, MapItem
from ui.windows.map.points import draw_lines, mapped, pixel, polygon, steps

MIN_RADIUS = 8.0
"""Smallest radius of a drawn robot, pixels, at any scale."""

RING = 5.0
"""Distance between the selected robot and its ring, pixels."""

TRAIL_STEPS = 4
"""Number of steps in which a trail fades."""

TRAIL_ALPHA = 0.5
"""Opacity of a trail at its newest end."""

LABEL_MARGIN = 40.0
"""Distance from the view, pixels. Robots that are farther from the view have no label in the view."""

JUMP = 1.0
"""Maximum distance that a robot drives between two frames, meters. If it moves farther, it has jumped."""

FLAG = 20.0
"""Margin around a path with space for the flag at its end, pixels."""

DASH, SPACE = 7.0, 5.0
"""Lengths of a dash and of the gap after it along a path, pixels."""


_ROUND = np.linspace(0.0, 2.0 * np.pi, 49)[:-1]
_CIRCLE = polygon(np.stack((np.cos(_ROUND), np.sin(_ROUND)), axis=1))
"""Circle of radius 1."""

_NOSE = np.array([[0.72, 0.0], [0.12, 0.42], [0.26, 0.0], [0.12, -0.42]])
"""Arrowhead that shows the forward direction of a robot, in units of the body's reach."""


@dataclass(frozen=True, slots=True, eq=False)
class _Body:
    """Footprint as it is drawn, in the robot's own frame, meters.

    Attributes:
        outline: corners of the footprint.
        nose: arrowhead that shows the front.
        reach: distance from the middle to the farthest corner.
        inside: distance from the middle to the nearest edge.
    """

    outline: QPolygonF
    nose: QPolygonF
    reach: float
    inside: float

    @classmethod
    def of(cls, footprint: FloatArray) -> "_Body":
        inside, reach = radii(footprint)
        return cls(polygon(footprint), polygon(_NOSE * reach), reach, inside)

    def scale(self, to_pixels: QTransform) -> float:
        """Return the drawing scale, pixels per meter. A robot is never drawn too small to be seen."""
        return max(to_pixels.m11(), MIN_RADIUS / self.reach)

    def transform(self, to_pixels: QTransform, pose: Pose2) -> QTransform:
        """Return the transform from the robot's own frame to pixels."""
        scale = self.scale(to_pixels)
        c, s = scale * math.cos(pose.theta), scale * math.sin(pose.theta)
        at = pixel(to_pixels, pose.x, pose.y)
        return QTransform(c, -s, -s, -c, at.x(), at.y())


@dataclass(frozen=True, slots=True, eq=False)
class _Place:
    """Place of a robot on the screen. All boxes are in logical pixels of the map's box.

    Attributes:
        mark: the robot.
        near: box around the body, ring, ellipse, true pose, and last line of the trail.
        trail: box around the trail.
        path: box around the path and the flag at its end.
        badge: label; None while the robot is outside the view.
        corner: upper left corner of the label.
    """

    mark: RobotMark
    near: QRect
    trail: QRect
    path: QRect
    badge: Badge | None = None
    corner: QPointF = field(default_factory=QPointF)

    @property
    def label(self) -> QRect:
        """Box around the label."""
        if self.badge is None:
            return QRect()
        return QRectF(self.corner, QSizeF(self.badge.width, self.badge.height)).adjusted(-1, -1, 1, 1).toAlignedRect()


class Robots(MapItem):
    """Item that draws all robots. Marks on the floor are drawn first, and labels last.

    While robots stand still, nothing is painted: `show_robots` repaints only the parts that changed.

    Args:
        box: view of the map.
        ground: ground of the map; labels must not cover its words.
    """

    def __init__(self, box: MapBox, ground: Ground) -> None:
        super().__init__(box, Z_ROBOTS)
        self.marks: tuple[RobotMark, ...] = ()
        self._ground = ground
        self._badges = Badges()
        self._places: dict[int, int] = {}
        self._bodies: dict[bytes, _Body] = {}
        self._trails: dict[int, tuple[FloatArray, FloatArray]] = {}
        self._pens: dict[str, list[QPen]] = {}
        self._laid: dict[int, _Place] = {}
        # View and ground for which the places were computed.
        self._laid_in: tuple[QTransform, float, object] | None = None

    def show_robots(self, robots: Sequence[RobotMark]) -> None:
        """Show the current robots. After a jump of a robot, labels are placed as if they were new."""
        before = {mark.robot: mark.pose for mark in self.marks}
        if any(mark.pose.distance(before.get(mark.robot, mark.pose)) > JUMP for mark in robots):
            self._places.clear()
        self.marks = tuple(robots)
        view = self.box.to_pixels(), self.box.getViewWidget().devicePixelRatioF(), self._ground.picture
        if self._laid_in != view or before.keys() != {mark.robot for mark in robots}:
            self._laid_in = None
            self.update()
            return
        laid = self._laid
        self._lay_out(*view)
        changed = QRegion()
        for robot, place in self._laid.items():
            for part in _changed(view[0], laid[robot], place):
                changed += part
        self.box.repaint_part(changed)

    def invalidate(self) -> None:
        """Draw the labels again, for example after a change of the font or the colors."""
        self._badges.clear()
        self._laid_in = None
        self.update()

    def draw(self, painter: QPainter, to_pixels: QTransform) -> None:
        """Draw all robots that have a part that needs painting."""
        # An exported file may have more pixels than the screen.
        ratio = self.box.getViewWidget().devicePixelRatioF() * painter.worldTransform().m11()
        if self._laid_in != (to_pixels, ratio, self._ground.picture):
            self._laid.clear()
            self._lay_out(to_pixels, ratio, self._ground.picture)
        exposed = self.box.exposed or QRegion(self.box.rect().toAlignedRect())
        order = sorted(self._laid.values(), key=lambda place: (place.mark.selected, -place.mark.robot))
        near = [place.mark for place in order if exposed.intersects(place.near)]
        for place in order:
            if exposed.intersects(place.trail):
                self._paint_trail(painter, to_pixels, place.mark)
        for place in order:
            if exposed.intersects(place.path):
                self._paint_path(painter, to_pixels, place.mark)
        for mark in near:
            self._paint_belief(painter, to_pixels, mark)
        for mark in near:
            self._paint_body(painter, to_pixels, mark)
        for place in order[::-1]:
            if place.badge is not None and exposed.intersects(place.label):
                painter.drawPixmap(place.corner, place.badge.picture)

    def _lay_out(self, to_pixels: QTransform, ratio: float, picture: object) -> None:
        """Compute the places of all robots in a view; keep the places of robots that have not moved."""
        before, self._laid = self._laid, {}
        for mark in self.marks:
            place = before.get(mark.robot)
            self._laid[mark.robot] = (
                place if place is not None and place.mark is mark else self._placed(to_pixels, mark)
            )
        self._laid_in = to_pixels, ratio, picture
        around = self.box.rect().adjusted(-LABEL_MARGIN, -LABEL_MARGIN, LABEL_MARGIN, LABEL_MARGIN)
        order = sorted(self.marks, key=lambda mark: (mark.selected, -mark.robot), reverse=True)
        seen = [mark for mark in order if around.contains(pixel(to_pixels, mark.pose.x, mark.pose.y))]
        if not seen:
            return
        palette, font = self.box.colors, self.box.letters
        badges = [self._badges.of(self._badge_text(mark), palette, font, ratio) for mark in seen]
        anchors = [self._anchor(to_pixels, mark, badge) for mark, badge in zip(seen, badges, strict=True)]
        had = [self._places.get(mark.robot, -1) for mark in seen]
        corners, places = place_labels(anchors, had, self._ground.words(to_pixels))
        self._places = {mark.robot: place for mark, place in zip(seen, places, strict=True)}
        for mark, badge, (x, y) in zip(seen, badges, corners.tolist(), strict=True):
            corner = QPointF(round(x * ratio) / ratio, round(y * ratio) / ratio)
            place = self._laid[mark.robot]
            if (place.badge, place.corner) != (badge, corner):
                self._laid[mark.robot] = replace(place, badge=badge, corner=corner)

    def _placed(self, to_pixels: QTransform, mark: RobotMark) -> _Place:
        body = self._body(mark.footprint)
        radius = body.reach * body.scale(to_pixels) + RING + 3.0
        if mark.ellipse is not None:
            radius = max(radius, mark.ellipse.major * to_pixels.m11() + 2.0)
        points = [(mark.pose.x, mark.pose.y), *mark.trail[-1:].tolist()]
        if mark.truth is not None:
            points.append((mark.truth.x, mark.truth.y))
        near = _around(to_pixels, np.array(points), radius)
        trail = _around(to_pixels, mark.trail, 3.0).united(near) if len(mark.trail) else QRect()
        path = _around(to_pixels, mark.path, FLAG) if len(mark.path) > 1 else QRect()
        return _Place(mark, near, trail, path)

    def _badge_text(self, mark: RobotMark) -> BadgeText:
        return BadgeText(mark.label, self._colour(mark), mark.selected, mark.trouble, mark.commander)

    def _body(self, footprint: FloatArray) -> _Body:
        key = footprint.tobytes()
        body = self._bodies.get(key)
        if body is None:
            body = self._bodies[key] = _Body.of(footprint)
        return body

    def _colour(self, mark: RobotMark) -> str:
        return self.box.colors.robot(mark.robot)

    def _paint_trail(self, painter: QPainter, to_pixels: QTransform, mark: RobotMark) -> None:
        if not len(mark.trail):
            return
        known, lines = self._trails.get(mark.robot, (None, None))
        if lines is None or known is not mark.trail:
            # The last line of the trail leads to the robot, and changes in each frame.
            lines = steps(np.concatenate((mark.trail, mark.trail[-1:])))
            self._trails[mark.robot] = mark.trail, lines
        lines[-1, 2:] = mark.pose.x, mark.pose.y
        pixels = mapped(to_pixels, lines.reshape(-1, 2)).reshape(-1, 4)
        colour = self._colour(mark)
        pens = self._pens.get(colour) or self._pens.setdefault(colour, _fading(colour))
        for step, pen in enumerate(pens):
            painter.setPen(pen)
            draw_lines(painter, pixels[len(lines) * step // TRAIL_STEPS : len(lines) * (step + 1) // TRAIL_STEPS])

    def _paint_path(self, painter: QPainter, to_pixels: QTransform, mark: RobotMark) -> None:
        if len(mark.path) < 2:
            return
        pixels = mapped(to_pixels, mark.path)
        colour = QColor(self._colour(mark))
        pen = QPen(colour, 2.5 if mark.selected else 1.8)
        pen.setCapStyle(Qt.PenCapStyle.FlatCap)
        painter.setPen(pen)
        draw_lines(painter, _dashes(pixels))
        x, y = pixels[-1].tolist()
        painter.setPen(QPen(colour, 2.0))
        painter.drawLine(QPointF(x, y), QPointF(x, y - 17.0))
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(colour)
        painter.drawPolygon(QPolygonF([QPointF(x, y - 18.0), QPointF(x + 12.0, y - 13.5), QPointF(x, y - 9.0)]))

    def _paint_belief(self, painter: QPainter, to_pixels: QTransform, mark: RobotMark) -> None:
        if mark.ellipse is not None:
            self._paint_ellipse(painter, to_pixels, mark, mark.ellipse)
        if mark.truth is not None:
            self._paint_truth(painter, to_pixels, mark, mark.truth)

    def _paint_ellipse(self, painter: QPainter, to_pixels: QTransform, mark: RobotMark, ellipse: Ellipse) -> None:
        body = self._body(mark.footprint)
        if ellipse.major * to_pixels.m11() < body.inside * body.scale(to_pixels):
            return  # The body covers the whole ellipse.
        c, s = to_pixels.m11() * math.cos(ellipse.angle), to_pixels.m11() * math.sin(ellipse.angle)
        centre = pixel(to_pixels, mark.pose.x, mark.pose.y)
        transform = QTransform(
            c * ellipse.major, -s * ellipse.major, -s * ellipse.minor, -c * ellipse.minor, centre.x(), centre.y()
        )
        outline = transform.map(_CIRCLE)
        colour = QColor(self._colour(mark))
        colour.setAlpha(40)
        # A fill without smooth edges under a smooth outline looks the same and takes a quarter of the time.
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(colour)
        painter.drawPolygon(outline)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(QColor(self._colour(mark)), 1.0))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawPolygon(outline)

    def _paint_truth(self, painter: QPainter, to_pixels: QTransform, mark: RobotMark, truth: Pose2) -> None:
        pen = QPen(QColor(self.box.colors.text), 1.5)
        pen.setDashPattern([2.0, 2.0])
        painter.setPen(pen)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        body = self._body(mark.footprint)
        painter.drawPolygon(body.transform(to_pixels, truth).map(body.outline))
        painter.drawLine(pixel(to_pixels, truth.x, truth.y), pixel(to_pixels, mark.pose.x, mark.pose.y))

    def _paint_body(self, painter: QPainter, to_pixels: QTransform, mark: RobotMark) -> None:
        centre = pixel(to_pixels, mark.pose.x, mark.pose.y)
        body = self._body(mark.footprint)
        radius = body.reach * body.scale(to_pixels)
        if mark.selected:
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.setPen(QPen(QColor(self.box.colors.panel), 5.0))
            painter.drawEllipse(centre, radius + RING, radius + RING)
            painter.setPen(QPen(QColor(self.box.colors.accent), 2.5))
            painter.drawEllipse(centre, radius + RING, radius + RING)
        pen = QPen(QColor(self.box.colors.panel), 1.5)
        pen.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
        painter.setPen(pen)
        painter.setBrush(QColor(self._colour(mark)))
        transform = body.transform(to_pixels, mark.pose)
        painter.drawPolygon(transform.map(body.outline))
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(self.box.colors.panel))
        painter.drawPolygon(transform.map(body.nose))

    def _anchor(self, to_pixels: QTransform, mark: RobotMark, badge: Badge) -> Anchor:
        body = self._body(mark.footprint)
        ring = RING + 1.0 if mark.selected else 0.0
        radius = body.reach * body.scale(to_pixels) + ring
        at = pixel(to_pixels, mark.pose.x, mark.pose.y)
        return Anchor(at.x(), at.y(), radius, badge.width, badge.height)


def _around(to_pixels: QTransform, points: FloatArray, margin: float) -> QRect:
    """Return the box around (n, 2) map points, with a margin in pixels."""
    pixels = mapped(to_pixels, points)
    (left, top), (right, bottom) = pixels.min(axis=0).tolist(), pixels.max(axis=0).tolist()
    return QRectF(left, top, right - left, bottom - top).adjusted(-margin, -margin, margin, margin).toAlignedRect()


def _changed(to_pixels: QTransform, before: _Place, now: _Place) -> Iterator[QRect]:
    """Yield boxes around all differences between two places of a robot."""
    if before is now:
        return
    if before.label != now.label or before.badge is not now.badge:
        yield before.label
        yield now.label
    old, new = before.mark, now.mark
    if old is new:
        return
    yield before.near
    yield now.near
    if old.selected != new.selected:  # The robot is now drawn in front of the others, or behind them.
        yield from (before.trail, now.trail, before.path, now.path)
        return
    if old.trail is not new.trail:
        yield from (before.trail, now.trail)
    rest = len(new.path) - 1
    if 0 < rest < len(old.path) and np.array_equal(old.path[-rest:], new.path[1:]):
        # Dashes are counted from the far end. Therefore only the near end changes, and the dash at the first
        # point that is kept.
        used = np.concatenate((old.path[: len(old.path) - rest + 1], new.path[:1]))
        yield _around(to_pixels, used, DASH + 3.0)
    else:
        yield from (before.path, now.path)


def _fading(colour: str) -> list[QPen]:
    """Return the pens of a trail, beginning with the pen of its oldest part."""
    pens = []
    for step in range(TRAIL_STEPS):
        faded = QColor(colour)
        faded.setAlphaF(TRAIL_ALPHA * (step + 1) / TRAIL_STEPS)
        pens.append(QPen(faded, 2.5, c=Qt.PenCapStyle.FlatCap))
    return pens


def _dashes(pixels: FloatArray) -> FloatArray:
    """Return (n, 4) dashes along a line.

    Dashes are counted from the far end, so that they do not move while the robot drives along the path. Single lines
    are painted five times faster than Qt's dashed polylines.
    """
    line = np.ascontiguousarray(pixels[::-1]).view(np.complex128)[:, 0]
    along = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(line)))))
    starts = np.arange(0.0, along[-1], DASH + SPACE)
    ends = np.minimum(starts + DASH, along[-1])
    dashes = np.stack((np.interp(starts, along, line), np.interp(ends, along, line)), axis=1)
    return dashes.view(np.float64)
