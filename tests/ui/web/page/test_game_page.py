"""The page of a game offers what the screen offers, and has no other words."""

import pytest

from tests.support.windows import sample_screens
from thbridge.files.language_texts import shipped_texts
from ui.model.playing.keys import act_for
from ui.model.playing.offers import offers
from ui.model.playing.screen import Screen
from ui.web.page.game_page import KEYS, BrowserPage, BrowserPageMaker, PageButton
from ui.web.page.patches import tree

STATES = sample_screens.states()


def page_of(screen: Screen) -> BrowserPage:
    maker = BrowserPageMaker(lambda picture: "" if picture is None else "picture")
    return maker.page(shipped_texts(), screen, (), None)


def buttons(value: object) -> list[PageButton]:
    """Return all buttons of a page."""
    match value:
        case PageButton():
            return [value]
        case tuple():
            return [each for part in value for each in buttons(part)]
        case _ if hasattr(value, "__dataclass_fields__"):
            return [each for name in value.__dataclass_fields__ for each in buttons(getattr(value, name))]
        case _:
            return []


@pytest.mark.parametrize("name", STATES)
def test_each_state_offers_the_acts_of_its_screen(name: str) -> None:
    screen = STATES[name]
    page = page_of(screen)
    shown = {repr(button.act) for button in buttons(page)}
    assert {repr(action.act) for action in offers(screen)} <= shown
    assert set(page.keys) == {key for key in KEYS if act_for(key, screen) is not None}
    assert isinstance(tree(page), dict)
