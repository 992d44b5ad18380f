"""What watching costs a session of ten robots: processor time of the door's part in a tick, by number of watchers.

The watchers read in another process, but for one in the last case, which never does.
"""

import asyncio
import dataclasses
import subprocess
import sys
import time
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest

from tests.bench.budget import Budgets
from thbridge.app import play
from thbridge.app.compose.game import build_bot
from thbridge.app.compose.setting import read_setting
from thbridge.app.listeners import StartupCallbacks, WatchAddress
from thbridge.app.play import HuntUnfinished, PlayOptions
from thbridge.roles.participant.tabui import TabUI
from thbridge.ros.topics import RosMessage
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.errors import CannotListen
from thbridge.study.study_file import Study
from thbridge.watching.sockets.server import WatchServer

pytestmark = pytest.mark.bench

ROBOTS = 10
SECONDS = 12.0
STUDY = dataclasses.replace(
    Study(), map="warehouse12", robots=ROBOTS, server=dataclasses.replace(Study().server, port=0)
)

READ = """
import socket, sys
sockets = [socket.create_connection(("127.0.0.1", int(sys.argv[1]))) for _ in range(int(sys.argv[2]))]
import selectors
chosen = selectors.DefaultSelector()
for each in sockets:
    chosen.register(each, selectors.EVENT_READ)
total = 0
while chosen.get_map():
    for key, _ in chosen.select():
        data = key.fileobj.recv(1 << 20)
        total += len(data)
        if not data:
            chosen.unregister(key.fileobj)
print(total)
"""


@pytest.mark.parametrize(("reading", "stalled"), [(0, 0), (1, 0), (8, 0), (1, 1)])
def test_a_tick_with_watchers(reading: int, stalled: int, budgets: Budgets, monkeypatch: pytest.MonkeyPatch) -> None:
    setting = read_setting(STUDY, Path())
    taken: list[float] = []
    readers: list[subprocess.Popen[str]] = []
    writers: list[asyncio.StreamWriter] = []
    tasks: list[asyncio.Task[None]] = []
    plain = WatchServer.take

    def timed(door: WatchServer, tick: int, messages: Iterable[RosMessage]) -> None:
        started = time.thread_time()
        plain(door, tick, messages)
        taken.append(time.thread_time() - started)

    monkeypatch.setattr(WatchServer, "take", timed)

    def come(where: ListeningAddress | CannotListen) -> None:
        assert isinstance(where, ListeningAddress)
        command = [sys.executable, "-c", READ, str(where.port), str(reading)]
        readers.append(subprocess.Popen(command, stdout=subprocess.PIPE, text=True))
        if stalled:
            tasks.append(asyncio.ensure_future(stall(where)))

    async def stall(where: ListeningAddress) -> None:
        _, writer = await asyncio.open_connection(where.host, where.port, limit=1024)
        writers.append(writer)

    async def whole() -> None:
        options = PlayOptions(1.0, None, frozenset(), "suggestion", SECONDS, watch=WatchAddress("127.0.0.1", 0, None))
        bot = TabUI(build_bot(setting.templates, STUDY.participant.strategy, STUDY.seed))
        await play.play(
            setting, (bot,), options, lambda _: None, lambda _: None, StartupCallbacks(lambda _: None, come)
        )

    with pytest.raises(HuntUnfinished):
        asyncio.run(whole())
    told, _ = readers[0].communicate(timeout=30)
    warm = np.array(taken[100:]) * 1e6
    each = int(told) / max(reading, 1) / SECONDS / 1e6
    print(
        f"\n{ROBOTS} robots, {reading} watchers, {stalled} stalled: the door takes {warm.mean():.0f} us of a tick on "
        f"average, 99 %: {np.percentile(warm, 99):.0f} us, longest {warm.max():.0f} us; {each:.2f} MB/s each"
    )
    assert each > 1.0 or not reading
    assert np.percentile(warm, 99) < 10_000.0  # half a tick
    budgets.time(f"watching: a tick, {reading} watchers, {stalled} stalled", 1e-6 * float(warm.mean()))
