"""Trials of strategies and authors of wordings, for `thbridge talk check`."""

from collections.abc import Sequence

from thbridge.app.compose.installed import impatient_author, impatient_strategy
from thbridge.dialogue.games.tables import Rulebook
from thbridge.dialogue.trials.author_check import try_author
from thbridge.dialogue.trials.strategy_check import try_strategy
from thbridge.dialogue.wording.language import Language
from thbridge.files.word_files import read_language
from ui.commands.talk.check import counted
from ui.commands.talk.trial_report import LONGEST, TrialReport


def check_strategy(name: str, rulebook: Rulebook, conversations: int, seed: int) -> TrialReport:
    """Check the strategy installed under a name.

    Args:
        name: name of the strategy.
        rulebook: rulebook of the games to play.
        conversations: number of conversations of each kind.
        seed: random seed.

    Raises:
        BadFile: there is no such strategy; see `impatient_strategy`.
    """
    trial = try_strategy(impatient_strategy(name, LONGEST), rulebook, conversations, seed)
    summary = f"{name}: {trial.moves} moves in {trial.conversations} conversations"
    figures = {"conversations": trial.conversations, "moves": trial.moves}
    return TrialReport(name, summary, figures, [*trial.faults.values()])


def check_author(
    name: str, languages: Sequence[Language], rulebook: Rulebook, conversations: int, seed: int
) -> TrialReport:
    """Check the author of wordings installed under a name.

    Args:
        name: name of the author.
        languages: languages of the robots' sentences. If empty, the sentences are in English.
        rulebook: rulebook of the games.
        conversations: number of conversations of each kind.
        seed: random seed.

    Raises:
        BadFile: there is no such author; see `impatient_author`.
    """
    author = impatient_author(name, LONGEST)
    trial = try_author(author, languages or (read_language(),), rulebook, conversations, seed)
    summary = f"{name}: {counted('sentence', range(trial.sentences))}, {trial.taken} of them worded by the author"
    figures = {"sentences": trial.sentences, "taken": trial.taken}
    return TrialReport(name, summary, figures, [*trial.faults.values()])
