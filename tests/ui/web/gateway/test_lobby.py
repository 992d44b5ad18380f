"""Lobby of games with several people: who plays with whom, and when."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from ui.web.gateway.lobby import Lobby
from ui.web.gateway.matching import MatchByArrival, WaitingPerson

RULE = MatchByArrival(("north", "south"), longest=60.0)


@dataclass
class LobbyAndPeople:
    """Lobby with a clock, the people whose browsers are connected, and the games that have started."""

    now: float = 100.0
    room: int = 10
    here: set[str] = field(default_factory=set)
    games: list[Mapping[str, str]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.lobby = Lobby(RULE, self.begin, lambda: self.room > 0, lambda: self.now)

    def begin(self, people: Mapping[str, str]) -> str:
        self.games.append(people)
        self.room -= 1
        return f"game-{len(self.games)}"

    def enter(self, *people: str) -> None:
        for person in people:
            self.here.add(person)
            self.lobby.enter(person, lambda person=person: person in self.here)  # type: ignore[misc]


def test_seats_are_filled_by_arrival_when_all_people_are_there() -> None:
    waiting = [WaitingPerson("P-1", 1.0), WaitingPerson("P-2", 2.0), WaitingPerson("P-3", 3.0)]
    assert RULE.next_game(waiting[:1], 5.0) is None
    assert RULE.next_game(waiting, 5.0) == {"north": "P-1", "south": "P-2"}
    assert not RULE.ends_wait(waiting[0], 61.0)
    assert RULE.ends_wait(waiting[0], 61.1)


def test_a_person_who_is_not_connected_takes_no_place_and_blocks_nobody() -> None:
    at = LobbyAndPeople()
    at.enter("P-1", "P-2")
    at.here.remove("P-1")
    assert at.lobby.place("P-2") is None
    at.enter("P-3")
    place = at.lobby.place("P-3")
    assert place is not None
    assert (place.seat, place.people) == ("south", {"north": "P-2", "south": "P-3"})
    assert at.lobby.take_place("P-2") is not None
    assert at.lobby.take_place("P-2") is None, "a place is taken once"
    at.here.add("P-1")
    at.enter("P-4")
    assert at.lobby.place("P-1") is not None
    assert len(at.games) == 2


def test_nobody_is_placed_before_a_game_can_start() -> None:
    at = LobbyAndPeople(room=0)
    at.enter("P-1", "P-2")
    assert at.lobby.place("P-1") is None
    at.lobby.leave("P-1")
    at.enter("P-3")
    at.room = 1
    at.now += 20.0
    assert [*at.lobby.seconds.items()] == [("P-2", 20.0), ("P-3", 20.0)]
    assert at.lobby.place("P-3") is not None
    assert at.games == [{"north": "P-2", "south": "P-3"}]
    assert not at.lobby.seconds


def test_a_wait_is_over_after_the_longest_time_of_the_rule() -> None:
    at = LobbyAndPeople()
    at.enter("P-1")
    at.now += 60.0
    assert not at.lobby.waits_too_long("P-1")
    at.now += 0.1
    assert at.lobby.waits_too_long("P-1")
