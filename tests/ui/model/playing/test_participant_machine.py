"""Random acts and events: nothing raises, and every act that the rules allow is offered."""

from dataclasses import replace

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

from tests.support.hunts.hunt_without_simulator import RULES
from tests.support.hunts.screen_player import ScreenPlayer
from tests.support.windows.english import english_on
from thbridge.files.language_texts import shipped_texts
from thbridge.hunt import rules
from thbridge.hunt.events import Condition
from thbridge.roles.shared.notices import PicturePiece, PoseTelemetry, RobotMotion
from thbridge.roles.shared.participant_rules import revealed
from thbridge.roles.shared.view import (
    Consent,
    DialogueView,
    IdentificationVerdict,
    OpenDialogue,
    RefusalView,
    RequestSuggestion,
    RobotView,
    RoomView,
    SelectRoom,
    View,
)
from ui.model.playing.keys import act_for
from ui.model.playing.offers import offers
from ui.model.playing.participant import Participant
from ui.model.playing.possible import is_allowed
from ui.model.playing.screen import (
    AnswerDialogueAct,
    Cancel,
    ChooseRobot,
    Confirm,
    ConsiderRoom,
    DialoguePopup,
    EndGameAct,
    IdentifyTreasureAct,
    LeaveTreasureAct,
    NextRobot,
    Phase,
    PickName,
    RequestHandbackAct,
    RequestSuggestionAct,
    SelectRoomAct,
    ShowHelp,
    ShowNext,
    ShowWaiting,
    StopRobotAct,
    TakePictureAct,
    TakeUpTreasureAct,
    TreasurePopup,
    TypeDigit,
    TypeLetter,
)

KEYS = ("Tab", "Shift+Tab", "Enter", "Esc", "Up", "Down", "F1", "?", *"0123456789", *"ABCDEFHMNSWXY")
KEYS += ("Ctrl+Z", "Space", "Home", "End", "Ctrl+P", "Ctrl+L", "Ctrl+N", "Ctrl+X")

ACTS = st.one_of(
    st.builds(ChooseRobot, st.integers(-1, 3)),
    st.builds(NextRobot, st.sampled_from((-1, 1))),
    st.builds(ConsiderRoom, st.one_of(st.none(), st.integers(0, 9))),
    st.builds(SelectRoomAct, st.integers(-1, 9)),
    st.builds(TypeDigit, st.integers(0, 9)),
    st.builds(StopRobotAct, st.one_of(st.none(), st.integers(-1, 3))),
    st.builds(RequestHandbackAct, st.one_of(st.none(), st.integers(-1, 3))),
    st.builds(AnswerDialogueAct, st.integers(-1, 2)),
    st.builds(PickName, st.one_of(st.none(), st.sampled_from(("Orange Bottle", "Pink can", "nothing")))),
    st.builds(TypeLetter, st.sampled_from("bcop ")),
    st.builds(ShowWaiting, st.integers(0, 3)),
    st.sampled_from(
        (
            RequestSuggestionAct(),
            TakePictureAct(),
            TakeUpTreasureAct(),
            IdentifyTreasureAct(),
            LeaveTreasureAct(),
            ShowNext(),
            EndGameAct(),
            Confirm(),
            Cancel(),
            ShowHelp(),
        )
    ),
)


def check_offers(screen):
    """Every button says what it does, and why it does not."""
    for action in offers(screen):
        assert action.label
        assert action.enabled or action.hint or action.pending or isinstance(action.act, AnswerDialogueAct)
    if isinstance(screen.popup, DialoguePopup):
        keys = [choice.key for choice in screen.popup.choices]
        assert len(set(keys)) == len(keys)
    printed = [action.key for action in offers(screen) if action.key and action.key != "W"]
    assert len(set(printed)) == len(printed), printed
    if screen.help or screen.typed:
        return
    for action in offers(screen):
        if action.key and not action.key.isdigit() and not isinstance(action.act, ChooseRobot | ShowWaiting):
            done = act_for(action.key, screen)
            assert done == action.act or isinstance(done, StopRobotAct | TakeUpTreasureAct), (action, done)


