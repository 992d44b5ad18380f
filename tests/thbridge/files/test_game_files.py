"""Files of dialogue games and locutions: what is wrong in them is told with line and remedy, all else can be played."""

import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.dialogue.argumentation.arguments import Belief
from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.examples import jhri2015
from thbridge.dialogue.games.control import Conversation
from thbridge.dialogue.games.tables import DialogueEnd, GameTable, Rulebook
from thbridge.dialogue.rule_examples import rules_as_topics
from thbridge.files.errors import BadFile, BadFiles
from thbridge.files.game_files import SHIPPED_GAMES, read_rulebook

PERSUASION, SEEKING, INQUIRY = "persuasion.yaml", "information-seeking.yaml", "inquiry.yaml"
LOCUTIONS = "locutions.yaml"
OPENING = "{say: assert, of: topic, next: claimed}"
ACCEPT = "{say: accept, of: claim, next: agreement}"
OFFERED = """{say: accept, of: support, next: challenged, last: agreement}
      - {say: reject, of: claim, next: disagreement, questioned: reconsidered}"""
OPPOSITE = "{say: assert, of: not topic, next: countered}"

FAULTS = [
    # Words.
    (PERSUASION, "turn: respondent", "turn: respondant", "line 11, stages[1].turn: 'respondant' is not a valid choice"),
    (PERSUASION, "of: topic", "of: topics", "line 9, stages[0].replies[0].of: 'topics' is not a valid choice"),
    (PERSUASION, "say: challenge", "say: chalenge", "locution chalenge does not exist. The nearest name is challenge"),
    (PERSUASION, "next: countered", "next: counterd", "line 15, stages[1].replies[2].next: stage or end counterd does"),
    (PERSUASION, "last: agreement", "last: agree", "stage or end agree does not exist. The nearest name is agreement"),
    (PERSUASION, "about: literal", "about: thing", "line 3, about: 'thing' is not a valid choice"),
    (PERSUASION, "opening: opening", "opening: start", "line 4, opening: stage start does not exist"),
    (PERSUASION, "name: persuasion", "name:", "line 2, name: no value"),
    (PERSUASION, "name: persuasion", "name: ' '", "line 2, name: ' ' is not a valid name"),
    (PERSUASION, "name: announced", "name: ''", "stages[4].name: '' is not a valid name"),
    (PERSUASION, "name: announced", "name: agreement", "agreement is already the name of an end"),
    (PERSUASION, "name: announced", "name: challenged", "two stages have the name challenged"),
    (PERSUASION, "next: announced, last: agreement}", "next: announced, final: agreement}", "final: unknown key"),
    (PERSUASION, "name: persuasion", "name: persuasion\nmost_turns: 1", "most_turns: 1 is out of range"),
    (PERSUASION, "name: persuasion", "name: persuasion\nmost_turn: 9", "The nearest name is most_turns"),
    (PERSUASION, "stages:", "stages: [", "line 6: not YAML"),
    (PERSUASION, "opening: opening\n", "", "opening: missing"),
    # What words go together with.
    (PERSUASION, "about: literal", "about: rule", "line 3, about: this game replaces persuasion of"),
    (PERSUASION, ACCEPT, "{say: accept, of: argument, next: agreement}", "accept has no form with"),
    (
        PERSUASION,
        ACCEPT,
        f"{ACCEPT[:-1]}, last: agreement}}",
        "`last` is for the last support of a claim",
    ),
    (PERSUASION, OPPOSITE, ACCEPT, "line 15, stages[1].replies[2]: accept of claim is already a reply of this stage"),
    (INQUIRY, "say: challenge, of: claim", "say: propose, of: not topic", "a rule has no opposite"),
    (INQUIRY, "say: challenge, of: claim", "say: assert, of: unknown", "a rule has no form for not knowing"),
    (
        INQUIRY,
        "of: support, next: offered",
        "of: argument, next: offered",
        "propose has no form with",
    ),
    # Openings.
    (PERSUASION, "of: topic", "of: claim", "the first move must be about the topic, not claim"),
    (PERSUASION, "turn: initiator", "turn: respondent", "line 7, stages[0].turn: the initiator must open the game"),
    (PERSUASION, OPENING, "{say: assert, of: topic, next: agreement}", "every opening ends the game without a reply"),
    (PERSUASION, f"\n      - {OPENING}", " []", "this stage has no replies"),
    # Ways through a table.
    (PERSUASION, f"      - {OPPOSITE}\n", "", "no reply leads to the stage countered"),
    (INQUIRY, OFFERED, "{say: accept, of: support, next: offered}", "the stage challenged leads to no end"),
    (SEEKING, "turn: respondent", "turn: challenger", "line 11, stages[1].turn: the challenger may get the turn here"),
    (SEEKING, "turn: respondent", "turn: defender", "line 11, stages[1].turn: the defender may get the turn here"),
    # Replies that no play makes legal.
    (
        PERSUASION,
        OPENING,
        "{say: question, of: topic, next: claimed}",
        "accept of claim is never legal here: no earlier move",
    ),
    (
        PERSUASION,
        OPENING,
        "{say: propose, of: topic, next: claimed}",
        "challenge of claim is never legal here: no earlier",
    ),
    (SEEKING, "{say: assert, of: unknown,", "{say: accept, of: claim,", "line 15, stages[1].replies[2].of: accept of"),
    (
        PERSUASION,
        ACCEPT,
        "{say: accept, of: support, next: agreement}",
        "no earlier move states a support",
    ),
    (
        PERSUASION,
        ACCEPT,
        "{say: assert, of: argument, next: agreement}",
        "no earlier move states an argument",
    ),
    (
        PERSUASION,
        "challenged\n    turn: defender",
        "challenged\n    turn: challenger",
        "no earlier move states an argument",
    ),
    (
        PERSUASION,
        "offered\n    turn: challenger",
        "offered\n    turn: defender",
        "repeats what the other side",
    ),
    (
        SEEKING,
        "told\n    turn: initiator",
        "told\n    turn: defender",
        "line 19, stages[2].replies[0].of",
    ),
    (
        PERSUASION,
        "announced\n    turn: defender\n    replies:\n      - {say: assert, of: support, next: offered}",
        "announced\n    turn: defender\n    replies:\n      - {say: assert, of: support, next: offered}\n"
        "      - {say: accept, of: support, next: offered}",
        "stages[4].replies[1].of: accept of support is never legal here",
    ),
    (
        SEEKING,
        "{say: assert, of: support, next: offered}\n  - name: offered",
        "{say: assert, of: support, next: late}\n  - name: late\n    turn: defender\n    replies:\n"
        "      - {say: assert, of: argument, next: offered}\n  - name: offered",
        "the argument as a whole comes before its support",
    ),
    # What is questioned.
    (
        PERSUASION,
        "questioned: reconsidered",
        "questioned: reconsiderd",
        "stage reconsiderd does not exist. The nearest",
    ),
    (PERSUASION, "questioned: reconsidered", "questioned: disagreement", "stage disagreement does not exist"),
    (
        PERSUASION,
        "next: disagreement, questioned",
        "next: announced, questioned",
        "line 34, stages[5].replies[1].questioned: `questioned` is for a refusal that ends the game",
    ),
    (
        PERSUASION,
        "      - {say: reject, of: claim, next: disagreement}",
        "      - {say: reject, of: claim, next: disagreement, questioned: reconsidered}",
        "no refusal here can be questioned",
    ),
    (
        PERSUASION,
        "{say: accept, of: support, next: resumed, last: agreement}",
        "{say: accept, of: support, next: agreement, questioned: resumed}",
        "no refusal here can be questioned",
    ),
    # Games beside each other.
    (PERSUASION, "name: persuasion", "name: inquiry", "line 2, name: inquiry.yaml also has a game inquiry"),
    (INQUIRY, "about: rule", "about: literal", "which is about a rule"),
    # Locutions.
    (LOCUTIONS, "argued, news]", "arged, news]", "line 11, locutions[0].before[1]: condition arged does not exist"),
    (LOCUTIONS, "after: [claimed,", "after: [claimd,", "effect claimd does not exist. The nearest name is claimed"),
    (LOCUTIONS, "before: [held, argued", "before: [held, not held, argued", "held and not held exclude each other"),
    (LOCUTIONS, "content: literal", "content: litteral", "'litteral' is not a valid choice"),
    (LOCUTIONS, "content: unknown", "content: literal", "locutions[2]: assert of a literal is defined twice"),
    (LOCUTIONS, "of: support", "of: claim", "locutions[8].of: 'claim' is not a valid choice"),
    (LOCUTIONS, "of: support, ", "", "locutions[8]: propose of a rule is defined twice"),
    (
        LOCUTIONS,
        "before: [undecided]",
        "before: [held]",
        "line 13, locutions[2].before[0]: held is",
    ),
    (LOCUTIONS, "after: [believed, shown]", "after: [concluded]", "concluded is for content: rule; not for literal"),
    (LOCUTIONS, "after: [concluded]", "after: concluded", "a list is needed"),
    (LOCUTIONS, "name: assert", "name: ''", "locutions[0].name: '' is not a valid name"),
    (LOCUTIONS, "after: [claimed, shown, shown to be argued]", "after: [shown]", "accept of claim is never legal here"),
]


