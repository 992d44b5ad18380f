"""A withdrawal and a restore are killed at changes that they make on a disk; then a command of the study is run.

The disk is the one that forgets (`forgetting_disk`), but nothing is forgotten here: the program is killed, and the disk
goes on. `test_power_cut` cuts the power at every single change instead.
"""

import itertools
import multiprocessing
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.disks.forgetting_disk import ForgettingDisk
from tests.support.programs.commands import invoke, output_of
from tests.support.studies.participants import another_person, people, traces
from tests.support.studies.study_events import NOON
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.restore import plan_restore, restore
from thbridge.experiment.store.event_log import ExperimentLog, read_log
from thbridge.experiment.withdrawal import plan_withdrawal, withdraw
from thbridge.files.errors import BadFile

WORDS = ("I like okapis", "I saw a zebra")
pytestmark = pytest.mark.timeout(3600)
COMMANDS = ("status", "check", "withdraw", "freeze", "backup", "export", "watch")
MOMENTS = 50


@pytest.fixture(scope="module")
def prepared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A study of two people, and a backup that was made before the second one came."""
    root = tmp_path_factory.mktemp("prepared")
    (root / "study").mkdir()
    first = another_person(root / "study", WORDS[0])
    output_of("study", "backup", root / "study", "--to", root / "earlier")
    another_person(root / "study", WORDS[1])
    (root / "id").write_text(first)
    return root


@pytest.fixture(scope="module")
def processes() -> multiprocessing.context.BaseContext:
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([__name__])
    return context


def act(name: str, folder: Path) -> None:
    """Do what is killed, in a process of its own."""
    study = ExperimentFolder(folder / "study")
    if name == "withdraw":
        withdraw(
            study,
            study.read(),
            plan_withdrawal(study, study.read(), people_of(folder)).withdrawal,
            {},
            None,
            lambda: NOON,
        )
    else:
        restore(plan_restore(folder / "earlier", study.root))


def people_of(folder: Path) -> str:
    return (folder.parent / "id").read_text()


def killed(
    disk: ForgettingDisk,
    processes: multiprocessing.context.BaseContext,
    prepared: Path,
    name: str,
    changes: Iterator[int],
) -> Iterator[int]:
    """Kill it at these changes, one after the other, and yield each; end after the last that it makes."""
    for change in changes:
        disk.fresh()
        for each in ("study", "earlier"):
            shutil.copytree(prepared / each, disk.folder / each)
        (disk.folder.parent / "id").write_text((prepared / "id").read_text())
        study = disk.folder / "study"
        for known in ("backups.json", "exports.json"):
            (study / "store" / known).unlink(missing_ok=True)
        if name == "withdraw":
            output_of("study", "backup", study, "--to", disk.folder / "backup")
            output_of("study", "export", study, "--to", disk.folder / "tables")
        disk.settle()
        disk.cut_after(change)
        process = processes.Process(target=act, args=(name, disk.folder))
        process.start()
        if not disk.wait(process):
            process.join()
            assert process.exitcode == 0, "it has failed without being killed"
            return
        disk.kill(process)
        process.join()
        yield change


def check_withdrawal(folder: Path, gone: str, name: str) -> None:
    study = ExperimentFolder(folder / "study")
    begun = bool(study.pending_withdrawals.read())
    words = {"backup": ["--to", folder / "new"], "export": ["--to", folder / "out"], "withdraw": [gone, "--yes"]}
    done = invoke("study", name, study.root, *words.get(name, []))
    if not begun and name != "withdraw" and gone in people(study.root):
        # Nothing was deleted before the intention was on the disk.
        assert (study.recordings / gone / "step-9.bag").exists()
        output_of("study", "withdraw", study.root, gone, "--yes")
    left = [trace for trace in traces(folder, [gone, WORDS[0]]) if "/earlier/" not in trace]
    assert left == [], (name, done.output)
    for log in (study.log, folder / "backup" / "store" / "log"):
        assert read_log(log)
    assert gone not in people(study.root)


@pytest.mark.parametrize("stride", [180, pytest.param(1, marks=[pytest.mark.slow, pytest.mark.timeout(4 * 3600)])])
def test_a_withdrawal_that_is_killed_is_finished_by_the_next_command(
    disk: ForgettingDisk, processes: multiprocessing.context.BaseContext, prepared: Path, stride: int
) -> None:
    gone, seen = (prepared / "id").read_text(), 0
    kills = killed(disk, processes, prepared, "withdraw", itertools.count(stride, stride))
    for name, _ in zip(itertools.cycle(COMMANDS), kills, strict=False):
        check_withdrawal(disk.folder, gone, name)
        seen += 1
    assert seen > 1


@pytest.mark.slow
def test_a_log_is_whole_or_refused_after_a_restore_is_killed_at_any_change(
    disk: ForgettingDisk, processes: multiprocessing.context.BaseContext, prepared: Path
) -> None:
    earlier, seen = read_log(prepared / "earlier" / "store" / "log"), set()
    whole = read_log(prepared / "study" / "store" / "log")
    for change in killed(disk, processes, prepared, "restore", itertools.count(1)):
        study = ExperimentFolder(disk.folder / "study")
        try:
            entries = read_log(study.log)
            assert entries in (whole, earlier)
            with ExperimentLog(study.log) as log:
                assert log.read() == entries
            seen.add("before" if entries == whole else "after")
        except BadFile as fault:
            assert "restore" in str(fault)
            seen.add("refused")
        restore(plan_restore(disk.folder / "earlier", study.root))
        assert read_log(study.log) == earlier
        kept = [read_log(each.log) for each in study.replaced() if each.log.exists()]
        assert whole in kept
        assert change
    assert {"before", "refused"} <= seen
    assert change >= MOMENTS
