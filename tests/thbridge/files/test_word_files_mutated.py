"""Files of words with mistakes in them: each is refused with its file and a remedy, or every move has a sentence."""

from pathlib import Path
from random import Random

import pytest

from tests.support.dialogue.random_propositions import FORMS
from thbridge.dialogue.argumentation.arguments import Argument
from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.argumentation.propositions import Literal, Rule
from thbridge.dialogue.games.contents import Content, ContentKind, DialogueMove, Unknown
from thbridge.dialogue.propositions import NextRoom, TeamPlan, Visited
from thbridge.dialogue.wording.wording import Wording
from thbridge.files.errors import BadFile
from thbridge.files.word_files import SHIPPED_LANGUAGES, read_language
from thbridge.hunt.rooms import Room

FILES = sorted((SHIPPED_LANGUAGES / "de").glob("*.yaml"))
LITERALS = [
    Literal(proposition, holds)
    for proposition in (NextRoom(0, Room(3)), NextRoom(1, Room(3)), TeamPlan(1, Room(2), 1, 12.5), Visited(Room(0)))
    for holds in (True, False)
]


def mutated(text: str, random: Random) -> str:
    """Return a text with a few mistakes: lines or characters that are gone, twice, elsewhere or others."""
    for _ in range(random.randint(1, 3)):
        lines = text.splitlines()
        at, other = random.randrange(len(lines)), random.randrange(len(lines))
        match random.randrange(5):
            case 0:
                del lines[at]
            case 1:
                lines.insert(at, lines[other])
            case 2:
                lines[at], lines[other] = lines[other], lines[at]
            case 3:
                words = lines[at].split(" ")
                words[random.randrange(len(words))] = random.choice(lines[other].split(" "))
                lines[at] = " ".join(words)
            case _:
                place = random.randrange(len(lines[at]) + 1)
                lines[at] = lines[at][:place] + random.choice("£:{}[]\",'# \t0é\\&*!-\x7f") + lines[at][place + 1 :]
        text = "\n".join(lines) + "\n"
    return text


def content(kind: str, literal: Literal) -> Content:
    """Return a content of a kind about a literal."""
    rule = Rule((literal,), ~literal)
    match kind:
        case ContentKind.RULE:
            return rule
        case ContentKind.ARGUMENT:
            return Argument(frozenset([literal, rule]), literal)
        case ContentKind.UNKNOWN:
            return Unknown(literal.proposition)
        case _:
            return literal


@pytest.mark.slow
def test_a_mistake_is_told_or_does_no_harm(tmp_path: Path) -> None:
    random, refused = Random(7), 0
    for _ in range(200):
        changed = random.choice(FILES)
        folder = tmp_path / "de"
        folder.mkdir(exist_ok=True)
        for file in FILES:
            text = file.read_text(encoding="utf-8")
            (folder / file.name).write_text(mutated(text, random) if file == changed else text, encoding="utf-8")
        try:
            language = read_language((tmp_path,), "de")
        except BadFile as fault:
            refused += 1
            assert str(fault).startswith(str(folder)) and fault.remedy
            continue
        wording = Wording(language, 0)
        for literal in LITERALS:
            for name, kind in FORMS:
                for side in Side:
                    said = wording.sentence(DialogueMove(name, content(kind, literal)), side)
                    assert said.strip() and said.isprintable()
    assert 50 < refused < 200
