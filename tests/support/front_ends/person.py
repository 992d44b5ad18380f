"""Person at a front end, in a game of their own. The test moves the time of the game, of the front end and of the
person."""

from abc import ABC, abstractmethod
from pathlib import Path

from tests.support.hunts.study_without_simulator import StudyWithoutSimulator
from thbridge.roles.participant.tabui import TabUI
from thbridge.study.study_file import Study
from ui.model.playing.screen import Act

TICK = 0.02
"""Seconds of a tick."""


class Person(ABC):
    """Person at a front end.

    Attributes:
        now: time of game, front end and person, seconds.
        tabui: program of the participant.
        game: the game.
    """

    def __init__(self, study: Study, tabui: TabUI, beside: Path = Path()) -> None:
        self.now = 0.0
        self.tabui = tabui
        self.game = StudyWithoutSimulator(study, tabui, beside=beside)

    def wait(self, ticks: int) -> None:
        """Let the game and the front end go on."""
        for _ in range(ticks):
            self.now += TICK
            self.tabui.poll_player()
            self.game.session.step()
            self.look()

    @abstractmethod
    def look(self) -> None:
        """Draw the present state."""

    @abstractmethod
    def press(self, act: Act) -> None:
        """Carry out an act with the means of the front end."""
