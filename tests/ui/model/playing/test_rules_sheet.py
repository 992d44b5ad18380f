"""Rules in sentences, with the numbers of a game."""

from pathlib import Path

import msgspec.structs as structs
import pytest

from tests.support.hunts.participant_views import view
from thbridge.files.language_texts import shipped_texts
from thbridge.study.study_file import load_study
from ui.command_line.settings import setting_of
from ui.hosting.games import offer_of
from ui.model.playing.rules_sheet import rules_lines, rules_of


def sheet(**fields: object) -> str:
    return " ".join(rules_of(shipped_texts(), structs.replace(view(), **fields)))


@pytest.mark.parametrize(
    ("share", "told"),
    [
        (None, "A wrong name may lose points."),
        (0.0, "A wrong name loses no points."),
        (1.0, "A wrong name loses the same number of points."),
        (0.125, "A wrong name loses 12.5% of these points."),
        (0.001, "A wrong name loses 0.1% of these points."),
    ],
)
def test_the_share_lost_for_a_wrong_name_is_the_games(share: float | None, told: str) -> None:
    assert told in sheet(wrong_share=share)


def test_moves_are_those_to_rooms() -> None:
    costs = ((None, 12.0, 40.0), (2.0, None, 20.0), (99.5, 30.0, None))
    rooms = view().rooms[:2]
    assert "A move costs 12 to 40 energy. A picture" in sheet(costs=costs, rooms=rooms)


def test_moves_priced_by_position_are_told_from_room_to_room() -> None:
    costs = ((None, None, None), (None, None, 20.0), (None, 30.0, None))
    told = sheet(costs=costs, rooms=view().rooms[:2], by_position=True)
    assert "A move costs energy for its length and its turns: from room to room between 20 and 30. A picture" in told


def test_before_a_game_it_is_told_what_moves_priced_by_position_cost_energy_for() -> None:
    told = rules_lines(shipped_texts(), picture_cost=3.0, identify_cost=2.0, by_position=True)
    assert "A move costs energy for its length and its turns. A picture costs 3" in " ".join(told)


def test_what_is_left_for_good_is_what_the_participant_sends_a_robot_on_from() -> None:
    assert "When you send the robot on, a treasure that you have not named is left for good." in sheet()


SEATS = """
robots: 2
seats:
  - {name: driver, robots: [1, 2], names_treasures: false, sees_energy: false, stops: none}
  - {name: namer, takes_over: false, ends_game: false, sees_map: false, sees_score: false, sees_dialogues: own}
"""


def offered(tmp_path: Path, seat: str) -> tuple[str, ...]:
    file = tmp_path / "study.yaml"
    file.write_text(SEATS, encoding="utf-8")
    return offer_of(setting_of(load_study(file).value, file), given=True, seat=seat).rules


def test_the_start_page_names_the_rights_of_a_seat_and_no_amount_that_it_does_not_see(tmp_path: Path) -> None:
    you, *rules = offered(tmp_path, "driver")
    assert you == (
        "In this game, you are the driver. You play together with the namer. You command robot 1 and robot 2. "
        "You may take over robots and end the game early. You may not name treasures or stop robots. "
        "You do not see the energy of the robots."
    )
    assert "A move, a picture and a name cost energy." in rules
    assert not any("starts with" in rule for rule in rules)
    you, *rules = offered(tmp_path, "namer")
    assert you == (
        "In this game, you are the namer. You play together with the driver. You command no robot. "
        "You may name treasures. You may not take over robots or end the game early. "
        "You do not see the map, the score or what robots and other people say to each other."
    )
    assert any("Each robot starts with" in rule for rule in rules)
    assert not any("end it earlier" in rule for rule in rules)


def test_before_the_seats_are_known_the_rules_hold_for_all_of_them(tmp_path: Path) -> None:
    first, *rules = offered(tmp_path, "")
    assert first.startswith("These people play this game together: the driver and the namer.")
    assert not any("starts with" in rule or "In this game, you are" in rule for rule in rules)
    assert any("end it earlier" in rule for rule in rules)
