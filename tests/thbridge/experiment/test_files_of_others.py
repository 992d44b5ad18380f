"""Pipes, huge files and odd contents in place of a study's own small files are refused within bounds."""

import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.support.programs.inline_engine import InlineEngine
from thbridge.batch.tasks import _deaths
from thbridge.experiment.export.manifest import MANIFEST, people_of
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.rehearsal.people import SimulatedPeople
from thbridge.experiment.rehearsal.power import PowerQuestion, PowerTask, estimate_power
from thbridge.experiment.restore import plan_restore, restore
from thbridge.experiment.store.event_log import ExperimentLog
from thbridge.experiment.store.head import restoring_path
from thbridge.files.errors import BadFile
from thbridge.recording.recordings import digest_of

PATIENCE = 120
"""Seconds after which a test that waits for a pipe fails."""


@pytest.fixture(autouse=True)
def _no_waiting() -> Iterator[None]:
    def give_up(_signal: int, _frame: object) -> None:
        pytest.fail("it waits for a pipe")

    usual = signal.signal(signal.SIGALRM, give_up)
    signal.alarm(PATIENCE)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, usual)


def _power(result: Path) -> object:
    question = PowerQuestion("workload", "robots", (4,))
    task = PowerTask(result.parent, result.parents[1], question, SimulatedPeople(plays=False), 7, effects=True)
    assert task.result == result
    return estimate_power([task], InlineEngine())


FILES: dict[str, tuple[str, Callable[[Path], object]]] = {
    "exports": ("store/exports.json", lambda path: ExperimentFolder(path.parents[1]).exports_known.paths()),
    "backups": ("store/backups.json", lambda path: ExperimentFolder(path.parents[1]).backups_known.paths()),
    "withdrawals": ("store/withdrawal.json", lambda path: ExperimentFolder(path.parents[1]).pending_withdrawals.read()),
    "withdrawn": ("store/withdrawn.json", lambda path: ExperimentFolder(path.parents[1]).withdrawn_events.read()),
    "a result of a rehearsal": ("results/with/7.json", _power),
    "attempts": ("attempts/chunk-1", _deaths),
}


def pipe(path: Path) -> None:
    os.mkfifo(path)


def device(path: Path) -> None:
    path.symlink_to("/dev/zero")


def huge(path: Path) -> None:
    with path.open("wb") as file:
        file.truncate(1 << 40)


ODD: dict[str, Callable[[Path], object]] = {
    "a pipe": pipe,
    "a device": device,
    "huge": huge,
    "deep": lambda path: path.write_text("[" * 100_000),
    "another content": lambda path: path.write_text("attempt host:1\nzebra\n"),
    "no text": lambda path: path.write_bytes(b'["\xff"]'),
    "numbers": lambda path: path.write_text("[1, 2]"),
}


@pytest.mark.parametrize(
    ("name", "odd"),
    # A text without attempts is a journal.
    [(name, odd) for name in FILES for odd in ODD if name != "attempts" or odd not in {"deep", "numbers"}],
)
def test_an_odd_file_is_refused_with_its_name(tmp_path: Path, name: str, odd: str) -> None:
    file, read = FILES[name]
    path = tmp_path / file
    path.parent.mkdir(parents=True)
    ODD[odd](path)
    with pytest.raises(BadFile, match=path.name):
        read(path)


@pytest.mark.parametrize("odd", ODD)
def test_an_odd_manifest_says_nothing(tmp_path: Path, odd: str) -> None:
    ODD[odd](tmp_path / MANIFEST)
    assert people_of(tmp_path) is None


def test_a_pipe_in_place_of_a_recording_is_no_recording(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "step-1.bag")
    with pytest.raises(BadFile, match="a pipe"):
        digest_of(tmp_path / "step-1.bag")


@pytest.mark.parametrize("odd", ODD)
def test_a_restore_does_not_rely_on_what_an_interrupted_one_left(tmp_path: Path, odd: str) -> None:
    for name in ("study", "backup"):
        folder = ExperimentFolder(tmp_path / name)
        folder.log.parent.mkdir(parents=True)
        folder.file.write_text("title: x\nsteps: []\n")
        with ExperimentLog(folder.log):
            pass
    study = ExperimentFolder(tmp_path / "study")
    ODD[odd](restoring_path(study.log))
    if odd in {"a pipe", "a device", "huge", "deep"}:
        with pytest.raises(BadFile, match="Delete this file, and run the command again"):
            restore(plan_restore(tmp_path / "backup", study.root))
        restoring_path(study.log).unlink()
    kept, _ = restore(plan_restore(tmp_path / "backup", study.root))
    assert kept is not None
    assert not restoring_path(study.log).exists()
