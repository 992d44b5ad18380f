"""The log of a study: each byte changed and each cut of each of its files is noticed, or changes nothing."""

import os
import shutil
import subprocess
import sys
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

import pytest

from tests.support.disks.damaged_files import EACH_BIT, cuts, flips
from tests.support.project import ROOT
from tests.support.studies.experiment_files import write_experiment
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.rehearsal.people import SimulatedPeople
from thbridge.experiment.rehearsal.rehearsal import rehearse
from thbridge.experiment.store.event_log import ExperimentLog, read_log
from thbridge.experiment.store.events import Clocks, LoggedEvent, NewEvent
from thbridge.files.errors import BadFile

LATER = NewEvent("note", "experimenter", Clocks("2026-01-02T12:00:00Z", 5), data={"text": "later"})

APPEND_AND_DIE = """
import os, sys
from pathlib import Path
from tests.thbridge.experiment.test_each_byte import LATER
from thbridge.experiment.store.event_log import ExperimentLog
log = ExperimentLog(Path(sys.argv[1]))
log.append([LATER])
log.append([LATER])
os.kill(os.getpid(), 9)
"""

Files = dict[str, bytes]


def files_in(folder: Path) -> Files:
    """The log's files, without those that hold nothing: the lock, and the index of the write-ahead log."""
    return {file.name: file.read_bytes() for file in folder.iterdir() if not file.name.endswith(("-shm", "-lock"))}


@pytest.fixture(scope="module")
def closed(tmp_path_factory: pytest.TempPathFactory) -> Files:
    """The files of a short study with a form, a trial and two people, as its program leaves them."""
    study = ExperimentFolder(tmp_path_factory.mktemp("study"))
    text = "title: x\nquota: 2\nsteps:\n  - {step: form, form: workload}\n  - {step: trial}\n"
    write_experiment(study.root, text)
    rehearse(study, study.read(), SimulatedPeople(plays=False, drop_out=0.0), 1)
    return files_in(study.log.parent)


@pytest.fixture(scope="module")
def killed(closed: Files, tmp_path_factory: pytest.TempPathFactory) -> Files:
    """The same after a program that was killed: its last events are in the write-ahead log."""
    folder = tmp_path_factory.mktemp("killed")
    write_files(folder, closed)
    program = [sys.executable, "-c", APPEND_AND_DIE, str(folder / "log")]
    subprocess.run(program, check=False, env={**os.environ, "PYTHONPATH": str(ROOT)})
    files = files_in(folder)
    assert set(files) == {"log", "log-head", "log-wal"}
    return files


def write_files(folder: Path, files: Files) -> None:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    for name, content in files.items():
        (folder / name).write_bytes(content)


def outcomes(
    folder: Path, files: Files, name: str, damaged: Iterable[tuple[str, bytes]], appends: bool
) -> Counter[str]:
    """Read a log with each damage to one of its files, and count what came of it; another history is a failure.

    Args:
        folder: to write it into.
        files: of the log.
        name: of the file that is damaged.
        damaged: its contents.
        appends: True to go on with each log that reads as before, too; what it had must stay.
    """
    log = folder / "log"
    write_files(folder, files)
    history = read_log(log)
    assert len(history) > 10
    counted: Counter[str] = Counter()
    for what, data in damaged:
        write_files(folder, {**files, name: data})
        try:
            read = read_log(log)
        except BadFile as fault:
            assert fault.path.parent == folder, what
            counted["refused"] += 1
            continue
        assert read == history, what
        counted["the same"] += 1
        if not appends:
            continue
        try:
            with ExperimentLog(log) as again:
                assert again.append([LATER]) == [LoggedEvent(len(history) + 1, LATER)], what
        except BadFile:
            counted["refused when opened"] += 1
            continue
        assert read_log(log) == [*history, LoggedEvent(len(history) + 1, LATER)], what
    return counted


@pytest.mark.parametrize("name", ["log", "log-head"])
@pytest.mark.parametrize(
    ("masks", "stride"), [((0x01, 0xFF), 131), pytest.param(EACH_BIT, 1, marks=pytest.mark.slow)], ids=["quick", "each"]
)
def test_a_changed_byte_is_refused_or_changes_nothing(
    closed: Files, tmp_path: Path, name: str, masks: tuple[int, ...], stride: int
) -> None:
    counted = outcomes(tmp_path / "spoilt", closed, name, flips(closed[name], masks, stride), appends=False)
    assert counted["refused"] > 0


@pytest.mark.parametrize("stride", [257, pytest.param(7, marks=pytest.mark.slow)], ids=["quick", "many"])
def test_a_log_with_a_changed_byte_that_reads_as_before_is_gone_on_with(
    closed: Files, tmp_path: Path, stride: int
) -> None:
    counted = outcomes(tmp_path / "spoilt", closed, "log", flips(closed["log"], (0x04, 0xFF), stride), appends=True)
    assert counted["the same"] > 0


def test_a_log_with_any_byte_of_its_header_changed_is_gone_on_with_or_refused(closed: Files, tmp_path: Path) -> None:
    """The first 100 bytes say how all others are to be read, and SQLite's checks pass over some of them."""
    header = ((what, data) for what, data in flips(closed["log"], (0x01, 0x80, 0xFF)) if int(what.split()[1]) < 100)
    counted = outcomes(tmp_path / "spoilt", closed, "log", header, appends=True)
    assert counted["refused"] > 0


@pytest.mark.parametrize("name", ["log", "log-head", "log-wal"])
@pytest.mark.parametrize(
    ("masks", "stride"), [((0xFF,), 201), pytest.param(EACH_BIT, 1, marks=pytest.mark.slow)], ids=["quick", "each"]
)
def test_a_changed_byte_of_a_log_whose_program_was_killed(
    killed: Files, tmp_path: Path, name: str, masks: tuple[int, ...], stride: int
) -> None:
    counted = outcomes(tmp_path / "spoilt", killed, name, flips(killed[name], masks, stride), appends=False)
    assert counted["refused"] + counted["the same"] > 0


@pytest.mark.parametrize("name", ["log", "log-head", "log-wal"])
@pytest.mark.parametrize("stride", [131, pytest.param(1, marks=pytest.mark.slow)], ids=["quick", "each"])
def test_each_cut_of_a_file_is_refused(killed: Files, tmp_path: Path, name: str, stride: int) -> None:
    counted = outcomes(tmp_path / "spoilt", killed, name, cuts(killed[name], stride), appends=False)
    assert counted["refused"] > 0
