"""Researcher's window. It passes the data of a feed to the window's parts, and people's actions to the feed."""

import math
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from PySide6.QtCore import QRectF, Qt, QTimer, Signal
from PySide6.QtGui import QCloseEvent, QImage
from PySide6.QtWidgets import QProgressDialog

from sim.common.robot_numbers import number_of, robot_name
from sim.numerics.float_array import FloatArray
from thbridge.files.errors import BadFile
from thbridge.files.grid_files import read_grid
from thbridge.recording.recordings import parts_of
from thbridge.roles.keeper.disclosed.floor_plan import floor_plan_of
from ui.model.shared.scene import RobotMark
from ui.model.shared.theme import Palette
from ui.model.watching.bookmarks import Bookmarks, clock
from ui.model.watching.curves import as_steps, broken
from ui.model.watching.scene import NO_POINTS, RobotScene, Scene, ShownLayers
from ui.model.watching.seat_rows import seat_rows, team_lines
from ui.model.watching.series import RobotSeries
from ui.sources.numbers import PlottedField
from ui.windows.map import MapView
from ui.windows.researcher.docked_window import DockedWindow
from ui.windows.researcher.docks.displays import MapDisplay
from ui.windows.researcher.docks.playback import SPEEDS
from ui.windows.researcher.docks.plots import BAND, PANELS, NumberCurve, RobotCurves
from ui.windows.researcher.docks.team import RobotRow
from ui.windows.researcher.feeds.feed import Feed
from ui.windows.researcher.log_updater import LogUpdater
from ui.windows.researcher.map.overlays import Overlays
from ui.windows.researcher.map.sign import TroubleSign
from ui.windows.researcher.pictures import NO_FFMPEG, VideoWriter, ffmpeg, image_of
from ui.windows.researcher.seat_windows import SeatWindows
from ui.windows.researcher.tool_controller import ToolController

FRAME = 33
"""Milliseconds between two frames of the map."""
SLOW, PLOTTED = 5, 2
"""Number of map frames between two updates of the lists, and between two updates of plots. Plots take turns."""
MARGIN = 3.0
"""Margin of the view around the robots if there is no map, meters."""
DEFAULT_FOOTPRINT: FloatArray = 0.2 * np.array(
    [[math.cos(a), math.sin(a)] for a in np.linspace(0.0, 2.0 * math.pi, 17)[:-1]]
)
"""Footprint of a robot that has not published its own footprint, meters."""


