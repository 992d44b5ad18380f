"""Participant's window, in the states of a hunt."""

import tempfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from msgspec import structs

from pictured import language
from pictured.hunt import PicturedHunt
from pictured.shot import Shot, Story, unkept_preferences
from sim.common.geometry import Pose2
from sim.inputs import KidnapRobot, SetPoseEstimate
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.hunt.events import Condition
from thbridge.roles.participant.tabui import ParticipantUpdate
from thbridge.roles.shared.notices import PoseTelemetry
from thbridge.roles.shared.robot_requests import StationSend, TakeCommand
from thbridge.roles.shared.view import View
from thbridge.study.built_in import STANDARD
from thbridge.study.study_file import DialogueSection, ParticipantSection, ShowsSection, Study
from ui.hosting.games import PRACTICE
from ui.model.lobby import Offer, Preparing
from ui.model.playing.participant import Participant
from ui.model.playing.screen import (
    Cancel,
    ChooseRobot,
    Confirm,
    ConsiderRoom,
    EndGameAct,
    IdentifyTreasureAct,
    LeaveTreasureAct,
    MeasurePropertyAct,
    PickName,
    RequestHandbackAct,
    RequestSuggestionAct,
    SelectRoomAct,
    ShowHelp,
    ShowNext,
    ShowWaiting,
    TakePictureAct,
    TreasurePopup,
)
from ui.model.shared.theme import LIGHT
from ui.sources.game import ReceivedEvent, ServerReached
from ui.windows.link import ParticipantLink
from ui.windows.participant import ParticipantWindow
from ui.windows.participant_program import GamePage, ParticipantMainWindow

SIZE = (1200, 800)

CONSENT = """\
Thank you for your interest in this study of how people and robots decide together.

You will command a team of robots that look for treasures in a house. This takes about twenty minutes. What you do in \
the game is recorded under a number, not under your name.

You may stop at any time and need not say why; close the window, and nothing more is recorded. No one will ask you to \
explain it, and you keep your compensation.

The recordings are kept for ten years and may be published without anything that identifies you. If you have a \
question, please ask it now, before you begin.

By pressing the button you say that you are eighteen or older, that you have read this text, and that you take part \
voluntarily.
"""


class PicturedWindow(ParticipantWindow):
    """Window whose model can also be shown by a browser."""

    def __init__(self, model: Participant, clock: Callable[[], float]) -> None:
        super().__init__(model, clock, LIGHT)
        self.model, self.now = model, clock


def window_on(model: Participant, clock: Callable[[], float]) -> PicturedWindow:
    """Return a window of the usual size."""
    window = PicturedWindow(model, clock)
    window.resize(*SIZE)
    window.show()
    return window


def shot(name: str, window: PicturedWindow) -> Shot:
    """Return a picture of a window."""
    return Shot(name, window, window.set_palette, settled=lambda: not window.top.score.is_counting)


# Before a game --------------------------------------------------------------------------------------------------------


def before() -> Iterator[Shot]:
    """Yield the start page, the preparation of a game, and connecting."""
    window = ParticipantMainWindow(unkept_preferences(), lambda _: None, texts=language.texts())
    window.resize(*SIZE)
    window.show()
    window.receive(Offer(language.texts(), 1, 4, 2))
    yield Shot("start", window)
    window.receive(Offer(language.texts(), 2, 2, 2))
    yield Shot("start-no-choice", window)
    window.receive(Preparing("The robots are being prepared."))
    yield Shot("preparing", window)
    window.leave()
    yield shot("connecting", window_on(Participant(), lambda: 0.0))


def consent() -> Iterator[Shot]:
    """Yield the consent text of a study."""
    with tempfile.TemporaryDirectory() as folder:
        text = Path(folder) / "consent.txt"
        text.write_text(CONSENT, encoding="utf-8")
        hunt = PicturedHunt(replace(STANDARD, participant=ParticipantSection(consent=text)))
    yield shot("consent", window_on(hunt.model, lambda: hunt.now))


def practice() -> Iterator[Shot]:
    """Yield the practice game, with advice above the map."""
    hunt = PicturedHunt(PRACTICE)
    hunt.send(SelectRoomAct(1))
    hunt.reached()
    game = GamePage(RecordedLink(hunt), language.texts(), unkept_preferences(), True, lambda: None, lambda: hunt.now)
    game.resize(*SIZE)
    game.show()
    game.setFocus()
    game.pump()
    yield Shot("practice", game, game.window_of_game.set_palette)
    game.leave()


