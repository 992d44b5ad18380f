"""Tables of games: decisions, reliance and fluency are what a hand-made game says; recordings are read as they were."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

from sim.common.robot_numbers import number_of
from tests.support.studies.experiment_files import WITH_GAMES
from tests.support.studies.rehearsed_studies import rehearse
from thbridge.experiment.allocation.places import Place
from thbridge.experiment.design.plan import PlannedStep
from thbridge.experiment.design.steps import StepEntry, StepKind
from thbridge.experiment.export.families.attempts import Attempt
from thbridge.experiment.export.families.attention import AttentionFigures, figures_of
from thbridge.experiment.export.families.decisions import GameDecision, decisions_of
from thbridge.experiment.export.families.forms import GivenScore
from thbridge.experiment.export.families.game_recording import (
    GameRecording,
    TimedEvent,
    TimedMove,
    TimedUtterance,
    read_game,
)
from thbridge.experiment.export.tables import game_tables, log_tables, records_of
from thbridge.experiment.progress import Run
from thbridge.experiment.questionnaires.form import Item, Scoring
from thbridge.experiment.rehearsal.people import SimulatedPeople
from thbridge.experiment.store.event_log import read_log
from thbridge.experiment.store.events import EventKind
from thbridge.hunt import game
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.events import (
    Commander,
    CommanderChanged,
    EndReason,
    Event,
    GameEnded,
    GameStarted,
    RobotArrived,
    RobotDeparted,
    RoomAdvised,
    TreasureIdentified,
    TreasureSensed,
    TreasuresHidden,
)
from thbridge.hunt.rooms import Room
from thbridge.hunt.treasures import TreasureKind
from thbridge.recording.bag.options import RecordingFormat
from thbridge.ros.messages.session_records import DialogueMoveRecord, UtteranceRecord

ROOMS = 4
Told = Event | UtteranceRecord | DialogueMoveRecord


def recorded(told: Sequence[tuple[float, Told]], robots: int = 1, energy: float = 100.0) -> GameRecording:
    costs = CostMatrix(tuple(tuple(5.0 for _ in range(ROOMS + 1)) for _ in range(ROOMS + 1)))
    start = GameStarted(1, 1, robots, energy, 5.0, 1.0, 1.0, costs)
    state, recording = game.begin(start), GameRecording()
    recording.happenings.append(TimedEvent(0.0, start, state, state))
    for time, each in told:
        if isinstance(each, UtteranceRecord):
            recording.happenings.append(TimedUtterance(time, each))
        elif isinstance(each, DialogueMoveRecord):
            recording.happenings.append(TimedMove(time, each))
        else:
            after = game.apply(state, each)
            recording.happenings.append(TimedEvent(time, each, state, after))
            state = after
        recording.duration = time
    return recording


def said(speaker: str, room: int, move: str, robot: int = 0, scenario: str = "select-room", talk: int = 1):
    return UtteranceRecord(talk, speaker, robot, room, scenario, f"{move} {room}", move, speaker)


def moved(speaker: str, locution: str, content: str, robot: int = 0) -> DialogueMoveRecord:
    return DialogueMoveRecord(
        1, 1, None, 0, robot, speaker, speaker, "persuasion", locution, content, "", "", False, "", ""
    )


def advised(room: int, planned: int, robot: int = 0) -> RoomAdvised:
    return RoomAdvised(robot, Room(room), 1, Room(planned), room != planned, 0.8)


def goes(room: int, robot: int = 0) -> RobotDeparted:
    return RobotDeparted(robot, Room(room), 5.0)


def decided(*told: tuple[float, Told]) -> GameDecision:
    return next(decisions_of(recorded(told)))


@pytest.mark.parametrize(
    ("planned", "chosen", "right", "agreed", "appropriate"),
    [(2, 2, True, True, True), (3, 2, False, True, False), (2, 3, True, False, False), (3, 4, False, False, True)],
)
def test_reliance_is_appropriate_when_right_advice_is_taken_and_wrong_is_not(
    planned: int, chosen: int, right: bool, agreed: bool, appropriate: bool
) -> None:
    made = decided(
        (2.0, advised(2, planned)),
        (2.0, said("robot", 2, "ask")),
        (6.0, said("human", chosen, "stop")),
        (6.1, goes(chosen)),
    )
    assert (made.advice, made.advice_from, made.is_right) == ("2", "asked", right)
    assert (made.agreed, made.is_appropriate) == (agreed, appropriate)
    assert (made.shown, made.advised, made.chosen) == (0.0, 2.0, 6.0)
    assert made.options == ("1", "2", "3", "4")
    assert made.switched is None


@pytest.mark.parametrize(("chosen", "switched"), [(1, False), (2, True)])
def test_a_choice_that_was_argued_against_is_kept_or_switched(chosen: int, switched: bool) -> None:
    made = decided(
        (1.0, said("human", 1, "assert")),
        (1.0, moved("human", "assert", "next(Robot1, Room1)")),
        (1.0, moved("robot", "assert", "not next(Robot1, Room1)")),
        (1.0, moved("robot", "assert", "next(Robot1, Room2)")),
        (4.0, said("human", chosen, "accept")),
        (4.1, goes(chosen)),
    )
    # All rooms cost the same, so the planner's is the first one: the robot argues for a wrong one.
    assert (made.first_choice, made.advice, made.advice_from, made.is_right) == ("1", "2", "argued", False)
    assert (made.disagreed, made.switched, made.is_appropriate) == (True, switched, not switched)


def test_who_decides_is_told_apart() -> None:
    alone = decided((9.0, said("robot", 1, "decide-alone")), (9.0, goes(1)))
    last_word = decided(
        (1.0, said("human", 1, "assert")),
        (1.0, moved("human", "assert", "next(Robot1, Room1)")),
        (1.0, said("robot", 1, "reject")),
        (1.1, goes(2)),
    )
    station = decided((1.0, CommanderChanged(0, Commander.GROUND_STATION, "gcs")), (2.0, goes(1)))
    assert [each.by for each in (alone, last_word, station)] == ["robot", "robot", "ground station"]
    assert all(each.agreed is None for each in (alone, last_word, station))


def test_advice_on_a_name_is_held_against_the_treasure() -> None:
    kinds = tuple(TreasureKind({}, 10, name, "x.jpg") for name in ("can", "ball", "cup", "jar"))
    made = [
        *decisions_of(
            recorded(
                [
                    (0.0, TreasuresHidden(kinds)),
                    (1.0, goes(2)),
                    (5.0, RobotArrived(0, Room(2))),
                    (5.0, TreasureSensed(Room(2), {})),
                    (6.0, said("human", 2, "assert", scenario="take-treasure")),
                    (6.0, moved("human", "assert", "treasure_in(can, Room2)")),
                    (6.0, moved("robot", "assert", "treasure_in(ball, Room2)")),
                    (8.0, said("human", 2, "accept", scenario="take-treasure")),
                    (8.1, TreasureIdentified(Room(2), 0, "ball", 10, 1.0)),
                ]
            )
        )
    ]
    (named,) = [each for each in made if each.matter == "take-treasure"]
    assert (named.choice, named.advice, named.is_right, named.is_appropriate, named.switched) == (
        "ball",
        "ball",
        True,
        True,
        True,
    )
    assert (named.shown, named.chosen) == (5.0, 8.0)


def fluency(told: Sequence[tuple[float, Told]], robots: int) -> AttentionFigures:
    recording = recorded(told, robots)
    return figures_of(recording, decisions_of(recording))


def test_fluency_is_that_of_the_times() -> None:
    """The first robot stands 2 s, drives 8 s, stands 4 s, drives; the second one stands 5 s and drives 15 s."""
    figures = fluency(
        [
            (1.0, said("human", 1, "assert")),
            (2.0, goes(1)),
            (5.0, goes(2, robot=1)),
            (10.0, RobotArrived(0, Room(1))),
            (13.0, said("human", 3, "assert", talk=2)),
            (14.0, goes(3)),
            (20.0, GameEnded(EndReason.GIVEN_UP, 0)),
        ],
        2,
    )
    first, second = figures.robots
    assert (first.under_way, second.under_way) == (8.0 + 6.0, 15.0)
    assert (first.waiting, second.waiting) == (2.0 + 4.0, 5.0)
    assert figures.person_waited == 20.0 - (5.0 + 4.0)
    assert figures.both == 3.0 + 4.0
    assert first.attention == [1.0, 3.0]
    assert first.interaction == [1.0, 1.0]
    assert first.delays == [1.0, 1.0, 3.0, 1.0]
    # What is done at once was thought about before, and is no interaction.
    assert (second.attention, second.interaction, second.delays) == ([5.0], [0.0], [5.0, 0.0])
    assert first.drives == [8.0]


@pytest.mark.parametrize(("scoring", "value"), [(Scoring.MEAN, 5.0), (Scoring.SUM, 10.0)])
def test_stated_trust_is_the_same_share_of_a_mean_and_of_a_sum(scoring: Scoring, value: float) -> None:
    items = tuple(Item(name, name, subscale="trust", points=7) for name in "ab")
    attempt = Attempt(PlannedStep(1, 0, StepEntry(StepKind.FORM), "trust", 0, None), 1, "", 0)
    given = GivenScore(Run("P-1", Place(0, 0, 0), ()), attempt, "trust", items, value, 2, scoring)
    assert given.share == pytest.approx(4 / 6)


def test_tables_of_recorded_games_and_recordings_that_are_gone_or_changed(tmp_path: Path) -> None:
    folder = rehearse(tmp_path, SimulatedPeople(drop_out=0.0, not_applicable=0.0), 1, WITH_GAMES)
    entries = read_log(folder.log)
    pieces = [*game_tables(records_of(folder.read(), entries, folder.root))]
    frames = {
        name: pd.DataFrame(
            [row for piece in pieces if not isinstance(piece, str) and piece.name == name for row in piece.rows]
        )
        for name in ("decisions", "reliance", "robots", "fluency", "moves")
    }
    assert not any(isinstance(piece, str) for piece in pieces)
    assert frames["robots"].groupby("trial").robot.max().tolist() in ([1, 2], [2, 1])
    choices = frames["decisions"][frames["decisions"].matter == "select-room"]
    assert choices.advice_right.notna().all()
    assert (choices.agreed == (choices.advice == choices.choice)).all()
    assert (frames["reliance"].error_rate_set == 0.5).all()
    assert frames["reliance"].trust.between(0, 1).all()
    assert frames["fluency"][["human_idle", "robot_idle"]].apply(lambda idle: idle.between(0, 1).all()).all()
    assert {"human", "robot"} == set(frames["moves"].speaker)
    bags = [folder.root / str(e.event.data["bag"]) for e in entries if e.event.kind == EventKind.GAME_PLAYED]
    bags[0].unlink()
    with bags[1].open("ab") as file:
        file.write(b"x")
    records = records_of(folder.read(), entries, folder.root)
    assert [str(trial.recording) for trial in records.trials] == ["missing", "changed"]
    notes = [*game_tables(records)]
    assert "is missing" in str(notes[0])
    assert "was changed after recording" in str(notes[1])
    assert len(notes) == 2


def test_recordings_of_both_formats_have_the_same_tables(tmp_path: Path) -> None:
    text = WITH_GAMES.replace("robots: [1, 2]", "robots: [1]").replace("max_seconds: 60", "max_seconds: 20")
    tables = []
    for form in RecordingFormat:
        (tmp_path / form).mkdir()
        written = text.replace("map: arena8", f"map: arena8, recording.format: {form}")
        folder = rehearse(tmp_path / form, SimulatedPeople(drop_out=0.0), 1, written)
        records = records_of(folder.read(), read_log(folder.log), folder.root)
        pieces = (*log_tables(records), *game_tables(records))
        assert not any(isinstance(piece, str) for piece in pieces)
        assert [str(trial.recording) for trial in records.trials] == ["as recorded"]
        frames = {piece.name: pd.DataFrame(piece.rows) for piece in pieces}
        assert frames["trials"].pop("bag")[0].endswith(f"/step-1.{form}")
        named = rf"\.{form}|{frames['trials'].pop('sha256')[0]}"
        frames["events"]["data"] = frames["events"]["data"].str.replace(named, "", regex=True)
        tables.append(frames)
    bag, mcap = tables
    assert bag.keys() == mcap.keys() and len(bag["decisions"]) > 0
    for name in bag:
        pd.testing.assert_frame_equal(bag[name], mcap[name])


@pytest.mark.slow
def test_a_room_that_was_argued_for_is_right_when_the_same_advice_would_have_been(tmp_path: Path) -> None:
    """A recorded game in which robots suggested rooms, a half of them wrong, told as if they had argued for them."""
    text = WITH_GAMES.replace("collaborator", "supervisor").replace("robots: [1, 2]", "robots: [2]")
    folder = rehearse(tmp_path, SimulatedPeople(drop_out=0.0), 1, text)
    (bag,) = folder.recordings.rglob("*.bag")
    asked = read_game(bag)
    argued = read_game(bag)
    for index, each in enumerate(argued.happenings):
        if isinstance(each, TimedEvent) and isinstance(each.event, RoomAdvised):
            content = f"next(Robot{number_of(each.event.robot)}, Room{each.event.room.people})"
            move = replace(moved("robot", "assert", content, each.event.robot), talk=1000 + index)
            argued.happenings[index] = TimedMove(each.time, move)
    told = [[each for each in decisions_of(game) if each.advice] for game in (asked, argued)]
    assert [each.is_right for each in told[0]] == [each.is_right for each in told[1]]
    assert {each.is_right for each in told[0]} == {True, False}
    assert {each.advice_from for each in told[1]} == {"argued"}


def test_decisions_and_replies_have_their_real_time_where_the_log_has_it(tmp_path: Path) -> None:
    text = WITH_GAMES.replace("robots: [1, 2]", "robots: [1]").replace("max_seconds: 60", "max_seconds: 30")
    folder = rehearse(tmp_path, SimulatedPeople(drop_out=0.0), 1, text)
    entries = read_log(folder.log)
    (played,) = (entry for entry in entries if entry.event.kind == EventKind.GAME_PLAYED)

    def tables(course: list | None) -> dict[str, pd.DataFrame]:
        told = {} if course is None else {"course": course, "wall_seconds": 40.0, "most_lag_seconds": 10.0}
        event = replace(played.event, data={**(played.event.data or {}), **told})
        with_course = [replace(entry, event=event) if entry is played else entry for entry in entries]
        records = records_of(folder.read(), with_course, folder.root)
        pieces = (*log_tables(records), *game_tables(records))
        return {piece.name: pd.DataFrame(piece.rows) for piece in pieces if not isinstance(piece, str) and piece.rows}

    # Rehearsals have no real time, and neither have games of earlier releases.
    none = tables(None)
    assert "most_lag_seconds" not in played.event.data
    assert none["decisions"].filter(like="_wall_s").isna().all(axis=None)
    assert none["moves"].reply_wall_s.isna().all()
    assert none["trials"][["wall_seconds", "most_lag_s", "late_share"]].isna().all(axis=None)
    begins = read_game(next(folder.recordings.rglob("*.bag"))).began
    made = none["decisions"]
    last = round(begins + (made.shown_s + made.decision_s).max(), 2)
    even = tables([[0.0, 0.0], [last, last]])
    made = even["decisions"]
    assert len(made) > 1
    for name in ("shown", "decision", "after_advice"):
        assert made[f"{name}_wall_s"].tolist() == pytest.approx(made[f"{name}_s"].tolist(), nan_ok=True)
    # The machine stood still for ten seconds while somebody waited for a reply in a decision.
    waits = even["moves"].reply_s
    row = waits.idxmax()
    stops = even["moves"].time_s[row] - waits[row] / 2.0
    # Real time counts from the first tick of the session, in which the game may not have begun yet.
    stall = tables([[0.0, 0.0], [begins + stops] * 2, [begins + stops + 0.001, begins + stops + 10.001], [30.0, 40.0]])
    late = stall["moves"].reply_wall_s - waits
    assert late.dropna().tolist() == pytest.approx([10.0 * (each == row) for each in late.dropna().index], abs=1e-6)
    late = stall["decisions"].decision_wall_s - made.decision_s
    inside = (made.shown_s < stops) & (stops + 0.001 < made.shown_s + made.decision_s)
    assert inside.sum() == 1
    assert late.tolist() == pytest.approx((10.0 * inside).tolist(), abs=1e-6)
    (trial,) = stall["trials"].to_dict("records")
    assert (trial["wall_seconds"], trial["most_lag_s"]) == (40.0, 10.0)
