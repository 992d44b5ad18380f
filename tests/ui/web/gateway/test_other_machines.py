"""Games on other machines, which Dask workers start: they survive a dead Dask worker, and no dead machine loses one.

The other machines are further addresses of this one.
"""

import asyncio
import os
import shutil
import signal
from collections.abc import Callable
from contextlib import AbstractAsyncContextManager
from pathlib import Path

import pytest

from tests.support.programs.browser_client import BrowserClient
from tests.support.programs.dask_cluster import DaskCluster, dask_cluster
from tests.support.programs.processes import run_thbridge
from tests.support.studies.served_study import served
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.store.events import EventKind, LoggedEvent
from thbridge.recording.journal import journal_path, read_journal
from thbridge.recording.recordings import journal_of
from ui.web.pool.running_games import RunningGames, WorkerAddress

pytest.importorskip("distributed")

from ui.web.pool.cluster import ClusterHosts

STUDY = """\
title: Other machines
seed: 3
base: {map: practice, templates: practice, robots: 1, rate: 10, server.port: 0}
quota: 4
consent_elsewhere: People agreed before.
steps:
  - {step: trial, name: game, max_seconds: 3000}
"""
HOSTS = "127.0.0.2", "127.0.0.3"


async def the_worker(running: RunningGames, browser: BrowserClient) -> WorkerAddress:
    """Wait until the game is placed on another machine, and return its worker."""
    found: list[WorkerAddress] = []

    def is_placed() -> bool:
        found[:] = [each for key in running if (each := running.address(key)) is not None and each.process]
        return bool(found)

    await browser.until(is_placed)
    return found[0]


@pytest.mark.slow
def test_a_game_on_another_machine_outlives_its_dask_worker_and_goes_on_elsewhere_when_it_is_killed(
    tmp_path: Path,
) -> None:
    study = tmp_path / "study"
    study.mkdir()
    (study / "experiment.yaml").write_text(STUDY)
    running = RunningGames.of(study)

    async def run(cluster: DaskCluster) -> None:
        def remote(report: Callable[[str], None]) -> AbstractAsyncContextManager[ClusterHosts]:
            return ClusterHosts(cluster.address, study, report).watched()

        joined = {host: cluster.join("--nthreads", "1", "--host", host) for host in HOSTS}
        async with served(study, running, games=0, remote=remote) as (port, _):
            browser = await BrowserClient.arrived(port)
            await browser.press_button()
            await browser.until(lambda: browser.tree.get("phase") == "playing" and browser.tree["tiles"])
            worker = await the_worker(running, browser)
            assert worker.host in HOSTS

            joined.pop(worker.host).kill()
            await asyncio.sleep(0.4)
            await browser.act(browser.tree["tiles"][0]["choose"]["act"])
            await browser.until(lambda: browser.tree["dialogue"] and browser.tree["dialogue"]["choices"])
            said = browser.tree["dialogue"]["sentences"][-1]

            # The process and its sleeping copies: the machine has ended all its programs.
            before = browser.whole_pages
            os.killpg(worker.process, signal.SIGKILL)
            await browser.until(lambda: browser.whole_pages > before)
            await browser.until(lambda: browser.tree["dialogue"] and browser.tree["dialogue"]["choices"])
            assert browser.tree["dialogue"]["sentences"][-1] == said
            assert {(await the_worker(running, browser)).host} == {*joined}
            await asyncio.sleep(0.4)
            await browser.act(browser.tree["dialogue"]["aside"]["act"])
            await browser.until(lambda: browser.tree["dialogue"] is None)
            await browser.end_game()
            await browser.until(lambda: browser.shown.get("button") == "Finish")
            assert not [*running]
            await browser.close()

    with dask_cluster(tmp_path) as cluster:
        cluster.schedule("--host", "127.0.0.1")
        try:
            asyncio.run(asyncio.wait_for(run(cluster), 280))
        finally:
            shutil.rmtree(running.folder)
    events = [entry.event for entry in ExperimentFolder(study).entries() if isinstance(entry, LoggedEvent)]
    kinds = [event.kind for event in events]
    assert kinds.count(EventKind.GAME_PLAYED) == 1
    assert kinds.count(EventKind.RECORDING_CUT_OFF) == 1
    assert EventKind.GAME_BROKEN_OFF not in kinds
    (played,) = (event.data["bag"] for event in events if event.kind == EventKind.GAME_PLAYED)
    bag = study / str(played)
    assert read_journal(journal_path(journal_of(bag), 1)).state.ended is not None
    assert run_thbridge(tmp_path, "replay", str(bag)).returncode == 0
