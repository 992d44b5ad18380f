"""What the map shows, each kind switched on and off."""

from dataclasses import dataclass
from enum import StrEnum

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QCheckBox, QComboBox, QGridLayout, QLabel, QVBoxLayout, QWidget


class Display(StrEnum):
    """A kind of thing on the map."""

    TRUTH = "truth"
    ELLIPSES = "ellipses"
    CLOUDS = "clouds"
    SCANS = "scans"
    GLOBAL_COSTMAPS = "global costmaps"
    LOCAL_COSTMAPS = "local costmaps"
    GLOBAL_PLANS = "global plans"
    LOCAL_PLANS = "local plans"
    PATHS = "paths"
    THINGS = "things"
    ROOMS = "rooms"
    GOALS = "goals"
    FOOTPRINTS = "footprints"


@dataclass(frozen=True, slots=True)
class Switch:
    """How one kind is switched.

    Attributes:
        key: that does it; empty: none does.
        label: for people.
        on: at first.
        hint: what it is.
    """

    key: str
    label: str
    on: bool
    hint: str


SWITCHES = {
    Display.TRUTH: Switch("1", "Truth", True, "Where robots really are, as an outline"),
    Display.ELLIPSES: Switch("2", "Uncertainty", True, "Where a robot may be as well: 95 % of its belief"),
    Display.CLOUDS: Switch("3", "Particle clouds", True, "Of the robot selected in full, of others thinned"),
    Display.SCANS: Switch("4", "Laser scans", True, "From where the robot believes it is: off the walls when it errs"),
    Display.GLOBAL_COSTMAPS: Switch("5", "Global costmap", False, "What the global planner goes by"),
    Display.LOCAL_COSTMAPS: Switch("6", "Local costmap", False, "What the local planner goes by"),
    Display.GLOBAL_PLANS: Switch("7", "Global plan", True, "The way to the goal"),
    Display.LOCAL_PLANS: Switch("8", "Local plan", True, "The next metres"),
    Display.PATHS: Switch("9", "Paths driven", True, "Where robots believe they have been"),
    Display.ROOMS: Switch("0", "Rooms", True, "Their outlines and numbers"),
    Display.THINGS: Switch("", "Things in the way", True, "What no map shows"),
    Display.GOALS: Switch("", "Goals", True, "Where robots shall end, and facing where"),
    Display.FOOTPRINTS: Switch("", "Footprints", False, "As the costmaps have them"),
}


class Displays(QWidget):
    """Switches of what the map shows.

    Signals:
        changed: something was switched.
    """

    changed = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._boxes: dict[Display, QCheckBox] = {}
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
            key = QLabel(switch.key)
            key.setProperty("role", "key")
            self._boxes[display] = box
            grid.addWidget(box, row, 0)
            grid.addWidget(key, row, 1)
        self._whose = QComboBox()
        self._whose.addItems(["of the robot selected", "of all robots"])
        self._whose.setAccessibleName("Scans, costmaps and plans of which robots")
        self._whose.setToolTip("Scans, costmaps, plans and footprints of which robots")
        self._whose.currentIndexChanged.connect(self.changed)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(12, 12, 12, 12)
        layout.addLayout(grid)
        layout.addSpacing(8)
        layout.addWidget(QLabel("Scans, costmaps and plans"))
        layout.addWidget(self._whose)
        layout.addStretch(1)

    def shows(self, display: Display) -> bool:
        """Whether it is on."""
        return self._boxes[display].isChecked()

    @property
    def of_all(self) -> bool:
        """Whether scans, costmaps and plans of all robots are wanted, or those of the one selected."""
        return self._whose.currentIndex() == 1

    def toggle(self, display: Display) -> None:
        """Switch it on or off."""
        self._boxes[display].toggle()
