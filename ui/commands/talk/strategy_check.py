"""Words of `thbridge talk check --strategy`."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from thbridge.app.compose.installed import impatient_strategy
from thbridge.dialogue.games.tables import Rulebook
from thbridge.dialogue.trials.strategy_check import StrategyTrial, try_strategy
from ui.commands.talk.check import counted
from ui.commands.talk.trial_faults import fault_as_json, fault_lines

LONGEST = 5.0
"""Seconds of wall time after which a strategy counts as one that never chooses."""


@dataclass(frozen=True, slots=True)
class StrategyCheck:
    """Result of the check of a strategy.

    Attributes:
        name: of the strategy.
        trial: what was found.
    """

    name: str
    trial: StrategyTrial

    @property
    def ok(self) -> bool:
        """True when nothing is wrong."""
        return not self.trial.faults

    def lines(self) -> Iterator[str]:
        """Yield what people are told."""
        faults = [*self.trial.faults.values()]
        yield from fault_lines(self.name, faults)
        yield (
            f"{self.name}: {self.trial.moves} moves in {self.trial.conversations} conversations, "
            f"{counted('fault', faults)}"
        )

    def as_json(self) -> Mapping[str, object]:
        """Return what programs are told."""
        return {
            "name": self.name,
            "conversations": self.trial.conversations,
            "moves": self.trial.moves,
            "faults": [*map(fault_as_json, self.trial.faults.values())],
        }


def check_strategy(name: str, rulebook: Rulebook, conversations: int, seed: int) -> StrategyCheck:
    """Check the strategy that is installed under a name.

    Args:
        name: of the strategy.
        rulebook: of the games that it is to play.
        conversations: number of those of each kind.
        seed: of all chance.

    Raises:
        BadFile: there is no such strategy; see `impatient_strategy`.
    """
    return StrategyCheck(name, try_strategy(impatient_strategy(name, LONGEST), rulebook, conversations, seed))