class RecordedLink(ParticipantLink):
    """Link with all events already received."""

    def __init__(self, hunt: PicturedHunt) -> None:
        super().__init__("", 0, "nobody")
        self._recorded = [ReceivedEvent(hunt.now, event) for event in (ServerReached(), *hunt.levels.values())]

    def start(self) -> None:
        """Do nothing, because this link has no connection."""

    def stop(self) -> None:
        """Do nothing, because no thread is running."""

    def take_events(self) -> list[ReceivedEvent]:
        """Return all events at once."""
        events, self._recorded = self._recorded, []
        return events


# A hunt ---------------------------------------------------------------------------------------------------------------


def hunting() -> Iterator[Shot]:
    """Yield a hunt of three robots, from the first choice of a room to the end."""
    hunt = PicturedHunt(replace(STANDARD, robots=3))
    window = window_on(hunt.model, lambda: hunt.now)
    hunt.do(ConsiderRoom(6))
    yield shot("begin", window)
    hunt.do(SelectRoomAct(6))
    yield shot("thinking", window)
    hunt.asked()
    yield shot("talk", window)
    hunt.agree()
    hunt.do(ConsiderRoom(None))
    hunt.do(ChooseRobot(1))
    hunt.send(SelectRoomAct(3))
    hunt.reached()
    yield shot("treasure", window)
    hunt.send(TakePictureAct())
    hunt.until(lambda screen: getattr(screen.popup, "picture", None) is not None)
    hunt.do(PickName("beer_bottle"))
    yield shot("picture", window)
    hunt.send(IdentifyTreasureAct())
    hunt.until(lambda screen: getattr(screen.popup, "verdict", None) is not None)
    yield shot("verdict", window)
    hunt.do(ShowNext())
    hunt.reached()
    hunt.do(PickName("candy_box"))
    hunt.send(IdentifyTreasureAct())
    hunt.until(lambda screen: getattr(screen.popup, "verdict", None) is not None)
    yield shot("verdict-wrong", window)
    hunt.do(ShowNext())
    yield from _at_work(hunt, window)
    yield from _queue(hunt, window)
    yield from _end(hunt, window)


def _at_work(hunt: PicturedHunt, window: PicturedWindow) -> Iterator[Shot]:
    """Yield a hunt in which robot 1 drives and robot 2 waits for robot 1."""
    for robot, room in ((1, 1), (0, 2)):
        hunt.do(ChooseRobot(robot))
        hunt.send(SelectRoomAct(room))
    hunt.run(8.0)
    hunt.shade = _waiting_for
    hunt.run(0.2)
    hunt.do(ConsiderRoom(7))
    yield shot("playing", window)
    hunt.do(ConsiderRoom(None))
    hunt.shade = lambda seen: seen
    hunt.do(ShowHelp())
    yield shot("help", window)
    hunt.do(ShowHelp())
    window.waiting.history.click()
    yield shot("history", window)
    window.waiting.history.click()


def _waiting_for(seen: ParticipantUpdate) -> ParticipantUpdate:
    """Return a message in which robot 2 waits for robot 1."""
    if not isinstance(seen, PoseTelemetry):
        return seen
    motions = list(seen.motions)
    motions[1] = replace(motions[1], doing="waiting", waits_for=0)
    return structs.replace(seen, motions=tuple(motions))


def _queue(hunt: PicturedHunt, window: PicturedWindow) -> Iterator[Shot]:
    """Yield two robots that arrive while the third robot asks a question; then robots with problems."""
    hunt.do(SelectRoomAct(5))
    yield shot("question-change", window)
    hunt.do(Cancel())
    hunt.do(ChooseRobot(2))
    hunt.do(SelectRoomAct(8))
    hunt.asked()
    hunt.until(lambda screen: sum(tile.room in (1, 2) and tile.found != "" for tile in screen.tiles) == 2)
    yield shot("queue", window)
    hunt.agree()
    while hunt.screen.popup is not None:
        hunt.do(ShowNext())
    hunt.run(1.0)
    hunt.model.lost("The server does not answer.", hunt.now)
    hunt.now += 12.0
    yield shot("lost-connection", window)
    hunt.model.connected(hunt.now)
    hunt.run(0.2)
    hunt.model.do(SelectRoomAct(6), hunt.now)
    yield shot("refused", window)
    hunt.now += 10.0
    hunt.run(0.2)
    hunt.change_view(_in_trouble)
    yield shot("trouble", window)
    hunt.change_view(lambda view: view)


