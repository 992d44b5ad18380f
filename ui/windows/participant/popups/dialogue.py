"""Pop-up of a dialogue between a robot and the participant."""

from PySide6.QtCore import QSize, Qt
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QVBoxLayout, QWidget

from thbridge.dialogue.wording.texts import Texts
from ui.model.playing.screen import DialoguePopup
from ui.model.playing.spoken import state_of
from ui.windows import look
from ui.windows.look import GAP, px, spaced
from ui.windows.participant.popups.finding import PICTURE, TreasureFacts, TreasurePicture, find_size
from ui.windows.participant.widgets.buttons import ActionButton, ActionRow
from ui.windows.participant.widgets.panels import TitledPanel, Transcript
from ui.windows.participant.widgets.reason_line import ReasonLine

_SAID_WIDTH = 140
"""Smallest width of the sentences if they are next to a picture, `px`."""


class DialoguePanel(TitledPanel):
    """Pop-up of a dialogue with a robot: the subject, sentences in bubbles, and answers as buttons."""

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(texts, texts.text("window.dialogue"), parent)
        self._pop: DialoguePopup | None = None
        self._side_by_side: bool | None = None
        self.aside = ActionButton(texts, "quiet")
        self.aside.requested.connect(self.requested)
        self.top.addWidget(self.aside)
        self.facts, self.picture = TreasureFacts(texts), TreasurePicture(texts)
        self.picture.requested.connect(self.requested)
        self.transcript = Transcript(texts)
        self._grid = spaced(QGridLayout(), int(1.5 * GAP))
        self._grid.addWidget(self.picture, 0, 0, 2, 1, Qt.AlignmentFlag.AlignTop)
        self._grid.setColumnStretch(1, 1)
        self.rows.addLayout(self._grid, 1)
        self._state = look.label(muted=True)
        self.rows.addWidget(self._state)
        self._outcome = look.label(bold=True)
        self.rows.addWidget(self._outcome)
        self._warning = look.label()
        self.rows.addWidget(self._warning)
        answers = spaced(QVBoxLayout(), GAP)
        self.rows.addLayout(answers)
        # All answer buttons look the same, because the window must not suggest an answer.
        self.choices = ActionRow(texts, answers, self.requested, hints=True)
        # The person's own words in an objection, and its button.
        foot = spaced(QHBoxLayout(), GAP)
        self.own_words = ReasonLine(texts.text("objections.own_words"))
        foot.addWidget(self.own_words, 1)
        self.objects = ActionRow(texts, foot, self.requested, hints=True)
        self.rows.addLayout(foot)
        # Index of the answer that opened the questions. It gets the focus again when the person leaves the questions.
        self._left_from = 0
        self.arrange(self.usual_size())

    def show_pop(self, pop: DialoguePopup) -> None:
        """Show this dialogue; do nothing if it is already shown."""
        if pop == self._pop:
            return
        before, self._pop = self._pop, pop
        self.entitle(pop.title, pop.robot)
        self.aside.show_action(pop.aside)
        self.facts.show_facts(pop.facts)
        self.facts.setVisible(bool(pop.facts))
        self.picture.show_picture(pop.picture, enlarge=pop.enlarge)
        self.picture.setVisible(pop.picture is not None)
        self.transcript.show_sentences(pop.sentences, pop.robot, pop.partner)
        state = state_of(self._texts, pop)
        self._state.setText(state)
        self._state.setVisible(bool(state))
        self._outcome.setText(pop.outcome)
        self._outcome.setVisible(bool(pop.outcome))
        self._warning.setText(self._texts.text("window.warning", warning=pop.warning))
        self._warning.setVisible(bool(pop.warning))
        if not pop.own_words or before is None or before.title != pop.title:
            self.own_words.clear()
        self.own_words.setVisible(bool(pop.own_words))
        self.objects.show_actions(() if pop.objects is None else (pop.objects,))
        focused = self._focused()
        self.choices.show_actions(pop.choices)
        if focused is not None and pop.choices:
            self._keep_focus(focused, before, pop)

    def arrange(self, space: QSize) -> None:
        """Put sensor readings and sentences next to the picture, or below the picture if the panel is narrow."""
        super().arrange(space)
        self.transcript.keep_room(space.height() // 2)
        side_by_side = self.room_beside(PICTURE.width(), space) >= px(_SAID_WIDTH)
        if side_by_side == self._side_by_side:
            return
        self._side_by_side = side_by_side
        row, column, columns = (0, 1, 1) if side_by_side else (2, 0, 2)
        self._grid.addWidget(self.facts, row, column, 1, columns, Qt.AlignmentFlag.AlignTop)
        self._grid.addWidget(self.transcript, row + 1, column, 1, columns)
        for each in (1, 3):
            self._grid.setRowStretch(each, int(each == row + 1))

    def usual_size(self) -> QSize:
        """Return the usual size.

        A dialogue about a treasure replaces the pop-up about this treasure, and has the same size.
        """
        about_find = self._pop is not None and (self._pop.facts or self._pop.picture is not None)
        if about_find:
            return find_size()
        # Dialogues with robots that argue have more sentences and more answers.
        numbered = self._pop is not None and self._pop.numbered
        return QSize(px(380), px(400)) if numbered else super().usual_size()

    def go_to(self, key: int) -> None:
        """Handle Down (focus the first answer), Up (focus the last answer), and Page Up and Page Down (scroll)."""
        match key:
            case Qt.Key.Key_Down:
                self._focus_choice(0)
            case Qt.Key.Key_Up:
                self._focus_choice(-1)
            case Qt.Key.Key_PageUp:
                self.transcript.turn_page(-1)
            case Qt.Key.Key_PageDown:
                self.transcript.turn_page(1)

    def _focus_choice(self, at: int) -> None:
        """Give the focus to the answer with this index; -1 is the last answer."""
        shown = [button for button in self.choices.buttons if not button.isHidden()]
        if shown:
            shown[at].setFocus(Qt.FocusReason.OtherFocusReason)

    def _focused(self) -> int | None:
        """Return the index of the answer that has the focus; None if no answer has the focus."""
        return next((at for at, button in enumerate(self.choices.buttons) if button.hasFocus()), None)

    def _keep_focus(self, focused: int, before: DialoguePopup | None, pop: DialoguePopup) -> None:
        """Give the focus to the first new answer.

        When the person leaves the questions, give the focus to the answer that opened the questions.
        """
        turned = before is not None and (before.robot, before.sentences) == (pop.robot, pop.sentences)
        if _asks(pop) and not (before is not None and _asks(before)):
            self._left_from = focused
            self._focus_choice(0)
        elif before is not None and _asks(before):
            self._focus_choice(min(self._left_from, len(pop.choices) - 1))
        elif not turned:
            self._focus_choice(0)


def _asks(pop: DialoguePopup) -> bool:
    """Return True while the answers are questions to the robot. The person leaves these questions with Esc."""
    return any(choice.key == "Esc" for choice in pop.choices)
