"""Progress of long commands outside a terminal."""

import json
from itertools import count

import pytest

from ui.command_line.options import ProgressKind
from ui.command_line.progress import ProgressLines, shown_progress


def test_a_line_counts_what_is_done_and_estimates_the_rest() -> None:
    lines = ProgressLines("trips", 100.0)
    assert lines.sentence(130.0) == "trips: 30 s elapsed"
    lines.take("trips", 10, 90, 160.0)  # ten were there before: they say nothing about the rate
    assert lines.sentence(160.0) == "trips: 10 of 90 (11%), 1 min elapsed"
    lines.take("trips", 30, 90, 280.0)
    assert lines.sentence(280.0) == "trips: 30 of 90 (33%), 3 min elapsed, about 6 min left"
    assert json.loads(lines.as_json(280.0)) == {
        "task": "trips",
        "done": 30,
        "total": 90,
        "elapsed_seconds": 180.0,
        "seconds_left": 360.0,
    }


def test_a_total_that_is_unknown_is_left_out() -> None:
    lines = ProgressLines("play", 100.0)
    lines.take("simulated seconds", 30, 0, 100.0)
    lines.take("simulated seconds", 90, 0, 160.0)
    assert lines.sentence(160.0) == "simulated seconds: 90, 1 min elapsed"
    told = json.loads(lines.as_json(160.0))
    assert (told["done"], told["total"], told["seconds_left"]) == (90, None, None)


@pytest.mark.parametrize("kind", list(ProgressKind))
def test_lines_come_while_the_work_goes_on(kind: ProgressKind, capsys: pytest.CaptureFixture[str]) -> None:
    told = ""
    with shown_progress(kind, "games", every=0.001) as tell:
        for done in count():
            tell("games", done, 10**9)
            if "\n" in (told := told + capsys.readouterr().err):
                break
    line = told.splitlines()[0]
    if kind is ProgressKind.JSON:
        assert json.loads(line)["task"] == "games"
    else:
        assert line.startswith("games: ")
