"""Labels lie beside their robots, off one another, and do not hop about."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PySide6.QtGui import QFont

from tests.support.maps.sample_maps import robot_at
from thbridge.files.language_texts import shipped_texts
from ui.model.shared.theme import LIGHT
from ui.windows.map.badges import SIGN_WIDTH, Anchor, Badges, BadgeText, place_labels
from ui.windows.map.lettering import USUAL, fitting_font, text_scale
from ui.windows.map.words import describe

NOWHERE = np.empty((0, 4))

spots = st.lists(st.tuples(st.floats(0.0, 1000.0), st.floats(0.0, 700.0)), min_size=1, max_size=20)


def anchors(at: list[tuple[float, float]]) -> list[Anchor]:
    return [Anchor(x, y, 18.0, 22.0, 20.0) for x, y in at]


def overlap(corners: np.ndarray) -> float:
    total = 0.0
    for one in range(len(corners)):
        for other in range(one):
            across = 22.0 - abs(corners[one, 0] - corners[other, 0])
            down = 20.0 - abs(corners[one, 1] - corners[other, 1])
            total += max(across, 0.0) * max(down, 0.0)
    return total


def test_a_lone_label_lies_above_its_robot() -> None:
    corners, _ = place_labels(anchors([(100.0, 100.0)]), [-1], NOWHERE)
    assert corners[0, 0] == 100.0 - 11.0
    assert corners[0, 1] + 20.0 < 100.0 - 18.0


def test_labels_of_a_row_of_robots_do_not_overlap() -> None:
    row = [(100.0 + 24.0 * k, 100.0 + 10.0 * (k % 3)) for k in range(20)]
    assert overlap(place_labels(anchors(row), [-1] * 20, NOWHERE)[0]) == 0.0


def test_labels_of_robots_in_one_place_do_not_overlap() -> None:
    assert overlap(place_labels(anchors([(100.0, 100.0)] * 10), [-1] * 10, NOWHERE)[0]) == 0.0


@given(spots)
def test_a_second_look_changes_nothing(at: list[tuple[float, float]]) -> None:
    first, places = place_labels(anchors(at), [-1] * len(at), NOWHERE)
    second, again = place_labels(anchors(at), places, NOWHERE)
    third, _ = place_labels(anchors(at), again, NOWHERE)
    assert np.array_equal(second, third)
    assert overlap(second) <= overlap(first) + 1e-9


def test_a_label_stays_while_it_is_in_nobodys_way() -> None:
    _, places = place_labels(anchors([(100.0, 100.0), (100.0, 70.0)]), [-1, -1], NOWHERE)
    _, later = place_labels(anchors([(300.0, 100.0), (100.0, 70.0)]), places, NOWHERE)
    assert later == places


def test_a_label_leaves_words_readable() -> None:
    above = np.array([[80.0, 50.0, 160.0, 90.0]])
    corners, places = place_labels(anchors([(100.0, 100.0)]), [-1], above)
    assert corners[0, 1] > 90.0
    assert place_labels(anchors([(100.0, 100.0)]), [0], above)[1] == places, "it moves away where it lay on words"


def test_a_label_grows_by_the_words_on_who_commands_its_robot(qtbot) -> None:
    badges, font = Badges(), QFont()
    own = BadgeText("1", LIGHT.robot(0), selected=False, trouble=False, commander="")
    narrow = badges.of(own, LIGHT, font, 1.0)
    wide = badges.of(replace(own, commander="ground station 255"), LIGHT, font, 1.0)
    assert wide.width > narrow.width + SIGN_WIDTH and badges.of(own, LIGHT, font, 1.0) is narrow


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("en", "Map: 0 rooms; robot 1 in the corridor, commanded by QGC; robot 2 in the corridor, in trouble."),
        ("de", "Karte: 0 Räume; Roboter 1 im Flur, gesteuert durch QGC; Roboter 2 im Flur, in Schwierigkeiten."),
    ],
)
def test_the_map_in_words_says_who_commands_a_robot(language: str, words: str) -> None:
    taken = replace(robot_at(0, 0.0, 0.0), commander="QGC")
    other = replace(robot_at(1, 1.0, 1.0), trouble=True)
    assert describe(shipped_texts(language), (), (taken, other)) == words


def test_a_label_is_as_large_as_the_text(qtbot) -> None:
    badges, text = Badges(), BadgeText("1", LIGHT.robot(0), selected=False, trouble=True, commander="")
    usual, large = QFont(), QFont()
    usual.setPointSizeF(USUAL)
    large.setPointSizeF(2.0 * USUAL)
    small, twice = (badges.of(text, LIGHT, font, 1.0) for font in (usual, large))
    assert (twice.width, twice.height) == (2.0 * small.width, 2.0 * small.height)
    assert twice.picture.width() == 2 * small.picture.width()


def test_letters_grow_on_large_maps_only() -> None:
    large = QFont()
    large.setPointSizeF(2.0 * USUAL)
    assert text_scale(fitting_font(large, 1200, 900)) == 2.0
    assert 1.0 < text_scale(fitting_font(large, 600, 500)) < 2.0
    assert text_scale(fitting_font(large, 300, 200)) == 1.0
