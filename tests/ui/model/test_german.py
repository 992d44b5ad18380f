"""A game in German: nothing on any screen is English."""

import re
from dataclasses import replace
from enum import StrEnum
from pathlib import Path

import pytest
from msgspec import structs

from tests.support.hunts.hunt_without_simulator import RULES
from tests.support.hunts.participant_views import ANSWERS, argued, arguing, ended, view, with_robot, with_room
from tests.support.hunts.screen_player import ScreenPlayer, play
from tests.support.hunts.scripted_hunt import NAME, TAKE
from tests.support.windows.english import ENGLISH_ONLY, english_names, english_on, said_by_others, shown
from thbridge.app.compose.game import build_briefing
from thbridge.app.compose.setting import read_setting
from thbridge.dialogue.scripted.protocols import TemplateProtocol
from thbridge.dialogue.scripted.scripted_engine import ScriptedEngine
from thbridge.dialogue.scripted.strategies import TemplateStrategy
from thbridge.dialogue.scripted.templates import TemplatePhrasing
from thbridge.files.language_texts import shipped_texts
from thbridge.hunt.events import Commander, Condition, EndReason
from thbridge.hunt.rules import RuleReason
from thbridge.hunt.tour import NoTour
from thbridge.roles.keeper.disclosed.briefing import Briefing
from thbridge.roles.shared.notices import PoseTelemetry, RobotMotion
from thbridge.roles.shared.participant_rules import KeeperReason
from thbridge.roles.shared.robot_requests import ReleaseCommand
from thbridge.roles.shared.view import Debrief, IdentificationVerdict, RefusalView, RoomDebrief, View
from thbridge.study.study_file import DialogueSection, Study
from ui.model.playing.participant import Participant
from ui.model.playing.screen import (
    Act,
    AnswerDialogueAct,
    AskWhatItIs,
    Cancel,
    ChooseRobot,
    CloseWindow,
    Confirm,
    ConsiderRoom,
    DialoguePopup,
    EndGameAct,
    FollowRobot,
    GiveConsentAct,
    IdentifyTreasureAct,
    LeaveTreasureAct,
    Phase,
    PickName,
    PlayAgainAct,
    RequestHandbackAct,
    RequestSuggestionAct,
    Screen,
    SelectRoomAct,
    ShowHelp,
    ShowNext,
    StopRobotAct,
    SwitchSound,
    TakePictureAct,
    TakeUpTreasureAct,
    TypeDigit,
    TypeLetter,
)

GERMAN = shipped_texts("de")
REASONS: list[StrEnum] = [*RuleReason, *KeeperReason, *NoTour]


class GermanSeat(ScreenPlayer):
    """A participant who reads every screen, and finds nothing English on it."""

    def __init__(self, **hunt) -> None:
        super().__init__(Participant(texts=GERMAN), **hunt)

    def run(self, ticks: int = 12) -> Screen:
        for _ in range(max(ticks, 1)):
            super().run(min(ticks, 1))
            assert english_on(self.screen, self.theirs) == []
        return self.screen

    def agree(self) -> Screen:
        while isinstance(self.screen.popup, DialoguePopup) and self.screen.popup.choices:
            self.do(AnswerDialogueAct(0), 4)
        return self.run(12)

    def go(self, room: int) -> Screen:
        self.press(SelectRoomAct(room), 4)
        return self.agree()


def german(*views: View, acts: tuple[Act, ...] = ()) -> Screen:
    """The screen after these views and acts; nothing on it, or on one before, is English."""
    model, theirs = Participant(texts=GERMAN), set()
    model.connected(0.0)
    for now, each in enumerate(views):
        theirs |= said_by_others(each)
        model.receive(each, float(now))
        assert english_on(model.screen(float(now)), theirs) == []
    for act in acts:
        model.do(act, float(len(views)))
        assert english_on(model.screen(float(len(views))), theirs) == []
    return model.screen(float(len(views)))


FOUND = structs.replace(
    with_room(with_robot(view(), 0, place=3), 3, state="visited", robot=0, sensed={"colour": "Pink"}),
    names=("ball", "can"),
)


def test_what_is_english_only_would_be_found():
    assert {"robot", "room", "the", "energy"} <= ENGLISH_ONLY
    model = Participant()
    model.receive(view(), 0.0)
    assert len(english_on(model.screen(0.0), ())) > 50


