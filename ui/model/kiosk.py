"""Messages between the program that runs a study with people (host) and the participant's window (kiosk).

The window runs in a separate process. It receives the contents of each page, but cannot read the study's log. Each page
has a number; a message about a page other than the present page is ignored. The docstring of each message begins with
the sender of the message.
"""

from collections.abc import Sequence
from typing import Literal, TypeAlias

import msgspec

from thbridge.dialogue.wording.texts import Texts
from thbridge.roles.shared.notices import GameTexts
from ui.model.shared.window_protocol import WindowProtocol

Answer: TypeAlias = float | str | tuple[str, ...] | None
"""Answer to an item: a number, a text, an option, or several options. If None, there is no answer."""


class StudyTexts(msgspec.Struct, frozen=True, tag=True):
    """Host: the texts of the study's language.

    This is the first message. A window shows nothing before it arrives.
    """

    texts: GameTexts


class StudyProgress(msgspec.Struct, frozen=True):
    """Position of a page in a person's run: `step` of `steps`. If `steps` is 0, nothing is shown."""

    step: int = 0
    steps: int = 0


class TextToRead(msgspec.Struct, frozen=True, tag=True):
    """Host: show a text.

    Attributes:
        page: number of the page.
        heading: heading above the text; empty if there is none.
        text: text in paragraphs, or in Markdown.
        button: label of the button that leads to the next page. If None, the label is the usual word. If empty, there
            is no button, and the page stays until the host sends another page.
        markdown: True if the text is Markdown.
        code: completion code for the person to write down; empty if there is none.
        ending: address of a recruiting service to which the person may go, or a completion code for it; empty if there
            is none. The kiosk's window does not show it, because people from recruiting services come in browsers.
        `anew`: True if another person begins; the settings of the previous person (size of text, sound) are reset.
        progress: position in the person's run.
    """

    page: int
    heading: str
    text: str
    button: str | None = None
    markdown: bool = False
    code: str = ""
    ending: str = ""
    anew: bool = False
    progress: StudyProgress = StudyProgress()


class ConsentToAsk(msgspec.Struct, frozen=True, tag=True):
    """Host: ask for consent to a text; `markdown` is True if the text is Markdown."""

    page: int
    text: str
    markdown: bool = False
    progress: StudyProgress = StudyProgress()


class FormItem(msgspec.Struct, frozen=True):
    """Item of a form in the window. `questionnaires.form.Item` describes the attributes that are not listed here.

    Attributes:
        labels: labels of the options, in the order of the options; if empty, the options themselves are shown.
        one_line: True if the answer is a word or a code. Then Enter leads to the next item.
    """

    id: str
    text: str
    scale: Literal["likert", "analogue", "differential", "number", "choice", "text"]
    words: tuple[str, ...] = ()
    low: str = ""
    high: str = ""
    minimum: float = 0.0
    maximum: float = 100.0
    step: float = 1.0
    unit: str = ""
    options: tuple[str, ...] = ()
    labels: tuple[str, ...] = ()
    several: bool = False
    required: bool = True
    not_applicable: bool = False
    seconds: float = 0.0
    one_line: bool = False


class FormToFill(msgspec.Struct, frozen=True, tag=True):
    """Host: show a page of a form to fill in.

    Attributes:
        page: number of the page.
        title: title of the form.
        instructions: instructions above the items; empty if there are none.
        items: items of this page, in the order of the form.
        answers: complete and incomplete answers so far, by the id of the item.
        timed_out: ids of items whose time limits have ended.
        missing: ids of required items without an answer, which the window marks.
        part: number of the page within the form, from 1.
        parts: number of pages of the form.
        back: True if the person may go back to the previous page.
        progress: position in the person's run.
    """

    page: int
    title: str
    instructions: str
    items: tuple[FormItem, ...]
    answers: dict[str, Answer] = {}
    timed_out: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()
    part: int = 1
    parts: int = 1
    back: bool = False
    progress: StudyProgress = StudyProgress()


