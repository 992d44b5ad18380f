"""Check boxes that choose the data shown on the map."""

from dataclasses import dataclass
from enum import StrEnum

from PySide6.QtCore import QEvent, QObject, QSize, Qt, Signal
from PySide6.QtWidgets import QCheckBox, QFrame, QGridLayout, QScrollArea, QVBoxLayout, QWidget

from ui.windows.untrusted_text import PlainLabel


class MapDisplay(StrEnum):
    """Kind of data on the map."""

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
    """Switch that shows or hides one kind of data on the map.

    Attributes:
        key: shortcut of the switch; empty if there is none.
        label: name of the display for people.
        on: True if the display is on when the window opens.
        hint: description of the display.
    """

    key: str
    label: str
    on: bool
    hint: str


SWITCHES = {
    MapDisplay.TRUTH: DisplaySwitch("1", "Truth", True, "True poses, dashed and linked to the believed poses"),
    MapDisplay.ELLIPSES: DisplaySwitch(
        "2", "Uncertainty", True, "Area that contains the robot with a probability of 95 %, by its own belief"
    ),
    MapDisplay.CLOUDS: DisplaySwitch(
        "3", "Particle clouds", True, "All particles of the selected robot, and fewer of the other robots"
    ),
    MapDisplay.SCANS: DisplaySwitch(
        "4", "Laser scans", True, "Scans as seen from the believed pose; they miss the walls if this pose is wrong"
    ),
    MapDisplay.GLOBAL_COSTMAP: DisplaySwitch(
        "5", "Global costmap", False, "Costmap of the selected robot's global planner"
    ),
    MapDisplay.LOCAL_COSTMAP: DisplaySwitch(
        "6", "Local costmap", False, "Costmap of the selected robot's local planner"
    ),
    MapDisplay.PLANS: DisplaySwitch("7", "Plans", True, "Complete planned path to the goal"),
    MapDisplay.LOCAL_PLANS: DisplaySwitch("8", "Local plans", True, "Path that the local planner follows next"),
    MapDisplay.PATHS: DisplaySwitch("9", "Paths", True, "Past positions, as the robot believed them"),
    MapDisplay.TRUE_PATHS: DisplaySwitch("0", "True paths", False, "True past positions"),
    MapDisplay.ODOMETRY: DisplaySwitch(
        "", "Odometry", False, "Path measured by the wheels, shifted to end at the believed pose"
    ),
    MapDisplay.GOALS: DisplaySwitch("", "Goals", True, "Poses of the robots' goals, with their directions"),
    MapDisplay.FOOTPRINTS: DisplaySwitch("", "Footprints", False, "Latest published outlines of the robots"),
    MapDisplay.THINGS: DisplaySwitch("", "Things in the way", True, "Obstacles that are not on the map"),
    MapDisplay.ROOMS: DisplaySwitch("", "Rooms", True, "Room numbers, hidden treasures, and the names given so far"),
}


class DisplaysPanel(QScrollArea):
    """List of displays, as in rviz. It scrolls if there is too little space.

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
            box.setAccessibleDescription(f"{switch.hint}. Shortcut: {switch.key}" if switch.key else switch.hint)
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
        """Return the width of the labels, and the height of four lines."""
        wide = self._inside.minimumSizeHint().width() + self.verticalScrollBar().sizeHint().width()
        return QSize(wide, 4 * self.fontMetrics().height())

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Ask the layout for a new size when the labels change their size."""
        if event.type() == QEvent.Type.LayoutRequest:
            self.updateGeometry()
        return super().eventFilter(watched, event)

    def shows(self, display: MapDisplay) -> bool:
        """Return True if this display is on."""
        return self._boxes[display].isChecked()

    def toggle(self, display: MapDisplay) -> None:
        """Switch this display on or off."""
        self._boxes[display].toggle()