def test_a_whole_game():
    seat = GermanSeat(robots=2, set_name="four-properties", rules=replace(RULES, energy=150.0))
    for act in (ShowHelp(), ShowHelp(), SwitchSound(), SwitchSound(), FollowRobot(), ConsiderRoom(2), TypeDigit(9)):
        seat.press(act)
    for act in (StopRobotAct(), RequestHandbackAct(), TakeUpTreasureAct()):
        seat.press(act)
        assert seat.screen.banner is not None
    # Another goal on the way, and a stop.
    seat.hunt.puppets.ticks = 60
    seat.go(3)
    seat.press(SelectRoomAct(1))
    seat.press(Cancel())
    seat.press(EndGameAct())
    seat.press(SelectRoomAct(1))
    seat.press(Confirm())
    seat.agree()
    seat.press(StopRobotAct(), 40)
    seat.hunt.puppets.ticks = 8
    # A find, with all that can be done with it.
    pop = seat.go(3).popup
    assert pop.room == 3
    for fact in pop.facts:
        seat.press(fact.sense.act if fact.sense else ConsiderRoom(None))
    seat.do(TakePictureAct())
    seat.agree()
    for fact in seat.screen.popup.facts:
        seat.press(fact.tell[0].act if fact.tell else ConsiderRoom(None))
    seat.press(IdentifyTreasureAct())
    seat.press(TypeLetter("q"))
    wrong = next(name for name in seat.names if name != seat.hunt.session.game.treasures[2].name)
    seat.press(PickName(wrong))
    seat.press(RequestSuggestionAct())
    seat.press(Cancel())
    seat.do(IdentifyTreasureAct(), 4)
    seat.agree()
    assert seat.screen.popup.verdict
    seat.press(ShowNext())
    seat.do(RequestSuggestionAct(), 4)
    seat.do(AnswerDialogueAct(1))
    # Another one is left, and taken up again.
    assert seat.go(2).popup.room == 2
    seat.press(LeaveTreasureAct())
    seat.press(TakeUpTreasureAct())
    seat.press(ShowNext())
    # What goes wrong with robots.
    seat.press(ChooseRobot(1))
    seat.hunt.puppets.stuck = {1}
    seat.go(5)
    assert seat.run(30).banner.text == GERMAN.text("hints.refused_no_path")
    for condition in (Condition.LOST, Condition.SILENT, Condition.WELL):
        seat.hunt.puppets.conditions = [Condition.WELL, condition]
        seat.run(60)
    # Others command one for a while.
    seat.hunt.session.ask("station", TAKE)
    seat.run()
    seat.press(ChooseRobot(0))
    seat.do(RequestHandbackAct())
    seat.press(RequestHandbackAct())
    seat.hunt.session.ask("station", ReleaseCommand(0))
    seat.run()
    # The connection, the end, and another game.
    seat.model.lost("", seat.now)
    seat.now += 2.0
    assert english_on(seat.screen, seat.theirs) == []
    seat.model.connected(seat.now)
    seat.tabui.connected()
    seat.run()
    for act in (CloseWindow(ends=True), CloseWindow(ends=False), EndGameAct()):
        assert seat.press(act).confirmation is not None
        seat.press(SelectRoomAct(1))
        seat.do(Cancel())
    seat.press(EndGameAct())
    assert seat.do(Confirm()).phase is Phase.OVER
    assert seat.do(PlayAgainAct(), 30).game == 2


@pytest.mark.parametrize("templates", ["four-properties", pytest.param("everyday-things", marks=pytest.mark.slow)])
def test_a_game_with_the_german_words_of_map_and_templates(templates):
    setting = read_setting(Study(map="office", templates=templates, dialogue=DialogueSection(language="de")), Path())
    words, read = setting.set_words, set()
    phrasing = TemplatePhrasing(words.dialogue, 7, setting.texts, words.properties)
    talk = ScriptedEngine(TemplateProtocol(words.dialogue), TemplateStrategy(), phrasing)
    seat = GermanSeat(set_name=templates, briefing=build_briefing(setting), talk=talk)
    play(seat, lambda screen: read.update(shown(screen)))
    assert {*words.names.values(), "Farbe"} <= read
    english = re.compile("|".join(rf"\b{re.escape(word)}\b" for word in sorted(english_names(setting))), re.IGNORECASE)
    assert [words for words in sorted(read) if english.search(words)] == []