class AnswerKept(msgspec.Struct, frozen=True, tag=True):
    """Host: an answer was logged; `timed_out` is True if the time limit of the item had ended."""

    page: int
    item: str
    answer: Answer
    timed_out: bool = False


class GamePrepared(msgspec.Struct, frozen=True, tag=True):
    """Host: a game is being prepared or is ending; the window shows `sentence` to the person."""

    page: int
    sentence: str
    progress: StudyProgress = StudyProgress()


class TurnToAwait(msgspec.Struct, frozen=True, tag=True):
    """Host: the person waits, for a place in the study or for a game. Sent again each second, with the same number.

    Attributes:
        page: number of the page.
        heading: heading above the text.
        text: reason for the wait.
        waited: whole seconds that the person has waited.
        before: number of people who wait and come first.
        progress: position in the person's run.
    """

    page: int
    heading: str
    text: str
    waited: int = 0
    before: int = 0
    progress: StudyProgress = StudyProgress()


class GameToJoin(msgspec.Struct, frozen=True, tag=True):
    """Host: join a game at a text server.

    Attributes:
        page: number of the page.
        host: host of the game's text server.
        port: port of the game's text server.
        token: secret by which the server recognizes this participant.
        practice: True for the practice game.
        agreed_at: date and time at which the person gave consent; empty if the study did not ask for consent.
        progress: position in the person's run.
        to_do: tasks at the beginning of the game, as in `GameNews`.
        seat: name of the person's seat; empty in a game with one participant.
    """

    page: int
    host: str
    port: int
    token: str
    practice: bool
    agreed_at: str = ""
    progress: StudyProgress = StudyProgress()
    to_do: tuple[str, ...] = ()
    seat: str = ""


class GameNews(msgspec.Struct, frozen=True, tag=True):
    """Host: progress of the game.

    Attributes:
        page: number of the game's page.
        seconds_left: real time in seconds until the game ends, rounded up.
        to_do: descriptions of the tasks that the person must finish in a practice game before the study continues.
    """

    page: int
    seconds_left: int
    to_do: tuple[str, ...] = ()


class InstructionText(msgspec.Struct, frozen=True):
    """Text of the study's instructions; `markdown` is True if the text is Markdown."""

    text: str
    markdown: bool = False


class InstructionsSoFar(msgspec.Struct, frozen=True, tag=True):
    """Host: the instructions that the person has read so far, and can read again on every page."""

    texts: tuple[InstructionText, ...]


class GameRecorded(msgspec.Struct, frozen=True, tag=True):
    """Host: the game has ended and is recorded. If the window does not show the end of the game, it shows this text."""

    page: int
    heading: str
    text: str
    progress: StudyProgress = StudyProgress()


class ResearcherMessage(msgspec.Struct, frozen=True, tag=True):
    """Host: show a message of the researcher above the page until the person closes it, or until the next message."""

    text: str


class CloseKiosk(msgspec.Struct, frozen=True, tag=True):
    """Host: close the window. The host ends normally, and no run is in progress."""


class HostStops(msgspec.Struct, frozen=True, tag=True):
    """Host: the host ends during a person's run. The window shows this text until a new window opens.

    If the host ends without this message and without `CloseKiosk`, the window reports this in the study's language.
    """

    heading: str
    text: str


class WentOn(msgspec.Struct, frozen=True, tag=True):
    """Window: the person continued from a page."""

    page: int


class WentBack(msgspec.Struct, frozen=True, tag=True):
    """Window: the person went back to the previous page of a form."""

    page: int


class ConsentReply(msgspec.Struct, frozen=True, tag=True):
    """Window: the person gives consent, or declines."""

    page: int
    agrees: bool
    window_ns: int


