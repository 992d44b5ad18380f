"""Layout of the researcher's window: the map in the middle, all other parts in docks that can be moved and closed."""

from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise
from pathlib import Path

from PySide6.QtCore import QEvent, QObject, QSize, Qt, QTimer, Signal
from PySide6.QtGui import (
    QAccessible,
    QAccessibleAnnouncementEvent,
    QAction,
    QActionGroup,
    QDragEnterEvent,
    QDropEvent,
    QKeyEvent,
    QKeySequence,
    QResizeEvent,
)
from PySide6.QtWidgets import (
    QAbstractButton,
    QApplication,
    QComboBox,
    QDockWidget,
    QFileDialog,
    QGraphicsView,
    QMainWindow,
    QMenu,
    QSizePolicy,
    QStackedWidget,
    QTabBar,
    QToolBar,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from ui.model.playing.keys import SETTINGS_KEYS
from ui.model.shared.theme import Palette
from ui.model.watching.bookmarks import clock
from ui.model.watching.scene import EntryKind
from ui.model.watching.tools import Shape
from ui.windows.controls import ChoiceBox
from ui.windows.key_sheet import KeySheet
from ui.windows.look import open_within_screen
from ui.windows.researcher.docks.arguments import ArgumentsDock
from ui.windows.researcher.docks.displays import SWITCHES, DisplaysPanel
from ui.windows.researcher.docks.log import LogView
from ui.windows.researcher.docks.playback import PlaybackBar
from ui.windows.researcher.docks.plots import Plots
from ui.windows.researcher.docks.seats import SeatsDock
from ui.windows.researcher.docks.team import TeamTable
from ui.windows.researcher.docks.topics import TopicTree
from ui.windows.researcher.docks.wizard import WizardDock
from ui.windows.researcher.keys import GROUPS
from ui.windows.researcher.map.tools import TOOLS, MapTool
from ui.windows.researcher.pictures import copy_picture, save_picture
from ui.windows.untrusted_text import PlainLabel, title_text

LEFT, RIGHT, BOTTOM = (
    Qt.DockWidgetArea.LeftDockWidgetArea,
    Qt.DockWidgetArea.RightDockWidgetArea,
    Qt.DockWidgetArea.BottomDockWidgetArea,
)

LISTS: dict[EntryKind, tuple[str, str, tuple[str, ...]]] = {
    "line": ("Lines", "Lines of the protocol", ("Topic", "Line")),
    "said": ("Dialogue", "Dialogue", ("Speaker", "Subject", "Sentence")),
    "event": ("Events", "Events", ("Source", "Event", "Room", "Details")),
    "input": ("Inputs", "Inputs", ("Sender", "Kind", "Content")),
    "log": ("Log", "Log of ROS nodes", ("Node", "Level", "Text")),
}
"""Lists in the order of their tabs. Each has the title of the tab, the name of the list, and the columns after the
time."""

_WANTED = QSize(1480, 940)
"""Size of the window on a large screen. On a smaller screen, all parts are smaller."""


class DockedWindow(QMainWindow):
    """Window with parts, buttons and keys. A subclass supplies the data and the actions.

    Args:
        title: name of the session or recording.
        palette: the colors.
        live: True for a running session, False for a recording.
        canvas: the map.

    Signals:
        tool_selected: a person selected this tool.
        robot_stepped: select the next (1) or the previous (-1) robot.
        kill, revive, clear_costmaps, follow_toggled, fit: a person pressed the button of this name.
        speed_stepped: play faster (1) or slower (-1).
        jumped: go to the next (1) or the previous (-1) mark.
        jumped_to_end: go to the end (1) or the beginning (-1).
        bookmark_toggled: set a bookmark at the time shown, or remove it.
        bookmark_chosen: go to this bookmark, seconds since the beginning.
        loop_toggled: start or stop playing repeatedly between two bookmarks.
        video_wanted: save a section of the recording as a video.
        section_wanted: save a section of the recording as a bag.
        map_chosen: show the map of this `map.yaml`.
        open_wanted: a person wants to open another recording or session.
        settings_wanted: a person wants to open the settings.
        source_chosen: a person wants to open this path of a dropped file, or the recording of the ended session.
        closed: the window was closed.
    """

    tool_selected = Signal(object)
    robot_stepped = Signal(int)
    kill = Signal()
    revive = Signal()
    clear_costmaps = Signal()
    follow_toggled = Signal(bool)
    fit = Signal()
    speed_stepped = Signal(int)
    jumped = Signal(int)
    jumped_to_end = Signal(int)
    bookmark_toggled = Signal()
    bookmark_chosen = Signal(float)
    loop_toggled = Signal(bool)
    video_wanted = Signal()
    section_wanted = Signal()
    map_chosen = Signal(object)
    open_wanted = Signal()
    settings_wanted = Signal()
    source_chosen = Signal(str)
    closed = Signal()

    def __init__(self, title: str, palette: Palette, live: bool, canvas: QWidget) -> None:
        super().__init__()
        self.setWindowTitle(f"{title_text(title)} - thbridge watch")
        self.setDockNestingEnabled(True)
        self.setAcceptDrops(True)
        open_within_screen(self, _WANTED)
        self.canvas = canvas
        self.playback = PlaybackBar(live)
        self.displays = DisplaysPanel()
        self.team = TeamTable()
        self.plots = Plots(palette, live)
        self.logs = {kind: LogView(name, columns) for kind, (_, name, columns) in LISTS.items()}
        self.topics = TopicTree()
        self.arguments = ArgumentsDock()
        self.wizard = WizardDock()
        self.seats = SeatsDock(live)
        self.seats.setParent(self)
        self.seats.hide()
        self.tool = MapTool.LOOK
        self._tool_actions: dict[MapTool, QAction] = {}
        self._robot_actions: list[QAction] = []
        self._center = QStackedWidget()
        self._center.addWidget(canvas)
        self.setCentralWidget(self._center)
        self._add_docks(live)
        self._add_tools(live)
        self._add_time()
        self._add_keys(live)
        self.tool_help = PlainLabel()
        self.tool_help.setAccessibleDescription("Instructions for the selected tool")
        self.statusBar().addPermanentWidget(self.tool_help)
        self.statusBar().messageChanged.connect(lambda text: self.statusBar().setAccessibleName(text))
        canvas.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        canvas.installEventFilter(self)
        canvas.setFocus()
        self._order_focus()
        for view in self.findChildren(QGraphicsView):
            # Without this, the scenes of these views would receive dropped files instead of the window.
            view.setAcceptDrops(False)
            view.viewport().setAcceptDrops(False)

    # Contents

    @property
    def shape(self) -> Shape:
        """Shape of the next obstacle."""
        return "box" if self._shape.currentIndex() else "circle"

    @property
    def tool_actions(self) -> tuple[QAction, ...]:
        """Actions of the toolbar that send requests to the robots."""
        return (
            *(action for tool, action in self._tool_actions.items() if tool is not MapTool.LOOK),
            *self._robot_actions,
        )

    def show_status(self, text: str, seconds: float = 8.0) -> None:
        """Show a sentence in the status bar, and announce it to screen readers."""
        self.statusBar().showMessage(text, round(seconds * 1000.0))
        QAccessible.updateAccessibility(QAccessibleAnnouncementEvent(self, text))

    def select_tool(self, tool: MapTool) -> None:
        """Select a tool as if its button were pressed."""
        self._tool_actions[tool].trigger()

    def show_waiting(self, things: int) -> None:
        """Show the number of waiting turns on the wizard's tab."""
        self._docks[-1].setWindowTitle(f"Wizard ({things} waiting)" if things else "Wizard")

    def disable_tools(self, reason: str) -> None:
        """Disable all actions that send requests to the robots. Their tool tips show this reason."""
        for action in self.tool_actions:
            action.setEnabled(False)
            action.setToolTip(reason)
        self._shape.setEnabled(False)
        self._shape.setToolTip(reason)
        self.wizard.refuse(reason)

    def show_contents(self, drawable: bool) -> None:
        """Show the topics of a recording in their dock, or in place of the map if there is no map to draw."""
        topics, plots = self.dock("Topics"), self.dock("Plots")
        if drawable:
            topics.setWidget(self.topics)
            self._center.setCurrentWidget(self.canvas)
            self.raise_dock("Topics")
        else:
            self._center.addWidget(self.topics)
            self._center.setCurrentWidget(self.topics)
        self.tool_help.setVisible(drawable)
        for dock in self._docks:
            dock.setVisible(drawable or dock is plots)
        self.topics.show()
        # Qt moves the tabs of hidden docks far outside the window, but the Tab key would reach them there.
        for tabs in self.findChildren(QTabBar):
            tabs.setFocusPolicy(Qt.FocusPolicy.TabFocus if drawable else Qt.FocusPolicy.NoFocus)
        if drawable:
            self._size_docks()
        else:
            self.resizeDocks([plots], [self.width() // 2], Qt.Orientation.Horizontal)

    def add_seats_dock(self) -> None:
        """Add the dock of the seats next to the plots, in front. Windows of games with one participant have none."""
        dock = self._dock("Seats", self.seats, keeps_room=True)
        self.tabifyDockWidget(self.dock("Arguments"), dock)
        self._docks.insert(-1, dock)
        self._panes.addAction(dock.toggleViewAction())
        if (layout := self.layout()) is not None:
            layout.activate()
        for tabs in self.findChildren(QTabBar):
            tabs.setAccessibleName("Panes")
        self._order_focus()
        QTimer.singleShot(0, dock.raise_)  # Qt has the tab of a new dock only after its layout.

    def dock(self, title: str) -> QDockWidget:
        """Return the dock with this title."""
        return next(dock for dock in self._docks if dock.objectName() == title)

    def raise_dock(self, title: str) -> None:
        """Bring the dock with this title to the front of its group of tabs."""
        dock = self.dock(title)
        dock.show()
        dock.raise_()

    # Layout

    def _add_docks(self, live: bool) -> None:
        self.setCorner(Qt.Corner.BottomLeftCorner, LEFT)
        self.setCorner(Qt.Corner.BottomRightCorner, RIGHT)
        self._docks = [
            self._dock("Robots", self.team, LEFT),
            self._dock("Displays", self.displays, LEFT),
            self._dock("Plots", self.plots, RIGHT, keeps_room=True),
            self._dock("Arguments", self.arguments, keeps_room=True),
        ]
        figures = self._docks[2:]
        bottom = [*(self._dock(LISTS[kind][0], log, BOTTOM) for kind, log in self.logs.items())]
        if live:
            # A session has no dock for topics. The widgets of this dock need a parent to be deleted with the window.
            self.topics.setParent(self)
            self.topics.hide()
        else:
            bottom.append(self._dock("Topics", self.topics, BOTTOM))
        bottom.append(self._dock("Wizard", self.wizard, BOTTOM))
        self.wizard.hide()  # Hide this part until its tab is in front, so that it does not enlarge the window.
        for group in (bottom, figures):
            for before, after in pairwise(group):
                self.tabifyDockWidget(before, after)
            group[0].raise_()
            # Without this, Qt leaves a second row of tabs behind when the next group of tabs is created.
            if (layout := self.layout()) is not None:
                layout.activate()
        for tabs in self.findChildren(QTabBar):
            tabs.setAccessibleName("Panes")
        self._docks += bottom
        self._size_docks()

    def _size_docks(self) -> None:
        """Give the docks their usual shares of the window."""
        robots, displays, plots, bottom = self._docks[0], self._docks[1], self._docks[2], self._docks[4]
        wide, high = self.width() / _WANTED.width(), self.height() / _WANTED.height()
        self.resizeDocks([robots, plots], [round(380 * wide), round(400 * wide)], Qt.Orientation.Horizontal)
        self.resizeDocks([robots, displays], [round(260 * high), round(460 * high)], Qt.Orientation.Vertical)
        self.resizeDocks([bottom], [round(265 * high)], Qt.Orientation.Vertical)

    def _order_focus(self) -> None:
        """Let Tab follow the reading order: tools, left docks, map, right docks, lower docks."""
        parts: list[QWidget] = [*self.findChildren(QToolBar, "Tools"), *self._docks[:2], self.canvas, *self._docks[2:]]
        parts += [*self.findChildren(QTabBar), self.playback]
        stops = [
            widget
            for part in parts
            for widget in (part, *part.findChildren(QWidget))
            if widget.focusPolicy() & Qt.FocusPolicy.TabFocus and not widget.isWindow() and widget.window() is self
        ]
        for before, after in pairwise(stops):
            self.setTabOrder(before, after)

    def _dock(
        self, title: str, part: QWidget, area: Qt.DockWidgetArea | None = None, *, keeps_room: bool = False
    ) -> QDockWidget:
        """Return a new dock.

        Args:
            title: title and object name of the dock.
            part: content of the dock.
            area: side of the window. If None, the caller makes the dock a tab of another dock.
            keeps_room: True to keep the part's space while another tab is in front; False to let the group of tabs
                shrink.
        """
        dock = QDockWidget(title, self)
        dock.setObjectName(title)
        content = part
        if keeps_room:
            content = QWidget()
            rows = QVBoxLayout(content)
            rows.setContentsMargins(0, 0, 0, 0)
            rows.addWidget(part)
        dock.setWidget(content)
        # Qt moves parts behind another tab far outside the window, but the Tab key would reach them there.
        dock.visibilityChanged.connect(part.setVisible)
        if area is not None:
            self.addDockWidget(area, dock)
        return dock

    def _add_time(self) -> None:
        bar = QToolBar("Time", self)
        bar.setMovable(False)
        bar.addWidget(self.playback)
        self.addToolBar(Qt.ToolBarArea.BottomToolBarArea, bar)

    def _add_tools(self, live: bool) -> None:
        bar = QToolBar("Tools", self)
        bar.setObjectName("Tools")
        bar.setMovable(False)
        bar.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextOnly)
        self.addToolBar(bar)
        bar.addWidget(self._menu_button("File", "Open, save and copy", self._file_menu(live)))
        group = QActionGroup(self)
        for tool, tool_help in TOOLS.items():
            label = f"{tool_help.label} ({tool_help.key})"
            action = self._action(label, tool_help.key, partial(self._tool_chosen, tool))
            action.setCheckable(True)
            action.setChecked(tool is MapTool.LOOK)
            action.setToolTip(tool_help.how.format(robot="the selected robot"))
            group.addAction(action)
            bar.addAction(action)
            self._tool_actions[tool] = action
        self._shape = ChoiceBox()
        self._shape.addItems(["round", "box"])
        self._shape.setAccessibleName("Shape of the next obstacle")
        self._shape.setToolTip("Shape of the next obstacle")
        bar.addWidget(self._shape)
        bar.addSeparator()
        for label, key, tip, signal in (
            ("Kill", "Delete", "Stop the software of the selected robot until you revive the robot", self.kill),
            ("Revive", "R", "Restart the software of a dead robot", self.revive),
            ("Clear costmaps", "C", "Clear the obstacles that the selected robot remembers", self.clear_costmaps),
        ):
            action = self._action(f"{label} ({key})", key, signal.emit)
            action.setToolTip(tip)
            bar.addAction(action)
            self._robot_actions.append(action)
        bar.addSeparator()
        self.follow = self._action("Follow (F)", "F", lambda: self.follow_toggled.emit(self.follow.isChecked()))
        self.follow.setCheckable(True)
        self.follow.setToolTip("Keep the selected robot in the middle of the map")
        bar.addAction(self.follow)
        whole_map = self._action("All (A)", "A", self.fit.emit)
        whole_map.setToolTip("Show the whole map")
        bar.addAction(whole_map)
        spacer = QWidget()
        spacer.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        bar.addWidget(spacer)
        if not live:
            bar.addWidget(self._menu_button("Bookmarks", "Set, remove and visit bookmarks", self._bookmark_menu()))
        self._panes = QMenu(self)
        for dock in self._docks:
            self._panes.addAction(dock.toggleViewAction())
        bar.addWidget(self._menu_button("Panes", "Show or hide parts of the window", self._panes))
        bar.addAction(self._action("Keys (F1)", "F1", self.show_keys))

    def _file_menu(self, live: bool) -> QMenu:
        menu = QMenu(self)
        menu.addAction(self._action("Open…", "Ctrl+O", self.open_wanted.emit))
        if not live:
            menu.addAction(self._action("Load a map…", "", self._choose_map))
        for name, part in (("map", self.canvas), ("plots", self.plots.canvas)):
            menu.addSeparator()
            menu.addAction(self._action(f"Copy the {name}", "", partial(self._copy, name, part)))
            menu.addAction(self._action(f"Save the {name}…", "", partial(self._save, name, part)))
        if not live:
            menu.addSeparator()
            menu.addAction(self._action("Save a section as a video…", "", self.video_wanted.emit))
            menu.addAction(self._action("Save a section as a bag…", "", self.section_wanted.emit))
        menu.addSeparator()
        menu.addAction(self._action(f"Settings… ({SETTINGS_KEYS})", "", self.settings_wanted.emit))
        return menu

    def _copy(self, name: str, part: QWidget) -> None:
        copy_picture(part)
        self.show_status(f"Copied the {name}.")

    def _save(self, name: str, part: QWidget) -> None:
        path = self.ask_target(f"Save the {name}", f"{name}.png", "Pictures (*.png *.svg)")
        if path is not None:
            self.show_status(save_picture(part, path) or f"Saved: {path}")

    def ask_target(self, title: str, suggested: str, kinds: str) -> Path | None:
        """Ask for the file to write; return None if the person cancels.

        A name without a suffix gets the suggested suffix.
        """
        chosen, _ = QFileDialog.getSaveFileName(self, title, suggested, kinds)
        path = Path(chosen)
        return None if not chosen else path if path.suffix else path.with_suffix(Path(suggested).suffix)

    def _choose_map(self) -> None:
        chosen, _ = QFileDialog.getOpenFileName(self, "Load a map", "", "Maps of map_server (*.yaml *.yml)")
        if chosen:
            self.map_chosen.emit(Path(chosen))

    def _bookmark_menu(self) -> QMenu:
        self._bookmarks = QMenu(self)
        self._toggle_bookmark = self._action("Set or remove a bookmark at this time", "B", self.bookmark_toggled.emit)
        self.loop = self._action(
            "Loop between two bookmarks", "L", lambda: self.loop_toggled.emit(self.loop.isChecked())
        )
        self.loop.setCheckable(True)
        self.show_bookmarks(())
        return self._bookmarks

    def show_bookmarks(self, times: Sequence[float]) -> None:
        """List these bookmarks, seconds since the beginning."""
        self._bookmarks.clear()
        self._bookmarks.addActions([self._toggle_bookmark, self.loop])
        self._bookmarks.addSeparator()
        for time in times:
            self._bookmarks.addAction(clock(time), partial(self.bookmark_chosen.emit, time))

    def _menu_button(self, text: str, hint: str, menu: QMenu) -> QToolButton:
        button = QToolButton()
        button.setText(text)
        button.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        button.setToolTip(hint)
        button.setMenu(menu)
        return button

    def _add_keys(self, live: bool) -> None:
        self._action("Play or pause", "Space", self.playback.play_toggled.emit)
        self._action("One step forward", ".", lambda: self.playback.stepped.emit(1))
        self._action("Faster", "]", lambda: self.speed_stepped.emit(1))
        self._action("Slower", "[", lambda: self.speed_stepped.emit(-1))
        self._action("Stop using the tool", "Esc", lambda: self.select_tool(MapTool.LOOK))
        self._action("Next part", "F6", lambda: self._next_part(1))
        self._action("Previous part", "Shift+F6", lambda: self._next_part(-1))
        self._action("Filter", "Ctrl+F", self._filter)
        if not live:
            self._action("One step back", ",", lambda: self.playback.stepped.emit(-1))
            self._action("To the beginning", "Home", lambda: self.jumped_to_end.emit(-1))
            self._action("To the end", "End", lambda: self.jumped_to_end.emit(1))
            self._action("Go to a typed time", "Ctrl+T", self.playback.ask_time)
            self._action("Previous mark", "PgUp", lambda: self.jumped.emit(-1))
            self._action("Next mark", "PgDown", lambda: self.jumped.emit(1))
        for display, switch in SWITCHES.items():
            if switch.key:
                self._action(switch.label, switch.key, partial(self.displays.toggle, display))

    def _action(self, text: str, key: str, do: Callable[[], None]) -> QAction:
        action = QAction(text, self)
        action.setShortcut(QKeySequence(key))
        action.triggered.connect(lambda _: do())
        self.addAction(action)
        return action

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Adapt the height of the wizard's list to the height of the window."""
        super().resizeEvent(event)
        self.wizard.fit_window()

    # Files dropped on the window

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Accept files and folders of this machine."""
        if any(url.isLocalFile() for url in event.mimeData().urls()):
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:
        """Emit the path of each dropped file and folder."""
        event.acceptProposedAction()
        for url in event.mimeData().urls():
            if url.isLocalFile():
                self.source_chosen.emit(url.toLocalFile())

    # Keys

    def show_keys(self) -> None:
        """Open the sheet of keyboard shortcuts."""
        KeySheet(self, GROUPS).open()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """While the map has the focus, let Tab select the next robot. F6 moves the focus away from the map."""
        if watched is self.canvas and isinstance(event, QKeyEvent) and event.type() == QEvent.Type.KeyPress:
            if event.key() == Qt.Key.Key_Tab and not event.modifiers():
                self.robot_stepped.emit(1)
                return True
            if event.key() == Qt.Key.Key_Backtab:
                self.robot_stepped.emit(-1)
                return True
        return super().eventFilter(watched, event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Let Enter activate the focused button or combo box, because Space pauses or plays in this window."""
        focus = self.focusWidget()
        if event.key() not in {Qt.Key.Key_Return, Qt.Key.Key_Enter}:
            super().keyPressEvent(event)
        elif isinstance(focus, QAbstractButton):
            focus.click()
        elif isinstance(focus, QComboBox):
            focus.showPopup()

    def _tool_chosen(self, tool: MapTool) -> None:
        self.tool = tool
        self.tool_selected.emit(tool)

    def _next_part(self, step: int) -> None:
        """Move the focus to the next visible part of the window."""
        center = self.canvas if self.canvas.isVisible() else self.topics
        parts = [center, self.playback, *(dock.widget() for dock in self._docks if _in_sight(dock))]
        focus = QApplication.focusWidget()
        here = next((n for n, part in enumerate(parts) if focus is part or (focus and part.isAncestorOf(focus))), 0)
        part = parts[(here + step) % len(parts)]
        first = part if part.focusPolicy() & Qt.FocusPolicy.TabFocus else _first_focus(part)
        first.setFocus(Qt.FocusReason.TabFocusReason)

    def _filter(self) -> None:
        log = next((log for log in self.logs.values() if not log.visibleRegion().isEmpty()), None)
        if log is not None:
            log.focus_filter()


def _in_sight(dock: QDockWidget) -> bool:
    return dock.isVisible() and not dock.widget().visibleRegion().isEmpty()


def _first_focus(part: QWidget) -> QWidget:
    """Return the first widget in a part that accepts the focus, in the order of the Tab key."""
    widget = part.nextInFocusChain()
    while widget is not None and widget is not part:
        wanted = widget.isVisible() and widget.isEnabled() and widget.focusPolicy() & Qt.FocusPolicy.TabFocus
        if wanted and part.isAncestorOf(widget):
            return widget
        widget = widget.nextInFocusChain()
    return part
