"""Loading, checks and supervision of the plug-ins that a study names; see `thbridge.files.plugins`."""

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

from thbridge.dialogue.conditions import Manner
from thbridge.dialogue.games.contents import DialogueMove
from thbridge.dialogue.games.control import Conversation
from thbridge.dialogue.games.strategies import Attitude
from thbridge.dialogue.robot_strategies import StrategyFactory
from thbridge.files.plugins import PARTICIPANTS, STRATEGIES, WORDINGS, printing_aside
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.participant.bots import Bot, TreasureKnowledge
from thbridge.roles.participant.installed_participant import InstalledParticipant, ParticipantCaller, ParticipantFactory
from thbridge.roles.shared.view import ParticipantRequest
from thbridge.timing.slow_calls import ImpatientCaller, told_if_slow

if TYPE_CHECKING:
    from thbridge.dialogue.wording.authors import WordingAuthor, WordingRequest

_log = logging.getLogger(__name__)

MOST_LOGGED = 100
"""Maximum number of different faults of a plug-in that are logged."""
_NO_TREASURES = TreasureKnowledge((), {})
PATIENCE = 2.0
"""If a game waits for a plug-in for this number of seconds of wall time, the log contains a warning."""


@dataclass(frozen=True, slots=True)
class WatchedStrategy:
    """Strategy of a lab. A warning is logged if a game waits for a move; moves do not depend on the duration.

    Attributes:
        name: name of the strategy.
        factory: factory of the strategy.
        manner: manner of the robot, as in `StrategyFactory`.
        seed: random seed, as in `StrategyFactory`.
    """

    name: str
    factory: StrategyFactory
    manner: Manner
    seed: int

    def choose(self, conversation: Conversation, number: int) -> DialogueMove:
        """Return the strategy's move; see `GameStrategy`."""
        warning = f"the strategy {self.name} needs more than {PATIENCE:g} s to choose a move; meanwhile, the game waits"
        with told_if_slow(PATIENCE, lambda: _log.warning(warning)), printing_aside():
            return self.factory(self.manner, self.seed).choose(conversation, number)


@dataclass(frozen=True, slots=True)
class ImpatientStrategy:
    """Strategy of a lab, called with a timeout.

    Attributes:
        factory: factory of the strategy.
        caller: caller with the timeout.
        manner: manner of the robot, as in `StrategyFactory`.
        seed: random seed, as in `StrategyFactory`.
    """

    factory: StrategyFactory
    caller: ImpatientCaller[DialogueMove]
    manner: Manner
    seed: int

    def choose(self, conversation: Conversation, number: int) -> DialogueMove:
        """Return the strategy's move; see `GameStrategy`. Raises TimeoutError: the call took too long."""
        with printing_aside():
            return self.caller.call(lambda: self.factory(self.manner, self.seed).choose(conversation, number))


def installed_author(name: str) -> "WordingAuthor":
    """Return the author of wordings with this name.

    Raises:
        BadFile: no author with this name is installed, or the author cannot be imported or called.
    """
    author: WordingAuthor = WORDINGS.load(name)
    warning = f"the author {name} needs more than {PATIENCE:g} s for a sentence; meanwhile, the game waits"

    def watched(request: "WordingRequest", /) -> str | None:
        with told_if_slow(PATIENCE, lambda: _log.warning(warning)), printing_aside():
            return author(request)

    return watched


def impatient_author(name: str, seconds: float) -> "WordingAuthor":
    """Return the author of wordings with this name, for trials.

    The author raises TimeoutError after `seconds` of wall time.

    Raises:
        BadFile: for the same reasons as `installed_author`.
    """
    author: WordingAuthor = WORDINGS.load(name)
    caller = ImpatientCaller[str | None](seconds)

    def impatient(request: "WordingRequest", /) -> str | None:
        with printing_aside():
            return caller.call(lambda: author(request))

    return impatient


def installed_strategy(name: str) -> StrategyFactory:
    """Return the factory of the strategy with this name, for games.

    Raises:
        BadFile: for the same reasons as `installed_author`; or the factory does not accept a manner and a seed, or does
            not return a strategy.
    """
    return partial(WatchedStrategy, name, _strategy(name))


def impatient_strategy(name: str, seconds: float) -> StrategyFactory:
    """Return the factory of the strategy with this name, for trials.

    Args:
        name: name of the strategy.
        seconds: timeout of a move, in wall time.

    Raises:
        BadFile: for the same reasons as `installed_strategy`.
    """
    return partial(ImpatientStrategy, _strategy(name), ImpatientCaller(seconds))


def participant_factory(name: str) -> ParticipantFactory:
    """Return the factory of the simulated participant with this name.

    Raises:
        BadFile: for the same reasons as `installed_author`; or the factory has other arguments, or does not return a
            participant.
    """
    factory: ParticipantFactory = PARTICIPANTS.load(name)
    takes = "a TreasureKnowledge, an attitude and a seed"
    PARTICIPANTS.made(name, lambda: factory(_NO_TREASURES, Attitude.CREDULOUS, 0), ("requests",), takes)
    return factory


def installed_participant(
    name: str, knowledge: TreasureKnowledge, seed: int, attitude: Attitude, call: ParticipantCaller | None = None
) -> InstalledParticipant:
    """Return the simulated participant with this name.

    Args:
        name: name of the participant.
        knowledge: knowledge of treasures.
        seed: random seed.
        attitude: attitude of the participant toward statements of robots.
        call: function that calls the participant in a trial, where faults are not logged. If None, the game waits for
            each call.

    Raises:
        BadFile: for the same reasons as `participant_factory`.
    """
    factory = participant_factory(name)
    warning = f"the participant {name} needs more than {PATIENCE:g} s for a decision; meanwhile, the game waits"

    def watched(asked: Callable[[], Sequence[ParticipantRequest]]) -> Sequence[ParticipantRequest]:
        with told_if_slow(PATIENCE, lambda: _log.warning(warning)), printing_aside():
            return asked()

    def ignored(_fault: str) -> None:
        pass

    report = ignored if call else FaultLog(f"a built-in participant decided, because {name} failed")
    with printing_aside():
        player = factory(replace(knowledge, shown_by=dict(knowledge.shown_by)), attitude, seed)
    stand_in = Bot(BotStrategy.SUGGESTION, knowledge, seed, attitude)
    return InstalledParticipant(player, stand_in, call or watched, report)


class FaultLog:
    """Log of a plug-in's faults; each different fault is logged once.

    Args:
        sentence: beginning of each log line.
    """

    def __init__(self, sentence: str) -> None:
        self._sentence = sentence
        self._logged: set[str] = set()

    def __call__(self, fault: str) -> None:
        """Log a fault that has not been logged before."""
        if fault not in self._logged and len(self._logged) < MOST_LOGGED:
            self._logged.add(fault)
            _log.warning("%s: %s", self._sentence, fault)


def _strategy(name: str) -> StrategyFactory:
    factory: StrategyFactory = STRATEGIES.load(name)
    STRATEGIES.made(name, lambda: factory(Manner(), 0), ("choose",), "a manner and a seed")
    return factory
