"""Lobby of games with several people: who plays with whom, and when."""

from dataclasses import dataclass, field

from ui.web.gateway.lobby import ServedLobby
from ui.web.gateway.matching import MatchByArrival, MatchedGame


@dataclass
class LobbyAndPeople:
    """Lobby with a clock, the people whose browsers are connected, and the games that have started."""

    now: float = 100.0
    room: int = 10
    here: set[str] = field(default_factory=set)
    games: list[MatchedGame] = field(default_factory=list)

    def __post_init__(self) -> None:
        matching = MatchByArrival(("north", "south"), lambda: f"game-{len(self.games)}", longest=60.0)
        self.lobby = ServedLobby(matching, self.begin, lambda: self.room, lambda: self.now)

    def begin(self, game: MatchedGame) -> None:
        self.games.append(game)
        self.room -= 1

    def enter(self, *people: str) -> None:
        for person in people:
            self.here.add(person)
            self.lobby.enter(person, lambda person=person: person in self.here)  # type: ignore[misc]

    def placed(self, person: str) -> bool:
        game, _ = self.lobby.look(person)
        return game is not None


def test_seats_are_filled_by_arrival_when_all_people_are_there() -> None:
    at = LobbyAndPeople()
    at.enter("P-1")
    assert not at.placed("P-1")
    at.enter("P-2", "P-3")
    assert at.placed("P-1")
    assert at.placed("P-2")
    assert not at.placed("P-3")
    (game,) = at.games
    assert game.people == {"north": "P-1", "south": "P-2"}
    assert game.seat_of("P-2") == "south"


def test_a_person_who_is_not_connected_takes_no_place_and_blocks_nobody() -> None:
    at = LobbyAndPeople()
    at.enter("P-1", "P-2")
    at.here.remove("P-1")
    assert not at.placed("P-2")
    at.enter("P-3")
    assert at.placed("P-3")
    assert at.games[0].people == {"north": "P-2", "south": "P-3"}
    # A person who comes back waits behind all others.
    at.enter("P-4")
    assert not at.placed("P-4")
    at.here.add("P-1")
    assert at.placed("P-1")
    assert at.games[1].people == {"north": "P-4", "south": "P-1"}


def test_nobody_is_placed_before_a_game_can_start() -> None:
    at = LobbyAndPeople(room=0)
    at.enter("P-1", "P-2")
    assert not at.placed("P-1")
    at.lobby.leave("P-1")
    at.enter("P-3", "P-4", "P-5")
    at.now += 20.0
    assert not at.placed("P-3")
    assert at.lobby.seconds == {"P-2": 20.0, "P-3": 0.0, "P-4": 0.0, "P-5": 0.0}
    at.room = 1
    assert at.placed("P-3")
    assert not at.placed("P-4")
    assert [game.people for game in at.games] == [{"north": "P-2", "south": "P-3"}]
    assert [*at.lobby.seconds] == ["P-4", "P-5"]


def test_a_wait_ends_after_the_longest_time_of_the_rule() -> None:
    at = LobbyAndPeople()
    at.enter("P-1")
    assert at.lobby.look("P-1") == (None, False)
    at.now += 60.1
    assert at.lobby.look("P-1") == (None, True)
    at.enter("P-2")
    assert not at.placed("P-2"), "a person whose wait has ended is not matched any more"
