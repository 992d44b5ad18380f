"""Messages between the program that takes people through a study (host) and the window in which they go through it.

The window is a process of its own. It knows what its page shows and nothing of the study's log: each page has a number,
and what is said of another page than the one shown is void.
"""

from collections.abc import Sequence
from typing import Literal, TypeAlias

import msgspec

from thbridge.roles.shared.notices import GameTexts
from ui.model.shared.window_protocol import WindowProtocol

Answer: TypeAlias = float | str | tuple[str, ...] | None
"""Answer to an item: a number, words or an option, several options; None: not answered."""


class StudyTexts(msgspec.Struct, frozen=True, tag=True):
    """Host: the texts of the study's language, before all else. A window shows nothing before they come."""

    texts: GameTexts


class StudyProgress(msgspec.Struct, frozen=True):
    """Place of a page in a person's way through the study: `step` of `steps`; 0 steps: none to show."""

    step: int = 0
    steps: int = 0


class TextToRead(msgspec.Struct, frozen=True, tag=True):
    """Host: show a text.

    Attributes:
        page: number of the page.
        heading: above the text; empty: none.
        text: in paragraphs, or Markdown.
        button: what leads on; None: the usual word; empty: nothing does, and the page is there until another comes.
        markdown: True where the text is Markdown.
        code: completion code to copy down; empty: none.
        anew: True where the next person begins: what the one before chose for themselves (size of text, sound) is over.
        progress: of the person.
    """

    page: int
    heading: str
    text: str
    button: str | None = None
    markdown: bool = False
    code: str = ""
    anew: bool = False
    progress: StudyProgress = StudyProgress()


class ConsentToAsk(msgspec.Struct, frozen=True, tag=True):
    """Host: ask for the agreement to a text; `markdown` where it is Markdown."""

    page: int
    text: str
    markdown: bool = False
    progress: StudyProgress = StudyProgress()


class FormItem(msgspec.Struct, frozen=True):
    """An item of a form as people see it; most attributes are those of `questionnaires.form.Item`.

    Attributes:
        labels: of the options, in their order; empty: the options themselves.
        one_line: True where a text is a word or a code, and Enter leads on.
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
    """Host: have a page of a form filled in.

    Attributes:
        page: number of the page.
        title: of the form.
        instructions: above the items; empty: none.
        items: of this page, in their order.
        answers: given or begun before, by the item's id.
        timed_out: ids of items that were closed by their time limits.
        missing: ids of required items without an answer, to be pointed at.
        part: number of the page within the form, from 1.
        parts: pages of the form.
        back: True where the person may go back to the page before.
        progress: of the person.
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
    """Host: an answer is in the log; `timed_out` where the time limit of its item was over."""

    page: int
    item: str
    answer: Answer
    timed_out: bool = False


class GamePrepared(msgspec.Struct, frozen=True, tag=True):
    """Host: a game is being prepared, or ends; `sentence` tells people so."""

    page: int
    sentence: str
    progress: StudyProgress = StudyProgress()


class GameToJoin(msgspec.Struct, frozen=True, tag=True):
    """Host: the game waits at this address.

    Attributes:
        page: number of the page.
        host: host of its text server.
        port: port of its text server.
        token: secret by which the server recognizes this participant.
        practice: True for the practice game.
        agreed_at: time of day at which the person agreed to take part; empty: nothing was asked.
        progress: of the person.
        to_do: as in `GameNews`, when the game begins.
    """

    page: int
    host: str
    port: int
    token: str
    practice: bool
    agreed_at: str = ""
    progress: StudyProgress = StudyProgress()
    to_do: tuple[str, ...] = ()


class GameNews(msgspec.Struct, frozen=True, tag=True):
    """Host: how far the game is.

    Attributes:
        page: number of the game's page.
        seconds_left: real time until the game ends, s, rounded up.
        to_do: what must still be done in a practice game before the person may go on, each in words.
    """

    page: int
    seconds_left: int
    to_do: tuple[str, ...] = ()


