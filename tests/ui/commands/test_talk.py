"""`thbridge talk`."""

import json
import shutil
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.programs.commands import invoke
from thbridge.dialogue.examples import jhri2015
from thbridge.dialogue.games.dialogue_game import GameUtterance
from thbridge.dialogue.games.locutions import CONDITIONS, EFFECTS
from thbridge.dialogue.games.tables import DialogueEnd, GameRole, Slot
from thbridge.dialogue.rule_examples import rules_as_topics
from thbridge.dialogue.wording.lines import LineKey
from thbridge.dialogue.wording.predicates import PREDICATES
from thbridge.dialogue.wording.wording import Wording
from thbridge.files.game_files import SHIPPED_GAMES, read_rulebook
from thbridge.files.word_files import read_language
from ui.commands.talk.examples import TerminalTalk


def talk(*arguments: object, code: int = 0, typed: str | None = None) -> str:
    done = invoke("talk", *arguments, input=typed)
    assert done.exit_code == code, done.output
    return done.stdout


EXAMPLE = ("--example", "jhri2015")
EXCHANGES = jhri2015(read_rulebook())


def said(exchange: int, *more: object, example: str = "jhri2015", typed: str | None = None) -> list[dict[str, object]]:
    told = talk("--example", example, "--exchange", exchange, "--json", *more, typed=typed)
    return [json.loads(line) for line in told.splitlines()]


@pytest.mark.parametrize(
    ("example", "number"),
    [*(("jhri2015", number) for number in (1, 2, 4, 5)), *(("rules", number) for number in (1, 2, 3))],
)
def test_two_programs_say_just_what_the_example_says(example: str, number: int) -> None:
    told = said(number, "--human", "program", example=example)
    moves = [(each["side"], each["locution"]) for each in told if not each["booked"]]
    course = (EXCHANGES if example == "jhri2015" else rules_as_topics(read_rulebook()))[number - 1].course
    assert moves == [(side, text.partition("(")[0]) for side, (text,) in course]
    for each, (_, (text,)) in zip([each for each in told if not each["booked"]], course, strict=True):
        assert each["content"] in text


def test_the_fourth_exchange_has_a_dialogue_inside_another_and_one_acceptance_follows_by_itself() -> None:
    told = said(4, "--human", "program")
    assert [each["dialogue"] for each in told if each["dialogue"] != 2] == [1] * 5 + [3] * 2
    assert {each["parent"] for each in told if each["dialogue"] == 3} == {2}
    (booked,) = [each for each in told if each["booked"]]
    assert (booked["locution"], booked["after"]) == ("accept", "agreement")
    assert told[-1] == booked
    shown = talk(*EXAMPLE, "--exchange", 4, "--human", "program")
    assert "    Dialogue 3 opens: persuasion about order(1, Room1), inside dialogue 2, which is paused" in shown
    assert "      human: accept(order(1, Room1))" in shown


def test_a_seed_chooses_among_the_ways_that_the_third_exchange_leaves_open() -> None:
    wording = Wording(read_language(), 0)

    def way(seed: int) -> tuple[str, ...]:
        heard: list[GameUtterance] = []
        TerminalTalk(EXCHANGES[2], frozenset(), None, seed, wording, lambda _: None, heard.append).play()
        return tuple(str(each.move) for each in heard)

    # The robot gives in at once, or to each of three reasons, or to none of them.
    assert len({way(seed) for seed in range(60)}) == 7
    assert way(5) == way(5)


def test_a_person_chooses_by_numbers_and_is_told_openings_and_ends() -> None:
    told = talk(*EXAMPLE, "--exchange", 2, typed="2\n1\n1\n2\nn\n")
    assert "Dialogue 1 opens: persuasion about selected(Room3)" in told
    assert "  2  challenge(selected(Room3))" in told
    assert "  human: reject(selected(Room3))\n" in told
    assert "Dialogue 1 ends: disagreement" in told
    told = talk(*EXAMPLE, "--exchange", 1, typed="1\n")
    assert '  human: accept(selected(Room3))\n    "All right, room 3."\nDialogue 1 ends: agreement' in told


def test_a_person_may_be_the_robot_and_sees_stores_and_beliefs() -> None:
    told = talk(*EXAMPLE, "--exchange", 5, "--robot", "person", "--human", "program", typed="1\ns\nb\nq\n")
    assert '1  question(in_image(bottle, image5))   "Does picture 5 show a bottle?"   (opens information' in told
    assert "said by the robot: question(in_image(bottle, image5))" in told
    assert "said by the human: assert(U(in_image(bottle, image5)))" in told
    assert "believes that the other does not know: in_image(bottle, image5)" in told