@pytest.fixture(name="folder")
def fixture_folder(tmp_path: Path) -> Path:
    return Path(shutil.copytree(SHIPPED_GAMES, tmp_path / "games"))


@pytest.mark.parametrize(("name", "old", "new", "told"), FAULTS)
def test_what_is_wrong_is_told_with_its_line(folder: Path, name: str, old: str, new: str, told: str) -> None:
    path = folder / name
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(BadFile) as caught:
        read_rulebook((SHIPPED_GAMES, folder))
    assert told in str(caught.value)
    assert all(fault.line is not None and fault.remedy for fault in _each(caught.value))


def test_one_mistake_is_told_once(folder: Path) -> None:
    path = folder / PERSUASION
    path.write_text(path.read_text().replace("next: challenged", "next: weighed"))
    with pytest.raises(BadFile) as caught:
        read_rulebook((folder,))
    assert str(caught.value).count("\n") == 0
    assert "no reply leads to the stage challenged" in str(caught.value)


def test_a_folder_needs_games_or_locutions(tmp_path: Path) -> None:
    with pytest.raises(BadFile, match="there is no such folder"):
        read_rulebook((tmp_path / "games",))
    with pytest.raises(BadFile, match="this is a file, not a folder"):
        read_rulebook((SHIPPED_GAMES / PERSUASION,))
    with pytest.raises(BadFile, match="neither games"):
        read_rulebook((SHIPPED_GAMES, tmp_path))


