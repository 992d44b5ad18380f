"""Window, browser and terminal offer the same in the same hunt, at each of its moments.

All three front ends are the real ones, each in a game of its own, with the same seed and the same acts at the same
times. The differences that are intended are in `tests/support/front_ends`, each with its reason:

- a browser has Ctrl+Tab and Ctrl+Q for itself, so its help sheet does not name them (`read_window`);
- a card or a tile shows the longest version of its words that fits (`Shown.differences`);
- the terminal has no selected robot, no pop-ups, no questions for confirmation (`ThreeFrontEnds`).
"""

import dataclasses
import random
from collections import Counter
from collections.abc import Callable, Iterator

import pytest
from PySide6.QtWidgets import QApplication

from tests.support.front_ends.three import ThreeFrontEnds
from tests.support.hunts.study_without_simulator import StudyWithoutSimulator
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.hunt.events import Condition
from thbridge.roles.shared.robot_requests import ReleaseCommand, TakeCommand
from thbridge.study.study_file import Study
from ui.model.playing.screen import (
    Act,
    AnswerDialogueAct,
    AskWhatItIs,
    Cancel,
    ChooseRobot,
    Confirm,
    EndGameAct,
    EnlargePicture,
    FitMap,
    FollowRobot,
    GoOnFromGame,
    IdentifyTreasureAct,
    LeaveTreasureAct,
    PickName,
    RequestHandbackAct,
    RequestSuggestionAct,
    SelectRoomAct,
    ShowHelp,
    ShowNext,
    ShowSettings,
    ShowWaiting,
    StopRobotAct,
    TakePictureAct,
)
from ui.model.shared.theme import LIGHT
from ui.windows import look

OF_THE_MAP = (FollowRobot, FitMap, ShowSettings, GoOnFromGame, EnlargePicture)
"""Acts that change only the view of a front end."""

REFUSABLE = (SelectRoomAct, RequestSuggestionAct, EndGameAct, TakePictureAct)
"""Acts that are also pressed while they are impossible."""


@pytest.fixture
def sit(qapp: QApplication) -> Iterator[Callable[[Study], ThreeFrontEnds]]:
    look.apply_palette(qapp, LIGHT)
    sitting: list[ThreeFrontEnds] = []

    def make(study: Study) -> ThreeFrontEnds:
        sitting.append(ThreeFrontEnds(study))
        return sitting[-1]

    yield make
    for each in sitting:
        each.window.window.close()
        each.window.window.deleteLater()


def study(
    condition: DialogueCondition, language: str = "en", templates: str = "everyday-things", seed: int = 5
) -> Study:
    plain = Study()
    talk = dataclasses.replace(plain.dialogue, condition=condition, language=language)
    return dataclasses.replace(plain, templates=templates, robots=3, seed=seed, dialogue=talk)


EVENTS: dict[int, Callable[[StudyWithoutSimulator], None]] = {
    6: lambda game: game.puppets.conditions.__setitem__(1, Condition.LOST),
    9: lambda game: game.session.ask("station", TakeCommand(2, "ground station 255")),
    14: lambda game: game.puppets.conditions.__setitem__(1, Condition.SILENT),
    17: lambda game: game.session.ask("station", ReleaseCommand(2)),
    20: lambda game: game.puppets.conditions.__setitem__(1, Condition.WELL),
    23: lambda game: game.puppets.stuck.add(0),
    28: lambda game: game.puppets.stuck.clear(),
}
"""What happens to the robots, by the number of the step before it."""


APPEAL: dict[object, float] = {
    AnswerDialogueAct(0): 3.0,
    RequestSuggestionAct: 2.0,
    IdentifyTreasureAct: 4.0,
    ShowHelp: 0.3,
    ChooseRobot: 0.7,
}
"""How often a person does an act in comparison with others; 1 for all that are not named."""


def kind_of(act: Act) -> object:
    """Return what makes an act something new for a person: its class, for answers also which one."""
    return act if isinstance(act, AnswerDialogueAct) else type(act)


def choices(three: ThreeFrontEnds) -> list[Act]:
    """Return the acts that a person may do now, in the order of the page."""
    page, shown = three.page, three.shown
    if page["question"]:
        return [Confirm(), Cancel()]
    if page["help"]:
        return [ShowHelp()]
    drives = any(card["selected"] and card["progress"] is not None for card in page["cards"])
    acts = [act for act in shown.possible() if not isinstance(act, (*OF_THE_MAP, EndGameAct))]
    acts = [act for act in acts if not (drives and isinstance(act, SelectRoomAct))]
    names = page["treasure"]["names"] if page["treasure"] else []
    impossible = [act for act, offer in shown.offers.items() if not offer.possible and isinstance(act, REFUSABLE)]
    return [*acts, *(PickName(name["pick"]["name"]) for name in names), *impossible]


def play(three: ThreeFrontEnds, steps: int, choose: Callable[[list[Act]], Act | None]) -> None:
    """Play a hunt, and end it after a number of steps."""
    three.step()
    for number in range(steps):
        if number in EVENTS:
            three.outside(EVENTS[number])
            three.step()
        three.step(choose(choices(three)))
        if three.page["ending"]:
            return
    while not three.page["ending"]:
        offered = three.shown.offers
        stop = next((act for act in offered if isinstance(act, StopRobotAct) and offered[act].possible), None)
        end = EndGameAct() if offered[EndGameAct()].possible else stop
        three.step(Confirm() if three.page["question"] else end)


@pytest.mark.slow
def test_a_hunt_with_robots_that_argue(sit: Callable[[Study], ThreeFrontEnds]) -> None:
    three = sit(study(DialogueCondition.COLLABORATOR))
    done: Counter[object] = Counter()

    def newest(acts: list[Act]) -> Act | None:
        """Choose what was done least so far."""
        act = min(acts, key=lambda each: (done[kind_of(each)] + 1) / APPEAL.get(kind_of(each), 1.0), default=None)
        done[act if act is None else kind_of(act)] += 1
        return act

    play(three, 40, newest)
    assert three.faults == []
    assert {AnswerDialogueAct(number) for number in range(4)} <= set(done)
    assert {SelectRoomAct, RequestSuggestionAct, ChooseRobot, RequestHandbackAct, Confirm, Cancel} <= set(done)
    assert {ShowNext, ShowWaiting, PickName, IdentifyTreasureAct, LeaveTreasureAct, TakePictureAct} <= set(done)


@pytest.mark.slow
@pytest.mark.timeout(280)
@pytest.mark.parametrize(
    ("condition", "language", "templates", "seed"),
    [
        (DialogueCondition.COLLABORATOR, "de", "everyday-things", 1),
        (DialogueCondition.ADVISER, "de", "four-properties", 2),
        (DialogueCondition.AUTONOMOUS, "en", "original-2016", 3),
        (DialogueCondition.SCRIPT, "de", "everyday-things", 4),
        (DialogueCondition.SUPERVISOR, "en", "four-properties", 5),
    ],
)
def test_random_hunts(
    sit: Callable[[Study], ThreeFrontEnds], condition: DialogueCondition, language: str, templates: str, seed: int
) -> None:
    rng = random.Random(seed)
    three = sit(study(condition, language, templates, seed=seed))

    def random_act(acts: list[Act]) -> Act | None:
        likely = [act for act in acts if isinstance(act, (AskWhatItIs, IdentifyTreasureAct, AnswerDialogueAct))]
        return rng.choice(likely if likely and rng.random() < 0.5 else acts) if acts else None

    play(three, 150, random_act)
    assert three.faults == []
