"""Seats of a study: who plays, and what each participant may do and see."""

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

from msgspec import UNSET

from sim.common.robot_numbers import index_of, robot_numbers
from sim.parameters import param
from thbridge.dialogue.games.strategies import Attitude
from thbridge.files.errors import BadFile
from thbridge.files.plugins import PARTICIPANTS
from thbridge.files.yaml.load import Loaded
from thbridge.hunt.events import DecisionKind
from thbridge.hunt.seats import MOST_SEATS, SEAT_NAME, DialogueSight, Seat, StopRight
from thbridge.roles.keeper.team.decisions import AgreementRule, VotingRules
from thbridge.roles.keeper.team.game_team import TeamRules
from thbridge.roles.keeper.team.people_talk import TalkRules
from thbridge.roles.participant.bot_strategy import BotStrategy

S = TypeVar("S")
LONGEST_LABEL = 60
"""Greatest length of the words for a seat, characters."""


@dataclass(frozen=True, slots=True)
class SeatEntry:
    """A seat: the place of one participant in a game of several."""

    name: str = field(metadata={"help": "name of the seat in recordings: small letters, digits and hyphens"})
    label: str = param("", "words for the seat in sentences, such as `the driver`; if empty, `the` and its name")
    robots: tuple[int, ...] = param((), "numbers of the robots that the seat commands at the start")
    takes_over: bool = param(True, "the seat may take over robots that other seats hand over, if it talks with robots")
    names_treasures: bool = param(
        True, "the seat may name treasures, leave them, and report properties that only people recognize"
    )
    stops: StopRight = param(StopRight.OWN, "robots that the seat may stop: none, its own, or all")
    talks: bool = param(True, "the seat may have dialogues with robots")
    ends_game: bool = param(True, "the seat may end the game early")
    sees_dialogues: DialogueSight = param(
        DialogueSight.ALL, "dialogues with robots that the seat sees: its own, or those of all seats"
    )
    objects: bool = param(False, "the seat may object in dialogues of other seats that it sees")
    sees_energy: bool = param(True, "the seat sees the robots' energy, and the costs of moves")
    sees_map: bool = param(True, "the seat sees the map and the robots on it")
    sees_score: bool = param(True, "the seat sees the score, and the points of treasures")
    strategy: str | None = param(
        None,
        "how a simulated participant in this seat chooses rooms, as in participant.strategy; if null, "
        "participant.strategy applies",
        choices=tuple(each.value for each in BotStrategy),
        plugins=PARTICIPANTS.group,
    )
    attitude: Attitude | None = param(
        None, "how a simulated participant in this seat replies to robots; if null, participant.attitude applies"
    )

    def seat(self) -> Seat:
        """Return the seat of the game."""
        return Seat(
            name=self.name,
            label=self.label or f"the {self.name}",
            robots=tuple(index_of(robot) for robot in self.robots),
            takes_over=self.takes_over,
            names_treasures=self.names_treasures,
            stops=self.stops,
            talks=self.talks,
            ends_game=self.ends_game,
            sees_dialogues=self.sees_dialogues,
            sees_energy=self.sees_energy,
            sees_map=self.sees_map,
            sees_score=self.sees_score,
            objects=self.objects or UNSET,
        )


@dataclass(frozen=True, slots=True)
class TalkSection:
    """Texts that the participants of a game send to each other."""

    on: bool = param(True, "participants may send texts to each other")
    opens: float = param(0.0, "simulated time from which participants may send texts", "s", 0, 1e6)
    closes: float | None = param(
        None,
        "simulated time from which participants can no longer send texts; if null, they can until the end",
        "s",
        0,
        1e6,
    )

    def rules(self) -> TalkRules:
        """Return the rules of the game."""
        closes = math.inf if self.closes is None else self.closes
        return TalkRules(self.opens if self.on else math.inf, closes)


@dataclass(frozen=True, slots=True)
class AgreementSection:
    """Decisions on which several participants vote. All participants who are present may vote."""

    send: AgreementRule = param(
        AgreementRule.ONE, "participants who must agree before a robot drives to a room: one, two, majority or all"
    )
    name: AgreementRule = param(AgreementRule.ONE, "participants who must agree on the name of a treasure")
    end: AgreementRule = param(AgreementRule.ALL, "participants who must agree to end the game early")
    timeout: float = param(60.0, "time after which an open vote ends without a decision", "s", 1, 3600)

    def rules(self) -> VotingRules:
        """Return the rules of the game."""
        kinds = {DecisionKind.SEND: self.send, DecisionKind.NAME: self.name, DecisionKind.END: self.end}
        return VotingRules(kinds, self.timeout)


