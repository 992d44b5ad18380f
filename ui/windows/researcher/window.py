"""The researcher's window at work: what a feed tells goes to the parts, what people do goes to the feed."""

import math
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QAccessible, QAccessibleAnnouncementEvent, QCloseEvent
from PySide6.QtWidgets import QLabel, QMessageBox

from sim.geometry import FloatArray, Pose2
from thbridge.hunt.outcomes import Refused
from thbridge.hunt.rules import robot_name
from thbridge.roles.house import house_of
from ui.model.scene import RobotMark
from ui.model.theme import Palette
from ui.model.watching.scene import Entry, EntryKind, PendingTurn, RobotScene, Scene, Shown
from ui.model.watching.series import RobotSeries
from ui.model.watching.tools import Tools, aimed
from ui.windows.look import panel
from ui.windows.map import MapView
from ui.windows.researcher.deck import Deck
from ui.windows.researcher.displays import Display
from ui.windows.researcher.feed import Feed, Wish
from ui.windows.researcher.log import Log, Row
from ui.windows.researcher.overlays import Overlays, drawn
from ui.windows.researcher.plots import BAND, Curves
from ui.windows.researcher.preview import Preview
from ui.windows.researcher.team import RobotRow
from ui.windows.researcher.tools import TOOLS, Gesture, Tool
from ui.windows.researcher.transport import SPEEDS, Mark

FRAME = 33
"""Milliseconds from one picture of the map to the next."""
SLOW, PLOTTED = 5, 10
"""Pictures of the map to one of the lists, and of the plots."""
PORTION = 2000
"""Rows that a list takes at once."""
EPSILON = 0.01
"""Seconds from a mark at which we are there."""
REACH, GRIP = 0.4, 24.0
"""Metres, or pixels where those are more, from its middle at which a robot is taken hold of."""
NO_POINTS: FloatArray = np.empty((0, 2))
ROUND: FloatArray = 0.2 * np.array([[math.cos(a), math.sin(a)] for a in np.linspace(0.0, 2.0 * math.pi, 17)[:-1]])
"""The body of a robot that never told of its own, metres."""


