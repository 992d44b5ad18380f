"""A hunt with simulated robots in their house, by the keys that the screen offers."""

import dataclasses
from pathlib import Path

import pytest

from thbridge.app.compose.game import build_hider, build_keeper
from thbridge.app.compose.robots import build_simr
from thbridge.app.compose.setting import read_setting
from thbridge.app.session.session import Session
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.view import View
from thbridge.study.study_file import Study
from ui.model.playing.keys import act_for
from ui.model.playing.participant import Participant
from ui.model.playing.screen import DialoguePopup, Phase, Screen, TreasurePopup

ROBOTS = 2
MINUTES = 12


def key_for(screen: Screen) -> str | None:
    """The key that a participant who trusts the robots presses now."""
    match screen.popup:
        case DialoguePopup(choices=choices):
            return "Enter" if choices else None
        case TreasurePopup() as found if found.verdict is not None:
            return "Enter"
        case TreasurePopup() as found if found.take_picture is not None and found.take_picture.enabled:
            return "Ctrl+P"
        case TreasurePopup() as found if found.picked is None and found.names:
            return "Down"
        case TreasurePopup() as found:
            return "Enter" if found.name_it.enabled else "Ctrl+L" if found.name_it.hint.startswith("Naming") else None
    return "D" if screen.ask_advice.enabled else "Tab"


class Table:
    def __init__(self) -> None:
        setting = read_setting(dataclasses.replace(Study(), robots=ROBOTS), Path())
        self.model, self.now = Participant(), 0.0
        self.tabui = TabUI(self, self)
        roles = [build_simr(setting), build_hider(setting.templates, setting.study.seed)]
        self.session = Session(build_keeper(setting), roles, [], self.tabui)
        self.model.connected(0.0)

    def observe(self, level) -> None:
        self.model.receive(level, self.now)

    def requests(self, view: View):
        return self.model.requests()

    def step(self) -> Screen:
        self.now += 0.02
        self.tabui.poll_player()
        self.session.step()
        return self.model.screen(self.now)


@pytest.mark.slow
def test_a_hunt_with_robots_is_shown_as_it_goes():
    table = Table()
    progress = [0.0] * ROBOTS
    states: set[str] = set()
    for tick in range(MINUTES * 60 * 50):
        screen = table.step()
        if screen.phase is Phase.OVER:
            break
        assert screen.banner is None or screen.banner.kind == "note", screen.banner
        marks = table.model.robots(table.now)
        for card in screen.cards:
            states.add(card.state.split(" room")[0])
            # A longer way than was planned at first makes it a smaller share.
            assert card.progress is None or card.progress >= progress[card.robot] - 0.35
            progress[card.robot] = card.progress or 0.0
            if marks and card.progress is not None and 0.1 < card.progress < 0.9:
                assert len(marks[card.robot].path) > 1
                assert len(marks[card.robot].trail) > 1
        if screen.phase is Phase.PLAYING and tick % 20 == 0 and (key := key_for(screen)) is not None:
            act = act_for(key, screen)
            assert act is not None, key
            table.model.do(act, table.now)
    assert table.model.screen(table.now).phase is Phase.OVER
    assert sum(tile.state == "visited" for tile in table.model.screen(table.now).tiles) >= 6
    assert {"traveling to", "ready", "found something"} <= states
    assert len(table.model.rooms(table.now)) == 8
