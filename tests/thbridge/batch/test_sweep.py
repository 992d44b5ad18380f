"""Sweeps: games as `thbridge play` plays them, every one once, whatever happens to workers and machine."""

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from threading import Thread

import pytest

from tests.support.programs.commands import thbridge
from tests.support.programs.inline_engine import InlineEngine
from tests.support.project import ROOT
from tests.thbridge.batch.small_sweeps import DESIGN, games, run
from thbridge.batch import tasks
from thbridge.batch.chunks import Shard, chunks_of
from thbridge.batch.design import read_design
from thbridge.batch.engines.batch_task import worker_name
from thbridge.batch.engines.engine import EngineFailed
from thbridge.batch.engines.processes import ProcessEngine
from thbridge.batch.folder import SweepFolder, open_folder
from thbridge.batch.measures import GameMeasures
from thbridge.batch.results import GameStatus, read_table
from thbridge.batch.status import status_of
from thbridge.batch.sweep import WARM, tasks_of
from thbridge.batch.tasks import ATTEMPT, SweepTask
from thbridge.files.errors import BadFile
from thbridge.recording.bag.options import RecordingFormat
from thbridge.recording.bag.reading.reader import info
from thbridge.recording.digest import digest_of
from thbridge.recording.recordings import parts_of

PROGRAM = [sys.executable, "-c", "from ui.cli import main; main()"]
SURROUNDINGS = {**os.environ, "PYTHONPATH": str(ROOT)}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sweep that nothing has happened to."""
    root = tmp_path_factory.mktemp("whole") / "sweep"
    told = run(root, InlineEngine())
    assert (told.games, told.played, told.failed, told.verified, told.differing) == (12, 12, 0, 12, 0)
    return root


def test_a_game_says_what_it_says_in_play_with_the_same_study_and_seed(whole: Path) -> None:
    study, bag = SweepFolder(whole).study(4), whole / "played.bag"
    play = ("play", study, "--seed", "5", "--headless", "--port", "0", "--max-seconds", "4", "--bag", bag, "--json")
    thbridge(whole, *play)
    row = next(row for row in games(whole).to_pylist() if (row["condition"], row["seed"]) == (4, 5))
    assert row["messages"] == digest_of(bag)


def test_a_game_has_the_same_result_if_nothing_reads_its_messages(whole: Path, tmp_path: Path) -> None:
    run(tmp_path / "sweep", InlineEngine(), DESIGN.replace("verify: 1", "verify: 0").replace("[3, 5, 8]", "[5]"))
    unread, read = (games(root).drop_columns(["messages", "verified"]) for root in (tmp_path / "sweep", whole))
    assert unread.to_pylist() == [row for row in read.to_pylist() if row["seed"] == 5]


def test_games_come_by_condition_and_seed_with_their_factors_and_measures(whole: Path) -> None:
    rows = games(whole).to_pylist()
    assert [(row["condition"], row["seed"]) for row in rows] == [(c, s) for c in (1, 2, 3, 4) for s in (3, 5, 8)]
    assert [(row["noise.preset"], row["robots"]) for row in rows[::3]] == [
        ("none", 1), ("none", 2), ("bad wheels", 1), ("bad wheels", 2),
    ]  # fmt: skip
    assert {row["status"] for row in rows} == {GameStatus.OUT_OF_TIME}
    assert all(row["sim_seconds"] == 4.0 and row["distance"] > 0.0 for row in rows)
    assert [len(row["each_robot"]) for row in rows[::3]] == [1, 2, 1, 2]


def test_no_two_games_are_the_same(whole: Path) -> None:
    assert len({row["messages"] for row in games(whole).to_pylist()}) == 12


def test_conditions_share_their_chance(tmp_path: Path) -> None:
    """A difference that makes none: with the same seeds, games of both conditions are equal, one by one."""
    text = "factors: {robot.ekf.gyro_noise: [0.01, 0.02]}\nseeds: [3, 5]\nmax_seconds: 2\nverify: 0\n"
    run(tmp_path / "sweep", InlineEngine(), text)
    rows = games(tmp_path / "sweep").drop_columns(["condition", "robot.ekf.gyro_noise"]).to_pylist()
    assert rows[:2] == rows[2:]
    assert rows[0] != rows[1]


def test_processes_play_the_same_games(whole: Path, tmp_path: Path) -> None:
    told = run(tmp_path / "sweep", ProcessEngine(2, WARM))
    assert (told.played, told.verified, told.differing, told.deaths) == (12, 12, 0, 0)
    assert games(tmp_path / "sweep").equals(games(whole))


def test_a_game_is_played_again_by_another_process_even_where_there_is_one_at_a_time(tmp_path: Path) -> None:
    run(tmp_path / "sweep", ProcessEngine(1, WARM), "seeds: [3]\nverify: 1\nmax_seconds: 1\n")
    again = tasks.read_digests(tmp_path / "sweep/games/condition=1/chunk-1.parquet")
    (row,) = read_table(tmp_path / "sweep/verified/condition=1/chunk-1.parquet").to_pylist()
    assert row["first_worker"] == again[3][1] != row["again_worker"]
    assert row["equal"]


def test_a_worker_that_is_killed_costs_nothing_but_time(whole: Path, tmp_path: Path) -> None:
    root = tmp_path / "sweep"
    killed: list[int] = []

    def kill() -> None:
        """Kill the first worker that has begun a game."""
        for begun in _begun(root):
            killed.append(begun)
            os.kill(begun, signal.SIGKILL)
            return

    killer = Thread(target=kill)
    killer.start()
    told = run(root, ProcessEngine(2, WARM))
    killer.join()
    assert killed
    assert told.deaths == 1
    assert games(root).equals(games(whole))


def _begun(root: Path) -> Iterator[int]:
    """Yield the process ids of workers that have begun a game."""
    deadline = time.monotonic() + 120.0
    while time.monotonic() < deadline:
        for journal in root.glob("attempts/*"):
            try:
                lines = journal.read_text().splitlines()
            except FileNotFoundError:
                continue
            if len(lines) > 1 and lines[0].startswith(ATTEMPT):
                yield int(lines[0].rpartition(":")[2])


@pytest.mark.slow
def test_a_run_goes_on_where_an_earlier_one_was_killed(whole: Path, tmp_path: Path) -> None:
    root = tmp_path / "sweep"
    (tmp_path / "sweep.yaml").write_text(DESIGN)
    command = [*PROGRAM, "sweep", str(tmp_path / "sweep.yaml"), "--out", str(root), "--processes", "1"]
    with subprocess.Popen(command, env=SURROUNDINGS, stderr=subprocess.PIPE) as program:
        deadline = time.monotonic() + 120.0
        while not list(root.glob("games/*/*.parquet")):
            assert program.poll() is None
            assert time.monotonic() < deadline
        program.kill()
    there = list(root.glob("games/*/*.parquet"))
    before = {path: path.stat().st_mtime_ns for path in there}
    told = run(root, ProcessEngine(1, WARM))
    assert told.before >= 2
    assert told.played == 12 - told.before
    assert {path: path.stat().st_mtime_ns for path in there} == before
    assert games(root).equals(games(whole))
    assert list(root.rglob("*.part")) == list(root.glob("attempts/*")) == []


@pytest.mark.parametrize("stop", [signal.SIGTERM, pytest.param(signal.SIGINT, marks=pytest.mark.slow)])
def test_a_run_that_is_stopped_ends_its_workers_and_says_how_to_go_on(stop: signal.Signals, tmp_path: Path) -> None:
    root = tmp_path / "sweep"
    (tmp_path / "sweep.yaml").write_text(DESIGN)
    command = [*PROGRAM, "sweep", str(tmp_path / "sweep.yaml"), "--out", str(root), "--processes", "1"]
    with subprocess.Popen(command, env=SURROUNDINGS, stderr=subprocess.PIPE, text=True) as program:
        worker = next(_begun(root))
        program.send_signal(stop)
        _, told = program.communicate(timeout=60)
    assert program.returncode == 1
    assert (
        "Stopped. All results are kept. To resume, run the same command. For the status, run thbridge sweep status "
        in told
    )
    with pytest.raises(ProcessLookupError):
        os.kill(worker, 0)


def test_a_second_run_has_nothing_to_do(whole: Path) -> None:
    engine = InlineEngine()
    assert run(whole, engine).before == 12
    assert engine.carried_out == []


@pytest.mark.slow
def test_shards_share_the_games_out_and_their_folder(whole: Path, tmp_path: Path) -> None:
    root = tmp_path / "sweep"
    played = [run(root, InlineEngine(), shard=Shard(number, 3)).played for number in (1, 2, 3)]
    assert sum(played) == 12
    assert min(played) > 0
    assert games(root).equals(games(whole))


def test_every_game_is_in_exactly_one_chunk_of_one_shard() -> None:
    chunks = chunks_of(7, range(10, 33), 5)
    assert sorted((chunk.condition, seed) for chunk in chunks for seed in chunk.seeds) == [
        (condition, seed) for condition in range(1, 8) for seed in range(10, 33)
    ]
    for chunk in chunks:
        assert sum(Shard(number, 4).has(chunk) for number in range(1, 5)) == 1


@pytest.mark.parametrize(
    ("before", "after", "told"),
    [
        ("seeds: [3, 5, 8]", "seeds: [3, 5, 9]", "seeds was [3, 5, 8] and is now [3, 5, 9]. "),
        ("energy: 20", "energy: 21", "the study of condition 1 was energy: 20.0 and is now energy: 21.0. "),
        ("max_seconds: 4", "max_seconds: 9", "max_seconds was 4.0 and is now 9.0. "),
        ("robots: [1, 2]", "robots: [1, 2, 3]", "levels.3.noise.preset was bad wheels and is now none. "),
    ],
)
def test_another_design_is_refused_with_the_difference(whole: Path, before: str, after: str, told: str) -> None:
    with pytest.raises(BadFile) as raised:
        run(whole, InlineEngine(), DESIGN.replace(before, after))
    assert told in str(raised.value)
    assert "Name another folder with --out, or undo the change." in str(raised.value)


def test_a_map_that_changed_is_refused(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "maps" / "practice", tmp_path / "hall")
    text = "base: {map: ./hall, templates: practice, robots: 1}\nseeds: [1]\nmax_seconds: 1\nverify: 0\n"
    run(tmp_path / "sweep", InlineEngine(), text)
    with (tmp_path / "hall" / "rooms.yaml").open("a") as file:
        file.write("# moved\n")
    with pytest.raises(BadFile, match=r"the files of map \./hall were changed"):
        run(tmp_path / "sweep", InlineEngine(), text)


def test_a_game_that_fails_is_kept_with_its_fault_and_the_others_are_played(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    play = tasks.play_hunt

    def failing(setting, max_seconds, listeners=()) -> GameMeasures:
        if setting.study.seed == 5:
            raise ZeroDivisionError("of a strategy")
        return play(setting, max_seconds, listeners)

    monkeypatch.setattr(tasks, "play_hunt", failing)
    text = DESIGN.replace("robots: [1, 2]", "robots: [1]")
    told = run(tmp_path / "sweep", InlineEngine(), text)
    assert (told.played, told.failed) == (6, 2)
    rows = games(tmp_path / "sweep").to_pylist()
    assert [row["seed"] for row in rows if row["status"] == GameStatus.FAILED] == [5, 5]
    assert all(row["fault"].startswith("ZeroDivisionError: of a strategy (") for row in rows if row["seed"] == 5)
    status = status_of(tmp_path / "sweep")
    assert status.by_status == {"ended": 0, "out of time": 4, "failed": 2, "crashed": 0}
    assert status.faults[0].startswith("condition 1, seed 5: ZeroDivisionError")

    monkeypatch.setattr(tasks, "play_hunt", play)
    mended = run(tmp_path / "sweep", InlineEngine(), text, retry=True)
    assert (mended.before, mended.played, mended.failed) == (2, 4, 0)
    assert status_of(tmp_path / "sweep").faults == ()


def test_a_game_that_is_not_the_same_again_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    play, played = tasks.play_hunt, list[int]()

    def wavering(setting, max_seconds, listeners=()) -> GameMeasures:
        played.append(setting.study.seed)
        if played.count(5) == 2:  # The second time, it has another seed.
            setting = replace(setting, study=replace(setting.study, seed=6))
        return play(setting, max_seconds, listeners)

    monkeypatch.setattr(tasks, "play_hunt", wavering)
    told = run(tmp_path / "sweep", InlineEngine(), "seeds: [3, 5]\nverify: 1\nmax_seconds: 1\n")
    assert (told.verified, told.differing) == (2, 1)
    status = status_of(tmp_path / "sweep")
    assert (status.drawn, status.verified) == (2, 2)
    (differing,) = status.differing
    assert differing.startswith("condition 1, seed 5: the repetition gave another result (first played by ")
    assert [row["verified"] for row in games(tmp_path / "sweep").to_pylist()] == [True, False]


def test_a_game_with_which_two_workers_died_is_left_out_and_marked(tmp_path: Path) -> None:
    """What the engine does when they die is tested above: here only what they have left behind counts."""
    begun = dict[Path, int]()

    def dies(task: SweepTask) -> bool:
        journal = SweepFolder(task.folder).attempts(task.chunk)
        if task.again or 5 not in task.chunk.seeds or begun.get(journal, 0) == 2:
            return False
        begun[journal] = begun.get(journal, 0) + 1
        journal.parent.mkdir(exist_ok=True)
        with journal.open("a") as file:
            file.write(f"{ATTEMPT} host:1\n3\n5\n")
        return True

    told = run(tmp_path / "sweep", InlineEngine(dies), "seeds: [3, 5]\nverify: 1\nmax_seconds: 1\n")
    assert (told.deaths, told.failed, told.played) == (2, 1, 2)
    rows = games(tmp_path / "sweep").to_pylist()
    assert [(row["status"], row["score"]) for row in rows] == [(GameStatus.OUT_OF_TIME, 0), (GameStatus.CRASHED, None)]
    assert rows[1]["fault"] == "2 workers died during this game"


ONE_CHUNK = "seeds: [3, 5, 8, 9]\nverify: 0\nmax_seconds: 1\n"


def task_of(root: Path) -> SweepTask:
    """The task of the one chunk of a sweep that was begun in a folder."""
    file = root.with_suffix(".yaml")
    file.write_text(ONE_CHUNK)
    design = read_design(file)
    (task,) = tasks_of(design, open_folder(design, root), lambda _chunk: True)
    return task


def test_games_that_ended_are_kept_wherever_their_chunk_ends(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By its worker's death in the middle of a game, and by the end of what a worker was asked for."""
    run(tmp_path / "whole", InlineEngine(), ONE_CHUNK)
    root, play, played = tmp_path / "sweep", tasks.play_hunt, list[int]()
    task = task_of(root)
    assert task.carry_out(1).left == 3

    def dying(setting, max_seconds, listeners=()) -> GameMeasures:
        if setting.study.seed == 8 and 8 not in played:
            played.append(8)
            raise SystemExit
        played.append(setting.study.seed)
        return play(setting, max_seconds, listeners)

    monkeypatch.setattr(tasks, "play_hunt", dying)
    with pytest.raises(SystemExit):
        task.carry_out()
    status = status_of(root)
    assert (status.games, status.done, status.missing, status.running) == (4, 2, 2, 1)
    with SweepFolder(root).ended(task.chunk).open("ab") as torn:
        torn.write(b'{"seed": 9')
    run(root, InlineEngine(), ONE_CHUNK)
    assert played == [5, 8, 8, 9]
    assert games(root).equals(games(tmp_path / "whole"))
    assert list(root.glob("ended/*")) == list(root.glob("attempts/*")) == []
    assert status_of(root).running == 0


