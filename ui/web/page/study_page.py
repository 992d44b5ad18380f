"""Pages of a study in a browser: each message of the study's host as a page with all its words."""

import math
from collections.abc import Sequence
from html import escape

from markdown_it import MarkdownIt
from markdown_it.renderer import RendererHTML
from markdown_it.token import Token
from markdown_it.utils import EnvType, OptionsDict

from thbridge.dialogue.wording.texts import Texts
from thbridge.experiment.design.recruiting import is_address
from ui.model.kiosk import (
    AnswerKept,
    CloseKiosk,
    ConsentToAsk,
    FormItem,
    FormToFill,
    GameNews,
    GamePrepared,
    GameRecorded,
    GameToJoin,
    HostStops,
    InstructionsSoFar,
    ResearcherMessage,
    StudyProgress,
    StudyTexts,
    TextToRead,
    ToKiosk,
    TurnToAwait,
    waited_words,
)
from ui.web.page.patches import Json, tree

WARNINGS = (60, 10)
"""Seconds before the end of a game at which people are warned."""
_GROUP = 4
"""Characters of a completion code between two spaces."""
_FINE = 1000
"""Number of positions of a mark on a line without steps."""
_MOST_TICKS = 20
"""Greatest number of steps that are drawn on a line."""


class StudyPageMaker:
    """Maker of the messages that a browser receives about the pages of a study.

    Args:
        texts: texts of the study's language.

    Attributes:
        texts: the texts; they may be replaced.
    """

    def __init__(self, texts: Texts) -> None:
        self.texts = texts
        # Texts come from the study's files, which may have been written by others: no HTML in them takes effect.
        self._markdown = MarkdownIt("commonmark", {"html": False, "linkify": False})
        self._markdown.add_render_rule("link_open", _link_in_other_tab)

    def page(self, message: ToKiosk) -> dict[str, Json] | None:
        """Return the message for the browser; None if the browser does not need it."""
        texts = self.texts
        match message:
            case StudyTexts():
                return self._words()
            case TextToRead(page=number, button=button):
                return {
                    "t": "text",
                    "page": number,
                    "heading": message.heading,
                    "html": self._html(message.text, markdown=message.markdown),
                    "button": texts.text("kiosk.continue") if button is None else button,
                    "code": self._code(message.code),
                    "ending": self._ending(message.ending),
                    **self._progress(message.progress),
                }
            case ConsentToAsk(page=number, text=text, markdown=markdown):
                return {
                    "t": "consent",
                    "page": number,
                    "heading": texts.text("pages.before"),
                    "html": self._html(text, markdown=markdown),
                    "agree": texts.text("game.agree"),
                    "agree_hint": texts.text("game.agree_hint"),
                    "decline": texts.text("game.decline"),
                    "decline_hint": texts.text("kiosk.stop_hint"),
                    **self._progress(message.progress),
                }
            case FormToFill():
                return self._form(message)
            case GamePrepared(page=number, sentence=sentence):
                return {
                    "t": "wait",
                    "page": number,
                    "heading": texts.text("pages.one_moment"),
                    "text": sentence,
                    **self._progress(message.progress),
                }
            case TurnToAwait(page=number, heading=heading, text=text):
                return {
                    "t": "turn",
                    "page": number,
                    "heading": heading,
                    "html": self._html(text, markdown=False),
                    "waited": waited_words(texts, message),
                    "button": texts.text("web.stop_waiting"),
                    **self._progress(message.progress),
                }
            case GameToJoin(page=number, practice=practice):
                return {
                    "t": "game",
                    "page": number,
                    "practice": practice,
                    "heading": texts.text("pages.one_moment"),
                    "text": texts.text("game.looking_for_game"),
                    "to_do": self._to_do(message.to_do),
                    "done": not message.to_do,
                    "back": texts.text("kiosk.go_on") if practice else "",
                    **self._progress(message.progress),
                }
            case GameNews(page=number, seconds_left=seconds):
                key = "kiosk.seconds_left" if seconds <= WARNINGS[0] else "kiosk.minutes_left"
                count = seconds if seconds <= WARNINGS[0] else math.ceil(seconds / 60)
                return {
                    "t": "news",
                    "page": number,
                    "left": texts.text(key, count=count),
                    "near": seconds <= WARNINGS[0],
                    "warn": seconds in WARNINGS,
                    "to_do": self._to_do(message.to_do),
                    "done": not message.to_do,
                }
            case GameRecorded(page=number, heading=heading, text=text):
                return {
                    "t": "recorded",
                    "page": number,
                    "heading": heading,
                    "html": self._html(text, markdown=False),
                    "button": texts.text("kiosk.continue"),
                    **self._progress(message.progress),
                }
            case InstructionsSoFar(texts=instructions):
                return {
                    "t": "instructions",
                    "html": [self._html(each.text, markdown=each.markdown) for each in instructions],
                }
            case HostStops(heading=heading, text=text):
                return {"t": "stopped", "heading": heading, "html": self._html(text, markdown=False)}
            case ResearcherMessage(text=text):
                heading, close = texts.text("web.message"), texts.text("web.message_close")
                return {"t": "message", "heading": heading, "text": text, "close": close}
            case CloseKiosk():
                over = self._html(texts.text("pages.close_window"), markdown=False)
                return {"t": "closed", "heading": texts.text("pages.thanks"), "html": over}
            case AnswerKept(page=number, item=item):
                return {"t": "kept", "page": number, "item": item, "timed_out": message.timed_out}

    def elsewhere(self) -> dict[str, Json]:
        """Return the message for a tab while another tab of the same person is live."""
        texts = self.texts
        return {
            **self._words(),  # The tab may have received nothing yet.
            "t": "elsewhere",
            "page": 0,
            "heading": texts.text("web.elsewhere"),
            "html": self._html(texts.text("web.elsewhere_text"), markdown=False),
            "button": texts.text("web.continue_here"),
            "code": None,
            "ending": None,
            **self._progress(StudyProgress()),
        }

    def _ending(self, ending: str) -> Json:
        """Return the contents of a page about an ending: an address or a completion code."""
        if not ending:
            return None
        texts = self.texts
        if is_address(ending):
            return {"address": ending, "label": texts.text("web.to_service")}
        spoken = texts.text("kiosk.completion_code_name", code=", ".join(ending))
        return {"address": "", "label": texts.text("web.service_code"), "code": ending, "spoken": spoken}

    def _words(self) -> dict[str, Json]:
        """Return the words of the page's fixed parts."""
        texts = self.texts
        return {
            "t": "words",
            "language": texts.language,
            "words": {key: texts.text(key) for key in PAGE_WORDS},
        }

    def _progress(self, progress: StudyProgress) -> dict[str, Json]:
        if not progress.steps:
            return {"step": "", "share": 0.0}
        words = self.texts.text("kiosk.step", step=progress.step, steps=progress.steps)
        return {"step": words, "share": round(max(progress.step - 1, 0) / progress.steps, 3)}

    def _html(self, text: str, *, markdown: bool) -> str:
        if markdown:
            return str(self._markdown.render(text))
        paragraphs = [part for part in text.replace("\r\n", "\n").split("\n\n") if part.strip()]
        return "".join(f"<p>{escape(part.strip()).replace(chr(10), '<br>')}</p>" for part in paragraphs)

    def _code(self, code: str) -> Json:
        if not code:
            return None
        texts = self.texts
        return {
            "label": texts.text("kiosk.completion_code"),
            "code": " ".join(code[at : at + _GROUP] for at in range(0, len(code), _GROUP)),
            "spoken": texts.text("kiosk.completion_code_name", code=", ".join(code)),
            "note": texts.text("kiosk.completion_code_blank") if len(code) > _GROUP else "",
        }

    def _to_do(self, tasks: tuple[str, ...]) -> str:
        texts = self.texts
        return texts.text("pages.before_you_go_on", to_do=", ".join(tasks)) if tasks else texts.text("pages.done")

    def _form(self, form: FormToFill) -> dict[str, Json]:
        texts, count = self.texts, len(form.items)
        return {
            "t": "form",
            "page": form.page,
            "heading": form.title,
            "html": self._html(form.instructions, markdown=False),
            "items": [self._item(item, number, count) for number, item in enumerate(form.items, start=1)],
            "answers": {key: tree(answer) for key, answer in form.answers.items()},
            "timed_out": list(form.timed_out),
            "missing": list(form.missing),
            "part": texts.text("forms.page", page=form.part, pages=form.parts) if form.parts > 1 else "",
            "answered": [
                texts.text("forms.answered", answered=answered, total=count) if count > 1 else ""
                for answered in range(count + 1)
            ],
            "lacking": [texts.text("forms.missing", count=lacking) for lacking in range(count + 1)],
            "button": texts.text("kiosk.continue"),
            "back": texts.text("kiosk.back") if form.back else "",
            **self._progress(form.progress),
        }

    def _item(self, item: FormItem, number: int, count: int) -> dict[str, Json]:
        texts = self.texts
        question = item.text or texts.text("forms.either", low=item.low, high=item.high)
        shown: dict[str, Json] = {
            "id": item.id,
            "scale": item.scale,
            "question": question,
            "spoken": texts.text("forms.question", number=str(number), total=str(count), question=question),
            "several": texts.text("forms.several") if item.several else "",
            "required": item.required,
            "optional": "" if item.required else texts.text("forms.optional"),
            "not_applicable": texts.text("forms.not_applicable") if item.not_applicable else "",
            "please_answer": texts.text("forms.please_answer"),
            "seconds": item.seconds,
            "left": [texts.text("forms.seconds_left", count=left) for left in range(math.ceil(item.seconds) + 1)]
            if item.seconds > 0.0
            else [],
            "over": texts.text("forms.time_is_over"),
        }
        match item.scale:
            case "likert" | "differential":
                shown["points"] = self._points(item)
                inner = any(item.words[1:-1])
                shown["ends"] = [] if inner else [item.words[0], item.words[-1]]
            case "choice":
                shown["options"] = [
                    {"value": option, "label": label}
                    for option, label in zip(item.options, item.labels or item.options, strict=True)
                ]
            case "number":
                least, greatest = texts.number(item.minimum), texts.number(item.maximum)
                shown |= {
                    "minimum": item.minimum,
                    "maximum": item.maximum,
                    "step": item.step,
                    "unit": item.unit,
                    "hint": texts.text("forms.range", least=least, greatest=greatest),
                    "wanted": texts.text("forms.number_wanted", least=least, greatest=greatest),
                    "decimal": texts.forms.decimal,
                }
            case "analogue":
                span = item.maximum - item.minimum
                steps = max(round(span / item.step), 1) if item.step > 0.0 else 0
                shown |= {
                    "minimum": item.minimum,
                    "maximum": item.maximum,
                    "step": item.step if steps else span / _FINE,
                    "ticks": steps if 0 < steps <= _MOST_TICKS else 1,
                    "ends": [item.low, item.high],
                    "hint": texts.text("forms.line_keys"),
                }
            case "text":
                shown["one_line"] = item.one_line
        return shown

    def _points(self, item: FormItem) -> Json:
        texts, words = self.texts, item.words
        inner = any(words[1:-1])
        points: list[Json] = []
        for index, word in enumerate(words):
            number = str(index + 1)
            if word:
                name = texts.text("forms.point_word", point=number, points=len(words), word=word)
            elif not inner and words[0] and words[-1]:
                name = texts.text("forms.point_ends", point=number, points=len(words), low=words[0], high=words[-1])
            else:
                name = texts.text("forms.point", point=number, points=len(words))
            points.append({"value": index + 1.0, "label": number, "spoken": name, "word": word if inner else ""})
        return points