class Game(RuleBasedStateMachine):
    @initialize(
        robots=st.integers(1, 3),
        energy=st.sampled_from((12.0, 40.0, 100.0)),
        set_name=st.sampled_from(("original-2016", "sklar-azhar-2015")),
        language=st.sampled_from(("en", "de")),
    )
    def begin(self, robots, energy, set_name, language):
        model = Participant(texts=shipped_texts(language))
        self.seat = ScreenPlayer(model, robots=robots, set_name=set_name, rules=replace(RULES, energy=energy))

    @rule(act=ACTS, ticks=st.integers(0, 15))
    def act(self, act, ticks):
        self.seat.press(act, ticks)

    @rule(data=st.data(), ticks=st.integers(0, 30))
    def do_what_is_offered(self, data, ticks):
        possible = [
            action for action in self.seat.offers() if action.enabled and not isinstance(action.act, EndGameAct)
        ]
        self.seat.do(data.draw(st.sampled_from(possible)).act, ticks)

    @rule(data=st.data(), ticks=st.integers(5, 30))
    @precondition(lambda self: self.seat.screen.popup is not None)
    def go_along(self, data, ticks):
        match self.seat.screen.popup:
            case DialoguePopup(choices=choices) if choices:
                self.seat.press(AnswerDialogueAct(0), ticks)
            case TreasurePopup(names=names) if names:
                self.seat.press(PickName(data.draw(st.sampled_from(names))), 1)
                self.seat.press(IdentifyTreasureAct(), ticks)

    @rule(key=st.sampled_from(KEYS), ticks=st.integers(0, 5))
    def press_a_key(self, key, ticks):
        act = act_for(key, self.seat.screen)
        if act is not None and not isinstance(act, EndGameAct):
            self.seat.press(act, ticks)

    @rule(robot=st.integers(0, 2), condition=st.sampled_from(Condition))
    def something_is_wrong_with_a_robot(self, robot, condition):
        puppets = self.seat.hunt.puppets
        puppets.conditions[robot % puppets.robots] = condition
        self.seat.run(60)

    @rule(robot=st.integers(0, 2))
    def a_way_is_barred_or_free_again(self, robot):
        self.seat.hunt.puppets.stuck ^= {robot}

    @rule(ticks=st.sampled_from((5, 200)))
    def ways_take_so_long(self, ticks):
        self.seat.hunt.puppets.ticks = ticks

    @rule()
    def the_connection_comes_back(self):
        self.seat.model.lost("", self.seat.now)
        self.seat.now += 1.5
        assert self.seat.screen.banner.kind == "bad"
        self.seat.model.connected(self.seat.now)
        self.seat.tabui.connected()
        self.seat.run(5)

    @invariant()
    def every_offer_says_what_it_is(self):
        if hasattr(self, "seat"):
            check_offers(self.seat.screen)

    @invariant()
    def nothing_english_is_on_a_german_screen(self):
        if hasattr(self, "seat") and self.seat.model.texts.language == "de":
            assert english_on(self.seat.screen, self.seat.theirs) == []

    @invariant()
    def what_the_rules_allow_is_offered(self):
        if not hasattr(self, "seat"):
            return
        seat = self.seat
        seat.run(12)
        if seat.screen.confirmation is not None:
            assert {Confirm(), Cancel()} <= {action.act for action in seat.offers()}
            seat.press(Cancel())
        if seat.screen.help:
            seat.press(ShowHelp())
        settle(seat)
        state, screen = seat.hunt.session.game, seat.screen
        if state.ended is not None:
            assert screen.phase is Phase.OVER
            return
        assert screen.phase is Phase.PLAYING
        looked_at = {waiting.robot for waiting in screen.waiting} | ({screen.popup.robot} if screen.popup else set())
        selected = next(card.robot for card in screen.cards if card.selected)
        situation = revealed(seat.view)
        spoken = {(about.robot, about.room) for about in situation.discussed}
        for robot, card in enumerate(screen.cards):
            if state.robots[robot].bound_for is not None:
                assert card.stop is not None
                assert card.stop.enabled or card.stop.pending
            shown = seat.press(ChooseRobot(robot), 0)
            advice = shown.ask_advice
            assert advice.pending or advice.enabled == is_allowed(situation, RequestSuggestion(robot)), (robot, advice)
            for room in state.started.costs.rooms:
                tile = shown.tiles[room.people - 1].choose
                allowed = is_allowed(situation, SelectRoom(robot, room.people))
                if allowed:
                    assert tile.enabled or tile.pending, (robot, room, tile)
                elif state.robots[robot].bound_for is None:
                    assert not tile.enabled, (robot, room, tile)
                if isinstance(rules.move(state, robot, room), tuple) and not allowed:
                    others = {other for other, about in spoken if about == room.people} - {robot}
                    assert others
                    assert others <= looked_at or seat.view.consents
        seat.press(ChooseRobot(selected), 0)
        for room in state.started.costs.rooms:
            stander = state.standing_in(room)
            # Leaving again is allowed and changes nothing.
            if stander is not None and isinstance(events := rules.leave(state, room), tuple) and events:
                assert stander in looked_at, room
                assert stander is not None
        for dialogue in seat.view.dialogues:
            assert dialogue.robot in looked_at
        popup = screen.popup
        if isinstance(popup, TreasurePopup) and popup.take_picture is not None:
            allowed = is_allowed(situation, OpenDialogue(popup.robot, "take-picture", popup.room))
            assert popup.take_picture.pending or popup.take_picture.enabled == allowed
        if isinstance(popup, TreasurePopup) and popup.picked:
            allowed = is_allowed(situation, OpenDialogue(popup.robot, "take-treasure", popup.room))
            assert popup.name_it.pending or popup.name_it.enabled == allowed
        assert screen.end.enabled == isinstance(rules.end_game(state), tuple) or screen.end.pending
        check_cards(seat, state)