def test_games_that_another_version_has_played_are_played_again(tmp_path: Path) -> None:
    task = task_of(tmp_path / "sweep")
    task.carry_out(2)
    kept = SweepFolder(tmp_path / "sweep").ended(task.chunk)
    kept.write_bytes(kept.read_bytes().replace(b'"thbridge": "', b'"thbridge": "0.'))
    assert status_of(tmp_path / "sweep").done == 0
    assert task.carry_out(3).left == 1


def test_a_game_of_a_worker_that_is_dead_is_not_running(tmp_path: Path) -> None:
    task = task_of(tmp_path / "sweep")
    host = worker_name().rpartition(":")[0]
    journal = SweepFolder(tmp_path / "sweep").attempts(task.chunk)
    journal.parent.mkdir()
    for worker, running in ((f"{host}:{2**22 + 1}", 0), (f"{host}:{os.getpid()}", 1), ("elsewhere:7", 1)):
        journal.write_text(f"{ATTEMPT} {worker}\n3\n")
        assert status_of(tmp_path / "sweep").running == running, worker


def test_workers_that_always_die_end_the_sweep(tmp_path: Path) -> None:
    with pytest.raises(EngineFailed, match="workers died at chunk 1"):
        run(tmp_path / "sweep", InlineEngine(lambda _task: True), "seeds: [3]\nmax_seconds: 1\n")


