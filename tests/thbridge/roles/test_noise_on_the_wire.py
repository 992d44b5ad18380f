"""Whatever anybody says under whatever name, no role falls over, and the game's own books stay right."""

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from msgspec import structs

from tests.support.hunts.game_states import fold
from tests.support.hunts.hunt_without_simulator import HuntWithoutSimulator, templates
from thbridge.app.compose.game import build_bot
from thbridge.app.compose.robots import build_simr
from thbridge.app.compose.setting import read_setting
from thbridge.hunt.events import GameStarted
from thbridge.roles.keeper.disclosed.briefing import Briefing
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.participant.tabui import ParticipantUpdate, TabUI
from thbridge.roles.shared import notices, view
from thbridge.roles.shared.notices import KEEPER
from thbridge.study.study_file import Study
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.lines import TextCommand, TextMessage
from thbridge.text_protocol.wire.notice_format import encode_notice, kind_of, notice, parse_notice

small = st.integers(-2, 10)
number = st.one_of(small, st.integers(), st.floats(allow_nan=False, allow_infinity=False))
word = st.text(max_size=8)
json = st.recursive(
    st.one_of(st.none(), st.booleans(), number, word),
    lambda inner: st.one_of(st.lists(inner, max_size=4), st.dictionaries(word, inner, max_size=3)),
    max_leaves=12,
)
KINDS = [
    *(
        kind_of(each)
        for each in vars(notices).values()
        if isinstance(each, type) and issubclass(each, notices.NoticeValue) and each is not notices.NoticeValue
    ),
    *map(kind_of, view.ParticipantRequest.__args__),
    "View",
    "undelivered",
]
FIELDS = ["game", "moves", "energy", "at", "poses", "results", "robots", "costs", "map", "rooms", "treasures", "robot"]
FIELDS += ["room", "dialogue", "turn", "choice", "matter", "command", "text", "sentence", "tick"]
names = st.sampled_from([KEEPER, legacy.SIMR, legacy.HIDER, legacy.TABUI, "Stranger"])


@st.composite
def junk(draw) -> TextMessage:
    """A notice with the right words in the wrong places, or a line of 2016 with any numbers."""
    sender, receiver = draw(names), draw(names)
    if draw(st.booleans()):
        fields = draw(st.dictionaries(st.sampled_from(FIELDS), json, max_size=8))
        return notice(sender, receiver, draw(st.sampled_from(KINDS)), **fields)
    robot, room = draw(st.integers(0, 10**9 - 1)), draw(st.integers(0, 12))
    line = draw(
        st.sampled_from(
            [
                legacy.GotoRoom(robot % 4, room),
                legacy.RoomReached(robot % 4, room),
                legacy.AskTreasure(room),
                legacy.FoundTreasure(room, (("Colour", "Red"), ("Footprint", "Flat"))),
                legacy.SnapTreasure(room),
                legacy.TreasureImage(room, "x.jpg"),
                legacy.NameTreasure(room, "thing"),
                legacy.PointsAwarded(robot),
            ]
        )
    ).message()
    return replace(line, sender=sender)


