"""Map of all windows: floor plan, rooms and robots seen from above, with zoom, drag and clicks."""

import math
from collections.abc import Sequence

import numpy as np
import pyqtgraph as pg
from pyqtgraph.GraphicsScene.mouseEvents import MouseClickEvent
from PySide6.QtCore import QEvent, QPointF, QRect, QRectF, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QFontMetricsF, QKeyEvent, QMouseEvent, QNativeGestureEvent, QPaintEvent, QResizeEvent
from PySide6.QtWidgets import QGraphicsScene, QSizePolicy, QWidget

from thbridge.dialogue.wording.texts import Texts
from thbridge.files.language_texts import shipped_texts
from thbridge.roles.shared.notices import FloorPlan
from ui.model.shared.map_geometry import contains, unpack
from ui.model.shared.scene import RobotMark, RoomMark
from ui.model.shared.theme import Palette
from ui.windows import pointer
from ui.windows.map.box import MapBox
from ui.windows.map.changes import same_rooms, settled
from ui.windows.map.ground import Ground
from ui.windows.map.item import Z_SCALE_BAR
from ui.windows.map.lettering import fitting_font
from ui.windows.map.points import pixel
from ui.windows.map.robots import Robots
from ui.windows.map.scale_bar import ScaleBar
from ui.windows.map.words import describe

HIT_RADIUS = 24.0
"""Distance from a robot's middle within which a click selects the robot, pixels."""

DRAG_THRESHOLD = 4.0
"""If the pressed pointer moves at least this distance, the movement is a drag and not a click, pixels."""

FOLLOW_SCALE = 60.0
"""Smallest scale after the map begins to follow a robot, pixels per meter."""

FOLLOW_SHARE = 0.15
"""In each frame, the view moves by this share of the distance to the followed robot."""

FOLLOW_TOLERANCE = 1.0
"""Distance within which the followed robot counts as being in the middle, pixels."""

AXIS_GAP = 8.0
"""Distance between an axis and its numbers, including ticks, pixels."""

DESCRIPTION_PERIOD = 1000
"""Milliseconds between two updates of the description in words."""

pg.setConfigOption("mouseRateLimit", 0)  # Do not combine moves of the pointer: handle each of them.


