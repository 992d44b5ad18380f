"""Texts of languages: complete, with the values of English, and told with their faults."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

from tests.support.project import ROOT
from thbridge.dialogue.sentences import reserved_in
from thbridge.dialogue.wording.texts import COUNT, value_of
from thbridge.files.errors import BadFile
from thbridge.files.language_texts import ENGLISH, advice_on_texts, missing_texts, read_texts, shipped_texts
from thbridge.files.word_files import SHIPPED_LANGUAGES, languages_in

ONLY_IN_WINDOWS = frozenset(
    {
        *("kiosk.welcome_wait", "kiosk.restarted_text", "kiosk.stopped_text"),
        *("kiosk.program_stopped_text", "kiosk.program_stopped_between"),
        *(
            "kiosk.close",
            "kiosk.close_text",
            "kiosk.close_window",
            "kiosk.close_window_hint",
            "kiosk.close_window_name",
        ),
        *("pages.not_recorded", "pages.key_close"),
    }
)
"""Keys of texts about the room or the window that no browser shows."""
HEAD = "language: {title: Polski, falls_back_on: en, plural: 'n==1 ? 0 : n%10>=2 && n%10<=4 && n%100/10!=1 ? 1 : 2'}\n"


def written(folder: Path, texts: str, name: str = "pl") -> tuple[Path, Path]:
    """A folder with one language, whose texts are these."""
    (folder / name / "texts").mkdir(parents=True)
    (folder / name / "language.yaml").write_text(HEAD)
    (folder / name / "texts" / "words.yaml").write_text(texts)
    return SHIPPED_LANGUAGES, folder


@pytest.mark.parametrize("language", languages_in(SHIPPED_LANGUAGES))
def test_languages_that_come_with_the_project_have_all_texts(language):
    assert missing_texts((SHIPPED_LANGUAGES,), language) == ()
    assert shipped_texts(language).language == language


def test_what_a_language_lacks_is_english_and_told(tmp_path):
    folders = written(tmp_path, "last: ' i '\npoints: [£count£ punkt, £count£ punkty, £count£ punktów]\n")
    texts = read_texts(folders, "pl")
    assert [texts.text("words.points", count=count) for count in (1, 3, 5, 12, 22)] == [
        "1 punkt",
        "3 punkty",
        "5 punktów",
        "12 punktów",
        "22 punkty",
    ]
    assert texts.text("words.rooms", count=2) == "2 rooms"
    assert texts.listed(["a", "b", "c"]) == "a, b i c"
    missing = missing_texts(folders, "pl")
    assert "words.rooms" in missing and "words.points" not in missing
    advice, number = advice_on_texts(folders, "pl"), len(shipped_texts().entries)
    assert advice is not None and advice.startswith(f"language pl: {len(missing)} of {number} texts are missing")
    assert f"first {missing[0]}. Write them in {tmp_path}/pl/texts/" in advice
    assert advice_on_texts(folders, "de") is None


def test_a_study_rewords_a_text_of_a_language_that_comes_with_the_project(tmp_path):
    (tmp_path / "en" / "texts").mkdir(parents=True)
    (tmp_path / "en" / "texts" / "words.yaml").write_text("rooms: [£count£ chamber, £count£ chambers]\n")
    texts = read_texts((SHIPPED_LANGUAGES, tmp_path), "en")
    assert texts.text("words.rooms", count=2) == "2 chambers"
    assert texts.text("words.points", count=2) == "2 points"


@pytest.mark.parametrize(
    ("text", "line", "problem"),
    [
        ("last: ' i '\npionts: a\n", 2, "text words.pionts does not exist. The nearest name is words.points"),
        ("percent: procent\n", 1, "this text must contain £number£, as the English text does"),
        ("percent: £numer£ %\n", 1, "unknown reserved word £numer£. Write £number£"),
        ("last: ' i '\nlast: ' i '\n", 2, "this name is already used above"),
        ("last: [' i ', ' a ']\n", 1, "this text has no plural forms in English"),
        ("last: {a: b}\n", 1, "neither a text nor a list of texts"),
        ("points: ''\n", 1, "the text is empty"),
    ],
)
def test_a_fault_is_told_with_its_line_and_remedy(tmp_path, text, line, problem):
    folders = written(tmp_path, text)
    with pytest.raises(BadFile) as raised:
        read_texts(folders, "pl")
    assert f"words.yaml, line {line}, " in str(raised.value) and problem in str(raised.value)


def test_a_wrong_rule_for_plurals_is_told(tmp_path):
    folders = written(tmp_path, "last: ' i '\n")
    (tmp_path / "pl" / "language.yaml").write_text("language: {title: Polski, falls_back_on: en, plural: n is 1}\n")
    with pytest.raises(BadFile, match="'n is 1' is not a rule for plurals"):
        read_texts(folders, "pl")


def test_values_are_said_as_the_language_says_them():
    german = shipped_texts("de")
    assert german.number(12.5) == "12,5"
    assert german.text("words.percent", number=12.5) == "12,5 %"
    assert (german.robot(0), german.room(3, "in"), german.room(0, "to")) == ("Roboter 1", "in Raum 3", "zum Flur")


class Used(ast.NodeVisitor):
    """The texts that a program asks for: keys with the values given, beginnings of keys, and all words in quotes."""

    def __init__(self) -> None:
        self.asked: list[tuple[str, set[str], bool]] = []
        self.asked_begun: set[str] = set()
        self.begun: set[str] = set()
        self.words: set[str] = set()

    def visit_Call(self, node: ast.Call) -> None:
        if isinstance(node.func, ast.Attribute) and node.func.attr in {"text", "clause"} and node.args:
            given = {keyword.arg for keyword in node.keywords if keyword.arg is not None}
            open_ended = any(keyword.arg is None for keyword in node.keywords)
            keys = [node.args[0].body, node.args[0].orelse] if isinstance(node.args[0], ast.IfExp) else [node.args[0]]
            for key in keys:
                match key:
                    case ast.Constant(value=str(value)):
                        self.asked.append((value, given, open_ended))
                    case ast.JoinedStr(values=[ast.Constant(value=str(value)), *_]):
                        self.asked_begun.add(value)
        self.generic_visit(node)

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        match node.values:
            case [ast.Constant(value=str(value)), *_] if re.fullmatch(r"[a-z_]+\.[a-z_]*", value):
                self.begun.add(value)
        self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> None:
        if isinstance(node.value, str):
            self.words.add(node.value)


@cache
def used() -> Used:
    """The texts that all programs ask for."""
    found = Used()
    for part in ("ui", "thbridge"):
        for path in (ROOT / part).rglob("*.py"):
            found.visit(ast.parse(path.read_text()))
    return found


def test_every_text_that_a_program_asks_for_is_there_with_its_values():
    entries, found = shipped_texts().entries, used()
    for key, given, open_ended in found.asked:
        assert key in entries, f"there is no text {key}"
        forms = entries[key] if isinstance(entries[key], tuple) else (entries[key],)
        wanted = {value_of(word) for form in forms for word in reserved_in(form)}
        assert open_ended or wanted - {COUNT} <= given, f"{key} is asked for without {wanted - given}"
    for begin in found.asked_begun:
        assert any(key.startswith(begin) for key in entries), f"no text begins with {begin}"


def test_no_text_is_left_that_no_program_asks_for():
    found = used()
    asked = {key for key, _, _ in found.asked} | found.words
    left = [key for key in shipped_texts().entries if key not in asked and not key.startswith(tuple(found.begun))]
    assert left == []


@pytest.mark.parametrize(
    ("language", "room"), [("en", "researcher|window|desk|computer"), ("de", "Versuchsl|Fenster|Tisch|Computer")]
)
def test_texts_in_browsers_refer_to_no_room_and_no_window(language, room):
    texts = shipped_texts(language)
    assert all(key.removeprefix("browser.") in texts.entries for key in texts.entries)
    shown = texts.in_browser().entries
    parts = ("forms.", "game_over.", "kiosk.", "pages.", "practice.", "start.", "web.")
    found = {key for key in shown if key.startswith(parts) and re.search(room, str(shown[key]))}
    assert found - ONLY_IN_WINDOWS - {"kiosk.tell_researcher", "web.message", "web.elsewhere_text"} == set()


def test_english_is_the_language_that_has_all_texts():
    assert ENGLISH in languages_in(SHIPPED_LANGUAGES)
