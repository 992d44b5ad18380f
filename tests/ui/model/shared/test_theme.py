"""Every state in the windows can be read and told apart, by figures."""

from itertools import combinations
from typing import get_args

import pytest

from ui.model.shared.scene import RoomState
from ui.model.shared.theme import DARK, LIGHT, SIMULATED, Palette, Vision, contrast, difference

PALETTES = pytest.mark.parametrize("palette", [LIGHT, DARK], ids=["light", "dark"])
VISIONS = pytest.mark.parametrize("vision", sorted(SIMULATED))
TEXT, SIGN = 4.5, 3.0
"""WCAG 2.2 AA, criteria 1.4.3 and 1.4.11."""


def floors(palette: Palette) -> list[str]:
    return [palette.room(state) for state in get_args(RoomState)]


def grounds(palette: Palette) -> list[str]:
    return [palette.window, palette.panel, palette.floor, *floors(palette)]


@PALETTES
@pytest.mark.parametrize("role", ["text", "muted", "accent", "good"])
def test_text_can_be_read_on_every_ground(palette: Palette, role: str) -> None:
    assert all(contrast(getattr(palette, role), ground) >= TEXT for ground in grounds(palette))


@PALETTES
def test_text_can_be_read_where_a_button_is_pointed_at(palette: Palette) -> None:
    for role in (palette.text, palette.muted, palette.accent):
        assert contrast(role, palette.track) >= TEXT
    assert contrast(palette.line, palette.track) >= SIGN


@PALETTES
def test_bad_news_can_be_read(palette: Palette) -> None:
    assert all(contrast(palette.bad, ground) >= TEXT for ground in (palette.window, palette.panel))


@PALETTES
def test_text_on_fillings_can_be_read(palette: Palette) -> None:
    assert contrast(palette.on_accent, palette.accent) >= TEXT
    assert all(contrast(palette.panel, robot) >= TEXT for robot in palette.robots), "the number on a robot's chip"


@PALETTES
def test_edges_and_robots_show_on_every_ground(palette: Palette) -> None:
    for ground in grounds(palette):
        assert contrast(palette.line, ground) >= SIGN
        assert all(contrast(robot, ground) >= SIGN for robot in palette.robots)
    assert contrast(palette.wall, palette.floor) >= SIGN


@PALETTES
@VISIONS
def test_robots_and_rooms_look_different_to_everybody(palette: Palette, vision: Vision) -> None:
    for one, other in combinations(palette.robots, 2):
        assert difference(one, other, vision) >= 15.0
    for one, other in combinations(floors(palette), 2):
        assert difference(one, other, vision) >= 6.0
    assert difference(palette.good, palette.bad, vision) >= 15.0


def test_known_figures_of_contrast_and_difference() -> None:
    assert contrast("#ffffff", "#000000") == pytest.approx(21.0)
    assert contrast("#777777", "#ffffff") == pytest.approx(4.48, abs=0.01)
    assert difference("#ffffff", "#000000") == pytest.approx(100.0, abs=0.01)
    assert difference("#ff0000", "#00ff00") == pytest.approx(170.6, abs=0.3)
    assert difference("#ff0000", "#00ff00", "deutan") < 0.6 * difference("#ff0000", "#00ff00")


@VISIONS
def test_grey_stays_grey_in_every_eye(vision: Vision) -> None:
    assert difference("#808080", "#818181", vision) < 1.0
