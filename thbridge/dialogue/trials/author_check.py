"""Trial of an author of wordings: the author words sentences in random conversations, and its faults are collected."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

from sim.numerics import noise
from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.dialogue.games.tables import Rulebook
from thbridge.dialogue.trials.faults import TrialFault
from thbridge.dialogue.trials.strategy_check import moves_of_robots
from thbridge.dialogue.wording.authors import (
    AuthoredSentence,
    RefusalReason,
    WordingAuthor,
    ask_author,
    request_of,
)
from thbridge.dialogue.wording.language import Language
from thbridge.dialogue.wording.wording import Wording

_REMEDIES = {
    RefusalReason.AUTHOR_FAILED: "Correct the author for this sentence, or let it return None for it",
    RefusalReason.NO_TEXT: "Let it return a text, or None to keep the sentence of the files",
    RefusalReason.NOT_PRINTABLE: "Let it return one line of printable characters",
    RefusalReason.TOO_LONG: "Let it return a shorter sentence",
    RefusalReason.OTHER_VALUES: "Keep numbers, names, negations and bound words of the files' sentence, in their order",
}


@dataclass(slots=True)
class AuthorTrial:
    """Trial of an author.

    Attributes:
        sentences: number of requested sentences.
        taken: number of the author's sentences that were accepted.
        faults: faults by their problems.
    """

    sentences: int = 0
    taken: int = 0
    faults: dict[str, TrialFault] = field(default_factory=dict)

    def judge(self, ask: Callable[[], AuthoredSentence]) -> None:
        """Ask for one sentence twice, and record the faults."""
        first, again = ask(), ask()
        self.sentences += 1
        files = f"The files say: {first.request.sentence}"
        offered = f"It offered: {first.offered}"
        if first.refusal is not None:
            reason, why = first.refusal.reason, first.refusal.why
            problem = why if reason is RefusalReason.AUTHOR_FAILED else f"a sentence is refused ({reason})"
            self._note(problem, _REMEDIES[reason], (files, *(() if first.offered is None else (offered, why))))
        elif (first.offered, first.refusal) != (again.offered, again.refusal):
            remedy = "Let it depend only on its request; otherwise games cannot be replayed"
            problem = "two requests for the same sentence gave different sentences"
            self._note(problem, remedy, (files, offered, f"The second time it offered: {again.offered}"))
        else:
            self.taken += first.offered is not None

    def _note(self, problem: str, remedy: str, position: tuple[str, ...]) -> None:
        fault = self.faults.get(problem) or TrialFault(problem, remedy, position, 0)
        self.faults[problem] = replace(fault, times=fault.times + 1)


def try_author(
    author: WordingAuthor, languages: Sequence[Language], rulebook: Rulebook, conversations: int, seed: int
) -> AuthorTrial:
    """Return the trial of an author with the sentences of robots in the worked example, in all games, and in hunts.

    Args:
        author: the author.
        languages: the languages for the sentences.
        rulebook: locutions and games.
        conversations: number of conversations of each kind.
        seed: random seed.
    """
    trial = AuthorTrial()
    said = moves_of_robots(rulebook, conversations, seed)
    for language in languages:
        wording = Wording(language, 0)
        for number, move in enumerate(said):
            chance = noise.uniform(noise.key(seed, "author-check"), number, 0)
            try:
                request = request_of(wording, move, Side.ROBOT, condition=DialogueCondition.COLLABORATOR, chance=chance)
            except ValueError:
                # A lab's own locution may still lack words.
                continue
            trial.judge(partial(ask_author, author, request))
    return trial
