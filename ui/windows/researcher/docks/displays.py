"""Check boxes for all that the map can show."""

from dataclasses import dataclass
from enum import StrEnum

from PySide6.QtCore import QEvent, QObject, QSize, Qt, Signal
from PySide6.QtWidgets import QCheckBox, QFrame, QGridLayout, QScrollArea, QVBoxLayout, QWidget

from ui.windows.words_of_others import PlainLabel


class MapDisplay(StrEnum):
    """A kind of data on the map."""

    TRUTH = "truth"
    ELLIPSES = "ellipses"
    CLOUDS = "clouds"
    SCANS = "scans"
    GLOBAL_COSTMAP = "global costmap"
    LOCAL_COSTMAP = "local costmap"
    PLANS = "plans"
    LOCAL_PLANS = "local plans"
    PATHS = "paths"
    TRUE_PATHS = "true paths"
    ODOMETRY = "odometry"
    GOALS = "goals"
    FOOTPRINTS = "footprints"
    THINGS = "things"
    ROOMS = "rooms"


@dataclass(frozen=True, slots=True)
class DisplaySwitch:
    """The switch of one display.

    Attributes:
        key: toggles it; empty for none.
        label: its name, for people.
        on: its first state.
        hint: explains what it shows.
    """

    key: str
    label: str
    on: bool
    hint: str


SWITCHES = {
    MapDisplay.TRUTH: DisplaySwitch(
        "1", "Truth", True, "Where robots really are: dashed, tied to where they believe to be"
    ),
    MapDisplay.ELLIPSES: DisplaySwitch("2", "Uncertainty", True, "Where a robot may be as well: 95 % of its belief"),
    MapDisplay.CLOUDS: DisplaySwitch("3", "Particle clouds", True, "Of the robot selected in full, of others thinned"),
    MapDisplay.SCANS: DisplaySwitch(
        "4", "Laser scans", True, "From where the robot believes to be: off the walls when it errs"
    ),
    MapDisplay.GLOBAL_COSTMAP: DisplaySwitch(
        "5", "Global costmap", False, "Of the robot selected: its global planner's"
    ),
    MapDisplay.LOCAL_COSTMAP: DisplaySwitch("6", "Local costmap", False, "Of the robot selected: its local planner's"),
    MapDisplay.PLANS: DisplaySwitch("7", "Plans", True, "The whole way to the goal"),
    MapDisplay.LOCAL_PLANS: DisplaySwitch("8", "Local plans", True, "The next moments"),
    MapDisplay.PATHS: DisplaySwitch("9", "Paths", True, "Where robots believed to be so far"),
    MapDisplay.TRUE_PATHS: DisplaySwitch("0", "True paths", False, "Where robots were so far"),
    MapDisplay.ODOMETRY: DisplaySwitch(
        "", "Odometry", False, "What wheels counted, laid where the robot believes to be now"
    ),
    MapDisplay.GOALS: DisplaySwitch("", "Goals", True, "Where robots shall end, and facing where"),
    MapDisplay.FOOTPRINTS: DisplaySwitch("", "Footprints", False, "Of the robots' bodies, as they published them last"),
    MapDisplay.THINGS: DisplaySwitch("", "Things in the way", True, "What no map shows"),
    MapDisplay.ROOMS: DisplaySwitch("", "Rooms", True, "Their numbers, what is hidden there and what it was named"),
}


class DisplaysPanel(QScrollArea):
    """The list of displays, as in rviz; it scrolls where there is little space.

    Signals:
        changed: a display was switched on or off.
    """

    changed = Signal()

    def __init__(self) -> None:
        super().__init__(widgetResizable=True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setAccessibleName("Displays")
        self._boxes: dict[MapDisplay, QCheckBox] = {}
        grid = QGridLayout()
        grid.setHorizontalSpacing(12)
        grid.setVerticalSpacing(6)
        grid.setColumnStretch(0, 1)
        for row, (display, switch) in enumerate(SWITCHES.items()):
            box = QCheckBox(switch.label)
            box.setChecked(switch.on)
            box.setToolTip(switch.hint)
            box.setAccessibleDescription(f"{switch.hint}. Key {switch.key}" if switch.key else switch.hint)
            box.toggled.connect(self.changed)
            key = PlainLabel(switch.key)
            key.setProperty("role", "key")
            self._boxes[display] = box
            grid.addWidget(box, row, 0)
            grid.addWidget(key, row, 1)
        self._inside = QWidget()
        layout = QVBoxLayout(self._inside)
        layout.setContentsMargins(12, 12, 12, 12)
        layout.addLayout(grid)
        layout.addStretch(1)
        self.setWidget(self._inside)

    def minimumSizeHint(self) -> QSize:
        """Return the width of the labels, and the height of some of them."""
        wide = self._inside.minimumSizeHint().width() + self.verticalScrollBar().sizeHint().width()
        return QSize(wide, 4 * self.fontMetrics().height())

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Report another size of the labels to the layout."""
        if event.type() == QEvent.Type.LayoutRequest:
            self.updateGeometry()
        return super().eventFilter(watched, event)

    def shows(self, display: MapDisplay) -> bool:
        """Return True when this display is on."""
        return self._boxes[display].isChecked()

    def toggle(self, display: MapDisplay) -> None:
        """Switch this display on or off."""
        self._boxes[display].toggle()