real = st.floats(-5.0, 5.0)
pose = st.tuples(real, real, real)
poses = st.lists(pose, max_size=3).map(tuple)
costs = st.lists(st.lists(st.one_of(st.none(), real), max_size=3).map(tuple), max_size=3).map(tuple)
order = st.builds(notices.MoveOrder, small, small)
result = st.builds(notices.MoveResult, small, st.booleans(), word, real)
well_formed = st.one_of(
    st.builds(notices.RobotsReady, word, small, costs, costs),
    st.builds(
        notices.Orders,
        small,
        st.lists(st.one_of(st.none(), order), max_size=3).map(tuple),
        st.lists(real, max_size=3).map(tuple),
        st.lists(small, max_size=3).map(tuple),
        st.one_of(st.none(), poses),
    ),
    st.builds(notices.TeamStatus, small, poses, st.lists(st.one_of(st.none(), result), max_size=3).map(tuple)),
    st.builds(notices.HideRequest, small, st.integers(0, 20)),
    st.builds(notices.Subscribe),
    st.builds(notices.ParticipantReady),
    st.builds(notices.ConsentQuery),
    st.builds(notices.RecordingPermission, st.booleans()),
    st.builds(notices.PoseTelemetry, small, poses),
    st.builds(notices.PlannedPaths, small, st.just(())),
    st.builds(notices.FloorPlan, word, real, pose, small, small, word, st.just(()), st.just(())),
    st.builds(notices.PicturePiece, small, small, small, small, word),
    st.builds(view.GiveConsent),
    st.builds(view.DeclineConsent),
    st.builds(view.SelectRoom, small, small),
    st.builds(view.RequestSuggestion, small),
    st.builds(view.AnswerDialogue, small, small, small),
    st.builds(view.OpenDialogue, small, st.sampled_from(["take-picture", "take-treasure"]), small),
    st.builds(view.LeaveTreasure, small),
    st.builds(view.TakeUpTreasure, small),
    st.builds(view.StopRobot, small),
    st.builds(view.RequestHandback, small),
    st.builds(view.PlayAgain, small),
)
typed = st.builds(encode_notice, names, names, well_formed)


class Forgetful:
    def observe(self, level: ParticipantUpdate) -> None:
        pass


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(st.one_of(junk(), typed), max_size=20))
@example([TextMessage(TextCommand.FOUND, legacy.TABUI, legacy.HIDER, ("8,thing",))])
@example([encode_notice(KEEPER, legacy.HIDER, notices.HideRequest(-1, 1))])
@example([encode_notice(KEEPER, legacy.HIDER, notices.HideRequest(1 << 70, 1))])
def test_the_keeper_and_its_neighbours(said):
    briefing = Briefing(names=("Blue Bottle",), pictures={"x.jpg": bytes(50_000), "rsz_t1.jpg": b"1"}, consent="Yes?")
    bot = build_bot(templates(), BotStrategy.SUGGESTION, 7)
    hunt = HuntWithoutSimulator(participant=TabUI(bot, Forgetful()), briefing=briefing)
    hunt.run(8)
    hunt.router.local.attach("Noise")
    for message in said:
        hunt.router.local.submit("Noise", message)
        hunt.run(1)
    hunt.run(10)
    started = max(i for i, event in enumerate(hunt.log.events) if isinstance(event, GameStarted))
    assert fold(hunt.log.events[started], hunt.log.events[started + 1 :]) == hunt.session.game


@pytest.mark.parametrize("number", [-1, 0, 1, 1 << 70])
def test_a_view_with_a_dialogue_that_cannot_be_numbered_so_is_not_taken(number):
    hunt = HuntWithoutSimulator()
    hunt.run(8)
    talk = view.DialogueView(number, 1, 0, "select-room", 1, ("Shall I go?",), ("Continue", "Stop"))
    line = encode_notice(KEEPER, legacy.TABUI, structs.replace(hunt.view(), dialogues=(talk,)))
    assert (view.View.of_notice(parse_notice(line)) is None) == (number != 1)


@pytest.mark.parametrize(
    ("acts", "speakers", "is_taken"),
    [((), (), True), (("continue", "stop"), ("robot",), True), (("continue",), (), False), ((), ("robot",) * 2, False)],
)
def test_a_view_names_all_acts_and_speakers_or_none_as_those_of_older_releases(acts, speakers, is_taken):
    hunt = HuntWithoutSimulator()
    hunt.run(8)
    talk = view.DialogueView(
        1, 1, 0, "select-room", 1, ("Shall I go?",), ("Continue", "Stop"), acts=acts, speakers=speakers
    )
    line = encode_notice(KEEPER, legacy.TABUI, structs.replace(hunt.view(), dialogues=(talk,)))
    assert (view.View.of_notice(parse_notice(line)) is not None) == is_taken


@pytest.fixture(scope="module")
def simr():
    return build_simr(read_setting(replace(Study(), robots=2), Path()))


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.one_of(junk(), typed), max_size=10))
def test_the_robots_program(simr, said):
    simr.step(0, said)
    simr.step(1, [])
    assert simr.snapshot is not None
