"""Real game in this process, and the model of the participant's window."""

from collections.abc import Callable, Sequence
from pathlib import Path

from pictured import language
from sim.common.observations import TICK
from thbridge.app.compose.game import build_hider, build_keeper
from thbridge.app.compose.robots import build_simr
from thbridge.app.compose.setting import read_setting
from thbridge.app.session.session import Session
from thbridge.roles.participant.tabui import ParticipantUpdate, TabUI
from thbridge.roles.shared.robot_requests import Request
from thbridge.roles.shared.view import ParticipantRequest, View
from thbridge.study.study_file import Study
from ui.model.playing.offers import offer
from ui.model.playing.participant import Participant
from ui.model.playing.screen import Act, AnswerDialogueAct, ConsiderRoom, DialoguePopup, PickName, Screen

LIMIT = 120.0
"""Simulated seconds after which waiting fails."""


class PicturedHunt:
    """Real game with requests as from a person at the window. Its time advances only in the methods of this class.

    Args:
        study: study to play; its paths are absolute.

    Attributes:
        model: model of the window.
        now: seconds of the window's clock.
        shade: function that changes the game's messages before the window gets them.
        levels: latest message of each kind.
        view: latest view of the game.
    """

    def __init__(self, study: Study) -> None:
        self.model = Participant(texts=language.texts())
        self.now = 0.0
        self.shade: Callable[[ParticipantUpdate], ParticipantUpdate] = lambda seen: seen
        self.levels: dict[type[ParticipantUpdate], ParticipantUpdate] = {}
        setting = read_setting(language.spoken(study), Path())
        self._tabui = TabUI(self, self)
        self._session = Session(
            build_keeper(setting),
            [build_simr(setting), build_hider(setting.templates, setting.study.seed)],
            participants=(self._tabui,),
        )
        self.model.connected(self.now)
        self.until(lambda screen: bool(screen.cards))
        self.run(0.2)

    def observe(self, level: ParticipantUpdate) -> None:
        """Handle a message of the game."""
        self.levels[type(level)] = level
        if isinstance(level, View):
            self.view = level
        self.model.receive(self.shade(level), self.now)

    def requests(self, _view: View) -> Sequence[ParticipantRequest]:
        """Return the open requests of the window."""
        return self.model.requests()

    @property
    def screen(self) -> Screen:
        """Screen that the window shows now."""
        return self.model.screen(self.now)

    def run(self, seconds: float) -> None:
        """Advance the game."""
        for _ in range(round(seconds / TICK)):
            self.now += TICK
            self._tabui.poll_player()
            self._session.step()
            # A window reads the robots in each frame, and trails consist of the poses that it read.
            self.model.robots(self.now)

    def ask(self, request: Request) -> None:
        """Send a request to the robots, as a researcher's window does."""
        self._session.ask("watch", request)

    def until(self, holds: Callable[[Screen], bool]) -> None:
        """Advance the game until a condition is true. Raise RuntimeError after `LIMIT` seconds."""
        for _ in range(round(LIMIT / TICK)):
            if holds(self.screen):
                return
            self.run(TICK)
        last = "; ".join(line.text for line in self.screen.history[-4:])
        raise RuntimeError(f"the expected state was not reached; last events: {last}")

    def do(self, act: Act) -> None:
        """Do an act that the window offers. Raise RuntimeError if the window does not offer this act."""
        offered = offer(self.screen, act)
        if not isinstance(act, ConsiderRoom | PickName) and (offered is None or not offered.enabled):
            raise RuntimeError(f"the window does not offer {act}: {offered}")
        self.model.do(act, self.now)

    def asked(self) -> None:
        """Wait until a robot has asked a question that can be answered."""
        self.until(lambda screen: bool(getattr(screen.popup, "choices", ())))

    def agree(self) -> None:
        """Give the first answer to all questions of the robot in the pop-up."""
        self.asked()
        while getattr(self.screen.popup, "choices", ()):
            self.do(AnswerDialogueAct(0))
            self.run(0.2)

    def say(self, act: str, which: int = 0) -> None:
        """Give an answer, and wait until the robot has replied.

        Args:
            act: word for the effect of the answer.
            which: index among several answers with this effect, from 0.
        """
        pop = self.screen.popup
        robot = pop.robot if isinstance(pop, DialoguePopup) else None
        acts = [each for dialogue in self.view.dialogues if dialogue.robot == robot for each in dialogue.acts]
        found = [at for at, each in enumerate(acts) if each == act]
        if len(found) <= which:
            raise RuntimeError(f"there is no answer {act}: {acts}")
        self.do(AnswerDialogueAct(found[which]))
        self.run(0.4)

    def send(self, act: Act) -> None:
        """Start an act that needs a dialogue, and agree to everything that the robot asks."""
        self.do(act)
        self.agree()

    def reached(self) -> None:
        """Wait until a robot has reached a room and reported the properties that it senses."""
        self.until(lambda screen: bool(getattr(screen.popup, "facts", ())))

    def change_view(self, change: Callable[[View], View]) -> None:
        """Apply a function to the present view of the game and to each later view."""
        self.shade = lambda seen: change(seen) if isinstance(seen, View) else seen
        self.model.receive(self.shade(self.view), self.now)
