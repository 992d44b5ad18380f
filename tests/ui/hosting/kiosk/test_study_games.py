"""Games of a study, really played: recorded, and kept apart where they cannot go on."""

import asyncio
import hashlib
import json
from pathlib import Path

import pytest

from thbridge.experiment.design.experiment_file import practice_seed
from thbridge.experiment.design.plan import plan_of
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.progress import Run
from thbridge.recording.bag.options import RecordingFormat
from thbridge.recording.bag.reading.reader import info
from thbridge.recording.recordings import active_of
from thbridge.sockets.addresses import ListeningAddress
from thbridge.timing.pace_meter import real_time
from ui.hosting.kiosk.games import StudyGames

STUDY = """\
title: x
seed: 1
base: {map: practice, templates: practice, robots: 1, rate: 50, server.port: 0}
quota: 1
steps:
  - {step: trial, max_seconds: 2}
"""


class NobodyThere:
    """A host whose window never joins."""

    def __init__(self) -> None:
        self.times: list[float] = []
        self.left: list[float] = []
        self.told = 0
        self.moved: list[Path | None] = []
        self.cut: list[str] = []

    def ready(self, where: ListeningAddress) -> None:
        pass

    def passed(self, seconds: float, lag: float, left: float) -> None:
        self.times.append(seconds)
        self.left.append(left)

    def still_to_do(self, missing) -> None:
        self.missing = dict(missing)

    def time_is_up(self) -> None:
        self.told += 1

    def has_left(self) -> bool:
        return False

    def has_seen_end(self) -> bool:
        return False

    def broken_off(self, bag: Path | None) -> None:
        self.moved.append(bag)

    def cut_off(self, bag: Path) -> None:
        self.cut.append(bag.name)


def played(root: Path, *, goes_on: bool) -> tuple[NobodyThere, dict]:
    folder = ExperimentFolder(root)
    design = folder.read()
    run = Run("P-1", design.allocation.place(0), ())
    (step,) = plan_of(design, run.place)
    host = NobodyThere()
    game = asyncio.run(StudyGames(folder, design).play(run, step, host, goes_on=goes_on))
    assert game is not None
    return host, game


@pytest.mark.parametrize("form", RecordingFormat)
def test_a_game_is_recorded_and_one_of_another_study_begins_anew_beside_what_there_was(
    tmp_path: Path, form: RecordingFormat
) -> None:
    study = STUDY.replace("robots: 1", f"robots: 1, recording.format: {form}")
    (tmp_path / "experiment.yaml").write_text(study)
    host, game = played(tmp_path, goes_on=False)
    bag = tmp_path / game["bag"]
    assert info(bag).messages > 100
    assert hashlib.sha256(bag.read_bytes()).hexdigest() == game["sha256"]
    assert (game["over"], game["sim_seconds"]) == (None, 2.0)
    assert (host.told, host.moved) == (1, [])
    assert host.times[-1] <= 2.0
    (tmp_path / "experiment.yaml").write_text(study.replace("seed: 1", "seed: 2"))
    host, again = played(tmp_path, goes_on=True)
    assert [moved.name for moved in host.moved if moved is not None] == [f"step-1-1.{form}"]
    kept = tmp_path / "recordings" / "P-1" / f"step-1-1.{form}"
    assert hashlib.sha256(kept.read_bytes()).hexdigest() == game["sha256"]
    assert again["sha256"] != game["sha256"]


@pytest.mark.parametrize("form", RecordingFormat)
def test_a_recording_that_was_cut_off_is_told_when_its_game_goes_on(tmp_path: Path, form: RecordingFormat) -> None:
    study = STUDY.replace("robots: 1", f"robots: 1, recording.format: {form}")
    (tmp_path / "experiment.yaml").write_text(study)
    _, game = played(tmp_path, goes_on=False)
    bag = tmp_path / game["bag"]
    bag.rename(active_of(bag))
    host, again = played(tmp_path, goes_on=True)
    assert host.cut == [f"step-1-1.{form}.active"]
    assert host.moved == []
    assert again["bag"] == game["bag"]
    # Its own program died before it could tell.
    bag.rename(active_of(bag))
    host, _ = played(tmp_path, goes_on=True)
    assert host.cut == [f"step-1-1.{form}.active", f"step-1-2.{form}.active"], "whoever is told knows which are new"


def test_the_log_has_the_real_time_of_a_game_also_where_another_program_went_on_with_it(tmp_path: Path) -> None:
    (tmp_path / "experiment.yaml").write_text(STUDY)
    _, game = played(tmp_path, goes_on=False)
    times, walls = zip(*game["course"], strict=True)
    assert (times[0], walls[0]) == (0.0, 0.0)
    assert times[-1] == pytest.approx(2.0, abs=0.05)
    assert walls[-1] == pytest.approx(game["wall_seconds"], abs=0.01)
    assert list(walls) == sorted(walls)
    assert 0.0 <= game["late_seconds"] <= game["wall_seconds"]
    log = tmp_path / "recordings" / "P-1" / "step-1.inputs"
    lines = [json.loads(line) for line in log.read_bytes().splitlines()]
    # The program died after the first second, which took 7 s because the machine was too slow.
    cut = [line for line in lines if line.get("tick", 0) <= 50]
    cut[-1]["pace"] = [7.0, 0.02, 6.0, 6.5, 3.0]
    log.write_text("".join(json.dumps(line, separators=(",", ":")) + "\n" for line in cut))
    _, again = played(tmp_path, goes_on=True)
    assert again["most_lag_seconds"] >= 6.5
    assert again["late_seconds"] >= 3.0
    assert real_time(again["course"], 1.0) == pytest.approx(7.0, abs=0.1)
    assert again["wall_seconds"] > 7.0
    assert again["sha256"] == game["sha256"], "the recording does not depend on real time"
    # An earlier release kept no real time there.
    for line in cut:
        line.pop("pace", None)
    log.write_text("".join(json.dumps(line, separators=(",", ":")) + "\n" for line in cut))
    _, older = played(tmp_path, goes_on=True)
    assert older["score"] == game["score"]


PRACTICE = """\
title: x
seed: 1
base: {map: practice, templates: practice, robots: 1, rate: 50, server.port: 0}
quota: 1
steps:
  - {step: practice, max_seconds: 4}
  - {step: trial}
"""


def test_practice_is_really_played_again_in_another_game_and_tells_what_is_missing(tmp_path: Path) -> None:
    (tmp_path / "experiment.yaml").write_text(PRACTICE)
    folder = ExperimentFolder(tmp_path)
    design = folder.read()
    step = plan_of(design, design.allocation.place(0))[0]
    seeds = []
    for attempt in (1, 2):
        run, host = Run("P-1", design.allocation.place(0), (), begun={1: attempt}), NobodyThere()
        count = asyncio.run(StudyGames(folder, design).practise(run, step, host))
        assert (host.missing, dict(count.missing)) == ({"moves": 1.0}, {"moves": 1.0})
        assert (host.times[-1], host.left[0] > host.left[-1], host.told) == (3.98, True, 1)
        assert host.left[-1] < 0.1, "real time: 4 simulated seconds take a fiftieth of that"
        seeds.append(practice_seed(design, attempt))
    assert seeds[0] != seeds[1]
    assert not (tmp_path / "recordings").exists()