def test_the_question_whether_to_take_part():
    seat = GermanSeat(briefing=Briefing(names=("ball",), consent="May we?"))
    assert seat.screen.agree.label == "Ich stimme zu"
    seat.do(GiveConsentAct())


@pytest.mark.parametrize("who", ["both", "participant", "robot"])
def test_robots_that_argue(who):
    german(argued(arguing(">Go.", "No.", acts=ANSWERS), who=who), acts=(ShowHelp(),))
    german(argued(arguing("No.", ">Go.", acts=ANSWERS), who=who))
    german(argued(who=who), argued(words=(ended(agreed=False),), who=who))
    german(argued(who=who), argued(words=(ended(agreed=True, said=()),), who=who))
    german(structs.replace(FOUND, has_last_word=who), acts=(AskWhatItIs(),))


@pytest.mark.parametrize("commander", [Commander.GROUND_STATION, Commander.RESEARCHER])
@pytest.mark.parametrize(("name", "known_as"), [("", "eine Bodenstation"), (NAME, "Bodenstation 255"), ("Ada", "Ada")])
def test_each_commander(commander, name, known_as):
    theirs = {"commander": commander, "commander_name": name}
    known_as = "die Versuchsleitung" if commander is Commander.RESEARCHER else known_as
    assert german(view(), with_robot(view(), 0, **theirs)).cards[0].commander == known_as
    german(with_robot(view(), 0, **theirs), view())
    both = with_robot(with_robot(view(), 0, **theirs), 1, **theirs)
    assert german(both).banner.text == GERMAN.text("game.all_commanded")


@pytest.mark.parametrize("doing", ["resting", "planning", "driving", "waiting", "clearing", "silent"])
@pytest.mark.parametrize("motion", [{}, {"waits_for": 1}, {"makes_way_for": 1}])
def test_each_motion(doing, motion):
    model = Participant(texts=GERMAN)
    for seen in (with_room(with_robot(view(), 0, moving_to=3), 3, state="reserved", robot=0), view()):
        model.receive(seen, 0.0)
        moving = RobotMotion(doing, progress=0.5, **motion)
        model.receive(PoseTelemetry(1, ((0.0, 0.0, 0.0),) * 2, (moving, RobotMotion())), 0.0)
        assert english_on(model.screen(0.0), ()) == []


@pytest.mark.parametrize("reason", [*EndReason, "of-a-later-release"])
def test_each_end(reason):
    told = Debrief((RoomDebrief(1, "ball", 20), RoomDebrief(2, "can", 1), RoomDebrief(3, "can", 1)), 60)
    left = with_room(FOUND, 1, state="visited", left=True)
    wrong = with_room(left, 3, verdict=IdentificationVerdict("ball", -20))
    right = with_room(wrong, 3, verdict=IdentificationVerdict("can", 1))
    for played in (left, wrong, right):
        assert german(structs.replace(played, over=reason, debrief=told)).ending is not None


@pytest.mark.parametrize("reason", REASONS, ids=str)
def test_each_reason_of_a_refusal_has_words_in_every_language(reason):
    refused = structs.replace(view(), refusal=RefusalView(1, "Leave", reason, "The rules say this."))
    assert german(view(), refused).banner.text == GERMAN.text(f"hints.refused_{reason.replace('-', '_')}")


def test_a_reason_of_a_later_release_is_told_by_its_sentence():
    model = Participant(texts=GERMAN)
    model.receive(view(), 0.0)
    model.receive(structs.replace(view(), refusal=RefusalView(1, "Leave", "no-wind", "There is no wind.")), 1.0)
    assert model.screen(1.0).banner.text == "There is no wind."


def test_a_refusal_is_told_with_what_is_known_of_its_request():
    model = Participant(texts=GERMAN)
    model.receive(view(), 0.0)
    model.screen(0.0)
    model.do(SelectRoomAct(3), 0.0)
    poor = with_robot(view(), 0, energy=2.5)
    poor = structs.replace(poor, refusal=RefusalView(1, "select-room", RuleReason.NOT_ENOUGH_ENERGY, "It is too far."))
    model.receive(poor, 1.0)
    assert model.screen(1.0).banner.text == "Das kostet 7 Energie; Roboter 1 hat nur 2,5."
