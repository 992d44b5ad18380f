"""Rules in sentences, with the numbers of a game."""

import msgspec.structs as structs
import pytest

from tests.support.hunts.participant_views import view
from thbridge.files.language_texts import shipped_texts
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
