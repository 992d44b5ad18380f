"""Words of the pages that no file of a study holds."""

import math
from collections.abc import Mapping, Sequence

from thbridge.experiment.allocation.places import NoPlace
from thbridge.experiment.design.steps import PracticeTerm, StepKind
from thbridge.experiment.progress import Run
from thbridge.experiment.store.events import JsonValue, RunState, StepOutcome
from ui.model.kiosk import ConsentToAsk, FormToFill, GamePrepared, GameRecorded, GameToJoin, TextToRead, ToKiosk

CALL = "Please tell the researcher."

WELCOME = "Welcome"
WELCOME_PARTICIPANT = (
    "If you are the next person to take part, please begin. You will go through the study page by page; each page says "
    "what to do.\n\nEverything can be done with the mouse, and with the keyboard alone: Tab goes on, Enter presses. "
    "Ctrl and + make the text larger, Ctrl and - smaller."
)
WELCOME_RESEARCHER = "Please wait. The researcher begins the study for you."

NO_PLACES = {
    NoPlace.FULL: (
        "The study is complete",
        f"As many people as are needed have taken part, so nobody else is asked. Thank you for coming. {CALL}",
    ),
    NoPlace.TAKEN: (
        "There is no place just now",
        f"All places of the study are taken by others who are still under way. One may become free later. {CALL}",
    ),
}
"""Headings and texts for whoever comes when there is no place."""

LAGS = "This computer is too slow: the game is {} s behind real time. Close other programs."
"""Sentence for the researcher; takes whole seconds."""

NAMES_OTHER = "Do not name {} in the reason: it stays when they withdraw. A note may name them."

RESTARTED = "The study goes on where you were"
RESTARTED_TEXT = (
    "The program had to be started again. Your answers up to here are kept, and you need not give them again.\n\n"
    "If you are not the person who was taking part just now, please do not go on, and tell the researcher."
)

STOPPED = "The study pauses here"
STOPPED_TEXT = (
    "The researcher has stopped the program. All that you have done and answered is kept, and you go on where you are "
    "when it is started again. Please stay here and ask the researcher."
)
FAILED = "The study pauses here"
FAILED_TEXT = (
    "The program cannot go on just now. That is not your fault, and all that you have answered is kept. "
    "Please stay here and tell the researcher, who starts it again; you then go on where you are."
)

RECRUITING = "Before you begin"
CODE_NOT_KEPT = (
    "If you had written your code already, please write it once more: the program stopped before it was kept."
)

BACK = "Back"

BEFORE_YOU_GO = "Before you go: what this study was about"

ONCE_MORE = "Once more, please"

PAUSE = "A pause"
PAUSE_TEXT = "Take a rest if you like. Go on when you are ready."

HEADINGS = {StepKind.INSTRUCTIONS: "Please read", StepKind.DEBRIEF: "What this study was about", StepKind.PAUSE: PAUSE}

PRACTICE_COMES = "The practice game is being made ready. It does not count."
GAME_COMES = "The game is being made ready. It begins in a moment."
GAME_COMES_BACK = "The game is being brought back to where it was. It goes on in a moment."
TIME_IS_UP = "The time of this game is over. One moment, please."
PRACTICE_ENDED = "The practice game has ended"
GAME_ENDED = "The game has ended"


_SPOKEN = {
    StepKind.INSTRUCTIONS: "the text that explains it",
    StepKind.PRACTICE: "the practice game",
}


def spoken(kind: StepKind) -> str:
    """Return what people call a step."""
    return _SPOKEN.get(kind, "what was before them")


def repetition(from_step: str, attempts_left: int) -> str:
    """Return what somebody is told who failed a check that is tried again; `from_step` what comes before it."""
    last = " This is the last try." if attempts_left == 1 else ""
    again = f"First comes {from_step} once more; then you answer again." if from_step else "Please answer them again."
    return (
        f"Not all of your answers were right. That happens, and nothing is lost: the questions only make sure that the "
        f"study was explained well enough. {again}{last}"
    )