def test_locutions_with_which_a_shipped_game_cannot_be_played_are_at_fault_themselves(tmp_path: Path) -> None:
    path = tmp_path / LOCUTIONS
    path.write_text("locutions:\n  - {name: assert, content: literal, after: [shown]}\n")
    with pytest.raises(BadFile, match=r"with these locutions the game [a-z-]+ cannot be played") as caught:
        read_rulebook((SHIPPED_GAMES, tmp_path))
    assert caught.value.path == path


def test_a_later_folder_adds_games_and_replaces_those_of_the_same_name(tmp_path: Path) -> None:
    text = (SHIPPED_GAMES / PERSUASION).read_text()
    (tmp_path / "a.yaml").write_text(text.replace("name: persuasion", "name: persuasion\nmost_turns: 9"))
    (tmp_path / "b.yaml").write_text(text.replace("name: persuasion", "name: dispute"))
    games = read_rulebook((SHIPPED_GAMES, tmp_path)).games
    assert games.keys() == {*read_rulebook().games, "dispute"}
    assert games["persuasion"].most_turns == 9


def test_the_page_on_dialogue_games_names_all_that_is_in_the_shipped_tables() -> None:
    page = (Path(__file__).parents[3] / "docs" / "explanation" / "dialogue.md").read_text()
    rulebook = read_rulebook()
    named = {each.name for each in rulebook.locutions} | {*DialogueEnd} | {*rulebook.games["persuasion"].stages}
    assert {name for name in named if not re.search(rf"\b{name}\b", page)} == set()
    games = {name.replace("-in-brief", " in brief") for name in rulebook.games}
    assert {name for name in games if f"**{name}**" not in page.lower()} == set()