class ItemNews(msgspec.Struct, frozen=True, tag=True):
    """Window: an event of an item.

    Attributes:
        page: number of the page.
        item: id of the item.
        what: the event. "shown": the item became fully visible. "touched": the person began the answer. "changed": the
            answer changed. "given": the person went to another item or page. "pasted": text was pasted into the
            answer. "timed out": the time limit of the item ended.
        window_ns: monotonic time of the window, nanoseconds.
        answer: the present answer; it has no meaning for the events "shown", "touched" and "pasted".
        characters: number of pasted characters.
    """

    page: int
    item: str
    what: Literal["shown", "touched", "changed", "given", "pasted", "timed out"]
    window_ns: int
    answer: Answer = None
    characters: int = 0


class FocusNews(msgspec.Struct, frozen=True, tag=True):
    """Window: the keyboard focus moved to another window, or returned to this window."""

    has_focus: bool
    window_ns: int


class InstructionsNews(msgspec.Struct, frozen=True, tag=True):
    """Window: the person opened the instructions to read them again, or closed them."""

    is_open: bool
    window_ns: int


class MessageClosed(msgspec.Struct, frozen=True, tag=True):
    """Window: the person has closed the message of the researcher."""


class GameSeenOver(msgspec.Struct, frozen=True, tag=True):
    """Window: the end of the game is shown, and the game is no longer needed."""

    page: int


class StoppedTakingPart(msgspec.Struct, frozen=True, tag=True):
    """Window: the person wants to stop taking part, and has confirmed this."""


class BeginNext(msgspec.Struct, frozen=True, tag=True):
    """Window: the researcher pressed the keys that start the run of the next person."""


class KioskClosed(msgspec.Struct, frozen=True, tag=True):
    """Window: a person closed the window on purpose."""


ToKiosk: TypeAlias = (
    StudyTexts
    | TextToRead
    | ConsentToAsk
    | FormToFill
    | AnswerKept
    | GamePrepared
    | TurnToAwait
    | GameToJoin
    | GameNews
    | InstructionsSoFar
    | GameRecorded
    | ResearcherMessage
    | CloseKiosk
    | HostStops
)
FromKiosk: TypeAlias = (
    WentOn
    | WentBack
    | ConsentReply
    | ItemNews
    | FocusNews
    | InstructionsNews
    | MessageClosed
    | GameSeenOver
    | StoppedTakingPart
    | BeginNext
    | KioskClosed
)


def _answered(form: FormToFill, kept: AnswerKept) -> FormToFill:
    if form.page != kept.page:
        return form
    closed = (*form.timed_out, kept.item) if kept.timed_out else form.timed_out
    return msgspec.structs.replace(form, answers={**form.answers, kept.item: kept.answer}, timed_out=closed)


def _kept(before: Sequence[ToKiosk], message: ToKiosk) -> Sequence[ToKiosk]:
    """Return the messages that a reopened window needs.

    These are the texts, the last page with the logged answers of its form, the last news of a game, the instructions,
    and the last message of the researcher, until another person begins.
    """
    match message:
        case TextToRead(anew=True):
            return [*(one for one in before if isinstance(one, StudyTexts | InstructionsSoFar)), message]
        case GameNews() | InstructionsSoFar() | ResearcherMessage():
            return [*(one for one in before if type(one) is not type(message)), message]
        case AnswerKept():
            return [_answered(one, message) if isinstance(one, FormToFill) else one for one in before]
        case _:
            lasting = StudyTexts | InstructionsSoFar | ResearcherMessage
            return [*(one for one in before if isinstance(one, lasting)), message]


def waited_words(texts: Texts, turn: TurnToAwait) -> str:
    """Return the sentences about the time that a person has waited, and about the people who come first."""
    waited = texts.text("web.waited", time=f"{turn.waited // 60}:{turn.waited % 60:02}")
    return f"{waited} {texts.text('web.before_you', count=turn.before)}" if turn.before else waited


KIOSK = WindowProtocol(msgspec.json.Decoder(ToKiosk), msgspec.json.Decoder(FromKiosk), KioskClosed(), _kept)
"""Messages between host and kiosk, the window in which people take part in a study."""
