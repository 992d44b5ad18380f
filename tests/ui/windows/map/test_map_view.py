"""The map view: it reports what is pointed at, moves as it is asked to, and shows the colors."""

from dataclasses import replace
from typing import get_args

import numpy as np
import pytest
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QObject, QPoint, QPointF, QRectF, Qt
from PySide6.QtGui import (
    QColor,
    QImage,
    QNativeGestureEvent,
    QPainter,
    QPaintEvent,
    QPixmap,
    QPointingDevice,
    QRegion,
    QTransform,
    QWheelEvent,
)
from PySide6.QtTest import QSignalSpy
from PySide6.QtWidgets import QApplication, QWidget
from pytestqt.qtbot import QtBot

from sim.common.geometry import Pose2
from tests.support.maps.sample_maps import busy_robots, house_of, robot_at, rooms_of, shipped_map
from thbridge.files.map_files import Map
from ui.model.shared.scene import RoomState
from ui.model.shared.theme import DARK, LIGHT
from ui.windows.map import MapView, rooms
from ui.windows.map.item import Z_ABOVE, Z_FLAT, CellImage, MapItem
from ui.windows.map.points import mapped
from ui.windows.researcher.map.overlays import COST_COLORS, Arrows, Dots, Lines

MAPS = ("arena8", "office", "warehouse12")


@pytest.fixture
def arena() -> Map:
    return shipped_map("arena8")


@pytest.fixture
def view(qtbot: QtBot, arena: Map) -> MapView:
    return shown(qtbot, arena)


def shown(qtbot: QtBot, house: Map) -> MapView:
    view = MapView(LIGHT)
    qtbot.addWidget(view)
    view.resize(1000, 700)
    view.show_floor_plan(house_of(house))
    view.show_rooms(rooms_of(house))
    view.show()
    return view


def spot(view: MapView, x: float, y: float) -> QPoint:
    return view.pixel(x, y).toPoint()


def click(qtbot: QtBot, view: MapView, at: QPoint) -> None:
    qtbot.mouseClick(view.viewport(), Qt.MouseButton.LeftButton, pos=at)


def drag(qtbot: QtBot, view: MapView, start: QPoint, end: QPoint, button: Qt.MouseButton) -> None:
    qtbot.mousePress(view.viewport(), button, pos=start)
    qtbot.mouseMove(view.viewport(), (start + end) / 2)
    qtbot.mouseMove(view.viewport(), end)
    qtbot.mouseRelease(view.viewport(), button, pos=end)


def double_click(qtbot: QtBot, view: MapView, at: QPoint) -> None:
    click(qtbot, view, at)
    qtbot.mouseDClick(view.viewport(), Qt.MouseButton.LeftButton, pos=at)
    qtbot.mouseRelease(view.viewport(), Qt.MouseButton.LeftButton, pos=at)


def wheel(view: MapView, at: QPoint, turns: int) -> None:
    event = QWheelEvent(
        QPointF(at),
        QPointF(view.mapToGlobal(at)),
        QPoint(),
        QPoint(0, 120 * turns),
        Qt.MouseButton.NoButton,
        Qt.KeyboardModifier.NoModifier,
        Qt.ScrollPhase.NoScrollPhase,
        False,
    )
    QApplication.sendEvent(view.viewport(), event)


@pytest.mark.parametrize("name", MAPS)
def test_a_click_in_a_room_names_it(qtbot: QtBot, name: str) -> None:
    house = shipped_map(name)
    view = shown(qtbot, house)
    clicks = QSignalSpy(view.room_clicked)
    for room in house.rooms:
        click(qtbot, view, spot(view, room.goal.x, room.goal.y))
    assert [clicks.at(k)[0] for k in range(clicks.count())] == [room.room.people for room in house.rooms]


def test_a_click_near_a_robot_names_the_nearest(qtbot: QtBot, view: MapView) -> None:
    view.show_robots([robot_at(0, 0.0, 0.0), robot_at(1, 0.5, 0.0)])
    clicks = QSignalSpy(view.robot_clicked)
    click(qtbot, view, spot(view, 0.35, 0.1))
    click(qtbot, view, spot(view, 0.1, 0.1))
    assert [clicks.at(k)[0] for k in range(clicks.count())] == [1, 0]