class ResearcherWindow(Deck):
    """A recording or a session under way, in a window.

    Args:
        feed: what is shown.
        title: what is looked at.
        palette: the colours.
        clock: seconds that never go back.
    """

    def __init__(self, feed: Feed, title: str, palette: Palette, clock: Callable[[], float]) -> None:
        self._map = MapView(palette)
        super().__init__(title, palette, feed.live, self._map)
        self._feed = feed
        self._clock = clock
        self._selected = 0
        self._edition = feed.edition
        self._scene: Scene | None = None
        self._bodies: dict[int, FloatArray] = {}
        self._taken: dict[EntryKind, int] = {}
        self._marks: tuple[Mark, ...] = ()
        self._marked = (0, 0.0)
        self._frames = 0
        self._tools = Tools()
        self._overlays = Overlays(self._map)
        self._preview = Preview()
        self._map.add_layer(self._preview)
        self._sign = Sign(self._map)
        self._connect()
        if feed.refusal:
            self.disable_tools(feed.refusal)
        self._timer = QTimer(self)
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self.refresh)
        self._timer.start(FRAME)
        self._working = QTimer(self)
        self._working.timeout.connect(self._work)
        self._working.start(0)

    def _connect(self) -> None:
        feed, bar = self._feed, self.transport
        bar.play_toggled.connect(lambda: feed.play(not feed.playing))
        bar.stepped.connect(feed.step)
        bar.speed_chosen.connect(feed.set_speed)
        bar.seek.connect(feed.seek)
        self.speed_stepped.connect(self._change_speed)
        self.jumped.connect(self._jump)
        self.ended.connect(lambda way: feed.seek(0.0 if way < 0 else feed.span))
        self.plots.seek.connect(feed.seek)
        for log in self.logs:
            log.chosen.connect(feed.seek)
        self.team.selected.connect(self._choose_row)
        self.robot_stepped.connect(self._next_robot)
        self.follow_toggled.connect(self._follow)
        self.fit.connect(self._fit)
        self.kill.connect(self._ask_to_kill)
        self.revive.connect(partial(self._ask, Tools.revive, "{robot} is to go on."))
        self.clear_costmaps.connect(partial(self._ask, Tools.clear_costmaps, "{robot} is to clear its costmaps."))
        self.wizard.puppeteered.connect(self._puppeteer)
        self.wizard.spoke.connect(self._speak)
        self.wizard.advised.connect(self._advise)
        self.tool_taken.connect(self._take_tool)
        self._map.robot_clicked.connect(self.select)
        self._map.point_pressed.connect(self._press)
        self._map.point_dragged.connect(self._drag)
        self._map.point_released.connect(self._release)

    @property
    def scene(self) -> Scene | None:
        """What is on the map; None before there is anything."""
        return self._scene

    @property
    def trouble(self) -> str:
        """What the sign on the map says; empty where all is well."""
        return self._sign.text()

    # Every frame

    def refresh(self) -> None:
        """Show what has become of it since the last time."""
        feed, now = self._feed, self._clock()
        feed.advance(now)
        if feed.edition != self._edition:
            self._begin_anew()
        scene = feed.scene(self._shown())
        if scene is not None:
            self._show_map(scene)
        self._sign.say(feed.trouble())
        for news in feed.take_news():
            self.say(news)
        time = feed.time
        self.transport.show_time(time)
        self.transport.show_playing(feed.playing)
        self.transport.show_speed(feed.speed)
        self.transport.show_state(feed.state(now))
        self._frames += 1
        if self._frames % SLOW == 1:
            self._show_lists()
            if scene is not None:
                self._show_figures(scene)
        if self._frames % PLOTTED == 1:
            self._show_plots()
        for log in self.logs:
            log.show_time(time)

    def _work(self) -> None:
        if not self._feed.work():
            self._working.setInterval(FRAME)
        else:
            self._working.setInterval(0)

    def _begin_anew(self) -> None:
        self._edition = self._feed.edition
        self._taken, self._bodies, self._scene = {}, {}, None
        self.plots.clear()
        for log in self.logs:
            log.clear()

    def _shown(self) -> Shown:
        on = self.displays.shows
        return Shown(
            selected=self._selected,
            clouds=on(Display.CLOUDS),
            scans=on(Display.SCANS),
            global_costmap=on(Display.GLOBAL_COSTMAP),
            local_costmap=on(Display.LOCAL_COSTMAP),
            plans=on(Display.PLANS) or on(Display.LOCAL_PLANS),
            paths=on(Display.PATHS) or on(Display.TRUE_PATHS) or on(Display.ODOMETRY),
        )

    def _show_map(self, scene: Scene) -> None:
        before, self._scene = self._scene, scene
        if scene.grid is not None and (before is None or before.grid is not scene.grid):
            self._map.show_house(house_of("", scene.grid, (), ()))
        self._map.show_rooms(scene.rooms if self.displays.shows(Display.ROOMS) else ())
        self._overlays.show(scene, self._selected, self.displays)
        self._map.show_robots([mark for robot in scene.robots if (mark := self._mark(robot)) is not None])

    def _mark(self, robot: RobotScene) -> RobotMark | None:
        """How a robot is drawn; not at all where nobody knows of its place."""
        place = robot.estimate or robot.truth
        if place is None:
            return None
        if robot.robot not in self._bodies and len(robot.footprint) >= 3 and robot.estimate is not None:
            self._bodies[robot.robot] = robot.estimate.inverse().transform(robot.footprint)
        on = self.displays.shows
        return RobotMark(
            robot=robot.robot,
            label=str(robot.robot + 1) if robot.name == robot_name(robot.robot) else robot.name,
            pose=place,
            footprint=self._bodies.get(robot.robot, ROUND),
            selected=robot.robot == self._selected,
            trouble=robot.trouble or robot.dead,
            trail=drawn(robot.estimate_path) if on(Display.PATHS) else NO_POINTS,
            way=robot.plan if on(Display.PLANS) else NO_POINTS,
            ellipse=robot.ellipse if on(Display.ELLIPSES) else None,
            truth=robot.truth if on(Display.TRUTH) else None,
        )

    def _show_lists(self) -> None:
        story = self._feed.story
        kinds: tuple[tuple[EntryKind, Log], ...] = (
            ("event", self.events),
            ("said", self.talk),
            ("line", self.lines),
            ("input", self.inputs),
            ("log", self.notes),
        )
        for kind, log in kinds:
            dropped, entries = story.dropped(kind), story.entries(kind)
            new = max(self._taken.get(kind, 0) - dropped, 0)
            log.extend([self._row(entry) for entry in entries[new : new + PORTION]])
            self._taken[kind] = dropped + min(new + PORTION, len(entries))
        told = sum(story.dropped(kind) + len(story.entries(kind)) for kind in ("event", "said"))
        if not self._feed.live and (told, self._feed.span) != self._marked:
            self._marked = told, self._feed.span
            self._marks = tuple(self._timeline_marks())
            self.transport.show_span(self._feed.span, self._marks)

    def _row(self, entry: Entry) -> Row:
        time = (entry.stamp_ns - self._feed.start_ns) / 1e9
        room = "" if entry.room is None else f"room {entry.room}" if entry.room else "corridor"
        match entry.kind:
            case "event":
                cells: tuple[str, ...] = (entry.who, entry.what, room, entry.text)
            case "said":
                cells = (entry.who, room or entry.what, entry.text)
            case "line":
                cells = (entry.what, entry.text)
            case "input" | "log":
                cells = (entry.who, entry.what, entry.text)
        return Row(time, cells, entry.robot)

    def _timeline_marks(self) -> Iterator[Mark]:
        start_ns = self._feed.start_ns
        for entry in self._feed.story.marks():
            room = f"room {entry.room}" if entry.room else ""
            text = " ".join(part for part in (entry.who, entry.what, room) if part)
            yield Mark((entry.stamp_ns - start_ns) / 1e9, text, entry.robot, talk=False)
        for entry in self._feed.story.entries("said"):
            yield Mark((entry.stamp_ns - start_ns) / 1e9, f"{entry.who}: {entry.text}", entry.robot, talk=True)

    def _show_figures(self, scene: Scene) -> None:
        rows = [
            RobotRow(
                each.name, each.state, each.error, each.deviation, each.energy, each.speed, each.trouble or each.dead
            )
            for each in scene.robots
        ]
        self.team.show_rows(rows, self._place(self._selected))
        self.wizard.show_wizard(scene.wizard, len(scene.robots))
        self.tell_waiting(len(scene.wizard.turns) + len(scene.wizard.advice))

    def _show_plots(self) -> None:
        if self._scene is not None and self.plots.isVisible():
            series = self._feed.series
            curves = [Curves(robot.robot, _figures(series.of(robot.robot))) for robot in self._scene.robots]
            self.plots.show_curves(curves, self._feed.span)
        self.plots.show_time(self._feed.time)

    # Robots

    @property
    def _name(self) -> str:
        return robot_name(self._selected).capitalize()

    def _place(self, robot: int) -> int:
        """Row of a robot in the list."""
        robots = () if self._scene is None else self._scene.robots
        return next((row for row, each in enumerate(robots) if each.robot == robot), -1)

    def _robot(self, robot: int) -> RobotScene | None:
        robots = () if self._scene is None else self._scene.robots
        return next((each for each in robots if each.robot == robot), None)

    def select(self, robot: int) -> None:
        """Have to do with this robot from now on."""
        if robot == self._selected:
            return
        self._selected = robot
        self.plots.select(robot)
        if self.follow.isChecked():
            self._map.follow(robot)
        self._take_tool(self.tool)

    def _choose_row(self, row: int) -> None:
        if self._scene is not None and row < len(self._scene.robots):
            self.select(self._scene.robots[row].robot)

    def _next_robot(self, step: int) -> None:
        if self._scene is not None and self._scene.robots:
            row = (self._place(self._selected) + step) % len(self._scene.robots)
            self._choose_row(row)
            self._show_figures(self._scene)

    def _follow(self, on: bool) -> None:
        self._map.follow(self._selected if on else None)

    def _fit(self) -> None:
        self.follow.setChecked(False)
        self._map.fit()

    # Time

    def _change_speed(self, step: int) -> None:
        nearest = min(range(len(SPEEDS)), key=lambda number: abs(SPEEDS[number] - self._feed.speed))
        self._feed.set_speed(SPEEDS[min(max(nearest + step, 0), len(SPEEDS) - 1)])

    def _jump(self, way: int) -> None:
        times = sorted(mark.time for mark in self._marks if not mark.talk)
        here = self._feed.time
        if way > 0:
            target = next((time for time in times if time > here + EPSILON), self._feed.span)
        else:
            target = next((time for time in reversed(times) if time < here - EPSILON), 0.0)
        self._feed.seek(target)

    # What is asked of the robots

    def _ask(self, make: Callable[[Tools, Scene, int], Wish | Refused], told: str) -> None:
        """Ask something of the robot selected."""
        if self._scene is not None:
            self._send(make(self._tools, self._scene, self._selected), told)

    def _send(self, wish: Wish | Refused, told: str) -> None:
        """Ask for something, and say that or why not."""
        refusal = wish.sentence if isinstance(wish, Refused) else self._feed.ask(wish)
        self.say(refusal or told.format(robot=self._name))

    def _ask_to_kill(self) -> None:
        box = QMessageBox(self)
        box.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        box.setIcon(QMessageBox.Icon.Warning)
        box.setWindowTitle("Kill a robot")
        box.setText(f"Kill {robot_name(self._selected)}?")
        box.setInformativeText("Its software stops and its motors brake, until it is revived. The record tells of it.")
        kill = box.addButton("Kill it", QMessageBox.ButtonRole.DestructiveRole)
        box.setDefaultButton(box.addButton("Leave it alive", QMessageBox.ButtonRole.RejectRole))
        kill.clicked.connect(lambda: self._ask(Tools.kill, "{robot} is to die."))
        box.open()

    def _puppeteer(self, robot: int, on: bool) -> None:
        if self._scene is not None:
            told = "You speak for {robot}." if on else "{robot} speaks for itself."
            self._send(self._tools.puppeteer(self._scene, robot, on), told.format(robot=robot_name(robot)))

    def _speak(self, turn: PendingTurn, move: int, text: str) -> None:
        if self._scene is not None:
            self._send(self._tools.speak(self._scene, turn, move, text), "Said.")

    def _advise(self, robot: int, room: int) -> None:
        if self._scene is not None:
            self._send(self._tools.advise(self._scene, robot, room), "Said.")

    def _take_tool(self, tool: Tool) -> None:
        self._preview.gesture = None
        self._map.set_tool(None if tool is Tool.LOOK else Qt.CursorShape.CrossCursor)
        self.how.setText(TOOLS[tool].how.format(robot=robot_name(self._selected)))
        self._map.update()

    def _press(self, x: float, y: float) -> None:
        if self.tool is Tool.CARRY:
            robot = self._robot_near(x, y)
            if robot is None:
                self.say("Nobody stands there: press on a robot to carry it.")
                return
            self.select(robot)
            self._preview.body = self._bodies.get(robot, ROUND)
        self._preview.shape = self.shape
        self._preview.heading = self._heading()
        self._preview.gesture = Gesture(self.tool, x, y, x, y)
        self._map.update()

    def _drag(self, x: float, y: float) -> None:
        begun = self._preview.gesture
        if begun is not None:
            self._preview.gesture = Gesture(begun.tool, begun.x, begun.y, x, y)
            self._map.update()

    def _release(self, x: float, y: float) -> None:
        self._drag(x, y)
        done, self._preview.gesture = self._preview.gesture, None
        if done is None or self._scene is None:
            return
        self._send(self._meant(done, self._scene), _TOLD[done.tool])
        if done.tool in {Tool.GOAL, Tool.POSE}:
            self.take(Tool.LOOK)

    def _meant(self, done: Gesture, scene: Scene) -> Wish | Refused:
        """What a stroke asks for."""
        tools = self._tools
        match done.tool:
            case Tool.GOAL | Tool.POSE:
                place = aimed(done.x, done.y, done.to_x, done.to_y, self._heading())
                make = tools.goal if done.tool is Tool.GOAL else tools.pose
                return make(scene, self._selected, place)
            case Tool.CARRY:
                return tools.carry(scene, self._selected, done.to_x, done.to_y)
            case _:
                hit = tools.remove(scene, done.x, done.y) if done.click else None
                put = tools.put(scene, self.shape, done.x, done.y, done.size)
                return put if hit is None or isinstance(hit, Refused) else hit

    def _heading(self) -> float:
        """Of the robot selected: the true one where it is carried, else as it believes."""
        robot = self._robot(self._selected)
        if robot is None:
            return 0.0
        pose = (robot.truth or robot.estimate) if self.tool is Tool.CARRY else (robot.estimate or robot.truth)
        return 0.0 if pose is None else pose.theta

    def _robot_near(self, x: float, y: float) -> int | None:
        """The robot whose body, or else whose belief, is there."""
        here = Pose2(x, y, 0.0)
        robots = () if self._scene is None else self._scene.robots
        near = [
            (pose.distance(here), robot.robot) for robot in robots for pose in (robot.truth, robot.estimate) if pose
        ]
        distance, robot = min(near, default=(math.inf, -1))
        return robot if distance <= max(REACH, GRIP / self._map.camera.scale) else None

    # Looks, and the end

    def set_palette(self, palette: Palette) -> None:
        """Other colours."""
        super().set_palette(palette)
        self._map.set_palette(palette)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Let go of the feed."""
        self._timer.stop()
        self._working.stop()
        self._feed.close()
        super().closeEvent(event)


class Sign(QLabel):
    """A sentence across the top of the map, as long as it holds."""

    def __init__(self, view: MapView) -> None:
        super().__init__(view)
        self.setAccessibleName("Trouble")
        self.setWordWrap(True)
        self.setMargin(8)
        panel(self)
        self.hide()

    def say(self, text: str) -> None:
        """Show a sentence; an empty one hides the sign."""
        if text == self.text() and self.isHidden() == (not text):
            return
        if text.partition("(")[0] != self.text().partition("(")[0]:
            QAccessible.updateAccessibility(QAccessibleAnnouncementEvent(self, text))
        self.setText(text)
        view = self.parentWidget()
        width = min(640, view.width() - 32) if view is not None else 640
        self.setFixedWidth(width)
        self.adjustSize()
        self.move(16, 16)
        self.setVisible(bool(text))


_TOLD = {
    Tool.GOAL: "{robot} is sent there.",
    Tool.POSE: "{robot} is told that it is there.",
    Tool.CARRY: "{robot} is carried there, and not told.",
    Tool.OBSTACLE: "Asked for; an obstacle appears as soon as its place is free.",
}


def _row_of(robot: RobotScene) -> RobotRow:
    trouble = robot.trouble or robot.dead
    return RobotRow(robot.name, robot.state, robot.error, robot.deviation, robot.energy, robot.speed, trouble)


def _figures(series: RobotSeries) -> dict[str, tuple[FloatArray, FloatArray]]:
    """What is plotted of a robot."""
    errors, doubts = series.errors.rows(), series.deviations.rows()
    energy, speeds = series.energy.rows(), series.speeds.rows()
    return {
        "error": (errors[:, 0], errors[:, 1]),
        "heading_error": (errors[:, 0], errors[:, 2]),
        "sigma": (doubts[:, 0], doubts[:, 1]),
        BAND: (doubts[:, 0], 2.0 * doubts[:, 1]),
        "energy": (energy[:, 0], energy[:, 1]),
        "speed": (speeds[:, 0], speeds[:, 1]),
    }
