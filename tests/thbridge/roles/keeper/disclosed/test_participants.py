"""What participants' programs are told, and when: the house, pictures, names, the consent they are asked for."""

import base64
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest
from msgspec import structs

from tests.support.hunts.hunt_without_simulator import RULES, HuntWithoutSimulator, scripted_engine, templates
from tests.support.hunts.scripted_hunt import ScriptedPlayer, go
from thbridge.app.compose.game import build_floor_plan
from thbridge.app.compose.setting import read_setting
from thbridge.hunt.events import (
    ConsentGiven,
    GameStarted,
    ObjectionReason,
    RobotDeparted,
    TreasureIdentified,
    TreasurePictured,
    TreasureSensed,
    TreasuresHidden,
)
from thbridge.hunt.rooms import Room
from thbridge.hunt.treasures import TreasureKind
from thbridge.roles.keeper.disclosed.briefing import Briefing
from thbridge.roles.keeper.disclosed.consent import ConsentStatus
from thbridge.roles.keeper.disclosed.participants import (
    MOST_NUMBERS,
    MOST_PARTICIPANTS,
    PIECE_PERIOD,
    PIECE_SIZE,
    Participants,
)
from thbridge.roles.keeper.keeper import Keeper
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.participant.tabui import REJOIN_PERIOD, RENEWAL_PERIOD, TabUI
from thbridge.roles.shared.notices import KEEPER, FloorPlan, PicturePiece, PlannedPaths, PoseTelemetry, Subscribe
from thbridge.roles.shared.team_notices import MarkRead, RaiseObjection, SayToPeople, Vote
from thbridge.roles.shared.view import (
    AnswerDialogue,
    Debrief,
    EndGame,
    GiveConsent,
    HandOver,
    IdentifyTreasure,
    LeaveTreasure,
    MeasureProperty,
    OpenDialogue,
    ParticipantRequest,
    PlayAgain,
    RequestHandback,
    RequestSuggestion,
    SelectRoom,
    SendRobot,
    SenseTreasure,
    StopRobot,
    TakePicture,
    TakeUpTreasure,
    TellProperty,
    View,
)
from thbridge.study.study_file import Study
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.notice_format import decode_notice, encode_notice, kind_of, parse_notice

HOUSE = FloorPlan("stage", 0.05, (0.0, 0.0, 0.0), 1, 1, "eJxjAAAAAQAB", (), ())
CONSENT = "We record what you do."
YES = GiveConsent("2026-11-23T09:30:00Z")


class Eyes:
    """An onlooker that remembers."""

    def __init__(self) -> None:
        self.seen = []

    def observe(self, level) -> None:
        self.seen.append(level)

    def of(self, kind: type) -> list:
        return [level for level in self.seen if isinstance(level, kind)]


class Played:
    """A hunt whose player wishes what the test says, and whose onlooker remembers."""

    def __init__(self, briefing: Briefing) -> None:
        self.player, self.eyes = ScriptedPlayer(), Eyes()
        self.tabui = TabUI(self.player, self.eyes)
        self.hunt = HuntWithoutSimulator(participant=self.tabui, briefing=briefing)
        self.hunt.run(5)

    def say(self, *wishes: ParticipantRequest, ticks: int = 8) -> View:
        self.player.wish = wishes
        self.tabui.poll_player()
        self.hunt.run(ticks)
        return self.tabui.view

    def go(self, robot: int, room: int) -> View:
        return go(self, robot, room)

    def picture(self, robot: int, room: int) -> View:
        self.go(robot, room)
        self.say(SenseTreasure(room))
        self.say(OpenDialogue(robot, "take-picture", room))
        return self.say(TakePicture(room))


def images(size: int) -> dict[str, bytes]:
    """A different file for each treasure of the set."""
    names = [kind.image for kind in templates().kinds]
    return {name: bytes([number]) * size for number, name in enumerate(names)}


def joined(pieces: list[PicturePiece]) -> bytes:
    return b"".join(base64.b64decode(piece.data) for piece in pieces)


