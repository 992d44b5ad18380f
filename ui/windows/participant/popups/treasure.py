"""Pop-up about a treasure that a robot found."""

from PySide6.QtCore import QSize, Qt
from PySide6.QtWidgets import (
    QBoxLayout,
    QGridLayout,
    QVBoxLayout,
    QWidget,
)

from thbridge.dialogue.wording.texts import Texts
from ui.model.playing.screen import PickName, TreasurePopup
from ui.windows import look
from ui.windows.look import GAP, px, spaced
from ui.windows.participant.popups.finding import (
    FACTS_WIDTH,
    PICTURE,
    FactActs,
    NamingResult,
    PicturePlace,
    TreasureFacts,
    find_size,
)
from ui.windows.participant.popups.names import NameList
from ui.windows.participant.widgets.buttons import ActionButton
from ui.windows.participant.widgets.panels import TitledPanel, set_text, wrapped_height


class TreasurePanel(TitledPanel):
    """Pop-up with the picture and sensor readings on the left, the possible names on the right, and the acts below.

    In a narrow panel, the list of names is above the picture and the readings.
    """

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(texts, texts.text("window.treasure"), parent)
        self._pop: TreasurePopup | None = None
        self._columns: tuple[bool, bool] | None = None
        self._space = self.usual_size()
        self.aside = ActionButton(texts, "quiet")
        self.top.addWidget(self.aside)
        self.talk = look.label(muted=True)
        self.rows.addWidget(self.talk)
        self.more = FactActs(texts)
        self.more.requested.connect(self.requested)
        self.rows.addWidget(self.more)
        self.place, self.facts = PicturePlace(texts), TreasureFacts(texts)
        self.names, self.verdict = NameList(texts), NamingResult()
        self.picture, self.take_picture = self.place.picture, self.place.take
        self._asking = look.label(texts.text("window.what_is_it"), bold=True)
        self._naming = QWidget()
        naming = spaced(QVBoxLayout(self._naming), GAP, 0)
        naming.addWidget(self._asking)
        naming.addWidget(self.names, 1)
        naming.addWidget(self.verdict, 1)
        self._grid = spaced(QGridLayout(), int(1.5 * GAP))
        self.rows.addLayout(self._grid, 1)
        self._stakes = look.label(size="small", muted=True)
        self.rows.addWidget(self._stakes)
        self.name_it, self.leave = ActionButton(texts, "main", hints=True), ActionButton(texts, hints=True)
        self.unsure = ActionButton(texts, hints=True)
        self._others = spaced(QBoxLayout(QBoxLayout.Direction.TopToBottom), GAP)
        self.foot.setContentsMargins(GAP, 0, GAP, GAP)
        self.foot.addWidget(self.name_it, 3)
        self.foot.addLayout(self._others, 2)
        self._others.addWidget(self.unsure)
        self._others.addWidget(self.leave)
        for button in (self.aside, self.picture, self.take_picture, self.name_it, self.unsure, self.leave):
            button.requested.connect(self.requested)
        self.names.picked.connect(self._ask_for_pick)
        self.arrange(self.usual_size())

    def arrange(self, space: QSize) -> None:
        """Put the list of names next to the picture if all names fit there completely, otherwise above the picture.

        The sensor readings are below the picture. If the list is above the picture and there is space, they are next to
        the picture. If there is little space, the cost and gain of a name move from the button to the bottom, and all
        parts move closer together.
        """
        super().arrange(space)
        self._space = space
        for button in (self.name_it, self.unsure, self.leave):
            button.show_hints(not self.compact)
        gap = GAP if self.compact else int(1.5 * GAP)
        if self.rows.spacing() != gap:  # Without this check, each layout would start another layout.
            self.rows.setSpacing(gap)
            self._grid.setSpacing(gap)
        row, column = QBoxLayout.Direction.LeftToRight, QBoxLayout.Direction.TopToBottom
        self._others.setDirection(row if self.compact else column)
        alone = self._pop is None or self._pop.unsure is None
        self.foot.setStretch(0, 3 if not self.compact else 4 if alone else 2)
        self._show_stakes()
        free = self.room_beside(PICTURE.width(), space)
        named, known = free >= self.names.widest(), free >= px(FACTS_WIDTH)
        if (named, known) == self._columns:
            return
        self._columns = named, known
        top = Qt.AlignmentFlag.AlignTop
        self._grid.addWidget(self._naming, *((0, 1, 3, 1) if named else (0, 0, 1, 2)))
        self._grid.addWidget(self.place, 1, 0, top)
        self._grid.addWidget(self.facts, *((1, 1) if known and not named else (2, 0)), top)
        self._grid.setColumnStretch(1, 1)
        self._grid.setRowStretch(0, int(not named))
        self._grid.setRowStretch(2, int(named))

    def _show_stakes(self) -> None:
        """Show the cost and gain of a name if the button does not show them. Their place has space for all names."""
        asks = self._pop is not None and self._pop.asks_for_name
        set_text(self._stakes, self._pop.name_it.hint if self._pop is not None and asks else "")
        self._stakes.setVisible(self.compact and asks)
        longest = self._pop.longest_name_it if self._pop is not None else None
        width = self.room_beside(0, self._space)
        self._stakes.setMinimumHeight(wrapped_height(self._stakes, longest.hint, width) if longest else 0)

    def usual_size(self) -> QSize:
        """Return the size that all pop-ups about finds have."""
        return find_size()

    def _ask_for_pick(self, name: str) -> None:
        # Do not make this a function inside `__init__`. The list of names, which the panel owns, would then refer to
        # the panel, and the panel would never be freed.
        self.requested.emit(PickName(name))

    def show_pop(self, pop: TreasurePopup) -> None:
        """Show this treasure; do nothing if it is already shown."""
        if pop == self._pop:
            return
        new = self._pop is None or pop.room != self._pop.room
        self._pop = pop
        self.entitle(pop.title, pop.robot)
        self.aside.show_action(pop.aside)
        set_text(self.talk, pop.talk)
        self.talk.setVisible(bool(pop.talk))
        self.facts.show_facts(pop.facts)
        self.more.show_facts(pop.facts or ())
        unseen = self._texts.text("window.no_picture_yet" if pop.verdict is None else "window.no_picture")
        came = pop.picture is not None and self.place.picture.isHidden()
        self.place.show_place(pop.picture, pop.picture_note or unseen, pop.take_picture, pop.enlarge)
        decided = pop.verdict is not None
        names, worth, called = ((), (), ()) if decided else (pop.names, pop.worth, pop.called)
        self.names.show_names(names, pop.picked, worth, called)
        self.names.setVisible(pop.asks_for_name)
        key = "window.what_is_it_typed" if pop.typed else "window.what_is_it"
        set_text(self._asking, self._texts.text(key, typed=pop.typed))
        self._asking.setVisible(pop.asks_for_name)
        self.verdict.setVisible(decided)
        self._show_stakes()
        if pop.verdict is not None:
            self.verdict.show_verdict(pop.verdict, pop.points)
        for button, action in ((self.name_it, pop.name_it), (self.unsure, pop.unsure), (self.leave, pop.leave)):
            if action is not None:
                button.show_action(action, pop.longest_name_it if button is self.name_it else None)
            button.setVisible(action is not None and pop.asks_for_name)
        if came:
            self.reveal(self.place)
        elif new:
            self.reveal(self._naming)
