"""Power cuts while real programs record on a disk that forgets what was not synced: what may be lost, and no more."""

import contextlib
import json
import random
import subprocess
import sys
import time
from collections import defaultdict
from pathlib import Path

import pytest

from tests.support.disks.forgetting_disk import ForgettingDisk
from tests.support.programs.processes import THBRIDGE
from tests.system.cut_recordings import (
    FIRST_NS,
    PATIENCE,
    SPIED_PLAY,
    STUDY,
    TICK_NS,
    Said,
    by_stamp,
    lost_seconds,
    recorded_ticks,
)
from thbridge.files.errors import BadFile
from thbridge.recording.bag.reading.reader import messages
from thbridge.recording.bag.repair import reindex
from thbridge.recording.journal import journal_path, read_journal
from thbridge.recording.recordings import ACTIVE, is_folder, journal_of

pytestmark = [pytest.mark.slow, pytest.mark.timeout(3600)]


def play(folder: Path, bag: Path, compression: str, split: bool, rate: float) -> subprocess.Popen[bytes]:
    """Play in a folder that forgets nothing, and record elsewhere."""
    (folder / "study.yaml").write_text(STUDY.format(compression=compression, split_size="0.5" if split else "null"))
    arguments = ["play", "study.yaml", "--port", "0", "--rate", str(rate), "--bag", str(bag), "--json"]
    with (folder / "told").open("ab") as told:
        return subprocess.Popen(
            [sys.executable, "-c", SPIED_PLAY, *arguments], cwd=folder, stdout=told, stderr=told, start_new_session=True
        )


@pytest.fixture(scope="module", params=["a.bag", "a.mcap", "a"])
def name(request: pytest.FixtureRequest) -> str:
    """Name of the recording, which decides its format."""
    return request.param


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory, name: str) -> tuple[dict[int, Said], list[tuple[int, str]]]:
    """The hunt that nobody interrupts: what is said at each stamp, and the events with theirs."""
    folder = tmp_path_factory.mktemp("whole")
    process = play(folder, folder / name, "none", False, 0)
    assert process.wait(PATIENCE) == 0
    events = read_journal(journal_path(journal_of(folder / name), 1))
    assert len(events.events) > 10
    return by_stamp(folder / name), events_of(folder / name)


def events_of(bag: Path) -> list[tuple[int, str]]:
    return [(m.stamp_ns, m.data.decode(errors="replace")) for m in messages(bag) if m.topic == "/hunt/events"]


def events_in(journal: Path) -> list[str]:
    """The events of a journal as they are said, without the checksums."""
    lines = [json.loads(line) for line in journal.read_bytes().split(b"\n")[:-1]]
    return [json.dumps({k: v for k, v in line.items() if k not in {"length", "sum"}}) for line in lines]


def cut_and_recover(
    folder: Path, disk: ForgettingDisk, whole: tuple[dict[int, Said], list[tuple[int, str]]], case: int, name: str
) -> tuple[str, float]:
    """Play, cut the power at some change, recover; what was tried, and the seconds lost in the worst outcome."""
    chance = random.Random(case)
    compression = ("none", "lz4", "bz2" if name == "a.bag" else "zstd")[case % 3]
    split = case // 3 % 2 == 1
    rate, most = ((0, 220), (1, 40))[case // 6 % 2]
    disk.fresh()
    # Long after the folder was made.
    (disk.folder / "recordings").mkdir()
    disk.settle()
    bag = disk.folder / "recordings" / name
    disk.cut_after(chance.randrange(1, most))
    process = play(folder, bag, compression, split, rate)
    stopped = disk.wait(process)
    at = time.monotonic()
    disk.cut(process)
    process.wait()
    assert stopped, (folder / "told").read_text()
    assert "Traceback" not in (folder / "told").read_text()
    recorded = recorded_ticks(folder / "ticks") if (folder / "ticks").exists() else {}
    # What was being done when the machine had stopped already has told nobody.
    done = {tick: when for tick, when in recorded.items() if when < at}
    worst = 0.0
    for outcome in (None, *(chance.randrange(1000) for _ in range(3))):
        disk.cut(seed=outcome)
        for path in [bag] if is_folder(bag) else [*bag.parent.glob(f"a*{ACTIVE}")]:
            # The head of a part that has just begun may be lost: then nothing is counted as saved of it.
            with contextlib.suppress(BadFile):
                reindex(path)
        lost = lost_seconds(bag, whole[0], done, at)
        worst = max(worst, lost)
        check_journal(journal_of(bag), whole[1], max(done, default=0))
    # Another recording of the name begins, and none is lost for it.
    before = sizes_of_recordings(bag.parent)
    again = subprocess.run(
        [*THBRIDGE, "play", "--port", "0", "--rate", "0", "--bag", str(bag), "--max-seconds", "2", "--no-report"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert "Traceback" not in again.stderr + again.stdout
    assert bag.exists(), again.stderr + again.stdout
    after = sizes_of_recordings(bag.parent)
    assert len(after) == len(before) + 1
    assert all(size in after for size in before)
    return f"{compression}{', split' if split else ''}, rate {rate}", worst


def sizes_of_recordings(folder: Path) -> list[int]:
    return sorted(path.stat().st_size for path in folder.rglob("*") if path.suffix in {".bag", ".mcap"})


def check_journal(folder: Path, said: list[tuple[int, str]], tick: int) -> None:
    """All events that were told before the cut are in the journal, in their order, and nothing else."""
    told = [text for stamp, text in said if stamp < FIRST_NS + tick * TICK_NS]
    journal = journal_path(folder, 1)
    if not told and not journal.exists():
        return
    read_journal(journal)
    known = [json.loads(text) for text in events_in(journal)]
    places = [json.loads(text[text.index("{") :]) for text in told if "{" in text]
    for event in places:
        assert event in known, event


def test_at_most_a_second_is_lost_at_a_power_cut(tmp_path, disk, name, whole, capsys):
    losses = defaultdict(list)
    for case in range(14):
        folder = tmp_path / str(case)
        folder.mkdir()
        told, lost = cut_and_recover(folder, disk, whole, case, name)
        losses[told].append(lost)
    with capsys.disabled():
        print(f"\n{name}")
        for told, cases_ in losses.items():
            print(f"{told}: {len(cases_)} power cuts, at most {max(cases_):.2f} s lost")
    assert max(lost for each in losses.values() for lost in each) <= 1.0
