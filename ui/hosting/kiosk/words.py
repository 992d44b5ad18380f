"""Texts of the kiosk: for participants in the study's language, for researchers in English."""

import math
from collections.abc import Iterable, Mapping, Sequence

from thbridge.dialogue.wording.texts import Texts
from thbridge.experiment.allocation.places import NoPlace
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.lobby import LeavingRule
from thbridge.experiment.design.plan import PlannedStep, study_of_game
from thbridge.experiment.design.steps import PracticeTerm, StepKind
from thbridge.experiment.progress import Progress, Run
from thbridge.experiment.store.events import JsonValue, RunState, StepOutcome
from thbridge.hunt.seats import label_of
from thbridge.study.seats import seats_of
from ui.model.kiosk import (
    ConsentToAsk,
    FormToFill,
    GamePrepared,
    GameRecorded,
    GameToJoin,
    TextToRead,
    ToKiosk,
    TurnToAwait,
)

NO_PLACES = {NoPlace.FULL: "full", NoPlace.TAKEN: "taken", NoPlace.CLOSED: "closed"}
"""Names of the texts for people who arrive when no place in the study is free."""

# For the researcher

NO_PLACE_TOLD = {
    NoPlace.FULL: "The study is complete.",
    NoPlace.TAKEN: "All places of the study are taken by people who are still in the study.",
    NoPlace.CLOSED: "Admission is closed.",
}
"""Reasons why the next person cannot begin."""

LAGS = "This computer is too slow: the game is {} s behind real time. Close other programs."
"""Sentence about the lag of a game, in whole seconds."""


def page(shown: ToKiosk) -> str:
    """Return a description of a page for the researcher; headings are in the participant's language."""
    match shown:
        case TextToRead(heading=heading) | GameRecorded(heading=heading):
            return heading or "text"
        case ConsentToAsk():
            return "consent"
        case FormToFill(title=title, part=part, parts=parts):
            return f"{title}, page {part} of {parts}" if parts > 1 else title
        case GamePrepared():
            return "game starts or ends"
        case TurnToAwait():
            return "waiting"
        case GameToJoin(practice=practice):
            return "practice game" if practice else "game"
        case _:
            return ""


# For participants


def headed(texts: Texts, name: str, part: str = "kiosk") -> tuple[str, str]:
    """Return the heading and text of a page; `part` is the part of the texts that has them."""
    return texts.text(f"{part}.{name}"), texts.text(f"{part}.{name}_text")


def no_place(texts: Texts, why: NoPlace) -> tuple[str, str]:
    """Return the heading and text for people who arrive when no place in the study is free."""
    heading, text = headed(texts, NO_PLACES[why])
    return heading, f"{text} {texts.text('kiosk.tell_researcher')}"


def step_heading(texts: Texts, kind: StepKind) -> str:
    """Return the heading of a step's text."""
    return texts.text(f"kiosk.{kind}")


_AGAIN = {
    None: "kiosk.answers_again",
    StepKind.INSTRUCTIONS: "kiosk.instructions_again",
    StepKind.PRACTICE: "kiosk.practice_again",
}


def repetition(texts: Texts, first: StepKind | None, attempts_left: int) -> str:
    """Return the text for a person who failed a check that is repeated.

    Args:
        texts: texts of the study.
        first: kind of the step that is repeated before the check. If None, only the check is repeated.
        attempts_left: number of attempts left.
    """
    said = [texts.text("kiosk.check_failed"), texts.text(_AGAIN.get(first, "kiosk.steps_again"))]
    return " ".join([*said, texts.text("kiosk.last_try")] if attempts_left == 1 else said)


def to_do(texts: Texts, missing: Mapping[PracticeTerm, float]) -> tuple[str, ...]:
    """Return sentences about the remaining tasks of a practice game; `missing` has the number for each task."""
    return tuple(texts.text(f"kiosk.to_do_{term}", count=math.ceil(number)) for term, number in missing.items())


