"""A hunt in which robots argue: recorded, looked into, exported, reported, and run again bit for bit."""

import asyncio
import dataclasses
import os
import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from pyarrow import parquet

from thbridge.analysis.export.folder import export_bag
from thbridge.analysis.report.builder import read_report
from thbridge.app.compose.game import build_bot
from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.app.play import HuntUnfinished, PlayOptions, play
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.dialogue.portrait import read_portrait
from thbridge.files.tables.table_files import TableFormat
from thbridge.recording.bag.reading.reader import messages
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.view import AnswerDialogue, ParticipantRequest, View
from thbridge.ros import names
from thbridge.ros.messages import unpack
from thbridge.study.study_file import DialogueSection, MannerSection, Study

DOCUMENT = Path(__file__).parents[4] / "docs" / "reference" / "bags.md"
SECONDS = 2.0
DOUBTS_UNTIL = 5
STUDY = dataclasses.replace(
    Study(),
    seed=7,
    robots=2,
    dialogue=DialogueSection(DialogueCondition.COLLABORATOR, MannerSection(misheard=0.2)),
    server=dataclasses.replace(Study().server, port=0),
)


class Doubter:
    """Participant who wants the nearest rooms; of several replies she gives the second one, until she insists."""

    def __init__(self, setting: StudySetting) -> None:
        self._bot = build_bot(setting.templates, BotStrategy.NEAREST, setting.study.seed)

    def requests(self, view: View) -> Sequence[ParticipantRequest]:
        doubted = {each.dialogue for each in view.dialogues if len(each.choices) > 2 and each.turn < DOUBTS_UNTIL}
        return [
            AnswerDialogue(asked.dialogue, asked.turn, 1)
            if isinstance(asked, AnswerDialogue) and asked.dialogue in doubted
            else asked
            for asked in self._bot.requests(view)
        ]


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("argued") / "hunt.bag"
    setting = read_setting(STUDY, Path())
    options = PlayOptions(0.0, path, frozenset(), "suggestion", SECONDS)
    with pytest.raises(HuntUnfinished):
        asyncio.run(play(setting, (TabUI(Doubter(setting)),), options, lambda where: None, lambda tick_record: None))
    return path


def said(bag: Path, topic: str) -> list[Any]:
    reads = {
        names.UTTERANCES: unpack.utterance,
        names.DIALOGUE_MOVES: unpack.dialogue_move,
        names.DIALOGUE_STATES: unpack.dialogue_state,
    }
    return [reads[topic](message.data) for message in messages(bag, [topic])]


def test_moves_and_states_stand_beside_what_was_said(bag: Path) -> None:
    utterances, moves = said(bag, names.UTTERANCES), said(bag, names.DIALOGUE_MOVES)
    assert {"challenge", "reject", "accept"} <= {utterance.move for utterance in utterances}
    texts = {(utterance.dialogue, utterance.text) for utterance in utterances}
    assert {(move.talk, move.text) for move in moves if not move.is_booked} <= texts
    assert {move.robot for move in moves} == {0, 1}
    assert any(move.heard for move in moves)
    last = {state.robot: read_portrait(state.json) for state in said(bag, names.DIALOGUE_STATES)}
    for robot, portrait in last.items():
        *_, move = (move for move in moves if move.robot == robot)
        assert portrait.games[-1].number == move.dialogue and portrait.sigma


@pytest.mark.slow
def test_the_hunt_is_the_same_again_in_another_process_with_another_order_of_sets(bag: Path) -> None:
    command = [sys.executable, "-c", "from ui.cli import main; main()", "replay", str(bag)]
    seeds = {"PYTHONHASHSEED": "12345"}
    done = subprocess.run(command, env={**os.environ, **seeds}, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "are the same, bit for bit" in done.stdout


def test_moves_and_states_are_tables_with_all_their_columns(bag: Path, tmp_path: Path) -> None:
    export_bag(bag, tmp_path / "out", (TableFormat.PARQUET,), {names.DIALOGUE_MOVES, names.DIALOGUE_STATES})
    moves = parquet.read_table(tmp_path / "out" / "dialogue_moves.parquet")
    assert moves["content"].to_pylist() == [move.content for move in said(bag, names.DIALOGUE_MOVES)]
    assert {"talk", "dialogue", "parent", "locution", "before", "after", "booked", "heard"} <= set(moves.column_names)
    # The game of the hunt, and that of the dialogue.
    assert set(moves["game"].to_pylist()) == {1}
    assert moves["game_"].to_pylist() == [move.game for move in said(bag, names.DIALOGUE_MOVES)]
    states = parquet.read_table(tmp_path / "out" / "dialogue_states.parquet")
    assert [read_portrait(text) for text in states["json"].to_pylist()]


def test_the_report_counts_every_move_of_the_recording(bag: Path) -> None:
    dialogues = read_report(messages(bag)).dialogues
    moves = [move for move in said(bag, names.DIALOGUE_MOVES) if not move.is_booked]
    assert sum(dialogues.moves.values()) == len(moves) == sum(game.moves for game in dialogues.games)
    assert dialogues.misheard == sum(bool(move.heard) for move in moves) > 0
    assert {"agreement", "disagreement"} <= {game.end for game in dialogues.games}
    # Whoever insists for long enough persuades a robot, in a dialogue after that in which it said no.
    assert "robot" in {game.gave_in for game in dialogues.games}


def test_the_document_tells_how_to_read_what_stands(bag: Path) -> None:
    (recipe,) = re.findall(r"```python\n((?:(?!```).)*?def standing.*?)```", DOCUMENT.read_text("utf-8"), re.DOTALL)
    told: dict[str, Any] = {}
    exec(recipe, told)
    standing = list(told["standing"](bag))
    assert len(standing) == len(said(bag, names.DIALOGUE_STATES))
    assert any(conclusions for _, _, conclusions in standing)
    assert {robot for _, robot, _ in standing} == {1, 2}
