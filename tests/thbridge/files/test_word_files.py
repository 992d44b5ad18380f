"""Files of words: whatever is wrong in them is told with its file, place and remedy before anything is said."""

from pathlib import Path

import pytest

from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.argumentation.propositions import Literal
from thbridge.dialogue.games.contents import ContentKind, DialogueMove
from thbridge.dialogue.games.locutions import Locution
from thbridge.dialogue.propositions import NextRoom
from thbridge.dialogue.wording.lines import LineKey
from thbridge.dialogue.wording.wording import Wording
from thbridge.files.errors import BadFile
from thbridge.files.game_files import read_rulebook
from thbridge.files.word_files import SHIPPED_LANGUAGES, check_words, languages_in, read_language
from thbridge.hunt.rooms import Room

ROOM_3 = Literal(NextRoom(0, Room(3)))
DUTCH = "language: {title: Nederlands, falls_back_on: en}\n"


def lab(folder: Path, text: str, language: str = "en", name: str = "ours.yaml") -> Path:
    """Write a file of a language into a lab's folder, and return that."""
    (folder / language).mkdir(exist_ok=True)
    (folder / language / name).write_text(text, encoding="utf-8")
    return folder


BROKEN = {
    "phrases: [{of: nxt, yes: [x]}]": ("line 1, phrases[0].of", "predicate nxt does not", "The nearest name is next"),
    "phrases: [{of: visited, yes: ['£rom£ is done']}]": ("phrases[0].yes[0]", "£rom£", "Write £room£"),
    "phrases: [{of: visited, yes: ['it is done']}]": ("must contain £room£", "Add £room£ to it"),
    "phrases: [{of: plan, no: ['no £robot£ £room£ £rooms£']}]": ("must contain £energy£",),
    "phrases: [{of: plan, robot: self, no: ['no £to_room£']}]": ("must contain £energy£ and £rooms£",),
    "phrases: [{of: visited, robot: self, yes: ['£room£']}]": ("visited is not about a robot", "Delete"),
    "phrases: [{of: visited, yes: ['£room£ is done.']}]": ("does not end the sentence", "Delete the punct"),
    "phrases: [{of: visited, yes: ['£room£'], no: ['£room£']}]": ("the same words", "Write the negation"),
    "phrases: [{of: visited}]": ("there is no wording", "at least one"),
    "phrases: [{of: visited, yes: ['']}]": ("the wording is empty",),
    'phrases: [{of: visited, yes: ["a\\nb £room£"]}]': ("a line break or control sign, U+000A",),
    'phrases: [{of: visited, yes: ["£room£\u00a0!"]}]': ("no-break space, U+00A0", "plain blanks"),
    "phrases: [{of: visited, yes: ['£room']}]": ("a pound sign without its partner",),
    "phrases: [{of: visited, speaker: cat, yes: ['£room£']}]": ("'cat' is not a valid choice", "robot or human"),
    "phrases: [{of: visited, yes: ['£room£']}, {of: visited, no: ['£room£ not']}]": (
        "the same case is already in ours.yaml",
    ),
    "moves: [{move: chalenge, speaker: human, say: ['£content£']}]": (
        "locution chalenge does not",
        "nearest name is challenge",
    ),
    "moves: [{move: challenge, speaker: human, say: ['Why?']}]": ("must contain £content£",),
    "moves: [{move: challenge, speaker: human, say: []}]": ("there is no wording",),
    "moves: [{move: challenge, speaker: human, of: next, say: ['Why £room£?']}]": ("must contain £content£",),
    "moves: [{move: challenge, speaker: human, of: next, holds: true, say: ['Why £room£?']}]": (
        "must contain £content£",
    ),
    "moves: [{move: challenge, speaker: human, of: nex, say: ['£content£']}]": ("predicate nex does not", "next"),
    "moves: [{move: challenge, speaker: human, condition: boss, say: ['£content£']}]": (
        "'boss' is not a valid choice",
        "adviser",
    ),
    "moves: [{move: assert, content: argument, speaker: human, say: ['£content£']}]": ("£content£", "£conclusion£"),
    "moves: [{move: assert, content: argument, speaker: human, say: ['£conclusion£']}]": ("must contain £support£",),
    "moves: [{move: challenge, content: rule, of: next, speaker: human, say: ['£content£']}]": (
        "apply to all predicates",
    ),
    "moves: [{move: assert, content: argument, of: next, robot: self, holds: true, speaker: human, say: ['£room£']}]": (
        "must contain £support£",
    ),
    "moves: [{move: challenge, speaker: human, of: visited, robot: self, say: ['£content£']}]": ("not about a robot",),
    "moves: [{move: accept, speaker: human, say: ['£content£']}, {move: accept, speaker: human, say: ['£content£']}]": (
        "the same case is already in ours.yaml, line 1",
    ),
    "lines: [{key: mishered, say: [Hello]}]": ("line mishered does not", "The nearest name is misheard"),
    "lines: [{key: misheard, say: ['Hello £seconds£']}]": ("£seconds£", "£heard£"),
    "lines: [{key: back, say: ['Hello £seconds£']}]": ("£seconds£", "Write it without"),
    "lines: [{key: back, say: []}]": ("there is no wording",),
    "lines: [{key: back, say: [Back]}, {key: back, say: [Zurück]}]": ("the same case is already in",),
    "lines: [{say: [Back]}]": ("lines[0].key", "missing"),
    "frases: []": ("unknown key", "phrases"),
    "phrases: 3": ("a list is needed",),
    "language: {title: Nederlands, falls_back_on: fr}": ("language fr does not exist", "Write one of: de, en, nl"),
    "language: {title: Nederlands, falls_back_on: nl}": ("in a circle", "Write null"),
    "grammar: {room: x}": ("grammar", "missing"),
    "[": ("ours.yaml, line 1",),
}