def _in_trouble(view: View) -> View:
    """Return a view in which one robot is lost, one has no energy left, and one does not answer."""
    first, second, third, *others = view.robots
    lost = replace(first, condition=Condition.LOST, moving_to=None)
    spent = replace(second, energy=0.0, blocked=True, moving_to=None)
    silent = replace(third, condition=Condition.SILENT)
    return structs.replace(view, robots=(lost, spent, silent, *others))


def _end(hunt: PicturedHunt, window: PicturedWindow) -> Iterator[Shot]:
    """Leave all treasures undecided, and end the game."""
    hunt.until(lambda screen: all(card.progress is None for card in screen.cards))
    hunt.reached()
    for robot in (2, 1, 0):
        if hunt.screen.popup is None:
            hunt.do(ShowWaiting(robot))
        hunt.do(LeaveTreasureAct())
        hunt.run(0.2)
    hunt.do(EndGameAct())
    yield shot("question-end", window)
    hunt.do(Confirm())
    hunt.until(lambda screen: screen.ending is not None)
    yield shot("over", window)


def sure() -> Iterator[Shot]:
    """Yield a study that shows the uncertainty of the robots' poses, and their true poses."""
    shows = ShowsSection(uncertainty=True, truth=True)
    hunt = PicturedHunt(replace(STANDARD, participant=ParticipantSection(shows=shows)))
    hunt.send(SelectRoomAct(8))
    hunt.do(ChooseRobot(1))
    hunt.send(SelectRoomAct(1))
    hunt.run(6.0)
    hunt.ask(KidnapRobot(0, Pose2(4.2, 0.6, 2.5)))
    hunt.ask(SetPoseEstimate(1, Pose2(0.2, 2.6, 2.0), np.diag([0.3, 0.1, 0.1])))
    hunt.run(0.3)
    yield shot("uncertainty", window_on(hunt.model, lambda: hunt.now))


def commanded() -> Iterator[Shot]:
    """Yield a game in which a ground station takes command of a driving robot, and sends the robot on from its room."""
    hunt = PicturedHunt(STANDARD)
    window = window_on(hunt.model, lambda: hunt.now)
    for robot, room in ((1, 1), (0, 8)):
        hunt.do(ChooseRobot(robot))
        hunt.send(SelectRoomAct(room))
    hunt.run(5.0)
    hunt.ask(TakeCommand(0, "ground station 255"))
    hunt.run(0.2)
    yield shot("commanded", window)
    hunt.do(RequestHandbackAct(0))
    hunt.run(0.2)
    yield shot("commanded-asked", window)
    hunt.until(lambda screen: screen.tiles[7].found != "")
    hunt.ask(StationSend(0, 7))
    hunt.until(lambda screen: screen.cards[0].progress is not None)
    hunt.run(2.0)
    yield shot("commanded-sent-on", window)


def properties() -> Iterator[Shot]:
    """Yield treasures with four properties: two are seen, one is sensed, one is reported by the participant."""
    hunt = PicturedHunt(Study(templates="four-properties"))
    window = window_on(hunt.model, lambda: hunt.now)
    hunt.send(SelectRoomAct(2))
    hunt.reached()
    yield shot("properties", window)
    hunt.do(MeasurePropertyAct("weight"))
    hunt.run(0.4)
    hunt.send(TakePictureAct())
    hunt.until(lambda screen: getattr(screen.popup, "picture", None) is not None)
    yield shot("properties-picture", window)


def arguing() -> Iterator[Shot]:
    """Yield robots that argue: a disagreement, reasons, questions, two robots at once, and the end."""
    hunt = PicturedHunt(_argued(DialogueCondition.COLLABORATOR))
    window = window_on(hunt.model, lambda: hunt.now)
    hunt.do(SelectRoomAct(6))
    hunt.asked()
    yield shot("argue", window)
    hunt.say("challenge")
    yield shot("argue-reasons", window)
    hunt.say("open-questions")
    yield shot("argue-questions", window)
    hunt.say("enquire", 3)
    hunt.do(ChooseRobot(1))
    hunt.do(RequestSuggestionAct())
    hunt.run(0.4)
    yield shot("argue-two", window)
    hunt.do(ChooseRobot(0))
    hunt.say("leave")
    yield shot("argue-left", window)
    hunt.do(ChooseRobot(1))
    hunt.say("accept")
    hunt.run(3.0)
    yield shot("argue-agreed", window)
    hunt.until(lambda screen: bool(getattr(screen.popup, "facts", ())))
    yield shot("argue-found", window)
    hunt.do(PickName(_misfit(hunt.screen.popup)))
    hunt.do(IdentifyTreasureAct())
    hunt.asked()
    hunt.say("challenge")
    yield shot("argue-name", window)
    advised = PicturedHunt(_argued(DialogueCondition.ADVISER))
    advised.do(SelectRoomAct(6))
    advised.asked()
    advised.say("challenge")
    yield shot("argue-adviser", window_on(advised.model, lambda: advised.now))