class MapView(pg.GraphicsView):  # type: ignore[misc]  # pyqtgraph has no types
    """Map that people can zoom and drag, and that can follow a robot; it reports clicks and hovering by signals.

    To add an item, create the item with the `box` of the map.

    Args:
        palette: the colors.
        parent: parent widget.
        texts: texts of the description for screen readers. If None, English texts are used.
        axes: True for axes in meters, and for a menu of the right mouse button that exports the map.

    Attributes:
        box: view of the map, to which items belong.
        followed: index of the robot that is kept in the middle, or None.
        sight: part of the widget that keeps the followed robot in its middle, logical pixels. If None, it is the whole
            widget.
        hovered: number of the room under the pointer, if the pointer was moved there; otherwise None.

    Signals:
        room_clicked: number of the room, counted from 1.
        robot_clicked: index of the robot.
        room_hovered: new value of `hovered`.
        follow_ended: the robot is no longer followed, because the map was dragged or the whole map is shown.
        point_pressed, point_dragged, point_released: x, y in map meters, while a tool uses the left button.
    """

    room_clicked = Signal(int)
    robot_clicked = Signal(int)
    room_hovered = Signal(object)
    follow_ended = Signal()
    point_pressed = Signal(float, float)
    point_dragged = Signal(float, float)
    point_released = Signal(float, float)

    def __init__(
        self, palette: Palette, parent: QWidget | None = None, texts: Texts | None = None, *, axes: bool = False
    ) -> None:
        super().__init__(parent, background=None)
        self.box = MapBox(palette, self.font(), menu=axes)
        self._ground = Ground(self.box)
        self._robots = Robots(self.box, self._ground)
        self._scale_bar = ScaleBar(self.box, Z_SCALE_BAR)
        self._axes = {side: pg.AxisItem(side, linkView=self.box) for side in (("left", "bottom") if axes else ())}
        self._lay_out()
        self._rooms: tuple[RoomMark, ...] = ()
        self.followed: int | None = None
        self.sight: QRect | None = None
        self._tool: Qt.CursorShape | None = None
        self._stroking = False
        self.hovered: int | None = None
        self._last = QPointF()
        self.scene().sigMouseClicked.connect(self._click)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        # This call also affects the widget itself, because it is the focus proxy of the viewport.
        self.viewport().setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._texts = texts or shipped_texts()
        self.setAccessibleName(self._texts.text("map.name"))
        self._describing = QTimer(self)
        self._describing.timeout.connect(self._describe)
        self._describing.start(DESCRIPTION_PERIOD)

    def _lay_out(self) -> None:
        """Fill the widget with the map. Configure the scene for a few items that are painted in each frame."""
        layout = pg.GraphicsLayout()
        self.setCentralItem(layout)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(0)
        layout.addItem(self.box, 0, 1)
        for side, axis in self._axes.items():
            layout.addItem(axis, *((0, 0) if side == "left" else (1, 1)))
        self._color_axes()
        self.setCacheMode(self.CacheModeFlag.CacheNone)
        self.setViewportUpdateMode(self.ViewportUpdateMode.FullViewportUpdate)
        self.viewport().setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        scene = self.scene()
        scene.setItemIndexMethod(QGraphicsScene.ItemIndexMethod.NoIndex)
        scene.setMoveDistance(DRAG_THRESHOLD)
        scene.minDragTime = math.inf  # A slow click also counts as a click.

    # Contents ---------------------------------------------------------------------------------------------------------

    def show_floor_plan(self, floor_plan: FloorPlan) -> None:
        """Show another floor plan, completely visible."""
        geometry = unpack(floor_plan)
        self._ground.show_geometry(geometry)
        left, bottom, right, top = geometry.bounds
        self.box.bounds = QRectF(left, bottom, right - left, top - bottom)
        self.fit()

    def show_rooms(self, rooms: Sequence[RoomMark]) -> None:
        """Show the current rooms; do nothing if they look the same as before."""
        if not same_rooms(self._rooms, rooms):
            self._rooms = tuple(rooms)
            self._ground.show_rooms(self._rooms)

    def show_robots(self, robots: Sequence[RobotMark]) -> None:
        """Show the robots of this frame; paint only visible changes."""
        marks = settled(self._robots.marks, robots, 1.0 / self.metres(1.0))
        if marks != self._robots.marks:
            self._robots.show_robots(marks)
        self._follow()

    def set_palette(self, palette: Palette) -> None:
        """Use the colors of this palette."""
        self.box.colors = palette
        self._ground.change_colors()
        self._robots.invalidate()
        self._color_axes()

    def _color_axes(self) -> None:
        palette = self.box.colors
        self.setBackground(palette.window if self._axes else None)
        metrics = QFontMetricsF(self.box.letters)
        for side, axis in self._axes.items():
            axis.setPen(palette.line)
            axis.setTextPen(palette.muted)
            axis.setTickFont(self.box.letters)
            # The size is fixed, because an axis that grows with its numbers would move the map.
            if side == "left":
                axis.setWidth(metrics.horizontalAdvance("-10.5") + AXIS_GAP)
            else:
                axis.setHeight(metrics.height() + AXIS_GAP)

    # View -------------------------------------------------------------------------------------------------------------

    def fit(self) -> None:
        """Stop following a robot, and show the whole floor plan, now and after each change of size."""
        self._end_follow()
        self.box.fit()

    @property
    def fitted(self) -> bool:
        """True while the whole floor plan is shown, because no person has zoomed or dragged it."""
        return self.box.fitted

    def follow(self, robot: int | None) -> None:
        """Keep this robot in the middle of the view. If None, stop following."""
        self.followed = robot
        if robot is not None:
            self.box.zoom(max(FOLLOW_SCALE * self.metres(1.0), 1.0), *self.box.middle)
            self._follow()

    def set_tool(self, cursor: Qt.CursorShape | None) -> None:
        """Let a tool with this cursor use the left button. If None, no tool uses it.

        While a tool uses the left button, the map emits `point_pressed`, `point_dragged` and `point_released`. The
        middle button then drags the map, and clicks select nothing.
        """
        self._tool = cursor
        self._point_at(self._last)

    def pixel(self, x: float, y: float) -> QPointF:
        """Return the pixel of this widget at a map point."""
        at: QPointF = self.box.mapToScene(pixel(self.box.to_pixels(), x, y))
        return at

    def point(self, position: QPointF) -> tuple[float, float]:
        """Return the map point at a pixel of this widget."""
        at = self.box.to_pixels().inverted()[0].map(self.box.mapFromScene(position))
        return at.x(), at.y()

    def robot_place(self, robot: int) -> QPointF | None:
        """Return the pixel of this widget at the middle of a robot; None if the robot is not shown."""
        pose = next((mark.pose for mark in self._robots.marks if mark.robot == robot), None)
        return None if pose is None else self.pixel(pose.x, pose.y)

    def room_place(self, room: int) -> QRectF | None:
        """Return the box around a room, pixels of this widget; None if the room is not shown."""
        region = next((mark.region for mark in self._rooms if mark.room == room), None)
        if region is None:
            return None
        (left, bottom), (right, top) = region.min(axis=0), region.max(axis=0)
        return QRectF(self.pixel(left, top), self.pixel(right, bottom))

    def opposite_corner(self, robot: int) -> tuple[bool, bool] | None:
        """Return the corner of the map that is farthest from a robot; None if the robot is not shown.

        The first value is True for the right side, and the second value is True for the bottom.
        """
        pose = next((mark.pose for mark in self._robots.marks if mark.robot == robot), None)
        middle = self.box.bounds.center()
        return None if pose is None else (pose.x < middle.x(), pose.y > middle.y())

    def metres(self, pixels: float) -> float:
        """Convert a length on the screen, pixels, to a length on the map, meters."""
        return pixels / self.box.to_pixels().m11()

    def room_at(self, position: QPointF) -> int | None:
        """Return the number of the room at a pixel of this widget."""
        here = np.array([self.point(position)])
        return next((mark.room for mark in self._rooms if contains(mark.region, here)[0]), None)

    def robot_at(self, position: QPointF) -> int | None:
        """Return the index of the robot nearest to a pixel of this widget; None if no robot is near the pixel."""
        reached = [(self.pixel(mark.pose.x, mark.pose.y) - position, mark.robot) for mark in self._robots.marks]
        near = [(gap.x() ** 2 + gap.y() ** 2, robot) for gap, robot in reached]
        distance, robot = min(near, default=(HIT_RADIUS**2 + 1.0, -1))
        return robot if distance <= HIT_RADIUS**2 else None

    def sizeHint(self) -> QSize:
        """Return the usual size of a map."""
        return QSize(800, 600)

    def minimumSizeHint(self) -> QSize:
        """Return an empty size, because the window sets the minimum size."""
        return QSize()

    def _end_follow(self) -> None:
        if self.followed is not None:
            self.followed = None
            self.follow_ended.emit()

    def _follow(self) -> None:
        target = next((mark.pose for mark in self._robots.marks if mark.robot == self.followed), None)
        if target is not None:
            middle_x, middle_y = self.box.middle if self.sight is None else self.point(QRectF(self.sight).center())
            x, y = target.x - middle_x, target.y - middle_y
            if math.hypot(x, y) > self.metres(FOLLOW_TOLERANCE):
                self.box.translateBy(x=FOLLOW_SHARE * x, y=FOLLOW_SHARE * y)

    # Events -----------------------------------------------------------------------------------------------------------

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the map, and set the part to paint for its items."""
        self.box.exposed = event.region().translated(-self.box.scenePos().toPoint())
        super().paintEvent(event)
        self.box.exposed = None

    def resizeEvent(self, event: QResizeEvent | None) -> None:
        """Adapt to another size of the widget; a small map has smaller letters."""
        super().resizeEvent(event)
        if event is not None:
            self._fit_letters()

    def changeEvent(self, event: QEvent) -> None:
        """Adapt to another font."""
        if event.type() == QEvent.Type.FontChange:
            self._fit_letters()
        super().changeEvent(event)

    def close(self) -> bool:
        """Hide the widget. pyqtgraph would remove the scene, and the next event would end the process."""
        return QWidget.close(self)

    def _fit_letters(self) -> None:
        letters = fitting_font(self.font(), self.width(), self.height())
        if letters != self.box.letters:
            self.box.letters = letters
            self._ground.invalidate()
            self._robots.invalidate()
            self._color_axes()

    def viewportEvent(self, event: QEvent) -> bool:
        """Zoom with two fingers; Qt and pyqtgraph handle all other events."""
        if isinstance(event, QNativeGestureEvent) and event.gestureType() == Qt.NativeGestureType.ZoomNativeGesture:
            self.box.zoom(1.0 + event.value(), *self.point(event.position()))
            return True
        return bool(super().viewportEvent(event))

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Start a stroke of the tool. Without a tool, pyqtgraph distinguishes clicks from drags."""
        self._stroking = self._tool is not None and event.button() == Qt.MouseButton.LeftButton
        if self._stroking:
            self.point_pressed.emit(*self.point(event.position()))
        else:
            super().mousePressEvent(event)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Start a stroke of the tool, also at the second press of a double click."""
        if self._tool is not None:
            self.mousePressEvent(event)
        else:
            super().mouseDoubleClickEvent(event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Continue the tool's stroke, drag the map, or update the hovered room."""
        self._last = event.position()
        if self._stroking:
            self.point_dragged.emit(*self.point(event.position()))
            return
        super().mouseMoveEvent(event)
        if self.scene().dragItem is not None:
            self._end_follow()
            self.setCursor(Qt.CursorShape.ClosedHandCursor)
        elif not event.buttons():
            self._point_at(event.position())

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """End a stroke or a drag."""
        if self._stroking and event.button() == Qt.MouseButton.LeftButton:
            self._stroking = False
            self.point_released.emit(*self.point(event.position()))
        else:
            super().mouseReleaseEvent(event)
        self._point_at(event.position())

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Leave all keys to the window."""
        event.ignore()

    def leaveEvent(self, event: QEvent) -> None:
        """Report that no room is hovered."""
        super().leaveEvent(event)
        self.hover(None)

    def _click(self, event: MouseClickEvent) -> None:
        """Report a click; on a double click outside robots and rooms, show the whole floor plan."""
        if event.button() != Qt.MouseButton.LeftButton:
            return
        position = QPointF(event.scenePos())
        robot, room = self.robot_at(position), self.room_at(position)
        if event.double():
            if robot is None and room is None:
                self.fit()
        elif robot is not None:
            self.robot_clicked.emit(robot)
        elif room is not None:
            self.room_clicked.emit(room)

    def _point_at(self, position: QPointF) -> None:
        """Set the cursor, which shows whether a click at a pixel has an effect; update the hovered room."""
        robot, room = self.robot_at(position), self.room_at(position)
        choosable = any(mark.room == room and mark.choosable for mark in self._rooms)
        shape = Qt.CursorShape.PointingHandCursor if robot is not None or choosable else Qt.CursorShape.ArrowCursor
        self.setCursor(shape if self._tool is None else self._tool)
        if pointer.has_moved(self, position):
            self.hover(room if robot is None else None)

    def hover(self, room: int | None) -> None:
        """Set the hovered room. If None, no room is hovered."""
        if room != self.hovered:
            self.hovered = room
            self.room_hovered.emit(room)

    # In words ---------------------------------------------------------------------------------------------------------

    def _describe(self) -> None:
        words = describe(self._texts, self._rooms, self._robots.marks)
        if words != self.accessibleDescription():
            self.setAccessibleDescription(words)