def test_only_drawn_games_are_recorded_and_a_bag_has_the_digest_of_its_row(tmp_path: Path) -> None:
    run(tmp_path / "sweep", InlineEngine(), "replicates: 6\nmax_seconds: 1\nbags: 1 in 3\nverify: 0\n")
    rows = games(tmp_path / "sweep").to_pylist()
    recorded = [row for row in rows if row["bag"] is not None]
    assert 0 < len(recorded) < 6
    for row in recorded:
        assert digest_of(tmp_path / "sweep" / row["bag"]) == row["messages"]


def test_games_are_recorded_in_the_format_of_the_study_with_the_same_results(tmp_path: Path) -> None:
    for form in RecordingFormat:
        design = (
            f"base: {{recording.format: {form}, recording.split_duration: 1}}\nseeds: [3]\nmax_seconds: 2\nbags: yes\n"
        )
        run(tmp_path / form, InlineEngine(), f"{design}verify: 0\n")
    (bag,), (mcap,) = (games(tmp_path / form).to_pylist() for form in RecordingFormat)
    assert (bag.pop("bag"), mcap.pop("bag")) == ("bags/condition=1/seed-3.bag", "bags/condition=1/seed-3.mcap")
    assert bag == mcap
    recording = tmp_path / "mcap" / "bags" / "condition=1" / "seed-3.mcap"
    assert len(parts_of(recording)) > 1
    assert info(recording).messages == info(tmp_path / "bag" / "bags" / "condition=1" / "seed-3.bag").messages


def test_measures_that_are_not_wanted_are_not_kept(tmp_path: Path) -> None:
    run(tmp_path / "sweep", InlineEngine(), "seeds: [3]\nmax_seconds: 1\nmeasures: [score, error_95]\nverify: 0\n")
    names = ["condition", "seed", "status", "fault", "score", "error_95", "messages", "bag", "verified"]
    assert games(tmp_path / "sweep").column_names == names