def _misfit(pop: object) -> str:
    """Return a name with another color than the treasure's color."""
    if not isinstance(pop, TreasurePopup):
        raise TypeError("the window shows no treasure")
    colour = (pop.facts or ())[0].value
    return next(name for name in pop.names if colour not in name)


def _argued(condition: DialogueCondition) -> Study:
    return Study(dialogue=DialogueSection(condition=condition))


def crowd() -> Iterator[Shot]:
    """Yield six robots and twelve rooms."""
    hunt = PicturedHunt(replace(STANDARD, map="warehouse12", robots=6))
    for robot, room in enumerate((5, 12, 3, 9)):
        hunt.do(ChooseRobot(robot))
        hunt.send(SelectRoomAct(room))
    hunt.run(3.0)
    hunt.do(ConsiderRoom(7))
    yield shot("six-robots", window_on(hunt.model, lambda: hunt.now))


def leaving() -> Iterator[Shot]:
    """Yield the question that appears when the window is closed in the middle of a game."""
    hunt = PicturedHunt(STANDARD)
    window = ParticipantMainWindow(unkept_preferences(), lambda _: None, lambda: hunt.now, language.texts())
    window.resize(*SIZE)
    window.show()
    window.join(RecordedLink(hunt))
    if window.game is None:
        raise RuntimeError("the window shows no game")
    game = window.game
    game.pump()
    window.close()
    yield Shot("leave", window, game.window_of_game.set_palette)
    window.leave()


STORIES = (
    Story(
        "The participant, before a game",
        {
            "start": "Start page",
            "start-no-choice": "Start page of a study that allows one number of robots",
            "preparing": "A game is being prepared",
            "connecting": "Connecting to the game",
        },
        before,
    ),
    Story("Consent", {"consent": "Consent"}, consent),
    Story("Practice", {"practice": "Practice game, with advice above the map"}, practice),
    Story(
        "A hunt",
        {
            "begin": "The game begins; the pointer is on room 6",
            "thinking": "A room is selected; the robot thinks",
            "talk": "The robot asks",
            "treasure": "A treasure is sensed",
            "picture": "A picture was taken, and a name is chosen",
            "verdict": "A right name",
            "verdict-wrong": "A wrong name",
            "playing": "Robot 1 drives, robot 2 waits for it, robot 3 rests; one room is visited, two are reserved",
            "help": "Keys (F1)",
            "history": "The history is open",
            "question-change": "A driving robot gets another goal",
            "queue": "Two robots wait while the third robot asks a question",
            "lost-connection": "The connection is lost",
            "refused": "A request is refused with a reason",
            "trouble": "One robot is lost, one has no energy left, one does not answer",
            "question-end": "The question before a game is ended",
            "over": "The game is over",
        },
        hunting,
    ),
    Story("Uncertainty of the robots", {"uncertainty": "A study that shows the believed and the true poses"}, sure),
    Story(
        "Robots under other commanders",
        {
            "commanded": "A ground station has taken robot 1, which is selected",
            "commanded-asked": "The participant has asked to get robot 1 back",
            "commanded-sent-on": "The ground station sent robot 1 away; the treasure that was found can still be named",
        },
        commanded,
    ),
    Story(
        "Treasures with other properties",
        {
            "properties": "Two properties are visible; sensing the weight costs energy",
            "properties-picture": "The weight was sensed; the participant reports the material from the picture",
        },
        properties,
    ),
    Story(
        "Robots that argue",
        {
            "argue": "The robot does not agree",
            "argue-reasons": "The robot gives its reasons",
            "argue-questions": "Questions to the robot",
            "argue-two": "Robot 2 asks while robot 1 also waits for an answer",
            "argue-left": "A dialogue that ended without an agreement",
            "argue-agreed": "The robot does as agreed",
            "argue-found": "A treasure, and the button to ask the robot about it",
            "argue-name": "A name that does not match the treasure",
            "argue-adviser": "The participant makes the final decision",
        },
        arguing,
    ),
    Story("Many robots", {"six-robots": "Six robots and twelve rooms"}, crowd),
    Story("Leaving", {"leave": "The window is closed in the middle of a game"}, leaving),
)