_ONE: Mapping[PracticeTerm, tuple[str, str]] = {
    PracticeTerm.SECONDS: ("play for another second", "play for another {} seconds"),
    PracticeTerm.MOVES: ("send a robot to a room", "send robots to {} more rooms"),
    PracticeTerm.PICTURES: ("take a picture of a treasure", "take pictures of {} more treasures"),
    PracticeTerm.IDENTIFIED: ("name a treasure", "name {} more treasures"),
    PracticeTerm.DIALOGUES: ("answer a robot", "answer robots in {} more dialogues"),
}


def to_do(missing: Mapping[PracticeTerm, float]) -> tuple[str, ...]:
    """Return what must still be done in a practice game, each in words; `missing` is how much."""
    return tuple(_ONE[term][number > 1.0].format(math.ceil(number)) for term, number in missing.items())


def practice_again(still: Sequence[str]) -> str:
    """Return what somebody reads whose practice game ended before all was done."""
    return (
        f"Before you go on, please try out all parts of the game. Still to do: {', '.join(still)}.\n\n"
        "The practice game starts again. It does not count, so you can try things out."
    )


def result(game: Mapping[str, JsonValue] | None) -> str:
    """Return what somebody is told after a game whose end they do not see any more."""
    if game is None:
        return "Go on when you are ready."
    why = "" if game.get("over") else "The time for this game was over. "
    return f"{why}Your score: {game['score']}.\n\nGo on when you are ready."


def results(games: Sequence[tuple[int, int | None]]) -> str:
    """Return what a debriefing says of each game: its score, and the best possible one where it is known."""
    return "\n\n".join(
        f"Your score in game {number}: {score}."
        + ("" if best is None else f" With the same energy and enough time, {best} points were possible.")
        for number, (score, best) in enumerate(games, 1)
    )


def page(shown: ToKiosk) -> str:
    """Return what a researcher is told of a page."""
    match shown:
        case TextToRead(heading=heading) | GameRecorded(heading=heading):
            return heading or "a text"
        case ConsentToAsk():
            return "consent"
        case FormToFill(title=title, part=part, parts=parts):
            return f"{title}, page {part} of {parts}" if parts > 1 else title
        case GamePrepared(sentence=sentence):
            return sentence
        case GameToJoin(practice=practice):
            return "practice game" if practice else "game"
        case _:
            return ""


def before_debriefing(run: Run) -> tuple[str, str]:
    """Return heading and text of the page for a person whose run ended early, before they read the debriefing."""
    heading = "Thank you" if run.state is RunState.LEFT else "The study ends here"
    return heading, f"{_ended_early(run)} On the next page you read what the study was about."


def _ended_early(run: Run) -> str:
    if run.state is RunState.LEFT:
        return "You do not go on with the study."
    if run.last_outcome is StepOutcome.FAILED:
        told = "Your answers to the questions were not those that the study needs to go on."
        return f"{told} You have done nothing wrong. Thank you for your time."
    return "It cannot go on. That is not your fault. Thank you for your time."


def farewell(run: Run) -> tuple[str, str]:
    """Return heading and text of the last page."""
    kept = (
        f"What you did is kept under the code {run.participant}. Please write it down: if you want it deleted "
        "later, tell us this code."
    )
    match run.state:
        # A code means that they came to the end, also where their run does not count.
        case _ if run.code:
            told = (
                "You have completed the study. Everything is kept. If you want it deleted later, tell us the code below"
            )
            return "Thank you", f"{told}. You may go now."
        case RunState.DECLINED:
            return "Thank you", f"You do not take part, and nothing more is recorded. {CALL}\n\n{kept}"
        case RunState.LEFT:
            return "Thank you", f"{_ended_early(run)} Nothing more is recorded. {CALL}\n\n{kept}"
        case _:
            return "The study ends here", f"{_ended_early(run)} {CALL}\n\n{kept}"