@settings(max_examples=12)
@given(st.lists(st.one_of(st.integers(0, 6).map(str), st.sampled_from(["n", "s", "b", "?", "", "²", "1 2", "\x00"]))))
def test_any_typing_is_taken_and_the_end_of_it_is_no_fault(lines: list[str]) -> None:
    people = ("--robot", "person", "--human", "person")
    talk(*EXAMPLE, *people, "--exchange", 4, typed="".join(f"{line}\n" for line in lines))


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (("--seed", 1), "--example: the example is missing."),
        ((*EXAMPLE, "--exchange", 6), "--exchange: there is no exchange 6. The example has exchanges 1 to 5."),
        ((*EXAMPLE, "--game", "chess"), "--game: there is no game chess. Choose one of "),
        ((*EXAMPLE, "--games", "nowhere"), "nowhere: there is no such folder."),
        ((*EXAMPLE, "--language", "tlh"), "language tlh does not exist."),
    ],
)
def test_what_cannot_be_talked_about_is_told(options: tuple[object, ...], told: str) -> None:
    done = invoke("talk", *options)
    assert done.exit_code == 2
    assert told in done.stderr


def test_the_shipped_games_are_told_with_their_ends() -> None:
    told = talk("check")
    assert "persuasion, about a literal; it ends after at most 60 moves" in told
    assert "ends: agreement, disagreement, unknown; stalemate," in told
    assert f"{len(read_rulebook().games)} games, no languages, no faults" in told


def test_moves_are_said_in_a_language(tmp_path: Path) -> None:
    told = talk(*EXAMPLE, "--exchange", 5, "--human", "program", "--language", "de")
    assert '  robot: question(in_image(bottle, image5))\n    "Ist auf Bild 5 eine Flasche zu sehen?"' in told
    (tmp_path / "en").mkdir()
    (tmp_path / "en" / "moves.yaml").write_text(
        "moves: [{move: challenge, speaker: human, of: selected, holds: true, say: [Why £content£?]}]\n"
    )
    told = talk(*EXAMPLE, "--exchange", 2, "--human", "program", "--words", tmp_path)
    assert '  human: challenge(selected(Room3))\n    "Why we search room 3?"' in told
    assert "languages: en (English)" in talk("check", tmp_path)
    (tmp_path / "en" / "moves.yaml").write_text("moves: [{move: chalenge, speaker: human, say: [Why £content£?]}]\n")
    assert "moves.yaml, line 1," in talk("check", tmp_path, code=2)


def test_what_texts_of_a_language_are_missing_or_wrong_is_told(tmp_path: Path) -> None:
    (tmp_path / "nl" / "texts").mkdir(parents=True)
    (tmp_path / "de" / "texts").mkdir(parents=True)
    (tmp_path / "nl" / "ours.yaml").write_text("language: {title: Nederlands, falls_back_on: en}\n")
    (tmp_path / "nl" / "texts" / "words.yaml").write_text("last: ' en '\n")
    (tmp_path / "de" / "texts" / "words.yaml").write_text("rooms: [£count£ Zimmer, £count£ Zimmer]\n")
    told = talk("check", tmp_path)
    assert "languages: de (Deutsch), nl (Nederlands)\nlanguage nl: " in told
    assert "texts are missing and are shown in English, first " in told
    assert "language de" not in told
    (tmp_path / "nl" / "texts" / "words.yaml").write_text("lest: ' en '\n")
    assert "text words.lest does not exist. The nearest name is words.last" in talk("check", tmp_path, code=2)


def test_a_no_may_be_questioned_and_the_dialogue_that_has_ended_goes_on() -> None:
    typed = "1\n2\n1\n1\n2\n2\n3\n1\nq\n"
    told = talk(*EXAMPLE, "--exchange", 2, "--robot", "person", typed=typed)
    level = "current_energy_level(1000)"
    course = [
        "human: reject(selected(Room3))",
        "Dialogue 1 ends: disagreement, a content was rejected",
        f"Dialogue 2 opens: information-seeking about not {level}, inside dialogue 1, which is paused",
        f"robot: question(not {level})",
        f"human: assert(U({level}))",
        "Dialogue 2 ends: unknown, the side that was asked does not know",
        f"human: accept({level})",
    ]
    assert [line.strip() for line in told.splitlines() if line.strip() in course] == course


