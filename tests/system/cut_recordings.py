"""Hunts whose recording is cut short, and what is lost."""

import struct
from collections import defaultdict
from pathlib import Path

from thbridge.recording.bag.reading.reader import messages
from thbridge.recording.recordings import parts_of

SPIED_PLAY = """
import os, struct, sys, time
from thbridge.app.session.broadcast import Broadcast
from ui.cli import main

log = os.open("ticks", os.O_WRONLY | os.O_CREAT | os.O_APPEND)
record = Broadcast.record

def spied(self, snapshot, records=()):
    record(self, snapshot, records)
    os.write(log, struct.pack("<dq", time.monotonic(), snapshot.tick))

Broadcast.record = spied
main()
"""
"""`thbridge`, that also says of each tick when it was recorded."""
STUDY = """
robots: 3
recording:
  compression: {compression}
  split_size: {split_size}
"""
TICK_NS = 20_000_000
FIRST_NS = 1_000_000_000
PATIENCE = 240.0
Said = list[tuple[str, bytes]]


def by_stamp(path: Path) -> dict[int, Said]:
    """What was said at each stamp. The study differs by how it is recorded, so it is left out."""
    said: defaultdict[int, Said] = defaultdict(list)
    for message in messages(path):
        if message.topic != "/thbridge/session":
            said[message.stamp_ns].append((message.topic, message.data))
    return {stamp: sorted(entries) for stamp, entries in said.items()}


def recorded_ticks(log: Path) -> dict[int, float]:
    """The times at which ticks were recorded."""
    data = log.read_bytes()
    return {tick: at for at, tick in struct.iter_unpack("<dq", data[: len(data) // 16 * 16])}


def lost_seconds(path: Path, whole: dict[int, Said], recorded: dict[int, float], killed: float) -> float:
    """Seconds from the first thing that is lost to the kill; everything before it must be there."""
    saved = by_stamp(path) if any(part.is_file() for part in parts_of(path)) else {}
    if not saved:
        return killed - min(recorded.values(), default=killed)
    last = max(saved)
    assert {stamp: saved[stamp] for stamp in saved if stamp < last} == {
        stamp: whole[stamp] for stamp in whole if stamp < last
    }
    assert all(entry in whole[last] for entry in saved[last])
    complete = (last - FIRST_NS) // TICK_NS - (saved[last] != whole[last])
    return killed - min((at for tick, at in recorded.items() if tick > complete), default=killed)
