"""Dialogue of a robot that argues: its moves, the robot's beliefs, and the attacks between arguments."""

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QLineEdit, QScrollArea, QSizePolicy, QTableView, QVBoxLayout, QWidget

from ui.model.watching.dialogue_log import DialogueCourse
from ui.model.watching.dialogue_rows import DialogueList, heading, move_row, rows
from ui.windows.controls import ChoiceBox
from ui.windows.look import follow_text, px
from ui.windows.researcher.docks.attack_graph import AttackGraph
from ui.windows.tables import TextModel, row_table
from ui.windows.untrusted_text import shown

MOVES = ("Time", "Speaker", "Move", "Sentence", "State")
DETAILS = ("Content", "Source", "Status")
PART = 110
"""Smallest height of each part, `px`. If the parts do not fit, the dock scrolls."""


class ArgumentsDock(QWidget):
    """Dock with the latest dialogue of the selected robot, at the time shown.

    Signals:
        chosen: a person wants to go to the time of a move; seconds since the beginning.
    """

    chosen = Signal(float)

    def __init__(self) -> None:
        super().__init__()
        self._course = DialogueCourse()
        self._times: tuple[float, ...] = ()
        # The arrow keys show the end of a sentence that is wider than the field.
        self.heading = QLineEdit(readOnly=True, frame=False)
        self.heading.setAccessibleName("Dialogue shown")
        self.list = ChoiceBox()
        self.list.addItems(list(DialogueList))
        self.list.setAccessibleName("Contents shown next to the moves")
        self.list.setSizeAdjustPolicy(ChoiceBox.SizeAdjustPolicy.AdjustToContents)
        self.list.setMinimumContentsLength(8)
        self.list.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        self.list.currentIndexChanged.connect(lambda _: self._show_details())
        single = QTableView.SelectionMode.SingleSelection
        self.moves = TextModel(MOVES, self, has_time=True)
        self.course = row_table("Moves of the dialogue", self.moves, single, 1, (7, 11, 30, 40, 24))
        self.course.activated.connect(lambda index: self.chosen.emit(self._times[index.row()]))
        self.details = TextModel(DETAILS, self)
        self.table = row_table(str(DialogueList.ARGUMENTS), self.details, single, 1, (30, 40, 30))
        self.graph = AttackGraph()
        for table in (self.course, self.table):
            table.horizontalHeader().setStretchLastSection(True)
        inside = QWidget()
        column = QVBoxLayout(inside)
        column.setContentsMargins(8, 8, 8, 8)
        column.addWidget(self.heading)
        column.addWidget(self.course, 1)
        column.addWidget(self.list)
        column.addWidget(self.table, 1)
        column.addWidget(self.graph, 1)
        for part in (self.course, self.table, self.graph):
            follow_text(part, lambda it: it.setMinimumHeight(px(PART)))
        area = QScrollArea()
        area.setWidgetResizable(True)
        area.setFrameShape(QScrollArea.Shape.NoFrame)
        area.setWidget(inside)
        area.setAccessibleName("Dialogue of the selected robot")
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(area)
        self.show_course(0, DialogueCourse(), 0)

    def show_course(self, robot: int, course: DialogueCourse, start_ns: int) -> None:
        """Show a dialogue.

        Args:
            robot: index of the robot.
            course: latest dialogue of the robot.
            start_ns: ROS time at which the displayed times are zero.
        """
        if (text := shown(heading(robot, course))) != self.heading.text():
            self.heading.setText(text)
            self.heading.setToolTip(text)
            self.heading.setCursorPosition(0)
        self._times = tuple((stamp - start_ns) / 1e9 for stamp, _ in course.moves)
        said = [(f"{time:.2f}", *move_row(move)) for time, (_, move) in zip(self._times, course.moves, strict=True)]
        if self.moves.show_rows(said):
            self.course.scrollToBottom()
        if course.portrait != self._course.portrait:
            self.graph.show_portrait(course.portrait)
        self._course = course
        self._show_details()

    def _show_details(self) -> None:
        shown = DialogueList(self.list.currentText())
        self.table.setAccessibleName(str(shown))
        self.details.show_rows(list(rows(shown, self._course.portrait)))