def test_a_robot_is_hit_within_reach_and_not_beyond(view: MapView) -> None:
    view.show_robots([robot_at(0, 0.0, 0.0)])
    assert view.robot_at(view.pixel(0.0, 0.0) + QPointF(23.0, 0.0)) == 0
    assert view.robot_at(view.pixel(0.0, 0.0) + QPointF(25.0, 0.0)) is None


def test_a_robot_in_a_room_is_clicked_and_not_the_room(qtbot: QtBot, view: MapView, arena: Map) -> None:
    goal = arena.rooms[0].goal
    view.show_robots([robot_at(0, goal.x, goal.y)])
    rooms = QSignalSpy(view.room_clicked)
    with qtbot.waitSignal(view.robot_clicked):
        click(qtbot, view, spot(view, goal.x, goal.y))
    assert rooms.count() == 0


def test_hovering_tells_a_room_once_and_leaving_it(qtbot: QtBot, view: MapView, arena: Map) -> None:
    hovers = QSignalSpy(view.room_hovered)
    goal = arena.rooms[0].goal
    qtbot.mouseMove(view.viewport(), spot(view, goal.x, goal.y))
    qtbot.mouseMove(view.viewport(), spot(view, goal.x + 0.2, goal.y))
    qtbot.mouseMove(view.viewport(), spot(view, 0.0, 0.0))
    assert [hovers.at(k)[0] for k in range(hovers.count())] == [1, None]


def test_dragging_moves_the_map_and_chooses_nothing(qtbot: QtBot, view: MapView, arena: Map) -> None:
    clicks = QSignalSpy(view.room_clicked)
    goal = arena.rooms[0].goal
    start = spot(view, goal.x, goal.y)
    drag(qtbot, view, start, start + QPoint(60, 40), Qt.MouseButton.LeftButton)
    assert clicks.count() == 0
    assert spot(view, goal.x, goal.y) == start + QPoint(60, 40)


def test_the_wheel_zooms_about_the_pointer(view: MapView) -> None:
    at = spot(view, 2.0, 3.0)
    before, under = view.metres(1.0), view.point(QPointF(at))
    wheel(view, at, 3)
    assert view.metres(1.0) < before / 1.3
    assert view.point(QPointF(at)) == pytest.approx(under, abs=view.metres(1.0))


def test_two_fingers_zoom_about_their_middle(view: MapView) -> None:
    at, before = QPointF(spot(view, 2.0, 3.0)), view.metres(1.0)
    under = view.point(at)
    pinch = QNativeGestureEvent(
        Qt.NativeGestureType.ZoomNativeGesture,
        QPointingDevice.primaryPointingDevice(),
        2,
        at,
        at,
        QPointF(view.mapToGlobal(at)),
        0.25,
        QPointF(),
    )
    QApplication.sendEvent(view.viewport(), pinch)
    assert view.metres(1.0) == pytest.approx(before / 1.25)
    assert view.point(at) == pytest.approx(under, abs=view.metres(1.0))


def test_a_double_click_beside_rooms_fits_again(qtbot: QtBot, view: MapView) -> None:
    fitted, at = view.metres(1.0), spot(view, 0.0, 0.0)
    wheel(view, at, 4)
    assert view.metres(1.0) != fitted
    double_click(qtbot, view, at)
    assert view.metres(1.0) == pytest.approx(fitted)


def test_a_double_click_on_a_room_chooses_once(qtbot: QtBot, view: MapView, arena: Map) -> None:
    clicks, at = QSignalSpy(view.room_clicked), spot(view, arena.rooms[0].goal.x, arena.rooms[0].goal.y)
    double_click(qtbot, view, at)
    assert clicks.count() == 1


def test_the_whole_house_stays_in_view_when_the_size_changes(view: MapView, qtbot: QtBot) -> None:
    view.resize(500, 400)
    qtbot.waitUntil(lambda: view.box.width() == 500.0)
    for x, y in ((-5.0, -5.0), (11.0, 7.0)):
        assert view.rect().contains(spot(view, x, y))


