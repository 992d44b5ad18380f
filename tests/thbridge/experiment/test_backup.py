"""Backups stay within the study's folder, and away from a folder in which a program runs the study."""

import hashlib
import os
import random
import shutil
from pathlib import Path

import pytest

from tests.support.studies.experiment_files import write_experiment
from tests.support.studies.participants import play_a_game
from thbridge.experiment.backup import back_up
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.freeze import data_of
from thbridge.experiment.restore import plan_restore, restore
from thbridge.experiment.store.event_log import ExperimentLog, read_log
from thbridge.experiment.store.events import Clocks, EventKind
from thbridge.files.errors import BadFile


@pytest.fixture
def study(tmp_path: Path) -> ExperimentFolder:
    """A study with one recording."""
    folder = ExperimentFolder(tmp_path / "study")
    folder.root.mkdir()
    write_experiment(folder.root, "title: x\nquota: 3\nsteps:\n  - {step: trial}\n")
    folder.log.parent.mkdir()
    play_a_game(folder)
    return folder


def below(folder: Path) -> dict[str, object]:
    """What is below a folder: contents of files, targets of links."""
    return {
        path.relative_to(folder).as_posix(): str(path.readlink()) if path.is_symlink() else path.read_bytes()
        for path in folder.rglob("*")
        if path.is_symlink() or path.is_file()
    }


def test_links_are_copied_as_links_and_those_out_of_the_study_left_out(study: ExperimentFolder, tmp_path: Path) -> None:
    outside, to = tmp_path / "secret", tmp_path / "backup"
    outside.mkdir()
    (outside / "key").write_text("secret")
    texts = study.root / "more"
    texts.mkdir()
    (texts / "one.txt").write_text("one")
    (texts / "loop").symlink_to("..")
    (texts / "self").symlink_to("self")
    (texts / "same.txt").symlink_to(texts / "one.txt")
    (study.root / "out").symlink_to(outside)
    (study.root / "key").symlink_to(outside / "key")
    (study.root / "recordings" / "others").symlink_to(outside)
    os.mkfifo(study.root / "pipe")

    told = " ".join(back_up(study, to))

    copied = below(to)
    assert {name: copied[f"more/{name}"] for name in ("one.txt", "loop", "self", "same.txt")} == {
        "one.txt": b"one",
        "loop": "..",
        "self": "self",
        "same.txt": "one.txt",
    }
    assert not any(b"secret" in content for content in copied.values() if isinstance(content, bytes))
    for name in ("out", "key", "recordings/others"):
        assert f"{study.root / name} is a link to a target outside the study and is not in the backup" in told
        assert name not in copied
    assert f"{study.root / 'pipe'} is not a regular file" in told
    assert len(back_up(study, to)) == 4
    assert below(to) == copied


def test_recordings_on_another_disk_are_in_the_backup(study: ExperimentFolder, tmp_path: Path) -> None:
    disk, to = tmp_path / "disk", tmp_path / "backup"
    study.recordings.rename(disk)
    study.recordings.symlink_to(disk)
    with pytest.raises(BadFile, match="inside the study's folder would be lost"):
        back_up(study, disk / "backup")
    assert back_up(study, to) == ()
    assert not (to / "recordings").is_symlink()
    assert [path.read_bytes() for path in to.rglob("*.bag")] == [b"a game"]


def test_links_in_a_backup_lead_no_copy_elsewhere(study: ExperimentFolder, tmp_path: Path) -> None:
    outside, to = tmp_path / "mine", tmp_path / "backup"
    outside.mkdir()
    (study.root / "texts").mkdir()
    for folder in (study.root / "texts", outside):
        (folder / "one.txt").write_text("one of mine"[: 11 if folder == outside else 3])
    back_up(study, to)
    (to / "texts" / "one.txt").unlink()
    (to / "texts").rmdir()
    (to / "texts").symlink_to(outside)
    (to / "recordings" / "nobody").symlink_to(outside)
    back_up(study, to)
    assert below(outside) == {"one.txt": b"one of mine"}
    assert not (to / "texts").is_symlink()
    assert (to / "texts" / "one.txt").read_text() == "one"
    assert not (to / "recordings" / "nobody").is_symlink()


def test_a_folder_in_which_the_study_is_run_is_no_backup(study: ExperimentFolder, tmp_path: Path) -> None:
    copy = ExperimentFolder(tmp_path / "backup")
    back_up(study, copy.root)
    participant = play_a_game(study)
    before = below(copy.root)
    known = study.backups_known.paths()
    with ExperimentLog(copy.log):
        with pytest.raises(BadFile, match="another program runs this study"):
            back_up(study, copy.root)
        assert below(copy.root).keys() - before.keys() <= {"store/log-wal", "store/log-shm"}
        assert len(read_log(copy.log)) < len(read_log(study.log))
    assert study.backups_known.paths() == known
    back_up(study, copy.root)
    assert copy.bag(participant, 1).exists()


def test_a_recording_that_an_event_places_elsewhere_is_not_looked_at(study: ExperimentFolder, tmp_path: Path) -> None:
    secret = tmp_path / "secret.bag"
    secret.write_bytes(b"secret")
    with ExperimentLog(study.log) as log:
        conductor = Conductor(study.read(), log, lambda: Clocks("2026-01-02T09:00:00Z", 0), random.Random(7).randrange)
        participant = conductor.admit().participant
        data = {"bag": "../secret.bag", "sha256": hashlib.sha256(b"secret").hexdigest()}
        conductor.tell(EventKind.GAME_PLAYED, participant, conductor.begin(participant), data, "program")
    (told,) = back_up(study, tmp_path / "backup")
    assert "'../secret.bag'" in told


def test_a_study_that_is_restored_still_admits_no_one_who_withdrew(study: ExperimentFolder, tmp_path: Path) -> None:
    event, link = hashlib.sha256(b"event").digest(), hashlib.sha256(b"code").digest()
    study.withdrawn_events.add([event])
    study.withdrawn_links.add([link])
    back_up(study, tmp_path / "backup")
    shutil.rmtree(study.root)
    restore(plan_restore(tmp_path / "backup", study.root))
    assert study.withdrawn_events.read() == {event}
    assert study.withdrawn_links.read() == {link}


def test_the_copy_for_a_rehearsal_has_an_end(study: ExperimentFolder, tmp_path: Path) -> None:
    texts, copy = study.root / "texts", tmp_path / "copy"
    texts.mkdir()
    (texts / "one.txt").write_text("one")
    for name, target in (("loop", ".."), ("self", "self"), ("gone", "nothing"), ("same.txt", "one.txt")):
        (texts / name).symlink_to(target)
    shutil.copytree(study.root, copy, ignore=data_of)
    assert sorted(path.name for path in (copy / "texts").iterdir()) == ["one.txt", "same.txt"]
    assert not (copy / "recordings").exists()