def test_the_house_is_told_when_somebody_joins_and_when_they_join_again():
    played = Played(Briefing(HOUSE))
    assert played.eyes.of(FloorPlan) == [HOUSE]
    played.tabui.connected()
    played.hunt.run(3)
    assert played.eyes.of(FloorPlan) == [HOUSE, HOUSE]


def test_a_house_that_the_robots_are_not_in_is_kept():
    audience = Participants(KEEPER, Briefing(HOUSE))
    assert [len(audience.join("TabUI", robots_on)) for robots_on in (None, "stage", "elsewhere")] == [1, 1, 0]


def test_invented_programs_make_room_and_no_more_than_so_many_are_told():
    audience = Participants(KEEPER, Briefing(HOUSE))
    assert [len(audience.join(f"real{number}", None)) for number in range(10)] == [1] * 10
    for number in range(5000):
        audience.join(f"invented{number}", None)
        audience.note_unreachable(f"invented{number}")
    assert audience.join("TabUI", None)
    receivers = {message.receiver for message in audience.show(Played(Briefing(HOUSE)).tabui.view)}
    assert receivers >= {"TabUI", *(f"real{number}" for number in range(10))}
    assert len(receivers) == MOST_PARTICIPANTS


def test_who_can_be_reached_makes_room_for_nobody():
    audience = Participants(KEEPER, Briefing(HOUSE))
    assert all(audience.join(f"real{number}", None) for number in range(MOST_PARTICIPANTS))
    assert audience.join("late", None) == []
    assert "late" not in audience


def test_a_picture_is_told_once_it_is_taken():
    files = images(2 * PIECE_SIZE + 7)
    played = Played(Briefing(HOUSE, pictures=files))
    played.go(0, 3)
    assert played.eyes.of(PicturePiece) == []
    view = played.picture(0, 3)
    played.hunt.run(4 * PIECE_PERIOD)
    pieces = played.eyes.of(PicturePiece)
    assert [(piece.game, piece.room, piece.piece, piece.pieces) for piece in pieces] == [
        (1, 3, 0, 3),
        (1, 3, 1, 3),
        (1, 3, 2, 3),
    ]
    assert joined(pieces) == files[view.room(3).picture]
    assert all(len(piece.data) <= 40_000 for piece in pieces)


def test_who_comes_back_is_told_all_pictures_again_from_the_first_piece():
    played = Played(Briefing(HOUSE, pictures=images(2 * PIECE_SIZE)))
    played.picture(0, 3)
    played.hunt.run(2 * PIECE_PERIOD)
    played.eyes.seen.clear()
    played.tabui.connected()
    played.hunt.run(4 * PIECE_PERIOD)
    assert [(piece.room, piece.piece) for piece in played.eyes.of(PicturePiece)] == [(3, 0), (3, 1)]


def test_a_picture_that_nobody_has_is_told_by_its_name_alone():
    played = Played(Briefing(HOUSE))
    assert played.picture(0, 3).room(3).picture is not None
    played.hunt.run(50)
    assert played.eyes.of(PicturePiece) == []


def test_a_large_picture_leaves_slow_readers_time():
    audience = Participants(KEEPER, Briefing(pictures={"a.jpg": bytes(10 * PIECE_SIZE)}))
    played = Played(Briefing(HOUSE))
    view = played.tabui.view
    audience.join("TabUI", None)
    audience.show(structs.replace(view, rooms=(replace(view.rooms[0], picture="a.jpg"), *view.rooms[1:])))
    told = [tick for tick in range(100) for _ in audience.pieces(tick)]
    assert len(told) == 10
    assert {b - a for a, b in pairwise(told)} == {PIECE_PERIOD}


def test_names_are_told_once_a_treasure_was_sensed():
    played = Played(Briefing(names=("Blue Bottle", "Pink can")))
    assert played.go(0, 3).names == ()
    assert played.say(SenseTreasure(3)).names == ("Blue Bottle", "Pink can")


# --- consent


