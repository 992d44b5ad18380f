"""What sounds in a game, once each, and when nothing does."""

from dataclasses import dataclass, field

import pytest
from msgspec import structs

from tests.support.hunts.participant_views import asking, view, with_robot, with_room
from thbridge.roles.shared.view import IdentificationVerdict, View
from ui.model.playing.keys import act_for
from ui.model.playing.participant import Participant
from ui.model.playing.screen import GameSound, ShowHelp, SwitchSound


@dataclass
class Listener:
    """Takes views, and keeps what was heard of each screen."""

    model: Participant = field(default_factory=Participant)
    heard: list[GameSound] = field(default_factory=list)
    _number: int = 0

    def see(self, *views: View) -> list[GameSound]:
        self.heard = []
        self.model.connected(0.0)
        for seen in views:
            self.model.receive(seen, 0.0)
            screen = self.model.screen(0.0)
            if screen.sound_number != self._number:
                self._number = screen.sound_number
                self.heard.append(screen.sound)
        return self.heard


UNDER_WAY = with_room(with_robot(view(), 0, moving_to=2), 2, state="reserved", robot=0)
THERE = with_room(with_robot(view(), 0, place=2), 2, state="visited", robot=0)
SENSED = with_room(THERE, 2, sensed={"colour": "Red", "footprint": "Round"})
NAMES = {"names": ("ball", "die")}


def named(points: int) -> View:
    return structs.replace(with_room(SENSED, 2, verdict=IdentificationVerdict("ball", points)), score=points, **NAMES)


ASKS = structs.replace(view(), dialogues=(asking(1, 3),))


@pytest.mark.parametrize(
    ("before", "after", "sound"),
    [
        (UNDER_WAY, THERE, GameSound.ARRIVAL),
        (THERE, SENSED, GameSound.FIND),
        (view(), ASKS, GameSound.QUESTION),
        (ASKS, structs.replace(view(), dialogues=(asking(1, 3, turn=3),)), GameSound.QUESTION),
        (structs.replace(SENSED, **NAMES), named(20), GameSound.WON),
        (structs.replace(SENSED, **NAMES), named(-20), GameSound.LOST),
    ],
)
def test_each_kind_of_news_sounds_once(before: View, after: View, sound: GameSound):
    listener = Listener()
    assert listener.see(before) == [], "nothing sounds of what was there when the window came"
    assert listener.see(after, after) == [sound]
    assert listener.see(structs.replace(after, thinking=(1,))) == []


def test_of_several_at_once_the_most_important_one_is_heard():
    listener = Listener()
    listener.see(UNDER_WAY)
    assert listener.see(structs.replace(SENSED, dialogues=(asking(1, 3),))) == [GameSound.FIND]


def test_stopping_on_the_way_and_naming_for_nothing_are_silent():
    listener = Listener()
    listener.see(UNDER_WAY)
    assert listener.see(view()) == []
    listener.see(THERE, structs.replace(SENSED, **NAMES))
    assert listener.see(named(0)) == []


def test_nothing_sounds_again_when_the_game_is_reached_again_or_begins_anew():
    listener = Listener()
    listener.see(UNDER_WAY, THERE, SENSED)
    listener.model.lost("The server has gone.", 0.0)
    assert listener.see(SENSED) == []
    assert listener.see(structs.replace(ASKS, game=2)) == []


def test_m_switches_it_off_and_on():
    listener = Listener()
    listener.see(UNDER_WAY)
    assert act_for("M", listener.model.screen(0.0)) == SwitchSound()
    listener.model.do(SwitchSound(), 0.0)
    assert listener.model.screen(0.0).banner.text == "Sound is off."
    assert listener.see(THERE) == [] and not listener.model.sound_on
    listener.model.do(SwitchSound(), 0.0)
    assert listener.model.screen(0.0).banner.text == "Sound is on."
    assert listener.see(SENSED) == [GameSound.FIND]


def test_a_study_without_sound_says_so_and_is_silent():
    quiet = Listener()
    quiet.see(structs.replace(UNDER_WAY, sound=False))
    assert quiet.model.why_silent == "This study is without sound."
    quiet.model.do(SwitchSound(), 0.0)
    assert quiet.model.screen(0.0).banner.text == "This study is without sound."
    assert quiet.see(structs.replace(THERE, sound=False)) == []


def test_a_computer_without_a_player_is_said_to_have_none():
    listener = Listener(Participant(can_sound=False))
    listener.see(view())
    assert listener.model.why_silent == "This computer has no program that plays sounds."


@pytest.mark.parametrize(
    ("can_sound", "sound", "said"),
    [
        (True, True, "Switch sound off or on"),
        (True, False, "This study is without sound."),
        (False, True, "This computer has no program that plays sounds."),
    ],
)
def test_the_sheet_of_keys_says_of_m_what_it_does_or_why_it_does_nothing(can_sound: bool, sound: bool, said: str):
    listener = Listener(Participant(can_sound=can_sound))
    listener.see(structs.replace(view(), sound=sound))
    listener.model.do(ShowHelp(), 0.0)
    assert dict(listener.model.screen(0.0).help)["M"] == said
