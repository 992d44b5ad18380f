"""A participant who only looks at screens and does what they offer, in a real game without a simulator."""

from tests.support.hunts.hunt_without_simulator import Stage
from tests.ui.model.language import said_by_others
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.view import View
from ui.model.playing.offers import offer, offers
from ui.model.playing.participant import Participant
from ui.model.playing.screen import Act, Action, Screen

TICK = 0.02


class Seat:
    """The view model on a stage; every act is done by what is offered for it.

    Attributes:
        theirs: all words so far that come from the study, and not from the program.
    """

    def __init__(self, model: Participant | None = None, **stage) -> None:
        self.model = model or Participant()
        self.now = 0.0
        self.theirs: set[str] = set()
        self.staged = stage
        self.tabui = TabUI(self, self)
        self.stage = Stage(participant=self.tabui, **stage)
        self.names = tuple(sorted({kind.name for kind in self.stage.templates.kinds}))
        self.model.connected(self.now)
        self.run(6)

    def observe(self, level) -> None:
        if isinstance(level, View):
            self.theirs |= said_by_others(level)
        self.model.receive(level, self.now)

    def requests(self, view: View):
        return self.model.requests()

    def restart_server(self) -> None:
        """Kill the server with all its programs, and start them again on the journal."""
        self.model.lost("The server has gone.", self.now)
        self.now += 2.0
        self.tabui = TabUI(self, self)
        self.stage = Stage(participant=self.tabui, history=self.stage.log.entries, **self.staged)
        self.model.connected(self.now)

    @property
    def screen(self) -> Screen:
        return self.model.screen(self.now)

    @property
    def view(self) -> View:
        return self.tabui.view

    def run(self, ticks: int = 12) -> Screen:
        for _ in range(ticks):
            self.now += TICK
            self.tabui.poll_player()
            self.stage.run(1)
        return self.screen

    def do(self, act: Act, ticks: int = 12) -> Screen:
        """Do what is offered; it must be there and possible."""
        action = self.offered(act)
        assert action is not None, f"{act} is not offered"
        assert action.enabled, f"{act} is not possible: {action.hint}"
        self.model.do(act, self.now)
        return self.run(ticks)

    def press(self, act: Act, ticks: int = 12) -> Screen:
        """Do it whether or not anything offers it."""
        self.model.do(act, self.now)
        return self.run(ticks)

    def offered(self, act: Act) -> Action | None:
        return offer(self.screen, act)

    def offers(self) -> list[Action]:
        return list(offers(self.screen))
