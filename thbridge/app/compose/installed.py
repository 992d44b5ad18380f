"""Plug-ins that a study names, loaded, checked and watched; see `thbridge.files.plugins`."""

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
"""Different faults of a plug-in that are logged."""
_NO_TREASURES = TreasureKnowledge((), {})
PATIENCE = 2.0
"""Seconds of wall time after which people are told that a game waits for a strategy."""


@dataclass(frozen=True, slots=True)
class WatchedStrategy:
    """Strategy of a lab; people are told while a game waits for it, and its moves do not depend on how long it takes.

    Attributes:
        name: of the strategy.
        factory: makes it.
        manner: as for `StrategyFactory`.
        seed: likewise.
    """

    name: str
    factory: StrategyFactory
    manner: Manner
    seed: int

    def choose(self, conversation: Conversation, number: int) -> DialogueMove:
        """Return the strategy's move; see `GameStrategy`."""
        told = f"the strategy {self.name} has not chosen a move for {PATIENCE:g} s; the game waits for it"
        with told_if_slow(PATIENCE, lambda: _log.warning(told)), printing_aside():
            return self.factory(self.manner, self.seed).choose(conversation, number)


@dataclass(frozen=True, slots=True)
class ImpatientStrategy:
    """Strategy of a lab that is not waited for, once it has taken too long.

    Attributes:
        factory: makes it.
        caller: waits for it.
        manner: as for `StrategyFactory`.
        seed: likewise.
    """

    factory: StrategyFactory
    caller: ImpatientCaller[DialogueMove]
    manner: Manner
    seed: int

    def choose(self, conversation: Conversation, number: int) -> DialogueMove:
        """Return the strategy's move; see `GameStrategy`. Raises TimeoutError when there is none in time."""
        with printing_aside():
            return self.caller.call(lambda: self.factory(self.manner, self.seed).choose(conversation, number))


def installed_author(name: str) -> "WordingAuthor":
    """Return the author of wordings of a name.

    Raises:
        BadFile: none of this name is installed, or it cannot be imported, or called.
    """
    author: WordingAuthor = WORDINGS.load(name)
    told = f"the author {name} has not worded a sentence for {PATIENCE:g} s; the game waits for it"

    def watched(request: "WordingRequest", /) -> str | None:
        with told_if_slow(PATIENCE, lambda: _log.warning(told)), printing_aside():
            return author(request)

    return watched


def impatient_author(name: str, seconds: float) -> "WordingAuthor":
    """Return the author of wordings of a name, for trials; it raises TimeoutError after these seconds of wall time.

    Raises:
        BadFile: as for `installed_author`.
    """
    author: WordingAuthor = WORDINGS.load(name)
    caller = ImpatientCaller[str | None](seconds)

    def impatient(request: "WordingRequest", /) -> str | None:
        with printing_aside():
            return caller.call(lambda: author(request))

    return impatient


def installed_strategy(name: str) -> StrategyFactory:
    """Return the factory of the strategy of a name, for games.

    Raises:
        BadFile: as for `installed_author`; or it does not take a manner and a seed, or makes no strategy of them.
    """
    return partial(WatchedStrategy, name, _strategy(name))


def impatient_strategy(name: str, seconds: float) -> StrategyFactory:
    """Return the factory of the strategy of a name, for trials.

    Args:
        name: of the strategy.
        seconds: of wall time that it may take for a move.

    Raises:
        BadFile: as for `installed_strategy`.
    """
    return partial(ImpatientStrategy, _strategy(name), ImpatientCaller(seconds))


def participant_factory(name: str) -> ParticipantFactory:
    """Return the factory of the simulated participant of a name.

    Raises:
        BadFile: as for `installed_author`; or it takes other arguments, or makes no participant of them.
    """
    factory: ParticipantFactory = PARTICIPANTS.load(name)
    takes = "a TreasureKnowledge, an attitude and a seed"
    PARTICIPANTS.made(name, lambda: factory(_NO_TREASURES, Attitude.CREDULOUS, 0), ("requests",), takes)
    return factory


def installed_participant(
    name: str, knowledge: TreasureKnowledge, seed: int, attitude: Attitude, call: ParticipantCaller | None = None
) -> InstalledParticipant:
    """Return the simulated participant of a name.

    Args:
        name: of the participant.
        knowledge: of treasures.
        seed: random seed.
        attitude: toward what robots say.
        call: calls it in a trial, in which no fault is logged; None: the game waits for it.

    Raises:
        BadFile: as for `participant_factory`.
    """
    factory = participant_factory(name)
    told = f"the participant {name} has not decided for {PATIENCE:g} s; the game waits for it"

    def watched(asked: Callable[[], Sequence[ParticipantRequest]]) -> Sequence[ParticipantRequest]:
        with told_if_slow(PATIENCE, lambda: _log.warning(told)), printing_aside():
            return asked()

    def ignored(_fault: str) -> None:
        pass

    report = ignored if call else FaultLog(f"a built-in participant decided, because {name} failed")
    with printing_aside():
        player = factory(replace(knowledge, shown_by=dict(knowledge.shown_by)), attitude, seed)
    stand_in = Bot(BotStrategy.SUGGESTION, knowledge, seed, attitude)
    return InstalledParticipant(player, stand_in, call or watched, report)


class FaultLog:
    """Logs each fault of a plug-in once.

    Args:
        sentence: beginning of what is logged.
    """

    def __init__(self, sentence: str) -> None:
        self._sentence = sentence
        self._logged: set[str] = set()

    def __call__(self, fault: str) -> None:
        """Log a fault, unless it has been logged."""
        if fault not in self._logged and len(self._logged) < MOST_LOGGED:
            self._logged.add(fault)
            _log.warning("%s: %s", self._sentence, fault)


def _strategy(name: str) -> StrategyFactory:
    factory: StrategyFactory = STRATEGIES.load(name)
    STRATEGIES.made(name, lambda: factory(Manner(), 0), ("choose",), "a manner and a seed")
    return factory
