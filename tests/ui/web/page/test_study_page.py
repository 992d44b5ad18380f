"""Pages of a study: no text of a study or of a person becomes HTML, except harmless Markdown."""

import re
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path

import pytest

from thbridge.files.language_texts import shipped_texts
from ui.model.kiosk import (
    ConsentToAsk,
    FormItem,
    FormToFill,
    GameNews,
    GamePrepared,
    GameRecorded,
    GameToJoin,
    HostStops,
    InstructionsSoFar,
    InstructionText,
    ResearcherMessage,
    TextToRead,
    ToKiosk,
)
from ui.web.page.patches import Json
from ui.web.page.study_page import StudyPageMaker, first_text

STATIC = Path(__file__).parents[4] / "ui" / "web" / "static"
HOSTILE = """<script>pwned = 1</script><img src=x onerror="pwned = 1"><svg/onload=pwned=1>
<a href="javascript:pwned=1">x</a>

[a](javascript:pwned=1) [b](JaVaScRiPt:pwned=1) [c](data:text/html,<script>pwned=1</script>) ![d](javascript:pwned=1)
[e]: javascript:pwned=1 "x"
[e] <javascript:pwned=1> [f](https://a.example/"onmouseover="pwned=1) `<b>` &lt;script&gt;

<iframe srcdoc="<script>pwned=1</script>"></iframe><style>*{display:none}</style><base href=//a.example>
"""
HARMLESS = {
    "p",
    "br",
    "a",
    "img",
    "code",
    "em",
    "strong",
    "ul",
    "ol",
    "li",
    "h1",
    "h2",
    "h3",
    "pre",
    "blockquote",
    "hr",
}


class Found(HTMLParser):
    """Tags and attributes of HTML."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: set[str] = set()
        self.attributes: list[tuple[str, str]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        self.attributes += [(name, value or "") for name, value in attrs]


def html_in(message: Json) -> Iterator[str]:
    """Yield all values that the page shows as HTML."""
    if isinstance(message, dict):
        for name, value in message.items():
            if name == "html":
                yield from value if isinstance(value, list) else [value]  # type: ignore[misc]
            else:
                yield from html_in(value)
    elif isinstance(message, list):
        for each in message:
            yield from html_in(each)


ITEM = FormItem(
    HOSTILE, HOSTILE, "choice", (HOSTILE,) * 5, HOSTILE, HOSTILE, unit=HOSTILE, options=(HOSTILE,), labels=(HOSTILE,)
)
MESSAGES: list[ToKiosk] = [
    TextToRead(1, HOSTILE, HOSTILE, HOSTILE, code=HOSTILE),
    TextToRead(1, HOSTILE, HOSTILE, markdown=True),
    ConsentToAsk(1, HOSTILE),
    ConsentToAsk(1, HOSTILE, markdown=True),
    FormToFill(1, HOSTILE, HOSTILE, (ITEM,), {HOSTILE: HOSTILE}),
    GamePrepared(1, HOSTILE),
    GameToJoin(1, "", 0, HOSTILE, practice=True, to_do=(HOSTILE,)),
    GameNews(1, 30, (HOSTILE,)),
    GameRecorded(1, HOSTILE, HOSTILE),
    InstructionsSoFar((InstructionText(HOSTILE), InstructionText(HOSTILE, markdown=True))),
    ResearcherMessage(HOSTILE),
    HostStops(HOSTILE, HOSTILE),
]


@pytest.mark.parametrize("message", MESSAGES, ids=lambda message: type(message).__name__)
def test_hostile_texts_stay_texts(message: ToKiosk) -> None:
    page = StudyPageMaker(shipped_texts()).page(message)
    first = first_text(page, shipped_texts()) if page is not None and "heading" in page else ""
    for html in (*html_in(page), first.replace('<article class="reading">', "").replace('<div class="prose">', "")):
        found = Found()
        found.feed(html)
        assert found.tags <= HARMLESS
        for name, value in found.attributes:
            assert name in {"href", "src", "alt", "title", "target", "rel", "start"}
            assert not re.match(r"\s*(javascript|vbscript|file|data):", value, re.IGNORECASE)


def test_links_of_a_study_open_in_another_tab() -> None:
    page = StudyPageMaker(shipped_texts()).page(TextToRead(1, "", "[a](https://a.example)", markdown=True))
    assert page is not None
    assert 'target="_blank" rel="noopener noreferrer"' in str(page["html"])


def test_scripts_of_the_page_make_html_only_of_what_the_server_has_made() -> None:
    makes = re.compile(r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|eval\(|new Function|srcdoc")
    lines = [line.strip() for path in sorted(STATIC.glob("*.js")) for line in path.read_text().splitlines()]
    assert [line.partition(";")[0] for line in lines if makes.search(line)] == [
        'body.innerHTML = instructions.join("<hr>")',
        "made.innerHTML = text",
    ]