def practice_again(texts: Texts, still: Iterable[str]) -> str:
    """Return the text for a person whose practice game ended before all tasks were done."""
    return texts.text("kiosk.still_to_do", tasks=texts.listed(still))


def result(texts: Texts, game: Mapping[str, JsonValue] | None) -> str:
    """Return the text about a game's result, for a person whose window no longer shows the end of the game."""
    ready = texts.text("kiosk.go_on_when_ready")
    if game is None:
        return ready
    why = "" if game.get("over") else f"{texts.text('kiosk.time_was_over')} "
    return f"{why}{texts.text('kiosk.your_score', score=str(game['score']))}\n\n{ready}"


def result_of_group(texts: Texts, progress: Progress, participant: str, step: PlannedStep) -> str:
    """Return the text about the result of a person's game, which is the game of a group if the person has a seat."""
    run, group = progress.runs[participant], progress.group_game(participant, step)
    ends = progress.design.file.lobby.leaving is LeavingRule.END
    if group is None or not (ends and group.has_absent) or (run.game or {}).get("over"):
        return result(texts, run.game)
    score = "" if run.game is None else f" {texts.text('kiosk.your_score', score=str(run.game['score']))}"
    return f"{texts.text('kiosk.person_left')}{score}\n\n{texts.text('kiosk.go_on_when_ready')}"


def seat_label(design: ExperimentDesign, run: Run, step: PlannedStep) -> str:
    """Return the words for the seat of a person in the game of a step."""
    study = study_of_game(design, run.place, step)
    return label_of(() if study is None else seats_of(study.seats), run.seats[step.number].seat)


def results(texts: Texts, games: Sequence[tuple[int, int | None]]) -> str:
    """Return sentences of a debriefing about each game: its score, and the best possible score if it is known."""
    paragraphs = []
    for number, (score, best) in enumerate(games, 1):
        only = len(games) == 1
        said = texts.text("kiosk.your_score" if only else "kiosk.score_of_game", game=number, score=score)
        paragraphs.append(said if best is None else f"{said} {texts.text('kiosk.best_possible', count=best)}")
    return "\n\n".join(paragraphs)


def before_debriefing(texts: Texts, run: Run) -> tuple[str, str]:
    """Return the heading and text of the page before the debriefing, for a person whose run ended early."""
    heading = texts.text("kiosk.thank_you" if run.state is RunState.LEFT and not run.absent else "kiosk.ends_here")
    return heading, f"{_ended_early(texts, run)} {texts.text('kiosk.debrief_comes')}"


def _ended_early(texts: Texts, run: Run) -> str:
    if run.absent:
        return texts.text("kiosk.was_absent")
    if run.state is RunState.LEFT:
        return texts.text("kiosk.you_stopped")
    failed = run.last_outcome is StepOutcome.FAILED
    return texts.text("kiosk.check_failed_for_good" if failed else "kiosk.cannot_go_on")


def farewell(texts: Texts, run: Run) -> tuple[str, str]:
    """Return the heading and text of the last page."""
    thanks, call = texts.text("kiosk.thank_you"), texts.text("kiosk.tell_researcher")
    kept = texts.text("kiosk.kept_under_code", code=run.participant)
    match run.state:
        # A code proves that the person reached the end, even if the run does not count.
        case _ if run.unmatched:
            return texts.text("kiosk.no_group"), texts.text("kiosk.no_group_text")
        case _ if run.code:
            return thanks, texts.text("kiosk.completed")
        case RunState.DECLINED:
            return thanks, f"{texts.text('kiosk.declined')} {call}\n\n{kept}"
        case RunState.LEFT if not run.absent:
            return thanks, f"{_ended_early(texts, run)} {texts.text('kiosk.nothing_more')} {call}\n\n{kept}"
        case _:
            return texts.text("kiosk.ends_here"), f"{_ended_early(texts, run)} {call}\n\n{kept}"