EVERY_WISH = [
    SelectRoom(0, 3),
    RequestSuggestion(0),
    AnswerDialogue(1, 1, 0),
    SendRobot(0, 3),
    StopRobot(0),
    RequestHandback(0),
    SenseTreasure(3),
    OpenDialogue(0, "take-picture", 3),
    TakePicture(3),
    IdentifyTreasure(3, "moon"),
    LeaveTreasure(3),
    TakeUpTreasure(3),
    EndGame(1),
    PlayAgain(1),
    MeasureProperty(3, "weight"),
    TellProperty(3, "material", "wood"),
    HandOver(0, "driver"),
    SayToPeople("Hello"),
    MarkRead(1),
    Vote(1, agrees=True),
    RaiseObjection(1, ObjectionReason.NOT_SURE),
]


def test_before_agreeing_nothing_else_is_granted():
    played = Played(Briefing(consent=CONSENT))
    assert {type(wish) for wish in EVERY_WISH} | {GiveConsent} == set(ParticipantRequest.__args__)
    for number, wish in enumerate(EVERY_WISH, start=1):
        view = played.say(wish)
        assert (view.consent, view.over, view.dialogues) == (CONSENT, None, ())
        assert (view.refusal.number, view.refusal.wish) == (number, kind_of(type(wish)))
        assert (view.refusal.reason, view.refusal.sentence) == ("not-agreed", "You have not agreed to take part yet.")
    assert [type(event).__name__ for event in played.hunt.log.events] == ["GameStarted", "TreasuresHidden"]


def test_who_has_agreed_plays_as_others_do():
    played = Played(Briefing(consent=CONSENT))
    assert played.say(GiveConsent()).consent is None
    assert played.say(GiveConsent()).refusal is None
    assert played.go(0, 3).room(3).state == "visited"
    assert played.hunt.log.events.count(ConsentGiven()) == 1


def test_agreement_holds_for_later_games_and_their_journals_say_so():
    played = Played(Briefing(consent=CONSENT))
    played.say(GiveConsent())
    played.say(EndGame(1))
    view = played.say(PlayAgain(1))
    assert (view.game, view.consent) == (2, None)
    events = played.hunt.log.events
    second = [event for event in events[events.index(ConsentGiven()) + 1 :] if not isinstance(event, TreasuresHidden)]
    assert [type(event).__name__ for event in second] == ["GameEnded", "GameStarted", "ConsentGiven"]


def test_the_record_has_the_time_of_the_yes_in_every_game():
    played = Played(Briefing(consent=CONSENT))
    played.say(GiveConsent(YES.at))
    played.say(EndGame(1))
    played.say(PlayAgain(1))
    assert [event for event in played.hunt.log.events if isinstance(event, ConsentGiven)] == [ConsentGiven(YES.at)] * 2


def test_the_next_person_at_a_finished_game_is_asked_anew():
    played = Played(Briefing(consent=CONSENT))
    played.say(GiveConsent(YES.at))
    played.tabui.connected()
    played.say(EndGame(1))
    played.tabui.connected()
    assert played.say(PlayAgain(1)).consent is None, "the connection of the same person was lost twice"
    played.say(EndGame(2))
    played.tabui.run = "another"
    played.tabui.connected()
    assert played.say(PlayAgain(2)).consent == CONSENT, "before anything of the game that is over"
    assert played.tabui.view.game == 2
    played.say(GiveConsent("2026-11-24T09:30:00Z"))
    assert played.say(PlayAgain(2)).consent is None
    started, agreed, hidden = played.hunt.log.events[-3:]
    assert (type(started), agreed, type(hidden)) == (
        GameStarted,
        ConsentGiven("2026-11-24T09:30:00Z"),
        TreasuresHidden,
    )


def test_who_agreed_before_joining_has_agreed_when_the_game_starts():
    played = HuntWithoutSimulator(participant=TabUI(ScriptedPlayer(), consent=YES), briefing=Briefing(consent=CONSENT))
    played.run(6)
    assert [type(event).__name__ for event in played.log.events] == ["GameStarted", "ConsentGiven", "TreasuresHidden"]
    assert played.log.events[1] == ConsentGiven(YES.at)
    assert played.keeper.consent is ConsentStatus.GIVEN


