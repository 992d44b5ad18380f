"""Tables name a researcher as the holder of a seat for the time in which the researcher played it."""

from thbridge.experiment.export.families.game_recording import TimedTeamEntry
from thbridge.experiment.export.families.group_games import is_researchers
from thbridge.hunt.events import SeatLeft, SeatTaken
from thbridge.hunt.seats import PlayedBy


def test_a_researcher_holds_a_seat_from_taking_it_until_the_person_is_back() -> None:
    entries = (
        SeatTaken("driver", 0.0),
        SeatLeft("driver", 10.0),
        SeatTaken("driver", 12.0, PlayedBy.RESEARCHER),
        SeatTaken("namer", 14.0),
        SeatTaken("driver", 20.0),
        SeatTaken("driver", 30.0, PlayedBy.RESEARCHER),
        SeatLeft("driver", 40.0),
    )
    team = [TimedTeamEntry(entry.at, entry) for entry in entries]
    times = (5.0, 11.0, 12.0, 19.0, 20.0, 35.0, 41.0)
    held = [is_researchers(team, "driver", time) for time in times]
    assert held == [False, False, True, True, False, True, False]
    assert not any(is_researchers(team, "namer", time) for time in times)
