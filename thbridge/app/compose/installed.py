"""Programs of labs that a study names, found by their entry points: authors of wordings, and strategies of robots."""

import difflib
import logging
import sys
from collections.abc import Callable
from contextlib import AbstractContextManager, redirect_stdout
from dataclasses import dataclass
from functools import partial
from importlib.metadata import entry_points
from pathlib import Path
from typing import TYPE_CHECKING, Any

from thbridge.dialogue.conditions import Manner
from thbridge.dialogue.games.contents import DialogueMove
from thbridge.dialogue.games.control import Conversation
from thbridge.dialogue.other_programs import RAISED, told_error
from thbridge.dialogue.robot_strategies import StrategyFactory
from thbridge.files.errors import BadFile
from thbridge.timing.slow_calls import ImpatientCaller, told_if_slow

if TYPE_CHECKING:
    from thbridge.dialogue.wording.authors import WordingAuthor, WordingRequest

_log = logging.getLogger(__name__)

WORDINGS, STRATEGIES = "thbridge.wordings", "thbridge.strategies"
"""Groups of entry points."""

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
        with told_if_slow(PATIENCE, lambda: _log.warning(told)), _printing_aside():
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
        with _printing_aside():
            return self.caller.call(lambda: self.factory(self.manner, self.seed).choose(conversation, number))


def installed_author(name: str) -> "WordingAuthor":
    """Return the author of wordings of a name.

    Raises:
        BadFile: none of this name is installed, or it cannot be imported, or called.
    """
    author: WordingAuthor = _installed(WORDINGS, name, "author of wordings")
    told = f"the author {name} has not worded a sentence for {PATIENCE:g} s; the game waits for it"

    def watched(request: "WordingRequest", /) -> str | None:
        with told_if_slow(PATIENCE, lambda: _log.warning(told)), _printing_aside():
            return author(request)

    return watched


def impatient_author(name: str, seconds: float) -> "WordingAuthor":
    """Return the author of wordings of a name, for trials; it raises TimeoutError after these seconds of wall time.

    Raises:
        BadFile: as for `installed_author`.
    """
    author: WordingAuthor = _installed(WORDINGS, name, "author of wordings")
    caller = ImpatientCaller[str | None](seconds)

    def impatient(request: "WordingRequest", /) -> str | None:
        with _printing_aside():
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


def _strategy(name: str) -> StrategyFactory:
    factory: StrategyFactory = _installed(STRATEGIES, name, "strategy")
    remedy = "Name a class, or function, that takes a manner and a seed and returns what has a method `choose`"
    try:
        with _printing_aside():
            made: object = factory(Manner(), 0)
    except RAISED as error:
        raise BadFile(Path(STRATEGIES), f"it cannot be made: {told_error(error)}", remedy, key=name) from error
    if not callable(getattr(made, "choose", None)):
        problem = f"it makes a {type(made).__name__}, which has no method choose"
        raise BadFile(Path(STRATEGIES), problem, remedy, key=name)
    return factory


def _installed(group: str, name: str, what: str) -> Callable[..., Any]:  # type: ignore[explicit-any]  # of others
    """Return what the entry point of a name in a group names. Raises BadFile, in which `what` is the kind of thing."""
    found = {each.name: each for each in entry_points(group=group)}
    if name not in found:
        near = difflib.get_close_matches(name, found, n=1)
        installed = f"Installed are: {', '.join(sorted(found))}" if found else "None is installed"
        remedy = f"The nearest is {near[0]}" if near else installed
        raise BadFile(Path(group), f"no {what} {name} is installed", remedy, key=name)
    entry = found[name]
    try:
        with _printing_aside():
            program: object = entry.load()
    except RAISED as error:
        problem = f"{entry.value} cannot be imported: {type(error).__name__}: {error}"
        raise BadFile(Path(group), problem, "Mend it, or install it anew", key=name) from error
    if not callable(program):
        raise BadFile(Path(group), f"{entry.value} is no function", "Name a function, or a class", key=name)
    return program


def _printing_aside() -> AbstractContextManager[object]:
    """Context in which what a program of others prints goes to standard error: standard output is for results."""
    return redirect_stdout(sys.stderr)
