"""Pages of a study with people at the kiosk."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from pictured import language
from pictured.hunt import PicturedHunt
from pictured.participant import CONSENT, RecordedLink
from pictured.shot import Shot, Story, unkept_preferences
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.experiment.allocation.places import Place
from thbridge.experiment.design.steps import PracticeTerm, StepKind
from thbridge.experiment.folder import EXAMPLE
from thbridge.experiment.progress import Run
from thbridge.experiment.questionnaires.form import SHIPPED, read_form
from thbridge.experiment.store.events import RunState
from thbridge.study.built_in import STANDARD
from thbridge.study.study_file import DialogueSection
from ui.hosting.kiosk import words
from ui.hosting.kiosk.answer_conversion import form_item
from ui.model.kiosk import (
    KIOSK,
    Answer,
    ConsentToAsk,
    FormItem,
    FormToFill,
    GameNews,
    GameRecorded,
    GameToJoin,
    HostStops,
    InstructionsSoFar,
    InstructionText,
    StudyProgress,
    TextToRead,
    ToKiosk,
)
from ui.model.playing.screen import SelectRoomAct, ShowHelp
from ui.model.shared.theme import Palette
from ui.windows.kiosk.pages.form import FormPage
from ui.windows.kiosk.window import KioskWindow

SIZE = (1200, 800)
STEPS = 12
ALL_KINDS = (
    FormItem("agree", "I trusted what the robots said.", "likert", ("never", "seldom", "sometimes", "often", "always")),
    FormItem("hard", "How hard was it?", "analogue", low="easy", high="hard", step=5.0),
    FormItem("warm", "", "differential", ("cold", "", "", "", "", "", "warm"), "cold", "warm", not_applicable=True),
    FormItem("used", "What have you used?", "choice", options=("a vacuum robot", "a drone", "an arm"), several=True),
    FormItem("why", "What would you change?", "text", required=False),
)


class PicturedKiosk(KioskWindow):
    """Kiosk whose pages can also be shown by a browser.

    Attributes:
        kept: messages that a window needs which opens now.
        hunt: the game that it shows; None outside of games.
    """

    kept: Sequence[ToKiosk] = ()
    hunt: PicturedHunt | None = None

    def receive(self, message: ToKiosk) -> None:
        """See `KioskWindow`."""
        self.kept = KIOSK.kept(self.kept, message)
        super().receive(message)

    def play(self, game: GameToJoin, hunt: PicturedHunt) -> None:
        """Show a game."""
        self.kept = KIOSK.kept(self.kept, game)
        self.hunt = hunt
        self.show_game(game, RecordedLink(hunt))


def at_the_kiosk() -> Iterator[Shot]:
    """Yield the pages, in the order of a study."""
    seconds = 0.0
    texts = language.texts()
    window = PicturedKiosk(texts, unkept_preferences(), lambda _: None, lambda: seconds)
    window.resize(*SIZE)
    window.show()
    window.receive(TextToRead(1, *words.headed(texts, "welcome"), texts.text("kiosk.begin")))
    yield Shot("kiosk-welcome", window)
    ask = FormItem("code", "Which code did the recruiting service give you?", "text", one_line=True)
    window.receive(FormToFill(2, texts.text("kiosk.recruiting"), "", (ask,), progress=StudyProgress(1, STEPS)))
    yield Shot("kiosk-code", window)
    text = (EXAMPLE / "texts" / "welcome.txt").read_text(encoding="utf-8")
    heading = words.step_heading(texts, StepKind.INSTRUCTIONS)
    window.receive(TextToRead(3, heading, text, progress=StudyProgress(1, STEPS)))
    yield Shot("kiosk-text", window)
    window.receive(ConsentToAsk(4, CONSENT, progress=StudyProgress(2, STEPS)))
    yield Shot("kiosk-consent", window)
    once_more = words.repetition(texts, StepKind.PRACTICE, 1)
    window.receive(TextToRead(5, texts.text("kiosk.once_more"), once_more, progress=StudyProgress(4, STEPS)))
    yield Shot("kiosk-once-more", window)
    argues = DialogueSection(condition=DialogueCondition.COLLABORATOR)
    hunt = PicturedHunt(replace(STANDARD, robots=2, dialogue=argues))
    hunt.do(SelectRoomAct(4))
    hunt.asked()
    seconds = hunt.now
    window.receive(InstructionsSoFar((InstructionText(text),)))
    to_do = words.to_do(texts, {PracticeTerm.MOVES: 1.0, PracticeTerm.DIALOGUES: 1.0})
    practice = GameToJoin(6, "", 0, "", True, progress=StudyProgress(3, STEPS), to_do=to_do)
    window.play(practice, hunt)
    window.receive(GameNews(6, 560, to_do))
    yield Shot("kiosk-practice", window, _wear(window))
    window.play(GameToJoin(6, "", 0, "", False, progress=StudyProgress(5, STEPS)), hunt)
    window.receive(GameNews(6, 61))
    window.receive(GameNews(6, 60))
    yield Shot("kiosk-game", window, _wear(window))
    if window.game is not None:
        window.game.window_of_game.do(ShowHelp())
    yield Shot("kiosk-game-instructions", window, _wear(window))
    played = words.result(texts, {"over": None, "score": 40})
    window.receive(GameRecorded(6, texts.text("kiosk.game_ended"), played, StudyProgress(6, STEPS)))
    yield Shot("kiosk-game-ended", window)
    asked = read_form(SHIPPED / "workload.yaml").value
    items = tuple(map(form_item, asked.items))
    page = FormToFill(7, asked.title, asked.instructions, items, progress=StudyProgress(8, STEPS))
    window.receive(page)
    yield Shot("kiosk-workload", window)
    answers: dict[str, Answer] = {"agree": 4.0, "hard": 35.0, "used": ("a drone",)}
    kinds = FormToFill(
        8, "The robots", "There are no right answers.", ALL_KINDS, answers, part=2, parts=3, back=True,
        progress=StudyProgress(9, STEPS),
    )  # fmt: skip
    window.receive(kinds)
    yield Shot("kiosk-form", window)
    seconds += 1.0
    form = window.pages.currentWidget()
    if isinstance(form, FormPage):
        form.go_on.click()
    yield Shot("kiosk-missing", window)
    window.progress.again.click()
    yield Shot("kiosk-instructions", window)
    window.progress.again.click()
    limited = FormItem("sum", "What is 7 times 8?", "number", unit="", seconds=20.0)
    window.receive(FormToFill(9, "Quickly", "", (limited,), progress=StudyProgress(9, STEPS)))
    seconds += 8.0
    yield Shot("kiosk-time-limit", window)
    seconds += 12.0
    yield Shot("kiosk-time-over", window)
    window.close()
    yield Shot("kiosk-leaving", window)
    window.leaving_panel.stay.click()
    run = Run("P-7K3FQ", Place(0, 0, 0), (), state=RunState.COMPLETE)
    window.receive(TextToRead(10, *words.farewell(texts, run), texts.text("kiosk.finish"), code="7K3FQ9XB"))
    yield Shot("kiosk-thanks", window)
    left = Run("P-7K3FQ", Place(0, 0, 0), (), state=RunState.LEFT)
    window.receive(TextToRead(11, *words.before_debriefing(texts, left)))
    yield Shot("kiosk-before-debriefing", window)
    debriefing = (EXAMPLE / "texts" / "debrief.txt").read_text(encoding="utf-8")
    window.receive(TextToRead(11, texts.text("kiosk.before_you_go"), debriefing))
    yield Shot("kiosk-debriefing", window)
    window.receive(TextToRead(11, *words.farewell(texts, left), texts.text("kiosk.finish")))
    yield Shot("kiosk-left", window)
    window.receive(HostStops(texts.text("kiosk.pauses"), texts.text("kiosk.stopped_text")))
    yield Shot("kiosk-stopped", window)
    window.give_way()


def _wear(window: KioskWindow) -> Callable[[Palette], None]:
    """Return a function that applies a palette to the game in a window."""
    return lambda palette: window.game.window_of_game.set_palette(palette) if window.game else None


STORIES = (
    Story(
        "A study with people, at the kiosk",
        {
            "kiosk-welcome": "The next participant can begin",
            "kiosk-code": "The code of a recruiting service is requested",
            "kiosk-text": "A text to read",
            "kiosk-consent": "Consent",
            "kiosk-once-more": "A comprehension check is repeated",
            "kiosk-practice": "Practice in the first condition, with the remaining tasks",
            "kiosk-game": "A game, with the step, the time left, and the button to stop",
            "kiosk-game-instructions": "The instructions during a game (F1)",
            "kiosk-game-ended": "The time of a game is over",
            "kiosk-workload": "A questionnaire of visual analogue scales, not yet answered",
            "kiosk-form": "A second page with all kinds of scales, partly filled in, and the button to go back",
            "kiosk-missing": "Missing answers are marked",
            "kiosk-instructions": "The instructions again (F1)",
            "kiosk-time-limit": "An item with a time limit",
            "kiosk-time-over": "The time of the item is over",
            "kiosk-leaving": "A participant closes the window",
            "kiosk-thanks": "The end, with the completion code",
            "kiosk-before-debriefing": "A participant stopped taking part",
            "kiosk-debriefing": "The debriefing for a participant who stopped",
            "kiosk-left": "The end for a participant who stopped",
            "kiosk-stopped": "The researcher stopped the program during a run",
        },
        at_the_kiosk,
    ),
)
"""States of the windows that `windows.py` draws."""
