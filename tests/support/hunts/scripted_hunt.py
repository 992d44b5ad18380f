"""Hunts without a simulator in which the test decides the acts of the participant and of a client outside."""

from tests.support.hunts.hunt_without_simulator import HuntWithoutSimulator
from thbridge.dialogue.arguing import ArguingEngine
from thbridge.dialogue.conditions import DialogueCondition, Manner
from thbridge.dialogue.moves import Author
from thbridge.dialogue.worded import WordedPhrasing
from thbridge.files.game_files import read_rulebook
from thbridge.files.word_files import read_language
from thbridge.roles.keeper.requests.wizard import WizardState
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.robot_requests import CommandRequest, TakeCommand, WizardMode, WizardRequest
from thbridge.roles.shared.view import (
    AnswerDialogue,
    DialogueView,
    ParticipantRequest,
    RequestSuggestion,
    SelectRoom,
    SendRobot,
    View,
)


class ScriptedPlayer:
    """Player whose requests the test sets."""

    def __init__(self) -> None:
        self.wish: tuple[ParticipantRequest, ...] = ()

    def requests(self, view: View):
        return self.wish


def go(played, robot: int, room: int) -> View:
    """Send a robot to a room, and agree to everything it asks."""
    view = played.say(SelectRoom(robot, room))
    while view.dialogues:
        dialogue = view.dialogues[0]
        view = played.say(AnswerDialogue(dialogue.dialogue, dialogue.turn, 0))
    return played.say(SendRobot(robot, room), ticks=25)


NAME = "ground station 255"
TAKE = TakeCommand(0, NAME)
SENTENCE = f"Robot 1 is commanded by {NAME} just now."


class ScriptedHunt:
    """Hunt in which the test decides the requests of the participant and of a client outside."""

    outside = "station"

    def __init__(self, **options) -> None:
        self.player = ScriptedPlayer()
        self.hunt = HuntWithoutSimulator(participant=TabUI(self.player), **options)
        self.hunt.run(10)

    def wish(self, *wishes: ParticipantRequest, ticks: int = 6) -> View:
        self.player.wish = wishes
        self.hunt.tabui.poll_player()
        self.hunt.run(ticks)
        self.player.wish = ()
        return self.view

    def ask(self, *requests: CommandRequest | WizardRequest, ticks: int = 5) -> View:
        for request in requests:
            self.hunt.session.ask(self.outside, request)
        self.hunt.run(ticks)
        return self.view

    @property
    def view(self) -> View:
        view = self.hunt.view()
        assert view is not None
        return view

    def events(self, *kinds: type) -> list:
        return [event for event in self.hunt.log.events if isinstance(event, kinds)]


RULEBOOK, LANGUAGE = read_rulebook(), read_language()
COLLABORATOR = DialogueCondition.COLLABORATOR


def arguing_engine(condition: DialogueCondition) -> ArguingEngine:
    return ArguingEngine(RULEBOOK, {None: Manner(condition)}, WordedPhrasing(LANGUAGE, condition, 7), 7)


class ArguingHunt(ScriptedHunt):
    """Scripted hunt with robots that argue."""

    def __init__(
        self, condition: DialogueCondition = COLLABORATOR, talk: ArguingEngine | None = None, **options
    ) -> None:
        self.talk = talk or arguing_engine(condition)
        super().__init__(talk=self.talk, **options)

    def dialogue(self, robot: int = 0) -> DialogueView:
        return next(each for each in self.view.dialogues if each.robot == robot)

    def say(self, text: str, robot: int = 0) -> View:
        """Choose the first answer that contains a text."""
        talk = self.dialogue(robot)
        choice = next(number for number, sentence in enumerate(talk.choices) if text in sentence)
        return self.wish(AnswerDialogue(talk.dialogue, talk.turn, choice))

    def suggested(self, robot: int = 0) -> int:
        """Return the room that a robot suggests; the dialogue about it is then left."""
        self.wish(RequestSuggestion(robot))
        room = self.dialogue(robot).room
        self.say("Let us leave it", robot)
        return room

    def another_room(self, robot: int = 0) -> int:
        suggested = self.suggested(robot)
        costs = self.view.costs_from(self.view.robots[robot])
        return next(room for room in range(1, 9) if room != suggested and costs[room] is not None)


WIZARD_ON, WIZARD_OFF = WizardMode(0, on=True), WizardMode(0, on=False)


class WizardHunt(ScriptedHunt):
    """Scripted hunt with a wizard outside the session."""

    outside = "wizard"

    @property
    def held(self) -> WizardState:
        return self.hunt.tick_records[-1].wizard

    @property
    def said(self) -> list[tuple[Author, str]]:
        spoken = [item for tick_record in self.hunt.tick_records for item in tick_record.utterances]
        return [(item.author, item.text) for item in spoken if item.topic.robot == 0]
