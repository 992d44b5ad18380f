"""Several people in one hunt without a simulator, each with the model of their screen."""

import math
from collections.abc import Sequence
from dataclasses import replace

from sim.common.observations import TICK
from tests.support.hunts.hunt_without_simulator import RULES, HuntWithoutSimulator
from thbridge.files.language_texts import shipped_texts
from thbridge.hunt.events import DecisionKind
from thbridge.hunt.seats import Seat, StopRight
from thbridge.roles.keeper.team.decisions import AgreementRule, VotingRules
from thbridge.roles.keeper.team.game_team import TeamRules
from thbridge.roles.keeper.team.people_talk import TalkRules
from thbridge.roles.participant.tabui import ParticipantUpdate, TabUI
from thbridge.roles.shared.view import ParticipantRequest, View
from ui.hosting.terminal_player import TerminalPlayer
from ui.model.playing.participant import Participant
from ui.model.playing.screen import Act, PeoplePanel, Screen

SEATS = (
    Seat("driver", "the driver", robots=(0, 1), names_treasures=False),
    Seat("namer", "the namer", stops=StopRight.ALL),
    Seat("scout", "the scout", robots=(2,), takes_over=False),
)

ALL_AGREE = VotingRules(dict.fromkeys(DecisionKind, AgreementRule.ALL), timeout=60.0)


class PersonInHunt:
    """Person in a seat.

    Attributes:
        model: model of the person's screen.
        away: True while the person's connection is lost: no message arrives.
    """

    def __init__(self, seat: str, run: str = "run") -> None:
        self.seat = seat
        self.model = Participant()
        self.tabui = TabUI(self, self, seat=seat)
        self.tabui.run = run
        self.away = False
        self.now = 0.0

    def requests(self, view: View) -> Sequence[ParticipantRequest]:
        return () if self.away else self.model.requests()

    def observe(self, level: ParticipantUpdate) -> None:
        if not self.away:
            self.model.receive(level, self.now)

    def do(self, act: Act) -> None:
        self.model.screen(self.now)
        self.model.do(act, self.now)
        self.tabui.poll_player()

    @property
    def screen(self) -> Screen:
        return self.model.screen(self.now)

    @property
    def panel(self) -> PeoplePanel:
        assert self.screen.people is not None
        return self.screen.people

    @property
    def history(self) -> list[str]:
        return [line.text for line in self.screen.history]

    @property
    def read(self) -> list[tuple[str, str]]:
        """Texts on the panel: author, and words."""
        return [(text.who, text.text) for text in self.panel.texts]


class PersonAtTerminal:
    """Person who plays in a seat at the terminal.

    Attributes:
        lines: printed lines.
    """

    def __init__(self, seat: str) -> None:
        texts = shipped_texts()
        self.lines: list[str] = []
        self.player = TerminalPlayer(self.lines.append, lambda: self.tabui.room_names, lambda: texts)
        self.tabui = TabUI(self.player, seat=seat, talk=self.player.talk.hear)

    def type(self, line: str) -> None:
        self.player.type(line)
        self.tabui.poll_player()


class HuntOfPeople:
    """Hunt in which people with these seats play, one of them at a terminal if `at_terminal` names a seat.

    Attributes:
        people: the people, by the names of their seats, except the person at the terminal.
        terminal: the person at the terminal.
    """

    def __init__(
        self,
        seats: Sequence[Seat] = SEATS,
        opens: float = 0.0,
        closes: float = math.inf,
        at_terminal: str = "",
        voting: VotingRules | None = None,
    ) -> None:
        self.people = {seat.name: PersonInHunt(seat.name) for seat in seats if seat.name != at_terminal}
        self.terminal = PersonAtTerminal(at_terminal)
        talk = TalkRules(opens, closes)
        team = TeamRules(talk) if voting is None else TeamRules(talk, voting)
        rules = replace(RULES, seats=tuple(seats), team=team)
        first, *others = (person.tabui for person in self.people.values())
        others += [self.terminal.tabui] if at_terminal else []
        self.hunt = HuntWithoutSimulator(robots=3, rules=rules, participant=first, others=others)

    def run(self, ticks: int = 8) -> None:
        for _ in range(ticks):
            for person in self.people.values():
                person.now += TICK
            self.hunt.run(1)