def first_text(page: dict[str, Json] | None, texts: Texts) -> str:
    """Return the text of a page as HTML, which people can read before the scripts are loaded; None is a short wait."""
    shown = page or {"heading": texts.text("pages.one_moment")}
    html = shown.get("html") or f"<p>{escape(str(shown.get('text', '')))}</p>"
    return f'<article class="reading"><h1>{escape(str(shown["heading"]))}</h1><div class="prose">{html}</div></article>'


def _link_in_other_tab(
    renderer: RendererHTML, tokens: Sequence[Token], index: int, options: OptionsDict, _env: EnvType
) -> str:
    """Return the beginning of a link, which opens in another tab: the study's page must not be left."""
    tokens[index].attrSet("target", "_blank")
    tokens[index].attrSet("rel", "noopener noreferrer")
    return renderer.renderToken(tokens, index, options, _env)


PAGE_WORDS = (
    "window.title",
    "window.robots",
    "window.rooms",
    "window.score",
    "window.score_and_tools",
    "window.what_waits",
    "window.dialogue",
    "window.treasure",
    "window.picture",
    "window.picture_of_find",
    "window.history",
    "window.possible_names",
    "window.what_was_said",
    "votes.title",
    "votes.reason",
    "map.name",
    "pages.before",
    "pages.one_moment",
    "pages.question",
    "pages.game_over",
    "pages.rules_and_keys",
    "pages.instructions",
    "pages.thanks",
    "popups.close",
    "kiosk.read_again",
    "kiosk.read_again_name",
    "kiosk.stop",
    "kiosk.stop_name",
    "kiosk.stop_hint",
    "kiosk.leave",
    "kiosk.go_on",
    "settings.title",
    "settings.look",
    "settings.look_light",
    "settings.look_dark",
    "settings.text_size",
    "settings.sound",
    "settings.sound_on",
    "settings.close",
    "settings.look_system",
    "kiosk.leave_text",
)
"""Keys of the texts for the fixed parts of the page."""
