"""Words of `thbridge talk check --author`."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from thbridge.app.compose.installed import impatient_author
from thbridge.dialogue.games.tables import Rulebook
from thbridge.dialogue.trials.author_check import AuthorTrial, try_author
from thbridge.dialogue.wording.language import Language
from thbridge.files.word_files import read_language
from ui.commands.talk.check import counted
from ui.commands.talk.strategy_check import LONGEST
from ui.commands.talk.trial_faults import fault_as_json, fault_lines


@dataclass(frozen=True, slots=True)
class AuthorCheck:
    """Result of the check of an author.

    Attributes:
        name: of the author.
        trial: what was found.
    """

    name: str
    trial: AuthorTrial

    @property
    def ok(self) -> bool:
        """True when nothing is wrong."""
        return not self.trial.faults

    def lines(self) -> Iterator[str]:
        """Yield what people are told."""
        faults = [*self.trial.faults.values()]
        yield from fault_lines(self.name, faults)
        yield (
            f"{self.name}: {counted('sentence', range(self.trial.sentences))}, {self.trial.taken} worded by it, "
            f"{counted('fault', faults)}"
        )

    def as_json(self) -> Mapping[str, object]:
        """Return what programs are told."""
        return {
            "name": self.name,
            "sentences": self.trial.sentences,
            "taken": self.trial.taken,
            "faults": [*map(fault_as_json, self.trial.faults.values())],
        }


def check_author(
    name: str, languages: Sequence[Language], rulebook: Rulebook, conversations: int, seed: int
) -> AuthorCheck:
    """Check the author that is installed under a name.

    Args:
        name: of the author.
        languages: in which it is to word what robots say; without any, English.
        rulebook: of the games.
        conversations: number of those of each kind.
        seed: of all chance.

    Raises:
        BadFile: there is no such author; see `impatient_author`.
    """
    author = impatient_author(name, LONGEST)
    spoken = languages or (read_language(),)
    return AuthorCheck(name, try_author(author, spoken, rulebook, conversations, seed))
