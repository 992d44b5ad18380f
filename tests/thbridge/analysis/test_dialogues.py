"""Dialogues in which robots argue, in reports."""

from collections.abc import Iterable
from dataclasses import replace

import pytest

from tests.support.dialogue import recorded_dialogues
from tests.thbridge.analysis.reported_drive import Recorded, recorded
from thbridge.analysis.report.builder import read_report
from thbridge.analysis.report.dialogues import RecordedGame, count_ends
from thbridge.analysis.report.report import Report
from thbridge.analysis.report_page.page import render
from thbridge.dialogue.conditions import DialogueCondition, Manner
from thbridge.ros.messages.records import Record
from thbridge.ros.publisher import messages_of


def of(ticks: Iterable[Iterable[Record]]) -> Report:
    messages: list[Recorded] = [
        recorded(made.topic.name, made.topic.msgtype, second, made.data)
        for second, records in enumerate(ticks)
        for record in records
        for made in messages_of(0, 0, record)
    ]
    return read_report(messages)


@pytest.fixture(scope="module")
def stubborn() -> Report:
    return of(recorded_dialogues.recorded(*recorded_dialogues.utterances()))


def test_games_are_told_with_their_ends_and_with_who_gave_in(stubborn: Report) -> None:
    assert stubborn.missing and not [each for each in stubborn.missing if "dialogue" in each]
    first, *_, last = stubborn.dialogues.games
    kind = "persuasion-in-brief"
    about = (1, 0, "next(Robot1, Room1)")
    assert first == RecordedGame(0, 1, kind, "human", "disagreement", 5, 1, "", *about, 0.0, 2.0, 2.0)
    assert (last.kind, last.opener, last.end, last.gave_in) == (kind, "human", "agreement", "robot")
    assert count_ends(stubborn.dialogues.games) == {"agreement": 1, "disagreement": len(stubborn.dialogues.games) - 1}


def test_moves_are_counted_by_speaker_and_locution(stubborn: Report) -> None:
    said = [each for tick in recorded_dialogues.utterances() for each in tick]
    assert sum(stubborn.dialogues.moves.values()) == sum(bool(each.formal) for each in said)
    assert stubborn.dialogues.moves["human", "reject"] == 1
    assert stubborn.dialogues.moves["robot", "accept"] >= 1


def test_a_game_that_is_left_is_withdrawn_and_one_that_goes_on_unfinished() -> None:
    left = of(recorded_dialogues.recorded(*recorded_dialogues.utterances(recorded_dialogues.LEAVES)))
    assert [game.end for game in left.dialogues.games] == ["withdrawn"]
    goes_on = of(recorded_dialogues.recorded(*recorded_dialogues.utterances(recorded_dialogues.LEAVES[:1])))
    assert [game.end for game in goes_on.dialogues.games] == ["unfinished"]


def test_questions_overrides_and_what_is_misheard_are_counted() -> None:
    adviser = Manner(DialogueCondition.ADVISER, persistence=1)
    dialogues = of(recorded_dialogues.recorded(*recorded_dialogues.utterances(("Override()",), adviser))).dialogues
    assert (dialogues.questions, dialogues.overrides, dialogues.misheard) == (0, 1, 0)
    asked = of(recorded_dialogues.recorded(*recorded_dialogues.utterances(("OpenQuestions()", "Enquire("), adviser)))
    assert asked.dialogues.questions == 1
    misheard = of(
        recorded_dialogues.recorded(
            *recorded_dialogues.utterances(recorded_dialogues.STUBBORN[:1], Manner(misheard=1.0))
        )
    )
    assert misheard.dialogues.misheard == 1
    (entry,) = [entry for entry in misheard.timeline if entry.kind == "misheard"]
    assert entry.who == "robot 1" and entry.text


def test_a_strategy_that_failed_is_told_and_counted(stubborn: Report) -> None:
    ticks = [[replace(said, fault="a str is no move") for said in tick] for tick in recorded_dialogues.utterances()[:1]]
    failed = of(recorded_dialogues.recorded(*map(tuple, ticks)))
    entries = [entry for entry in failed.timeline if entry.kind == "strategy failed"]
    assert failed.dialogues.strategy_faults == len(entries) > 0 == stubborn.dialogues.strategy_faults
    assert entries[0].text == "a str is no move"
    assert f"Strategy failed: {len(entries)}." in render([failed], "a.bag")


def test_the_page_has_a_part_on_dialogues_only_where_robots_argued(stubborn: Report) -> None:
    page = render([stubborn], "a.bag")
    assert "<h2>Dialogues</h2>" in page
    assert "<td>persuasion-in-brief</td><td>participant</td>" in page
    assert "Questions asked: 0. Advice overridden: 0. Misheard: 0." in page
    assert "<h2>Dialogues</h2>" not in render([replace(stubborn, dialogues=of(()).dialogues)], "a.bag")