@pytest.mark.parametrize("text", BROKEN)
def test_what_is_wrong_is_told_with_file_place_and_remedy(tmp_path: Path, text: str) -> None:
    folder = lab(tmp_path, text, "nl")
    with pytest.raises(BadFile) as told:
        read_language((SHIPPED_LANGUAGES, folder), "nl")
    sentence = str(told.value)
    assert sentence.startswith(str(folder / "nl" / "ours.yaml")), sentence
    for part in BROKEN[text]:
        assert part in sentence


GRAMMAR = (SHIPPED_LANGUAGES / "en" / "language.yaml").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("right", "wrong", "told"),
    [
        ("to_room: to room £number£", "to_room: to room", "must contain £number£"),
        ("corridor: the corridor", "corridor: the £number£", "unknown reserved word £number£"),
        ("one_room: 1 room", "one_room: a room", "Write 1 in it"),
        ('decimal: "."', 'decimal: "x"', 'Write "." or ","'),
        ('last_or: " or "', r'last_or: "\n"', "the wording is empty"),
        ("{bottle: a bottle}", "{bottle: a £thing£}", "unknown reserved word £thing£"),
        ("£premises£; then", "so;", "must contain £premises£"),
        ("[not, ", "[no way, ", "'no way' is not one word"),
        ("bound:\n    [room, ", "bound:\n    ['*', room, ", "'*' is not one word"),
    ],
)
def test_a_broken_grammar_is_told(tmp_path: Path, right: str, wrong: str, told: str) -> None:
    assert right in GRAMMAR
    with pytest.raises(BadFile, match=r"language\.yaml, line \d+, grammar\.\w+") as raised:
        check_words(lab(tmp_path, GRAMMAR.replace(right, wrong), "nl", "language.yaml"))
    assert told in str(raised.value)


def test_all_faults_of_a_language_are_told_together(tmp_path: Path) -> None:
    lab(tmp_path, "lines: [{key: mishered, say: [Hello]}]")
    lab(tmp_path, "phrases: [{of: nxt, yes: [x]}]", name="theirs.yaml")
    with pytest.raises(BadFile) as told:
        check_words(tmp_path)
    assert len(str(told.value).splitlines()) == 2


