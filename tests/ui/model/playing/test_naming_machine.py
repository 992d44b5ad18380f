"""Random keys, clicks and views: a treasure is named only as it was chosen in the question shown."""

from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

from tests.support.hunts.screen_player import ScreenPlayer
from tests.support.hunts.scripted_hunt import TAKE
from thbridge.hunt.events import Condition, TreasureIdentified
from thbridge.hunt.treasures import name_in_words
from thbridge.roles.shared.robot_requests import ReleaseCommand, StationSend
from ui.model.playing.keys import act_for
from ui.model.playing.screen import (
    AnswerDialogueAct,
    ChooseRobot,
    DialoguePopup,
    EndGameAct,
    IdentifyTreasureAct,
    PickName,
    SelectRoomAct,
    TreasurePopup,
    TypeLetter,
)

LETTERS = tuple("ABCDFNPTX")
KEYS = (*LETTERS, "Space", "Up", "Down", "Home", "End", "Enter", "Esc", "Tab", "?", "F1", "1", "5")
KEYS += ("Enter", "Ctrl+N", "Ctrl+P", "Ctrl+W", "Ctrl+D", "Y", "S")


class Naming(RuleBasedStateMachine):
    """A participant with two robots at their finds, who remembers what they chose in the question before them."""

    @initialize(set_name=st.sampled_from(("original-2016", "sklar-azhar-2015")))
    def two_finds(self, set_name):
        self.seat = ScreenPlayer(robots=2, set_name=set_name)
        self.question = None
        self.chosen = None
        self.said = {}
        self.read = 0
        for robot, room in ((0, 3), (1, 4)):
            self.seat.press(ChooseRobot(robot))
            self.seat.press(SelectRoomAct(room))
            for _ in range(3):
                self.seat.press(AnswerDialogueAct(0), 20)
        self.look()

    def look(self):
        """See the screen: another question than before, or none, and what was chosen is chosen no more."""
        pop = self.seat.screen.popup
        asked = None
        if isinstance(pop, TreasurePopup) and pop.verdict is None:
            robot = self.seat.view.robots[pop.robot]
            asked = (pop.robot, pop.room, robot.place == pop.room and robot.moving_to is None)
        if asked is None or asked != self.question:
            self.question, self.chosen = asked, None

    def act(self, act, ticks):
        """Do an act as its person means it, and see what comes of it."""
        if isinstance(act, IdentifyTreasureAct) and self.chosen is not None:
            self.said[self.question[1]] = self.chosen
        self.seat.model.do(act, self.seat.now)
        self.look()
        if isinstance(act, PickName | TypeLetter) and self.question is not None:
            self.chosen = self.seat.screen.popup.picked
        for _ in range(ticks):
            self.seat.run(1)
            self.look()

    @rule(key=st.sampled_from(KEYS), ticks=st.sampled_from((0, 0, 1, 30)))
    def press(self, key, ticks):
        act = act_for(key, self.seat.screen)
        if act is not None:
            self.act(act, ticks)

    @rule(data=st.data(), ticks=st.sampled_from((0, 1, 30)))
    def click(self, data, ticks):
        acts = [action.act for action in self.seat.offers() if action.enabled and action.act != EndGameAct()]
        self.act(data.draw(st.sampled_from(acts)), ticks)

    @rule(data=st.data(), ticks=st.sampled_from((0, 1)))
    @precondition(lambda self: self.question is not None)
    def choose(self, data, ticks):
        self.act(PickName(data.draw(st.sampled_from(self.seat.names))), ticks)

    @rule(data=st.data())
    @precondition(lambda self: isinstance(self.seat.screen.popup, DialoguePopup) and self.seat.screen.popup.choices)
    def answer(self, data):
        self.act(data.draw(st.sampled_from(self.seat.screen.popup.choices)).act, 20)

    @rule()
    def time_passes(self):
        self.seat.run(90)
        self.look()

    @rule(room=st.integers(1, 8), released=st.booleans())
    def somebody_else_sends_robot_1_on(self, room, released):
        ask = self.seat.hunt.session.ask
        ask("station", TAKE)
        ask("station", StationSend(0, room))
        if released:
            ask("station", ReleaseCommand(0))
        for _ in range(20):
            self.seat.run(1)
            self.look()

    @rule(condition=st.sampled_from(Condition))
    def robot_2_is_well_or_not(self, condition):
        self.seat.hunt.puppets.conditions[1] = condition
        for _ in range(60):
            self.seat.run(1)
            self.look()

    @rule()
    def the_connection_comes_back(self):
        self.seat.model.lost("It broke.", self.seat.now)
        self.look()
        self.seat.model.connected(self.seat.now)
        self.seat.tabui.connected()
        self.seat.run(5)
        self.look()

    @invariant()
    def only_what_was_chosen_is_named(self):
        if not hasattr(self, "seat"):
            return
        pop = self.seat.screen.popup
        if self.question is not None and not pop.name_it.pending:
            assert pop.picked == self.chosen
            assert (pop.name_it.label == "Name it") == (self.chosen is None)
        talks = [talk for talk in self.seat.view.dialogues if talk.matter == "take-treasure"]
        if isinstance(pop, DialoguePopup) and ": name " in pop.title:
            room = next(talk.room for talk in talks if talk.robot == pop.robot)
            assert f"name it {name_in_words(self.said[room])}?" in pop.title
        events = self.seat.hunt.log.events
        for event in events[self.read :]:
            if isinstance(event, TreasureIdentified):
                assert event.name == self.said[event.room.people]
        self.read = len(events)


EXAMPLES = settings.default.max_examples // 2
Naming.TestCase.settings = settings(
    max_examples=settings.default.max_examples // 2,
    stateful_step_count=40,
    deadline=None,
    suppress_health_check=list(HealthCheck),
)
TestNaming = Naming.TestCase
