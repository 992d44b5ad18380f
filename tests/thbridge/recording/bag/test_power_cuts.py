"""Power cuts during a recording: every recovered message is a recorded one, whatever pages of the file are lost."""

import os
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from random import Random

import pytest

from tests.support.bags.drawn_team import MOUNT, SCAN_PERIOD, SESSION, arena, records, snapshots
from tests.support.bags.inline_queue import InlineQueue
from tests.support.slow import slow
from thbridge.app.session.broadcast import Broadcast
from thbridge.files.errors import BadFile
from thbridge.recording.bag.options import Compression
from thbridge.recording.bag.reading.reader import RawMessage, messages
from thbridge.recording.bag.repair import reindex
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.recording.recordings import active_of
from thbridge.ros.publisher import TeamPublisher

PAGE = 512
"""A disk writes whole sectors, in any order."""
CASES = (5, 6, 16, 18, 20, 150)
"""Seeds of power cuts. In each quick test, at least one of them gives a wrong message if checksums are ignored."""


class Watched:
    """Recording of some seconds, with every state of its file.

    Attributes:
        states: content of the file after each change, whether it was synced, and the stamp up to which it was recorded.
        messages: the recorded messages.
    """

    def __init__(self, path: Path, compression: Compression, seconds_per_tick: float, ticks: int) -> None:
        active, tick = active_of(path), 0
        self.states: list[tuple[bytes, bool, int]] = []

        def note(is_synced: bool) -> None:
            content = active.read_bytes()
            if is_synced or content != self.states[-1][0]:
                self.states.append((content, is_synced, tick))

        with pytest.MonkeyPatch.context() as patched:
            patched.setattr(os, "fsync", lambda _file: note(True) if active.exists() else None)
            writer = BagWriter(
                path,
                compression=compression,
                clock=lambda: tick * seconds_per_tick,
                make_queue=lambda _: InlineQueue(),
            )
            recorder = Broadcast(TeamPublisher(1, MOUNT, SCAN_PERIOD), SESSION, arena(), [writer])
            note(True)
            for snapshot in snapshots(1, ticks):
                tick += 1
                recorder.record(snapshot, records(snapshot.tick))
                note(False)
            writer.close()
        self.messages = Counter(messages(path))

    def after_cut(self, chance: Random) -> tuple[bytes, int]:
        """The file after a power cut at some change, and the tick of this change.

        Each page that was not synced is that of some state since the last sync. A new page may also be lost: zeros.
        """
        cut = chance.randrange(2, len(self.states))
        last = max(place for place in range(cut) if self.states[place][1])
        durable, later = self.states[last][0], [content for content, _, _ in self.states[last : cut + 1]]
        size, share = len(chance.choice(later)), chance.choice((0.02, 0.1, 0.5))
        pages = []
        for at in range(0, size, PAGE):
            # After its end, the durable state has zeros.
            source = durable if chance.random() < share else chance.choice(later[-2:])
            pages.append(source[at : min(at + PAGE, size)].ljust(min(PAGE, size - at), b"\0"))
        return b"".join(pages), self.states[cut][2]


def recovered(path: Path, content: bytes) -> Iterator[RawMessage]:
    """The messages of a file that a power cut has left."""
    for file in path.parent.iterdir():
        file.unlink()
    active_of(path).write_bytes(content)
    try:
        reindex(active_of(path))
    except BadFile:
        return
    yield from messages(path)


@pytest.mark.parametrize(
    ("name", "compression"),
    [
        ("a.bag", Compression.NONE),
        ("a.bag", Compression.LZ4),
        *slow(("a.bag", Compression.BZ2)),
        ("a.mcap", Compression.NONE),
        ("a.mcap", Compression.ZSTD),
        *slow(("a.mcap", Compression.LZ4)),
    ],
)
@pytest.mark.parametrize("seconds_per_tick", [0.02, *slow(0.1)])
def test_no_recovered_message_differs_and_less_than_a_second_is_lost(
    tmp_path: Path, name: str, compression: Compression, seconds_per_tick: float
) -> None:
    watched = Watched(tmp_path / name, compression, seconds_per_tick, 100)
    folder = tmp_path / "cut"
    folder.mkdir()
    for case in CASES:
        content, tick = watched.after_cut(Random(case))
        found = Counter(recovered(folder / name, content))
        assert not found - watched.messages
        first_ns = min(message.stamp_ns for message in watched.messages)
        missing = [message.stamp_ns - first_ns for message in watched.messages - found]
        assert tick * 0.02 - min(missing, default=1e12) / 1e9 < 1.0