def test_a_lab_replaces_a_wording_of_the_same_narrowing(tmp_path: Path) -> None:
    text = "moves: [{move: challenge, speaker: human, of: next, robot: self, holds: true, say: ['£room£? Why?']}]"
    (language,) = check_words(lab(tmp_path, text + "\nlines: [{key: back, say: [Never mind.]}]"))
    wording = Wording(language, 0)
    assert wording.sentence(DialogueMove("challenge", ROOM_3), Side.HUMAN) == "Room 3? Why?"
    assert wording.sentence(DialogueMove("challenge", ~ROOM_3), Side.HUMAN) == "Why not room 3?"
    assert wording.line(LineKey.BACK) == "Never mind."


def test_a_new_language_begins_with_few_lines(tmp_path: Path) -> None:
    (language,) = check_words(lab(tmp_path, DUTCH + "lines: [{key: back, say: [Terug.]}]", "nl"))
    assert language.fallback == read_language()
    dutch, english = Wording(language, 0), Wording(read_language(), 0)
    assert dutch.line(LineKey.BACK) == "Terug."
    assert dutch.line(LineKey.LEAVE_IT) == english.line(LineKey.LEAVE_IT)
    for side in Side:
        move = DialogueMove("challenge", ROOM_3)
        assert dutch.sentence(move, side) == english.sentence(move, side)


def test_a_language_that_lacks_words_and_falls_back_on_none_is_told(tmp_path: Path) -> None:
    lab(tmp_path, GRAMMAR, "nl", "language.yaml")
    with pytest.raises(BadFile) as told:
        check_words(tmp_path)
    sentence = str(told.value)
    assert sentence.startswith(str(tmp_path / "nl"))
    for part in ("phrase next with 'yes'", "accept with a rule, said by the", "line why_now", "fall back"):
        assert part in sentence


def test_a_language_without_a_heading_is_told(tmp_path: Path) -> None:
    with pytest.raises(BadFile, match=r"no section 'language'.*falls_back_on"):
        check_words(lab(tmp_path, "lines: []", "nl"))


def test_a_language_of_its_own_needs_a_grammar(tmp_path: Path) -> None:
    with pytest.raises(BadFile, match="no section 'grammar'"):
        check_words(lab(tmp_path, "language: {title: Nederlands}", "nl"))


def test_a_language_that_is_not_there_is_told_with_the_nearest(tmp_path: Path) -> None:
    with pytest.raises(BadFile, match=r"language dee does not exist\. The nearest name is de"):
        read_language(name="dee")
    with pytest.raises(BadFile, match="this folder has no language"):
        check_words(tmp_path)
    with pytest.raises(BadFile, match="no such folder"):
        check_words(tmp_path / "words")


def test_a_locution_of_a_lab_needs_words(tmp_path: Path) -> None:
    own = (*read_rulebook().locutions, Locution("concede", ContentKind.LITERAL))
    with pytest.raises(BadFile, match=r"concede with a literal, said by the robot, have no wording"):
        read_language(locutions=own)
    text = "moves:\n" + "".join(
        f"  - {{move: concede, speaker: {side}, say: ['I give in: £content£.']}}\n" for side in Side
    )
    (language,) = check_words(lab(tmp_path, text), locutions=own)
    assert Wording(language, 0).sentence(DialogueMove("concede", ROOM_3)) == "I give in: I go to room 3 next."


def test_shipped_languages_have_simpler_words_of_their_own() -> None:
    assert languages_in(SHIPPED_LANGUAGES) == ("de", "en")
    for name in languages_in(SHIPPED_LANGUAGES):
        assert read_language(name=name).fallback is None
        wording = Wording(read_language(name=name), 0)
        assert len(wording.phrase(ROOM_3, simply=True)) < len(wording.phrase(ROOM_3))
