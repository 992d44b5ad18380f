"""Moves priced by position in whole hunts: every robot by its own place, and nothing of it where the matrix counts."""

import json
from pathlib import Path

import pytest

from tests.support.programs.processes import run_thbridge
from thbridge.hunt.events import CostsEstimated, DialogueOpened, DialogueSaid, MoveFailed, RobotDeparted
from thbridge.hunt.game import GameState, apply, begin
from thbridge.recording.journal import read_journal

STUDY = """\
robots: 3
seed: 5
templates: sklar-azhar-2015
robot:
  move_base: {planner_patience: 1.0, controller_patience: 4.0}
things:
  - {name: closed door, shape: door, at: [7.0, -4.0, 1.5708], size: [2.0, 0.1]}
"""
BY_MATRIX = STUDY + "game: {cost_model: matrix}\n"


def hunt(folder: Path, study: str, seconds: int) -> list[tuple[GameState, object]]:
    """Play so many seconds of a hunt; each event with the state before it."""
    (folder / "study.yaml").write_text(study)
    limits = ("--port", "0", "--max-seconds", str(seconds))
    done = run_thbridge(folder, "play", "--headless", "--json", *limits, "study.yaml", "--bag", "hunt.bag")
    assert json.loads(done.stdout)["sim_seconds"] <= seconds, done.stderr
    (journal,) = (folder / "hunt.journal").glob("*.jsonl")
    game = read_journal(journal)
    events = [entry for entry in game.events if not isinstance(entry, DialogueOpened | DialogueSaid)]
    state, told = begin(game.started), []
    for event in events:
        told.append((state, event))
        state = apply(state, event)
    return told


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("hunt")


@pytest.fixture(scope="module")
def told(folder):
    return hunt(folder, STUDY, 80)


@pytest.mark.slow
def test_every_robot_is_priced_at_its_own_start_before_it_is_asked(told):
    first = next(at for at, (_, event) in enumerate(told) if not isinstance(event, CostsEstimated))
    rows = {event.robot: event.costs for _, event in told[:first]}
    assert set(rows) == {0, 1, 2}
    assert len(set(rows.values())) == 3


@pytest.mark.slow
def test_a_move_costs_what_was_told_last_and_a_robot_that_failed_is_priced_where_it_stands(told):
    departures = [(state, event) for state, event in told if isinstance(event, RobotDeparted)]
    assert departures and all(event.cost == state.cost(event.robot, event.room) for state, event in departures)
    failed = [at for at, (_, event) in enumerate(told) if isinstance(event, MoveFailed)]
    assert failed
    for at in failed:
        _, event = told[at]
        after = (later for _, later in told[at + 1 :] if getattr(later, "robot", None) == event.robot)
        assert isinstance(next(after, None), CostsEstimated)


@pytest.mark.slow
def test_the_recording_is_played_again_bit_for_bit(told, folder):
    done = run_thbridge(folder, "replay", "hunt.bag")
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.slow
def test_with_the_matrix_places_alone_have_a_price(tmp_path):
    told = hunt(tmp_path, BY_MATRIX, 3)
    assert not any(isinstance(event, CostsEstimated) for _, event in told)
    row = told[0][0].started.costs.rows[0]
    starts = [event for _, event in told if isinstance(event, RobotDeparted)][:3]
    assert [event.cost for event in starts] == [row[event.room.people] for event in starts]