def test_following_keeps_a_robot_in_the_middle_until_the_map_is_dragged(qtbot: QtBot, view: MapView) -> None:
    view.follow(1)
    for step in range(200):
        view.show_robots([robot_at(0, 0.0, 0.0), robot_at(1, 0.008 * step, 1.0)])
    assert view.box.middle == pytest.approx((1.6, 1.0), abs=0.1)
    drag(qtbot, view, QPoint(200, 200), QPoint(300, 300), Qt.MouseButton.LeftButton)
    assert view.followed is None


def test_a_tool_has_the_left_button_in_metres(qtbot: QtBot, view: MapView, arena: Map) -> None:
    view.set_tool(Qt.CursorShape.CrossCursor)
    clicks, before = QSignalSpy(view.room_clicked), view.box.viewRect()
    pressed, released = QSignalSpy(view.point_pressed), QSignalSpy(view.point_released)
    dragged = QSignalSpy(view.point_dragged)
    goal = arena.rooms[0].goal
    drag(qtbot, view, spot(view, goal.x, goal.y), spot(view, 0.0, 0.0), Qt.MouseButton.LeftButton)
    assert pressed.at(0) == pytest.approx([goal.x, goal.y], abs=0.03)
    assert released.at(0) == pytest.approx([0.0, 0.0], abs=0.03)
    assert dragged.count() >= 1
    assert clicks.count() == 0
    assert view.box.viewRect() == before
    assert view.cursor().shape() == Qt.CursorShape.CrossCursor
    drag(qtbot, view, QPoint(300, 300), QPoint(360, 300), Qt.MouseButton.MiddleButton)
    assert view.box.viewRect() != before


def test_the_pointer_tells_what_can_be_chosen(qtbot: QtBot, view: MapView, arena: Map) -> None:
    view.show_rooms([replace(mark, choosable=mark.room == 1) for mark in rooms_of(arena)])
    shapes = []
    for room in arena.rooms[:2]:
        qtbot.mouseMove(view.viewport(), spot(view, room.goal.x, room.goal.y))
        shapes.append(view.cursor().shape())
    assert shapes == [Qt.CursorShape.PointingHandCursor, Qt.CursorShape.ArrowCursor]


def test_a_robot_is_drawn_in_its_colour_and_its_nose_points_ahead(qtbot: QtBot, view: MapView) -> None:
    wheel(view, spot(view, 0.0, 0.0), 10)
    view.show_robots([robot_at(0, 0.0, 0.0, theta=np.pi / 2)])
    picture = view.grab().toImage()
    assert picture.pixelColor(spot(view, 0.0, -0.2)) == QColor(LIGHT.robot(0))
    assert picture.pixelColor(spot(view, 0.0, 0.15)) == QColor(LIGHT.panel)


def test_colours_change_by_night(view: MapView, arena: Map) -> None:
    at = spot(view, 0.0, 0.0)
    assert view.grab().toImage().pixelColor(at) == QColor(LIGHT.floor)
    view.set_palette(DARK)
    assert view.grab().toImage().pixelColor(at) == QColor(DARK.floor)


@pytest.mark.parametrize("name", MAPS)
def test_states_of_rooms_differ_without_colour(qtbot: QtBot, name: str) -> None:
    house = shipped_map(name)
    view = shown(qtbot, house)
    greys = []
    for state in get_args(RoomState):
        view.show_rooms([replace(mark, state=state) for mark in rooms_of(house)])
        image = view.grab().toImage()
        greys.append([image.pixelColor(x, y).lightness() for x in range(0, 1000, 3) for y in range(0, 700, 3)])
    shares = [np.mean(np.abs(np.diff(np.array(one).reshape(-1, 234), axis=1)) > 4) for one in greys]
    assert shares[1] > 1.3 * shares[0]
    assert all(share > 1.02 * shares[0] for share in shares[2:])


