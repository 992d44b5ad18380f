"""Pages of the browser, in the states of the windows' pictures."""

from collections.abc import Callable, Mapping
from dataclasses import replace

from pictured import language
from pictured.kiosk import STEPS, PicturedKiosk
from pictured.participant import PicturedWindow
from pictured.shot import Shot
from tests.support.programs.shown_pages import NO_SOCKET, PageState, ShownGame, shown_game
from ui.model.kiosk import GamePrepared, GameToJoin, StudyProgress, TurnToAwait
from ui.model.playing.participant import Participant
from ui.model.playing.practice import advice


def state_of(shot: Shot) -> PageState | None:
    """Return the state of the page that shows the same as a window; None for a window without a page."""
    match shot.window:
        case PicturedWindow() as window:
            return PageState(shot.name, (GameToJoin(1, "", 0, "", False),), _game(window.model, window.now()))
        case PicturedKiosk(kept=kept, hunt=hunt):
            games = [message for message in kept if isinstance(message, GameToJoin)]
            if not games or hunt is None:
                return PageState(shot.name, tuple(kept))
            return PageState(shot.name, tuple(kept), _game(hunt.model, hunt.now, practice=games[-1].practice))
        case _:
            return None


def _game(model: Participant, now: float, *, practice: bool = False) -> ShownGame:
    screen = model.screen(now)
    advise = advice(model.texts, screen) if practice else ""
    return shown_game(model.texts, screen, model.robots(now), model.floor_plan, model.followed, advise)


def _preparing(state: PageState) -> PageState:
    sentence = language.texts().text("pages.preparing", count=3)
    return replace(state, messages=(GamePrepared(3, sentence, StudyProgress(5, STEPS)),))


def _waiting(key: str, before: int = 0) -> Callable[[PageState], PageState]:
    """Return the change to a page on which a person waits; `key` is that of its texts."""

    def change(state: PageState) -> PageState:
        texts = language.texts()
        heading, text = texts.text(f"web.{key}"), texts.text(f"web.{key}_text")
        progress = StudyProgress(5, STEPS)
        return replace(state, messages=(TurnToAwait(3, heading, text, 95, before=before, progress=progress),))

    return change


def _doing(deed: str) -> Callable[[PageState], PageState]:
    return lambda state: replace(state, deed=deed)


BROWSER_ONLY: Mapping[str, tuple[str, Callable[[PageState], PageState]]] = {
    "map": ("playing", _doing("document.querySelector('.map-switch').click()")),
    "settings": ("kiosk-text", _doing("document.querySelector('#strip .acts button').click()")),
    "stop": ("kiosk-text", _doing("[...document.querySelectorAll('#strip .acts button')].at(-1).click()")),
    "missing": ("kiosk-form", _doing("document.querySelector('footer .main').click()")),
    "instructions": ("kiosk-form", _doing("document.querySelector('#strip .acts button').click()")),
    "form-end": ("kiosk-form", _doing("document.querySelector('footer .main').scrollIntoView()")),
    "prepared": ("kiosk-text", _preparing),
    "turn": ("kiosk-text", _waiting("waiting_for_game", before=2)),
    "others": ("kiosk-text", _waiting("waiting_for_others")),
    "place": ("kiosk-text", _waiting("waiting_for_place")),
    "taken": ("kiosk-text", _waiting("game_taken")),
    "taken-over": ("kiosk-text", _doing("new WebSocket(`ws://${location.host}/socket`)")),
    "lost": ("kiosk-text", lambda state: replace(state, before=NO_SOCKET)),
    "too-old": ("kiosk-text", lambda state: replace(state, before="delete window.HTMLDialogElement;")),
    "failed": ("kiosk-form", _doing("setTimeout(() => { throw new Error('for the picture'); })")),
    "not-loaded": ("kiosk-text", lambda state: replace(state, blocked=("*study.js",))),
}
"""States that only a browser has: name to the state of a window before, and the change of this state."""

GROUPS: Mapping[str, tuple[str, Mapping[str, str]]] = {
    "study": (
        "A study: texts and consent",
        {
            "kiosk-welcome": "welcome",
            "kiosk-text": "a text to read",
            "kiosk-consent": "consent",
            "prepared": "a game is being prepared",
            "kiosk-once-more": "a comprehension check is repeated",
            "settings": "settings",
            "stop": "the question before a person stops",
        },
    ),
    "waiting": (
        "Waiting",
        {
            "turn": "for a game",
            "others": "for the other people of a game",
            "place": "for a place in a study",
            "taken": "for a game that another person plays",
        },
    ),
    "forms": (
        "Forms",
        {
            "kiosk-code": "the code of a recruiting service",
            "kiosk-workload": "lines that are not marked yet",
            "kiosk-form": "all kinds of scales, partly filled in",
            "form-end": "the end of this form",
            "missing": "a missing answer is marked",
            "instructions": "the instructions again",
            "kiosk-time-limit": "an item with a time limit",
        },
    ),
    "game": (
        "A hunt",
        {
            "connecting": "connecting",
            "consent": "consent of a study file",
            "kiosk-practice": "practice, with the remaining tasks",
            "begin": "the game begins; the pointer is on room 6",
            "thinking": "the robot thinks",
            "talk": "the robot asks",
            "playing": "robots are moving",
            "map": "the map is open",
            "kiosk-game": "a game in a study, with the time left",
            "queue": "two robots wait while the third robot asks a question",
            "six-robots": "six robots and twelve rooms",
            "uncertainty": "believed and true poses",
        },
    ),
    "treasures": (
        "Treasures",
        {
            "treasure": "a treasure is sensed",
            "picture": "a picture was taken, and a name is chosen",
            "verdict": "a right name",
            "verdict-wrong": "a wrong name",
            "properties": "sensing another property",
            "properties-picture": "reporting a property",
        },
    ),
    "arguments": (
        "Robots that argue",
        {
            "argue": "the robot does not agree",
            "argue-reasons": "the robot gives its reasons",
            "argue-questions": "questions to the robot",
            "argue-two": "two robots ask at once",
            "argue-left": "an end without an agreement",
            "argue-agreed": "the robot does as agreed",
            "argue-found": "the button to ask the robot about a treasure",
            "argue-name": "a name that does not match the treasure",
        },
    ),
    "questions": (
        "Refusals, problems and questions",
        {
            "refused": "a request is refused with a reason",
            "trouble": "robots that are lost, have no energy, and do not answer",
            "lost-connection": "the connection to the game is lost",
            "commanded-asked": "a robot under another commander",
            "question-change": "a driving robot gets another goal",
            "question-end": "the question before a game is ended",
            "help": "rules and keys",
            "over": "the game is over",
        },
    ),
    "ends": (
        "Ends",
        {
            "kiosk-game-ended": "the time of a game is over",
            "kiosk-thanks": "the end, with the completion code",
            "kiosk-before-debriefing": "a person has stopped",
            "kiosk-debriefing": "the debriefing",
            "kiosk-left": "the end for a person who stopped",
        },
    ),
    "errors": (
        "Errors of the page",
        {
            "lost": "the connection is lost",
            "taken-over": "the study was opened in another tab",
            "failed": "a script has failed",
            "not-loaded": "a script did not load",
            "too-old": "the browser is too old",
        },
    ),
}
"""Groups of states that one picture shows: part of the file's name to the title, and the states with their captions."""
