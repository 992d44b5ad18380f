"""The game of the page on dialogue games of one's own, in the place of a shipped one, between a robot and a person."""

import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.dialogue.argued_topics import FormalPhrasing, manners, play_to_the_end, topics
from thbridge.dialogue.arguing import ArguingEngine
from thbridge.dialogue.conditions import Manner
from thbridge.dialogue.games.contents import DialogueMove
from thbridge.dialogue.games.tables import Rulebook
from thbridge.dialogue.moves import DialogueTopic
from thbridge.files.game_files import SHIPPED_GAMES, read_rulebook

PAGE = Path(__file__).parents[3] / "docs" / "how-to" / "your-own-dialogue-game.md"
FILE = re.compile(r"^cat > games/([\w.]+) <<'END'\n(.*?)^END$", re.MULTILINE | re.DOTALL)


@pytest.fixture(name="rulebook", scope="module")
def fixture_rulebook(tmp_path_factory: pytest.TempPathFactory) -> Rulebook:
    folder = tmp_path_factory.mktemp("games")
    for name, text in FILE.findall(PAGE.read_text(encoding="utf-8")):
        (folder / name).write_text(text.replace("name: command", "name: persuasion-in-brief"))
    return read_rulebook((SHIPPED_GAMES, folder))


@given(topics(), manners, st.data())
def test_robots_and_people_play_it_to_an_end(
    rulebook: Rulebook, topic: DialogueTopic, manner: Manner, draw: st.DataObject
) -> None:
    talker = ArguingEngine(rulebook, {None: manner}, FormalPhrasing(), seed=3)
    step = play_to_the_end(talker, talker.open(1, topic), draw)
    conversation = step.dialogue.conversation
    assert conversation is not None
    said = [turn.move for turn in step.dialogue.turns if isinstance(turn.move, DialogueMove)]
    opened = [each.moves[0][1] for each in conversation.plays if each.game.name == "persuasion-in-brief"]
    assert {move.locution for move in opened} <= {"instruct"}
    assert set(opened) <= set(said)
