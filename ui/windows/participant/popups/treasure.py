"""The pop-up about a treasure that a robot found."""

from PySide6.QtWidgets import (
    QHBoxLayout,
    QVBoxLayout,
    QWidget,
)

from ui.model.screen import PickName, TreasurePopup
from ui.windows import look
from ui.windows.look import GAP, spaced
from ui.windows.participant.popups.finding import FactActs, NamingResult, TreasureFacts, TreasurePicture
from ui.windows.participant.popups.names import NameList
from ui.windows.participant.widgets.buttons import ActionButton
from ui.windows.participant.widgets.panels import TitledPanel, set_text


class TreasurePanel(TitledPanel):
    """Sensor readings and picture at the left, the list of possible names at the right."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__("Treasure", parent)
        self._pop: TreasurePopup | None = None
        self.aside = ActionButton("quiet")
        self.top.addWidget(self.aside)
        self.talk = look.label(muted=True)
        self.rows.addWidget(self.talk)
        self.more = FactActs()
        self.more.requested.connect(self.requested)
        self.rows.addWidget(self.more)
        columns = spaced(QHBoxLayout(), 2 * GAP)
        self.rows.addLayout(columns, 1)
        left, right = spaced(QVBoxLayout(), int(1.5 * GAP)), spaced(QVBoxLayout(), GAP)
        columns.addLayout(left, 2)
        columns.addLayout(right, 3)
        self.facts, self.picture, self.names, self.verdict = (
            TreasureFacts(),
            TreasurePicture(),
            NameList(),
            NamingResult(),
        )
        self.take_picture = ActionButton(hints=True)
        # It keeps its space when hidden: else the list would move under the pointer when the picture comes.
        keeping = self.take_picture.sizePolicy()
        keeping.setRetainSizeWhenHidden(True)
        self.take_picture.setSizePolicy(keeping)
        left.addWidget(self.facts)
        left.addWidget(self.picture)
        left.addWidget(self.take_picture)
        left.addStretch(1)
        self._asking = look.label("What is it?", bold=True)
        self.name_it, self.leave = ActionButton("main", hints=True), ActionButton("plain", hints=True)
        self.unsure = ActionButton("plain", hints=True)
        for widget, stretch in (
            (self._asking, 0),
            (self.names, 1),
            (self.verdict, 1),
            (self.name_it, 0),
            (self.unsure, 0),
            (self.leave, 0),
        ):
            right.addWidget(widget, stretch)
        for button in (self.aside, self.take_picture, self.name_it, self.unsure, self.leave):
            button.requested.connect(self.requested)
        self.names.picked.connect(self._ask_for_pick)

    def _ask_for_pick(self, name: str) -> None:
        # A function within `__init__` would hold this panel by a list that it owns, so that nothing could free it.
        self.requested.emit(PickName(name))

    def show_pop(self, pop: TreasurePopup) -> None:
        """Show this; does nothing when it is shown already."""
        if pop == self._pop:
            return
        self._pop = pop
        self.entitle(pop.title, pop.robot)
        self.aside.show_action(pop.aside)
        set_text(self.talk, pop.talk)
        self.talk.setVisible(bool(pop.talk))
        self.facts.show_facts(pop.facts)
        self.more.show_facts(pop.facts or ())
        unseen = "No picture was taken" if pop.verdict is not None else "No picture yet"
        self.picture.show_picture(pop.picture, pop.picture_note or unseen)
        self.take_picture.setVisible(pop.take_picture is not None)
        if pop.take_picture is not None:
            self.take_picture.show_action(pop.take_picture)
        decided = pop.verdict is not None
        self.names.show_names(() if decided else pop.names, pop.picked, pop.worth)
        self.names.setVisible(not decided)
        set_text(self._asking, f"What is it? {pop.typed}…" if pop.typed else "What is it?")
        self._asking.setVisible(not decided)
        self.verdict.setVisible(decided)
        if pop.verdict is not None:
            self.verdict.show_verdict(pop.verdict, pop.points)
        for button, action in ((self.name_it, pop.name_it), (self.unsure, pop.unsure), (self.leave, pop.leave)):
            if action is not None:
                button.show_action(action)
            button.setVisible(action is not None and not decided)