class ResearcherWindow(DockedWindow):
    """Window with a recording or a running session.

    Args:
        feed: source of all data shown.
        title: name of the session or recording.
        palette: the colors.
        clock: monotonic clock, seconds.

    Attributes:
        scene: scene on the map; None before there is one.
        sign: label on the map with a sentence about a problem.
        bookmarks: times that a person marked.

    Signals:
        bookmarked: the bookmarks have changed.
    """

    bookmarked = Signal()

    def __init__(self, feed: Feed, title: str, palette: Palette, clock: Callable[[], float]) -> None:
        self._map = MapView(palette, axes=True)
        super().__init__(title, palette, feed.live, self._map)
        self._feed = feed
        self._transport = feed.transport
        self._clock = clock
        self._selected = 0
        self._generation = feed.data.generation
        self.scene: Scene | None = None
        self.bookmarks = Bookmarks()
        self._ended_bag: str | None = None
        self._contents_shown = feed.live
        self._has_seats = False
        self._seat_windows = SeatWindows(self.show_status, self)
        self._plotted: tuple[int, ...] = ()
        self._bodies: dict[int, FloatArray] = {}
        self._frames = 0
        self._overlays = Overlays(self._map.box)
        self._tool_controller = ToolController(feed, self, self._map, self._bodies, self.select)
        self._log_updater = LogUpdater(feed, self)
        # The label is a child of the viewport, because screen readers do not find widgets in the map itself.
        self.sign = TroubleSign(self._map.viewport())
        self._connect()
        self._tool_controller.use_tool(self.tool)
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
        feed, transport, bar = self._feed, self._transport, self.playback
        bar.play_toggled.connect(lambda: transport.play(not transport.playing))
        bar.stepped.connect(transport.step)
        bar.speed_chosen.connect(transport.set_speed)
        bar.seek.connect(transport.seek)
        self.speed_stepped.connect(self._change_speed)
        self.jumped.connect(self._jump)
        bar.recording_wanted.connect(lambda: self.source_chosen.emit(feed.ended_bag or ""))
        bar.refused.connect(self.show_status)
        self.bookmark_toggled.connect(self._change_bookmark)
        self.bookmark_chosen.connect(transport.seek)
        self.loop_toggled.connect(self._loop)
        self.jumped_to_end.connect(lambda direction: transport.seek(0.0 if direction < 0 else transport.span))
        self.plots.seek.connect(transport.seek)
        for log in self.logs.values():
            log.chosen.connect(transport.seek)
        self.arguments.chosen.connect(transport.seek)
        self.seats.wanted.connect(self._take_seat)
        self.team.selected.connect(self._choose_row)
        self.robot_stepped.connect(self._next_robot)
        self.follow_toggled.connect(self._follow)
        self._map.follow_ended.connect(lambda: self.follow.setChecked(False))
        self.fit.connect(self._fit)
        self._map.robot_clicked.connect(self.select)
        self.topics.opened.connect(self._list_numbers)
        self.topics.chosen.connect(self._choose_numbers)
        self.map_chosen.connect(self._load_map)
        self.video_wanted.connect(self._ask_video)
        self.section_wanted.connect(self._ask_section)

    # Each frame

    def refresh(self) -> None:
        """Show all changes since the last frame."""
        feed, now = self._feed, self._clock()
        feed.advance(now)
        if feed.data.generation != self._generation:
            self._restart()
        scene = feed.scene(self._shown())
        if scene is not None:
            self._show_map(scene)
            self._show_contents(scene)
        self.sign.show_sentence(feed.trouble())
        for notice in feed.take_notices():
            self.show_status(notice)
        if feed.ended_bag != self._ended_bag:
            self._show_end(feed.ended_bag)
        time = self._transport.time
        self.playback.show_time(time)
        self.playback.show_playing(self._transport.playing)
        self.playback.show_speed(self._transport.speed)
        self.playback.show_state(feed.state(now))
        self._frames += 1
        if self._frames % SLOW == 1:
            self._log_updater.show()
            if scene is not None:
                self._show_figures(scene)
        if self._frames % PLOTTED == 1:
            turn = self._frames // PLOTTED % (len(PANELS) + 1)
            if turn < len(PANELS):
                self._show_plots(PANELS[turn].name)
            else:
                self._show_numbers()
        for log in self.logs.values():
            log.show_time(time)

    def _work(self) -> None:
        self._working.setInterval(0 if self._feed.work() else FRAME)

    def _restart(self) -> None:
        self._generation = self._feed.data.generation
        self.scene = self._tool_controller.scene = None
        self._bodies.clear()
        self.plots.clear()
        self._log_updater.clear()

    def _shown(self) -> ShownLayers:
        on = self.displays.shows
        return ShownLayers(
            selected=self._selected,
            clouds=on(MapDisplay.CLOUDS),
            scans=on(MapDisplay.SCANS),
            global_costmap=on(MapDisplay.GLOBAL_COSTMAP),
            local_costmap=on(MapDisplay.LOCAL_COSTMAP),
            plans=on(MapDisplay.PLANS) or on(MapDisplay.LOCAL_PLANS),
            paths=on(MapDisplay.PATHS) or on(MapDisplay.TRUE_PATHS) or on(MapDisplay.ODOMETRY),
        )

    def _show_map(self, scene: Scene) -> None:
        before, self.scene, self._tool_controller.scene = self.scene, scene, scene
        if scene.grid is not None and (before is None or before.grid is not scene.grid):
            self._map.show_floor_plan(floor_plan_of("", scene.grid, (), ()))
        if scene.grid is None:
            self._widen(scene)
        self._map.show_rooms(scene.rooms if self.displays.shows(MapDisplay.ROOMS) else ())
        self._overlays.show(scene, self._selected, self.displays)
        self._map.show_robots([mark for robot in scene.robots if (mark := self._mark(robot)) is not None])

    def _widen(self, scene: Scene) -> None:
        """If there is no map, extend the view to all robots shown so far."""
        box = self._map.box
        places = [place for robot in scene.robots if (place := robot.estimate or robot.truth) is not None]
        for place in places:
            if not box.bounds.contains(place.x, place.y):
                box.bounds = box.bounds.united(QRectF(place.x - MARGIN, place.y - MARGIN, 2.0 * MARGIN, 2.0 * MARGIN))
                if box.fitted:
                    box.fit()

    def _mark(self, robot: RobotScene) -> RobotMark | None:
        """Return the mark of a robot on the map; None if its pose is unknown."""
        place = robot.estimate or robot.truth
        if place is None:
            return None
        if robot.robot not in self._bodies and len(robot.footprint) >= 3 and robot.estimate is not None:
            self._bodies[robot.robot] = robot.estimate.inverse().transform(robot.footprint)
        on = self.displays.shows
        return RobotMark(
            robot=robot.robot,
            label=str(number_of(robot.robot)) if robot.name == robot_name(robot.robot) else robot.name,
            pose=place,
            footprint=self._bodies.get(robot.robot, DEFAULT_FOOTPRINT),
            selected=robot.robot == self._selected,
            trouble=robot.trouble or robot.dead,
            trail=robot.estimate_path if on(MapDisplay.PATHS) else NO_POINTS,
            path=robot.plan if on(MapDisplay.PLANS) else NO_POINTS,
            ellipse=robot.ellipse if on(MapDisplay.ELLIPSES) else None,
            truth=robot.truth if on(MapDisplay.TRUTH) else None,
            commander=robot.commander,
        )

    def _show_figures(self, scene: Scene) -> None:
        self.team.show_rows([_row_of(robot) for robot in scene.robots], self._place(self._selected))
        self._show_seats()
        self.wizard.show_wizard(scene.wizard, len(scene.robots), self._feed.data.log.room_names)
        if self.arguments.isVisible():
            self._show_arguments()
        self.show_waiting(len(scene.wizard.turns) + len(scene.wizard.advice))

    def _show_seats(self) -> None:
        """Show the seats of the game at the time shown; the dock appears with the first game that has seats."""
        feed = self._feed
        log, start_ns = feed.data.log, feed.data.start_ns
        state = log.seats.at(start_ns + round(self._transport.time * 1e9))
        if state.seats and not self._has_seats:
            self._has_seats = True
            self.add_seats_dock()
        if self.seats.isVisible():
            self.seats.show_seats(seat_rows(state), team_lines(state, log.room_names, start_ns), feed.no_seat)

    def _take_seat(self, seat: str) -> None:
        """Open the participant's window for a seat, in which the researcher plays in the place of its person."""
        command = self._feed.seat_command(seat)
        self.show_status(command if isinstance(command, str) else self._seat_windows.open(seat, command))

    def _show_arguments(self) -> None:
        feed = self._feed
        course = feed.data.log.dialogue(self._selected, feed.data.start_ns + round(self._transport.time * 1e9))
        self.arguments.show_course(self._selected, course, feed.data.start_ns)

    def _show_plots(self, panel: str) -> None:
        if self.scene is not None and self.plots.isVisible():
            series = self._feed.data.series
            curves = [
                RobotCurves(robot.robot, robot.name, _figures(series.of(robot.robot), panel, series.gaps))
                for robot in self.scene.robots
            ]
            self.plots.show_curves(curves, self._transport.span)
            self.plots.show_joined(self._feed.data.known_since)
        self.plots.show_time(self._transport.time)

    def _show_end(self, bag: str | None) -> None:
        """Show that the session has ended, and offer its recording.

        If `bag` is None, another session has started, and the offer is hidden.
        """
        self._ended_bag = bag
        here = bool(bag) and any(part.exists() for part in parts_of(Path(bag or "")))
        self.playback.show_recording((bag or "") if here else "")
        if bag is not None:
            recorded = f" Its recording: {bag}" if bag else " It was not recorded."
            self.show_status(f"The session has ended.{recorded}", 3600.0)

    # Contents of recordings

    def _show_contents(self, scene: Scene) -> None:
        """List the topics when the recording is open. For another program's recording, bring the list to the front."""
        numbers = self._feed.data.numbers
        if self._contents_shown or numbers is None:
            return
        self._contents_shown = True
        self.topics.show_topics(numbers.topics)
        if self._feed.data.foreign:
            self.show_contents(drawable=scene.grid is not None or bool(scene.robots))

    def _list_numbers(self, topic: str) -> None:
        if self._feed.data.numbers is None:
            return
        try:
            self.topics.show_numbers(topic, self._feed.data.numbers.fields(topic))
        except BadFile as fault:
            self.show_status(str(fault))

    def _choose_numbers(self, chosen: tuple[PlottedField, ...]) -> None:
        if self._feed.data.numbers is not None:
            self._feed.data.numbers.choose(chosen)
            self._plotted = ()
            self._show_numbers()
            self.raise_dock("Plots")

    def _show_numbers(self) -> None:
        numbers = self._feed.data.numbers
        if numbers is None:
            return
        curves = [(number, *numbers.curve(number)) for number in numbers.chosen]
        lengths = tuple(len(times) for _, times, _ in curves)
        if lengths != self._plotted:
            self._plotted = lengths
            self.plots.show_numbers(
                [NumberCurve(_plot_of(each), each.name, *curve) for each, *curve in curves], self._transport.span
            )

    def _load_map(self, path: Path) -> None:
        try:
            self._feed.use_map(read_grid(path))
        except BadFile as fault:
            self.show_status(str(fault))
            return
        self.show_contents(drawable=True)
        self._fit()
        self.show_status(f"Showing the map {path.name} with the recording.")

    # Sections of recordings

    def _section(self) -> tuple[float, float]:
        """Return the section to save: between the bookmarks around the time shown, or the whole recording."""
        return self.bookmarks.around(self._transport.time) or (0.0, self._transport.span)

    def _ask_section(self) -> None:
        start, end = self._section()
        path = self.ask_target(f"Save {clock(start)} to {clock(end)} as a bag", "section.bag", "Bags (*.bag)")
        if path is not None:
            self.show_status(self._feed.save_section(path, start, end) or f"Saving {path}")

    def _ask_video(self) -> None:
        program, (start, end) = ffmpeg(), self._section()
        if program is None:
            self.show_status(NO_FFMPEG)
            return
        title = f"Save {clock(start)} to {clock(end)} as a video"
        path = self.ask_target(title, "section.mp4", "Videos (*.mp4 *.gif)")
        if path is not None:
            self.save_video(path, (start, end), program)

    def save_video(self, path: Path, span: tuple[float, float], program: str) -> VideoWriter:
        """Save a video of the middle of the window over a time span with ffmpeg."""
        before, part = self._transport.time, self.canvas if self.canvas.isVisible() else self.plots.canvas
        self._transport.play(False)

        def frame(time: float) -> QImage:
            self._transport.seek(time)
            self.refresh()
            return image_of(part)

        writer = VideoWriter(path, span, frame, program, self)
        box = QProgressDialog(f"Saving {path.name}", "Cancel", 0, 1000, self)
        box.setWindowModality(Qt.WindowModality.WindowModal)
        writer.progressed.connect(lambda share: box.setValue(min(999, round(1000 * share))))
        box.canceled.connect(writer.cancel)
        writer.ended.connect(lambda problem: self.show_status(problem or f"Saved: {path}"))
        writer.ended.connect(lambda _: box.reset())
        for over in (writer.ended, box.canceled):
            over.connect(lambda *_: self._transport.seek(before))
        box.setValue(0)
        return writer

    # Robots

    def _place(self, robot: int) -> int:
        """Return the row of a robot in the list; -1 if the robot is not in the list."""
        robots = () if self.scene is None else self.scene.robots
        return next((row for row, each in enumerate(robots) if each.robot == robot), -1)

    def select(self, robot: int) -> None:
        """Select this robot."""
        if robot == self._selected:
            return
        self._selected = self._tool_controller.selected = robot
        self.plots.select(robot)
        if self.follow.isChecked():
            self._map.follow(robot)
        self._tool_controller.use_tool(self.tool)

    def _choose_row(self, row: int) -> None:
        if self.scene is not None and row < len(self.scene.robots):
            self.select(self.scene.robots[row].robot)

    def _next_robot(self, step: int) -> None:
        if self.scene is not None and self.scene.robots:
            row = (self._place(self._selected) + step) % len(self.scene.robots)
            self._choose_row(row)
            self._show_figures(self.scene)

    def _follow(self, on: bool) -> None:
        self._map.follow(self._selected if on else None)

    def _fit(self) -> None:
        self.follow.setChecked(False)
        self._map.fit()

    # Time

    def use_bookmarks(self, times: Sequence[float]) -> None:
        """Show these bookmarks, seconds since the beginning. They replace all earlier bookmarks."""
        self.bookmarks = Bookmarks(times)
        self._show_bookmarks(None)

    def _change_bookmark(self) -> None:
        is_set = self.bookmarks.toggle(self._transport.time)
        self.show_status(f"Bookmark at {clock(self._transport.time)} {'set' if is_set else 'removed'}.")
        self._show_bookmarks(None)
        self.bookmarked.emit()

    def _loop(self, on: bool) -> None:
        span = self.bookmarks.around(self._transport.time) if on else None
        if on and span is None:
            self.show_status(
                "A loop needs two bookmarks. Go to a time and press B. Then go to another time and press B again."
            )
        self._show_bookmarks(span)
        if span is not None:
            self._transport.seek(span[0])
            self._transport.play(True)

    def _show_bookmarks(self, loop: tuple[float, float] | None) -> None:
        self._transport.loop(loop)
        self.loop.setChecked(loop is not None)
        self.show_bookmarks(self.bookmarks.times)
        self.playback.timeline.set_bookmarks(self.bookmarks.times, loop)

    def _jump(self, direction: int) -> None:
        self._transport.seek(self._log_updater.neighbouring_mark(direction, self.bookmarks.times))

    def _change_speed(self, step: int) -> None:
        nearest = min(range(len(SPEEDS)), key=lambda number: abs(SPEEDS[number] - self._transport.speed))
        self._transport.set_speed(SPEEDS[min(max(nearest + step, 0), len(SPEEDS) - 1)])

    # Colors and closing

    def set_palette(self, palette: Palette) -> None:
        """Use these colors for the map and the plots. All other parts use the application's palette."""
        self._map.set_palette(palette)
        self.plots.set_palette(palette)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Close the feed."""
        self._timer.stop()
        self._working.stop()
        self._feed.close()
        self._seat_windows.close()
        super().closeEvent(event)
        self.closed.emit()


def _row_of(robot: RobotScene) -> RobotRow:
    trouble = robot.trouble or robot.dead
    state = f"{robot.state} · commanded by {robot.commander}".removeprefix(" · ") if robot.commander else robot.state
    return RobotRow(robot.name, state, robot.error, robot.deviation, robot.energy, robot.speed, trouble)


def _plot_of(number: PlottedField) -> str:
    """Return the title of a number's plot.

    Numbers of a topic with the same unit share a plot. The elements of an array also share a plot.
    """
    if number.unit:
        return f"{number.topic}, {number.unit}"
    return f"{number.topic} {number.column}"


def _figures(series: RobotSeries, panel: str, gaps: Sequence[float]) -> dict[str, tuple[FloatArray, FloatArray]]:
    """Return the curves of a robot in one panel. For the error, also return the band of two standard deviations.

    Args:
        series: series of the robot.
        panel: name of the panel.
        gaps: times after which no messages arrived for a while; the curves have gaps there.
    """
    match panel:
        case "error":
            errors, doubts = broken(series.errors.rows(), gaps), _admitted(series, gaps)
            return {panel: (errors[:, 0], errors[:, 1]), BAND: (doubts[:, 0], 2.0 * doubts[:, 1])}
        case "heading_error":
            rows, column = broken(series.errors.rows(), gaps), 2
        case "sigma":
            rows, column = _admitted(series, gaps), 1
        case "energy":
            rows, column = broken(series.energy.rows(), gaps), 1
        case _:
            rows, column = broken(series.speeds.rows(), gaps), 1
    return {panel: (rows[:, 0], rows[:, column])}


def _admitted(series: RobotSeries, gaps: Sequence[float]) -> FloatArray:
    """Return the standard deviations as steps. A standing robot publishes none, and its last values remain valid."""
    return as_steps(broken(series.deviations.rows(), gaps), series.estimate.time)
