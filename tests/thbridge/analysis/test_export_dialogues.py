"""Tables of dialogues in which robots argued."""

from collections.abc import Sequence

import numpy as np
import pytest

from tests.support.dialogue import recorded_dialogues
from thbridge.analysis.export.exporting import ExportSummary, export
from thbridge.dialogue.moves import DialogueUtterance
from thbridge.recording.bag.records import BagConnection
from thbridge.ros.messages.types import plain_definition
from thbridge.ros.publisher import messages_of

Row = dict[str, object]


def tables(*ticks: tuple[DialogueUtterance, ...], broken: bool = False) -> dict[str, list[Row]]:
    """The rows of all tables of what is said, a tick a second."""
    messages = [
        (made.topic, second, made.data)
        for second, records in enumerate(recorded_dialogues.recorded(*ticks))
        for record in records
        for made in messages_of(0, 0, record)
    ]
    known = {topic.name: connection(number, topic.name, topic.msgtype) for number, (topic, _, _) in enumerate(messages)}
    stream = (
        (known[topic.name], second * 10**9, data.replace(b'"games"', b'"gamez"') if broken else data)
        for topic, second, data in messages
    )
    found: dict[str, list[Row]] = {}
    for piece in export(stream, 0, ExportSummary()):
        names = [column.name for column in piece.table.columns]
        values = [each if isinstance(each, list) else np.asarray(each).tolist() for each in piece.values]
        rows = [dict(zip(names, row, strict=True)) for row in zip(*values, strict=True)]
        found.setdefault(piece.table.name, []).extend(rows)
    return found


def connection(number: int, topic: str, msgtype: str) -> BagConnection:
    plain = plain_definition(msgtype)
    return BagConnection(number, topic, msgtype, plain.md5, plain.text, None, None)


def changed(rows: Sequence[Row], change: str, holder: str, second: float) -> list[object]:
    return [row["literal"] for row in rows if (row["change"], row["holder"], row["t_s"]) == (change, holder, second)]


@pytest.fixture(scope="module")
def stubborn() -> dict[str, list[Row]]:
    return tables(*recorded_dialogues.utterances())


def test_each_game_is_a_row_with_its_course_and_who_gave_in(stubborn: dict[str, list[Row]]) -> None:
    first, *_, last = stubborn["dialogue_games"]
    about = {"robot": 1, "talk": 1, "parent": 0, "topic": "next(Robot1, Room1)", "opener": "human"}
    assert about.items() <= first.items() and about.items() <= last.items()
    assert (first["dialogue"], first["end"], first["challenges"], first["gave_in"]) == (1, "disagreement", 1, "")
    assert (last["end"], last["gave_in"]) == ("agreement", "robot")
    # She challenges after a second, and rejects after another.
    assert (first["t_s"], first["until_s"], first["replied_s"]) == (0.0, 2.0, 2.0)


def test_beliefs_before_and_after_each_move_can_be_told(stubborn: dict[str, list[Row]]) -> None:
    rows = stubborn["dialogue_beliefs"]
    (given_in,) = {row["t_s"] for row in stubborn["dialogue_moves"] if row["after"] == "agreement"}
    assert isinstance(given_in, float)
    assert {row["t_s"] for row in rows} == {row["t_s"] for row in stubborn["dialogue_moves"]}
    assert {row["change"] for row in rows if row["t_s"] == 0.0} == {"first"}
    assert "next(Robot1, Room1)" in changed(rows, "gained", "robot", given_in)
    assert "not next(Robot1, Room1)" in changed(rows, "lost", "robot", given_in)
    assert "not next(Robot1, Room1)" in changed(rows, "kept", "robot", given_in - 1.0)
    (claim,) = [row for row in rows if row["t_s"] == 0.0 and row["literal"] == "next(Robot1, Room1)"]
    assert (claim["holder"], claim["source"]) == ("human", "held")


def test_recordings_without_such_dialogues_have_no_such_tables() -> None:
    assert not tables()


def test_states_of_another_release_leave_the_rest_as_it_is() -> None:
    found = tables(*recorded_dialogues.utterances(), broken=True)
    assert found["dialogue_states"]
    assert len(found["dialogue_games"]) > 1
    assert not found.get("dialogue_beliefs")
