"""Games of a study, really played: recorded, and kept apart where they cannot go on."""

import asyncio
import hashlib
from pathlib import Path

from thbridge.experiment.design.plan import plan_of
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.progress import Run
from thbridge.recording.bag.reading.reader import info
from thbridge.recording.recordings import active_of
from thbridge.sockets.addresses import ListeningAddress
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
        self.told = 0
        self.moved: list[Path | None] = []
        self.cut: list[str] = []

    def ready(self, where: ListeningAddress) -> None:
        pass

    def passed(self, seconds: float) -> None:
        self.times.append(seconds)

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


def test_a_game_is_recorded_and_one_of_another_study_begins_anew_beside_what_there_was(tmp_path: Path) -> None:
    (tmp_path / "experiment.yaml").write_text(STUDY)
    host, game = played(tmp_path, goes_on=False)
    bag = tmp_path / game["bag"]
    assert info(bag).messages > 100
    assert hashlib.sha256(bag.read_bytes()).hexdigest() == game["sha256"]
    assert (game["over"], game["sim_seconds"]) == (None, 2.0)
    assert (host.told, host.moved) == (1, [])
    assert host.times[-1] <= 2.0
    (tmp_path / "experiment.yaml").write_text(STUDY.replace("seed: 1", "seed: 2"))
    host, again = played(tmp_path, goes_on=True)
    assert [moved.name for moved in host.moved if moved is not None] == ["step-1-1.bag"]
    kept = tmp_path / "recordings" / "P-1" / "step-1-1.bag"
    assert hashlib.sha256(kept.read_bytes()).hexdigest() == game["sha256"]
    assert again["sha256"] != game["sha256"]


def test_a_recording_that_was_cut_off_is_told_when_its_game_goes_on(tmp_path: Path) -> None:
    (tmp_path / "experiment.yaml").write_text(STUDY)
    _, game = played(tmp_path, goes_on=False)
    bag = tmp_path / game["bag"]
    bag.rename(active_of(bag))
    host, again = played(tmp_path, goes_on=True)
    assert host.cut == ["step-1-1.bag.active"]
    assert host.moved == []
    assert again["bag"] == game["bag"]
    # Its own program died before it could tell.
    bag.rename(active_of(bag))
    host, _ = played(tmp_path, goes_on=True)
    assert host.cut == ["step-1-1.bag.active", "step-1-2.bag.active"], "whoever is told knows which are new"