def test_a_no_is_final_for_the_program_that_says_it_and_the_next_one_is_asked_anew():
    played = Played(Briefing(consent=CONSENT))
    assert played.hunt.keeper.consent is ConsentStatus.AWAITED
    played.tabui.decline()
    played.hunt.run(4)
    assert played.hunt.keeper.consent is ConsentStatus.DECLINED
    played.tabui.declined = False
    assert played.say(GiveConsent(YES.at)).consent == CONSENT
    assert played.hunt.keeper.consent is ConsentStatus.DECLINED
    played.tabui.connected()
    assert played.say(GiveConsent(YES.at), ticks=REJOIN_PERIOD + 4).consent is None
    assert played.hunt.keeper.consent is ConsentStatus.GIVEN


def test_a_no_after_the_yes_changes_nothing():
    played = Played(Briefing(consent=CONSENT))
    played.say(GiveConsent())
    played.tabui.decline()
    played.hunt.run(4)
    assert played.hunt.keeper.consent is ConsentStatus.GIVEN


def test_agreement_outlives_the_server():
    played = Played(Briefing(consent=CONSENT))
    played.say(GiveConsent())
    again = Keeper(
        RULES,
        lambda game: scripted_engine(templates()),
        tuple(played.hunt.log.events),
    )
    assert again.state.agreed


@pytest.mark.parametrize("strategy", BotStrategy)
def test_simulated_participants_agree(strategy):
    played = HuntWithoutSimulator(strategy=strategy, briefing=Briefing(consent=CONSENT))
    played.finish()
    assert played.session.game.agreed
    assert any(isinstance(event, RobotDeparted) for event in played.log.events)


def test_programs_of_2016_cannot_be_asked_and_are_not():
    played = Played(Briefing(consent=CONSENT))
    played.hunt.keeper._seats[""].participants._members.clear()
    played.say(SendRobot(0, 3), ticks=20)
    assert played.hunt.session.game.room(Room(3)).visited


# --- who watches


def test_only_who_watches_asks_where_the_robots_are():
    def subscriptions(onlooker) -> list[int]:
        tabui = TabUI(ScriptedPlayer(), onlooker)
        assert tabui.step(0, []) == []
        tabui.connected()
        ticks = range(1, 2 * RENEWAL_PERIOD)
        said = [(tick, message) for tick in ticks for message in tabui.step(tick, [])]
        return [tick for tick, message in said if decode_notice(parse_notice(message), Subscribe) is not None]

    assert subscriptions(None) == []
    assert subscriptions(Eyes()) == [1, 1 + RENEWAL_PERIOD]


def test_who_watches_sees_all_that_is_told_in_its_order():
    eyes = Eyes()
    tabui = TabUI(ScriptedPlayer(), eyes)
    levels = [
        HOUSE,
        PoseTelemetry(1, ((0.0, 0.0, 0.0),)),
        PlannedPaths(1, (((0.0, 0.0), (1.0, 0.0)),)),
        PicturePiece(1, 3, 0, 1, ""),
        PoseTelemetry(2, ((0.0, 0.0, 0.0),)),
    ]
    tabui.step(0, [encode_notice(KEEPER, legacy.TABUI, level) for level in levels])
    assert eyes.seen == levels


# --- what is not told


def hidden_kinds() -> list[TreasureKind]:
    """Words that occur nowhere else; two and two look alike, so that pictures are taken."""
    return [
        TreasureKind({"colour": f"colour{n // 2}q", "footprint": f"print{n // 2}q"}, 10, f"name{n}q", f"file{n}q.jpg")
        for n in range(8)
    ]


