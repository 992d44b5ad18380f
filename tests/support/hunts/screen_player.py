"""Participant who only looks at screens and uses what they offer, in a real game without a simulator."""

from tests.support.hunts.hunt_without_simulator import HuntWithoutSimulator
from tests.support.windows.english import said_by_others
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.view import View
from ui.model.playing.offers import offer, offers
from ui.model.playing.participant import Participant
from ui.model.playing.screen import (
    Act,
    Action,
    AnswerDialogueAct,
    ChooseRobot,
    DialoguePopup,
    IdentifyTreasureAct,
    LeaveTreasureAct,
    Phase,
    PickName,
    RequestSuggestionAct,
    Screen,
    SelectRoomAct,
    ShowNext,
    TakePictureAct,
    TreasurePopup,
)

TICK = 0.02


class ScreenPlayer:
    """View model in a hunt; acts are done only if the screen offers them.

    Attributes:
        theirs: all words shown so far that come from the study, not from the program.
    """

    def __init__(self, model: Participant | None = None, **hunt) -> None:
        self.model = model or Participant()
        self.now = 0.0
        self.theirs: set[str] = set()
        self.options = hunt
        self.tabui = TabUI(self, self)
        self.hunt = HuntWithoutSimulator(participant=self.tabui, **hunt)
        self.names = tuple(sorted({kind.name for kind in self.hunt.templates.kinds}))
        self.model.connected(self.now)
        self.run(6)

    def observe(self, level) -> None:
        if isinstance(level, View):
            self.theirs |= said_by_others(level)
        self.model.receive(level, self.now)

    def requests(self, view: View):
        return self.model.requests()

    def restart_server(self) -> None:
        """Kill the server with all its programs, and start them again from the journal."""
        self.model.lost("The server has gone.", self.now)
        self.now += 2.0
        self.tabui = TabUI(self, self)
        self.hunt = HuntWithoutSimulator(participant=self.tabui, history=self.hunt.log.entries, **self.options)
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
            self.hunt.run(1)
        return self.screen

    def do(self, act: Act, ticks: int = 12) -> Screen:
        """Do an act. The screen must offer it, and it must be enabled."""
        action = self.offered(act)
        assert action is not None, f"{act} is not offered"
        assert action.enabled, f"{act} is not possible: {action.hint}"
        self.model.do(act, self.now)
        return self.run(ticks)

    def press(self, act: Act, ticks: int = 12) -> Screen:
        """Do an act even if the screen does not offer it."""
        self.model.do(act, self.now)
        return self.run(ticks)

    def offered(self, act: Act) -> Action | None:
        return offer(self.screen, act)

    def offers(self) -> list[Action]:
        return list(offers(self.screen))


def go(seat, room):
    """Send the selected robot to a room, agree to everything it asks, and wait until it arrives."""
    seat.do(SelectRoomAct(room))
    agree(seat)
    return seat.run(30)


def agree(seat):
    while isinstance(seat.screen.popup, DialoguePopup) and seat.screen.popup.choices:
        seat.do(AnswerDialogueAct(0))


def events(seat, kind):
    return [event for event in seat.hunt.log.events if isinstance(event, kind)]


def play(seat, look=lambda screen: None):
    """Play until the hunt is over, using only what the screen offers; `look` is called with every screen."""
    for turn in range(200):
        screen = seat.screen
        look(screen)
        if screen.phase is Phase.OVER:
            break
        pop = screen.popup
        if isinstance(pop, DialoguePopup):
            agree(seat)
        elif isinstance(pop, TreasurePopup) and pop.verdict is not None:
            seat.do(ShowNext())
        elif isinstance(pop, TreasurePopup) and pop.take_picture is not None and pop.take_picture.enabled:
            seat.do(TakePictureAct())
        elif isinstance(pop, TreasurePopup):
            right = seat.hunt.session.game.treasures[pop.room - 1].name
            look(seat.press(PickName(right)))
            seat.do(IdentifyTreasureAct() if seat.offered(IdentifyTreasureAct()).enabled else LeaveTreasureAct())
        elif screen.ask_advice.enabled:
            seat.do(RequestSuggestionAct())
        elif len(screen.cards) > 1 and turn % 2:
            seat.do(ChooseRobot(1 - next(card.robot for card in screen.cards if card.selected)))
        else:
            seat.run(20)