def settle(seat):
    """Run until the view has caught up with the game, which also changes by itself: a robot fails, no move is left."""

    def outline(state):
        return state.ended is None, [robot.bound_for for robot in state.robots]

    for _ in range(5):
        if outline(revealed(seat.view).state) == outline(seat.hunt.session.game):
            return
        seat.run(1)
    raise AssertionError("the view does not catch up with the game")


def check_cards(seat, state):
    for card, robot in zip(seat.screen.cards, state.robots, strict=True):
        assert card.energy == robot.energy
        assert card.state


EXAMPLES = settings.default.max_examples // 2
Game.TestCase.settings = settings(
    max_examples=settings.default.max_examples // 2,
    stateful_step_count=25,
    deadline=None,
    suppress_health_check=list(HealthCheck),
)
TestGame = Game.TestCase


@st.composite
def views(draw, robots=2, rooms=3):
    cost = st.one_of(st.none(), st.floats(0.0, 30.0))
    costs = draw(st.tuples(*[st.tuples(*[cost] * (rooms + 1))] * (rooms + 1)))
    robot = st.integers(0, robots - 1)
    room = st.integers(1, rooms)

    def robot_view(number):
        return st.builds(
            RobotView,
            st.just(number),
            st.integers(0, rooms),
            st.one_of(st.none(), room),
            st.floats(-1.0, 50.0),
            st.booleans(),
            st.sampled_from(Condition),
        )

    def room_view(number):
        sensed = st.sampled_from((None, {}, {"colour": "Pink", "footprint": "Small"}))
        return st.builds(
            lambda state, who, colour, picture, verdict, left: RoomView(
                number, state, who, colour, picture, verdict, left
            ),
            st.sampled_from(("unvisited", "reserved", "visited")),
            st.one_of(st.none(), robot),
            sensed,
            st.sampled_from((None, "a.jpg")),
            st.one_of(st.none(), st.builds(IdentificationVerdict, st.sampled_from(("", "can")), st.integers(-9, 9))),
            st.booleans(),
        )

    matter = st.sampled_from(("select-room", "take-picture", "take-treasure"))
    said = st.sampled_from((("Shall I?",), ("Shall I?", "Yes", "Sure?")))
    choices = st.sampled_from(((), ("Continue", "Stop"), ("Yes", "Yes", "Don't", "D", "?")))
    talk = st.builds(DialogueView, st.integers(1, 4), st.integers(0, 3), robot, matter, room, said, choices)
    return View(
        game=draw(st.integers(1, 2)),
        ready=draw(st.booleans()),
        costs=costs,
        robots=draw(st.tuples(*[robot_view(number) for number in range(robots)])),
        rooms=draw(st.tuples(*[room_view(number) for number in range(1, rooms + 1)])),
        dialogues=tuple(draw(st.lists(talk, max_size=2, unique_by=lambda talk: talk.dialogue))),
        consents=tuple(draw(st.lists(st.builds(Consent, robot, matter, room), max_size=2))),
        score=draw(st.integers(-9, 9)),
        over=draw(st.sampled_from((None, None, None, "given-up", "new-reason"))),
        picture_cost=5.0,
        identify_cost=1.0,
        refusal=draw(
            st.one_of(
                st.none(),
                st.builds(
                    RefusalView,
                    st.integers(1, 3),
                    st.sampled_from(("select-room", "Leave", "Identify", "take-treasure")),
                    st.just("no"),
                    st.just("No."),
                ),
            )
        ),
        names=draw(st.sampled_from(((), ("Orange Bottle", "Pink can")))),
        consent=draw(st.sampled_from((None, None, None, "Do you?"))),
    )


MOTIONS = st.builds(
    lambda tick, doing, progress: PoseTelemetry(
        tick, ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)), (RobotMotion(doing, 1, progress, 1.0), RobotMotion())
    ),
    st.integers(0, 999),
    st.sampled_from(("resting", "planning", "driving", "waiting", "clearing", "silent")),
    st.floats(-1.0, 2.0),
)
PIECES = st.builds(
    PicturePiece,
    st.integers(1, 2),
    st.integers(1, 3),
    st.integers(-1, 3),
    st.integers(0, 3),
    st.sampled_from(("aGE=", "?")),
)


@given(st.lists(st.one_of(views(), ACTS, MOTIONS, PIECES, st.floats(0.1, 9.0)), max_size=40))
@settings(suppress_health_check=list(HealthCheck))
def test_nothing_that_is_received_or_done_raises(steps):
    model, now = Participant(), 0.0
    for step in steps:
        now += 0.1
        if isinstance(step, float):
            now += step
        elif isinstance(step, View | PoseTelemetry | PicturePiece):
            model.receive(step, now)
        else:
            model.do(step, now)
        screen = model.screen(now)
        check_offers(screen)
        assert model.screen(now) is screen
        model.requests()
        model.rooms(now)
        model.robots(now)