@pytest.mark.parametrize("strategy", BotStrategy)
@pytest.mark.parametrize("seed", range(4))
def test_nothing_of_a_treasure_is_told_before_the_game_reveals_it(strategy, seed):
    kinds = hidden_kinds()
    files = {kind.image: f"bytes of {kind.name}".encode() for kind in kinds}
    house = build_floor_plan(read_setting(Study(), Path()))
    briefing = Briefing(house, tuple(kind.name for kind in kinds), files, CONSENT)
    played = HuntWithoutSimulator(robots=2, strategy=strategy, seed=seed, briefing=briefing, kinds=kinds)
    played.finish()
    secrets = {word for kind in kinds for word in (*kind.properties.values(), kind.name, kind.image)}
    secrets |= {base64.b64encode(data).decode() for data in files.values()}
    names = ",".join(f'"{kind.name}"' for kind in kinds)
    revealed: set[str] = set()
    pictures = 0
    for tick_record in played.tick_records:
        for line in (item.message.line() for item in tick_record.forwarded if item.message.receiver == legacy.TABUI):
            # Once a treasure was sensed the whole list is told, in the same order whatever lies where.
            told = line.replace(f'"names":[{names}]', "") if revealed else line
            assert {word for word in secrets if word in told} <= revealed
        # What is decided in a tick is told in the next.
        for event in tick_record.events:
            match event:
                case TreasureSensed(_, properties):
                    revealed |= set(properties.values())
                case TreasurePictured(_, _, image):
                    revealed |= {image, base64.b64encode(files[image]).decode()}
                    pictures += 1
                case TreasureIdentified(name=name):
                    revealed.add(name)
    assert pictures > 0
    assert len(revealed) > 8


def test_after_the_game_and_not_before_it_is_told_what_was_in_the_rooms_and_what_was_possible():
    played = Played(Briefing(answers=True, farewell="Thanks."))
    assert played.go(0, 3).debrief is None
    view = played.say(EndGame(1))
    state = played.hunt.keeper.state
    assert [(room.name, room.points) for room in view.debrief.rooms] == [
        (kind.name, kind.points) for kind in state.treasures
    ]
    assert view.debrief.farewell == "Thanks."
    assert view.debrief.best == sum(kind.points for kind in state.treasures), "there is energy for every room"
    assert played.say(PlayAgain(1)).debrief is None


def test_a_study_may_keep_the_answers_to_itself():
    played = Played(Briefing())
    played.go(0, 3)
    assert played.say(EndGame(1)).debrief == Debrief()


def test_points_are_told_with_the_names_where_the_study_tells():
    played = Played(Briefing(names=("a", "b"), worth=(10, None)))
    played.go(0, 3)
    view = played.say(SenseTreasure(3))
    assert (view.names, view.worth, view.wrong_share) == (("a", "b"), (10, None), 1.0)


def test_programs_are_told_what_each_choice_does_and_who_said_each_sentence():
    played = Played(Briefing())
    (dialogue,) = played.say(SelectRoom(0, 1)).dialogues
    assert (dialogue.acts, dialogue.speakers) == (("continue", "stop"), ("robot",))
    (dialogue,) = played.say(AnswerDialogue(dialogue.dialogue, dialogue.turn, 0)).dialogues
    assert (dialogue.acts, dialogue.speakers) == (("continue", "stop"), ("robot", "person", "robot"))


def test_requests_of_another_run_of_a_program_are_new_and_those_of_the_same_run_are_not():
    participants = Participants(KEEPER, Briefing())

    def repeats(number: int | None) -> bool:
        said = parse_notice(encode_notice("TabUI", KEEPER, RequestSuggestion(0), number))
        return participants.is_repetition(said)

    assert not repeats(1), "of a program that has not joined nothing is remembered"
    participants.join("TabUI", None, "a run")
    assert [repeats(number) for number in (1, 2, 1, None, None)] == [False, False, True, False, False]
    participants.join("TabUI", None, "a run")
    assert repeats(2)
    participants.join("TabUI", None, "another")
    assert [repeats(number) for number in (1, 1)] == [False, True]
    participants.join("TabUI", None)
    assert not repeats(1), "a program that does not mark its runs may have begun to count again"
    for number in range(2, 2 + MOST_NUMBERS):
        assert not repeats(number)
    assert not repeats(1), "the oldest are forgotten"
