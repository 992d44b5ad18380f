"""A trial of a strategy finds its faults, and tells the positions."""

from dataclasses import dataclass
from itertools import count

import pytest

from thbridge.dialogue.conditions import Manner
from thbridge.dialogue.games.contents import DialogueMove
from thbridge.dialogue.games.control import Conversation
from thbridge.dialogue.games.strategies import GameStrategy
from thbridge.dialogue.robot_strategies import own_strategy
from thbridge.dialogue.trials.strategy_check import try_strategy
from thbridge.files.game_files import read_rulebook

RULEBOOK = read_rulebook()
GAMES: set[str] = set()
TOPICS: set[str] = set()


@dataclass(frozen=True)
class Noting:
    """The own strategy, which notes what it plays."""

    own: GameStrategy

    def choose(self, conversation: Conversation, number: int) -> DialogueMove:
        play = conversation.play(number)
        GAMES.add(play.game.name)
        TOPICS.add(str(play.topic).partition("(")[0].removeprefix("not "))
        return self.own.choose(conversation, number)


@pytest.mark.slow
def test_the_own_strategy_has_no_faults_in_any_game_or_situation() -> None:
    trial = try_strategy(lambda manner, seed: Noting(own_strategy(manner, seed)), RULEBOOK, 1, 0)
    assert trial.faults == {} and trial.moves > 1000
    assert set(RULEBOOK.games) == GAMES
    assert {"next", "picture", "selected", "in_image"} <= TOPICS


_CALLS = count()


@dataclass(frozen=True)
class Broken:
    """Raises, cheats or plays otherwise each time, by the state of the game."""

    manner: Manner
    seed: int

    def choose(self, conversation: Conversation, number: int) -> DialogueMove:
        play, legal = conversation.play(number), conversation.legal(number)
        match play.stage:
            case "challenged":
                raise ValueError("I say nothing")
            case "asked":
                return DialogueMove("accept", play.topic)
            case _:
                return legal[next(_CALLS) % len(legal)]


def test_a_broken_strategy_is_told_of_each_fault_with_the_position() -> None:
    faults = try_strategy(Broken, RULEBOOK, 1, 0).faults
    raised = next(fault for problem, fault in faults.items() if problem.startswith("ValueError: I say nothing (test_"))
    assert raised.position[0].endswith("in the state challenged") and raised.times > 1
    assert raised.position[-1].startswith("The robot may say: assert(")
    assert any(problem.endswith(" is not legal here") for problem in faults)
    fickle = faults["two requests for the same position gave different moves"]
    assert fickle.position[-1].startswith("It chose ") and "seed" in fickle.remedy