@dataclass(frozen=True, slots=True)
class TeamSection:
    """Participants of a game with several seats. It has no effect on games with one participant."""

    talk: TalkSection = param(TalkSection(), "texts that the participants send to each other")
    agreement: AgreementSection = param(AgreementSection(), "decisions on which several participants vote")

    def rules(self) -> TeamRules:
        """Return the rules of the game."""
        return TeamRules(self.talk.rules(), self.agreement.rules())


def seats_of(entries: Sequence[SeatEntry]) -> tuple[Seat, ...]:
    """Return the seats of a game."""
    return tuple(entry.seat() for entry in entries)


def faults_of_seats(
    loaded: Loaded[S], entries: Sequence[SeatEntry], robots: int, talk: TalkSection
) -> Iterator[BadFile]:
    """Yield faults of seats: seats that can do nothing, acts that no seat can do, and contradictions.

    Args:
        loaded: the study.
        entries: the seats.
        robots: number of robots in the team.
        talk: texts of the participants.
    """
    if entries and not 2 <= len(entries) <= MOST_SEATS:
        remedy = f"Write 2 to {MOST_SEATS} seats; for a game with one participant, delete the key"
        yield loaded.fault("seats", f"a game cannot have {len(entries)} of them", remedy)
    numbers = Counter(robot for entry in entries for robot in {*entry.robots})
    names = Counter(entry.name for entry in entries)
    for index, entry in enumerate(entries):
        key = f"seats[{index}]"
        if not SEAT_NAME.fullmatch(entry.name):
            problem = f"{entry.name!r} is no name of a seat"
            yield loaded.fault(f"{key}.name", problem, "Write 1 to 20 small letters, digits and hyphens")
        elif names[entry.name] > 1:
            yield loaded.fault(f"{key}.name", f"two seats are called {entry.name}", "Give each seat its own name")
        if not (entry.label.isprintable() and len(entry.label) <= LONGEST_LABEL):
            problem = f"the words for a seat must be one line of at most {LONGEST_LABEL} characters"
            yield loaded.fault(f"{key}.label", problem, "Write a shorter text")
        for robot in entry.robots:
            if not 1 <= robot <= robots:
                problem = f"there is no robot {robot}: the study has {robots}"
                yield loaded.fault(f"{key}.robots", problem, f"Write a number from 1 to {robots}, or increase `robots`")
            elif numbers[robot] > 1:
                problem = f"two seats command robot {robot}"
                yield loaded.fault(f"{key}.robots", problem, "Write each robot for only one seat")
        if entry.robots and not entry.talks:
            problem = f"{entry.name} commands robots but does not talk with them, so they never agree to a move"
            yield loaded.fault(f"{key}.talks", problem, "Write true")
        if entry.objects and entry.sees_dialogues is not DialogueSight.ALL:
            problem = f"{entry.name} sees no dialogue of another seat, so it cannot object"
            yield loaded.fault(f"{key}.objects", problem, "Write `sees_dialogues: all`, or delete `objects`")
        if not (
            entry.robots
            or (entry.takes_over and entry.talks)
            or entry.names_treasures
            or entry.stops is StopRight.ALL
            or entry.objects
        ):
            problem = f"{entry.name} can do nothing: it commands no robot, takes over none, and names no treasure"
            yield loaded.fault(key, problem, "Write `robots`, `takes_over: true` or `names_treasures: true`")
    if entries:
        missing = [robot for robot in robot_numbers(robots) if robot not in numbers]
        if missing:
            listed = ", ".join(map(str, missing))
            problem = f"no seat commands robot {listed}" if len(missing) == 1 else f"no seat commands robots {listed}"
            yield loaded.fault("seats", problem, "Write each robot in the `robots` of one seat")
        if not any(entry.names_treasures for entry in entries):
            problem = "no seat may name treasures, so every game would have 0 points"
            yield loaded.fault("seats", problem, "Write `names_treasures: true` for at least one seat")
        elif not any(entry.names_treasures and entry.talks for entry in entries):
            problem = "no seat that names treasures talks with robots, so no robot ever agrees to a name"
            yield loaded.fault("seats", problem, "Write `talks: true` for a seat with `names_treasures: true`")
        if not any(entry.ends_game for entry in entries):
            problem = "no seat may end the game early, so a game whose last room no robot reaches never ends"
            yield loaded.fault("seats", problem, "Write `ends_game: true` for at least one seat")
        if talk.on and talk.closes is not None and talk.closes <= talk.opens:
            problem = f"texts end at {talk.closes:g} s, but begin only at {talk.opens:g} s"
            yield loaded.fault("team.talk.closes", problem, "Write a later time, or `on: false`")
