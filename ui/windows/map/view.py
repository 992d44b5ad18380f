"""The map of both windows: floor plan, rooms and robots seen from above, with zoom, drag and clicks."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np
from PySide6.QtCore import QEvent, QPointF, QRect, QSize, Qt, QTimer, Signal
from PySide6.QtGui import (
    QMouseEvent,
    QNativeGestureEvent,
    QPainter,
    QPaintEvent,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QSizePolicy, QWidget

from thbridge.roles.notices import FloorPlan
from ui.model.scene import RobotMark, RoomMark
from ui.model.theme import Palette
from ui.windows import pointer
from ui.windows.map.background import MapBackground
from ui.windows.map.camera import Camera
from ui.windows.map.changes import same_robots, same_rooms
from ui.windows.map.geometry import MapGeometry, contains, unpack
from ui.windows.map.lettering import fitting_font
from ui.windows.map.robots import RobotPainter
from ui.windows.map.scale_bar import paint_scale_bar
from ui.windows.map.words import describe

FIT_MARGIN = 30.0
"""Pixels around the floor plan when all of it is shown."""

HIT_RADIUS = 24.0
"""Pixels from its middle within which a robot is hit."""

DRAG_THRESHOLD = 4.0
"""Pixels by which a press has to move to be a drag and no click."""

FOLLOW_SCALE = 60.0
"""Least scale at which following a robot begins, pixels a metre."""

FOLLOW_SHARE = 0.15
"""Share of the distance to the followed robot that the view moves in one frame."""

FOLLOW_TOLERANCE = 1.0
"""Pixels from the middle within which the followed robot counts as in the middle."""

DESCRIPTION_PERIOD = 1000
"""Milliseconds between two updates of the description in words."""

WHEEL_FACTOR = 1.0015
"""Zoom factor of an eighth of a degree of the wheel."""


class MapLayer(Protocol):
    """Something drawn on the map beside floor plan, rooms and robots."""

    @property
    def z(self) -> int:
        """Order of painting: below the robots when negative, above them otherwise; the larger the later."""

    def paint(self, painter: QPainter, view: "MapView") -> None:
        """Draw in logical pixels, see `view.camera`. The painter is restored afterwards."""


class MapView(QWidget):
    """A map that can be zoomed and dragged, and can follow a robot; it reports clicks and hovering by signals.

    Attributes:
        camera: the current view, in logical pixels of this widget.
        colours: the palette it is drawn in.
        followed: index of the robot that is kept in the middle, or None.
        hovered: number of the room that the pointer was moved onto, or None.

    Signals:
        room_clicked: number of the room, counted from 1.
        robot_clicked: index of the robot.
        room_hovered: `hovered`, when it is another.
        point_pressed, point_dragged, point_released: x, y in map metres, while a tool has the left button.
    """

    room_clicked = Signal(int)
    robot_clicked = Signal(int)
    room_hovered = Signal(object)
    point_pressed = Signal(float, float)
    point_dragged = Signal(float, float)
    point_released = Signal(float, float)

    def __init__(self, palette: Palette, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.colours = palette
        self._background = MapBackground(palette)
        self._robot_painter = RobotPainter(palette)
        self._geometry: MapGeometry | None = None
        self._rooms: tuple[RoomMark, ...] = ()
        self._robots: tuple[RobotMark, ...] = ()
        self._layers: list[MapLayer] = []
        self.camera = Camera(0.0, 0.0, 50.0, 1.0, 1.0)
        self._fitted = True
        self._free: QRect | None = None
        self.followed: int | None = None
        self._tool: Qt.CursorShape | None = None
        self.hovered: int | None = None
        self._pressed: QPointF | None = None
        self._last = QPointF()
        self._dragging = False
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self.setMouseTracking(True)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setAccessibleName("Map")
        self._describing = QTimer(self)
        self._describing.timeout.connect(self._describe)
        self._describing.start(DESCRIPTION_PERIOD)

    # Contents ---------------------------------------------------------------------------------------------------------

    def show_floor_plan(self, floor_plan: FloorPlan) -> None:
        """Show another floor plan, all of it."""
        self._geometry = unpack(floor_plan)
        self._background.show_geometry(self._geometry)
        self.fit()

    def show_rooms(self, rooms: Sequence[RoomMark]) -> None:
        """Show the rooms as they are now; does nothing when they look as before."""
        if not same_rooms(self._rooms, rooms):
            self._rooms = tuple(rooms)
            self._background.show_rooms(self._rooms)
            self.update()

    def show_robots(self, robots: Sequence[RobotMark]) -> None:
        """Show the robots as they are in this frame; nothing is painted when nobody would see a difference."""
        before = self.camera
        if not same_robots(self._robots, robots, self.camera.scale):
            self._robots = tuple(robots)
            self.update()
        self._follow()
        if self._layers or self.camera != before:
            self.update()

    def set_palette(self, palette: Palette) -> None:
        """Use other colours."""
        self.colours = palette
        self._background.set_palette(palette)
        self._robot_painter.set_palette(palette)
        self.update()

    def add_layer(self, layer: MapLayer) -> None:
        """Draw this layer from now on, whenever robots are shown or `update` is called."""
        self._layers.append(layer)
        self._layers.sort(key=lambda one: one.z)
        self.update()

    # Camera -----------------------------------------------------------------------------------------------------------

    def fit(self) -> None:
        """Show the whole floor plan, also after changes of size; no robot is followed any more."""
        self.followed, self._fitted = None, True
        self._refit()
        self.update()

    @property
    def fitted(self) -> bool:
        """True while the whole floor plan is shown, since nobody has moved it."""
        return self._fitted

    def scale_within(self, free: QRect) -> float:
        """Return the scale of the whole floor plan in a part of the view, pixels a metre."""
        return self._fit(free).scale

    def keep_within(self, free: QRect | None) -> None:
        """Show the whole floor plan in a part of the view, while nobody has moved it; None: in all of it."""
        if free != self._free:
            self._free = free
            if self._fitted:
                self._refit()
                self.update()

    def follow(self, robot: int | None) -> None:
        """Keep this robot in the middle; None: stop following."""
        if robot is None:
            self.followed = None
            return
        self.followed, self._fitted = robot, False
        if self.camera.scale < FOLLOW_SCALE:
            middle = self.camera.width / 2.0, self.camera.height / 2.0
            self.camera = self.camera.zoomed(FOLLOW_SCALE / self.camera.scale, *middle)
        self._follow()
        self.update()

    def set_tool(self, cursor: Qt.CursorShape | None) -> None:
        """Give the left button to a tool, which receives `point_pressed` and its like; None takes it back.

        While a tool has it, the map is dragged by the middle button, and clicks choose nothing.
        """
        self._tool = cursor
        self._point_at(self._last)

    def room_at(self, position: QPointF) -> int | None:
        """Return the room under a pixel of this widget."""
        here = np.array([self.camera.point(position.x(), position.y())])
        return next((mark.room for mark in self._rooms if contains(mark.region, here)[0]), None)

    def robot_at(self, position: QPointF) -> int | None:
        """Return the robot nearest to a pixel of this widget, if one is near."""
        reached = [
            (QPointF(*self.camera.pixel(mark.pose.x, mark.pose.y)) - position, mark.robot) for mark in self._robots
        ]
        near = [(gap.x() ** 2 + gap.y() ** 2, robot) for gap, robot in reached]
        distance, robot = min(near, default=(HIT_RADIUS**2 + 1.0, -1))
        return robot if distance <= HIT_RADIUS**2 else None

    def sizeHint(self) -> QSize:
        """Return a usual size of a map."""
        return QSize(800, 600)

    # Painting ---------------------------------------------------------------------------------------------------------

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw a frame."""
        ratio = self.devicePixelRatioF()
        camera = self.camera = self.camera.snapped(ratio)
        painter = QPainter(self)
        font = fitting_font(self.font(), self.width(), self.height())
        painter.setFont(font)
        moving = self.followed is not None or self._dragging
        self._background.paint(painter, camera, ratio, font, moving)
        for layer in self._layers:
            if layer.z < 0:
                self._paint_layer(painter, layer)
        words = self._background.words(camera)
        self._robot_painter.paint(painter, camera, self._robots, words, font, ratio)
        for layer in self._layers:
            if layer.z >= 0:
                self._paint_layer(painter, layer)
        if self._free is None:  # else it would lie below what covers the rest
            paint_scale_bar(painter, camera, self.colours, font)
        painter.end()

    def _paint_layer(self, painter: QPainter, layer: MapLayer) -> None:
        painter.save()
        layer.paint(painter, self)
        painter.restore()

    # Zoom and size ----------------------------------------------------------------------------------------------------

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Keep the middle, or the whole floor plan."""
        self.camera = replace(self.camera, width=float(max(self.width(), 1)), height=float(max(self.height(), 1)))
        if self._fitted:
            self._refit()

    def changeEvent(self, event: QEvent) -> None:
        """Take over another font."""
        if event.type() == QEvent.Type.FontChange:
            self._background.invalidate()
            self._robot_painter.invalidate()
        super().changeEvent(event)

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom about the pointer."""
        self._zoom(WHEEL_FACTOR ** event.angleDelta().y(), event.position())
        event.accept()

    def event(self, event: QEvent) -> bool:
        """Zoom by two fingers; Qt handles all other events."""
        if isinstance(event, QNativeGestureEvent) and event.gestureType() == Qt.NativeGestureType.ZoomNativeGesture:
            self._zoom(1.0 + event.value(), event.position())
            return True
        return super().event(event)

    def _zoom(self, factor: float, about: QPointF) -> None:
        self._fitted = False
        self.camera = self.camera.zoomed(factor, about.x(), about.y())
        self.update()

    def _refit(self) -> None:
        if self._geometry is not None:
            self.camera = self._fit(self._free or self.rect())

    def _fit(self, free: QRect) -> Camera:
        """Return the view of the whole floor plan in a part of the widget."""
        if self._geometry is None:
            return self.camera
        margin = FIT_MARGIN if free == self.rect() else FIT_MARGIN / 2.0
        part = Camera.fitted(self._geometry.bounds, max(free.width(), 1), max(free.height(), 1), margin)
        return part.moved_within(free.left(), free.top(), max(self.width(), 1), max(self.height(), 1))

    def _follow(self) -> None:
        target = next((mark.pose for mark in self._robots if mark.robot == self.followed), None)
        if target is not None:
            camera = self.camera
            x, y = target.x - camera.x, target.y - camera.y
            if math.hypot(x, y) * camera.scale > FOLLOW_TOLERANCE:
                self.camera = replace(camera, x=camera.x + FOLLOW_SHARE * x, y=camera.y + FOLLOW_SHARE * y)

    # Pointing ---------------------------------------------------------------------------------------------------------

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Begin a click, a drag or a tool's stroke."""
        self._last = event.position()
        self._pressed, self._dragging = event.position(), event.button() == Qt.MouseButton.MiddleButton
        if self._tools(event):
            self.point_pressed.emit(*self.camera.point(event.position().x(), event.position().y()))

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Drag the map, go on with the tool's stroke, or update what is hovered."""
        position = event.position()
        if self._pressed is None:
            self._point_at(position)
        elif self._tool is not None and not self._dragging:
            self.point_dragged.emit(*self.camera.point(position.x(), position.y()))
        else:
            moved = position - self._pressed
            if self._dragging or moved.manhattanLength() > DRAG_THRESHOLD:
                if not self._dragging:
                    self._last = self._pressed
                self._drag(position - self._last)
        self._last = position

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """End a drag or a stroke; a press that stayed where it was is a click."""
        pressed, self._pressed = self._pressed, None
        dragged, self._dragging = self._dragging, False
        if self._tools(event):
            self.point_released.emit(*self.camera.point(event.position().x(), event.position().y()))
        elif pressed is not None and not dragged and event.button() == Qt.MouseButton.LeftButton:
            self._click(event.position())
        self._point_at(event.position())

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Show the whole floor plan where there is nothing to choose; otherwise the first click has chosen it."""
        if self._tool is not None:
            self.mousePressEvent(event)
        elif self.room_at(event.position()) is None and self.robot_at(event.position()) is None:
            self.fit()

    def leaveEvent(self, event: QEvent) -> None:
        """Report that no room is hovered any more."""
        self.hover(None)

    def _tools(self, event: QMouseEvent) -> bool:
        return self._tool is not None and event.button() == Qt.MouseButton.LeftButton

    def _drag(self, moved: QPointF) -> None:
        self._dragging, self._fitted, self.followed = True, False, None
        self.camera = self.camera.dragged(moved.x(), moved.y())
        self.setCursor(Qt.CursorShape.ClosedHandCursor)
        self.update()

    def _click(self, position: QPointF) -> None:
        robot = self.robot_at(position)
        room = self.room_at(position)
        if robot is not None:
            self.robot_clicked.emit(robot)
        elif room is not None:
            self.room_clicked.emit(room)

    def _point_at(self, position: QPointF) -> None:
        """Show what can be clicked at a pixel, and hover its room if the pointer was moved there."""
        robot, room = self.robot_at(position), self.room_at(position)
        choosable = any(mark.room == room and mark.choosable for mark in self._rooms)
        shape = Qt.CursorShape.PointingHandCursor if robot is not None or choosable else Qt.CursorShape.ArrowCursor
        self.setCursor(shape if self._tool is None else self._tool)
        if pointer.has_moved(self, position):
            self.hover(room if robot is None else None)

    def hover(self, room: int | None) -> None:
        """Take a room for hovered, or none."""
        if room != self.hovered:
            self.hovered = room
            self.room_hovered.emit(room)

    # In words ---------------------------------------------------------------------------------------------------------

    def _describe(self) -> None:
        words = describe(self._rooms, self._robots)
        if words != self.accessibleDescription():
            self.setAccessibleDescription(words)