@pytest.mark.parametrize("size", [(1000, 700), (560, 340)])
def test_what_was_named_stands_in_its_room_also_on_a_small_map(qtbot: QtBot, arena: Map, size: tuple[int, int]) -> None:
    view = shown(qtbot, arena)
    view.resize(*size)
    hidden = [replace(mark, found="Orange Bottle") for mark in rooms_of(arena)]
    view.show_rooms(hidden)
    without = view.grab().toImage()
    for number, mark in enumerate(hidden):
        view.show_rooms([*hidden[:number], replace(mark, answer="−20 for Pink can"), *hidden[number + 1 :]])
        named = view.grab().toImage()
        inside = mapped(view.box.to_pixels(), mark.region)
        changed = [
            (x, y)
            for x in range(0, size[0], 2)
            for y in range(0, size[1], 2)
            if without.pixelColor(x, y) != named.pixelColor(x, y)
        ]
        assert len(changed) > 50, mark.room
        assert (np.array(changed) >= inside.min(axis=0)).all()
        assert (np.array(changed) <= inside.max(axis=0)).all()


def test_a_badge_has_fewer_words_where_all_do_not_fit(qtbot: QtBot, arena: Map) -> None:
    view = shown(qtbot, arena)
    space = rooms._Space(view.box.to_pixels(), rooms_of(arena)[0].region, None)
    found = rooms._Pill(space, "something of an orange that fits into no room", view.box.letters, ("orange",))
    assert found.words == "orange"
    assert (
        rooms._Pill(space, "something of an orange that fits into no room", view.box.letters).words
        == "something of an orange …"
    )
    assert not rooms._Pill(space, "something-that-fits-into-no-room-of-the-house", view.box.letters).words


class Paintings(QObject):
    """Counts how often a widget is painted."""

    def __init__(self, widget: QWidget) -> None:
        super().__init__(widget)
        self.count = 0
        widget.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        self.count += event.type() == QEvent.Type.Paint
        return False


def test_nothing_is_painted_while_nothing_moves(qtbot: QtBot, view: MapView) -> None:
    paintings = Paintings(view.viewport())

    def painted(x: float) -> bool:
        before = paintings.count
        view.show_robots([robot_at(0, x, 0.0)])
        QApplication.processEvents()
        return paintings.count > before

    assert painted(0.0)
    assert not painted(0.0001)
    assert painted(0.02)
    assert not any(painted(0.02 + 0.0002 * step) for step in range(5))
    assert any(painted(0.021 + 0.0002 * step) for step in range(20))


def pixels_of(picture: QPixmap) -> NDArray[np.int16]:
    image = picture.toImage().convertToFormat(QImage.Format.Format_RGB32)
    return np.frombuffer(image.constBits(), dtype=np.uint8).astype(np.int16)