WORDS = sorted(
    {
        word
        for path in SHIPPED_GAMES.glob("*.yaml")
        for word in re.findall(r"[\w-]+|[][{}:,]", re.sub("#.*", "", path.read_text()))
    }
)


@st.composite
def mutated(draw: st.DrawFn) -> tuple[str, str]:
    """A shipped file with some words changed, and lines left out, doubled or moved."""
    name = draw(st.sampled_from(sorted(path.name for path in SHIPPED_GAMES.glob("*.yaml"))))
    lines = [line for line in (SHIPPED_GAMES / name).read_text().splitlines() if not line.startswith("#")]
    for _ in range(draw(st.integers(1, 3))):
        at = draw(st.integers(0, len(lines) - 1))
        match draw(st.sampled_from(["word", "word", "word", "drop", "double", "move"])):
            case "word":
                places = list(re.finditer(r"[\w-]+", lines[at]))
                word = draw(st.sampled_from(places)) if places else None
                if word is not None:
                    lines[at] = lines[at][: word.start()] + draw(st.sampled_from(WORDS)) + lines[at][word.end() :]
            case "drop" if len(lines) > 1:
                del lines[at]
            case "double":
                lines.insert(at, lines[at])
            case _:
                lines.insert(draw(st.integers(0, len(lines) - 1)), lines.pop(at))
    return name, "\n".join(lines) + "\n"


@given(mutated(), st.integers(0, 2**32))
def test_any_file_is_refused_with_line_and_remedy_or_every_play_of_it_ends(
    tmp_path_factory: pytest.TempPathFactory, file: tuple[str, str], seed: int
) -> None:
    folder = Path(shutil.copytree(SHIPPED_GAMES, tmp_path_factory.mktemp("mutated") / "games"))
    (folder / file[0]).write_text(file[1])
    try:
        rulebook = read_rulebook((SHIPPED_GAMES, folder))
    except BadFile as bad:
        assert all(fault.path.parent == folder and fault.line and fault.remedy for fault in _each(bad))
        return
    chance = Random(seed)
    for _ in range(200):
        _play(rulebook, chance.choice(list(rulebook.games.values())), chance)


def _play(rulebook: Rulebook, game: GameTable, chance: Random) -> None:
    start = chance.choice((*jhri2015(rulebook), *rules_as_topics(rulebook))).start
    openings = [
        (side, opening)
        for side in Side
        for topic in _topics(start, game)
        for opening in start.opening(side, game.name, topic)
    ]
    if not openings:
        return
    side, opening = chance.choice(openings)
    now = start.open(side, opening)
    while (play := now.play(1)).end is None:
        now = now.say(1, chance.choice(now.legal(1)))
    # The acceptance of a claim that follows from that of its last support is booked beside.
    assert len(play.moves) <= game.most_turns + 1


def _topics(start: Conversation, game: GameTable) -> Iterator[Belief]:
    for agent in start.agents.values():
        if game.about == "rule":
            yield from agent.beliefs.rules
        else:
            yield from (literal for held in agent.beliefs.origins for literal in (held, ~held))


def _each(fault: BadFile) -> tuple[BadFile, ...]:
    return fault.faults if isinstance(fault, BadFiles) else (fault,)
