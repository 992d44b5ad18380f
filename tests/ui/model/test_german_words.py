"""A game in German: what the participant reads of map and templates is in German."""

import re
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from pathlib import Path

import pytest

from tests.thbridge.app.test_languages import english_in
from tests.ui.model.seat import Seat
from tests.ui.model.test_participant import play
from thbridge.app.compose.game import build_briefing
from thbridge.app.compose.setting import read_setting
from thbridge.dialogue.scripted.protocols import TemplateProtocol
from thbridge.dialogue.scripted.scripted_engine import ScriptedEngine
from thbridge.dialogue.scripted.strategies import TemplateStrategy
from thbridge.dialogue.scripted.templates import TemplatePhrasing
from thbridge.study.study_file import DialogueSection, Study
from ui.model.screen import Act, Screen, TreasureFact

PROGRAMS = {"names", "picked", "typed"}
"""Fields of a screen with names for programs."""


def words_on(part: object) -> Iterator[str]:
    """All that a screen shows."""
    if isinstance(part, str):
        yield part
    elif isinstance(part, tuple):
        for each in part:
            yield from words_on(each)
    elif is_dataclass(part) and not isinstance(part, Act):
        left_out = PROGRAMS | ({"value", "drawn"} if isinstance(part, TreasureFact) else set())
        for field in fields(part):
            if field.name not in left_out:
                yield from words_on(getattr(part, field.name))


@pytest.mark.parametrize("templates", ["four-properties", "everyday-things"])
def test_no_screen_has_english_words_of_map_and_templates(templates: str) -> None:
    setting = read_setting(Study(map="office", templates=templates, dialogue=DialogueSection(language="de")), Path())
    words, shown = setting.set_words, set[str]()
    phrasing = TemplatePhrasing(words.dialogue, 7, setting.texts, words.properties)
    talk = ScriptedEngine(TemplateProtocol(words.dialogue), TemplateStrategy(), phrasing)
    seat = Seat(set_name=templates, briefing=build_briefing(setting), talk=talk)

    def look(screen: Screen) -> None:
        shown.update(words_on(screen))

    play(seat, look)
    assert {*words.names.values(), "Farbe"} <= shown
    english = re.compile("|".join(rf"\b{re.escape(word)}\b" for word in sorted(english_in(setting))), re.IGNORECASE)
    assert [words for words in sorted(shown) if english.search(words)] == []