def test_what_is_painted_in_parts_looks_as_if_it_were_painted_at_once(qtbot: QtBot) -> None:
    house = shipped_map("office")
    view = shown(qtbot, house)
    robots = [replace(mark, path=mark.path[::6]) for mark in busy_robots(house, 6)]
    robots[3] = replace(robots[3], trail=np.empty((0, 2)))
    view.show_robots(robots)
    QApplication.processEvents()
    whole = QRegion(view.viewport().rect())
    parts, painted = Parts(view.viewport()), []
    for step in range(1, 6):
        for number in (0, 3):  # Two of six drive, close to their paths.
            mark, (x, y) = robots[number], robots[number].path[1] + 0.1
            trail = np.concatenate((mark.trail[1:], [[x, y]])) if number == 0 else mark.trail
            pose, path = Pose2(x, y, mark.pose.theta + 0.1), np.concatenate(([[x, y]], mark.path[2:]))
            robots[number] = replace(mark, pose=pose, trail=trail, path=path, ellipse=None, truth=pose)
        lonely = robots[5].pose  # One has no path and no trail.
        robots[5] = robot_at(5, lonely.x + 0.9 * (-1) ** step, lonely.y)
        if step % 4 == 0:
            robots = [replace(mark, selected=mark.robot == step // 4, trouble=step == 4) for mark in robots]
        view.show_robots(robots)
        QApplication.processEvents()
        painted.append(parts.painted[-1])
        on_screen = pixels_of(view.screen().grabWindow(view.winId()))
        # Where a part ends, edges may be rounded differently.
        assert np.abs(on_screen - pixels_of(view.grab())).max() <= 8, step
    assert all(part != whole for part in painted)


class Parts(QObject):
    """Records which parts of a widget are painted."""

    def __init__(self, widget: QWidget) -> None:
        super().__init__(widget)
        self.painted: list[QRegion] = []
        widget.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if isinstance(event, QPaintEvent):
            self.painted.append(event.region())
        return False


def test_items_are_painted_below_and_above_robots(view: MapView) -> None:
    class Stamp(MapItem):
        def draw(self, painter: QPainter, to_pixels: QTransform) -> None:
            at = QRectF(-3.0, -3.0, 6.0, 6.0).translated(to_pixels.map(QPointF(0.0, 0.0)))
            painter.fillRect(at, QColor("#ff0000" if self.zValue() == Z_FLAT else "#00ff00"))

    view.show_robots([robot_at(0, -0.1, 0.0)])
    at = spot(view, 0.0, 0.0)
    below = Stamp(view.box, Z_FLAT)
    assert view.grab().toImage().pixelColor(at) != QColor("#ff0000")
    above = Stamp(view.box, Z_ABOVE)
    assert view.grab().toImage().pixelColor(at) == QColor("#00ff00")
    assert below.scene() is above.scene() is view.scene()


def test_points_lines_and_arrows_lie_where_they_belong(view: MapView) -> None:
    points, lines, arrows = Dots(view.box, Z_FLAT, 4.0), Lines(view.box, Z_FLAT, 4.0), Arrows(view.box, Z_FLAT, 4.0)
    points.show_rows({2: np.array([[0.0, 0.0]])})
    lines.show_rows({2: np.array([[-0.4, 0.5], [0.4, 0.5]])})
    arrows.show_rows({2: np.array([[0.0, 1.0, 0.0]])})
    image = view.grab().toImage()
    for x, y in ((0.0, 0.0), (0.0, 0.5), (0.15, 1.0)):
        assert image.pixelColor(spot(view, x, y)) == QColor(LIGHT.robot(2)), (x, y)


def test_costs_lie_the_right_way_up(view: MapView, arena: Map) -> None:
    costs = np.zeros((20, 20), dtype=np.uint8)
    costs[0:5, :] = 100
    start = arena.starts[0]
    item = CellImage()
    item.show_cells(costs, COST_COLORS, start, 0.05)
    view.box.addItem(item, ignoreBounds=True)
    image = view.grab().toImage()

    def color(x: float, y: float) -> QColor:
        return image.pixelColor(spot(view, start.x + x, start.y + y))

    assert color(0.5, 0.1).red() > color(0.5, 0.1).green() + 60
    assert color(0.5, 0.8) == QColor(LIGHT.floor)


def test_the_map_is_told_in_words(view: MapView, qtbot: QtBot, arena: Map) -> None:
    goal = arena.rooms[1].goal
    view.show_robots([robot_at(0, 0.0, 0.0, selected=True), robot_at(1, goal.x, goal.y)])
    assert view.accessibleName() == "Map"
    qtbot.waitUntil(lambda: view.accessibleDescription() != "")
    assert view.accessibleDescription() == ("Map: 8 rooms; robot 1 in the corridor, selected; robot 2 in room 2.")


@pytest.mark.parametrize("name", MAPS)
def test_twenty_busy_robots_are_painted(qtbot: QtBot, name: str) -> None:
    house = shipped_map(name)
    view = shown(qtbot, house)
    view.show_robots(busy_robots(house, 20))
    assert not view.grab().isNull()


def test_a_closed_map_takes_another_font_and_can_be_shown_again(view: MapView) -> None:
    view.close()
    larger = view.font()
    larger.setPointSize(2 * larger.pointSize())
    view.setFont(larger)
    view.show()
    assert view.font() == larger
    assert not view.grab().isNull()