def test_of_a_folder_only_its_own_games_are_told(tmp_path: Path) -> None:
    text = (SHIPPED_GAMES / "persuasion.yaml").read_text()
    (tmp_path / "dispute.yaml").write_text(text.replace("name: persuasion", "name: dispute"))
    (told,) = json.loads(talk("check", tmp_path, "--json"))["folders"]
    assert [game["name"] for game in told["games"]] == ["dispute"]
    assert told["games"][0]["stages"][0] == {
        "name": "opening",
        "turn": "initiator",
        "replies": [{"say": "assert", "of": "topic", "next": "claimed", "last": None, "questioned": None}],
    }
    shown = [line.strip() for line in talk("check", tmp_path).splitlines()]
    assert "reject claim -> disagreement; reconsidered, when the refusal is questioned" in shown


def test_faults_of_all_folders_are_told_with_their_lines(tmp_path: Path) -> None:
    for name, word in (("a", "iniator"), ("b", "respondent")):
        folder = Path(shutil.copytree(SHIPPED_GAMES, tmp_path / name))
        file = folder / "inquiry.yaml"
        file.write_text(file.read_text().replace("turn: initiator", f"turn: {word}"))
    told = talk("check", tmp_path / "a", tmp_path / "b", code=2)
    assert f"{tmp_path}/a/inquiry.yaml, line 7, stages[0].turn: 'iniator' is not a valid choice." in told
    assert f"{tmp_path}/b/inquiry.yaml, line 7, stages[0].turn: the initiator must open the game." in told
    (fault,) = json.loads(talk("check", tmp_path / "b", "--json", code=2))["folders"][0]["faults"]
    assert (fault["line"], fault["remedy"]) == (7, "Write initiator")


def test_every_word_of_the_files_is_explained() -> None:
    told = {line.strip().split("  ")[0] for line in talk("words").splitlines()}
    assert told >= {*CONDITIONS, *EFFECTS, *Slot, *GameRole, *DialogueEnd, *PREDICATES, *LineKey}


STRATEGIES = """
class First:
    def __init__(self, manner, seed):
        pass

    def choose(self, conversation, number):
        return conversation.legal(number)[0]


class Silent(First):
    def choose(self, conversation, number):
        return None
"""


@pytest.mark.slow
def test_a_strategy_that_is_installed_is_checked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "lab_of_talk-1.0.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: lab-of-talk\nVersion: 1.0\n")
    (folder / "entry_points.txt").write_text(
        "[thbridge.strategies]\nfirst = lab_of_talk:First\nsilent = lab_of_talk:Silent\n"
    )
    (tmp_path / "lab_of_talk.py").write_text(STRATEGIES)
    monkeypatch.syspath_prepend(str(tmp_path))
    assert ", no faults" in talk("check", "--strategy", "first", "--conversations", 1)
    told = json.loads(talk("check", "--strategy", "silent", "--conversations", 1, "--json", code=2))
    (fault,) = told["strategy"]["faults"]
    assert not told["ok"] and fault["problem"] == "a NoneType is no move" and "legal(number)" in fault["remedy"]
    done = invoke("talk", "check", "--strategy", "sillent")
    assert done.exit_code == 2 and "The nearest name is silent" in done.output


AUTHORS = """
def polite(request):
    print("worded")
    return "Please note: " + request.sentence


def liar(request):
    return request.sentence.replace("not ", "")


def fickle(request, times=[0]):
    times[0] += 1
    return request.sentence + "!" * (times[0] % 2)
"""


@pytest.mark.slow
def test_an_author_that_is_installed_is_checked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "lab_of_words-1.0.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: lab-of-words\nVersion: 1.0\n")
    names = ("polite", "liar", "fickle")
    (folder / "entry_points.txt").write_text(
        "[thbridge.wordings]\n" + "".join(f"{name} = lab_of_words:{name}\n" for name in names)
    )
    (tmp_path / "lab_of_words.py").write_text(AUTHORS)
    monkeypatch.syspath_prepend(str(tmp_path))
    told = json.loads(talk("check", "--author", "polite", "--conversations", 1, "--json"))
    assert told["ok"] and told["author"]["taken"] == told["author"]["sentences"] > 100
    refused = talk("check", "--author", "liar", "--conversations", 1, code=2)
    assert "liar: a sentence is refused (other-values) (" in refused and "it has to say, in this order: not" in refused
    assert "gave different sentences" in talk("check", "--author", "fickle", "--conversations", 1, code=2)
    done = invoke("talk", "check", "--author", "lier")
    assert done.exit_code == 2 and "The nearest name is liar" in done.output