class InstructionText(msgspec.Struct, frozen=True):
    """A text of the study's instructions; `markdown` where it is Markdown."""

    text: str
    markdown: bool = False


class InstructionsSoFar(msgspec.Struct, frozen=True, tag=True):
    """Host: the instructions that the person has read so far, and may read again on any page."""

    texts: tuple[InstructionText, ...]


class GameRecorded(msgspec.Struct, frozen=True, tag=True):
    """Host: the game has ended and is recorded; a window that does not show its end shows this text instead."""

    page: int
    heading: str
    text: str
    progress: StudyProgress = StudyProgress()


class CloseKiosk(msgspec.Struct, frozen=True, tag=True):
    """Host: close; it ends in good order, and nobody is in the middle of the study."""


class HostStops(msgspec.Struct, frozen=True, tag=True):
    """Host: it ends in the middle of somebody's run; the window stays and shows this until another one opens.

    A window whose host ends without this or `CloseKiosk` says so with the study's texts.
    """

    heading: str
    text: str


class WentOn(msgspec.Struct, frozen=True, tag=True):
    """Window: the person went on from a page."""

    page: int


class WentBack(msgspec.Struct, frozen=True, tag=True):
    """Window: the person went back from a page of a form to the one before."""

    page: int


class ConsentReply(msgspec.Struct, frozen=True, tag=True):
    """Window: the person agrees to take part, or does not."""

    page: int
    agrees: bool
    window_ns: int


class ItemNews(msgspec.Struct, frozen=True, tag=True):
    """Window: something happened with an item.

    Attributes:
        page: number of the page.
        item: its id.
        what: it came wholly into sight, was begun, has another answer, was gone on from, got pasted text, or was closed
            because its time limit was over.
        window_ns: monotonic time of the window, nanoseconds.
        answer: in force; of no meaning for an item that is shown, touched or pasted into.
        characters: number of those pasted.
    """

    page: int
    item: str
    what: Literal["shown", "touched", "changed", "given", "pasted", "timed out"]
    window_ns: int
    answer: Answer = None
    characters: int = 0


class FocusNews(msgspec.Struct, frozen=True, tag=True):
    """Window: keys and clicks go elsewhere, or come here again."""

    has_focus: bool
    window_ns: int


class InstructionsNews(msgspec.Struct, frozen=True, tag=True):
    """Window: the person opened the instructions to read them again, or closed them."""

    is_open: bool
    window_ns: int


class GameSeenOver(msgspec.Struct, frozen=True, tag=True):
    """Window: it shows the end of the game, and needs the game no more."""

    page: int


class StoppedTakingPart(msgspec.Struct, frozen=True, tag=True):
    """Window: the person wants to stop, and has confirmed that."""


class BeginNext(msgspec.Struct, frozen=True, tag=True):
    """Window: the researcher begins the run of the next person, by their key combination."""


class KioskClosed(msgspec.Struct, frozen=True, tag=True):
    """Window: it was closed on purpose."""


ToKiosk: TypeAlias = (
    StudyTexts
    | TextToRead
    | ConsentToAsk
    | FormToFill
    | AnswerKept
    | GamePrepared
    | GameToJoin
    | GameNews
    | InstructionsSoFar
    | GameRecorded
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
    """The texts, the last page, with a form's answers that are in the log, a game's last news, and the instructions."""
    match message:
        case GameNews() | InstructionsSoFar():
            return [*(one for one in before if type(one) is not type(message)), message]
        case AnswerKept():
            return [_answered(one, message) if isinstance(one, FormToFill) else one for one in before]
        case _:
            return [*(one for one in before if isinstance(one, StudyTexts | InstructionsSoFar)), message]


KIOSK = WindowProtocol(msgspec.json.Decoder(ToKiosk), msgspec.json.Decoder(FromKiosk), KioskClosed(), _kept)
"""Messages of the window in which people go through a study."""
