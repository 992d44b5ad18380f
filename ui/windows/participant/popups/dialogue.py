"""The pop-up in which a robot talks with the participant."""

from PySide6.QtWidgets import QHBoxLayout, QVBoxLayout, QWidget

from sim.common.robot_numbers import robot_name
from ui.model.screen import DialoguePopup
from ui.windows import look
from ui.windows.look import GAP, spaced
from ui.windows.participant.popups.finding import TreasureFacts, TreasurePicture
from ui.windows.participant.widgets.buttons import ActionButton, ActionRow
from ui.windows.participant.widgets.panels import TitledPanel, Transcript

SHARE_OF_PICTURE = 0.6
"""Size of the picture beside a talk about naming, as a share of the usual one: what is said needs the space."""


class DialoguePanel(TitledPanel):
    """A dialogue with a robot: what it is about, sentences as bubbles, answers as buttons."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__("Dialogue", parent)
        self._pop: DialoguePopup | None = None
        self.aside = ActionButton("quiet")
        self.aside.requested.connect(self.requested)
        self.top.addWidget(self.aside)
        self.facts, self.picture = TreasureFacts(), TreasurePicture(SHARE_OF_PICTURE)
        find = spaced(QHBoxLayout(), GAP)
        self.rows.addLayout(find)
        find.addWidget(self.picture, 2)
        find.addWidget(self.facts, 3)
        self.transcript = Transcript()
        self.rows.addWidget(self.transcript, 1)
        self._thinking = look.label(muted=True)
        self.rows.addWidget(self._thinking)
        self._warning = look.label()
        self.rows.addWidget(self._warning)
        answers = spaced(QVBoxLayout(), GAP)
        self.rows.addLayout(answers)
        # All alike: the window must not make one answer look better than another.
        self.choices = ActionRow(answers, self.requested, hints=True)

    def show_pop(self, pop: DialoguePopup) -> None:
        """Show this; does nothing when it is shown already."""
        if pop == self._pop:
            return
        self._pop = pop
        self.entitle(pop.title, pop.robot)
        self.aside.show_action(pop.aside)
        self.facts.show_facts(pop.facts)
        self.facts.setVisible(bool(pop.facts))
        self.picture.show_picture(pop.picture, "")
        self.picture.setVisible(pop.picture is not None)
        self.transcript.show_sentences(pop.sentences, pop.robot)
        self._thinking.setText(f"{robot_name(pop.robot).capitalize()} is thinking …")
        self._thinking.setVisible(not pop.choices)
        self._warning.setText(f"⚠ {pop.warning}")
        self._warning.setVisible(bool(pop.warning))
        self.choices.show_actions(pop.choices)
